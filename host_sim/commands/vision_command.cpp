#include "host_sim/commands/vision_command.hpp"

#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "host_sim/commands/option_checks.hpp"
#include "host_sim/experiments/vision/describe_image.hpp"
#include "host_sim/reports/run_folder.hpp"

namespace cairn::host {
namespace {

struct VisionOptions {
  std::filesystem::path image;
  int threshold = 20;
  int descriptors = 1000;
  std::filesystem::path out;
};

void run(const VisionOptions& options, const std::string& command_line) {
  const cv::Mat grey = read_grey(options.image);
  make_folder(options.out);
  const std::vector<Corner> corners = detect_corners(grey, options.threshold);
  const std::vector<Feature> features =
      describe_corners(grey, strongest(corners, options.descriptors));
  Manifest manifest;
  manifest.command_line = command_line;
  manifest.config = {{"threshold", options.threshold}, {"descriptors", options.descriptors}};
  manifest.inputs = {{"image", options.image.string()}};
  write_manifest(options.out, manifest);
  write_corners(corners, options.out / "fast.csv");
  write_features(features, options.out / "freak.csv");
  fmt::print("{}x{} pixels, {} corners, {} descriptors\nresults in {}\n", grey.cols, grey.rows,
             corners.size(), features.size(), options.out.string());
}

}  // namespace

void register_vision_command(CommandContext& context) {
  CLI::App* command =
      context.app.add_subcommand("vision", "FAST corners and FREAK descriptors of one image");
  const auto options = std::make_shared<VisionOptions>();
  command->add_option("image", options->image, "Image file, read as grey")->required();
  command->add_option("--threshold", options->threshold, "FAST threshold, grey values")
      ->check(CLI::Range(1, 254))
      ->capture_default_str();
  command
      ->add_option("--descriptors", options->descriptors,
                   "Describe this many of the strongest corners, and those equal in score to the "
                   "last; 0: all")
      ->check(not_negative())
      ->capture_default_str();
  command->add_option("--out", options->out, "Folder for the results")->required();
  command->callback([&context, options] { run(*options, context.command_line); });
}

}  // namespace cairn::host

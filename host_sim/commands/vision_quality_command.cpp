#include "host_sim/commands/vision_quality_command.hpp"

#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "host_sim/experiments/vision/matching_quality.hpp"
#include "host_sim/reports/run_folder.hpp"

namespace cairn::host {
namespace {

struct QualityOptions {
  std::filesystem::path sets;
  std::filesystem::path out;
};

void run(const QualityOptions& options) {
  const std::vector<QualityResult> results = measure_matching_quality(options.sets);
  make_folder(options.out);
  write_quality(results, options.out / "quality.csv");
  const std::string table = quality_table(results);
  write_text(options.out / "quality.md", table);
  fmt::print("{}results in {}\n", table, options.out.string());
}

}  // namespace

void register_vision_quality_command(CommandContext& context) {
  CLI::App* command = context.app.add_subcommand(
      "vision-quality", "Matching quality of FREAK's modes and ORB on warped and recorded pairs");
  const auto options = std::make_shared<QualityOptions>();
  command->add_option("sets", options->sets, "Folder with the homography sets graf and churchill")
      ->required();
  command->add_option("--out", options->out, "Folder for the results")->required();
  command->callback([options] { run(*options); });
}

}  // namespace cairn::host

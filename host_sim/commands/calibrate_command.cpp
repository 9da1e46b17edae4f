#include "host_sim/commands/calibrate_command.hpp"

#include <filesystem>
#include <memory>
#include <unistd.h>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "host_sim/calibration/calibration_file.hpp"
#include "host_sim/calibration/calibration_pictures.hpp"
#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/io/output_file.hpp"

namespace cairn::host {
namespace {

namespace fs = std::filesystem;

constexpr int kMostSearched = 240;  // slots of a video
constexpr int kPrintedSquare_px = 120;
constexpr std::size_t kLeastBoards = 4;  // of a calibration

struct CalibrateOptions {
  fs::path media;
  fs::path out;
  fs::path board_picture;
  BoardOptions board;
  std::string board_kind = "chessboard";
  std::string squares = "10x7";
  std::string model = "radtan";
  int views = 40;
  bool force = false;
};

cv::Size parse_squares(const std::string& text) {
  int across = 0, down = 0;
  char end = 0;
  if (std::sscanf(text.c_str(), "%dx%d%c", &across, &down, &end) != 2) {
    throw UsageError(
        fmt::format("--squares '{}': expected squares across and down, such as 10x7", text));
  }
  return {across, down};
}

CalibratedModel model_named(const std::string& name) {
  if (name == "rational") return CalibratedModel::kRational;
  if (name == "fisheye") return CalibratedModel::kFisheye;
  return CalibratedModel::kRadialTangential;
}

void refuse_existing(const fs::path& path, bool force) {
  if (force || !fs::exists(path)) return;
  throw UsageError(fmt::format("--out {}: is there already; --force replaces it", path.string()));
}

void write_board(const CalibrateOptions& options, const BoardDetector& detector) {
  refuse_existing(options.board_picture, options.force);
  std::vector<unsigned char> png;
  cv::imencode(".png", detector.picture(kPrintedSquare_px), png);
  write_text(options.board_picture, {reinterpret_cast<const char*>(png.data()), png.size()});
  fmt::print(
      "board in {}: print it and glue it to something flat, or show it on a screen\n"
      "cairn_sim calibrate VIDEO --board {} --squares {} --out camera.yaml\n",
      options.board_picture.string(), options.board_kind, options.squares);
}

struct Search {
  std::vector<BoardView> found;
  cv::Size size;
  int searched = 0;
};

Search search(const CalibrateOptions& options, const BoardDetector& detector) {
  const bool progress = isatty(STDERR_FILENO) != 0;
  Search search;
  take_calibration_pictures(options.media, kMostSearched,
                            [&](const std::string& name, const cv::Mat& grey, int expected) {
                              search.size = grey.size();
                              ++search.searched;
                              BoardView view;
                              view.name = name;
                              if (detector.find(grey, view)) search.found.push_back(view);
                              if (progress) {
                                fmt::print(stderr, "\rboards {} in {} of {} pictures ",
                                           search.found.size(), search.searched, expected);
                              }
                            });
  if (progress) fmt::print(stderr, "\n");
  return search;
}

void print_calibration(const Calibration& calibration, const Coverage& coverage) {
  fmt::print("{:<24}{:>10}\n", "board", "rms, px");
  for (const CalibratedView& view : calibration.views) {
    fmt::print("{:<24}{:>10.3f}{}\n", view.name, view.rms_px,
               view.used ? "" : "  left out: does not fit the others");
  }
  fmt::print("\ncorners were seen in {:.0f} % of the picture\n{}\n", 100.0 * coverage.share(),
             drawn(coverage));
  fmt::print("fx {:.2f}  fy {:.2f}  cx {:.2f}  cy {:.2f} px of {}x{}\n", calibration.fx,
             calibration.fy, calibration.cx, calibration.cy, calibration.size.width,
             calibration.size.height);
  fmt::print("{} {:.6f}\n",
             calibration.model == CalibratedModel::kFisheye    ? "k1 k2 k3 k4"
             : calibration.model == CalibratedModel::kRational ? "k1 k2 p1 p2 k3 k4 k5 k6"
                                                               : "k1 k2 p1 p2 k3",
             fmt::join(calibration.coefficients, " "));
  fmt::print("rms {:.3f} px", calibration.rms_px);
  if (calibration.focal_sigma) {
    fmt::print("   focal length known to {:.2f} %", 100.0 * *calibration.focal_sigma);
  }
  fmt::print("\n");
}

/// Where nearly all pictures are without the board, it is another one.
void refuse_few(const Search& found, const CalibrateOptions& options) {
  if (found.found.size() >= kLeastBoards) return;
  const std::string count = found.found.empty() ? "none" : fmt::format("{}", found.found.size());
  const std::string hint =
      options.board.charuco
          ? fmt::format(
                "Are its markers of --dictionary {}, and as large as --marker-ratio {} "
                "says? Squares are counted, black and white, across and down",
                options.board.dictionary, options.board.marker_ratio)
          : "Squares are counted, not the corners between them; all of a chessboard must be seen, "
            "with a white border";
  throw InputError(
      options.media,
      fmt::format("expected a {} of {} squares, found {} in {} pictures, of {} or more "
                  "that are needed. {}",
                  options.board_kind, options.squares, count, found.searched, kLeastBoards, hint));
}

ExitCode run_calibration(const CalibrateOptions& options, const std::string& command_line) {
  const BoardDetector detector(options.board);
  if (!options.board_picture.empty()) {
    write_board(options, detector);
    if (options.media.empty()) return ExitCode::kOk;
  }
  if (options.media.empty()) throw UsageError("MEDIA: expected a video or a folder of pictures");
  if (options.out.empty()) throw UsageError("--out: expected the camera file to write");
  refuse_existing(options.out, options.force);
  (void)OutputFile(options.out);  // refused before the work where it cannot be written
  const Search found = search(options, detector);
  fmt::print("boards in {} of {} pictures\n", found.found.size(), found.searched);
  refuse_few(found, options);
  std::vector<BoardView> views;
  for (const std::size_t i :
       choose_views(found.found, found.size, static_cast<std::size_t>(options.views))) {
    views.push_back(found.found[i]);
  }
  const Calibration calibration =
      calibrate(options.media.string(), views, found.size, model_named(options.model));
  std::vector<BoardView> used;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (calibration.views[i].used) used.push_back(views[i]);
  }
  const Coverage coverage = coverage_of(used, found.size);
  print_calibration(calibration, coverage);
  write_text(options.out, camera_file_text(calibration, coverage, command_line));
  fmt::print("camera file: {}\n", options.out.string());
  std::vector<std::string> doubts = doubts_about(calibration, coverage);
  try {
    check_camera(camera_of(calibration), options.out);
  } catch (const InputError& error) {
    doubts.push_back(error.what());
  }
  for (const std::string& doubt : doubts) fmt::print("not good: {}\n", doubt);
  if (doubts.empty()) fmt::print("good\n");
  return doubts.empty() ? ExitCode::kOk : ExitCode::kCheckFailed;
}

}  // namespace

void register_calibrate_command(CommandContext& context) {
  CLI::App* command = context.app.add_subcommand(
      "calibrate", "Make a camera file from a video or pictures of a board");
  const auto options = std::make_shared<CalibrateOptions>();
  command->add_option("MEDIA", options->media, "Video, or folder of pictures, of the board");
  command->add_option("--out", options->out, "Camera file to write");
  command->add_flag("--force", options->force, "Replace files that are there");
  command->add_option("--board", options->board_kind, "What board it is")
      ->check(CLI::IsMember({"chessboard", "charuco"}))
      ->capture_default_str();
  command->add_option("--squares", options->squares, "Squares across and down")
      ->capture_default_str();
  command
      ->add_option("--marker-ratio", options->board.marker_ratio,
                   "ChArUco: side of a marker over that of a square")
      ->capture_default_str();
  command->add_option("--dictionary", options->board.dictionary, "ChArUco: its markers")
      ->check(CLI::IsMember(board_dictionaries(), CLI::ignore_case))
      ->capture_default_str();
  command->add_option("--model", options->model, "Lens model")
      ->check(CLI::IsMember({"radtan", "rational", "fisheye"}))
      ->capture_default_str();
  command->add_option("--views", options->views, "Boards that are used at most")
      ->check(CLI::Range(4, 200))
      ->capture_default_str();
  command->add_option("--write-board", options->board_picture,
                      "Write the board as a picture (PNG) to print or to show");
  command->callback([&context, options] {
    options->board.charuco = options->board_kind == "charuco";
    options->board.squares = parse_squares(options->squares);
    context.exit_code = run_calibration(*options, context.command_line);
  });
}

}  // namespace cairn::host

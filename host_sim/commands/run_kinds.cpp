#include "host_sim/commands/run_kinds.hpp"

#include <fmt/format.h>

#include "host_sim/commands/video_run.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/recorded/recorded_kinds.hpp"
#include "host_sim/recorded/starry_night.hpp"

namespace cairn::host {

const std::vector<RunKind>& run_kinds() {
  static const std::vector<RunKind> kinds = {
      {"hall", "", run_hall},
      {"hall-small", "", run_hall_small},
      {"stress", "FIELDS", run_stress},
      {"seven-scenes", "DIR", run_seven_scenes},
      {"tag-board", "DIR", run_tag_board},
      {"kitti", "DIR", run_kitti},
      {"tum-rgbd", "DIR", run_tum_rgbd},
      {"video", "FILE_OR_FOLDER", run_video},
      {"lost-in-the-woods", "DIR", run_lost_in_the_woods, false},
      {"mrclam", "DIR:ROBOT", run_mrclam, false},
      {"victoria-park", "DIR", run_victoria_park, false},
      {"starry-night", "DIR", run_starry_night, false},
  };
  return kinds;
}

ExitCode dispatch_run(const RunOptions& options) {
  const std::string name = options.source.substr(0, options.source.find(':'));
  for (const RunKind& kind : run_kinds()) {
    if (name != kind.name) continue;
    const bool has_rest = options.source.find(':') != std::string::npos;
    if (has_rest == kind.argument.empty()) {
      throw UsageError(fmt::format("source '{}': expected {}{}", options.source, kind.name,
                                   kind.argument.empty() ? "" : ":" + kind.argument));
    }
    if (options.timing.has_value() && !kind.gives_pictures) {
      throw UsageError(fmt::format("source '{}' gives no pictures to time", options.source));
    }
    return kind.run(options, has_rest ? options.source.substr(name.size() + 1) : std::string());
  }
  std::string known;
  for (const RunKind& kind : run_kinds()) {
    known += fmt::format("{}{}{}{}", known.empty() ? "" : ", ", kind.name,
                         kind.argument.empty() ? "" : ":", kind.argument);
  }
  throw UsageError(fmt::format("source '{}': expected one of {}", options.source, known));
}

}  // namespace cairn::host

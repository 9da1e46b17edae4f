#include "host_sim/commands/run_kinds.hpp"

#include "host_sim/mono/starry_night.hpp"
#include "host_sim/planar/recorded/recorded_kinds.hpp"
#include "host_sim/run/video_run.hpp"

namespace cairn::host {

const std::vector<RunKind>& run_kinds() {
  static const std::vector<RunKind> kinds = {
      {"hall", "", run_hall},
      {"hall-small", "", run_hall_small},
      {"seven-scenes", "DIR", run_seven_scenes},
      {"tag-board", "DIR", run_tag_board},
      {"kitti", "DIR", run_kitti},
      {"tum-rgbd", "DIR", run_tum_rgbd},
      {"video", "FILE_OR_FOLDER", run_video},
      {"lost-in-the-woods", "DIR", run_lost_in_the_woods},
      {"mrclam", "DIR:ROBOT", run_mrclam},
      {"victoria-park", "DIR", run_victoria_park},
      {"starry-night", "DIR", run_starry_night},
  };
  return kinds;
}

}  // namespace cairn::host

#include "host_sim/experiments/faults/fault_classes.hpp"

namespace cairn::host {

const std::vector<FaultClass>& fault_classes() {
  static const std::vector<FaultClass> classes = {
      {"F01", "frames dropped", inject_dropped_frames},
      {"F02", "frames late, twice, out of order", inject_frame_order},
      {"F03", "time jumps, wraps, stands", inject_time_jumps},
      {"F04", "odometry not finite or out of domain", inject_odometry_garbage},
      {"F05", "odometry stuck, wrong, slipping, silent", inject_wrong_odometry},
      {"F06", "pictures black, saturated, constant, noise, frozen", inject_blind_frames},
      {"F07", "pictures of a wrong size, or none", inject_wrong_pictures},
      {"F08", "pictures torn, skewed, with flipped bits", inject_corrupted_frames},
      {"F09", "places that look alike", inject_aliases},
      {"F10", "map full", inject_full_map},
      {"F11", "ambiguous pose of a plane", inject_planar_ambiguity},
      {"F12", "covariance worn by standing", inject_standing},
      {"F13", "singular innovation covariance", inject_singular_innovation},
      {"F14", "edges of domains", inject_domain_edges},
      {"F15", "too little time for a frame", inject_short_work},
      {"F16", "writing beside the tracker", inject_overwriting},
      {"F17", "calibration and mount missing, absurd, wrong", inject_bad_calibration},
      {"F18", "files of another version or capacity", inject_other_versions},
      {"F19", "damaged files", inject_damaged_files},
      {"F20", "storm of losses", inject_flicker},
      {"F21", "calls out of order, two instances", inject_call_order},
      {"F22", "bits that flip in the state", inject_bit_flips},
      {"F23", "kidnapped camera, long occlusion", inject_kidnapping},
      {"F24", "tick counter wraps, stands, is missing", inject_tick_wrap},
  };
  return classes;
}

}  // namespace cairn::host

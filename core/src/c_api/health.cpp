#include "health.hpp"

#include <cstddef>

// A counter that was added to Health, moved or renamed is to be treated alike in cairn_health.
#define CAIRN_SAME(counter)                                                          \
  static_assert(offsetof(cairn::Health, counter) == offsetof(cairn_health, counter), \
                "place of a counter in cairn_health")

CAIRN_SAME(non_finite_inputs);
CAIRN_SAME(time_errors);
CAIRN_SAME(images_refused);
CAIRN_SAME(frame_gaps);
CAIRN_SAME(odometry_refused);
CAIRN_SAME(odometry_glitches);
CAIRN_SAME(odometry_timeouts);
CAIRN_SAME(repeated_images);
CAIRN_SAME(innovations_used);
CAIRN_SAME(innovations_gated);
CAIRN_SAME(innovations_singular);
CAIRN_SAME(ransac_no_consensus);
CAIRN_SAME(landmarks_added);
CAIRN_SAME(landmarks_removed);
CAIRN_SAME(landmarks_replaced);
CAIRN_SAME(landmarks_refused);
CAIRN_SAME(candidates_dropped);
CAIRN_SAME(corners_dropped);
CAIRN_SAME(searches_deferred);
CAIRN_SAME(covariance_repairs);
CAIRN_SAME(depth_repairs);
CAIRN_SAME(reacquisitions);
CAIRN_SAME(resets);
CAIRN_SAME(losses);
CAIRN_SAME(landmarks_archived);
CAIRN_SAME(landmarks_reactivated);
CAIRN_SAME(map_messages_dropped);
CAIRN_SAME(relocalisations);
CAIRN_SAME(false_relocalisations_refused);
CAIRN_SAME(budget_exceeded);
CAIRN_SAME(low_texture_frames);
CAIRN_SAME(mount_suspicions);
CAIRN_SAME(ground_suspicions);
CAIRN_SAME(yaw_suspicions);

#pragma once

#include <cstdint>

namespace cairn {

/// Everything that was clamped, rejected, reset or dropped since initialise(). Counters only grow
/// (they wrap at 2^32); nothing of the kind happens silently. Plain value: copy it to take a
/// snapshot.
struct Health {
  std::uint32_t non_finite_inputs = 0;
  std::uint32_t time_errors = 0;        ///< duplicate, backwards or too large a step
  std::uint32_t images_refused = 0;     ///< none, or not of the camera's size
  std::uint32_t frame_gaps = 0;         ///< frames that were expected and did not come
  std::uint32_t odometry_refused = 0;   ///< readings outside their domain
  std::uint32_t odometry_glitches = 0;  ///< readings that changed faster than a vehicle can
  std::uint32_t odometry_timeouts = 0;  ///< steps in which the motion was unknown
  std::uint32_t repeated_images = 0;    ///< the same bytes as the frame before
  std::uint32_t innovations_used = 0;
  std::uint32_t innovations_gated = 0;  ///< outside the Mahalanobis gate
  std::uint32_t innovations_singular = 0;
  std::uint32_t ransac_no_consensus = 0;
  std::uint32_t landmarks_added = 0;
  std::uint32_t landmarks_removed = 0;   ///< deleted by quality
  std::uint32_t landmarks_replaced = 0;  ///< deleted to make room
  std::uint32_t landmarks_refused = 0;   ///< no room, nothing to replace
  std::uint32_t candidates_dropped = 0;
  std::uint32_t corners_dropped = 0;     ///< detector output over its capacity
  std::uint32_t searches_deferred = 0;   ///< landmarks not searched: work budget spent
  std::uint32_t covariance_repairs = 0;  ///< variance floor or symmetry repair
  std::uint32_t depth_repairs = 0;       ///< inverse depth kept positive
  std::uint32_t reacquisitions = 0;      ///< gate widened after a run of rejections
  std::uint32_t resets = 0;
  std::uint32_t losses = 0;
  std::uint32_t landmarks_archived = 0;     ///< handed to the map builder
  std::uint32_t landmarks_reactivated = 0;  ///< reactivated from the map library
  std::uint32_t map_messages_dropped = 0;
  std::uint32_t relocalisations = 0;
  std::uint32_t false_relocalisations_refused = 0;
  std::uint32_t budget_exceeded = 0;
  std::uint32_t low_texture_frames = 0;
  std::uint32_t mount_suspicions = 0;   ///< frames in which mount or focal length seemed wrong
  std::uint32_t ground_suspicions = 0;  ///< frames in which speed or camera height seemed wrong
  std::uint32_t yaw_suspicions = 0;     ///< frames in which odometry's yaw rate seemed wrong
};

/// A tracker's counters with those that its filter keeps.
inline Health with_filter(Health tracker, const Health& filter) {
  tracker.innovations_used += filter.innovations_used;
  tracker.innovations_gated += filter.innovations_gated;
  tracker.innovations_singular += filter.innovations_singular;
  tracker.ransac_no_consensus += filter.ransac_no_consensus;
  tracker.covariance_repairs += filter.covariance_repairs;
  tracker.depth_repairs += filter.depth_repairs;
  tracker.reacquisitions += filter.reacquisitions;
  tracker.resets += filter.resets;
  return tracker;
}

}  // namespace cairn

#pragma once

#include "cairn/base/hash.hpp"
#include "cairn/planar/fixed/covariance3.hpp"
#include "cairn/planar/fixed/motion.hpp"
#include "cairn/planar/fixed/pixel_sighting.hpp"
#include "cairn/planar/fixed/row_scaled_factor.hpp"
#include "cairn/planar/fixed/state.hpp"
#include "cairn/planar/fixed/tilt.hpp"

namespace cairn::detail {

/// Covariance of the error of a FixedPlanarState: what the factor holds, what odometry added since
/// the factor took it in, and, of the group's error, what the pose was unsure by when the first
/// landmark came. What turns with the heading is read from the mean that is handed in.
template <class State, FixedError Error>
class FixedPlanarError {
 public:
  static constexpr bool kWorld = Error == FixedError::kWorld;
  static constexpr int kStates = State::kStates;
  /// An append()'s `spare` for rows that may be full.
  static constexpr int kFullRow = kStates <= 64 ? 3 : (kStates <= 256 ? 4 : 5);
  using Factor = RowScaledFactor<kStates>;

  /// Of a pose alone. `tilt`: nullptr for a body that does not.
  void start(const FixedPoseCovariance& covariance, const FixedCovariance2* tilt,
             std::uint32_t& saturations);

  const Factor& factor() const { return factor_; }
  Factor& factor() { return factor_; }
  const FixedMotionNoise& motion() const { return motion_; }
  FixedMotionNoise& motion() { return motion_; }
  /// Memory for one call: each that is not const spoils it.
  std::int32_t* scratch() { return scratch_; }

  void propagate(const FixedIncrement& increment, const FixedStep& step,
                 std::uint32_t& saturations);
  /// The factor takes in the noise of the odometry.
  void absorb_motion(const State& state, std::uint32_t& saturations);
  /// What the pose is unsure by is common to all that comes: no sighting depends on it.
  void share_pose_error(const State& state, std::uint32_t& saturations);
  /// Position and heading of all that is shared, about the vehicle.
  void drift_world(const State& state, FixedVariance position, FixedVariance heading,
                   std::uint32_t& saturations);
  void shrink_tilt(const FixedTiltStep& step, std::uint32_t& saturations);
  /// An error of the heading turns about the vehicle from now on: before the state's recentre().
  void recentre(const State& state, std::uint32_t& saturations);

  /// Appends a landmark's states: `rows` of those before, and `noise`. Of a row at most 4^spare
  /// elements are not zero.
  void append(const FixedStateRow (&rows)[3], const FixedCholesky3& noise, int spare,
              std::uint32_t& saturations);
  void remove(int first) { factor_.template remove_rows<State::kLandmarkDim>(first, scratch_); }
  /// Adds noise of this deviation, doubled `doublings` times, to each coordinate of a landmark.
  void widen_landmark(int first, FixedLength sigma, int doublings, std::uint32_t& saturations);
  /// P += the sum of columns[k] columns[k]^T, each with `fraction` bits, on these states.
  template <int Columns, int Rows>
  void add_noise(const std::int64_t (&columns)[Columns][Rows], const int (&states)[Rows],
                 int fraction, std::uint32_t& saturations);

  /// Without the odometry that the factor has not taken in.
  FixedVariance covariance(int i, int j) const {
    std::uint32_t none = 0;
    return FixedVariance::from_raw(factor_.covariance(i, j, none));
  }
  /// The same of three rows over the states.
  FixedCovariance3 covariance_of(const FixedStateRow (&rows)[3]) const;
  FixedCovariance2 tilt_covariance() const {
    constexpr int kTilt = State::kTiltState;
    return {covariance(kTilt, kTilt), covariance(kTilt + 1, kTilt),
            covariance(kTilt + 1, kTilt + 1)};
  }
  /// Of (xi or x, xi or y, heading); `with_shared`: also what all have in common.
  FixedPoseCovariance pose_covariance(const State& state, std::uint32_t& saturations,
                                      bool with_shared = true) const;
  /// The same of a landmark and the heading, of the group's error.
  FixedPoseCovariance landmark_covariance(const State& state, int slot) const;
  /// Of the vector from vehicle to landmark in the plane, the odometry's noise included.
  FixedCovariance2 relative_covariance(const State& state, int slot,
                                       std::uint32_t& saturations) const;
  /// The odometry's part of it.
  FixedCovariance2 waiting_noise(const State& state, int slot, std::uint32_t& saturations) const {
    FixedCovariance2 out;
    motion_.add_relative(state.relative(slot, 0), state.relative(slot, 1), out, saturations);
    return out;
  }
  /// Of a pixel's two rows without their noise, m^2. `scratch`: 2 kStates elements.
  FixedCovariance2 innovation_covariance(const State& state, const FixedPixelSighting& sighting,
                                         std::int32_t* scratch, std::uint32_t& saturations) const;
  /// Variance of a landmark's depth, m^2 with 44 fraction bits; `scratch`: kStates elements.
  std::int64_t depth_variance(const State& state, int slot, const FixedTangent (&depth)[3],
                              std::int32_t* scratch, std::uint32_t& saturations) const;
  void hash_moved(Hash64& hash) const {
    for (const FixedCoordinate moved : moved_) hash.add(moved.raw());
  }

 private:
  /// By which an error of the heading turns what a sighting measures, in the world's error: from
  /// where the vehicle was when the factor took its motion in last.
  FixedLength lever(const State& state, int slot, int axis) const {
    return state.relative(slot, axis, moved_[axis]);
  }
  void clear(const FixedCovariance2* tilt, std::uint32_t& saturations);
  void turn_with_heading(std::uint32_t& saturations);
  void shear(int first, const FixedLength (&by)[2], std::uint32_t& saturations);
  bool enter(int row, std::int64_t value, std::uint64_t more, int fraction,
             std::uint32_t& saturations);

  Factor factor_;
  FixedMotionNoise motion_;
  FixedPoseCovariance shared_;
  FixedCoordinate moved_[2];  ///< since the factor took its motion in, of the world's error
  std::int32_t scratch_[State::kLandmarkDim * kStates] = {};
};

}  // namespace cairn::detail

#include "cairn/planar/fixed/error_covariances.hpp"
#include "cairn/planar/fixed/error_impl.hpp"

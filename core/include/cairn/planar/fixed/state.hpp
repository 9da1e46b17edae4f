#pragma once

#include "cairn/base/hash.hpp"
#include "cairn/planar/detail/landmark_slots.hpp"
#include "cairn/planar/fixed/motion.hpp"
#include "cairn/planar/fixed/pixel_sighting.hpp"
#include "cairn/planar/fixed/row_scaled_factor.hpp"
#include "cairn/planar/fixed/sighting.hpp"

namespace cairn::detail {

/// State of FixedPlanarSlam: its landmarks, where in the error the states of each lie, and the mean
/// of all, in metres from an anchor. Heading, x and y come first, then pitch and roll where the
/// body tilts, then the landmarks.
template <int MaxLandmarks, int LandmarkDim>
class FixedPlanarState {
 public:
  static constexpr int kLandmarkDim = LandmarkDim;
  static constexpr int kPoseStates = 3;
  static constexpr int kTiltState = kPoseStates;
  static constexpr int kStates = (LandmarkDim == 3 ? 5 : 3) + LandmarkDim * MaxLandmarks;
  using Slots = LandmarkSlots<MaxLandmarks>;

  /// An empty map; the anchor is at the pose.
  void start(const FixedPose& pose, bool tilts);

  int count() const { return slots_.size(); }
  int find(LandmarkId id) const { return slots_.find(id); }
  Slots& slots() { return slots_; }
  const Slots& slots() const { return slots_; }

  bool tilts() const { return LandmarkDim == 3 && tilts_; }
  int vehicle_states() const { return kPoseStates + (tilts() ? 2 : 0); }
  int state_of(int slot) const { return vehicle_states() + LandmarkDim * order_[slot]; }
  /// Of the landmark that enters next.
  int next_state() const { return vehicle_states() + LandmarkDim * count(); }
  /// Fraction bits of a correction of state i.
  int correction_bits(int i) const {
    const bool angle = i == 0 || (i >= kTiltState && i < vehicle_states());
    return angle ? FixedAngle::kFractionBits : FixedOffset::kFractionBits;
  }

  FixedAngle heading() const { return heading_; }
  const FixedTilt& tilt() const { return tilt_; }
  FixedAxes axes() const { return FixedAxes(heading_); }
  /// From the vehicle's axes, tilted with it, to the world's.
  FixedRotation rotation() const;
  FixedCameraView camera_view(const FixedCamera& camera, const FixedMount& T_vehicle_camera,
                              std::uint32_t& saturations) const {
    const FixedAxes own = axes();
    return FixedCameraView(camera, T_vehicle_camera, own.cosine, own.sine,
                           tilts() ? &tilt_ : nullptr, saturations);
  }

  FixedPose pose() const { return {in_world(x_[0], 0), in_world(x_[1], 1), heading_}; }
  FixedCoordinate in_world(FixedCoordinate from_anchor, int axis) const {
    std::uint32_t none = 0;
    return add(anchor_[axis], from_anchor, none);
  }
  FixedCoordinate from_anchor(FixedCoordinate in_world, int axis,
                              std::uint32_t& saturations) const {
    return subtract(in_world, anchor_[axis], saturations);
  }
  // From the anchor.
  FixedCoordinate vehicle_at(int axis) const { return x_[axis]; }
  FixedCoordinate landmark_at(int slot, int axis) const { return p_[slot][axis]; }
  FixedLength vehicle(int axis) const { return length(x_[axis]); }
  FixedLength landmark(int slot, int axis) const { return length(p_[slot][axis]); }
  FixedCoordinate height(int slot) const {
    if constexpr (LandmarkDim == 3) return p_[slot][2];
    static_cast<void>(slot);
    return {};
  }
  /// From the vehicle, or from where it was before it `moved`.
  FixedLength relative(int slot, int axis, FixedCoordinate moved = FixedCoordinate()) const {
    std::uint32_t none = 0;
    return length(subtract(p_[slot][axis], subtract(x_[axis], moved, none), none));
  }
  /// What a row of a pixel's sighting measures.
  FixedStateRow row_of(const FixedPixelSighting& sighting, int row) const;

  void move(const FixedStep& step, FixedAngle turn, std::uint32_t& saturations);
  void move_to(const FixedPose& pose, std::uint32_t& saturations);
  /// The anchor moves to the vehicle.
  void recentre(std::uint32_t& saturations);
  /// The tilt keeps `by` of itself; the map turns about the vehicle, as CartesianMap's does.
  void shrink_tilt(FixedRatio by, std::uint32_t& saturations);
  /// Applies a correction along the group's error: all turn together.
  void turn_by(const std::int32_t* correction, std::uint32_t& saturations);
  /// Applies a correction to each coordinate alone.
  void add_to_each(const std::int32_t* correction, std::uint32_t& saturations);
  /// The tilt that a correction leads to.
  FixedTilt tilt_after(const std::int32_t* correction) const;

  // A landmark enters: its place first, its errors meanwhile, then its identity.
  /// At (x, y) from the vehicle, in its level axes: its errors are the vehicle's own.
  void place_on_plane(FixedLength x, FixedLength y, FixedStateRow (&rows)[3],
                      std::uint32_t& saturations);
  void place_in_world(const FixedCoordinate (&p_world)[3], std::uint32_t& saturations);
  /// At `y` from the vehicle, turned by `rotation`: its errors are the vehicle's own and what the
  /// tilt turns about its axes.
  void place_beside_vehicle(const FixedRotation& rotation, const FixedLength (&y)[3],
                            FixedStateRow (&rows)[3], std::uint32_t& saturations);
  /// Adds to its errors that of the way from the position in slot `past`.
  void add_path(const FixedRotation& rotation, int past, const FixedLength (*by_path)[2],
                FixedStateRow (&rows)[3], std::uint32_t& saturations) const;
  void enter(LandmarkId id, std::uint32_t update, bool pinned = false);
  void remove(int slot);

  void hash_pose(Hash64& hash) const;

 private:
  void turn_map(const FixedRotation& turn, std::uint32_t& saturations);
  static FixedLength length(FixedCoordinate coordinate) {
    std::uint32_t none = 0;
    return convert<FixedLength>(coordinate, none);
  }

  Slots slots_;
  FixedAngle heading_;
  FixedCoordinate x_[2];
  FixedCoordinate anchor_[2];
  FixedCoordinate p_[MaxLandmarks][LandmarkDim];
  FixedTilt tilt_;
  bool tilts_ = false;
  std::int16_t order_[MaxLandmarks] = {};
};

}  // namespace cairn::detail

#include "cairn/planar/fixed/state_impl.hpp"

#pragma once

#include "cairn/planar/fixed/state.hpp"

namespace cairn::detail {

template <int MaxLandmarks, int LandmarkDim>
void FixedPlanarState<MaxLandmarks, LandmarkDim>::start(const FixedPose& pose, bool tilts) {
  slots_.clear();
  heading_ = wrapped_angle(pose.heading.raw());
  anchor_[0] = pose.x;
  anchor_[1] = pose.y;
  for (FixedCoordinate& x : x_) x = FixedCoordinate();
  tilt_ = FixedTilt();
  tilts_ = tilts;
}

template <int MaxLandmarks, int LandmarkDim>
FixedRotation FixedPlanarState<MaxLandmarks, LandmarkDim>::rotation() const {
  const FixedAxes own = axes();
  const FixedRotation level = rotation_about_vertical(own.cosine, own.sine);
  return tilts() ? level * rotation_of(tilt_) : level;
}

template <int MaxLandmarks, int LandmarkDim>
FixedStateRow FixedPlanarState<MaxLandmarks, LandmarkDim>::row_of(
    const FixedPixelSighting& sighting, int row) const {
  FixedStateRow out;
  const int l = state_of(sighting.slot);
  for (int i = 0; i < 3; ++i) {
    const std::int64_t h = sighting.h[row][i].raw();
    if (h != 0) out.add(l + i, h, FixedTangent::kFractionBits);
  }
  for (int i = 0; i < 2; ++i) {
    const std::int64_t h = sighting.h[row][i].raw();
    if (h != 0) out.add(1 + i, -h, FixedTangent::kFractionBits);
  }
  for (int k = 0; tilts() && k < 2; ++k) {
    const std::int64_t t = sighting.tilt[row][k].raw();
    if (t != 0) out.add(kTiltState + k, t, FixedLength::kFractionBits);
  }
  return out;
}

template <int MaxLandmarks, int LandmarkDim>
void FixedPlanarState<MaxLandmarks, LandmarkDim>::move(const FixedStep& step, FixedAngle turn,
                                                       std::uint32_t& saturations) {
  x_[0] = add(x_[0], step.x, saturations);
  x_[1] = add(x_[1], step.y, saturations);
  // Beyond the reach of a lever arm: counted here, where it is left.
  for (const FixedCoordinate x : x_) (void)convert<FixedLength>(x, saturations);
  heading_ = wrapped_angle(std::int64_t{heading_.raw()} + turn.raw());
}

template <int MaxLandmarks, int LandmarkDim>
void FixedPlanarState<MaxLandmarks, LandmarkDim>::move_to(const FixedPose& pose,
                                                          std::uint32_t& saturations) {
  x_[0] = from_anchor(pose.x, 0, saturations);
  x_[1] = from_anchor(pose.y, 1, saturations);
  heading_ = wrapped_angle(pose.heading.raw());
}

template <int MaxLandmarks, int LandmarkDim>
void FixedPlanarState<MaxLandmarks, LandmarkDim>::recentre(std::uint32_t& saturations) {
  for (int slot = 0; slot < count(); ++slot) {
    for (int axis = 0; axis < 2; ++axis) {
      p_[slot][axis] = subtract(p_[slot][axis], x_[axis], saturations);
    }
  }
  for (int axis = 0; axis < 2; ++axis) {
    anchor_[axis] = add(anchor_[axis], x_[axis], saturations);
    x_[axis] = FixedCoordinate();
  }
}

template <int MaxLandmarks, int LandmarkDim>
void FixedPlanarState<MaxLandmarks, LandmarkDim>::shrink_tilt(FixedRatio by,
                                                              std::uint32_t& saturations) {
  const FixedRotation before = rotation();
  tilt_ = {multiply<FixedAngle>(tilt_.pitch, by, saturations),
           multiply<FixedAngle>(tilt_.roll, by, saturations)};
  turn_map(rotation() * before.transposed(), saturations);
}

/// By what the rotation changes, which keeps the small digits of the places.
template <int MaxLandmarks, int LandmarkDim>
void FixedPlanarState<MaxLandmarks, LandmarkDim>::turn_map(const FixedRotation& turn,
                                                           std::uint32_t& saturations) {
  const FixedRotation none;
  FixedRatio by[3][3];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) by[i][j] = subtract(turn.r[i][j], none.r[i][j], saturations);
  }
  for (int slot = 0; slot < count(); ++slot) {
    const FixedLength v[3] = {relative(slot, 0), relative(slot, 1), length(height(slot))};
    for (int i = 0; i < LandmarkDim; ++i) {
      for (int j = 0; j < 3; ++j) {
        const auto moved = multiply<FixedCoordinate>(v[j], by[i][j], saturations);
        p_[slot][i] = add(p_[slot][i], moved, saturations);
      }
    }
  }
}

template <int MaxLandmarks, int LandmarkDim>
void FixedPlanarState<MaxLandmarks, LandmarkDim>::turn_by(const std::int32_t* correction,
                                                          std::uint32_t& saturations) {
  const auto by = [&](int i) { return FixedOffset::from_raw(correction[i]); };
  const FixedExponential exponential(FixedAngle::from_raw(correction[0]), saturations);
  heading_ = wrapped_angle(std::int64_t{heading_.raw()} + exponential.angle().raw());
  exponential.move(x_[0], x_[1], by(1), by(2), saturations);
  for (int slot = 0; slot < count(); ++slot) {
    const int l = state_of(slot);
    exponential.move(p_[slot][0], p_[slot][1], by(l), by(l + 1), saturations);
    if constexpr (LandmarkDim == 3) {
      p_[slot][2] = add(p_[slot][2], convert<FixedCoordinate>(by(l + 2), saturations), saturations);
    }
  }
  if (tilts()) tilt_ = tilt_after(correction);
}

template <int MaxLandmarks, int LandmarkDim>
void FixedPlanarState<MaxLandmarks, LandmarkDim>::add_to_each(const std::int32_t* correction,
                                                              std::uint32_t& saturations) {
  const std::int64_t pi = kFixedPi.raw();
  const std::int64_t turn = correction[0];
  heading_ = wrapped_angle(heading_.raw() + (turn > pi ? pi : (turn < -pi ? -pi : turn)));
  const auto move = [&](FixedCoordinate& coordinate, int i) {
    const auto by = FixedOffset::from_raw(correction[i]);
    coordinate = add(coordinate, convert<FixedCoordinate>(by, saturations), saturations);
  };
  for (int axis = 0; axis < 2; ++axis) {
    move(x_[axis], 1 + axis);
    for (int slot = 0; slot < count(); ++slot) move(p_[slot][axis], state_of(slot) + axis);
  }
}

template <int MaxLandmarks, int LandmarkDim>
FixedTilt FixedPlanarState<MaxLandmarks, LandmarkDim>::tilt_after(
    const std::int32_t* correction) const {
  const auto turned = [&](FixedAngle angle, int state) {
    return wrapped_angle(std::int64_t{angle.raw()} + correction[state]);
  };
  return {turned(tilt_.pitch, kTiltState), turned(tilt_.roll, kTiltState + 1)};
}

template <int MaxLandmarks, int LandmarkDim>
void FixedPlanarState<MaxLandmarks, LandmarkDim>::place_on_plane(FixedLength x, FixedLength y,
                                                                 FixedStateRow (&rows)[3],
                                                                 std::uint32_t& saturations) {
  FixedLength seen[2];
  axes().turn(x, y, seen[0], seen[1], saturations);
  for (int axis = 0; axis < 2; ++axis) {
    const auto at = convert<FixedCoordinate>(seen[axis], saturations);
    p_[count()][axis] = add(x_[axis], at, saturations);
    rows[axis].add(1 + axis, 1, 0);
  }
}

template <int MaxLandmarks, int LandmarkDim>
void FixedPlanarState<MaxLandmarks, LandmarkDim>::place_in_world(
    const FixedCoordinate (&p_world)[3], std::uint32_t& saturations) {
  for (int axis = 0; axis < LandmarkDim; ++axis) {
    p_[count()][axis] = axis < 2 ? from_anchor(p_world[axis], axis, saturations) : p_world[axis];
  }
}

template <int MaxLandmarks, int LandmarkDim>
void FixedPlanarState<MaxLandmarks, LandmarkDim>::place_beside_vehicle(
    const FixedRotation& rotation, const FixedLength (&y)[3], FixedStateRow (&rows)[3],
    std::uint32_t& saturations) {
  FixedLength seen[3];
  rotation.turn(y, seen, saturations);
  for (int axis = 0; axis < LandmarkDim; ++axis) {
    const auto at = convert<FixedCoordinate>(seen[axis], saturations);
    p_[count()][axis] = axis < 2 ? add(x_[axis], at, saturations) : at;
    if (axis < 2) rows[axis].add(1 + axis, 1, 0);
  }
  if (!tilts()) return;
  const FixedAxes own = axes();
  const FixedCameraView level({}, {}, own.cosine, own.sine, &tilt_, saturations);
  for (int axis = 0; axis < LandmarkDim; ++axis) {
    const int next = (axis + 1) % 3;
    const int last = (axis + 2) % 3;
    for (int k = 0; k < 2; ++k) {
      const FixedLength by_tilt = subtract(
          multiply<FixedLength>(seen[last], level.axes[k][next], saturations),
          multiply<FixedLength>(seen[next], level.axes[k][last], saturations), saturations);
      rows[axis].add(kTiltState + k, by_tilt.raw(), FixedLength::kFractionBits);
    }
  }
}

template <int MaxLandmarks, int LandmarkDim>
void FixedPlanarState<MaxLandmarks, LandmarkDim>::add_path(const FixedRotation& rotation, int past,
                                                           const FixedLength (*by_path)[2],
                                                           FixedStateRow (&rows)[3],
                                                           std::uint32_t& saturations) const {
  const FixedAxes own = axes();
  FixedLength turned[2][3];
  for (int k = 0; k < 2; ++k) {
    const FixedLength column[3] = {by_path[0][k], by_path[1][k], by_path[2][k]};
    rotation.turn(column, turned[k], saturations);
  }
  for (int axis = 0; axis < 3; ++axis) {
    // From the vehicle's axes to the world's.
    FixedLength by_world[2];
    own.turn(turned[0][axis], turned[1][axis], by_world[0], by_world[1], saturations);
    for (int k = 0; k < 2; ++k) {
      rows[axis].add(1 + k, by_world[k].raw(), FixedLength::kFractionBits);
      rows[axis].add(state_of(past) + k, -std::int64_t{by_world[k].raw()},
                     FixedLength::kFractionBits);
    }
  }
}

template <int MaxLandmarks, int LandmarkDim>
void FixedPlanarState<MaxLandmarks, LandmarkDim>::enter(LandmarkId id, std::uint32_t update,
                                                        bool pinned) {
  order_[count()] = static_cast<std::int16_t>(count());
  slots_.push(id, update);
  slots_.statistics(count() - 1).pinned = pinned;
}

template <int MaxLandmarks, int LandmarkDim>
void FixedPlanarState<MaxLandmarks, LandmarkDim>::remove(int slot) {
  const std::int16_t place = order_[slot];
  const int last = count() - 1;
  order_[slot] = order_[last];
  for (int axis = 0; axis < LandmarkDim; ++axis) p_[slot][axis] = p_[last][axis];
  for (int k = 0; k < last; ++k) {
    if (order_[k] > place) --order_[k];
  }
  slots_.remove_unordered(slot);
}

template <int MaxLandmarks, int LandmarkDim>
void FixedPlanarState<MaxLandmarks, LandmarkDim>::hash_pose(Hash64& hash) const {
  hash.add(heading_.raw());
  for (int i = 0; i < 2; ++i) {
    hash.add(x_[i].raw());
    hash.add(anchor_[i].raw());
  }
  for (int slot = 0; slot < count(); ++slot) {
    hash.add(slots_.id(slot));
    for (int i = 0; i < LandmarkDim; ++i) hash.add(p_[slot][i].raw());
  }
}

}  // namespace cairn::detail

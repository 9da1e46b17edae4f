#pragma once

#include "cairn/base/status.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/numeric/math.hpp"

namespace cairn {

/// How a camera reads its picture out: time from one row to the one below it, and from one column
/// to the one right of it, s. Both 0: all at once (a global shutter). A picture that was turned by
/// 90 degrees is read by columns; one that is played backwards has negative times.
struct ReadoutTimes {
  float row_time_s = 0.0F;
  float column_time_s = 0.0F;

  static constexpr float kLongest_s = 0.2F;  ///< of a whole picture

  bool instant() const { return row_time_s == 0.0F && column_time_s == 0.0F; }
  /// kBadConfig unless both are finite and a picture takes kLongest_s at most.
  Status validate(int width, int height) const {
    const float rows_s = row_time_s * static_cast<float>(height);
    const float columns_s = column_time_s * static_cast<float>(width);
    const bool good =
        is_finite(rows_s) && is_finite(columns_s) && abs(rows_s) + abs(columns_s) <= kLongest_s;
    return good ? Status::kOk : Status::kBadConfig;
  }
};

/// What the camera's movement does to a picture that is read out row by row: a pixel is exposed
/// (y - middle) row times, and (x - middle) column times, after the frame's time, which is that of
/// the middle. For so long the velocity counts as constant. With a global shutter nothing changes
/// by a bit. Directions are (x / z, y / z). Cost: one rotation a direction.
class RollingShutter {
 public:
  /// Starts anew, at rest. Domain: valid times.
  void reset(const ReadoutTimes& times, int width, int height) {
    *this = RollingShutter();
    times_s_ = Vector2<float>(times.column_time_s, times.row_time_s);
    middle_ = 0.5F * Vector2<float>(static_cast<float>(width - 1), static_cast<float>(height - 1));
  }
  /// In the camera's axes points move by p <- Exp(turn dt) p + velocity dt.
  void set_motion(const Vector3<float>& turn_radps, const Vector3<float>& velocity) {
    turn_radps_ = turn_radps;
    velocity_ = velocity;
    moves_ = true;
  }
  void forget_motion() {
    turn_radps_ = velocity_ = Vector3<float>::Zero();
    moves_ = false;
  }
  /// Of the picture of this frame, once the movement to the next one is known: a velocity in the
  /// middle of both, where a frame's own is that of the way to it.
  RollingShutter with_next(const RollingShutter& next) const {
    RollingShutter both = next;
    if (moves_ && next.moves_) {
      both.turn_radps_ = 0.5F * (turn_radps_ + next.turn_radps_);
      both.velocity_ = 0.5F * (velocity_ + next.velocity_);
    }
    return both;
  }
  bool used() const { return times_s_.x() != 0.0F || times_s_.y() != 0.0F; }

  /// What a pixel sees along `seen`, at an inverse depth in the camera: where the camera would see
  /// it at the frame's time.
  Vector2<float> at_frame_time(const Vector2<float>& seen, const Vector2<float>& pixel,
                               float inverse_depth) const {
    return used() ? moved(seen, -exposed_s(pixel), inverse_depth) : seen;
  }
  /// The other way: where that pixel's moment shows what the camera sees along `direction` at the
  /// frame's time.
  Vector2<float> at_pixel_time(const Vector2<float>& direction, const Vector2<float>& pixel,
                               float inverse_depth) const {
    return used() ? moved(direction, exposed_s(pixel), inverse_depth) : direction;
  }

 private:
  float exposed_s(const Vector2<float>& pixel) const { return times_s_.dot(pixel - middle_); }
  Vector2<float> moved(const Vector2<float>& from, float dt_s, float inverse_depth) const {
    constexpr float kLeastDepth = 0.05F;  // relative; behind it a direction stays as it is
    const Vector3<float> p = rotation_exp(Vector3<float>(turn_radps_ * dt_s)) *
                                 Vector3<float>(from.x(), from.y(), 1.0F) +
                             velocity_ * (inverse_depth * dt_s);
    return p.z() > kLeastDepth ? Vector2<float>(p.x() / p.z(), p.y() / p.z()) : from;
  }

  Vector2<float> times_s_ = Vector2<float>::Zero();  ///< of a column, of a row
  Vector2<float> middle_ = Vector2<float>::Zero();
  Vector3<float> turn_radps_ = Vector3<float>::Zero();
  Vector3<float> velocity_ = Vector3<float>::Zero();
  bool moves_ = false;  ///< the movement is known
};

}  // namespace cairn

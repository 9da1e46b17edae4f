#pragma once

#include <cstdint>

#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/vision/image.hpp"

namespace cairn {

namespace work {

/// YawCheck::add(), in units.
inline constexpr int kYawCheck = 60;

}  // namespace work

/// What odometry says of the way since the frame before.
struct ToldYaw {
  float heading = 0.0F;   ///< odometry's own at the frame, from any start, rad
  float variance = 0.0F;  ///< of what it turned since the frame before, rad^2
  float speed_mps = 0.0F;
  float step_s = 0.0F;  ///< since the frame before
};

/// Watches whether odometry turns as the pictures do, without a map and whether tracking holds or
/// not: a yaw rate in degrees, or of the wrong sign, makes every window of the search a wrong one.
///
/// The columns of the picture's middle rows are summed up to a profile; a turn shifts it. What the
/// vehicle passes on its way moves from the middle to both sides, and shifts the profile's middle
/// half by little: less the farther it is, which the camera's height stands for. Only for cameras
/// that look along the way, ahead or back.
class YawCheck {
 public:
  static constexpr int kBins = 64;

  /// Starts anew. `camera_height_m`: above the ground, > 0.
  void reset(const PinholeCamera<float>& camera, const Rigid<float>& T_vehicle_camera);

  /// Compares a frame with the one before. Domain: valid image of that camera. Cost:
  /// work::kYawCheck.
  void add(const ImageView& image, const ToldYaw& told);
  /// Nothing is known of the way to the next frame: it has none before it.
  void skip() { has_profile_ = false; }

  /// Whether, for a second, odometry turned otherwise than the pictures by more than its noise and
  /// the pictures' own error; until it turned as they do for as long.
  bool suspect() const { return suspect_; }
  /// Yaw rate of the odometry over that of the pictures: -1 where the sign is wrong, 57 for
  /// degrees. 0: not known.
  float ratio() const;

 private:
  struct Profile {
    std::uint8_t grey[kBins] = {};
  };

  Profile profile_of(const ImageView& image) const;
  /// By how many bins `now` lies to the right; false where it may be elsewhere as well.
  bool shift_from(const Profile& now, float& shift) const;
  int difference(const Profile& now, int shift) const;
  void compare(float seen_rad, float told_rad, const ToldYaw& told);

  Profile profile_;
  float bin_rad_ = 0.0F;  ///< of yaw, signed; 0: the camera does not look along the way
  float height_m_ = 1.0F;
  float heading_ = 0.0F;  ///< told, at the frame before
  float seen_ = 0.0F;     ///< yaw rates, low-passed, rad/s
  float told_ = 0.0F;
  float variance_ = 0.0F;  ///< of told_
  float against_s_ = 0.0F;
  float products_ = 0.0F;  ///< of told_ and seen_, faded
  float squares_ = 0.0F;
  bool has_profile_ = false;
  bool suspect_ = false;
};

}  // namespace cairn

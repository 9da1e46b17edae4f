#pragma once

#include <cstdint>

namespace cairn {

/// Watches the one length in the pictures that odometry cannot scale: the height of the camera
/// above the ground. A speed in another unit, or a height that was not measured, shows in one of
/// two ways.
///
/// Where the map takes its scale from odometry, the ground lies at another depth below the camera
/// than its height says. What stands on the ground lies above it and nothing lies below: the ground
/// is the lowest height that many landmarks share, a peak in the histogram of the logarithm of the
/// depth with almost nothing beyond. Without such a peak nothing is said, nor where it lies above
/// the ground that was told: a wall fills the picture, too, and the ground is out of view.
///
/// What lies on the vehicle's way and is driven over is ground, wherever it seems to lie: where
/// such landmarks share a height above the ground that was told, speeds are too small or the height
/// told too large.
///
/// Where the map takes its scale from the floor (FloorParameters), the distances that images show
/// differ from those of odometry.
class GroundCheck {
 public:
  /// Starts anew.
  void reset(float camera_height_m) {
    *this = GroundCheck();
    height_m_ = camera_height_m;
  }

  /// A landmark lies `below_m` below the camera; once for each.
  void note_landmark(float below_m);
  /// The same for one on the way ahead, of those to which note_way() came on.
  void note_on_way(float below_m);
  /// The vehicle moved by `ahead_m`.
  void note_way(float ahead_m);
  /// The vehicle moved by `ahead_m` by odometry, and the image added `correction_m` to it.
  void note_step(float ahead_m, float correction_m);

  /// How often the height of the camera above the ground goes into what the pictures say, by
  /// odometry's scale: 3.6 where km/h were taken for m/s, 0.8 where the camera is 20 % lower than
  /// was told. 0: not known.
  float ratio() const;
  /// Whether that is further from 1 than careful measuring and slopes leave.
  bool suspect() const;

 private:
  static constexpr int kBins = 32;

  float by_landmarks() const;
  float by_distance() const;
  float by_way() const;
  int around(int bin) const;

  std::uint8_t counts_[kBins] = {};
  std::uint8_t on_way_ = 0;   ///< landmarks on the way, each a height after the one before
  std::int16_t mean_ = 0;     ///< of the logarithm of their depth below the camera, in heights,
  std::uint16_t spread_ = 0;  ///< and its mean deviation, both in 1/4096
  std::uint16_t since_ = 0;   ///< way since the last one, in 1/8192 heights
  float height_m_ = 1.0F;
  float ahead_m_ = 0.0F;       ///< of the last while, by odometry
  float correction_m_ = 0.0F;  ///< and what images added to it
};

}  // namespace cairn

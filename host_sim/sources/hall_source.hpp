#pragma once

#include <memory>
#include <optional>

#include "host_sim/sources/frame_source.hpp"

namespace cairn::host {

struct HallOptions {
  int width = 640;                 ///< the height is 3/4 of it; the field of view stays the same
  std::optional<int> frame_count;  ///< default 2,387: paper A's video, one lap
  int first_frame = 0;
  std::uint64_t seed = 1;
  double tilt_rad = 0.0;    ///< rms of pitch and roll; 0: a flat floor and a stiff vehicle
  bool colour = false;      ///< gives Frame::colour too
  bool base_noise = false;  ///< odometry noise `base` instead of `s1`
};

/// The built-in hall, driven in laps of 80 s at 0.55 m/s, filmed at 30 Hz.
///
/// Camera: f = 500 px at 640x480, 0.35 m ahead of the rear axle, 1.0 m above the floor, looking
/// forward and 4 degrees down. Odometry: Ackermann, one sample a frame, wheelbase 0.5 m; noise of
/// the density that 0.1 m/s and 5 degrees (s1), or 0.05 m/s and 2 degrees (base), have at 10 Hz, so
/// sqrt(3) times as much in a sample of 1/30 s. With `tilt_rad` the body pitches and rolls, a
/// Gauss-Markov process of that rms which returns to level in 0.5 s, and the source says so.
/// Everything is a function of the seed.
std::unique_ptr<FrameSource> make_hall_source(const HallOptions& options);

}  // namespace cairn::host

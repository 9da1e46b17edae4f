#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace cairn::host {

/// What a real camera does to the ideal picture: lens blur (3x3), slow exposure change, read-out
/// noise, eight bits.
class Sensor {
 public:
  struct Settings {
    double noise_sigma = 2.0;      ///< grey levels
    double exposure_swing = 0.12;  ///< relative
    double exposure_period_s = 27.0;
    std::uint64_t seed = 1;

    static Settings with_seed(std::uint64_t seed) {
      Settings settings;
      settings.seed = seed;
      return settings;
    }
  };

  explicit Sensor(const Settings& settings);

  /// `ideal`: CV_16UC1, intensity * 16. `grey`: CV_8UC1. The noise depends on seed, frame number
  /// and pixel alone.
  void expose(const cv::Mat& ideal, int frame_number, double t_s, cv::Mat& grey);

 private:
  Settings settings_;
  std::vector<std::int16_t> noise_;  ///< drawn once, * 16; each row of a frame reads a random run
  std::vector<std::uint16_t> row_sums_[3];
};

}  // namespace cairn::host

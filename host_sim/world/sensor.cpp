#include "host_sim/world/sensor.hpp"

#include <algorithm>

#include "cairn/numeric/math.hpp"
#include "cairn/numeric/random.hpp"

#include "host_sim/world/gaussian.hpp"

namespace cairn::host {
namespace {

constexpr int kNoiseCount = 1 << 18;

/// Binomial-like weights (1, 4, 1) / 6 along the row, scaled by 6.
void sum_row(const std::uint16_t* source, int width, std::uint16_t* sums) {
  sums[0] = static_cast<std::uint16_t>(5 * source[0] + source[1]);
  for (int x = 1; x < width - 1; ++x) {
    sums[x] = static_cast<std::uint16_t>(source[x - 1] + 4 * source[x] + source[x + 1]);
  }
  sums[width - 1] = static_cast<std::uint16_t>(5 * source[width - 1] + source[width - 2]);
}

}  // namespace

Sensor::Sensor(const Settings& settings) : settings_(settings) {
  GaussianRandom random(settings.seed ^ 0x5e4504ULL);
  noise_.resize(kNoiseCount);
  for (std::int16_t& value : noise_) {
    value = static_cast<std::int16_t>(round_to_int(random.normal(16.0 * settings.noise_sigma)));
  }
}

void Sensor::expose(const cv::Mat& ideal, int frame_number, double t_s, cv::Mat& grey) {
  CV_Assert(ideal.type() == CV_16UC1 && ideal.cols >= 2 && ideal.rows >= 2);
  grey.create(ideal.size(), CV_8UC1);
  double sine = 0.0;
  double cosine = 0.0;
  sin_cos(wrap_angle(kTwoPi<double> * t_s / settings_.exposure_period_s), sine, cosine);
  const double gain = 1.0 + settings_.exposure_swing * sine;
  // Sums carry 36 * 16; after * scale >> 16 the value carries 16.
  const int scale = static_cast<int>(gain * 65536.0 / 36.0);
  Random random(settings_.seed * 1000003ULL + static_cast<std::uint64_t>(frame_number));
  const int width = ideal.cols;
  for (auto& sums : row_sums_) sums.resize(static_cast<std::size_t>(width));
  sum_row(ideal.ptr<std::uint16_t>(0), width, row_sums_[0].data());
  row_sums_[2] = row_sums_[0];
  for (int y = 0; y < ideal.rows; ++y) {
    const int below = std::min(y + 1, ideal.rows - 1);
    sum_row(ideal.ptr<std::uint16_t>(below), width, row_sums_[(y + 1) % 3].data());
    const std::uint16_t* a = row_sums_[(y + 2) % 3].data();
    const std::uint16_t* b = row_sums_[y % 3].data();
    const std::uint16_t* c = row_sums_[(y + 1) % 3].data();
    const std::int16_t* noise = &noise_[random.below(kNoiseCount - width)];
    std::uint8_t* out = grey.ptr<std::uint8_t>(y);
    for (int x = 0; x < width; ++x) {
      const int sum = a[x] + 4 * b[x] + c[x];
      const int value = ((sum * scale) >> 16) + noise[x] + 8;
      out[x] = static_cast<std::uint8_t>(std::clamp(value >> 4, 0, 255));
    }
  }
}

}  // namespace cairn::host

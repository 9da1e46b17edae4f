#pragma once

#include <cstddef>
#include <cstdint>

#include "cairn/vision/freak.hpp"

#include "freak_tables.hpp"
#include "lanes.hpp"

namespace cairn::vision {

inline constexpr int kRings = 7;
inline constexpr int kPointsPerRing = 6;
inline constexpr int kFreakPoints = kRings * kPointsPerRing + 1;
inline constexpr int kMaxScaleIndex = 24;

/// Pixel positions are Q18: fine enough to round as OpenCV's float arithmetic does, and 4,096
/// pixels still fit into 31 bits.
inline constexpr int kPositionBits = 18;
inline constexpr std::int32_t kOnePixel = 1 << kPositionBits;
/// A turn in steps of the cosine table; an orientation bin is three of them.
inline constexpr int kTurn = 768;
inline constexpr int kStepsPerBin = kTurn / 256;

/// kRingRadius[ring] * 2^(scale_index / 16) / 2^halvings, Q18.
inline std::int32_t scaled_radius(int ring, int scale_index, int halvings) {
  const int shift = 39 + halvings - (scale_index >> 4);
  const std::int64_t product =
      static_cast<std::int64_t>(kRingRadius[ring]) * kScaleStep[scale_index & 15];
  return static_cast<std::int32_t>((product + (std::int64_t{1} << (shift - 1))) >> shift);
}

inline std::int32_t cosine_q30(int step) {
  if (step >= kTurn / 2) step = kTurn - step;
  return step <= kTurn / 4 ? kQuarterCosine[step] : -kQuarterCosine[kTurn / 2 - step];
}

/// value * factor / 2^30, rounded; |value| below 2^29.
inline std::int32_t multiply_q30(std::int32_t value, std::int32_t factor) {
  const std::int64_t product = static_cast<std::int64_t>(value * 4) * factor;
  return static_cast<std::int32_t>((product + (std::int64_t{1} << 31)) >> 32);
}

/// Nearest pixel, halves to the even one.
inline int round_half_even(std::int32_t v) {
  return (v + (kOnePixel / 2 - 1) + ((v >> kPositionBits) & 1)) >> kPositionBits;
}

/// Rounds a position to what a float can hold: from 256 px on its last bit is above 2^-18.
inline std::int32_t round_as_float(std::int32_t v) {
  const int shift = 8 - __builtin_clz(static_cast<std::uint32_t>(v));
  if (shift <= 0) return v;
  const std::int32_t half = (1 << (shift - 1)) - 1 + ((v >> shift) & 1);
  return ((v + half) >> shift) << shift;
}

/// First pixel and first pixel beyond of a box along one axis.
struct Interval {
  int begin;
  int end;
};

/// The box [centre + offset - reach, centre + offset + reach] along one axis, as OpenCV rounds it.
/// It adds in float, where two things show. Far from the origin every sum is rounded to the float's
/// grid: followed here step by step. Nearer, only one tie ever falls on the other side (ring 4,
/// offset - reach = -5.5 px, coordinates just above a power of two). That these two rules are all,
/// for every orientation and coordinate up to 4,096 at scale index 0, freak_geometry_test shows.
class AxisRounder {
 public:
  explicit AxisRounder(int coordinate)
      : centre_(coordinate * kOnePixel),
        far_(coordinate >= kFarCoordinate),
        odd_tie_(coordinate == 37 || coordinate == 68 || coordinate == 133 || coordinate == 260 ||
                 coordinate == 517) {}

  Interval box(std::int32_t offset, std::int32_t reach, int ring) const {
    const std::int32_t position = centre_ + offset;
    if (far_) return far_box(position, reach);
    Interval interval{round_half_even(position - reach),
                      round_half_even(position + reach + kOnePixel)};
    if (odd_tie_ && ring == 4) {
      const std::int32_t edge = position - reach;
      if ((edge & (kOnePixel - 1)) == kOnePixel / 2) interval.begin = (edge >> kPositionBits) | 1;
    }
    return interval;
  }

 private:
  /// From here on the pattern at scale index 0 can reach 1,024 px.
  static constexpr int kFarCoordinate = 1000;

  static Interval far_box(std::int32_t position, std::int32_t reach) {
    position = round_as_float(position);
    return {round_half_even(round_as_float(position - reach)),
            round_half_even(round_as_float(round_as_float(position + reach) + kOnePixel))};
  }

  std::int32_t centre_;
  bool far_;
  bool odd_tie_;
};

/// Mean grey values of the 43 points, rounded.
struct FreakMeans {
  std::uint8_t value[kFreakPoints + 1];
};

/// Samples the pattern. The boxes lie inside the image by the caller's margin test, which also
/// leaves a row below the lowest box: box_sum's reading past a box's edge stays inside the image.
template <class Lanes>
class FreakSampler {
 public:
  FreakSampler(const ImageView& image, int x, int y, int scale_index)
      : image_(image), x_(x), y_(y), scale_index_(scale_index) {}

  void sample(int orientation_bin, FreakMeans& means) const {
    // Point k + 3 of a ring lies opposite to point k, and odd rings are turned by 64 steps: six
    // directions serve all points.
    std::int32_t cosine[kPointsPerRing];
    std::int32_t sine[kPointsPerRing];
    for (int k = 0; k < kPointsPerRing; ++k) {
      int step = kStepsPerBin * orientation_bin + k * (kTurn / 12);
      if (step >= kTurn) step -= kTurn;
      cosine[k] = cosine_q30(step);
      sine[k] = cosine_q30(step >= kTurn / 4 ? step - kTurn / 4 : step + kTurn * 3 / 4);
    }
    std::uint8_t* out = means.value;
    std::int32_t reach = 0;
    for (int ring = 0; ring < kRings; ++ring, out += kPointsPerRing) {
      const std::int32_t radius = scaled_radius(ring, scale_index_, 0);
      reach = scaled_radius(ring, scale_index_, 1);
      for (int k = 0; k < kPointsPerRing / 2; ++k) {
        const int direction = 2 * k + (ring & 1);
        const std::int32_t dx = multiply_q30(radius, cosine[direction]);
        const std::int32_t dy = multiply_q30(radius, sine[direction]);
        out[k] = mean(dx, dy, reach, ring);
        out[k + kPointsPerRing / 2] = mean(-dx, -dy, reach, ring);
      }
    }
    *out = mean(0, 0, reach, kRings);
  }

 private:
  std::uint8_t mean(std::int32_t dx, std::int32_t dy, std::int32_t reach, int ring) const {
    const Interval x = x_.box(dx, reach, ring);
    const Interval y = y_.box(dy, reach, ring);
    const int width = x.end - x.begin;
    const int height = y.end - y.begin;
    const std::uint32_t sum =
        Lanes::box_sum(image_.row(y.begin) + x.begin, image_.stride, width, height);
    const auto area = static_cast<std::uint32_t>(width * height);
    return static_cast<std::uint8_t>((sum + area / 2) / area);
  }

  ImageView image_;
  AxisRounder x_;
  AxisRounder y_;
  int scale_index_;
};

/// Orientation bin (256 to a turn) of the gradient (dx, dy): nearest bin, 0 for the zero vector.
int orientation_bin_of(int dx, int dy);

/// Orientation bin of the sampled pattern.
int freak_orientation(const FreakMeans& means, FreakOrientation precision);

/// The 512 comparisons.
void compare_means(const FreakMeans& means, Descriptor& descriptor);

inline bool freak_fits(const ImageView& image, int x, int y, int scale_index) {
  const int margin = freak_margin(scale_index);
  return x >= margin && y >= margin && x <= image.width - margin && y <= image.height - margin;
}

template <class Lanes>
Status describe_freak_with(const ImageView& image, int x, int y, FreakOrientation precision,
                           Descriptor& descriptor, std::uint8_t& orientation_bin) {
  if (!image.valid()) return Status::kInvalidArgument;
  if (!freak_fits(image, x, y, 0)) return Status::kOutOfView;
  const FreakSampler<Lanes> sampler(image, x, y, 0);
  FreakMeans means;
  sampler.sample(0, means);
  const int bin = freak_orientation(means, precision);
  if (bin != 0) sampler.sample(bin, means);
  compare_means(means, descriptor);
  orientation_bin = static_cast<std::uint8_t>(bin);
  return Status::kOk;
}

template <class Lanes>
Status describe_freak_with(const ImageView& image, int x, int y, FreakPose pose,
                           Descriptor& descriptor) {
  if (!image.valid() || pose.scale_index > kMaxScaleIndex) return Status::kInvalidArgument;
  if (!freak_fits(image, x, y, pose.scale_index)) return Status::kOutOfView;
  FreakMeans means;
  FreakSampler<Lanes>(image, x, y, pose.scale_index).sample(pose.orientation_bin, means);
  compare_means(means, descriptor);
  return Status::kOk;
}

}  // namespace cairn::vision

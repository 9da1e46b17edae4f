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

/// Radius of a ring, Q18.
struct RingSize {
  std::int32_t radius;
  std::int32_t reach;  ///< half the width of its boxes
};
inline RingSize ring_size(int ring, int scale_index) {
  const std::uint64_t product = static_cast<std::uint64_t>(kRingRadius[ring]) *
                                static_cast<std::uint64_t>(kScaleStep[scale_index & 15]);
  const auto radius_q27 = static_cast<std::uint32_t>((product + (1U << 29U)) >> 30U);
  const auto shift = static_cast<unsigned>(9 - (scale_index >> 4));
  const std::uint32_t half = 1U << (shift - 1);
  return {static_cast<std::int32_t>((radius_q27 + half) >> shift),
          static_cast<std::int32_t>((radius_q27 + 2 * half) >> (shift + 1))};
}

inline std::int32_t cosine_q30(int step) {
  if (step >= kTurn / 2) step = kTurn - step;
  return step <= kTurn / 4 ? kQuarterCosine[step] : -kQuarterCosine[kTurn / 2 - step];
}

/// value * factor / 2^30, rounded; |value| below 2^29.
inline std::int32_t multiply_q30(std::int32_t value, std::int32_t factor) {
#if defined(__ARM_FEATURE_DSP)
  std::int32_t result = 0;
  __asm__("smmulr %0, %1, %2" : "=r"(result) : "r"(value * 4), "r"(factor));
  return result;
#else
  const std::int64_t product = static_cast<std::int64_t>(value * 4) * factor;
  return static_cast<std::int32_t>((product + (std::int64_t{1} << 31)) >> 32);
#endif
}

/// Nearest pixel, halves to the even one, of a position that has kRoundingBias added. One more
/// makes a difference only at a tie, and there the biased position still has the integer part whose
/// last bit decides.
inline constexpr std::int32_t kRoundingBias = kOnePixel / 2 - 1;
inline int round_biased(std::int32_t biased) {
  return (biased + ((biased >> kPositionBits) & 1)) >> kPositionBits;
}

/// First pixel and first pixel beyond of a box along one axis.
struct Interval {
  int begin;
  int end;
};

/// OpenCV lays the box [centre + offset - reach, centre + offset + reach] in float, which shows in
/// two cases. From where the pattern can reach 1,024 px every sum is visibly rounded to the float's
/// grid. Nearer, only one tie ever falls on the other side (ring 4, offset - reach = -5.5 px,
/// coordinates just above a power of two). That these are all, for every orientation and
/// coordinate up to 4,096 at scale index 0, freak_geometry_test shows.
inline constexpr int kFarCoordinate = 1000;
constexpr bool is_special_coordinate(int coordinate) {
  return coordinate >= kFarCoordinate || coordinate == 37 || coordinate == 68 ||
         coordinate == 133 || coordinate == 260 || coordinate == 517;
}
/// The box along one axis, with these cases.
Interval special_interval(int coordinate, std::int32_t offset, std::int32_t reach, int ring);

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
      : image_(image),
        x_(x),
        y_(y),
        scale_index_(scale_index),
        special_(is_special_coordinate(x) || is_special_coordinate(y)) {}

  void sample(int orientation_bin, FreakMeans& means) const {
    // Every point lies in one of twelve directions, 64 steps apart.
    std::int32_t cosine[kDirections];
    std::int32_t sine[kDirections];
    for (int k = 0; k < kDirections / 2; ++k) {
      int step = kStepsPerBin * orientation_bin + k * (kTurn / kDirections);
      if (step >= kTurn) step -= kTurn;
      cosine[k] = cosine_q30(step);
      cosine[k + kDirections / 2] = -cosine[k];
      sine[k] = cosine_q30(step >= kTurn / 4 ? step - kTurn / 4 : step + kTurn * 3 / 4);
      sine[k + kDirections / 2] = -sine[k];
    }
    std::uint8_t* out = means.value;
    RingSize size{};
    for (int ring = 0; ring <= kRings; ++ring) {
      const bool centre = ring == kRings;
      size = centre ? RingSize{0, size.reach} : ring_size(ring, scale_index_);
      const Edges edges(x_, y_, size.reach);
      const int end = centre ? kRings % 2 + 1 : kDirections;
      for (int direction = ring % 2; direction < end; direction += 2) {
        const std::int32_t dx = multiply_q30(size.radius, cosine[direction]);
        const std::int32_t dy = multiply_q30(size.radius, sine[direction]);
        Box box = edges.moved(dx, dy);
        if (__builtin_expect(special_, 0)) {
          box = {special_interval(x_, dx, size.reach, ring),
                 special_interval(y_, dy, size.reach, ring)};
        }
        *out++ = mean(box);
      }
    }
  }

 private:
  static constexpr int kDirections = 2 * kPointsPerRing;

  struct Box {
    Interval x;
    Interval y;
  };
  /// Edges of a ring's box around the centre, ready to be moved and rounded.
  struct Edges {
    std::int32_t left;
    std::int32_t top;
    std::int32_t right;
    std::int32_t bottom;

    Edges(int x, int y, std::int32_t reach)
        : left(x * kOnePixel + kRoundingBias - reach),
          top(y * kOnePixel + kRoundingBias - reach),
          right(x * kOnePixel + kRoundingBias + kOnePixel + reach),
          bottom(y * kOnePixel + kRoundingBias + kOnePixel + reach) {}
    Box moved(std::int32_t dx, std::int32_t dy) const {
      return {{round_biased(left + dx), round_biased(right + dx)},
              {round_biased(top + dy), round_biased(bottom + dy)}};
    }
  };

  __attribute__((always_inline)) std::uint8_t mean(const Box& box) const {
    const int width = box.x.end - box.x.begin;
    const int height = box.y.end - box.y.begin;
    const std::uint32_t sum =
        Lanes::box_sum(image_.row(box.y.begin) + box.x.begin, image_.stride, width, height);
    const auto area = static_cast<std::uint32_t>(width * height);
    return static_cast<std::uint8_t>((sum + area / 2) / area);
  }

  ImageView image_;
  int x_;
  int y_;
  int scale_index_;
  bool special_;
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

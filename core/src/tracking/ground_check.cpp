#include "cairn/tracking/ground_check.hpp"

#include "cairn/numeric/math.hpp"

namespace cairn {
namespace {

constexpr float kBinsPerLog = 10.0F;
constexpr float kLowestLog = -1.6F;  // a fifth of the height; the highest bin ends at five
constexpr float kMostOff = 0.12F;
constexpr float kLogUnits = 4096.0F;
constexpr float kWayUnits = 8192.0F;
constexpr float kMostWay = 65535.0F;
constexpr float kLowestCamera_m = 0.02F;  // nearer to the ground, or below it, heights say nothing

/// Nothing lies below the ground; above it the true ground may be out of view.
bool is_below(float ratio) {
  return ratio > 1.0F + kMostOff;
}

/// A floor that has proven flat has no slopes: wheels and their noise are what is left.
bool is_off(float ratio) {
  constexpr float kMostOffOnFloor = 0.08F;
  return ratio > 0.0F && abs(ratio - 1.0F) > kMostOffOnFloor;
}

bool is_above(float ratio) {
  return ratio > 0.0F && ratio < 1.0F - kMostOff;
}

}  // namespace

void GroundCheck::note_landmark(float below_m) {
  constexpr int kMemory = 160;
  if (!(below_m > 0.0F) || !(height_m_ > kLowestCamera_m)) return;
  const float place = kBinsPerLog * (log(below_m / height_m_) - kLowestLog);
  if (!(place >= 0.0F) || !(place < static_cast<float>(kBins))) return;
  ++counts_[static_cast<int>(place)];
  int all = 0;
  for (const std::uint8_t count : counts_) all += count;
  if (all < kMemory) return;
  for (std::uint8_t& count : counts_) count = static_cast<std::uint8_t>(count / 2);
}

void GroundCheck::note_step(float ahead_m, float correction_m) {
  constexpr float kMemoryHeights = 20.0F;
  if (!(height_m_ > kLowestCamera_m)) return;
  const float memory_m = kMemoryHeights * height_m_;
  const float kept = memory_m / (memory_m + abs(ahead_m));
  ahead_m_ = kept * (ahead_m_ + ahead_m);
  correction_m_ = kept * (correction_m_ + correction_m);
}

void GroundCheck::note_way(float ahead_m) {
  if (!(height_m_ > kLowestCamera_m)) return;
  const float since = static_cast<float>(since_) + kWayUnits * abs(ahead_m) / height_m_;
  since_ = static_cast<std::uint16_t>(since < kMostWay ? since : kMostWay);
}

/// Landmarks a height apart: the first of a few were driven over when the last one is seen.
void GroundCheck::note_on_way(float below_m) {
  constexpr int kMemory = 8;
  constexpr float kFarthest = 4.0F;  // of the logarithm
  if (!(below_m > 0.0F) || !(height_m_ > kLowestCamera_m)) return;
  if (on_way_ > 0 && static_cast<float>(since_) < kWayUnits) return;
  since_ = 0;
  const float place = kLogUnits * clamp(log(below_m / height_m_), -kFarthest, kFarthest);
  if (on_way_ < kMemory) ++on_way_;
  const float share = 1.0F / static_cast<float>(on_way_);
  const float off = place - static_cast<float>(mean_);
  mean_ = static_cast<std::int16_t>(static_cast<float>(mean_) + share * off);
  if (on_way_ == 1) return;
  const float spread = static_cast<float>(spread_);
  spread_ = static_cast<std::uint16_t>(spread + share * (abs(off) - spread));
}

float GroundCheck::ratio() const {
  const float by_landmarks = this->by_landmarks();
  const float by_distance = this->by_distance();
  const float by_way = this->by_way();
  if (is_above(by_way) && !is_below(by_landmarks)) return by_way;
  if (is_below(by_landmarks) || !(by_distance > 0.0F)) return by_landmarks;
  return is_off(by_distance) || !(by_landmarks > 0.0F) ? by_distance : by_landmarks;
}

bool GroundCheck::suspect() const {
  return is_below(by_landmarks()) || is_off(by_distance()) || is_above(by_way());
}

/// Of a bin and its neighbours.
int GroundCheck::around(int bin) const {
  int sum = 0;
  for (int i = bin - 1; i <= bin + 1; ++i) {
    if (i >= 0 && i < kBins) sum += counts_[i];
  }
  return sum;
}

float GroundCheck::by_landmarks() const {
  constexpr int kFewest = 24;
  constexpr int kPeakShare = 3;    // one in three lies in the peak,
  constexpr int kBeyondShare = 7;  // and one for seven of these at most beyond it
  int peak = 0;
  int all = 0;
  for (int i = 0; i < kBins; ++i) {
    all += counts_[i];
    if (around(i) > around(peak)) peak = i;
  }
  int beyond = 0;
  for (int i = peak + 2; i < kBins; ++i) beyond += counts_[i];
  const int in_peak = around(peak);
  const bool is_ground =
      all >= kFewest && kPeakShare * in_peak >= all && kBeyondShare * beyond <= in_peak;
  if (!is_ground) return 0.0F;
  float sum = 0.0F;
  for (int i = peak - 1; i <= peak + 1; ++i) {
    if (i >= 0 && i < kBins) sum += static_cast<float>(counts_[i]) * (static_cast<float>(i) + 0.5F);
  }
  return exp(kLowestLog + sum / (kBinsPerLog * static_cast<float>(in_peak)));
}

/// What lies on the way and stands above the ground, or is a wall, is at no height of its own.
float GroundCheck::by_way() const {
  constexpr int kFewest = 5;
  constexpr float kMostSpread = 0.1F;
  if (on_way_ < kFewest || static_cast<float>(spread_) > kMostSpread * kLogUnits) return 0.0F;
  return exp(static_cast<float>(mean_) / kLogUnits);
}

/// Distances that a floor at the assumed height makes of the pictures are in proportion to it.
float GroundCheck::by_distance() const {
  constexpr float kFewestHeights = 3.0F;
  constexpr float kLeastShare = 0.2F;  // shorter by more is no scale: the images went another way
  if (!(ahead_m_ > kFewestHeights * height_m_)) return 0.0F;
  const float shown_m = ahead_m_ + correction_m_;
  return shown_m > kLeastShare * ahead_m_ ? ahead_m_ / shown_m : 0.0F;
}

}  // namespace cairn

#include "cairn/tracking/yaw_check.hpp"

#include "cairn/numeric/math.hpp"

namespace cairn {
namespace {

constexpr int kRowStep = 24;
constexpr int kMostShift = YawCheck::kBins / 4;
constexpr float kWindow_s = 0.5F;

}  // namespace

void YawCheck::reset(const PinholeCamera<float>& camera, const Rigid<float>& T_vehicle_camera) {
  constexpr float kLeast = 0.7F;
  *this = YawCheck();
  const Matrix3<float> R = T_vehicle_camera.rotation.toRotationMatrix();
  const float upright = -R(2, 1);
  const int bin_px = camera.width / kBins;
  if (abs(R(0, 2)) > kLeast && abs(upright) > kLeast && bin_px > 0) {
    bin_rad_ = static_cast<float>(bin_px) / (camera.fx * upright);
  }
  height_m_ = T_vehicle_camera.translation.z();
}

/// Of the rows from an eighth to five eighths: the sky and the ground beside the way are left out.
YawCheck::Profile YawCheck::profile_of(const ImageView& image) const {
  Profile profile;
  const int bin_px = image.width / kBins;
  const int first = (image.width - bin_px * kBins) / 2;
  const int end = image.height * 5 / 8;
  for (int bin = 0; bin < kBins; ++bin) {
    int sum = 0;
    int count = 0;
    for (int row = image.height / 8; row < end; row += kRowStep) {
      const std::uint8_t* p =
          image.data + static_cast<std::int64_t>(row) * image.stride + first + bin * bin_px;
      for (int i = 0; i < bin_px; ++i) sum += p[i];
      count += bin_px;
    }
    profile.grey[bin] = static_cast<std::uint8_t>(count > 0 ? sum / count : 0);
  }
  return profile;
}

/// Mean absolute difference, times the bins, of the middle half of `now` and what lay `shift` bins
/// to its left; a change of the light is left out.
int YawCheck::difference(const Profile& now, int shift) const {
  constexpr int kFirst = kBins / 4;
  constexpr int kCount = kBins / 2;
  const std::uint8_t* a = now.grey + kFirst;
  const std::uint8_t* b = profile_.grey + kFirst - shift;
  int light = 0;
  for (int i = 0; i < kCount; ++i) light += a[i] - b[i];
  light /= kCount;
  int sum = 0;
  for (int i = 0; i < kCount; ++i) {
    const int d = a[i] - b[i] - light;
    sum += d < 0 ? -d : d;
  }
  return sum;
}

bool YawCheck::shift_from(const Profile& now, float& shift) const {
  constexpr int kApart = 3;
  constexpr int kShifts = 2 * kMostShift + 1;
  int differences[kShifts];
  int best = 0;
  int sum = 0;
  for (int i = 0; i < kShifts; ++i) {
    differences[i] = difference(now, i - kMostShift);
    sum += differences[i];
    if (differences[i] < differences[best]) best = i;
  }
  if (best == 0 || best == kShifts - 1) return false;
  for (int i = 0; i < kShifts; ++i) {
    const bool apart = i < best - kApart || i > best + kApart;
    if (!apart) continue;
    // A pattern that repeats fits again, but perhaps between two bins.
    const bool fits_again = 2 * kShifts * differences[i] < sum;
    if (5 * differences[best] >= 3 * differences[i] || fits_again) return false;
  }
  const int left = differences[best - 1];
  const int right = differences[best + 1];
  const int above = (left > right ? left : right) - differences[best];
  shift = static_cast<float>(best - kMostShift);
  if (above > 0) shift += 0.5F * static_cast<float>(left - right) / static_cast<float>(above);
  return true;
}

void YawCheck::add(const ImageView& image, const ToldYaw& told) {
  constexpr float kLongest_s = 0.5F;
  if (bin_rad_ == 0.0F) return;
  const Profile now = profile_of(image);
  const float told_rad = wrap_angle(told.heading - heading_);
  float shift = 0.0F;
  const bool usable = has_profile_ && told.step_s > 0.0F && told.step_s <= kLongest_s;
  if (usable && shift_from(now, shift)) compare(shift * bin_rad_, told_rad, told);
  profile_ = now;
  heading_ = told.heading;
  has_profile_ = true;
}

/// What is passed shifts the picture by less than a hundredth of the speed in camera heights: so
/// much was seen of four recordings.
void YawCheck::compare(float seen_rad, float told_rad, const ToldYaw& told) {
  constexpr float kError_radps = 0.1F;
  constexpr float kPassing = 0.01F;
  constexpr float kSigmas = 4.0F;
  constexpr float kLowest_m = 0.05F;
  constexpr float kSure_s = 1.0F;
  constexpr float kMemory_s = 10.0F;
  const float share = told.step_s / (told.step_s + kWindow_s);
  seen_ += share * (seen_rad / told.step_s - seen_);
  told_ += share * (told_rad / told.step_s - told_);
  variance_ = square(1.0F - share) * variance_ + square(share / told.step_s) * told.variance;
  const float height_m = height_m_ > kLowest_m ? height_m_ : kLowest_m;
  const float error =
      kError_radps + kPassing * abs(told.speed_mps) / height_m + kSigmas * sqrt(variance_);
  const bool differs = abs(told_ - seen_) > error;
  if (!differs && abs(seen_) < error) return;  // where nothing turns, nothing is told
  const float kept = kMemory_s / (kMemory_s + told.step_s);
  products_ = kept * products_ + told_ * seen_ * told.step_s;
  squares_ = kept * squares_ + seen_ * seen_ * told.step_s;
  against_s_ = clamp(against_s_ + (differs ? told.step_s : -told.step_s), 0.0F, 2.0F * kSure_s);
  suspect_ = against_s_ > (suspect_ ? 0.0F : kSure_s);
}

float YawCheck::ratio() const {
  constexpr float kLeast = 0.01F;  // a tenth of a rad/s for a second
  return squares_ > kLeast ? products_ / squares_ : 0.0F;
}

}  // namespace cairn

#include "cairn/tracking/gyro_calibration.hpp"

#include "cairn/numeric/math.hpp"

namespace cairn {
namespace {

constexpr float kLongestWay_s = 0.3F;
constexpr float kLeastWay_rad = 0.02F;
constexpr int kLeastWays = 3;  // before anything is said
constexpr int kSmoothedWays = 16;
constexpr float kStrike = 0.25F;  // share of a way that contradicts
constexpr float kAgree = 0.3F;
constexpr float kDoubt = 0.6F;  // trust is lost
constexpr float kContradict = 1.1F;
constexpr float kPictureTime_s = 0.002F;  // of a picture that is not taken at once
constexpr float kLargestOffset_s = 0.1F;
constexpr float kLargestScale = 0.3F;
constexpr float kLargestBias = 10.0F;  // of the sigma at the start

}  // namespace

void GyroCalibration::Stretch::begin(const SeenAttitude& at, const Vector3<float>& rate_then) {
  *this = Stretch();
  begun = true;
  seen = at.R_world_camera;
  variance = at.variance;
  rate = rate_then;
}

void GyroCalibration::Stretch::add(const GyroTurn& turn) {
  const Quaternion<float> step = rotation_exp(turn.rotation);
  turned = turned * step;
  turned.coeffs() *= 1.0F / sqrt(turned.squaredNorm());
  by_bias = (step.conjugate().toRotationMatrix() * by_bias).eval();
  for (int i = 0; i < 3; ++i) by_bias(i, i) += turn.seconds;
  seconds += turn.seconds;
  noise += turn.variance;
}

void GyroCalibration::reset(const GyroParameters& parameters) {
  *this = GyroCalibration();
  parameters_ = parameters;
  for (int i = 0; i < 3; ++i) covariance_(i, i) = square(parameters.bias_sigma_radps);
  covariance_(3, 3) = square(parameters.time_sigma_s);
  covariance_(4, 4) = square(parameters.scale_sigma);
}

void GyroCalibration::skip() {
  stretch_.begun = way_.begun = false;
}

void GyroCalibration::age(float seconds) {
  for (int i = 0; i < 3; ++i) covariance_(i, i) += square(parameters_.bias_walk) * seconds;
  covariance_(4, 4) += square(parameters_.scale_sigma) * seconds;  // as the view of a lens changes
}

float GyroCalibration::largest_bias_variance() const {
  float largest = covariance_(0, 0);
  for (int i = 1; i < 3; ++i) largest = covariance_(i, i) > largest ? covariance_(i, i) : largest;
  return largest;
}

bool GyroCalibration::add(const GyroTurn& turn, const SeenAttitude& seen) {
  bool changed = false;
  if (!turn.known) skip();
  if (way_.begun) {
    way_.add(turn);
    compare(seen);
  } else {
    way_.begin(seen, turn.rate_after);
  }
  if (stretch_.begun) {
    stretch_.add(turn);
    if (stretch_.seconds >= kStretch_s) {
      changed = trust_ != GyroTrust::kContradicted && estimate(turn, seen);
      stretch_.begin(seen, turn.rate_after);
    }
  } else {
    stretch_.begin(seen, turn.rate_after);
  }
  return changed;
}

/// At the end of a way. A turn no larger than the pictures' noise says nothing.
void GyroCalibration::compare(const SeenAttitude& seen) {
  const Vector3<float> v = rotation_log(way_.seen.conjugate() * seen.R_world_camera);
  const Vector3<float> g = rotation_log(way_.turned);
  const float larger = v.squaredNorm() > g.squaredNorm() ? v.squaredNorm() : g.squaredNorm();
  const bool enough =
      larger > square(kLeastWay_rad) && larger > 9.0F * (way_.variance + seen.variance);
  if (!enough && way_.seconds < kLongestWay_s) return;
  if (enough) {
    ways_ += ways_ < 1000000 ? 1 : 0;
    const float difference = (v - g).squaredNorm() / larger;
    float share = 1.0F / static_cast<float>(ways_ < kSmoothedWays ? ways_ : kSmoothedWays);
    // About an axis that it is right about by chance it would be believed for long.
    if (difference > 1.0F && share < kStrike) share = kStrike;
    difference_ += share * (difference - difference_);
    products_ += share * (v * g.transpose() / larger - products_);
    judge();
  }
  way_.begin(seen, Vector3<float>::Zero());
}

void GyroCalibration::judge() {
  if (ways_ < kLeastWays) return;
  if (difference_ > kContradict) {
    trust_ = GyroTrust::kContradicted;
  } else if (difference_ < kAgree) {
    trust_ = GyroTrust::kAgrees;
  } else if (difference_ > kDoubt && trust_ == GyroTrust::kAgrees) {
    trust_ = GyroTrust::kUnproven;
  }
}

/// Kalman update by the three rows of what the gyroscope leaves of the pictures' turn.
bool GyroCalibration::estimate(const GyroTurn& turn, const SeenAttitude& seen) {
  constexpr float kGate = 25.0F;
  const Quaternion<float> back = stretch_.turned.conjugate();
  const Vector3<float> total = rotation_log(stretch_.turned);
  Vector3<float> left = rotation_log(back * (stretch_.seen.conjugate() * seen.R_world_camera));
  const Vector3<float> by_offset = turn.rate_after - back * stretch_.rate;
  const float noise =
      stretch_.noise + stretch_.variance + seen.variance +
      square(kPictureTime_s) * (turn.rate_after.squaredNorm() + stretch_.rate.squaredNorm()) +
      (square(parameters_.scale_sigma) + square(seen.lens_sigma)) * total.squaredNorm();
  if (!scaled_) covariance_(4, 4) += square(seen.focal_sigma) + square(seen.lens_sigma);
  Vector<float, 5> rows[3];
  for (int i = 0; i < 3; ++i) {
    rows[i].head<3>() = -stretch_.by_bias.row(i).transpose();
    rows[i](3) = by_offset(i);
    rows[i](4) = total(i);
    left(i) -= total(i) * scale_;
    const float s = rows[i].dot(covariance_ * rows[i]) + noise;
    if (!(square(left(i)) < kGate * s)) return false;
  }
  scaled_ = true;
  Vector<float, 5> step = Vector<float, 5>::Zero();
  for (int i = 0; i < 3; ++i) {
    const Vector<float, 5> across = covariance_ * rows[i];
    const float s = rows[i].dot(across) + noise;
    const Vector<float, 5> gain = across / s;
    step += gain * (left(i) - rows[i].dot(step));
    covariance_ -= (gain * across.transpose()).eval();
  }
  covariance_ = (0.5F * (covariance_ + covariance_.transpose())).eval();
  const float most = kLargestBias * parameters_.bias_sigma_radps;
  for (int i = 0; i < 3; ++i) bias_(i) = clamp(bias_(i) + step(i), -most, most);
  scale_ = clamp(scale_ + step(4), -kLargestScale, kLargestScale);
  offset_s_ = clamp(offset_s_ + step(3), -kLargestOffset_s, kLargestOffset_s);
  return true;
}

}  // namespace cairn

#include "cairn/tracking/mount_evidence.hpp"

#include "cairn/geometry/detail/spd_inverse.hpp"
#include "cairn/numeric/math.hpp"

namespace cairn {
namespace {

constexpr float kMemory_s = 30.0F;
constexpr float kPriorSigma = 0.2F;    // of each part: keeps unobserved parts near 0
constexpr float kOutlierShare = 2.0F;  // a pair with more than one in three says nothing
constexpr float kRelinearise = 0.02F;
constexpr float kLeastRows = 40.0F;
// Errors of odometry's yaw last, which makes the focal length less sure than it seems.
constexpr float kSureInSigmas[MountOffset::kParts] = {4.0F, 4.0F, 4.0F, 6.0F};
constexpr float kBoundInSigmas = 2.0F;
// What a careful calibration leaves: 1 deg of yaw and pitch, 1.5 deg of roll, 2.5 %.
constexpr float kTolerance[MountOffset::kParts] = {0.0175F, 0.0175F, 0.026F, 0.025F};

}  // namespace

void MountEvidence::reset(const Quaternion<float>& rotation_vehicle_camera, float focal_px,
                          float sigma_px) {
  *this = MountEvidence();
  assumed_ = rotation_vehicle_camera.toRotationMatrix();
  focal_px_ = focal_px;
  sigma_px_ = sigma_px;
  for (float& sigma : offset_.sigma) sigma = kPriorSigma;
}

EpipolarPair::Camera MountEvidence::camera(const Vector3<float>& origin_m) const {
  const float* offset = offset_.value;
  const Quaternion<float> turned = rotation_exp(Vector3<float>(
      offset[MountOffset::kRoll], offset[MountOffset::kPitch], offset[MountOffset::kYaw]));
  return {turned.toRotationMatrix() * assumed_, origin_m, focal_px_,
          1.0F / exp(offset[MountOffset::kFocal]), sigma_px_};
}

void MountEvidence::add(const EpipolarPair& pair, float step_s) {
  const EpipolarPair::Equations found = pair.equations();
  if (kOutlierShare * found.outliers > found.rows) return;
  Matrix3<float> motion = found.motion;
  motion.diagonal() += pair.prior_information();
  Matrix3<float> inverse;
  if (!detail::invert_spd(motion, detail::min_regular_pivot<float>(), inverse)) return;
  const Vector3<float> residual =
      found.right_motion + pair.prior_information().cwiseProduct(pair.correction());
  // Sums are taken at no offset.
  Vector3<float> nominal = residual;
  float right[kParts];
  for (int i = 0; i < kParts; ++i) {
    right[i] = found.right[i];
    for (int k = 0; k < kParts; ++k) right[i] -= found.information[i][k] * offset_.value[k];
    for (int k = 0; k < kMotions; ++k) nominal[k] -= found.mixed[i][k] * offset_.value[i];
  }

  const float keep = kMemory_s / (kMemory_s + step_s);
  for (int i = 0; i < kParts; ++i) {
    const Eigen::Map<const Vector3<float>> mixed(found.mixed[i]);
    const Vector3<float> through = inverse * mixed;
    right_[i] = keep * right_[i] + right[i] - through.dot(nominal);
    for (int k = 0; k < kParts; ++k) {
      information_[i][k] = keep * information_[i][k] + found.information[i][k] -
                           through.dot(Eigen::Map<const Vector3<float>>(found.mixed[k]));
    }
  }
  squares_ = keep * squares_ + found.squares - residual.dot(Vector3<float>(inverse * residual));
  rows_ = keep * rows_ + found.rows;
  solve();
}

void MountEvidence::solve() {
  Matrix<float, kParts, kParts> information;
  for (int i = 0; i < kParts; ++i) {
    for (int k = 0; k < kParts; ++k) information(i, k) = information_[i][k];
    information(i, i) += 1.0F / square(kPriorSigma);
  }
  Matrix<float, kParts, kParts> covariance = Matrix<float, kParts, kParts>::Zero();
  if (!detail::invert_spd(information, detail::min_regular_pivot<float>(), covariance)) return;
  bool moved = false;
  const float spread = rows_ > 0.0F && squares_ > rows_ ? sqrt(squares_ / rows_) : 1.0F;
  for (int i = 0; i < kParts; ++i) {
    float value = 0.0F;
    for (int k = 0; k < kParts; ++k) value -= covariance(i, k) * right_[k];
    const float sigma = spread * sqrt(covariance(i, i));
    offset_.value[i] = clamp(value, -2.0F * kPriorSigma, 2.0F * kPriorSigma);
    offset_.sigma[i] = sigma;
    moved = moved || abs(offset_.value[i] - linearised_[i]) > kRelinearise + sigma;
    const float size = abs(value);
    const bool sure =
        size > kSureInSigmas[i] * sigma && size - kBoundInSigmas * sigma > kTolerance[i];
    // What was told holds until it is excluded: a turn, say, shows less of the yaw.
    const bool still = offset_.suspect[i] && size + kBoundInSigmas * sigma > kTolerance[i];
    offset_.suspect[i] = rows_ >= kLeastRows && (sure || still);
  }
  if (moved) relinearise();
}

/// Sums taken far from the offset of now say little about it: they count half.
void MountEvidence::relinearise() {
  for (int i = 0; i < kParts; ++i) {
    linearised_[i] = offset_.value[i];
    right_[i] *= 0.5F;
    for (int k = 0; k < kParts; ++k) information_[i][k] *= 0.5F;
  }
  squares_ *= 0.5F;
  rows_ *= 0.5F;
}

}  // namespace cairn

#include "cairn/tracking/mount_evidence.hpp"

#include "cairn/geometry/detail/spd_inverse.hpp"
#include "cairn/numeric/math.hpp"

namespace cairn {
namespace {

constexpr float kMemory_s = 30.0F;
constexpr float kPriorSigma = 0.2F;  // of each part: keeps unobserved parts near 0
constexpr float kHuber = 2.0F;       // in sigmas
constexpr float kOutlier = 4.0F;
constexpr float kOutlierShare = 2.0F;  // a pair with more than one in three says nothing
constexpr float kRelinearise = 0.02F;
constexpr float kLeastRows = 40.0F;
constexpr float kSureInSigmas = 4.0F;
constexpr float kBoundInSigmas = 2.0F;
// What a careful calibration leaves: 1 deg of yaw and pitch, 1.5 deg of roll, 2.5 %.
constexpr float kTolerance[MountOffset::kParts] = {0.0175F, 0.0175F, 0.026F, 0.025F};

float dot2(const Vector3<float>& a, const Vector3<float>& b) {
  return a.x() * b.x() + a.y() * b.y();
}

}  // namespace

void MountEvidence::reset(const Quaternion<float>& rotation_vehicle_camera, float focal_px,
                          float sigma_px) {
  *this = MountEvidence();
  assumed_ = rotation_vehicle_camera.toRotationMatrix();
  focal_px_ = focal_px;
  sigma_px_ = sigma_px;
  for (float& sigma : offset_.sigma) sigma = kPriorSigma;
}

void MountEvidence::begin_pair(const Rigid<float>& T_second_first, const Vector3<float>& camera_m,
                               const float (&sigma_motion)[kMotions]) {
  pair_ = Pair();
  const float* offset = offset_.value;
  const Quaternion<float> turned = rotation_exp(Vector3<float>(
      offset[MountOffset::kRoll], offset[MountOffset::kPitch], offset[MountOffset::kYaw]));
  pair_.rotation_vehicle_camera = turned.toRotationMatrix() * assumed_;
  pair_.scale = 1.0F / exp(offset[MountOffset::kFocal]);
  const Matrix3<float> R_second_first = T_second_first.rotation.toRotationMatrix();
  const Matrix3<float> to_camera = pair_.rotation_vehicle_camera.transpose();
  pair_.R = to_camera * R_second_first * pair_.rotation_vehicle_camera;
  pair_.t = to_camera * (R_second_first * camera_m + T_second_first.translation - camera_m);
  for (int i = 0; i < kMotions; ++i) pair_.variance[i] = square(sigma_motion[i]);
}

float MountEvidence::flow_px(const TwoViews& views) const {
  const Vector3<float> turned = pair_.R * ray(views.first);
  if (!(turned.z() > 0.1F)) return 0.0F;
  const Vector3<float> second = ray(views.second);
  const float x = turned.x() / turned.z() - second.x();
  const float y = turned.y() / turned.z() - second.y();
  return focal_px_ / pair_.scale * sqrt(x * x + y * y);
}

/// Of e = second . (t x R first), divided by the length of its gradient by the four image
/// coordinates. Before the motion is refined only its derivatives are needed. False where the views
/// lie at the direction of travel, which leaves no line.
bool MountEvidence::row_of(const TwoViews& views, Row& row) const {
  const Vector3<float> first = ray(views.first);
  const Vector3<float> second = ray(views.second);
  const Vector3<float> turned = pair_.R * first;
  const Vector3<float> normal = second.cross(pair_.t);
  const Vector3<float> line = pair_.t.cross(turned);
  const Matrix3<float> back = pair_.R.transpose();
  const Vector3<float> line_first = back * normal;
  const float squared = dot2(line, line) + dot2(line_first, line_first);
  if (!(squared > 1e-12F)) return false;
  const float to_px = focal_px_ / (pair_.scale * sqrt(squared));
  row.residual_px = to_px * turned.dot(normal);

  // Of the residual, by the changes of e and of both lines.
  const auto derivative = [&](float e, const Vector3<float>& d_line,
                              const Vector3<float>& d_line_first) {
    const float d_length = (dot2(line, d_line) + dot2(line_first, d_line_first)) / squared;
    return to_px * e - row.residual_px * d_length;
  };
  for (int i = 0; i < kMotions; ++i) {
    const Vector3<float> axis = pair_.rotation_vehicle_camera.row(i).transpose();
    const Vector3<float> d_turned = axis.cross(turned);
    row.by[kParts + i] =
        derivative(d_turned.dot(normal), pair_.t.cross(d_turned), -(back * axis.cross(normal)));
  }
  if (!pair_.refined) return true;
  constexpr int kAxis[3] = {2, 1, 0};  // of yaw, pitch, roll
  for (int i = 0; i < 3; ++i) {
    const Vector3<float> axis = pair_.rotation_vehicle_camera.row(kAxis[i]).transpose();
    const Vector3<float> d_t = pair_.t.cross(axis);
    const Vector3<float> d_turned = pair_.R * axis.cross(first) - axis.cross(turned);
    const Vector3<float> d_normal = second.cross(d_t);
    row.by[i] = derivative(d_turned.dot(normal) + turned.dot(d_normal),
                           d_t.cross(turned) + pair_.t.cross(d_turned),
                           back * (axis.cross(normal) + d_normal) - axis.cross(line_first));
  }
  // A longer focal length makes rays narrower and pixels larger.
  const Vector3<float> d_turned = pair_.R * Vector3<float>(-first.x(), -first.y(), 0.0F);
  const Vector3<float> d_normal = Vector3<float>(-second.x(), -second.y(), 0.0F).cross(pair_.t);
  row.by[MountOffset::kFocal] =
      row.residual_px + derivative(d_turned.dot(normal) + turned.dot(d_normal),
                                   pair_.t.cross(d_turned), back * d_normal);
  return true;
}

void MountEvidence::add(const TwoViews& views) {
  Row row;
  if (!row_of(views, row)) return;
  float variance = square(sigma_px_);
  for (int i = 0; i < kMotions && !pair_.refined; ++i) {
    variance += square(row.by[kParts + i]) * pair_.variance[i];
  }
  const float sigmas = abs(row.residual_px) / sqrt(variance);
  if (!(sigmas < kOutlier)) {
    pair_.outliers += 1.0F;
    return;
  }
  const float weight = (sigmas > kHuber ? kHuber / sigmas : 1.0F) / square(sigma_px_);
  float nominal_px = row.residual_px;
  for (int i = 0; i < kParts; ++i) nominal_px -= row.by[i] * offset_.value[i];
  for (int i = 0; i < kAll; ++i) {
    const float weighted = weight * row.by[i];
    pair_.right[i] += weighted * (i < kParts ? nominal_px : row.residual_px);
    for (int k = 0; k <= i; ++k) pair_.information[at(i, k)] += weighted * row.by[k];
  }
  pair_.squares += weight * square(row.residual_px);
  pair_.rows += 1.0F;
}

bool MountEvidence::motion_equations(Matrix3<float>& inverse, Vector3<float>& residual) const {
  Matrix3<float> motion;
  for (int i = 0; i < kMotions; ++i) {
    for (int k = 0; k < kMotions; ++k) {
      motion(i, k) = pair_.information[at(kParts + i, kParts + k)];
    }
    motion(i, i) += 1.0F / pair_.variance[i];
    residual[i] = pair_.right[kParts + i] + pair_.motion[i] / pair_.variance[i];
  }
  return detail::invert_spd(motion, detail::min_regular_pivot<float>(), inverse);
}

void MountEvidence::refine_motion() {
  Matrix3<float> inverse;
  Vector3<float> residual;
  if (!motion_equations(inverse, residual)) return;
  const Vector3<float> step = -(inverse * residual);
  const Matrix3<float> turn =
      rotation_exp(Vector3<float>(pair_.rotation_vehicle_camera.transpose() * step))
          .toRotationMatrix();
  pair_.motion += step;
  pair_.R = turn * pair_.R;
  for (float& value : pair_.information) value = 0.0F;
  for (float& value : pair_.right) value = 0.0F;
  pair_.squares = pair_.rows = pair_.outliers = 0.0F;
  pair_.refined = true;
}

void MountEvidence::end_pair(float step_s) {
  Matrix3<float> inverse;
  Vector3<float> residual;
  if (kOutlierShare * pair_.outliers > pair_.rows || !motion_equations(inverse, residual)) return;
  Matrix<float, kParts, kMotions> mixed;
  for (int i = 0; i < kMotions; ++i) {
    for (int k = 0; k < kParts; ++k) mixed(k, i) = pair_.information[at(kParts + i, k)];
  }

  Vector3<float> nominal = residual;  // the same at no offset, where the sums are taken
  for (int k = 0; k < kParts; ++k) nominal -= offset_.value[k] * mixed.row(k).transpose();

  const float keep = kMemory_s / (kMemory_s + step_s);
  for (int i = 0; i < kParts; ++i) {
    const Vector3<float> through = inverse * mixed.row(i).transpose();
    right_[i] = keep * right_[i] + pair_.right[i] - through.dot(nominal);
    for (int k = 0; k < kParts; ++k) {
      information_[i][k] = keep * information_[i][k] + pair_.information[at(i, k)] -
                           through.dot(Vector3<float>(mixed.row(k).transpose()));
    }
  }
  squares_ = keep * squares_ + pair_.squares - residual.dot(Vector3<float>(inverse * residual));
  rows_ = keep * rows_ + pair_.rows;
  solve();
}

void MountEvidence::solve() {
  Matrix<float, kParts, kParts> information;
  for (int i = 0; i < kParts; ++i) {
    for (int k = 0; k < kParts; ++k) information(i, k) = information_[i][k];
    information(i, i) += 1.0F / square(kPriorSigma);
  }
  Matrix<float, kParts, kParts> covariance;
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
    offset_.suspect[i] = rows_ >= kLeastRows && size > kSureInSigmas * sigma &&
                         size - kBoundInSigmas * sigma > kTolerance[i];
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

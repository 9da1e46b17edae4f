#include "cairn/tracking/mount_check.hpp"

#include "cairn/numeric/float_bits.hpp"
#include "cairn/numeric/math.hpp"

namespace cairn {
namespace {

constexpr float kEnoughFlow_px = 10.0F;
constexpr float kLeastFlow_px = 4.0F;
constexpr float kLongest_s = 2.0F;
constexpr int kFewestViews = 8;
// No floor is flatter, no wheel truer: roll, pitch and yaw of one pair of frames.
constexpr float kLeastMotionVariance = 1e-6F;

void look(const PinholeCamera<float>& camera, const Vector2<float>& pixel, FixedTangent (&ray)[2]) {
  std::uint32_t saturations = 0;
  const Vector3<float> seen = camera.unproject(pixel);
  for (int i = 0; i < 2; ++i) ray[i] = fixed_of<FixedTangent>(seen[i], saturations);
}

/// The vehicle's frame at `from`, seen from its frame at `to`.
Rigid<float> between(const PlanarPose<float>& from, const PlanarPose<float>& to) {
  const float yaw = from.heading - to.heading;
  float sine = 0.0F;
  float cosine = 0.0F;
  sin_cos(to.heading, sine, cosine);
  const Vector2<float> moved = from.position - to.position;
  return {rotation_exp(Vector3<float>(0.0F, 0.0F, yaw)),
          Vector3<float>(cosine * moved.x() + sine * moved.y(),
                         -sine * moved.x() + cosine * moved.y(), 0.0F)};
}

}  // namespace

void MountCheck::reset(const PinholeCamera<float>& camera, const Rigid<float>& T_vehicle_camera,
                       float sigma_px) {
  evidence_.reset(T_vehicle_camera.rotation, 0.5F * (camera.fx + camera.fy), sigma_px);
  camera_m_ = T_vehicle_camera.translation;
  reference_.clear();
}

void MountCheck::add(const PinholeCamera<float>& camera, const OdometryStep& step,
                     const PixelMatch<float>* matches, int count) {
  yaw_variance_ += step.yaw_variance;
  tilt_variance_ += step.tilt_variance;
  since_s_ += step.step_s;
  const bool served = compare(camera, step, matches, count);
  if (served || reference_.size() < kFewestViews || since_s_ > kLongest_s) {
    take_reference(step, matches, count);
  }
}

const MountCheck::View* MountCheck::find(LandmarkId id) const {
  for (const View& view : reference_) {
    if (view.id == static_cast<std::uint16_t>(id)) return &view;
  }
  return nullptr;
}

bool MountCheck::compare(const PinholeCamera<float>& camera, const OdometryStep& step,
                         const PixelMatch<float>* matches, int count) {
  const float sigma_tilt = sqrt(kLeastMotionVariance + tilt_variance_);
  const float sigma_motion[MountEvidence::kMotions] = {sigma_tilt, sigma_tilt,
                                                       sqrt(kLeastMotionVariance + yaw_variance_)};
  EpipolarPair pair(evidence_.camera(camera_m_), between(path_, step.path), sigma_motion);
  FixedVector<TwoViews, kMostViews> both;
  float flow_px = 0.0F;
  for (int i = 0; i < count && !both.full(); ++i) {
    const View* first = find(matches[i].id);
    if (first == nullptr) continue;
    TwoViews views;
    look(camera, first->pixel(), views.first);
    look(camera, matches[i].pixel, views.second);
    flow_px += pair.flow_px(views);
    static_cast<void>(both.push_back(views));
  }
  if (both.size() < kFewestViews) return true;
  // Views that left the picture do not come back: half of them must serve with less flow.
  const bool fading = 2 * both.size() < reference_.size();
  const float enough_px = fading ? kLeastFlow_px : kEnoughFlow_px;
  const float wanted_px = enough_px * static_cast<float>(both.size());
  if (flow_px < wanted_px) return fading;
  for (const TwoViews& views : both) pair.add(views);
  pair.refine_motion();
  flow_px = 0.0F;
  for (const TwoViews& views : both) flow_px += pair.flow_px(views);
  if (flow_px < wanted_px) return fading;
  for (const TwoViews& views : both) pair.add(views);
  evidence_.add(pair, since_s_);
  return true;
}

MountCheck::View MountCheck::view_of(const PixelMatch<float>& match) {
  const auto packed = [](float pixel) {
    return static_cast<std::uint16_t>(clamp(round_to_int(kPerPixel * pixel), 0, 65535));
  };
  return {static_cast<std::uint16_t>(match.id), packed(match.pixel.x()), packed(match.pixel.y())};
}

void MountCheck::take_reference(const OdometryStep& step, const PixelMatch<float>* matches,
                                int count) {
  reference_.clear();
  for (int i = 0; i < count && !reference_.full(); ++i) {
    static_cast<void>(reference_.push_back(view_of(matches[i])));
  }
  path_ = step.path;
  yaw_variance_ = tilt_variance_ = since_s_ = 0.0F;
}

}  // namespace cairn

#include "convert.hpp"

#include "cairn/base/health.hpp"

namespace cairn::c_api {

// The values of the C enumerations are those of the C++ ones, checked at the ends and between.
static_assert(static_cast<int>(Status::kOk) == CAIRN_OK, "values of cairn_status");
static_assert(static_cast<int>(Status::kNotInitialised) == CAIRN_NOT_INITIALISED, "cairn_status");
static_assert(static_cast<int>(Status::kNoConsensus) == CAIRN_NO_CONSENSUS, "cairn_status");
static_assert(static_cast<int>(Status::kCorrupt) == CAIRN_CORRUPT, "cairn_status");
static_assert(static_cast<int>(Status::kLost) == CAIRN_LOST, "cairn_status");
static_assert(static_cast<int>(Status::kRepeatedImage) == CAIRN_REPEATED_IMAGE, "cairn_status");
static_assert(static_cast<int>(TrackingState::kInitialising) == CAIRN_INITIALISING, "cairn_state");
static_assert(static_cast<int>(TrackingState::kTracking) == CAIRN_TRACKING, "cairn_state");
static_assert(static_cast<int>(TrackingState::kUncertain) == CAIRN_UNCERTAIN, "cairn_state");
static_assert(static_cast<int>(TrackingState::kLost) == CAIRN_STATE_LOST, "cairn_state");
static_assert(static_cast<int>(FrameCut::kNone) == CAIRN_CUT_NONE, "cairn_cut");
static_assert(static_cast<int>(FrameCut::kPredictionOnly) == CAIRN_CUT_PREDICTION_ONLY, "cut");
static_assert(static_cast<int>(Lens::kFisheye) == CAIRN_LENS_FISHEYE, "values of cairn_lens");
static_assert(kStageCount == CAIRN_STAGES, "stages of a frame");

cairn_transform to_c(const Rigid<float>& T_a_b) {
  const Quaternion<float>& q = T_a_b.rotation;
  const Vector3<float>& p = T_a_b.translation;
  return {q.w(), q.x(), q.y(), q.z(), p.x(), p.y(), p.z()};
}

Rigid<float> from_c(const cairn_transform& T_a_b) {
  return {{T_a_b.qw, T_a_b.qx, T_a_b.qy, T_a_b.qz}, {T_a_b.x, T_a_b.y, T_a_b.z}};
}

PinholeCamera<float> from_c(const cairn_camera& camera) {
  PinholeCamera<float> out;
  out.fx = camera.fx;
  out.fy = camera.fy;
  out.cx = camera.cx;
  out.cy = camera.cy;
  out.k1 = camera.k1;
  out.k2 = camera.k2;
  out.p1 = camera.p1;
  out.p2 = camera.p2;
  out.k3 = camera.k3;
  out.k4 = camera.k4;
  out.k5 = camera.k5;
  out.k6 = camera.k6;
  const auto lens = static_cast<unsigned>(camera.lens);
  out.lens = static_cast<Lens>(lens <= CAIRN_LENS_FISHEYE ? lens : 255U);  // refused by validate()
  out.width = camera.width;
  out.height = camera.height;
  return out;
}

cairn_report to_c(const FrameReport& report) {
  cairn_report out = {};
  out.t_us = report.t_us;
  out.status = to_c(report.status);
  out.state = static_cast<cairn_state>(report.state);
  out.cut = static_cast<cairn_cut>(report.cut);
  out.T_map_camera = to_c(report.T_map_camera);
  for (int i = 0; i < CAIRN_STAGES; ++i) out.stage_ticks[i] = report.stage_ticks[i];
  out.searched = report.searched;
  out.matches = report.matches;
  out.inliers = report.inliers;
  out.landmarks = report.landmarks;
  out.reactivated = report.reactivated;
  out.work = report.work;
  out.relocalised = report.relocalised;
  return out;
}

cairn_landmark to_c(std::uint32_t id, const Vector3<float>& position,
                    const Matrix3<float>& covariance, const Rigid<float>& T_world_map) {
  const Rigid<float> T_map_world = T_world_map.inverse();
  const Matrix3<float> R = T_map_world.rotation.toRotationMatrix();
  const Vector3<float> p = T_map_world * position;
  const Matrix3<float> in_map_axes = R * covariance * R.transpose();
  cairn_landmark out = {};
  out.id = id;
  for (int i = 0; i < 3; ++i) {
    out.position[i] = p[i];
    for (int k = 0; k < 3; ++k) out.covariance[3 * i + k] = in_map_axes(i, k);
  }
  return out;
}

}  // namespace cairn::c_api

const char* cairn_status_text(cairn_status status) {
  const int value = static_cast<int>(status);
  if (value < CAIRN_OK || value > CAIRN_REPEATED_IMAGE) return "unknown";
  return cairn::to_string(static_cast<cairn::Status>(value));
}

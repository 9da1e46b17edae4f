#pragma once

#include "host_sim/trackers/tracker.hpp"

namespace cairn::host {

/// Reports the true pose, moved by a fixed offset: a tracker whose every figure is known.
class TruthTracker final : public Tracker {
 public:
  explicit TruthTracker(const Rigid<double>& T_vehicle_camera) : mounting_(T_vehicle_camera) {}

  /// From this frame on the pose is `offset_m` too far north.
  void offset_from(int frame, double offset_m) {
    offset_frame_ = frame;
    offset_m_ = offset_m;
  }

  Status process(const Frame& frame, cv::Mat& overlay, FrameReport& report) override {
    Rigid<double> T_world_vehicle = *frame.true_T_world_vehicle;
    if (frame.number >= offset_frame_) T_world_vehicle.translation.y() += offset_m_;
    const Rigid<double> T_world_camera = T_world_vehicle * mounting_;
    report.t_us = frame.t_us;
    report.state = TrackingState::kTracking;
    report.T_world_camera = {T_world_camera.rotation.cast<float>(),
                             T_world_camera.translation.cast<float>()};
    report.T_map_camera = report.T_world_camera;
    report.landmarks = 1;
    for (int i = 0; i < kStageCount; ++i) report.stage_ticks[i] = 1000U * (i + 1U);
    overlay.at<std::uint8_t>(0, 0) = 255;
    const Vector3<double> forward = T_world_vehicle.rotation * Vector3<double>::UnitX();
    pose_ = {T_world_vehicle.translation.x(), T_world_vehicle.translation.y(),
             cairn::atan2(forward.y(), forward.x()), 1e-4 * Matrix3<double>::Identity()};
    return Status::kOk;
  }

  std::vector<MapLandmark> landmarks() const override {
    MapLandmark landmark;
    landmark.id = 7;
    landmark.p_map = {1.0, 2.0, 3.0};
    landmark.active = true;
    return {landmark};
  }
  int landmark_capacity() const override { return 64; }
  Health health() const override { return {}; }
  std::optional<PlanarPoseEstimate> vehicle_pose() const override { return pose_; }
  std::optional<DirectionOfTravel<float>> travel() const override {
    return DirectionOfTravel<float>{0.007F, 1e-6F};
  }
  nlohmann::json description() const override { return {{"tracker", "truth"}}; }

 private:
  Rigid<double> mounting_;
  int offset_frame_ = 1 << 30;
  double offset_m_ = 0.0;
  std::optional<PlanarPoseEstimate> pose_;
};

}  // namespace cairn::host

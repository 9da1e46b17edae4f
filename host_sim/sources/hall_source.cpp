#include "host_sim/sources/hall_source.hpp"

#include <cmath>

#include <fmt/format.h>

#include "host_sim/world/body_tilt.hpp"
#include "host_sim/world/drive.hpp"
#include "host_sim/world/gaussian.hpp"
#include "host_sim/world/hall.hpp"
#include "host_sim/world/renderer.hpp"
#include "host_sim/world/sensor.hpp"

namespace cairn::host {
namespace {

constexpr int kPaperFrames = 2387;
constexpr double kFrameRate = 30.0;
constexpr double kWheelbase = 0.5;
constexpr double kSamplesPerResearchStep = 3.0;  // 10 Hz noise figures, 30 Hz samples
constexpr double kTiltTime_s = 0.5;
constexpr double kDegree_rad = kPi<double> / 180.0;

PinholeCamera<double> hall_camera(int width) {
  PinholeCamera<double> camera;
  camera.width = width;
  camera.height = width * 3 / 4;
  camera.fx = camera.fy = 500.0 * width / 640.0;
  camera.cx = 0.5 * (camera.width - 1);
  camera.cy = 0.5 * (camera.height - 1);
  return camera;
}

Rigid<double> hall_mounting() {
  double sine = 0.0;
  double cosine = 0.0;
  sin_cos(4.0 * kDegree_rad, sine, cosine);
  Matrix3<double> R_vehicle_camera;        // columns: image right, image down, optical axis
  R_vehicle_camera << 0.0, -sine, cosine,  //
      -1.0, 0.0, 0.0,                      //
      0.0, -cosine, -sine;
  return {Quaternion<double>(R_vehicle_camera), Vector3<double>(0.35, 0.0, 1.0)};
}

/// All but floor and ceiling.
std::vector<std::vector<Vector3<double>>> upright_surfaces(const Hall& hall) {
  std::vector<std::vector<Vector3<double>>> surfaces;
  for (const Quad& quad : hall.scene.quads) {
    const Vector3<double> normal = quad.edge_s.cross(quad.edge_t).normalized();
    if (std::abs(normal.z()) > 0.9) continue;
    surfaces.push_back({quad.origin, quad.origin + quad.edge_s,
                        quad.origin + quad.edge_s + quad.edge_t, quad.origin + quad.edge_t});
  }
  return surfaces;
}

class HallSource final : public FrameSource {
 public:
  explicit HallSource(const HallOptions& options)
      : options_(options),
        hall_(build_hall(options.seed)),
        camera_(hall_camera(options.width)),
        renderer_(camera_),
        sensor_(Sensor::Settings::with_seed(options.seed)),
        odometry_noise_(options.seed ^ 0x0d0ULL),
        body_({options.tilt_rad, options.tilt_rad, kTiltTime_s}, options.seed ^ 0x717ULL),
        next_(options.first_frame),
        end_(options.first_frame + options.frame_count.value_or(kPaperFrames)) {
    info_.name = options.width == 640 ? "hall" : "hall-small";
    info_.camera = camera_;
    info_.T_vehicle_camera = hall_mounting();
    OdometryModel odometry;
    odometry.kind = OdometrySample::Kind::kAckermann;
    const double density = std::sqrt(kSamplesPerResearchStep);
    odometry.speed_sigma_mps = density * (options.base_noise ? 0.05 : 0.1);
    odometry.turn_sigma = density * (options.base_noise ? 2.0 : 5.0) * kDegree_rad;
    odometry.wheelbase_m = kWheelbase;
    odometry.period_s = 1.0 / kFrameRate;
    info_.odometry = odometry;
    info_.tilt = {options.tilt_rad, options.tilt_rad, kTiltTime_s};
    info_.frame_rate_hz = kFrameRate;
    info_.lap_frames = static_cast<int>(std::lround(LapDrive::Shape().lap_time_s * kFrameRate));
    info_.frame_count = end_ - next_;
    info_.surfaces = upright_surfaces(hall_);
    info_.seed = options.seed;
    info_.note = options.base_noise ? "odometry noise base: 0.05 m/s, 2 deg at 10 Hz"
                                    : "odometry noise s1: 0.1 m/s, 5 deg at 10 Hz";
    if (options.tilt_rad > 0.0) {
      info_.note += fmt::format("; pitch and roll of {} rad rms", options.tilt_rad);
    }
  }

  const SourceInfo& info() const override { return info_; }

  bool next(Frame& frame) override {
    if (next_ >= end_) return false;
    const PlanarPose pose = pose_of(next_);
    if (next_ > options_.first_frame) body_.advance(1.0 / kFrameRate);
    const Rigid<double> T_world_vehicle = to_rigid(pose) * body_.tilt().T_level_vehicle();
    const Rigid<double> T_world_camera = T_world_vehicle * info_.T_vehicle_camera;
    frame.number = next_;
    frame.t_us = time_us(next_);
    frame.true_T_world_vehicle = T_world_vehicle;
    frame.true_T_world_camera = T_world_camera;
    frame.odometry.clear();
    if (next_ > options_.first_frame) frame.odometry.push_back(odometry_to(next_));
    renderer_.render(hall_.scene, T_world_camera, ideal_);
    sensor_.expose(ideal_, next_, 1e-6 * static_cast<double>(frame.t_us), frame.grey);
    if (options_.colour) renderer_.colour(frame.grey, frame.colour);
    list_scene_points(T_world_camera, frame.scene_points);
    ++next_;
    return true;
  }

 private:
  static std::int64_t time_us(int frame) {
    return std::llround(1e6 * static_cast<double>(frame) / kFrameRate);
  }

  PlanarPose pose_of(int frame) const {
    return drive_.pose_at_time(1e-6 * static_cast<double>(time_us(frame)));
  }

  /// What wheel and steering sensors report about the motion since the frame before.
  OdometrySample odometry_to(int frame) {
    const double dt = 1e-6 * static_cast<double>(time_us(frame) - time_us(frame - 1));
    const double turn = pose_of(frame).theta_rad - pose_of(frame - 1).theta_rad;
    const double speed = drive_.speed_mps();
    const double steering = cairn::atan2(kWheelbase * turn, speed * dt);
    OdometrySample sample;
    sample.t_us = time_us(frame);
    sample.kind = OdometrySample::Kind::kAckermann;
    sample.speed_mps =
        static_cast<float>(speed + odometry_noise_.normal(info_.odometry->speed_sigma_mps));
    sample.turn = static_cast<float>(steering + odometry_noise_.normal(info_.odometry->turn_sigma));
    return sample;
  }

  void list_scene_points(const Rigid<double>& T_world_camera,
                         std::vector<ScenePointView>& views) const {
    views.clear();
    const Rigid<double> T_camera_world = T_world_camera.inverse();
    for (std::size_t i = 0; i < hall_.scene_points.size(); ++i) {
      ScenePointView view;
      view.id = static_cast<std::uint32_t>(i + 1);
      view.p_camera = T_camera_world * hall_.scene_points[i];
      if (!ok(camera_.project(view.p_camera, view.pixel)) || !camera_.contains(view.pixel, 2.0)) {
        continue;
      }
      const float seen =
          renderer_.inverse_depth(round_to_int(view.pixel.x()), round_to_int(view.pixel.y()));
      const double depth_ratio = static_cast<double>(seen) * view.p_camera.z();
      if (depth_ratio < 1.02) views.push_back(view);  // else something nearer hides it
    }
  }

  HallOptions options_;
  Hall hall_;
  PinholeCamera<double> camera_;
  LapDrive drive_;
  Renderer renderer_;
  Sensor sensor_;
  GaussianRandom odometry_noise_;
  BodyTilt body_;
  SourceInfo info_;
  cv::Mat ideal_;
  int next_;
  int end_;
};

}  // namespace

std::unique_ptr<FrameSource> make_hall_source(const HallOptions& options) {
  return std::make_unique<HallSource>(options);
}

}  // namespace cairn::host

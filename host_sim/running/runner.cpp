#include "host_sim/running/runner.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <unistd.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "cairn/base/hash.hpp"
#include "cairn/runtime/replay.hpp"

#include "host_sim/base/core_conversions.hpp"
#include "host_sim/base/names.hpp"
#include "host_sim/io/interruption.hpp"
#include "host_sim/io/output_file.hpp"
#include "host_sim/render/shaded_object.hpp"
#include "host_sim/running/live_view.hpp"
#include "host_sim/running/overlay_video.hpp"
#include "host_sim/running/view_picture.hpp"
#include "host_sim/trackers/host_ticks.hpp"

namespace cairn::host {
namespace {

std::optional<double> nees_of(const PlanarPoseEstimate& estimate, const Matrix3<double>& covariance,
                              const Rigid<double>& truth) {
  const Vector3<double> forward = truth.rotation * Vector3<double>::UnitX();
  const Vector3<double> error(
      estimate.x_m - truth.translation.x(), estimate.y_m - truth.translation.y(),
      wrap_angle(estimate.theta_rad - cairn::atan2(forward.y(), forward.x())));
  if (!(covariance.determinant() > 0.0)) return std::nullopt;
  const double nees = error.dot(covariance.inverse() * error);
  return std::isfinite(nees) && nees >= 0.0 ? std::optional<double>(nees) : std::nullopt;
}

std::optional<double> nees_of(const Matrix3<double>& covariance, const Rigid<double>& estimate,
                              const Rigid<double>& truth) {
  if (!(covariance.determinant() > 0.0)) return std::nullopt;
  const Eigen::AngleAxisd error(Quaternion<double>(estimate.rotation.conjugate() * truth.rotation));
  const Vector3<double> phi = error.angle() * error.axis();
  const double nees = phi.dot(covariance.inverse() * phi);
  return std::isfinite(nees) && nees >= 0.0 ? std::optional<double>(nees) : std::nullopt;
}

/// Of a vehicle's pose, or of a hand-held camera's attitude.
PoseSigma sigma_of(const Tracker& tracker) {
  if (const auto vehicle = tracker.vehicle_pose(); vehicle.has_value()) {
    return pose_sigma(vehicle->in_map_covariance.cast<float>());
  }
  const std::optional<Matrix3<double>> attitude = tracker.attitude_covariance();
  return {0.0F,
          attitude.has_value() ? static_cast<float>(std::sqrt(attitude->trace() / 3.0)) : 0.0F};
}

class Progress {
 public:
  Progress(std::string name, std::optional<int> total, bool wanted)
      : name_(std::move(name)), total_(total), shown_(wanted && isatty(STDERR_FILENO) != 0) {}
  ~Progress() {
    if (shown_) fmt::print(stderr, "\r{:70}\r", "");
  }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(int done, const FrameRecord& frame) {
    if (!shown_ || done % 10 != 0) return;
    const std::string of = total_.has_value() ? fmt::format("/{}", *total_) : std::string();
    fmt::print(stderr, "\r{}: frame {}{}  {}  {} landmarks  {:.2f} ms   ", name_, done, of,
               to_string(frame.report.state), frame.report.landmarks, frame.total_ms);
  }

 private:
  std::string name_;
  std::optional<int> total_;
  bool shown_;
};

class FrameLoop {
 public:
  FrameLoop(FrameSource& source, Tracker& tracker, const RunnerSettings& settings)
      : source_(source),
        tracker_(tracker),
        settings_(settings),
        progress_(source.info().name, source.info().frame_count, settings.progress) {
    const int expected = source.info().frame_count.value_or(600);
    static_cast<void>(monitor_.reset(HealthLimits{}));
    picture_step_ = std::max(1, expected / std::max(1, settings.pictures));
    if (settings.view) view_.emplace("Cairn: " + source.info().name);
  }

  RunRecord run(Frame& frame) {
    do {
      process(frame);
    } while (interrupted() == 0 && !record_.ended_by_viewer && source_.next(frame));
    record_.interrupted_by = interrupted();
    if (record_.interrupted_by != 0 || record_.ended_by_viewer) keep_last_picture(frame);
    record_.landmarks = tracker_.landmarks();
    record_.library_size = tracker_.library_size();
    record_.lap_frames = source_.info().lap_frames;
    record_.landmark_capacity = tracker_.landmark_capacity();
    record_.health = tracker_.health();
    record_.mount = tracker_.mount_offset();
    record_.ground = tracker_.ground();
    record_.focal = tracker_.focal_scale();
    record_.yaw = tracker_.yaw();
    record_.travel = tracker_.travel();
    record_.gyro = tracker_.gyro();
    for (int i = 0; i < monitor_.record_count(); ++i) record_.events.push_back(monitor_.record(i));
    record_.tracker = tracker_.description();
    record_.log_hash = hash_.value();
    if (video_ != nullptr) {
      video_->finish();
      record_.overlay = video_->path();
    }
    return std::move(record_);
  }

 private:
  void note_mount() {
    const std::optional<MountOffset> mount = tracker_.mount_offset();
    if (record_.mount_suspect_frame.has_value() || !mount.has_value()) return;
    if (mount->any_suspect()) record_.mount_suspect_frame = static_cast<int>(record_.frames.size());
  }

  void process(const Frame& frame) {
    FrameRecord entry;
    entry.number = frame.number;
    frame.grey.copyTo(overlay_);
    const double core_start_ms = core_clock_ms();
    const auto start = std::chrono::steady_clock::now();
    entry.report.status = tracker_.process(frame, overlay_, entry.report);
    const auto end = std::chrono::steady_clock::now();
    entry.total_ms = std::chrono::duration<double, std::milli>(end - start).count();
    entry.core_ms = core_clock_ms() - core_start_ms;
    for (int i = 0; i < kStageCount; ++i) {
      entry.stage_ms[i] = entry.report.stage_ticks[i] / kHostTicksPerMs;
    }
    const PoseSigma sigma = sigma_of(tracker_);
    entry.health = tracker_.health();
    monitor_.note(frame.t_us, entry.report.status, entry.report, entry.health, sigma);
    entry.health_score = monitor_.score();
    if (entry.has_pose()) {
      entry.position_covariance = tracker_.position_covariance();
      entry.attitude_sigma_rad = static_cast<double>(sigma.heading_rad);
    }
    note_mount();
    entry.true_T_world_camera = frame.true_T_world_camera;
    entry.true_T_world_vehicle = frame.true_T_world_vehicle;
    entry.vehicle = tracker_.vehicle_pose();
    if (entry.vehicle.has_value() && frame.true_T_world_vehicle.has_value()) {
      const Rigid<double>& truth = *frame.true_T_world_vehicle;
      entry.nees = nees_of(*entry.vehicle, entry.vehicle->covariance, truth);
      entry.filter_nees = nees_of(*entry.vehicle, entry.vehicle->filter_covariance, truth);
    }
    if (entry.has_pose() && frame.true_T_world_camera.has_value()) judge_attitude(entry);
    entry.measured = tracker_.measured();
    add_to_hash(hash_, entry.report);
    RegistrationInput registration;
    registration.views = frame.scene_points;
    if (entry.has_pose()) registration.T_world_camera = to_double(entry.report.T_map_camera);
    if (const auto focal = tracker_.focal_scale(); focal.has_value()) {
      registration.focal_scale = static_cast<double>(focal->value);
    }
    record_.registration_input.push_back(std::move(registration));
    draw(frame, entry);
    record_.frames.push_back(entry);
    progress_.show(static_cast<int>(record_.frames.size()), entry);
  }

  /// Domain: the entry has a pose and its truth.
  void judge_attitude(FrameRecord& entry) {
    const std::optional<Matrix3<double>> covariance = tracker_.attitude_covariance();
    if (!covariance.has_value()) return;
    const Rigid<double> estimate = to_double(entry.report.T_map_camera);
    const Rigid<double>& truth = *entry.true_T_world_camera;
    if (!T_estimate_truth_) {
      T_estimate_truth_ = estimate * truth.inverse();
      return;
    }
    entry.nees = nees_of(*covariance, estimate, *T_estimate_truth_ * truth);
  }

  /// The frame in colour with the tracker's objects shaded, hidden by the surfaces that are known;
  /// empty where the tracker has no objects.
  cv::Mat shade(const Frame& frame, const FrameRecord& entry) {
    const Augmenter* objects = tracker_.objects();
    if (objects == nullptr) return {};
    if (!shaded_.has_value()) {
      shaded_.emplace(objects->shape(), source_.info().camera);
      for (const auto& corners : source_.info().surfaces) {
        if (entry.vehicle.has_value()) surfaces_.push_back({corners});
      }
    }
    cv::Mat picture = frame.colour.clone();
    if (picture.empty()) cv::cvtColor(frame.grey, picture, cv::COLOR_GRAY2BGR);
    if (entry.report.state == TrackingState::kLost) return picture;
    const Rigid<double> T_world_camera = to_double(entry.report.T_map_camera);
    for (const int i : far_to_near(*objects, T_world_camera)) {
      shaded_->draw(to_double((*objects)[i]), T_world_camera, surfaces_, picture);
    }
    return picture;
  }

  static std::vector<int> far_to_near(const Augmenter& objects, const Rigid<double>& eye) {
    std::vector<int> order(static_cast<std::size_t>(objects.size()));
    std::iota(order.begin(), order.end(), 0);
    const auto distance = [&](int i) {
      return (objects[i].translation.cast<double>() - eye.translation).norm();
    };
    std::sort(order.begin(), order.end(), [&](int a, int b) { return distance(a) > distance(b); });
    return order;
  }

  void draw(const Frame& frame, const FrameRecord& entry) {
    const std::size_t done = record_.frames.size();
    last_is_kept_ = false;
    const bool keep = settings_.pictures > 0 && done % static_cast<std::size_t>(picture_step_) ==
                                                    static_cast<std::size_t>(picture_step_ / 2);
    if (!settings_.video && !keep && !view_) return;
    const cv::Mat plain = with_objects(frame, entry);
    if (view_) show(plain, frame, entry);
    if (!settings_.video && !keep) return;
    const cv::Mat picture = captioned(plain, frame, entry);
    if (settings_.video) {
      if (video_ == nullptr) {
        video_ = std::make_unique<OverlayVideo>(settings_.out, source_.info().frame_rate_hz,
                                                picture.size());
      }
      video_->write(picture);
    }
    if (keep) keep_picture(picture, frame);
  }

  cv::Mat with_objects(const Frame& frame, const FrameRecord& entry) {
    const cv::Mat drawn = settings_.shaded ? shade(frame, entry) : cv::Mat();
    return drawn.empty() ? OverlayVideo::compose(frame.grey, overlay_, frame.colour) : drawn;
  }
  static cv::Mat captioned(const cv::Mat& picture, const Frame& frame, const FrameRecord& entry) {
    return OverlayVideo::captioned(
        picture, fmt::format("frame {}  {}  {:.2f} ms  {} inliers  {} landmarks", frame.number,
                             to_string(entry.report.state), entry.total_ms, entry.report.inliers,
                             entry.report.landmarks));
  }

  void keep_picture(const cv::Mat& picture, const Frame& frame) {
    const std::filesystem::path path =
        settings_.out / fmt::format("overlay-{:06d}.jpg", frame.number);
    std::vector<std::uint8_t> bytes;
    cv::imencode(".jpg", picture, bytes);
    write_text(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    record_.pictures.push_back(path);
    last_is_kept_ = true;
  }
  /// A run that ends early may not have come to a picture at all: its last frame, `frame`, is one.
  void keep_last_picture(const Frame& frame) {
    if (settings_.pictures <= 0 || last_is_kept_) return;
    const FrameRecord& entry = record_.frames.back();
    keep_picture(captioned(with_objects(frame, entry), frame, entry), frame);
  }

  void show(const cv::Mat& picture, const Frame& frame, const FrameRecord& entry) {
    const cv::Mat shown = view_picture(picture, frame.grey, entry, tracker_.landmarks(),
                                       source_.info().camera, settings_.budget_ms);
    record_.ended_by_viewer = !view_->show(shown, frame.t_us);
  }

  FrameSource& source_;
  Tracker& tracker_;
  const RunnerSettings& settings_;
  std::optional<Rigid<double>> T_estimate_truth_;  ///< between the two worlds, from the first pose
  Progress progress_;
  HealthMonitor monitor_;
  RunRecord record_;
  Hash64 hash_;
  cv::Mat overlay_;
  std::unique_ptr<OverlayVideo> video_;
  std::optional<LiveView> view_;
  int picture_step_ = 1;
  bool last_is_kept_ = false;
  std::optional<ShadedObject> shaded_;
  std::vector<OccludingPolygon> surfaces_;
};

}  // namespace

RunRecord run_frames(FrameSource& source, Frame& first, Tracker& tracker,
                     const RunnerSettings& settings) {
  return FrameLoop(source, tracker, settings).run(first);
}

}  // namespace cairn::host

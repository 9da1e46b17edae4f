#include "host_sim/sources/video_source.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/io/pose_file.hpp"
#include "host_sim/sources/frame_times.hpp"
#include "host_sim/sources/media.hpp"
#include "host_sim/sources/odometry_file.hpp"
#include "host_sim/sources/scene_tracks.hpp"
#include "host_sim/sources/time_span.hpp"
#include "host_sim/sources/true_poses.hpp"

namespace cairn::host {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kTruthTolerance_us = 20000;
constexpr std::int64_t kLeastRecordedStep_us = 100;
constexpr std::int64_t kMostOdometryStep_us = 1000000;
constexpr std::int64_t kMostTruthStep_us = 10000000;
/// By --hfov: phones' main cameras have 62 to 73 degrees, of which stabilised video shows 75 to
/// 90 %.
constexpr double kGuessedFocalSigma = 0.2;

/// A camera one metre up that looks forward, where the camera file does not say.
Rigid<double> default_mounting() {
  Matrix3<double> R_vehicle_camera;
  R_vehicle_camera << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return {Quaternion<double>(R_vehicle_camera), Vector3<double>(0.0, 0.0, 1.0)};
}

std::unique_ptr<Media> open_media(const VideoOptions& options,
                                  const PinholeCamera<double>& camera) {
  const cv::Size size(camera.width, camera.height);
  if (options.live) return open_camera(options.media.string(), size, options.range);
  return fs::is_directory(options.media) ? open_pictures(options.media, size, options.range)
                                         : open_video(options.media, size, options.range);
}

template <class Timed>
std::vector<std::int64_t> times_of(const std::vector<Timed>& entries) {
  std::vector<std::int64_t> times;
  times.reserve(entries.size());
  for (const Timed& entry : entries) times.push_back(entry.t_us);
  return times;
}

/// Says where more pictures are missing than there are, as where a counter began anew: which ones
/// came first is then a guess.
std::optional<std::string> missing_pictures(const fs::path& folder,
                                            const std::vector<MediaFrame>& frames) {
  constexpr std::size_t kFew = 3;
  if (frames.size() < kFew) return std::nullopt;
  std::vector<std::int64_t> steps;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    steps.push_back(frames[i].t_us - frames[i - 1].t_us);
  }
  const auto largest = std::max_element(steps.begin(), steps.end());
  const std::size_t at = static_cast<std::size_t>(largest - steps.begin());
  const std::int64_t most_us = *largest;
  std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2),
                   steps.end());
  const std::int64_t usual_us = steps[steps.size() / 2];
  if (most_us <= usual_us * static_cast<std::int64_t>(frames.size())) return std::nullopt;
  return fmt::format(
      "{}: no picture for {:.1f} s, between frames {} and {}: taken as a gap; where a counter "
      "began anew, their order is another",
      folder.string(), 1e-6 * static_cast<double>(most_us), frames[at].number,
      frames[at + 1].number);
}

class VideoSource final : public FrameSource {
 public:
  explicit VideoSource(const VideoOptions& options) : options_(options) {
    if (!options.hfov_deg) camera_ = read_camera_file(options.camera, options.lens);
    media_ = open_media(options, camera_.camera);
    if (options.hfov_deg) guess_camera(*options.hfov_deg);
    if (!options.times.empty()) times_.emplace(options.times);
    const MediaInfo& media = media_->info();
    info_.name = options.live ? "camera" : "video";
    info_.camera = camera_.camera;
    info_.T_body_camera = camera_.T_body_camera;
    info_.readout = camera_.readout;
    if (!info_.focal_sigma) info_.focal_sigma = camera_.focal_sigma;
    info_.frame_rate_hz = media.rate_hz;
    info_.frame_count = media.frame_count;
    info_.note = fmt::format(
        "{}; {}", options.hfov_deg ? "no calibration" : "camera file format: " + camera_.format,
        times_.has_value() ? "times from --times" : media.note);
    if (!options.hfov_deg) info_.inputs = {options.camera};
    info_.inputs.insert(info_.inputs.end(), media.inputs.begin(), media.inputs.end());
    if (times_.has_value()) info_.inputs.push_back(options.times);
    span_ = frames_span();
    if (!times_.has_value()) {
      const auto missing = missing_pictures(options.media, media_->frames());
      if (missing.has_value()) info_.warnings.push_back(*missing);
    }
    if (!options.truth.empty()) read_truth();
    if (!options.odometry.empty()) take_odometry();
  }

  const SourceInfo& info() const override { return info_; }
  std::optional<TimeSpan> span() const override { return span_; }

  void take_scene_points(ScenePoints points) {
    scene_points_ = std::move(points);
    info_.note +=
        fmt::format("; {} scene points triangulated with the true poses", scene_points_.count);
    if (scene_points_.count == 0) {
      info_.warnings.push_back(fmt::format(
          "--scene-points: no point of the scene could be triangulated with {}: too little "
          "texture, "
          "motion or frames with a true pose, or poses or camera do not fit the pictures",
          options_.truth.string()));
    }
  }

  bool next(Frame& frame) override {
    MediaFrame place;
    if (!media_->next(place, frame.grey)) {
      note_end();
      return false;
    }
    if (options_.colour) frame.colour = media_->colour();
    if (times_.has_value()) place.t_us = times_->t_us(place.number);
    describe(place, frame);
    ++given_;
    return true;
  }

 private:
  void guess_camera(double hfov_deg) {
    camera_.camera = guessed_camera(media_->info().size, hfov_deg);
    info_.focal_sigma = kGuessedFocalSigma;
    info_.warnings.push_back(fmt::format(
        "no calibration: a focal length of {:.0f} px is a guess by --hfov {}, and a lens "
        "without distortion another; angles and distances are wrong by what the guess "
        "is. `cairn_sim calibrate` makes a camera file",
        camera_.camera.fx, hfov_deg));
  }

  /// Of the frames to come; empty where a video with --times says neither.
  std::optional<TimeSpan> frames_span() const {
    if (!times_.has_value()) return media_->info().span;
    const std::vector<MediaFrame>& frames = media_->frames();
    if (!frames.empty()) {
      for (const MediaFrame& frame : frames) static_cast<void>(times_->t_us(frame.number));
      return TimeSpan{times_->t_us(frames.front().number), times_->t_us(frames.back().number)};
    }
    const int first = options_.range.first.value_or(0);
    const std::optional<int> count = media_->info().frame_count;
    if (!count.has_value()) return std::nullopt;
    return TimeSpan{times_->t_us(first), times_->t_us(first + *count - 1)};
  }

  void check_recording(const fs::path& file, const std::string& what,
                       const std::vector<std::int64_t>& times, std::int64_t most_step_us) {
    if (!span_.has_value()) return;
    const auto warning =
        check_overlap(file, what, times, *span_, kLeastRecordedStep_us, most_step_us);
    if (warning.has_value()) info_.warnings.push_back(*warning);
  }

  void read_truth() {
    truth_ = read_tum(options_.truth);
    check_recording(options_.truth, "the truth", times_of(truth_), kMostTruthStep_us);
    const auto fast = check_steps(options_.truth, truth_);
    if (fast.has_value()) info_.warnings.push_back(*fast);
    info_.inputs.push_back(options_.truth);
  }

  OdometryModel with_noise(OdometryModel model) const {
    if (options_.speed_sigma_mps) model.speed_sigma_mps = *options_.speed_sigma_mps;
    if (!options_.yaw_rate_sigma_radps) return model;
    if (model.kind != OdometrySample::Kind::kTwist) {
      throw UsageError("--odometry-noise-yaw-rate: the odometry has a steering angle instead");
    }
    model.turn_sigma = *options_.yaw_rate_sigma_radps;
    return model;
  }

  void take_odometry() {
    odometry_ = read_odometry(options_.odometry);
    if (!odometry_.warning.empty()) info_.warnings.push_back(odometry_.warning);
    check_recording(options_.odometry, "the odometry", times_of(odometry_.samples),
                    kMostOdometryStep_us);
    info_.odometry = with_noise(odometry_.model);
    info_.inputs.push_back(options_.odometry);
    info_.tilt = camera_.tilt.value_or(TiltParameters<double>::car());
    info_.T_vehicle_camera = camera_.T_vehicle_camera.value_or(default_mounting());
    if (!camera_.T_vehicle_camera.has_value()) {
      info_.note += "; no T_vehicle_camera in the camera file: camera 1 m up, looking forward";
    }
  }

  void note_end() {
    if (ended_) return;
    ended_ = true;
    const std::string missing = media_->missing();
    if (!missing.empty()) {
      info_.warnings.push_back(missing);
      info_.damaged = media_->is_damaged();
      if (times_.has_value()) {
        info_.warnings.push_back(
            "the rows of --times may belong to other frames than those they were given to");
        info_.damaged = true;
      }
    }
    constexpr int kLeastPoses = 3;  // that a path is aligned with
    const int least = std::min(given_, std::max(kLeastPoses, given_ / 10));
    if (!truth_.empty() && frames_with_truth_ < least) {
      info_.warnings.push_back(fmt::format("{}: {} of {} frames have a true pose within {} ms",
                                           options_.truth.string(), frames_with_truth_, given_,
                                           kTruthTolerance_us / 1000));
    }
  }

  void describe(const MediaFrame& place, Frame& frame) {
    frame.number = place.number;
    frame.t_us = place.t_us;
    frame.scene_points.clear();
    const auto index = static_cast<std::size_t>(given_);
    if (index < scene_points_.frames.size()) frame.scene_points = scene_points_.frames[index];
    frame.odometry.clear();
    take_samples(odometry_.samples, given_ == 0, next_sample_, frame);
    frame.true_T_world_camera.reset();
    frame.true_T_world_vehicle.reset();
    while (next_truth_ + 1 < truth_.size() && std::abs(truth_[next_truth_ + 1].t_us - frame.t_us) <=
                                                  std::abs(truth_[next_truth_].t_us - frame.t_us)) {
      ++next_truth_;
    }
    if (!truth_.empty() && std::abs(truth_[next_truth_].t_us - frame.t_us) <= kTruthTolerance_us) {
      ++frames_with_truth_;
      frame.true_T_world_camera = truth_[next_truth_].pose;
      if (info_.odometry.has_value()) {
        frame.true_T_world_vehicle = *frame.true_T_world_camera * info_.T_vehicle_camera.inverse();
      }
    }
  }

  VideoOptions options_;
  CameraFile camera_;
  std::unique_ptr<Media> media_;
  std::optional<FrameTimes> times_;
  OdometryFile odometry_;
  std::vector<TimedPose> truth_;
  ScenePoints scene_points_;
  SourceInfo info_;
  std::optional<TimeSpan> span_;
  std::size_t next_sample_ = 0;
  std::size_t next_truth_ = 0;
  int given_ = 0;
  int frames_with_truth_ = 0;
  bool ended_ = false;
};

ScenePoints follow_scene(VideoOptions options) {
  options.colour = false;
  VideoSource source(options);
  SceneTracker tracker(source.info().camera, scene_tracks_of_a_drive());
  for (Frame frame; source.next(frame);) tracker.add(frame.grey, frame.true_T_world_camera);
  return tracker.finish();
}

}  // namespace

PinholeCamera<double> guessed_camera(const cv::Size& size, double hfov_deg) {
  PinholeCamera<double> camera;
  camera.width = size.width;
  camera.height = size.height;
  camera.fx = camera.fy = 0.5 * size.width / std::tan(hfov_deg * CV_PI / 360.0);
  camera.cx = 0.5 * (size.width - 1);
  camera.cy = 0.5 * (size.height - 1);
  return camera;
}

std::unique_ptr<FrameSource> make_video_source(const VideoOptions& options) {
  if (!options.camera.empty() && options.hfov_deg) {
    throw UsageError(
        "--hfov: a guess in place of a camera file, and --camera gives one: expected one of them");
  }
  if (options.camera.empty() && !options.hfov_deg) {
    throw UsageError(fmt::format(
        "source {}: expected a camera file by --camera (`cairn_sim calibrate` makes one), or a "
        "guess by --hfov DEG, the horizontal field of view",
        options.live ? "camera" : "video"));
  }
  if (options.scene_points && (options.live || options.truth.empty())) {
    throw UsageError("--scene-points: expected true camera poses by --truth, of a recording");
  }
  auto source = std::make_unique<VideoSource>(options);
  if (options.scene_points) source->take_scene_points(follow_scene(options));
  return source;
}

}  // namespace cairn::host

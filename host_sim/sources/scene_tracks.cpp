#include "host_sim/sources/scene_tracks.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "host_sim/io/image_file.hpp"

namespace cairn::host {
namespace {

bool is_small(const std::vector<double>& errors, const SceneTrackSettings& settings) {
  double sum = 0.0;
  for (const double error : errors) sum += error * error;
  return std::sqrt(sum / static_cast<double>(errors.size())) <= settings.max_rms_px &&
         *std::max_element(errors.begin(), errors.end()) <= settings.max_error_px;
}

}  // namespace

SceneTrackSettings scene_tracks_of_a_drive() {
  SceneTrackSettings settings;
  settings.alive = 60;
  settings.renew_every = 2;
  settings.min_frames = 5;
  settings.max_return_px = 0.5;
  return settings;
}

void SceneTracker::add(const cv::Mat& grey, const std::optional<Rigid<double>>& T_world_camera) {
  poses_.push_back(T_world_camera);
  if (!T_world_camera.has_value()) {
    end_all();
    return;
  }
  step(grey);
  if ((poses_.size() - 1) % static_cast<std::size_t>(settings_.renew_every) == 0) renew(grey);
  grey.copyTo(before_);
}

ScenePoints SceneTracker::finish() {
  end_all();
  ScenePoints points;
  points.frames.resize(poses_.size());
  for (const Track& track : done_) {
    Vector3<double> p_world;
    std::vector<double> errors;
    if (!intersect_rays(track, p_world) || !refine(track, p_world, errors) ||
        !is_small(errors, settings_)) {
      continue;
    }
    const auto id = static_cast<std::uint32_t>(++points.count);
    for (std::size_t i = 0; i < track.pixels.size(); ++i) {
      const std::size_t k = track.first + i;
      points.frames[k].push_back({id, track.pixels[i], poses_[k]->inverse() * p_world});
    }
  }
  done_.clear();
  return points;
}

void SceneTracker::step(const cv::Mat& grey) {
  if (alive_.empty()) return;
  std::vector<cv::Point2f> from, to, back;
  for (const Track& track : alive_) {
    from.emplace_back(static_cast<float>(track.pixels.back().x()),
                      static_cast<float>(track.pixels.back().y()));
  }
  std::vector<std::uint8_t> found, returned;
  std::vector<float> error;
  const cv::Size window(15, 15);
  cv::calcOpticalFlowPyrLK(before_, grey, from, to, found, error, window);
  cv::calcOpticalFlowPyrLK(grey, before_, to, back, returned, error, window);
  std::vector<Track> still;
  for (std::size_t i = 0; i < alive_.size(); ++i) {
    const cv::Point2f off = back[i] - from[i];
    const bool good =
        found[i] != 0 && returned[i] != 0 && std::hypot(off.x, off.y) <= settings_.max_return_px &&
        cv::Rect2f(8, 8, static_cast<float>(grey.cols - 16), static_cast<float>(grey.rows - 16))
            .contains(to[i]);
    const bool full = static_cast<int>(alive_[i].pixels.size()) >= settings_.max_frames;
    if (!good || full) {
      end(alive_[i]);
      continue;
    }
    alive_[i].pixels.emplace_back(double{to[i].x}, double{to[i].y});
    still.push_back(std::move(alive_[i]));
  }
  alive_ = std::move(still);
}

void SceneTracker::renew(const cv::Mat& grey) {
  constexpr double kQuality = 0.02;
  constexpr int kApart_px = 20;
  const int wanted = settings_.alive - static_cast<int>(alive_.size());
  if (wanted <= 0) return;
  cv::Mat free(grey.size(), CV_8UC1, cv::Scalar(255));
  for (const Track& track : alive_) {
    cv::circle(free, {cvRound(track.pixels.back().x()), cvRound(track.pixels.back().y())},
               kApart_px, 0, cv::FILLED);
  }
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(grey, corners, wanted, kQuality, kApart_px, free);
  if (corners.empty()) return;
  cv::cornerSubPix(grey, corners, {4, 4}, {-1, -1},
                   {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 20, 0.02});
  for (const cv::Point2f& corner : corners) {
    alive_.push_back({poses_.size() - 1, {{double{corner.x}, double{corner.y}}}});
  }
}

void SceneTracker::end(Track& track) {
  if (static_cast<int>(track.pixels.size()) >= settings_.min_frames) {
    done_.push_back(std::move(track));
  }
}

void SceneTracker::end_all() {
  for (Track& track : alive_) end(track);
  alive_.clear();
}

/// The point nearest to all rays of a track. False when the rays are nearly parallel.
bool SceneTracker::intersect_rays(const Track& track, Vector3<double>& p_world) const {
  Matrix3<double> A = Matrix3<double>::Zero();
  Vector3<double> b = Vector3<double>::Zero();
  Vector3<double> first = Vector3<double>::Zero();
  double widest = 0.0;
  for (std::size_t i = 0; i < track.pixels.size(); ++i) {
    const Rigid<double>& pose = *poses_[track.first + i];
    const Vector3<double> ray = (pose.rotation * camera_.unproject(track.pixels[i])).normalized();
    if (i == 0) first = ray;
    widest = std::max(widest, first.cross(ray).norm());
    const Matrix3<double> across = Matrix3<double>::Identity() - ray * ray.transpose();
    A += across;
    b += across * pose.translation;
  }
  if (widest < settings_.min_angle_rad) return false;
  p_world = A.ldlt().solve(b);
  return true;
}

/// Gauss-Newton on the reprojection error. False when a frame does not see the point.
bool SceneTracker::refine(const Track& track, Vector3<double>& p_world,
                          std::vector<double>& errors) const {
  constexpr int kSteps = 5;
  for (int step = 0; step <= kSteps; ++step) {
    Matrix3<double> H = Matrix3<double>::Zero();
    Vector3<double> g = Vector3<double>::Zero();
    errors.clear();
    for (std::size_t i = 0; i < track.pixels.size(); ++i) {
      const Rigid<double> T_camera_world = poses_[track.first + i]->inverse();
      Vector2<double> pixel;
      Matrix<double, 2, 3> jacobian;
      if (!ok(camera_.project(T_camera_world * p_world, pixel, jacobian))) return false;
      const Vector2<double> residual = track.pixels[i] - pixel;
      const Matrix<double, 2, 3> by_world = jacobian * T_camera_world.rotation.toRotationMatrix();
      H += by_world.transpose() * by_world;
      g += by_world.transpose() * residual;
      errors.push_back(residual.norm());
    }
    if (step < kSteps) p_world += H.ldlt().solve(g);
  }
  return true;
}

int add_scene_tracks(const PinholeCamera<double>& camera, const SceneTrackSettings& settings,
                     std::vector<SequenceFrame>& frames) {
  SceneTracker tracker(camera, settings);
  cv::Mat grey;
  for (const SequenceFrame& frame : frames) {
    read_grey_image(frame.image, {camera.width, camera.height}, grey);
    tracker.add(grey, frame.known.true_T_world_camera);
  }
  ScenePoints points = tracker.finish();
  for (std::size_t k = 0; k < frames.size(); ++k) {
    frames[k].known.scene_points = std::move(points.frames[k]);
  }
  return points.count;
}

}  // namespace cairn::host

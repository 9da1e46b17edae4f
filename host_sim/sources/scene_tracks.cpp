#include "host_sim/sources/scene_tracks.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "host_sim/io/image_file.hpp"

namespace cairn::host {
namespace {

struct Track {
  std::size_t first = 0;  ///< frame of the first pixel; the others follow without a gap
  std::vector<Vector2<double>> pixels;
};

class Follower {
 public:
  explicit Follower(const SceneTrackSettings& settings) : settings_(settings) {}

  std::vector<Track> follow(const PinholeCamera<double>& camera,
                            const std::vector<SequenceFrame>& frames) {
    cv::Mat grey;
    for (std::size_t k = 0; k < frames.size(); ++k) {
      read_grey_image(frames[k].image, {camera.width, camera.height}, grey);
      if (k > 0) step(grey);
      if (k % static_cast<std::size_t>(settings_.renew_every) == 0) renew(grey, k);
      grey.copyTo(before_);
    }
    for (Track& track : alive_) end(track);
    return std::move(done_);
  }

 private:
  void step(const cv::Mat& grey) {
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
          found[i] != 0 && returned[i] != 0 &&
          std::hypot(off.x, off.y) <= settings_.max_return_px &&
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

  void renew(const cv::Mat& grey, std::size_t frame) {
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
      alive_.push_back({frame, {{double{corner.x}, double{corner.y}}}});
    }
  }

  void end(Track& track) {
    if (static_cast<int>(track.pixels.size()) >= settings_.min_frames) {
      done_.push_back(std::move(track));
    }
  }

  const SceneTrackSettings& settings_;
  cv::Mat before_;
  std::vector<Track> alive_;
  std::vector<Track> done_;
};

/// The point nearest to all rays of a track. False when the rays are nearly parallel.
bool intersect_rays(const PinholeCamera<double>& camera, const std::vector<SequenceFrame>& frames,
                    const Track& track, double min_angle_rad, Vector3<double>& p_world) {
  Matrix3<double> A = Matrix3<double>::Zero();
  Vector3<double> b = Vector3<double>::Zero();
  Vector3<double> first = Vector3<double>::Zero();
  double widest = 0.0;
  for (std::size_t i = 0; i < track.pixels.size(); ++i) {
    const Rigid<double>& pose = *frames[track.first + i].known.true_T_world_camera;
    const Vector3<double> ray = (pose.rotation * camera.unproject(track.pixels[i])).normalized();
    if (i == 0) first = ray;
    widest = std::max(widest, first.cross(ray).norm());
    const Matrix3<double> across = Matrix3<double>::Identity() - ray * ray.transpose();
    A += across;
    b += across * pose.translation;
  }
  if (widest < min_angle_rad) return false;
  p_world = A.ldlt().solve(b);
  return true;
}

/// Gauss-Newton on the reprojection error. False when a frame does not see the point.
bool refine(const PinholeCamera<double>& camera, const std::vector<SequenceFrame>& frames,
            const Track& track, Vector3<double>& p_world, std::vector<double>& errors) {
  constexpr int kSteps = 5;
  for (int step = 0; step <= kSteps; ++step) {
    Matrix3<double> H = Matrix3<double>::Zero();
    Vector3<double> g = Vector3<double>::Zero();
    errors.clear();
    for (std::size_t i = 0; i < track.pixels.size(); ++i) {
      const Rigid<double> T_camera_world =
          frames[track.first + i].known.true_T_world_camera->inverse();
      Vector2<double> pixel;
      Matrix<double, 2, 3> jacobian;
      if (!ok(camera.project(T_camera_world * p_world, pixel, jacobian))) return false;
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

bool is_small(const std::vector<double>& errors, const SceneTrackSettings& settings) {
  double sum = 0.0;
  for (const double error : errors) sum += error * error;
  return std::sqrt(sum / static_cast<double>(errors.size())) <= settings.max_rms_px &&
         *std::max_element(errors.begin(), errors.end()) <= settings.max_error_px;
}

}  // namespace

int add_scene_tracks(const PinholeCamera<double>& camera, const SceneTrackSettings& settings,
                     std::vector<SequenceFrame>& frames) {
  std::uint32_t next_id = 1;
  for (const Track& track : Follower(settings).follow(camera, frames)) {
    Vector3<double> p_world;
    std::vector<double> errors;
    if (!intersect_rays(camera, frames, track, settings.min_angle_rad, p_world) ||
        !refine(camera, frames, track, p_world, errors) || !is_small(errors, settings)) {
      continue;
    }
    for (std::size_t i = 0; i < track.pixels.size(); ++i) {
      Frame& frame = frames[track.first + i].known;
      frame.scene_points.push_back(
          {next_id, track.pixels[i], frame.true_T_world_camera->inverse() * p_world});
    }
    ++next_id;
  }
  return static_cast<int>(next_id - 1);
}

}  // namespace cairn::host

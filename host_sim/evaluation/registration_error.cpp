#include "host_sim/evaluation/registration_error.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace cairn::host {
namespace {

struct Anchor {
  Vector3<double> sum = Vector3<double>::Zero();
  int frames = 0;
};

class Evaluator {
 public:
  Evaluator(const PinholeCamera<double>& camera, const RegistrationSettings& settings)
      : camera_(camera), settings_(settings) {}

  RegistrationResult at_scale(const std::vector<RegistrationInput>& frames, double scale) const {
    RegistrationResult result;
    result.map_scale = scale;
    std::map<std::uint32_t, Anchor> anchors;
    for (const RegistrationInput& frame : frames) {
      result.frame_px.push_back(error_of(frame, scale, anchors));
    }
    result.points = static_cast<int>(anchors.size());
    return result;
  }

 private:
  std::optional<double> error_of(const RegistrationInput& frame, double scale,
                                 std::map<std::uint32_t, Anchor>& anchors) const {
    if (!frame.T_world_camera.has_value()) return std::nullopt;
    const Rigid<double> T_camera_world = frame.T_world_camera->inverse();
    double sum = 0.0;
    int count = 0;
    for (const ScenePointView& view : frame.views) {
      const auto known = anchors.find(view.id);
      if (known == anchors.end() ? well_seen(view)
                                 : known->second.frames < settings_.anchor_frames) {
        Anchor& anchor = anchors[view.id];
        anchor.sum +=
            *frame.T_world_camera * (scale * across(view.p_camera, 1.0 / frame.focal_scale)).eval();
        ++anchor.frames;
      } else if (known != anchors.end()) {
        const Anchor& anchor = known->second;
        const Vector3<double> p_camera = T_camera_world * (anchor.sum / anchor.frames).eval();
        sum += distance_px(across(p_camera, frame.focal_scale), view.pixel);
        ++count;
      }
    }
    return count > 0 ? std::optional<double>(sum / count) : std::nullopt;
  }

  /// A camera whose focal length is longer by a factor sees a point where the told camera sees the
  /// one that lies as many times as far from its axis.
  static Vector3<double> across(const Vector3<double>& p, double factor) {
    return {factor * p.x(), factor * p.y(), p.z()};
  }

  bool well_seen(const ScenePointView& view) const {
    return view.p_camera.z() < settings_.anchor_distance_m &&
           camera_.contains(view.pixel, settings_.anchor_margin_px);
  }

  /// At most the image's diagonal, which is also what a point behind the camera counts.
  double distance_px(const Vector3<double>& p_camera, const Vector2<double>& pixel) const {
    const double diagonal = std::hypot(camera_.width, camera_.height);
    Vector2<double> projected;
    if (!ok(camera_.project(p_camera, projected))) return diagonal;
    return std::min(diagonal, (projected - pixel).norm());
  }

  const PinholeCamera<double>& camera_;
  const RegistrationSettings& settings_;
};

double mean_error(const RegistrationResult& result) {
  double sum = 0.0;
  int count = 0;
  for (const std::optional<double>& px : result.frame_px) {
    if (!px.has_value()) continue;
    sum += *px;
    ++count;
  }
  return count > 0 ? sum / count : 0.0;
}

}  // namespace

RegistrationResult evaluate_registration(const std::vector<RegistrationInput>& frames,
                                         const PinholeCamera<double>& camera,
                                         const RegistrationSettings& settings) {
  const Evaluator evaluator(camera, settings);
  if (settings.map_scale.has_value()) return evaluator.at_scale(frames, *settings.map_scale);
  // A scan of log scale over four decades, then golden section about its best.
  constexpr double kLow = -4.7, kHigh = 4.7, kStep = 0.1;
  double best = 0.0;
  double best_error = 1e300;
  for (double log_scale = kLow; log_scale <= kHigh; log_scale += kStep) {
    const double error = mean_error(evaluator.at_scale(frames, std::exp(log_scale)));
    if (error < best_error) {
      best_error = error;
      best = log_scale;
    }
  }
  double low = best - kStep;
  double high = best + kStep;
  constexpr double kGolden = 0.6180339887498949;
  for (int i = 0; i < 30; ++i) {
    const double a = high - kGolden * (high - low);
    const double b = low + kGolden * (high - low);
    if (mean_error(evaluator.at_scale(frames, std::exp(a))) <
        mean_error(evaluator.at_scale(frames, std::exp(b)))) {
      high = b;
    } else {
      low = a;
    }
  }
  return evaluator.at_scale(frames, std::exp(0.5 * (low + high)));
}

}  // namespace cairn::host

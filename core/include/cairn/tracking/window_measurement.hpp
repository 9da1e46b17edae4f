#pragma once

#include "cairn/geometry/detail/spd_inverse.hpp"
#include "cairn/tracking/camera_track.hpp"
#include "cairn/tracking/window_exposures.hpp"
#include "cairn/tracking/window_features.hpp"
#include "cairn/window/window_pose.hpp"

namespace cairn {

namespace work {

/// estimate_window_pose() with `sightings`, ten iterations.
inline constexpr int window_pose(int sightings) {
  return 20 + 8 * sightings;
}

}  // namespace work

/// Measures the pose of a frame by the features of a window of keyframes: finds them in the
/// picture, the first ones in wide windows and the others where those say, and estimates the pose
/// from what was found.
template <class Config>
class WindowMeasurement {
 public:
  using Features = WindowFeatures<Config>;
  using Window = typename Features::Window;
  static constexpr int kMaxFeatures = Features::kMaxFeatures;

  struct Parameters {
    int min_inliers = 8;
    int guided_inliers = 5;         ///< with a gyroscope that agrees, in place of min_inliers
    float min_inlier_share = 0.4F;  ///< of those found
    float known_depth = 0.3F;       ///< relative sigma below which a depth counts as known
    float sure_share = 0.8F;        ///< of the latest matches that agree, for a pose to be sure

    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const bool good = min_inliers >= 4 && guided_inliers >= 4 && is_finite(min_inlier_share) &&
                        min_inlier_share >= 0.0F && min_inlier_share <= 1.0F &&
                        is_positive(known_depth) && is_finite(sure_share) && sure_share >= 0.0F &&
                        sure_share <= 1.0F;
      return good ? Status::kOk : Status::kBadConfig;
    }
  };
  /// What the tracker lends for a frame.
  struct Scene {
    FrameContext& frame;
    Features& features;
    const Window& window;
    const CameraTrack& track;
    const FrameStep& step;
  };
  /// Of a frame's searches.
  struct Limits {
    int features = 0;  ///< that are searched
    int work = 0;      ///< units to leave, beside those of two poses
  };

  /// Starts anew. Domain: valid parameters and times.
  void reset(const Parameters& parameters, const ReadoutTimes& times,
             const PinholeCamera<float>& camera) {
    parameters_ = parameters;
    exposures_.reset(times, camera.width, camera.height);
    covariance_.setZero();
    inliers_ = 0;
    forget_agreement();
  }

  /// Searches features, the first in wide windows. Where those agree on a pose, the others are
  /// close to where it expects them.
  void find(const Scene& scene, const Rigid<float>& predicted, const Limits& limits);
  /// The frame's pose, from where the camera is predicted and, unless nearly all agree on that,
  /// from where it was; the start with more inliers counts. True where enough agree.
  bool estimate(const Scene& scene, const Rigid<float>& predicted, Rigid<float>& pose);
  /// After estimate(), where its pose is taken: features learn whether they agree with it.
  void note_agreement(FrameContext& frame, Features& features) const;
  /// The same: the latest matches agree, and half of the inliers have a depth that is known, or
  /// enough of them the library's. A map that is wrong explains what is near its start; what it
  /// does not explain shows as matches that disagree, many more than are mismatched.
  bool sure(const Features& features, const Window& window) const;
  /// A new map begins with the frame, whose pose is exact in it.
  void begin_anew() {
    exposures_.forget_motion();
    covariance_.setZero();
    forget_agreement();
  }
  /// What follows is measured in another map.
  void forget_agreement() { agreed_ = compared_ = 0.0F; }
  /// The pose found becomes that of the frame.
  void expose(const CameraTrack& track, const Rigid<float>& pose) {
    exposures_.expose(track.movement_to(pose));
  }

  int inliers() const { return inliers_; }
  const Parameters& parameters() const { return parameters_; }
  WindowExposures& exposures() { return exposures_; }
  const WindowExposures& exposures() const { return exposures_; }
  /// Of the last pose found, relative to the landmarks, as estimate_window_pose() gives it.
  const Matrix<float, 6, 6>& covariance() const { return covariance_; }
  /// The attitude of the pose found by the landmarks alone, R_camera_world, and its covariance:
  /// what a gyroscope added to it is taken from it again. False where nothing is left.
  bool attitude_alone(const Rigid<float>& predicted, const Rigid<float>& pose,
                      Quaternion<float>& attitude, Matrix3<float>& covariance) const;

 private:
  bool search(const Scene& scene, const Rigid<float>& predicted, int first, int last, int radius,
              int later);
  bool first_agree(const Scene& scene, Rigid<float>& pose);
  int first_radius(const Scene& scene) const;
  Rigid<float> search_from(const Scene& scene, const Rigid<float>& predicted) const;
  int gather(const Scene& scene, const Rigid<float>& pose);
  WindowPoseOptions<float> options(const Scene& scene, const Rigid<float>& predicted) const;
  void note_matches(int found);

  Parameters parameters_;
  WindowExposures exposures_;
  Matrix<float, 6, 6> covariance_ = Matrix<float, 6, 6>::Zero();
  float guided_information_ = 0.0F;  ///< of the frame's attitude, that a gyroscope added
  int inliers_ = 0;
  float agreed_ = 0.0F;    ///< matches of the latest frames that agreed with the pose found
  float compared_ = 0.0F;  ///< all of them
  WindowSighting<float> sightings_[kMaxFeatures];
  int sighted_[kMaxFeatures] = {};  ///< feature of each
};

}  // namespace cairn

#include "cairn/tracking/detail/window_measurement_impl.hpp"

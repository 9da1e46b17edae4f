#pragma once

#include <cstdint>

#include "cairn/base/config.hpp"
#include "cairn/base/hash.hpp"
#include "cairn/geometry/focal_scale.hpp"
#include "cairn/tracking/frame_input.hpp"
#include "cairn/tracking/handheld_gyro.hpp"
#include "cairn/tracking/handheld_rotation.hpp"
#include "cairn/tracking/repeated_image.hpp"
#include "cairn/tracking/rolling_shutter.hpp"
#include "cairn/tracking/stage_timer.hpp"
#include "cairn/tracking/window_features.hpp"
#include "cairn/tracking/window_memory.hpp"
#include "cairn/tracking/window_motion.hpp"

namespace cairn {

namespace work {

inline constexpr int kWindowFrame = 120;   ///< prediction, lists, reports
inline constexpr int kWindowNewest = 130;  ///< of a keyframe: the one to drop, the typical depth
/// estimate_window_pose() with `sightings`, ten iterations.
inline constexpr int window_pose(int sightings) {
  return 20 + 8 * sightings;
}
/// What a rolling shutter takes, of all features in a frame.
inline constexpr int rolling_shutter(int features) {
  return 3 * features;
}
/// ShrunkImage::take().
inline constexpr int shrunk_image(int width, int height) {
  return 1 + width * height / (shrink_factor(width, height) == 2 ? 300 : 450);
}

}  // namespace work

/// Camera tracking from video alone by a window of keyframes (KeyframeWindow), with the interface
/// of HandheldTracker. The world is the camera of the first frame; lengths are in a unit of its own
/// (a landmark of the first frame is expected at a depth of one). Each frame: predict the pose, by
/// constant velocity or by what turned the whole picture; find the landmarks by their templates;
/// estimate the pose from them; make it a keyframe where the view has changed; improve the window
/// with what is left of the frame's work; report.
///
/// Where too few landmarks agree for some frames the tracker is lost: it begins its map anew where
/// it believes to be, with the depth that it saw last, so that the scale is kept roughly, and seeks
/// its place in the map that it remembers (WindowMemory).
///
/// The focal length is a state of the window (WindowParameters::focal_sigma says how well the
/// camera file knows it), but for a fisheye lens.
///
/// Deterministic; random numbers are drawn for P3P alone, after a loss. All storage is inside. One
/// frame costs at most kWindowFeatures template searches, three poses, one pass of corner detection
/// after a keyframe; the window's iterations wait for frames whose work affords them, and at most
/// four frames for the first.
template <class Config>
class WindowTracker {
 public:
  using Features = WindowFeatures<Config>;
  using Window = typename Features::Window;
  using Memory = WindowMemory<Config>;
  using Library = typename Memory::Library;
  static constexpr int kMaxFeatures = Features::kMaxFeatures;

  struct Parameters {
    WindowParameters<float> window;  ///< but for its sigma, which follows from sigma_px
    float sigma_px = 0.8F;           ///< of a feature's pixel
    typename Features::Parameters features;
    HandheldRotation::Parameters rotation;
    typename Memory::Parameters memory;
    GyroParameters gyro;  ///< of the samples, where there are any
    ReadoutTimes readout;
    float velocity_change_sigma = 1.0F;  ///< from frame to frame, depths a second; 0: anything
    int guided_inliers = 5;              ///< with a gyroscope that agrees, in place of min_inliers
    float forget_s = 30.0F;    ///< after a loss; where nothing was recognised, the new map counts
    int astray_features = 10;  ///< searched in frames of which the memory takes points
    float keyframe_parallax_px = 12.0F;  ///< mean since the last keyframe, its rotation apart
    float keyframe_share = 0.75F;  ///< found of the last one's features, below which one is made
    int keyframe_frames = 12;      ///< since the last one, at most, of a camera that does not stand
    float standing_px = 4.0F;      ///< mean flow, or parallax, below which it does
    int min_inliers = 8;
    float min_inlier_share = 0.4F;  ///< of those found
    /// Of a feature, in a row; then it is given up. Twice as many until the start is settled.
    int max_outliers = 2;
    int weak_frames = 3;       ///< in a row, after which tracking is lost
    float known_depth = 0.3F;  ///< relative sigma below which a depth counts as known
    float lens_sigma = 0.03F;  ///< of turns, relative: what else the calibration gets wrong
    /// Of the sigma: the square root of 64 landmarks, as if they shared all of their errors.
    float covariance_factor = 8.0F;
    float blind_rate_radps = 1.0F;      ///< sigma of a turn while too few landmarks are seen
    int work_limit = 11600;             ///< units of WorkBudget a frame, drawing apart
    std::int64_t max_step_us = 500000;  ///< a longer gap is not integrated
    std::uint64_t seed = 1;

    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const auto share = [](float v) { return v >= 0.0F && v <= 1.0F; };
      const bool parts = ok(window.validate()) && ok(features.validate()) &&
                         ok(rotation.validate()) && ok(memory.validate()) && ok(gyro.validate()) &&
                         guided_inliers >= 4;
      const bool good = parts && is_positive(sigma_px) && is_finite(velocity_change_sigma) &&
                        velocity_change_sigma >= 0.0F && is_positive(keyframe_parallax_px) &&
                        share(keyframe_share) && keyframe_frames >= 1 && is_finite(standing_px) &&
                        standing_px >= 0.0F && min_inliers >= 4 && share(min_inlier_share) &&
                        max_outliers >= 1 && max_outliers < 255 && is_finite(forget_s) &&
                        forget_s >= 0.0F && astray_features >= 0 && weak_frames >= 0 &&
                        is_positive(known_depth) && is_finite(lens_sigma) && lens_sigma >= 0.0F &&
                        is_positive(covariance_factor) && is_finite(blind_rate_radps) &&
                        blind_rate_radps >= 0.0F && work_limit >= 0 && max_step_us > 0 &&
                        max_step_us <= FrameInput::kLongestStepUs;
      return good ? Status::kOk : Status::kBadConfig;
    }
    /// Lengths in pixels are those of a picture whose longer side has 640: the same for another
    /// size. The error of a feature's pixel grows by the root alone: part of it is the view's blur,
    /// part that of the search.
    Parameters scaled_to(int width, int height) const {
      const float size = static_cast<float>(width > height ? width : height) / 640.0F;
      Parameters scaled = *this;
      scaled.sigma_px *= sqrt(size);
      scaled.keyframe_parallax_px *= size;
      scaled.standing_px *= size;
      scaled.features.border_px *= size;
      scaled.memory.inlier_px *= size;
      scaled.memory.recogniser.ransac.inlier_px *= size;
      return scaled;
    }
  };

  /// Starts anew. kBadConfig for an impossible camera or parameters; the tracker is then unchanged.
  Status initialise(const PinholeCamera<float>& camera, const Parameters& parameters);

  /// Tracks one frame. Refusals and kRepeatedImage: as HandheldTracker::process_frame(). Otherwise
  /// report.status is kOk, kLowTexture, kNoConsensus, kTimeGap or kLost.
  Status process_frame(const ImageView& image, std::int64_t t_us, const TickSource& ticks,
                       FrameReport& report);

  /// A gyroscope's sample, as GyroIntegrator::add(); those up to a frame's time come before it. Its
  /// turns then say where to search, once they agree with the pictures' they are measurements too,
  /// and bias and time offset are estimated. Without samples the video alone is used.
  /// kNotInitialised.
  Status add_angular_rate(const AngularRateSample& sample) {
    return input_.initialised() ? gyro_.add(sample, health_) : Status::kNotInitialised;
  }

  /// As HandheldTracker::set_work_limit().
  Status set_work_limit(int units) { return work_.set_limit(units); }

  /// With the focal length as it is estimated.
  const PinholeCamera<float>& camera() const { return camera_; }
  /// As initialise() was told.
  const PinholeCamera<float>& told_camera() const { return told_; }
  /// What the motion shows of the focal length. Where it does not, it stays as told.
  FocalScale focal_scale() const {
    return {window_.focal_scale(), window_.focal_sigma(), parameters_.window.focal_sigma};
  }
  Rigid<float> T_world_camera() const { return T_camera_world_.inverse(); }
  /// Of the pose, tangent (translation, rotation rad) in the axes of the camera: of the attitude
  /// relative to the first camera, of the position relative to the window's fixed keyframes.
  const Matrix<float, 6, 6>& pose_covariance() const { return covariance_; }
  const Window& window() const { return window_; }
  const Health& health() const { return health_; }
  const Library& library() const { return memory_.library(); }
  /// Samples, bias, time offset, and whether the gyroscope turns as the pictures do.
  const HandheldGyro& gyro() const { return gyro_; }
  /// Whether the map was begun anew and its place in the library's is not known yet.
  bool astray() const { return astray_; }
  TrackingState state() const { return state_; }
  /// Times that the present map's start was corrected.
  int corrected() const { return window_.corrected(); }

  // What place_on_features() asks of a map.
  int feature_count() const { return features_.size(); }
  LandmarkId feature_id(int i) const { return window_.id(features_[i].slot); }
  /// Whether a landmark is followed from frame to frame.
  bool follows(LandmarkId id) const {
    for (int i = 0; i < features_.size(); ++i) {
      if (feature_id(i) == id) return true;
    }
    return false;
  }
  /// kNotFound where its depth is not known at all.
  Status feature_position(int i, Vector3<float>& p, Matrix3<float>& covariance) const;
  void hash(Hash64& hash) const;

 private:
  /// Of the landmarks that a frame and the newest keyframe see; means, in pixels.
  struct ViewChange {
    int found = 0;  ///< by the frame, whether that keyframe sees them or not
    int common = 0;
    float flow = 0.0F;
    float parallax = 0.0F;  ///< what is left of it without the turn
  };
  static constexpr int kStepsOfClock = 4;
  static constexpr int kLeastKeyframe = 3;    ///< part of the cells without features, at least
  static constexpr int kMostWithoutStep = 4;  ///< frames; then the searches leave work for one

  Status track(FrameContext& frame, const FrameStep& step, StageTimer& timer);
  Rigid<float> predict(FrameContext& frame, const FrameStep& step);
  void find_features(FrameContext& frame, const FrameStep& step, const Rigid<float>& predicted);
  bool search(FrameContext& frame, const Rigid<float>& predicted, int first, int last, int radius);
  int first_radius(const FrameContext& frame, const FrameStep& step) const;
  bool first_agree(FrameContext& frame, Rigid<float>& pose);
  WindowPoseOptions<float> pose_options(const Rigid<float>& predicted) const;
  float expected_inverse_depth() const {
    return typical_inverse_depth_ > 0.0F ? typical_inverse_depth_
                                         : parameters_.window.first_inverse_depth;
  }
  int least_inliers() const {
    return gyro_.sure() ? parameters_.guided_inliers : parameters_.min_inliers;
  }
  void compare_gyro(const Rigid<float>& predicted, const Rigid<float>& pose);
  void note_gyro_frame(const FrameStep& step, std::int64_t t_us);
  void note_gyro_keyframe();
  void bridge(FrameContext& frame);
  Vector2<float> expected_pixel(const WindowFeature& feature, const Rigid<float>& predicted) const;
  void expose(const Rigid<float>& pose);
  Vector2<float> seen_direction(const WindowFeature& feature, const Rigid<float>& pose) const;
  Vector2<float> skewed(const Vector2<float>& direction, const WindowFeature& feature,
                        const RollingShutter& shutter, const Rigid<float>& pose) const;
  int gather(const Rigid<float>& pose);
  int estimate(FrameContext& frame, const Rigid<float>& predicted, Rigid<float>& pose);
  void accept(FrameContext& frame, const Rigid<float>& pose);
  void remove(FrameContext& frame, int i);
  void drop_missed(FrameContext& frame, const Rigid<float>& pose);
  void keep_keyframes(FrameContext& frame);
  ViewChange view_change() const;
  bool wants_keyframe(const ViewChange& change) const;
  bool make_keyframe(FrameContext& frame, bool moved);
  void observe_features();
  void note_pose();
  void forget_motion() {
    motion_.forget();
    forget_exposures();
  }
  void forget_exposures() {
    shutter_.forget_motion();
    shutter_before_.forget_motion();
  }
  void amend_keyframe(const RollingShutter& shutter);
  void improve_window(FrameContext& frame);
  void note_weak(FrameContext& frame);
  bool begin_anew(FrameContext& frame);
  int known_depths() const;
  bool depths_hold() const;
  bool takes_points(const FrameContext& frame) const;
  void keep_memory(FrameContext& frame);
  void seek_map(FrameContext& frame, const FrameStep& step, bool holds);
  void return_to_map(FrameContext& frame);
  void follow_focal() { camera_ = told_.with_focal_scale(window_.focal_scale()); }
  void update_covariance();
  Matrix3<float> attitude_by_focal() const;

  Parameters parameters_;
  PinholeCamera<float> told_;    ///< by initialise()
  PinholeCamera<float> camera_;  ///< with the focal length as it is estimated
  Window window_;
  Features features_;
  Memory memory_;
  WindowMotion motion_;
  RollingShutter shutter_;         ///< of the present frame
  RollingShutter shutter_before_;  ///< of the frame that T_camera_world_ is of
  HandheldGyro gyro_;
  HandheldRotation rotation_;
  FrameInput input_;
  RepeatedImage repeated_;
  InputClock clock_;
  FrameWork work_;
  Random random_;
  Health health_;
  LandmarkId next_id_ = 1;
  TrackingState state_ = TrackingState::kInitialising;
  Rigid<float> T_camera_world_;
  Matrix<float, 6, 6> frame_covariance_ = Matrix<float, 6, 6>::Zero();
  Matrix<float, 6, 6> covariance_ = Matrix<float, 6, 6>::Zero();
  Matrix3<float> attitude_[WindowBounds::kPoses];          ///< of keyframes, in world axes
  Matrix3<float> lost_attitude_ = Matrix3<float>::Zero();  ///< when tracking was lost
  float pose_age_s_ = 0.0F;  ///< of T_camera_world_, at the frame's time
  float unseen_s_ = 0.0F;    ///< since the landmarks last showed a pose
  bool gap_ = false;         ///< since then nothing is known of the movement for a while
  float blind_s_ = 0.0F;
  float blind_variance_ = 0.0F;  ///< of the turn while a gyroscope told it, rad^2
  float typical_inverse_depth_ = 0.0F;
  float astray_s_ = 0.0F;
  float guided_information_ = 0.0F;  ///< of the frame's attitude, that a gyroscope added
  bool astray_ = false;
  bool returned_ = false;      ///< to the map, since the last loss
  bool takes_points_ = false;  ///< the memory takes points of this frame
  int inliers_ = 0;
  int weak_frames_ = 0;
  int since_keyframe_ = 0;
  int frames_without_step_ = 0;
  int keyframe_work_ = 0;  ///< units that one put off needs; 0: none was
  int reserved_ = 0;       ///< of these, in the present frame
  int at_keyframe_ = 0;    ///< features, after the last one
  WindowSighting<float> sightings_[kMaxFeatures];
  int sighted_[kMaxFeatures] = {};  ///< feature of each
};

}  // namespace cairn

#include "cairn/runtime/detail/window_tracker_gyro.hpp"
#include "cairn/runtime/detail/window_tracker_impl.hpp"
#include "cairn/runtime/detail/window_tracker_map.hpp"
#include "cairn/runtime/detail/window_tracker_memory.hpp"
#include "cairn/runtime/detail/window_tracker_search.hpp"

#pragma once

#include <cstdint>

#include "cairn/base/config.hpp"
#include "cairn/base/hash.hpp"
#include "cairn/geometry/focal_scale.hpp"
#include "cairn/tracking/camera_track.hpp"
#include "cairn/tracking/frame_input.hpp"
#include "cairn/tracking/keyframe_choice.hpp"
#include "cairn/tracking/repeated_image.hpp"
#include "cairn/tracking/stage_timer.hpp"
#include "cairn/tracking/window_covariance.hpp"
#include "cairn/tracking/window_features.hpp"
#include "cairn/tracking/window_measurement.hpp"
#include "cairn/tracking/window_memory.hpp"

namespace cairn {

namespace work {

inline constexpr int kWindowFrame = 120;   ///< prediction, lists, reports
inline constexpr int kWindowNewest = 130;  ///< of a keyframe: the one to drop, the typical depth
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
  using Measurement = WindowMeasurement<Config>;
  static constexpr int kMaxFeatures = Features::kMaxFeatures;

  /// Those of the parts, each of which keeps its own, and the tracker's.
  struct Parameters : CameraTrack::Parameters,
                      KeyframeChoice::Parameters,
                      Measurement::Parameters,
                      WindowCovariance::Parameters {
    WindowParameters<float> window;  ///< but for its sigma, which follows from sigma_px
    float sigma_px = 0.8F;           ///< of a feature's pixel
    typename Features::Parameters features;
    typename Memory::Parameters memory;
    ReadoutTimes readout;
    float forget_s = 30.0F;    ///< after a loss; where nothing was recognised, the new map counts
    int astray_features = 10;  ///< searched in frames of which the memory takes points
    /// Of a feature, in a row; then it is given up. Twice as many until the start is settled.
    int max_outliers = 2;
    int weak_frames = 3;                ///< in a row, after which tracking is lost
    int work_limit = 11600;             ///< units of WorkBudget a frame, drawing apart
    std::int64_t max_step_us = 500000;  ///< a longer gap is not integrated
    std::uint64_t seed = 1;

    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const bool parts =
          ok(CameraTrack::Parameters::validate()) && ok(KeyframeChoice::Parameters::validate()) &&
          ok(Measurement::Parameters::validate()) && ok(WindowCovariance::Parameters::validate()) &&
          ok(window.validate()) && ok(features.validate()) && ok(memory.validate());
      const bool good = parts && is_positive(sigma_px) && max_outliers >= 1 && max_outliers < 255 &&
                        is_finite(forget_s) && forget_s >= 0.0F && astray_features >= 0 &&
                        weak_frames >= 0 && work_limit >= 0 && max_step_us > 0 &&
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
    return input_.initialised() ? track_.add(sample, health_) : Status::kNotInitialised;
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
  Rigid<float> T_world_camera() const { return track_.pose().inverse(); }
  /// Of the pose, tangent (translation, rotation rad) in the axes of the camera: of the attitude
  /// relative to the first camera, of the position relative to the window's fixed keyframes.
  const Matrix<float, 6, 6>& pose_covariance() const { return covariance_.value(); }
  const Window& window() const { return window_; }
  const Health& health() const { return health_; }
  const Library& library() const { return memory_.library(); }
  /// Samples, bias, time offset, and whether the gyroscope turns as the pictures do.
  const HandheldGyro& gyro() const { return track_.gyro(); }
  /// Whether the map was begun anew and its place in the library's is not known yet.
  bool astray() const { return memory_.astray(); }
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
  static constexpr int kStepsOfClock = 4;
  static constexpr int kLeastKeyframe = 3;    ///< part of the cells without features, at least
  static constexpr int kMostWithoutStep = 4;  ///< frames; then the searches leave work for one

  Status track(FrameContext& frame, const FrameStep& step, StageTimer& timer);
  typename Measurement::Limits search_limits(const FrameContext& frame) const;
  void compare_gyro(const Rigid<float>& predicted, const Rigid<float>& pose);
  void accept(FrameContext& frame, const Rigid<float>& pose);
  void note_weak(FrameContext& frame);
  void remove(FrameContext& frame, int i);
  void drop_missed(FrameContext& frame, const Rigid<float>& pose);
  void keep_keyframes(FrameContext& frame);
  bool make_keyframe(FrameContext& frame, bool moved);
  void begin_keyframe();
  void improve_window(FrameContext& frame);
  bool begin_anew(FrameContext& frame);
  void return_to_map(FrameContext& frame);
  void update_covariance() {
    if (window_.keyframes() == 0) return;
    covariance_.update(window_, track_.pose(), measurement_.covariance());
  }
  void follow_focal() { camera_ = told_.with_focal_scale(window_.focal_scale()); }

  Parameters parameters_;
  PinholeCamera<float> told_;    ///< by initialise()
  PinholeCamera<float> camera_;  ///< with the focal length as it is estimated
  CameraTrack track_;
  Features features_;
  Measurement measurement_;
  KeyframeChoice choice_;
  Window window_;
  Memory memory_;
  WindowCovariance covariance_;
  FrameInput input_;
  RepeatedImage repeated_;
  InputClock clock_;
  FrameWork work_;
  Random random_;
  Health health_;
  LandmarkId next_id_ = 1;
  TrackingState state_ = TrackingState::kInitialising;
  bool takes_points_ = false;  ///< the memory takes points of this frame
  int weak_frames_ = 0;
  int frames_without_step_ = 0;
};

}  // namespace cairn

#include "cairn/runtime/detail/window_tracker_impl.hpp"
#include "cairn/runtime/detail/window_tracker_map.hpp"

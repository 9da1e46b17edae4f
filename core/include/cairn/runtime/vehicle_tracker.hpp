#pragma once

#include <cstdint>

#include "cairn/numeric/hash.hpp"
#include "cairn/numeric/health.hpp"
#include "cairn/numeric/random.hpp"
#include "cairn/planar/increment.hpp"
#include "cairn/planar/types.hpp"
#include "cairn/runtime/augmenter.hpp"
#include "cairn/runtime/config.hpp"
#include "cairn/runtime/frame_report.hpp"
#include "cairn/tracking/candidate_pool.hpp"
#include "cairn/tracking/feature_supply.hpp"
#include "cairn/tracking/landmark_search.hpp"

namespace cairn {

/// Camera tracking on a planar vehicle from video and odometry (paper A): a planar SLAM filter with
/// camera landmarks (`Filter`: EkfSlam, LiftedIekfSlam or GroupIekfSlam with LandmarkDim 3) behind
/// the vision front end. Vehicle frame: x forward, y left, z up, origin on the floor.
///
/// All storage is inside; the caller decides where an instance lies. One frame costs at most
/// `max_searches` landmark searches, one filter update of as many matches, one step of the
/// candidate pool and `cells_per_frame` cells of corner detection.
template <class Config, class Filter>
class VehicleTracker {
 public:
  static constexpr int kMaxLandmarks = Config::kMaxLandmarks;
  static constexpr int kMaxKeyframes = Config::kMaxKeyframes;
  using Supply = FeatureSupply<Config::kMaxImageWidth>;
  using Pool = CandidatePool<Config::kMaxCandidates, Config::kMaxKeyframes>;

  /// All landmarks share the error of the heading: one frame in a hundred without any of them would
  /// be too many, so windows and gates are at 99.99 % (chi-square, 2 degrees of freedom).
  static constexpr float kWideGate = 18.42F;

  struct OdometryNoise {
    float sigma_speed_mps = 0.1F;  ///< per sample
    float sigma_turn = 0.0873F;    ///< steering angle, rad, or yaw rate, rad/s, per sample
    float wheelbase_m = 0.5F;      ///< kAckermann only
    float sample_period_s = 0.1F;  ///< the period at which the noise above is stated
    float steady_s = 0.3F;         ///< low pass of the readings at which noise is linearised
  };

  struct Parameters {
    /// The filter's own re-acquisition widens the pose at every prediction, which at frame rate
    /// would outrun the search windows: off, the tracker's states take its place. Two supporters
    /// are enough: a young map has no more, and odometry bounds what they can do.
    Parameters() {
      filter.reacquire_after = 0;
      filter.ransac.min_support = 2;
      filter.gate = kWideGate;
      search.gate = kWideGate;
    }

    PlanarParameters<float> filter;
    OdometryNoise odometry;
    SearchParameters search;
    typename Supply::Parameters supply;
    typename Pool::Parameters pool;
    float sigma_px = 0.5F;
    float tracked_yaw_rad = 3e-4F;     ///< error of the filter's turn in one frame, while tracking
    int target_in_view = 40;           ///< landmarks and candidates wanted in view
    int max_births_per_frame = 16;     ///< new candidates
    int keyframe_interval = 8;         ///< frames between frames with new candidates
    int max_promotions_per_frame = 4;  ///< candidates that become landmarks
    int max_searches = 40;
    int min_inliers = 4;
    int uncertain_frames_to_lost = 60;
    std::int64_t max_step_us = 1000000;  ///< a longer gap is not integrated
    std::uint64_t seed = 1;
  };

  struct Start {
    PlanarPose<float> pose;
    Matrix3<float> covariance = Matrix3<float>::Zero();  ///< of (x, y, heading)
    std::int64_t t_us = 0;
  };

  /// Starts anew at a known pose. kBadConfig for an impossible camera; the tracker is then
  /// unchanged.
  Status initialise(const PinholeCamera<float>& camera, const Rigid<float>& T_vehicle_camera,
                    const Start& start, const Parameters& parameters);

  /// Integrates odometry up to the sample's time. kTimeBackwards, kNonFiniteInput: sample refused.
  /// kTimeGap: time moved on, motion over the gap not integrated.
  Status add_odometry(const OdometrySample& sample);

  /// Tracks one frame; odometry up to its time should have been added, the rest is extrapolated.
  /// kInvalidArgument (wrong size), kDuplicate, kTimeBackwards: frame refused.
  Status process_frame(const ImageView& image, std::int64_t t_us, const TickSource& ticks,
                       FrameReport& report);

  /// Draws the virtual objects of `augmenter` into `overlay` as this frame's pose sees them. Where
  /// it wants an object, one is placed on the floor ahead of the vehicle first. Adds its ticks to
  /// `report` as Stage::kRender.
  void augment(Augmenter& augmenter, const MutableImageView& overlay, const TickSource& ticks,
               FrameReport& report);

  const Filter& filter() const { return filter_; }
  const PinholeCamera<float>& camera() const { return camera_; }
  const Rigid<float>& T_vehicle_camera() const { return T_vehicle_camera_; }
  Rigid<float> T_world_camera() const { return lift(filter_.mean_pose()) * T_vehicle_camera_; }
  const Health& health() const { return health_; }
  TrackingState state() const { return state_; }
  void hash(Hash64& hash) const;

 private:
  /// What search_landmarks asks of a filter.
  struct View {
    const VehicleTracker& tracker;
    int size() const { return tracker.filter_.landmark_count(); }
    LandmarkId id(int slot) const { return tracker.filter_.landmark_id(slot); }
    Status predict(int slot, PixelPrediction<float>& p) const {
      return tracker.filter_.predict_pixel(slot, tracker.camera_, tracker.T_vehicle_camera_,
                                           tracker.parameters_.sigma_px, p);
    }
    const PinholeCamera<float>& camera() const { return tracker.camera_; }
    Rigid<float> T_world_camera() const { return tracker.T_world_camera(); }
  };

  static constexpr float kShortestPath_m = 1e-3F;

  static Rigid<float> lift(const PlanarPose<float>& pose);
  Status check_input(const ImageView& image, std::int64_t t_us);
  Status integrate_to(std::int64_t t_us);
  PlanarIncrement<float> increment_of(const OdometrySample& motion, float dt, float scale) const;
  OdometrySample steadied(const OdometrySample& sample) const;
  void update(FixedVector<PixelMatch<float>, kMaxLandmarks>& matches, FrameReport& report);
  void remove_landmarks(FrameReport& report);
  void make_room(FrameReport& report);
  void remove_landmark(int slot, FrameReport& report);
  void build_map(const ImageView& image, FrameReport& report);
  void promote_candidates(FrameReport& report);
  bool add_promoted(const Promotion& promotion, FrameReport& report);
  bool begin_keyframe();
  void end_keyframes(bool make_room);
  void judge(FrameReport& report);
  typename Pool::Parameters pool_parameters() const;

  PinholeCamera<float> camera_;
  Rigid<float> T_vehicle_camera_;
  Parameters parameters_;
  Filter filter_;
  LandmarkTable<kMaxLandmarks> table_;
  Pool pool_;
  Supply supply_;
  union Scratch {
    SearchScratch search;
    typename Supply::Scratch supply;
  } scratch_;
  Random random_;
  Health health_;
  float frame_step_s_ = 0.0F;
  float turn_variance_ = 0.0F;  ///< of the odometry's turn since the last frame, rad^2
  OdometrySample motion_;       ///< last sample: held for extrapolation
  OdometrySample steady_motion_;
  TrackingState state_ = TrackingState::kInitialising;
  bool initialised_ = false;
  bool has_frame_ = false;
  bool has_motion_ = false;
  std::int64_t time_us_ = 0;  ///< of the filter's pose
  std::int64_t last_frame_us_ = 0;
  LandmarkId next_id_ = 1;
  FixedVector<LandmarkId, kMaxKeyframes> keyframes_;  ///< past positions in the filter
  int frames_since_keyframe_ = 0;
  int weak_frames_ = 0;
};

}  // namespace cairn

#include "cairn/runtime/detail/vehicle_tracker_impl.hpp"

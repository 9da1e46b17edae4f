#pragma once

#include <cstdint>

#include "cairn/mono/mono_ekf.hpp"
#include "cairn/numeric/hash.hpp"
#include "cairn/numeric/health.hpp"
#include "cairn/numeric/random.hpp"
#include "cairn/runtime/augmenter.hpp"
#include "cairn/runtime/config.hpp"
#include "cairn/runtime/frame_report.hpp"
#include "cairn/tracking/anchor.hpp"
#include "cairn/tracking/feature_supply.hpp"
#include "cairn/tracking/landmark_search.hpp"

namespace cairn {

/// Camera tracking from video alone (paper B): MonoEkf behind the vision front end. The world is
/// the camera of the first frame; lengths are in the filter's own unit (its initial inverse depth
/// is 1 / unit).
///
/// All storage is inside; the caller decides where an instance lies. One frame costs at most
/// `max_searches` landmark searches, one filter update of as many matches, and `cells_per_frame`
/// cells of corner detection.
template <class Config>
class HandheldTracker {
 public:
  static constexpr int kMaxFeatures = Config::kMaxFeatures;
  using Filter = MonoEkf<float, kMaxFeatures>;
  using Supply = FeatureSupply<Config::kMaxImageWidth>;

  /// The defaults of the members but for two: landmarks are found by their patches, and a pixel's
  /// standard deviation is 0.7 (docs/reference/turntable-results.md has the comparison).
  struct Parameters {
    Parameters() {
      search.method = SearchMethod::kPatch;
      filter.sigma_px = 0.7F;
    }
    typename Filter::Parameters filter;
    SearchParameters search;
    typename Supply::Parameters supply;
    int target_features = kMaxFeatures;  ///< kept measured per frame
    int max_births_per_frame = 6;
    int max_searches = kMaxFeatures;
    int min_inliers = 6;  ///< fewer: uncertain
    int uncertain_frames_to_lost = 20;
    /// A start is on trial for `start_blocks` blocks of frames. Where the innovations of one block
    /// exceed `start_misfit` times their covariance, the filter has settled in the mirrored
    /// solution (translation and relief reversed): the frame is lost and the map begins anew at its
    /// pose, at most `max_restarts` times.
    int start_blocks = 5;
    int start_block_frames = 15;
    float start_misfit = 1.3F;
    int max_restarts = 5;
    /// Motion noise over the first frames of the first start (at most those on trial): while
    /// rotation and translation look alike, a filter that expects fast motion settles in a wrong
    /// solution.
    int calm_frames = 30;
    float calm_velocity_noise = 0.14F;
    float calm_rate_noise = 0.35F;
    std::int64_t max_step_us = 500000;  ///< a longer gap is not integrated
    std::uint64_t seed = 1;
  };

  /// Starts anew. kBadConfig for an impossible camera or parameters; the tracker is then unchanged.
  Status initialise(const PinholeCamera<float>& camera, const Parameters& parameters);

  /// Tracks one frame. kInvalidArgument (wrong size), kDuplicate, kTimeBackwards: frame refused,
  /// tracker unchanged but for its counters. Otherwise report.status is kOk, kLowTexture,
  /// kNoConsensus, kTimeGap or kLost, and the pose is the filter's best.
  Status process_frame(const ImageView& image, std::int64_t t_us, const TickSource& ticks,
                       FrameReport& report);

  /// Draws the virtual objects of `augmenter` into `overlay` as this frame's pose sees them. Where
  /// it wants an object, one is placed first: on the plane of the landmarks where they have one,
  /// else at their median depth. Adds its ticks to `report` as Stage::kRender.
  void augment(Augmenter& augmenter, const MutableImageView& overlay, const TickSource& ticks,
               FrameReport& report);

  const Filter& filter() const { return filter_; }
  const PinholeCamera<float>& camera() const { return camera_; }
  const Health& health() const { return health_; }
  TrackingState state() const { return state_; }
  void hash(Hash64& hash) const;

 private:
  struct StartTrial {
    int frames = 0;
    int restarts = 0;
    float misfit = 0.0F;  ///< of this block, by degree of freedom 1 on average
    float dof = 0.0F;
  };
  /// What search_landmarks asks of a filter.
  struct View {
    const Filter& filter;
    int size() const { return filter.feature_count(); }
    LandmarkId id(int slot) const { return filter.feature_id(slot); }
    Status predict(int slot, PixelPrediction<float>& p) const {
      return filter.predict_feature(slot, p);
    }
    PinholeCamera<float> camera() const { return filter.camera(); }
    Rigid<float> T_world_camera() const { return filter.T_world_camera(); }
  };

  Status check_input(const ImageView& image, std::int64_t t_us);
  Status predict(std::int64_t t_us);
  void update(FixedVector<PixelMatch<float>, kMaxFeatures>& matches, FrameReport& report);
  void remove_features(FrameReport& report);
  void add_features(const ImageView& image, FrameReport& report);
  void watch_start(FrameReport& report);
  void judge(FrameReport& report);
  bool object_place(Rigid<float>& T_world_object);

  PinholeCamera<float> camera_;
  Parameters parameters_;
  Filter filter_;
  LandmarkTable<kMaxFeatures> table_;
  Supply supply_;
  union Scratch {
    SearchScratch search;
    typename Supply::Scratch supply;
  } scratch_;
  Random random_;
  Health health_;
  TrackingState state_ = TrackingState::kInitialising;
  bool initialised_ = false;
  bool has_frame_ = false;
  std::int64_t last_t_us_ = 0;
  LandmarkId next_id_ = 1;
  int weak_frames_ = 0;
  StartTrial start_;
};

}  // namespace cairn

#include "cairn/runtime/detail/handheld_tracker_impl.hpp"

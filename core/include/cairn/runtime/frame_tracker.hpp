#pragma once

#include <cstdint>
#include <new>

#include "cairn/ar/augmenter.hpp"
#include "cairn/base/config.hpp"
#include "cairn/base/hash.hpp"
#include "cairn/base/health.hpp"
#include "cairn/map/shared_map.hpp"
#include "cairn/map/visibility.hpp"
#include "cairn/numeric/random.hpp"
#include "cairn/planar/types.hpp"
#include "cairn/tracking/candidate_pool.hpp"
#include "cairn/tracking/expected_search.hpp"
#include "cairn/tracking/feature_supply.hpp"
#include "cairn/tracking/frame_report.hpp"
#include "cairn/tracking/frame_work.hpp"
#include "cairn/tracking/landmark_search.hpp"
#include "cairn/tracking/map_frame.hpp"
#include "cairn/tracking/odometry_integrator.hpp"
#include "cairn/tracking/place_look_up.hpp"
#include "cairn/tracking/planar_pose_search.hpp"
#include "cairn/tracking/reentry_rule.hpp"
#include "cairn/tracking/tracking_evidence.hpp"

namespace cairn {

/// Camera tracking on a planar vehicle from video and odometry (paper A): a planar SLAM filter with
/// camera landmarks (`Filter`: EkfSlam, LiftedIekfSlam or GroupIekfSlam with LandmarkDim 3) behind
/// the vision front end. Vehicle frame: x forward, y left, z up, origin on the floor.
///
/// This is the module "tracking and registration" of the paper. The active landmarks, whose error
/// is tied to the pose's, live in its filter; the long memory is the map library, which it reads
/// through a snapshot and which a MapBuilder keeps from the messages it sends (SharedMap).
/// Landmarks of the library come back into the filter when they come into view again, and tell the
/// place when tracking is lost.
///
/// All storage is inside; the caller decides where an instance lies. One frame costs at most
/// `max_searches` landmark searches, one filter update of as many matches, one step of the
/// candidate pool, `cells_per_frame` cells of corner detection and `library_slots_per_frame`
/// projections; while lost, one step of the relocaliser and at most two passes over the library in
/// place of the map's growth. All of it together ends within set_work_limit(): the pose comes
/// first, then the map (frame_tracker_work_impl.hpp has the rules).
template <class Config, class Filter>
class FrameTracker {
 public:
  static constexpr int kMaxLandmarks = Config::kMaxLandmarks;
  static constexpr int kMaxKeyframes = Config::kMaxKeyframes;
  using Supply = FeatureSupply<Config::kMaxImageWidth>;
  using Pool = CandidatePool<Config::kMaxCandidates, Config::kMaxKeyframes>;
  using Map = SharedMap<Config>;
  using Library = typename Map::Library;
  using Places = PlaceLookUp<Config>;

  /// All landmarks share the error of the heading: one frame in a hundred without any of them would
  /// be too many, so windows and gates are at 99.99 % (chi-square, 2 degrees of freedom).
  static constexpr float kWideGate = 18.42F;

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
    int target_in_view = 32;           ///< landmarks and candidates wanted in view
    int max_births_per_frame = 6;      ///< new candidates
    int keyframe_interval = 8;         ///< frames between frames with new candidates
    int max_promotions_per_frame = 4;  ///< candidates that become landmarks
    float floor_sigma_m = 0.02F;       ///< how even the floor is; 0: heights tell nothing
    float floor_told_m = 0.08F;        ///< a height known so well tells floor from other things
    float floor_gate = 3.84F;          ///< 95 %
    int max_searches = 40;
    TrackingEvidence::Parameters evidence;
    int min_sightings_to_store = 6;    ///< of a landmark that leaves the filter
    int mature_sightings = 12;         ///< from then on a landmark is also in the library
    int library_slots_per_frame = 48;  ///< looked through for landmarks that come into view
    int max_reentries_per_frame = 3;
    float library_inflation = 4.0F;    ///< of the variances of landmarks taken back
    float map_height_sigma_m = 0.02F;  ///< of the library as a whole
    MapDrift map_drift;                ///< of the library's frame
    int expected_in_view = 4;          ///< library landmarks by odometry: it has the place
    typename Places::Parameters look_up;
    int work_limit = 10000;              ///< units of WorkBudget a frame, drawing apart
    int max_frames_without_mapping = 8;  ///< for want of work; then mapping gets half of a frame
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
  Status process_frame(const ImageView& image, std::int64_t t_us, const TickSource& ticks, Map& map,
                       FrameReport& report);

  /// Units of work that each frame may take from now on (FrameCut tells what it gave up for it).
  /// An input like any other: logs record it. kInvalidArgument for a negative one.
  Status set_work_limit(int units) { return work_.set_limit(units); }

  /// Ids below `next` are taken: after a library came from elsewhere.
  void reserve_ids(LandmarkId next) {
    if (next <= next_id_) return;
    next_id_ = next;
    reentry_.take_for_old(next);
  }
  LandmarkId next_id() const { return next_id_; }

  /// Draws the virtual objects of `augmenter` into `overlay` as this frame's pose sees them. Where
  /// it wants an object, one is placed on the floor ahead of the vehicle first. Adds its ticks to
  /// `report` as Stage::kRender.
  void augment(Augmenter& augmenter, const MutableImageView& overlay, const TickSource& ticks,
               FrameReport& report);

  const Filter& filter() const { return filter_; }
  const PinholeCamera<float>& camera() const { return camera_; }
  const Rigid<float>& T_vehicle_camera() const { return T_vehicle_camera_; }
  Rigid<float> T_world_camera() const { return on_floor(filter_.mean_pose()) * T_vehicle_camera_; }
  const LandmarkTable<kMaxLandmarks>& landmarks() const { return table_; }
  const Health& health() const { return health_; }
  TrackingState state() const { return evidence_.state(); }
  void hash(Hash64& hash) const;

 private:
  /// What search_landmarks asks of a filter.
  struct View {
    const FrameTracker& tracker;
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

  Status check_input(const ImageView& image, std::int64_t t_us);
  void keep_map(const ImageView& image, Map& map, FrameReport& report);
  void update(FixedVector<PixelMatch<float>, kMaxLandmarks>& matches, FrameReport& report);
  void note_matches(const ImageView& image, Map& map,
                    const FixedVector<PixelMatch<float>, kMaxLandmarks>& matches,
                    FrameReport& report);
  void use_floor(TrackedLandmark& landmark);

  // What a frame can afford: detail/frame_tracker_work_impl.hpp.
  void begin_work();
  int updating_work(int matches) const;
  int searching_work() const;
  int searches_planned() const;
  void afford_update(FixedVector<PixelMatch<float>, kMaxLandmarks>& matches, FrameReport& report);

  // The filter's landmarks: detail/frame_tracker_map_impl.hpp.
  void remove_landmarks(Map& map, FrameReport& report);
  void make_room(Map& map, int reserve, int limit, FrameReport& report);
  void remove_landmark(int slot, FrameReport& report);
  void build_map(const ImageView& image, bool growing, FrameReport& report);
  void begin_candidates(const ImageView& image, FrameReport& report);
  void promote_candidates(FrameReport& report);
  bool add_promoted(const Promotion& promotion, FrameReport& report);
  bool begin_keyframe();
  void end_keyframes(bool make_room);
  typename Pool::Parameters pool_parameters() const;

  // The library: detail/frame_tracker_library_impl.hpp.
  using LibraryLandmark = typename Library::Landmark;
  static constexpr int kReentryCandidates = 24;
  /// Whether this filter can hold landmarks of a library.
  static constexpr bool kTakesLandmarksBack = Filter::kHasWorldLandmarks;
  /// Memory of what takes landmarks back from the library.
  struct ComingBack {
    SearchScratch search;
    VisibleLandmark<float> visible[kReentryCandidates];
    FixedVector<PixelMatch<float>, kMaxLandmarks> matches;
    FixedVector<LandmarkId, kReentryCandidates> entered;
  };

  void tell(Map& map, typename Map::Message::Kind kind, LandmarkId id);
  void store(int slot, const TrackedLandmark& landmark, Map& map);
  void reenter_landmarks(const Library& library, FrameReport& report);
  bool reenter(const LibraryLandmark& archived, FrameReport& report);
  Rigid<float> T_world_map() const;
  PlanarPose<float> in_map(const PlanarPose<float>& pose) const;
  void relocalise(const ImageView& image, const Library& library, Map& map, FrameReport& report);
  bool looks_for_place() const {
    return has_library_ && look_up_.wanted(parameters_.look_up, evidence_.weak_frames());
  }
  void refuse_place();
  bool plausible(const Rigid<float>& T_map_camera) const;
  bool in_known_place(const Library& library);
  bool come_back(const ImageView& image, const Library& library, Map& map, FrameReport& report);

  PinholeCamera<float> camera_;
  Rigid<float> T_vehicle_camera_;
  Parameters parameters_;
  Filter filter_;
  LandmarkTable<kMaxLandmarks> table_;
  Pool pool_;
  Supply supply_;
  /// Nothing in it outlives a frame: copies copy nothing.
  union Scratch {
    Scratch() {}
    Scratch(const Scratch&) {}
    Scratch& operator=(const Scratch&) { return *this; }
    ~Scratch() = default;
    SearchScratch search;
    typename Supply::Scratch supply;
    typename Places::Scratch places;
    ComingBack coming_back;
  } scratch_;
  FixedVector<PixelMatch<float>, kMaxLandmarks> matches_;  ///< of one frame: not on the stack
  Random random_;
  Health health_;
  FrameWork work_;
  bool initialised_ = false;
  bool has_frame_ = false;
  std::int64_t last_frame_us_ = 0;
  float frame_step_s_ = 0.0F;
  OdometryIntegrator odometry_;
  TrackingEvidence evidence_;
  LandmarkId next_id_ = 1;
  FixedVector<LandmarkId, kMaxKeyframes> keyframes_;  ///< past positions in the filter
  int frames_since_keyframe_ = 0;

  MapFrame<Filter> map_frame_;
  Matrix3<float> tracked_covariance_ = Matrix3<float>::Zero();  ///< of the pose when last tracked
  int next_library_slot_ = 0;
  ReentryRule reentry_;
  Places look_up_;
  bool has_library_ = false;  ///< something to look a place up in
};

}  // namespace cairn

#include "cairn/runtime/detail/frame_tracker_impl.hpp"
#include "cairn/runtime/detail/frame_tracker_library_impl.hpp"
#include "cairn/runtime/detail/frame_tracker_map_impl.hpp"
#include "cairn/runtime/detail/frame_tracker_work_impl.hpp"

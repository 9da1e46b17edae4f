#pragma once

#include <cstdint>
#include <new>

#include "cairn/ar/augmenter.hpp"
#include "cairn/ar/plane_fit.hpp"
#include "cairn/base/config.hpp"
#include "cairn/base/hash.hpp"
#include "cairn/base/health.hpp"
#include "cairn/map/map_file.hpp"
#include "cairn/map/visibility.hpp"
#include "cairn/mono/mono_ekf.hpp"
#include "cairn/numeric/random.hpp"
#include "cairn/tracking/expected_search.hpp"
#include "cairn/tracking/feature_supply.hpp"
#include "cairn/tracking/frame_report.hpp"
#include "cairn/tracking/frame_work.hpp"
#include "cairn/tracking/landmark_search.hpp"
#include "cairn/tracking/relocaliser.hpp"

namespace cairn {

/// Camera tracking from video alone (paper B): MonoEkf behind the vision front end. The world is
/// the camera of the first frame; lengths are in the filter's own unit (its initial inverse depth
/// is 1 / unit).
///
/// Landmarks that are well known are archived in a library. Where nothing of the filter's map is
/// seen for a while the tracker is lost: it holds its pose, draws nothing and looks the place up in
/// the library, until a pose is recognised, confirmed in the frame after, and followed for some
/// frames. It never goes on from a guess: with next to nothing in the library the map begins anew.
///
/// All storage is inside; the caller decides where an instance lies. One frame costs at most
/// `max_searches` landmark searches, one filter update of as many matches, and `cells_per_frame`
/// cells of corner detection; while lost, steps of the relocaliser or 2 * kReturning searches. All
/// of it together ends within set_work_limit(): the pose comes first, then the map.
template <class Config>
class HandheldTracker {
 public:
  static constexpr int kMaxFeatures = Config::kMaxFeatures;
  using Filter = MonoEkf<float, kMaxFeatures>;
  using Supply = FeatureSupply<Config::kMaxImageWidth>;
  /// An image is compared with the whole library within a few frames, so that the hand has moved
  /// little when the pose found is confirmed: the library is bounded for that. Without odometry a
  /// place takes more features, and the pose is sought of the best matches alone.
  struct LibraryConfig : Config {
    static constexpr int kLibraryLandmarks =
        Config::kLibraryLandmarks < 256 ? Config::kLibraryLandmarks : 256;
    static constexpr int kPlaceFeatures = 144;
    static constexpr int kPlaceMatches = 40;
  };
  using Library = MapLibrary<LibraryConfig>;
  using Places = Relocaliser<LibraryConfig>;

  /// The defaults of the members but for these: landmarks are found by their patches, and a pixel's
  /// standard deviation is 0.7 (docs/results/handheld.md has the comparison). A place is
  /// looked up with weak corners and few matches: what is found is a proposal, to be confirmed.
  struct Parameters {
    Parameters() {
      search.method = SearchMethod::kPatch;
      filter.sigma_px = 0.7F;
      places.fast_threshold = 12;
      places.min_score = 14;
      places.max_capture_work = 11000;
      places.max_pairs_per_step = 4096;
      places.samples_per_step = 24;
      places.ransac.min_inliers = 5;
      places.ransac.inlier_px = 8.0F;
      places.ransac.max_hypotheses = 300;
    }
    typename Filter::Parameters filter;
    SearchParameters search;
    typename Supply::Parameters supply;
    int target_features = kMaxFeatures;  ///< kept measured per frame
    int max_births_per_frame = 6;
    int max_searches = kMaxFeatures;
    int min_inliers = 6;  ///< fewer: uncertain
    int uncertain_frames_to_lost = 10;
    float min_return_share = 0.3F;  ///< of the landmarks looked for, after two weak frames
    int weak_births = 3;            ///< weak frames in which landmarks still begin
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
    int mature_sightings = 12;       ///< from then on a landmark is also in the library, and
                                     ///< renewed there as often as this number doubles
    int min_sightings_to_store = 6;  ///< of a landmark that leaves the filter
    float max_depth_sigma = 0.15F;   ///< of a stored landmark, as a share of its distance
    int min_known = 16;  ///< library landmarks; with fewer a lost tracker begins its map anew
    int min_found = 8;   ///< of them in the frame after the one that was recognised,
    float min_found_share = 0.4F;    ///< and of those that should be seen
    int max_confirm_distance = 120;  ///< of their descriptors, steered as the pose has it
    int probation_frames = 10;       ///< tracked, until a place counts as found
    typename Places::Parameters places;
    int work_limit = 12000;              ///< units of WorkBudget a frame, drawing apart
    int max_frames_without_mapping = 8;  ///< for want of work; then mapping gets half of a frame
    std::int64_t max_step_us = 500000;   ///< a longer gap is not integrated
    std::uint64_t seed = 1;
  };

  /// Starts anew. kBadConfig for an impossible camera or parameters; the tracker is then unchanged.
  Status initialise(const PinholeCamera<float>& camera, const Parameters& parameters);

  /// Tracks one frame. kInvalidArgument (wrong size), kDuplicate, kTimeBackwards: frame refused,
  /// tracker unchanged but for its counters. Otherwise report.status is kOk, kLowTexture,
  /// kNoConsensus, kTimeGap or kLost, and the pose is the filter's best.
  Status process_frame(const ImageView& image, std::int64_t t_us, const TickSource& ticks,
                       FrameReport& report);

  /// Units of work that each frame may take from now on (FrameCut tells what it gave up for it).
  /// An input like any other: logs record it. kInvalidArgument for a negative one.
  Status set_work_limit(int units) { return work_.set_limit(units); }

  /// Draws the virtual objects of `augmenter` into `overlay` as this frame's pose sees them. Where
  /// it wants an object, one is placed first: on the plane of the landmarks where they have one,
  /// else at their median depth. Adds its ticks to `report` as Stage::kRender.
  void augment(Augmenter& augmenter, const MutableImageView& overlay, const TickSource& ticks,
               FrameReport& report);

  /// Takes a saved library in place of the present one. The camera's place in it is not known: the
  /// tracker is lost until it recognises it. kNotInitialised; otherwise as cairn::load_map(), with
  /// nothing changed but where the source gives other bytes the second time: the library is then
  /// empty.
  Status load_map(const ByteSource& source, MapFileInfo& info);
  /// Errors: as cairn::save_map().
  Status save_map(const ByteSink& sink) const { return cairn::save_map(library_, next_id_, sink); }

  const Filter& filter() const { return filter_; }
  const PinholeCamera<float>& camera() const { return camera_; }
  const Health& health() const { return health_; }
  /// Admissions, replacements and refusals of the library.
  const Health& library_health() const { return library_health_; }
  const Library& library() const { return library_; }
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

  using LibraryLandmark = typename Library::Landmark;
  static constexpr int kReturning = 24;  ///< library landmarks looked for at a place found
  /// Memory of what takes landmarks back from the library.
  struct ComingBack {
    SearchScratch search;
    VisibleLandmark<float> visible[kReturning];
    FixedVector<PixelMatch<float>, kReturning> matches;  ///< slots are the library's
    PoseObservation<float> observations[kReturning];
    std::uint8_t inlier[kReturning];
  };

  Status check_input(const ImageView& image, std::int64_t t_us);
  Status predict(std::int64_t t_us);
  void search(const ImageView& image, SearchPass pass,
              FixedVector<PixelMatch<float>, kMaxFeatures>& matches, FrameReport& report);
  int updating_work(int matches) const;
  void afford_update(int first, FixedVector<PixelMatch<float>, kMaxFeatures>& matches,
                     FrameReport& report);
  void update(FixedVector<PixelMatch<float>, kMaxFeatures>& matches, int first,
              FrameReport& report);
  void note_inliers(const FixedVector<PixelMatch<float>, kMaxFeatures>& matches, int first,
                    FrameReport& report);
  void forget_searches();
  void remove_features(FrameReport& report);
  void add_features(const ImageView& image, FrameReport& report);
  void watch_start(FrameReport& report);
  void track(const ImageView& image, std::int64_t t_us, const TickSource& ticks,
             FrameReport& report);
  bool plausible(const FrameReport& report) const;
  void judge(FrameReport& report);
  void lose(FrameReport& report);

  // The library: detail/handheld_tracker_library_impl.hpp.
  bool start_is_over() const {
    return start_.frames >= parameters_.start_blocks * parameters_.start_block_frames;
  }
  void archive(const FixedVector<PixelMatch<float>, kMaxFeatures>& matches);
  bool is_due(const TrackedLandmark& landmark) const;
  float shared_depth_variance() const;
  void store(int slot, TrackedLandmark& landmark, float shared_variance);
  void look_up(const ImageView& image, FrameReport& report);
  void begin_anew(const ImageView& image, FrameReport& report);
  bool come_back(const ImageView& image, FrameReport& report);
  bool confirm(const ImageView& image, float variance, Rigid<float>& T_world_camera,
               ComingBack& work);
  void take_back(const ImageView& image, const Rigid<float>& T_world_camera, const ComingBack& work,
                 FrameReport& report);
  bool object_place(Rigid<float>& T_world_object);

  PinholeCamera<float> camera_;
  Parameters parameters_;
  Filter filter_;
  LandmarkTable<kMaxFeatures> table_;
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
  Library library_;
  Health library_health_;
  Places places_;
  bool place_found_ = false;  ///< to be confirmed
  FrameWork work_;
  Random random_;
  Health health_;
  TrackingState state_ = TrackingState::kInitialising;
  bool initialised_ = false;
  bool has_frame_ = false;
  std::int64_t last_t_us_ = 0;
  LandmarkId next_id_ = 1;
  int weak_frames_ = 0;
  int probation_ = 0;  ///< frames until a place found counts
  StartTrial start_;
};

}  // namespace cairn

#include "cairn/runtime/detail/handheld_tracker_impl.hpp"
#include "cairn/runtime/detail/handheld_tracker_library_impl.hpp"
#include "cairn/runtime/detail/handheld_tracker_work_impl.hpp"

#pragma once

#include "cairn/map/library.hpp"
#include "cairn/tracking/place_recogniser.hpp"
#include "cairn/tracking/place_views.hpp"
#include "cairn/tracking/window_features.hpp"

namespace cairn {

/// Capacities of the library of a WindowTracker. An image is compared with the whole of it within a
/// few frames.
template <class Config>
struct WindowLibraryConfig : Config {
  static constexpr int kLibraryLandmarks =
      Config::kLibraryLandmarks < 256 ? Config::kLibraryLandmarks : 256;
  static constexpr int kRelocalisationFeatures = 160;
  static constexpr int kRelocalisationMatches = 48;
  static constexpr int kPlaceViews = kLibraryLandmarks / 5 < 40 ? kLibraryLandmarks / 5 : 40;
};

/// The long memory of a WindowTracker: landmarks whose depth is well known, kept in a library with
/// a descriptor at the camera's roll, and the recognition of places in it.
template <class Config>
class WindowMemory {
 public:
  using LibraryConfig = WindowLibraryConfig<Config>;
  using Library = MapLibrary<LibraryConfig>;
  using Recogniser = PlaceRecogniser<LibraryConfig>;
  using Features = WindowFeatures<Config>;
  using Window = typename Features::Window;
  using Views = PlaceViews<LibraryConfig::kPlaceViews>;
  static constexpr int kMaxSought = 60;  ///< landmarks that are sought to confirm a place

  /// A landmark of the library that an image shows, and where.
  struct Seen {
    int slot = -1;
    Vector2<float> pixel = Vector2<float>::Zero();
  };
  /// What an image shows of a place.
  struct Place {
    Rigid<float> T_map_camera;
    Matrix<float, 6, 6> covariance = Matrix<float, 6, 6>::Zero();
    FixedVector<Seen, kMaxSought> seen;
    int sought = 0;
  };

  struct Parameters {
    typename Recogniser::Parameters recogniser;
    int view_proposals = 4;    ///< views that propose a pose of an image
    int seek_radius_px = 16;   ///< in the shrunk image, about where such a pose expects a landmark,
    int seek_landmarks = 38;   ///< of which so many are sought,
    int seek_samples = 150;    ///< of three of them, for P3P,
    int seek_found = 6;        ///< and so many must agree on a pose
    int wide_radius_px = 8;    ///< in the shrunk image, about where a landmark should be
    int narrow_radius_px = 3;  ///< same, once the landmarks agreed on a pose
    int least_q15 = 19661;     ///< correlation in the shrunk image, 0.6
    float inlier_px = 6.0F;
    float chance_share = 0.3F;  ///< of the landmarks sought, that a wrong pose may find too
    float evidence = 4.0F;      ///< landmarks found beyond that, in an image that confirms a place,
    float least_evidence = 0.0F;    ///< and in one that does not refute it
    float position_sigma = 0.015F;  ///< of the pose, at most, relative to the landmarks' distance
    int confirmations = 2;          ///< images that make a place
    int reuse_visits = 64;          ///< library landmarks, in a frame
    int reuse_searches = 4;         ///< of these
    int reuse_q15 = 26214;          ///< correlation, 0.8
    int reuse_radius_px = 2;        ///< in the shrunk image
    int min_library = 16;           ///< landmarks; with fewer a lost tracker begins its map anew
    int mature_sightings = 20;  ///< a feature is archived at so many, and its record renewed each
                                ///< time that the number doubles
    float max_depth_sigma = 0.1F;  ///< of an archived feature, relative to its depth
    float same_share = 0.02F;      ///< of its distance: a landmark nearer to it is the same point

    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const auto radius = [](int r) { return r >= 1 && r <= kMaxSearchRadius; };
      const bool good = ok(recogniser.validate()) && radius(wide_radius_px) &&
                        radius(narrow_radius_px) && least_q15 >= 0 && least_q15 <= 1 << 15 &&
                        is_positive(inlier_px) && view_proposals >= 0 &&
                        view_proposals <= kMaxProposals && radius(seek_radius_px) &&
                        seek_landmarks >= 6 && seek_landmarks <= kMaxSought && seek_found >= 4 &&
                        chance_share >= 0.0F && chance_share < 1.0F && is_finite(evidence) &&
                        is_finite(least_evidence) && is_positive(position_sigma) &&
                        confirmations >= 1 && reuse_visits >= 0 && reuse_searches >= 0 &&
                        radius(reuse_radius_px) && reuse_q15 >= 0 && reuse_q15 <= 1 << 15 &&
                        min_library >= 0 && mature_sightings >= 1 && is_positive(max_depth_sigma);
      return good ? Status::kOk : Status::kBadConfig;
    }
  };

  void reset(const Parameters& parameters) {
    parameters_ = parameters;
    library_.clear();
    views_.clear();
    health_ = Health{};
    recogniser_.reset();
    begin();
    next_slot_ = next_renewed_ = 0;
    host_ = -1;
  }
  void forget() {
    library_.clear();
    views_.clear();
    begin();
  }
  /// Recognition starts over.
  void begin() {
    stage_ = Stage::kIdle;
    by_views_ = false;
  }

  /// The library gets the depth that is known of a feature by now: before it is given up. Cost:
  /// kRenewal.
  void renew_depth(FrameContext& frame, const Window& window, const WindowFeature& feature,
                   float sigma);

  const Library& library() const { return library_; }
  Library& library() { return library_; }
  const Health& health() const { return health_; }
  bool library_too_small() const { return library_.size() < parameters_.min_library; }

  /// Archives features that are due, a bounded number in a frame, and renews the depths of
  /// some that were. `T_camera_world`: the frame's.
  void archive_due(FrameContext& frame, const Window& window, Features& features,
                   const Rigid<float>& T_camera_world, float sigma);

  /// Whether the next call of recognise() wants an image's points: the frame then should leave
  /// capture_work().
  bool wants_points() const { return stage_ == Stage::kIdle; }
  int capture_work(const ImageView& image) const {
    return compares_views() ? views_work() : points_work(image);
  }
  /// Whether a view's pose is tried in the next image: the frame then should leave trial_work().
  bool wants_to_try() const { return stage_ == Stage::kSeeking || stage_ == Stage::kSampling; }
  int trial_work() const { return (stage_ == Stage::kSeeking ? seek_work() : 0) + sampling_work(); }
  static int points_work(const ImageView& image) {
    constexpr int kCell = Features::Candidates::kCell;
    return Recogniser::kMaxPoints * (work::kDescriptor + work::texture_point(kCell)) +
           work::texture_cells(image.width * image.height / (kCell * kCell), kCell) + kSelection;
  }
  /// Whether the next image is to confirm a place: the frame then should leave confirm_work().
  bool wants_to_confirm() const { return stage_ == Stage::kFound; }
  static int confirm_work(int radius) {
    return kVisit + 2 * refinement_work(kMaxSought) + kWidelySought * work::warped_search(radius) +
           kMaxSought * work::warped_search(3);
  }
  int confirm_work() const { return confirm_work(parameters_.wide_radius_px); }
  /// Steps of the recognition, as many as the frame's work affords. True where a place was
  /// confirmed by the present image and the one before: place() is then what the present one shows.
  bool recognise(FrameContext& frame, Features& features, const Rigid<float>& T_camera_world);
  const Place& place() const { return place_; }
  /// After recognise(): the landmarks of place() become features of the window, whose first
  /// keyframe is at their pose.
  void take_place(FrameContext& frame, Window& window, Features& features);
  /// The window has a new keyframe.
  void note_keyframe() { host_ = -1; }
  /// Keeps the present view, of a camera whose place in the map is known. `inverse_depth`: of what
  /// it sees.
  void keep_view(FrameContext& frame, const Features& features, const Rigid<float>& T_camera_world,
                 float inverse_depth);
  /// Landmarks of a part of the library, each time of another one, become features where the frame,
  /// at T_camera_world, finds them. Cost: reuse_visits projections and reuse_searches searches.
  void reuse(FrameContext& frame, Window& window, Features& features,
             const Rigid<float>& T_camera_world);

 private:
  static constexpr int kWidelySought = 24;  ///< of kMaxSought, before they agree on a pose
  static constexpr int kMaxProposals = 8;
  static constexpr int kPictureWork = 60;  ///< units, of SmallPicture::take() of a shrunk image
  static constexpr int kStride = 97;       ///< coprime to any library: what is left out is spread
  enum class Stage : std::uint8_t { kIdle, kComparing, kSeeking, kSampling, kFound };
  static constexpr int kSelection = 120;  // units
  static constexpr int kRenewal = 50;     // of MapLibrary::update()
  static constexpr int kVisit = LibraryConfig::kLibraryLandmarks * work::kLibrarySlot;
  static int refinement_work(int count) { return work::kRefinement * count / 24; }

  int seek_work() const {
    return kVisit / 2 +
           parameters_.seek_landmarks * work::warped_search(parameters_.seek_radius_px);
  }
  /// Most often; what is left waits for the next frame.
  int sampling_work() const {
    return Recogniser::pose_work(parameters_.seek_samples, 2 * parameters_.seek_samples,
                                 parameters_.seek_landmarks / 2);
  }
  int views_work() const { return kPictureWork + views_.size() * work::kViewComparison; }
  bool compares_views() const { return by_views_ && views_.size() > 0; }
  bool expected_view(const FrameContext& frame, int slot, const Rigid<float>& T_map_camera,
                     Vector2<float>& pixel) const;
  bool find(const FrameContext& frame, const Features& features, int slot,
            const Rigid<float>& T_map_camera, const Vector2<float>& expected, int radius,
            int least_q15, Vector2<float>& pixel) const;
  bool confirm(FrameContext& frame, const Features& features, const Rigid<float>& T_camera_world);
  void begin_image(FrameContext& frame, Features& features, const Rigid<float>& T_camera_world);
  void compare_views(FrameContext& frame, const Features& features,
                     const Rigid<float>& T_camera_world);
  bool seek_proposal(FrameContext& frame, const Features& features,
                     const Rigid<float>& T_camera_world);
  void sample_pose(FrameContext& frame);
  void next_proposal();
  void begin_looks();
  void observe_seen();
  void take(FrameContext& frame, Window& window, Features& features, const Seen& seen,
            const Rigid<float>& T_camera_map);
  float look(FrameContext& frame, const Features& features, int radius);
  bool pose_is_sure() const;
  static constexpr int kMostLooks = 6;
  void seek(FrameContext& frame, const Features& features, int radius, int most);
  bool refine(FrameContext& frame);
  bool is_due(const WindowFeature& feature) const;
  void archive(FrameContext& frame, const Window& window, WindowFeature& feature,
               const Rigid<float>& T_camera_world, float sigma);
  void place_landmark(const Window& window, int slot, float sigma,
                      typename Library::Landmark& landmark) const;
  int same_point(const Vector3<float>& p_map, float distance) const;
  void capture(FrameContext& frame, Features& features, const Rigid<float>& T_camera_world);
  void compare(FrameContext& frame);

  Parameters parameters_;
  Library library_;
  Health health_;
  Recogniser recogniser_;
  SmallTemplate coarse_[LibraryConfig::kLibraryLandmarks];  ///< of each slot, as archived
  Views views_;
  Stage stage_ = Stage::kIdle;
  bool by_views_ = false;  ///< the next image is compared with views, else with landmarks
  FixedVector<Rigid<float>, kMaxProposals> proposals_;  ///< T_map_camera, the best last
  PoseSearch<float> search_;
  int looks_ = 0;                ///< at place_,
  int confirmed_ = 0;            ///< and those of them that confirmed it
  int next_renewed_ = 0;         ///< feature
  int next_slot_ = 0;            ///< before the next one that reuse() visits
  int host_ = -1;                ///< of reused landmarks, in the window, until its next keyframe
  Rigid<float> T_host_map_;      ///< its pose
  Rigid<float> T_camera_world_;  ///< where the tracker believed to be, when place_ was
  Place place_;
  PoseObservation<float> observations_[kMaxSought];
  std::uint8_t inlier_[kMaxSought];
};

}  // namespace cairn

#include "cairn/tracking/detail/window_memory_archive.hpp"
#include "cairn/tracking/detail/window_memory_places.hpp"
#include "cairn/tracking/detail/window_memory_views.hpp"

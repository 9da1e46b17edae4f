#pragma once

#include "cairn/map/library.hpp"
#include "cairn/tracking/place_recogniser.hpp"
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
  static constexpr int kMaxSought = 40;  ///< landmarks that are sought to confirm a place

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
    int wide_radius_px = 8;    ///< in the shrunk image, about where a landmark should be
    int narrow_radius_px = 3;  ///< same, once the landmarks agreed on a pose
    int least_q15 = 19661;     ///< correlation in the shrunk image, 0.6
    float inlier_px = 6.0F;
    int min_found = 12;            ///< landmarks that make a place,
    float min_found_share = 0.3F;  ///< and of those sought
    int reuse_visits = 64;         ///< library landmarks, in a frame
    int reuse_searches = 4;        ///< of these
    int reuse_q15 = 26214;         ///< correlation, 0.8
    int reuse_radius_px = 2;       ///< in the shrunk image
    int min_library = 16;          ///< landmarks; with fewer a lost tracker begins its map anew
    int mature_sightings = 10;  ///< a feature is archived at so many, and its record renewed each
                                ///< time that the number doubles
    float max_depth_sigma = 0.1F;  ///< of an archived feature, relative to its depth
    float same_share = 0.02F;      ///< of its distance: a landmark nearer to it is the same point

    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const auto radius = [](int r) { return r >= 1 && r <= kMaxSearchRadius; };
      const bool good = ok(recogniser.validate()) && radius(wide_radius_px) &&
                        radius(narrow_radius_px) && least_q15 >= 0 && least_q15 <= 1 << 15 &&
                        is_positive(inlier_px) && min_found >= 6 && min_found_share >= 0.0F &&
                        min_found_share <= 1.0F && reuse_visits >= 0 && reuse_searches >= 0 &&
                        radius(reuse_radius_px) && reuse_q15 >= 0 && reuse_q15 <= 1 << 15 &&
                        min_library >= 0 && mature_sightings >= 1 && is_positive(max_depth_sigma);
      return good ? Status::kOk : Status::kBadConfig;
    }
  };

  void reset(const Parameters& parameters) {
    parameters_ = parameters;
    library_.clear();
    health_ = Health{};
    recogniser_.reset();
    stage_ = Stage::kIdle;
    next_slot_ = 0;
    host_ = -1;
  }
  void forget() {
    library_.clear();
    begin();
  }
  /// Recognition starts over.
  void begin() { stage_ = Stage::kIdle; }

  const Library& library() const { return library_; }
  Library& library() { return library_; }
  const Health& health() const { return health_; }
  bool library_too_small() const { return library_.size() < parameters_.min_library; }

  /// Archives features that are due, a bounded number in a frame. `T_camera_world`: the frame's.
  void archive_due(FrameContext& frame, const Window& window, Features& features,
                   const Rigid<float>& T_camera_world, float sigma);

  /// Whether the next call of recognise() wants an image's points: the frame then should leave
  /// capture_work().
  bool wants_points() const { return stage_ == Stage::kIdle; }
  static int capture_work(const ImageView& image) {
    constexpr int kCell = Features::Candidates::kCell;
    return Recogniser::kMaxPoints * (work::kDescriptor + work::texture_point(kCell)) +
           work::texture_cells(image.width * image.height / (kCell * kCell), kCell) + kSelection;
  }
  /// Whether the next image is to confirm a place: the frame then should leave confirm_work().
  bool wants_to_confirm() const { return stage_ == Stage::kFound || stage_ == Stage::kProposed; }
  static int confirm_work(int radius) {
    return kVisit + 2 * refinement_work(kMaxSought) +
           kMaxSought * (work::template_search(radius) + work::template_search(3));
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
  /// Landmarks of a part of the library, each time of another one, become features where the frame,
  /// at T_camera_world, finds them. Cost: reuse_visits projections and reuse_searches searches.
  void reuse(FrameContext& frame, Window& window, Features& features,
             const Rigid<float>& T_camera_world);

 private:
  static constexpr int kStride = 97;  ///< coprime to any library: what is left out is spread
  enum class Stage : std::uint8_t { kIdle, kComparing, kFound, kProposed };
  static constexpr int kSelection = 120;  // units
  static constexpr int kVisit = LibraryConfig::kLibraryLandmarks * work::kLibrarySlot;
  static int refinement_work(int count) { return work::kRefinement * count / 24; }

  bool expected_view(const FrameContext& frame, int slot, const Rigid<float>& T_map_camera,
                     Vector2<float>& pixel) const;
  void take(FrameContext& frame, Window& window, Features& features, const Seen& seen,
            const Rigid<float>& T_camera_map);
  bool look(FrameContext& frame, const Features& features, int radius);
  void seek(FrameContext& frame, const Features& features, int radius);
  bool refine(FrameContext& frame);
  bool is_due(const WindowFeature& feature) const;
  void archive(FrameContext& frame, const Window& window, WindowFeature& feature,
               const Rigid<float>& T_camera_world, float sigma);
  int same_point(const Vector3<float>& p_map, float distance) const;
  void capture(FrameContext& frame, Features& features, const Rigid<float>& T_camera_world);
  void compare(FrameContext& frame);

  Parameters parameters_;
  Library library_;
  Health health_;
  Recogniser recogniser_;
  SmallTemplate coarse_[LibraryConfig::kLibraryLandmarks];  ///< of each slot, as archived
  Stage stage_ = Stage::kIdle;
  int next_slot_ = 0;            ///< before the next one that reuse() visits
  int host_ = -1;                ///< of reused landmarks, in the window, until its next keyframe
  Rigid<float> T_host_map_;      ///< its pose
  Rigid<float> T_camera_world_;  ///< where the tracker believed to be, when place_ was
  Place place_;
  PoseObservation<float> observations_[kMaxSought];
  std::uint8_t inlier_[kMaxSought];
};

template <class Config>
bool WindowMemory<Config>::is_due(const WindowFeature& feature) const {
  const int mature = parameters_.mature_sightings;
  if (!feature.in_library) return feature.sightings >= mature;
  int next = mature;
  while (next < feature.sightings) next *= 2;
  return next == feature.sightings;
}

template <class Config>
void WindowMemory<Config>::archive_due(FrameContext& frame, const Window& window,
                                       Features& features, const Rigid<float>& T_camera_world,
                                       float sigma) {
  constexpr int kMaxInFrame = 4;  // the others follow in the next frames
  int archived = 0;
  for (int i = 0; i < features.size() && archived < kMaxInFrame; ++i) {
    WindowFeature& feature = features[i];
    if (!feature.found || feature.outliers > 0 || !is_due(feature)) continue;
    if (!(window.sigma(feature.slot) <
          parameters_.max_depth_sigma * window.inverse_depth(feature.slot))) {
      continue;
    }
    if (!frame.work.take(work::kArchiving + work::kDescriptor)) return;
    archive(frame, window, feature, T_camera_world, sigma);
    ++archived;
  }
}

/// Slot of the landmark at a place, seen from a distance, -1 where there is none: a point that was
/// lost and found again is in the library already.
template <class Config>
int WindowMemory<Config>::same_point(const Vector3<float>& p_map, float distance) const {
  const float reach = parameters_.same_share * distance;
  int best = -1;
  float nearest = square(reach);
  for (int slot = 0; slot < library_.size(); ++slot) {
    const float squared = (library_[slot].p_map - p_map).squaredNorm();
    if (!(squared < nearest)) continue;
    nearest = squared;
    best = slot;
  }
  return best;
}

/// The covariance is that of the depth, the poses known, and of the pixel.
template <class Config>
void WindowMemory<Config>::archive(FrameContext& frame, const Window& window,
                                   WindowFeature& feature, const Rigid<float>& T_camera_world,
                                   float sigma) {
  constexpr float kLeastSigma = 0.01F;  // of the depth
  typename Library::Landmark landmark;
  LandmarkView<float>& view = landmark.views[0];
  view.pose.scale_index = kReferenceScaleIndex;
  view.pose.orientation_bin = roll_bin(T_camera_world);
  if (!ok(describe_freak(frame.image, round_to_int(feature.pixel.x()),
                         round_to_int(feature.pixel.y()), view.pose, view.descriptor))) {
    return;
  }
  view.focal_px = 0.5F * (frame.camera.fx + frame.camera.fy);
  view.T_map_reference = T_camera_world.inverse();
  landmark.id = window.id(feature.slot);
  landmark.p_map = window.position(feature.slot);
  const Vector3<float> ray = landmark.p_map - view.T_map_reference.translation;
  const float own = window.sigma(feature.slot) / window.inverse_depth(feature.slot);
  const float along = square(own > kLeastSigma ? own : kLeastSigma);
  landmark.covariance = square(sigma) * ray.squaredNorm() * Matrix3<float>::Identity() +
                        along * (ray * ray.transpose());
  if (library_.find(landmark.id) < 0) {
    const int known = same_point(landmark.p_map, sqrt(ray.squaredNorm()));
    if (known >= 0) landmark.id = library_[known].id;
  }
  landmark.searches = feature.searches;
  landmark.sightings = feature.sightings < feature.searches ? feature.sightings : feature.searches;
  landmark.view_count = 1;
  const Status status = library_.find(landmark.id) < 0 ? library_.insert(landmark, health_)
                                                       : library_.update(landmark);
  if (ok(status)) {
    coarse_[library_.find(landmark.id)] = feature.coarse;
    ++frame.health.landmarks_archived;
  }
  feature.in_library = true;
}

/// Describes what the frame found, then further points.
template <class Config>
void WindowMemory<Config>::capture(FrameContext& frame, Features& features,
                                   const Rigid<float>& T_camera_world) {
  const std::uint8_t bin = roll_bin(T_camera_world);
  recogniser_.reset();
  for (int i = 0; i < features.size(); ++i) {
    if (features[i].found) {
      static_cast<void>(recogniser_.add(frame.image, features[i].pixel, bin));
    }
  }
  const int most = Recogniser::kMaxPoints - recogniser_.points();
  const typename Features::Candidates& points = features.spread_points(frame, most);
  for (int i = 0; i < points.cells(); ++i) {
    if (!points.is_open(i)) continue;
    const Vector2<float> pixel(points[i].x, points[i].y);
    static_cast<void>(recogniser_.add(frame.image, pixel, bin));
  }
  frame.work.spend(recogniser_.points() * work::kDescriptor + kSelection);
}

}  // namespace cairn

#include "cairn/tracking/detail/window_memory_places.hpp"

#pragma once

#include "cairn/tracking/place_recogniser.hpp"
#include "cairn/tracking/place_sightings.hpp"
#include "cairn/tracking/view_proposals.hpp"

namespace cairn {

/// Seeks the place of a camera in the map of a WindowArchive, in steps that a frame's work affords.
/// Images propose poses in two ways in turn, by descriptors (PlaceRecogniser) and by views
/// (ViewProposals); the landmarks that the next images show at such a pose confirm or refute it
/// (PlaceSightings).
template <class Config>
class PlaceSearch {
 public:
  using Archive = WindowArchive<Config>;
  using Features = typename Archive::Features;
  using Recogniser = PlaceRecogniser<typename Archive::LibraryConfig>;
  using Proposals = ViewProposals<Config>;
  using Sightings = PlaceSightings<Config>;
  using Place = typename Sightings::Place;

  struct Parameters : Sightings::Parameters {
    int view_proposals = 4;   ///< views that propose a pose of an image
    int seek_radius_px = 16;  ///< in the shrunk image, about where such a pose expects a landmark,
    int seek_landmarks = 38;  ///< of which so many are sought,
    int seek_samples = 150;   ///< of three of them, for P3P,
    int seek_found = 6;       ///< and so many must agree on a pose
    int wide_radius_px = 8;   ///< in the shrunk image, about where a landmark should be
    float evidence = 4.0F;    ///< landmarks found beyond those of chance, in an image that
                              ///< confirms a place,
    float least_evidence = 0.0F;  ///< and in one that does not refute it
    int confirmations = 2;        ///< images that make a place
    typename Recogniser::Parameters recogniser;

    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const auto radius = [](int r) { return r >= 1 && r <= kMaxSearchRadius; };
      const bool good = ok(Sightings::Parameters::validate()) && ok(recogniser.validate()) &&
                        view_proposals >= 0 && view_proposals <= Proposals::kMaxProposals &&
                        radius(seek_radius_px) && seek_landmarks >= 6 &&
                        seek_landmarks <= Sightings::kMaxSought && seek_samples >= 1 &&
                        seek_found >= 4 && radius(wide_radius_px) && is_finite(evidence) &&
                        is_finite(least_evidence) && confirmations >= 1;
      return good ? Status::kOk : Status::kBadConfig;
    }
  };

  void reset(const Parameters& parameters) {
    parameters_ = parameters;
    recogniser_.reset();
    forget();
  }
  /// Forgets the views, and begins.
  void forget() {
    proposals_.clear();
    begin();
  }
  /// The search starts over.
  void begin() {
    stage_ = Stage::kIdle;
    by_views_ = false;
  }

  /// Keeps the present view, of a camera whose place in the map is known. `inverse_depth`: of what
  /// it sees.
  void keep_view(FrameContext& frame, const Features& features, const Rigid<float>& T_camera_world,
                 float inverse_depth) {
    proposals_.keep(frame, features, T_camera_world.inverse(), inverse_depth);
  }

  /// Units of work that the frame should leave for step(): to take an image's points or compare it
  /// with views, to try a view's pose, or to confirm a place; 0 where what it has suffices.
  int wanted_work(const ImageView& image) const;
  /// Steps of the search, as many as the frame's work affords. True where a place was confirmed by
  /// the present image and the one before: place() is then what the present one shows.
  /// `T_camera_world`: where the tracker believes to be.
  bool step(FrameContext& frame, Features& features, const Archive& archive,
            const Rigid<float>& T_camera_world);
  const Place& place() const { return sightings_.place(); }

 private:
  static constexpr int kMostLooks = 6;
  static constexpr int kSelection = 120;  // units
  enum class Stage : std::uint8_t { kIdle, kComparing, kSeeking, kSampling, kFound };

  static int points_work(const ImageView& image);
  int capture_work(const ImageView& image) const {
    return compares_views() ? proposals_.propose_work() : points_work(image);
  }
  int seek_work() const {
    return Sightings::seek_work(parameters_.seek_radius_px, parameters_.seek_landmarks);
  }
  /// Most often; what is left waits for the next frame.
  int sampling_work() const {
    return Recogniser::pose_work(parameters_.seek_samples, 2 * parameters_.seek_samples,
                                 parameters_.seek_landmarks / 2);
  }
  bool compares_views() const { return by_views_ && proposals_.views() > 0; }
  void begin_image(FrameContext& frame, Features& features, const Rigid<float>& T_camera_world);
  void capture(FrameContext& frame, Features& features, const Rigid<float>& T_camera_world);
  void compare(FrameContext& frame, const Archive& archive);
  void next_proposal() { stage_ = proposals_.empty() ? Stage::kIdle : Stage::kSeeking; }
  bool seek_proposal(FrameContext& frame, const Features& features, const Archive& archive,
                     const Rigid<float>& T_camera_world);
  void sample_pose(FrameContext& frame);
  void begin_looks(const Rigid<float>& T_map_camera);
  bool confirm(FrameContext& frame, const Features& features, const Archive& archive,
               const Rigid<float>& T_camera_world);

  Parameters parameters_;
  Recogniser recogniser_;
  Proposals proposals_;
  Sightings sightings_;
  Stage stage_ = Stage::kIdle;
  bool by_views_ = false;  ///< the next image is compared with views, else with landmarks
  PoseSearch<float> search_;
  int looks_ = 0;                ///< at the place,
  int confirmed_ = 0;            ///< and those of them that confirmed it
  Rigid<float> T_camera_world_;  ///< where the tracker believed to be, when the poses were
};

}  // namespace cairn

#include "cairn/tracking/detail/place_search_impl.hpp"

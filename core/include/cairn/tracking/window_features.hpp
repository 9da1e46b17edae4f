#pragma once

#include "cairn/base/fixed_vector.hpp"
#include "cairn/tracking/appearance.hpp"
#include "cairn/tracking/frame_context.hpp"
#include "cairn/tracking/rolling_shutter.hpp"
#include "cairn/vision/shrunk_image.hpp"
#include "cairn/vision/template_search.hpp"
#include "cairn/vision/texture_points.hpp"
#include "cairn/vision/warped_search.hpp"
#include "cairn/window/keyframe_window.hpp"

namespace cairn {

namespace work {

/// find_template() over (2 radius + 1)^2 places.
inline constexpr int template_search(int radius) {
  return 14 + (2 * radius + 1) * (2 * radius + 1) * 3 / 10;
}

/// Whether WindowFeatures::find_warped() looks at every second place alone.
inline constexpr bool searches_widely(int radius) {
  return radius > kMaxWarpedRadius;
}
/// WindowFeatures::find_warped(), the warp included.
inline constexpr int warped_search(int radius) {
  constexpr int kWarp = 5;
  const int side = 2 * radius + 11;
  const int even = radius + radius % 2;
  return searches_widely(radius)
             ? kWarp + 33 + (even + 1) * (even + 1) / 4 + (even + 6) * (even + 6) * 46 / 1000
             : kWarp + template_search(radius) + side * side * 46 / 1000;
}

/// TexturePoints::rate() of so many cells, and closing some.
inline constexpr int texture_cells(int cells, int cell) {
  return 100 + cells * (cell / 2) * (cell / 2) / 40;
}
/// best_texture() of a cell.
inline constexpr int texture_point(int cell) {
  return 1 + (cell / 2 + 2) * (cell / 2 + 2) / 12;
}
/// A cell becomes a landmark.
inline constexpr int window_landmark(int cell) {
  return 22 + texture_point(cell);
}

}  // namespace work

/// A landmark of the window that is followed from frame to frame.
struct WindowFeature {
  int slot = -1;                                           ///< in the window
  Vector2<float> pixel = Vector2<float>::Zero();           ///< where it was seen last, or expected
  Vector2<float> keyframe_pixel = Vector2<float>::Zero();  ///< in the newest keyframe
  Vector2<float> offset = Vector2<float>::Zero();  ///< of `pixel` from the templates' centre
  SmallTemplate full;
  SmallTemplate coarse;  ///< of the shrunk image
  std::uint8_t misses = 0;
  std::uint8_t outliers = 0;
  std::uint16_t searches = 0;   ///< frames that searched it
  std::uint16_t sightings = 0;  ///< and found it
  bool has_templates = false;
  bool searched = false;      ///< in the present frame
  bool found = false;         ///< in the present frame
  bool in_library = false;    ///< a record of it is in the map library
  bool from_library = false;  ///< its depth is that of the map library
};

/// The features that a WindowTracker follows: search by their templates, first in the shrunk image
/// and then in full.
template <class Config>
class WindowFeatures {
 public:
  static constexpr int kMaxFeatures = WindowBounds::kFeatures;
  using Shrunk = ShrunkImage<Config::kMaxImageWidth, Config::kMaxImageHeight>;
  using Window = KeyframeWindow<float, WindowBounds>;
  using Candidates = TexturePoints<Config::kMaxImageWidth, Config::kMaxImageHeight>;

  struct Parameters {
    float min_distance_share = 0.073F;  ///< between features, of the image height
    float min_texture_share = 0.01F;    ///< of a new one, of the best candidate's score
    int wide_radius_px = 8;             ///< in the shrunk image
    int narrow_radius_px = 3;           ///< same, where the first features agree on a pose
    int full_radius_px = 5;
    int first_features = 16;       ///< searched widely, before the others
    int least_coarse_q15 = 19661;  ///< correlation, 0.6
    int least_full_q15 = 22938;    ///< 0.7
    int max_misses = 3;            ///< frames in a row
    float border_px = 8.0F;        ///< a feature nearer to the border is given up

    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const auto radius = [](int r) { return r >= 1 && r <= kMaxSearchRadius; };
      const auto share = [](int q15) { return q15 >= 0 && q15 <= 1 << 15; };
      const bool good = is_positive(min_distance_share) && is_finite(min_texture_share) &&
                        min_texture_share >= 0.0F && radius(wide_radius_px) &&
                        radius(narrow_radius_px) && radius(full_radius_px) && first_features >= 0 &&
                        share(least_coarse_q15) && share(least_full_q15) && max_misses >= 0 &&
                        max_misses < 255 && is_finite(border_px) && border_px >= 0.0F;
      return good ? Status::kOk : Status::kBadConfig;
    }
  };

  void reset(const Parameters& parameters) {
    parameters_ = parameters;
    features_.clear();
  }
  const Parameters& parameters() const { return parameters_; }
  void clear() { features_.clear(); }
  int size() const { return features_.size(); }
  const WindowFeature& operator[](int i) const { return features_[i]; }
  WindowFeature& operator[](int i) { return features_[i]; }
  int found() const {
    int count = 0;
    for (const WindowFeature& feature : features_) count += feature.found ? 1 : 0;
    return count;
  }

  /// Before a frame's searches.
  void begin(const ImageView& image) {
    shrunk_.take(image);
    for (WindowFeature& feature : features_) feature.searched = feature.found = false;
  }
  /// Searches feature `i` about `expected`; `radius_px` in the shrunk image.
  void search(FrameContext& frame, int i, const Vector2<float>& expected, int radius_px);
  /// The same for one that must be close: in the picture itself first, which takes less.
  void search_near(FrameContext& frame, int i, const Vector2<float>& expected, int radius_px);
  /// Counts a feature that was not found; it goes on from where it was expected. False when it is
  /// to be given up.
  bool miss(const FrameContext& frame, int i, const Vector2<float>& expected);

  void remove(int i) { features_.remove_unordered(i); }
  /// Units of work that add() takes at most, if the frame affords them.
  int new_work(const FrameContext& frame);
  /// Adds landmarks to the window's newest keyframe, in parts of the picture without features, as
  /// many as the frame's work affords. `shutter`: of the frame.
  int add(FrameContext& frame, Window& window, const RollingShutter& shutter, LandmarkId& next_id);
  /// Adds a feature for a landmark that the window has, seen by the newest keyframe. False where
  /// there is no room, or no template.
  bool add_known(const FrameContext& frame, int slot, const Vector2<float>& pixel);
  bool full() const { return features_.full(); }
  /// Whether a pixel is as far from all features as new ones are.
  bool is_free(const FrameContext& frame, const Vector2<float>& pixel) const;
  /// Points of the picture beside the features that were found, spread over it, about `most`: the
  /// best of each block of two cells by two. They hold until add() is called.
  const Candidates& spread_points(FrameContext& frame, int most);
  /// Pixel at which the frame's shrunk image shows a coarse template of another view, within
  /// `radius_px` of it about `expected`. `warp`: from offsets there to offsets here. False where it
  /// is not found. A wide search looks at every second place. Cost: work::warped_search().
  bool find_warped(const SmallTemplate& coarse, const PatchWarp& warp,
                   const Vector2<float>& expected, int radius_px, int least_q15,
                   Vector2<float>& pixel) const {
    constexpr float kQ8 = 256.0F;
    const int x_q8 = round_to_int(kQ8 * shrunk_.to_shrunk(expected.x()));
    const int y_q8 = round_to_int(kQ8 * shrunk_.to_shrunk(expected.y()));
    TemplateMatch match;
    const Status found = work::searches_widely(radius_px)
                             ? find_warped_template_widely(shrunk_.view(), coarse, warp, x_q8, y_q8,
                                                           radius_px, least_q15, match)
                             : find_warped_template(shrunk_.view(), coarse, warp, x_q8, y_q8,
                                                    radius_px, least_q15, match);
    if (!ok(found)) return false;
    pixel = Vector2<float>(shrunk_.to_picture(static_cast<float>(match.x_q8) / kQ8),
                           shrunk_.to_picture(static_cast<float>(match.y_q8) / kQ8));
    return true;
  }
  /// The present frame is the newest keyframe.
  void note_keyframe() {
    for (WindowFeature& feature : features_) feature.keyframe_pixel = feature.pixel;
  }
  /// The frame's shrunk image.
  ImageView shrunk() const { return shrunk_.view(); }
  /// Takes new templates of the features that the frame found.
  void renew_templates(const FrameContext& frame);

 private:
  bool in_view(const FrameContext& frame, const Vector2<float>& pixel) const {
    return frame.camera.contains(pixel, parameters_.border_px);
  }
  void search_finely(FrameContext& frame, int i, const Vector2<float>& expected);
  void take_templates(const FrameContext& frame, WindowFeature& feature);
  float distance(const FrameContext& frame) const {
    return parameters_.min_distance_share * static_cast<float>(frame.image.height);
  }
  void open_cells(const FrameContext& frame);
  static void count(std::uint16_t& searches, std::uint16_t& sightings) {
    if (searches == 0xFFFFU) {
      searches = static_cast<std::uint16_t>(searches / 2);
      sightings = static_cast<std::uint16_t>(sightings / 2);
    }
    ++searches;
  }

  Parameters parameters_;
  Candidates candidates_;
  Shrunk shrunk_;
  FixedVector<WindowFeature, kMaxFeatures> features_;
};

}  // namespace cairn

#include "cairn/tracking/detail/window_features_impl.hpp"

#pragma once

#include "cairn/base/fixed_vector.hpp"
#include "cairn/tracking/appearance.hpp"
#include "cairn/tracking/frame_context.hpp"
#include "cairn/vision/template_search.hpp"
#include "cairn/vision/texture_points.hpp"
#include "cairn/window/keyframe_window.hpp"

namespace cairn {

namespace work {

/// find_template() over (2 radius + 1)^2 places.
inline constexpr int template_search(int radius) {
  constexpr int kPlacesPerUnit = 3;
  return 8 + (2 * radius + 1) * (2 * radius + 1) / kPlacesPerUnit;
}

/// TexturePoints::find() in so many cells.
inline constexpr int texture_points(int cells, int cell) {
  return 100 + cells * (cell / 2 + 2) * (cell / 2 + 2) / 32;
}
inline constexpr int kWindowLandmark = 30;  ///< a candidate becomes a landmark

}  // namespace work

/// A landmark of the window that is followed from frame to frame.
struct WindowFeature {
  int slot = -1;                                   ///< in the window
  Vector2<float> pixel = Vector2<float>::Zero();   ///< where it was seen last, or expected
  Vector2<float> offset = Vector2<float>::Zero();  ///< of `pixel` from the templates' centre
  SmallTemplate full;
  SmallTemplate quarter;  ///< of the quarter image
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

/// The features that a WindowTracker follows: search by their templates, first in the quarter image
/// and then in full.
template <class Config>
class WindowFeatures {
 public:
  static constexpr int kMaxFeatures = WindowBounds::kFeatures;
  using Quarter = QuarterImage<Config::kMaxImageWidth, Config::kMaxImageHeight>;
  using Window = KeyframeWindow<float, WindowBounds>;
  using Candidates = TexturePoints<Config::kMaxImageWidth, Config::kMaxImageHeight>;

  struct Parameters {
    float min_distance_share = 0.073F;  ///< between features, of the image height
    float min_texture_share = 0.01F;    ///< of a new one, of the best candidate's score
    int wide_radius_px = 8;             ///< in the quarter image
    int narrow_radius_px = 3;           ///< same, where the first features agree on a pose
    int full_radius_px = 5;
    int first_features = 16;        ///< searched widely, before the others
    int least_quarter_q15 = 19661;  ///< correlation, 0.6
    int least_full_q15 = 22938;     ///< 0.7
    int max_misses = 3;             ///< frames in a row
    float border_px = 8.0F;         ///< a feature nearer to the border is given up

    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const auto radius = [](int r) { return r >= 1 && r <= kMaxSearchRadius; };
      const auto share = [](int q15) { return q15 >= 0 && q15 <= 1 << 15; };
      const bool good = is_positive(min_distance_share) && is_finite(min_texture_share) &&
                        min_texture_share >= 0.0F && radius(wide_radius_px) &&
                        radius(narrow_radius_px) && radius(full_radius_px) && first_features >= 0 &&
                        share(least_quarter_q15) && share(least_full_q15) && max_misses >= 0 &&
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
    quarter_.take(image);
    for (WindowFeature& feature : features_) feature.searched = feature.found = false;
  }
  /// Searches feature `i` about `expected`; `radius_px` in the quarter image.
  void search(FrameContext& frame, int i, const Vector2<float>& expected, int radius_px);
  /// Counts a feature that was not found; it goes on from where it was expected. False when it is
  /// to be given up.
  bool miss(const FrameContext& frame, int i, const Vector2<float>& expected);

  void remove(int i) { features_.remove_unordered(i); }
  /// Adds landmarks to the window's newest keyframe, in parts of the picture without features.
  int add(FrameContext& frame, Window& window, LandmarkId& next_id);
  /// Adds a feature for a landmark that the window has, seen by the newest keyframe. False where
  /// there is no room, or no template.
  bool add_known(const FrameContext& frame, int slot, const Vector2<float>& pixel);
  bool full() const { return features_.full(); }
  /// Whether a pixel is as far from all features as new ones are.
  bool is_free(const FrameContext& frame, const Vector2<float>& pixel) const;
  /// Points of the picture beside the features that were found, spread over it, about `most`: the
  /// best of each block of two cells by two. They hold until add() is called.
  const Candidates& spread_points(FrameContext& frame, int most);
  /// Pixel at which the frame's quarter image shows a quarter template, within `radius_px` of it
  /// about `expected`. False where it is not found. Cost: work::template_search().
  bool find_coarsely(const SmallTemplate& quarter, const Vector2<float>& expected, int radius_px,
                     int least_q15, Vector2<float>& pixel) const {
    constexpr float kFromQ8 = 1.0F / 256.0F;
    TemplateMatch match;
    if (!ok(find_template(quarter_.view(), quarter, round_to_int(to_quarter(expected.x())),
                          round_to_int(to_quarter(expected.y())), radius_px, least_q15, match))) {
      return false;
    }
    pixel = 4.0F * kFromQ8 *
                Vector2<float>(static_cast<float>(match.x_q8), static_cast<float>(match.y_q8)) +
            Vector2<float>(kCentre, kCentre);
    return true;
  }
  /// Takes new templates of the features that the frame found.
  void renew_templates(const FrameContext& frame);

 private:
  bool in_view(const FrameContext& frame, const Vector2<float>& pixel) const {
    return frame.camera.contains(pixel, parameters_.border_px);
  }
  static constexpr float kCentre = 1.5F;  // of a quarter pixel, in full pixels
  static float to_quarter(float v) { return 0.25F * (v - kCentre); }
  void take_templates(const FrameContext& frame, WindowFeature& feature);
  static void count(std::uint16_t& searches, std::uint16_t& sightings) {
    if (searches == 0xFFFFU) {
      searches = static_cast<std::uint16_t>(searches / 2);
      sightings = static_cast<std::uint16_t>(sightings / 2);
    }
    ++searches;
  }

  Parameters parameters_;
  Candidates candidates_;
  Quarter quarter_;
  FixedVector<WindowFeature, kMaxFeatures> features_;
};

template <class Config>
void WindowFeatures<Config>::search(FrameContext& frame, int i, const Vector2<float>& expected,
                                    int radius_px) {
  constexpr float kFromQ8 = 1.0F / 256.0F;
  WindowFeature& feature = features_[i];
  feature.searched = true;
  count(feature.searches, feature.sightings);
  if (!feature.has_templates) return;
  TemplateMatch match;
  frame.work.spend(work::template_search(radius_px));
  if (!ok(find_template(quarter_.view(), feature.quarter, round_to_int(to_quarter(expected.x())),
                        round_to_int(to_quarter(expected.y())), radius_px,
                        parameters_.least_quarter_q15, match))) {
    return;
  }
  const auto to_full = [](std::int32_t q8) {
    return round_to_int(4.0F * static_cast<float>(q8) * kFromQ8 + kCentre);
  };
  frame.work.spend(work::template_search(parameters_.full_radius_px));
  if (!ok(find_template(frame.image, feature.full, to_full(match.x_q8), to_full(match.y_q8),
                        parameters_.full_radius_px, parameters_.least_full_q15, match))) {
    return;
  }
  const Vector2<float> pixel =
      Vector2<float>(static_cast<float>(match.x_q8), static_cast<float>(match.y_q8)) * kFromQ8 +
      feature.offset;
  if (!in_view(frame, pixel)) return;
  feature.pixel = pixel;
  feature.found = true;
  feature.misses = 0;
  ++feature.sightings;
}

template <class Config>
bool WindowFeatures<Config>::miss(const FrameContext& frame, int i,
                                  const Vector2<float>& expected) {
  WindowFeature& feature = features_[i];
  feature.misses = static_cast<std::uint8_t>(feature.misses + (feature.searched ? 1 : 0));
  if (feature.misses > parameters_.max_misses || !in_view(frame, expected)) return false;
  feature.pixel = expected;
  return true;
}

template <class Config>
int WindowFeatures<Config>::add(FrameContext& frame, Window& window, LandmarkId& next_id) {
  constexpr int kMargin = 12;  // what the templates need
  if (features_.full()) return 0;
  const ImageView& image = frame.image;
  const float distance = parameters_.min_distance_share * static_cast<float>(image.height);
  candidates_.begin(image.width, image.height);
  for (const WindowFeature& feature : features_) {
    candidates_.close(feature.pixel.x(), feature.pixel.y(), distance);
  }
  frame.work.spend(work::texture_points(candidates_.open_cells(), Candidates::kCell));
  candidates_.find(image, kMargin);
  const float least = parameters_.min_texture_share * candidates_.best().score;
  int added = 0;
  for (int tries = 0; tries < Candidates::kMaxCells && !features_.full(); ++tries) {
    const TexturePoint point = candidates_.best();
    if (!(point.score > least)) break;
    frame.work.spend(work::kWindowLandmark);
    const Vector2<float> pixel(point.x, point.y);
    candidates_.close(pixel.x(), pixel.y(), distance);
    WindowFeature feature;
    feature.pixel = pixel;
    take_templates(frame, feature);
    if (!feature.has_templates) continue;
    const Vector3<float> ray = frame.camera.unproject(feature.pixel);
    feature.slot = window.add_landmark(next_id, Vector2<float>(ray.x(), ray.y()));
    if (feature.slot < 0) {
      ++frame.health.landmarks_refused;
      break;
    }
    feature.found = true;
    static_cast<void>(features_.push_back(feature));
    ++next_id;
    ++added;
  }
  frame.report.added += added;
  frame.health.landmarks_added += static_cast<std::uint32_t>(added);
  return added;
}

template <class Config>
bool WindowFeatures<Config>::add_known(const FrameContext& frame, int slot,
                                       const Vector2<float>& pixel) {
  if (features_.full()) return false;
  WindowFeature feature;
  feature.slot = slot;
  feature.pixel = pixel;
  take_templates(frame, feature);
  feature.found = feature.in_library = feature.from_library = true;
  return feature.has_templates && features_.push_back(feature);
}

template <class Config>
bool WindowFeatures<Config>::is_free(const FrameContext& frame, const Vector2<float>& pixel) const {
  const float least = parameters_.min_distance_share * static_cast<float>(frame.image.height);
  for (const WindowFeature& feature : features_) {
    if ((feature.pixel - pixel).squaredNorm() < square(least)) return false;
  }
  return true;
}

template <class Config>
const typename WindowFeatures<Config>::Candidates& WindowFeatures<Config>::spread_points(
    FrameContext& frame, int most) {
  constexpr float kApart_px = 12.0F;
  const ImageView& image = frame.image;
  candidates_.begin(image.width, image.height);
  for (const WindowFeature& feature : features_) {
    if (feature.found) candidates_.close(feature.pixel.x(), feature.pixel.y(), kApart_px);
  }
  frame.work.spend(work::texture_points(candidates_.open_cells(), Candidates::kCell));
  candidates_.find(image, freak_margin(kReferenceScaleIndex));
  candidates_.keep_best(2, most);
  return candidates_;
}

template <class Config>
void WindowFeatures<Config>::renew_templates(const FrameContext& frame) {
  for (WindowFeature& feature : features_) {
    if (feature.found) take_templates(frame, feature);
  }
}

template <class Config>
void WindowFeatures<Config>::take_templates(const FrameContext& frame, WindowFeature& feature) {
  const int x = round_to_int(feature.pixel.x());
  const int y = round_to_int(feature.pixel.y());
  const ImageView quarter = quarter_.view();
  SmallTemplate full;
  SmallTemplate coarse;
  if (!take_template(frame.image, x, y, full) ||
      !take_template(quarter, round_to_int(to_quarter(feature.pixel.x())),
                     round_to_int(to_quarter(feature.pixel.y())), coarse)) {
    return;
  }
  feature.full = full;
  feature.quarter = coarse;
  feature.offset = feature.pixel - Vector2<float>(static_cast<float>(x), static_cast<float>(y));
  feature.has_templates = true;
}

}  // namespace cairn

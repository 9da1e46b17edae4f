#pragma once

#include "cairn/tracking/window_features.hpp"

namespace cairn {

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
  if (!ok(find_template(shrunk_.view(), feature.coarse,
                        round_to_int(shrunk_.to_shrunk(expected.x())),
                        round_to_int(shrunk_.to_shrunk(expected.y())), radius_px,
                        parameters_.least_coarse_q15, match))) {
    return;
  }
  search_finely(frame, i,
                Vector2<float>(shrunk_.to_picture(static_cast<float>(match.x_q8) * kFromQ8),
                               shrunk_.to_picture(static_cast<float>(match.y_q8) * kFromQ8)));
}

template <class Config>
void WindowFeatures<Config>::search_near(FrameContext& frame, int i, const Vector2<float>& expected,
                                         int radius_px) {
  const WindowFeature& feature = features_[i];
  if (feature.has_templates && feature.misses == 0) {
    search_finely(frame, i, expected - feature.offset);
    if (feature.found) {
      features_[i].searched = true;
      count(features_[i].searches, features_[i].sightings);
      return;
    }
  }
  search(frame, i, expected, radius_px);
}

template <class Config>
void WindowFeatures<Config>::search_finely(FrameContext& frame, int i,
                                           const Vector2<float>& expected) {
  constexpr float kFromQ8 = 1.0F / 256.0F;
  WindowFeature& feature = features_[i];
  TemplateMatch match;
  frame.work.spend(work::template_search(parameters_.full_radius_px));
  if (!ok(find_template(frame.image, feature.full, round_to_int(expected.x()),
                        round_to_int(expected.y()), parameters_.full_radius_px,
                        parameters_.least_full_q15, match))) {
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

/// The cells of the picture that are apart from all features.
template <class Config>
void WindowFeatures<Config>::open_cells(const FrameContext& frame) {
  candidates_.begin(frame.image.width, frame.image.height);
  for (const WindowFeature& feature : features_) {
    candidates_.close(feature.pixel.x(), feature.pixel.y(), distance(frame));
  }
}

template <class Config>
int WindowFeatures<Config>::new_work(const FrameContext& frame) {
  open_cells(frame);
  return work::texture_cells(candidates_.open_cells(), Candidates::kCell) +
         (kMaxFeatures - features_.size()) * work::window_landmark(Candidates::kCell);
}

template <class Config>
int WindowFeatures<Config>::add(FrameContext& frame, Window& window, const RollingShutter& shutter,
                                LandmarkId& next_id) {
  constexpr int kMargin = 12;  // what the templates need
  if (features_.full()) return 0;
  open_cells(frame);
  if (!frame.work.take(work::texture_cells(candidates_.open_cells(), Candidates::kCell))) return 0;
  candidates_.rate(frame.image);
  const int best = candidates_.best();
  const float least = best < 0 ? 0.0F : parameters_.min_texture_share * candidates_[best].score;
  int added = 0;
  for (int tries = 0; tries < Candidates::kMaxCells && !features_.full(); ++tries) {
    const int cell = candidates_.best();
    if (cell < 0 || !(candidates_[cell].score > least)) break;
    if (!frame.work.take(work::window_landmark(Candidates::kCell))) break;
    const TexturePoint point = candidates_.refine(cell, frame.image, kMargin);
    if (!(point.score > 0.0F)) continue;
    const Vector2<float> pixel(point.x, point.y);
    candidates_.close(pixel.x(), pixel.y(), distance(frame));
    WindowFeature feature;
    feature.pixel = feature.keyframe_pixel = pixel;
    take_templates(frame, feature);
    if (!feature.has_templates) continue;
    const Vector3<float> ray = frame.camera.unproject(feature.pixel);
    const Vector2<float> seen = shutter.at_frame_time(Vector2<float>(ray.x(), ray.y()), pixel,
                                                      window.expected_inverse_depth());
    feature.slot = window.add_landmark(next_id, seen);
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
  feature.pixel = feature.keyframe_pixel = pixel;
  take_templates(frame, feature);
  feature.found = feature.in_library = feature.from_library = true;
  return feature.has_templates && features_.push_back(feature);
}

template <class Config>
bool WindowFeatures<Config>::is_free(const FrameContext& frame, const Vector2<float>& pixel) const {
  for (const WindowFeature& feature : features_) {
    if ((feature.pixel - pixel).squaredNorm() < square(distance(frame))) return false;
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
  frame.work.spend(work::texture_cells(candidates_.open_cells(), Candidates::kCell));
  candidates_.rate(image);
  candidates_.keep_best(2, most);
  for (int i = 0; i < candidates_.cells(); ++i) {
    if (!candidates_.is_open(i)) continue;
    frame.work.spend(work::texture_point(Candidates::kCell));
    candidates_.refine(i, image, freak_margin(kReferenceScaleIndex));
  }
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
  const ImageView shrunk = shrunk_.view();
  SmallTemplate full;
  SmallTemplate coarse;
  if (!take_template(frame.image, x, y, full) ||
      !take_template(shrunk, round_to_int(shrunk_.to_shrunk(feature.pixel.x())),
                     round_to_int(shrunk_.to_shrunk(feature.pixel.y())), coarse)) {
    return;
  }
  feature.full = full;
  feature.coarse = coarse;
  feature.offset = feature.pixel - Vector2<float>(static_cast<float>(x), static_cast<float>(y));
  feature.has_templates = true;
}

}  // namespace cairn

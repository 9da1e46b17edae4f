#include "cairn/tracking/active_search.hpp"

#include "cairn/numeric/math.hpp"
#include "cairn/numeric/packed_symmetric.hpp"
#include "cairn/vision/hamming.hpp"

namespace cairn {
namespace {

/// The 99 % ellipse of a prediction, clipped to the largest window.
struct Ellipse {
  Vector2<float> centre;
  float i00, i01, i11;
  int half_x, half_y;
  float gate;

  bool contains(float u, float v) const {
    const float du = u - centre.x();
    const float dv = v - centre.y();
    return du * du * i00 + 2.0F * du * dv * i01 + dv * dv * i11 <= gate;
  }
};

bool make_ellipse(const PixelPrediction<float>& prediction, float gate, Ellipse& ellipse) {
  const Matrix2<float>& s = prediction.covariance;
  if (!invert_spd2(s(0, 0), s(0, 1), s(1, 1), ellipse.i00, ellipse.i01, ellipse.i11)) return false;
  const int limit = SearchParameters::kMaxHalfWindow;
  ellipse.centre = prediction.pixel;
  ellipse.gate = gate;
  ellipse.half_x = clamp(round_to_int(sqrt(gate * s(0, 0)) + 0.5F), 2, limit);
  ellipse.half_y = clamp(round_to_int(sqrt(gate * s(1, 1)) + 0.5F), 2, limit);
  return true;
}

struct Found {
  int x = 0;
  int y = 0;
  int distance = 513;
};

/// Best corner of the window by steered descriptor; false when none passes.
bool match_corner(const ImageView& image, const Ellipse& ellipse, const Appearance& appearance,
                  FreakPose pose, const SearchParameters& parameters, SearchScratch& scratch,
                  Found& best, SearchReport& report) {
  const int margin = freak_margin(pose.scale_index);
  const int u = round_to_int(ellipse.centre.x());
  const int v = round_to_int(ellipse.centre.y());
  const Rect window = intersect(
      {u - ellipse.half_x, v - ellipse.half_y, u + ellipse.half_x + 1, v + ellipse.half_y + 1},
      {margin, margin, image.width - margin, image.height - margin});
  if (window.empty()) return false;
  Corner corners[SearchParameters::kMaxCorners];
  FastReport fast;
  if (!ok(detect_fast(image, window, parameters.fast_threshold, scratch, corners,
                      SearchParameters::kMaxCorners, fast))) {
    return false;
  }
  report.work += work::fast(window.width(), window.height(), fast.candidates);
  report.corners = fast.found;
  report.corners_dropped = fast.dropped;
  const int count = fast.found - fast.dropped;
  int second = 513;
  for (int i = 0; i < count; ++i) {
    const Corner& c = corners[i];
    if (!ellipse.contains(c.x, c.y)) continue;
    Descriptor descriptor;
    if (!ok(describe_freak(image, c.x, c.y, pose, descriptor))) continue;
    ++report.descriptors;
    report.work += work::kDescriptor;
    const int distance = hamming_distance(appearance.descriptor, descriptor);
    if (distance < best.distance) {
      second = best.distance;
      best = {c.x, c.y, distance};
    } else if (distance < second) {
      second = distance;
    }
  }
  report.distance = best.distance;
  return best.distance <= parameters.max_distance &&
         best.distance * 100 <= second * parameters.ratio_percent;
}

bool align(const ImageView& image, const Appearance& appearance, const PatchWarp& warp,
           float start_x, float start_y, int min_correlation_q10, const Ellipse& ellipse,
           Vector2<float>& pixel, SearchReport& report) {
  int x_q8 = round_to_int(start_x * 256.0F);
  int y_q8 = round_to_int(start_y * 256.0F);
  PatchAlignment alignment;
  report.work += work::kAlignment;
  if (!ok(align_patch(image, appearance.patch, warp, x_q8, y_q8, alignment))) return false;
  if (!alignment.converged || alignment.correlation < min_correlation_q10) return false;
  const Vector2<float> found(static_cast<float>(x_q8) / 256.0F, static_cast<float>(y_q8) / 256.0F);
  if (!ellipse.contains(found.x(), found.y())) return false;
  report.correlation_q10 = alignment.correlation;
  pixel = found;
  return true;
}

}  // namespace

int most_search_work(const PixelPrediction<float>& prediction, const Appearance& appearance,
                     const SearchParameters& parameters) {
  if (is_searched_by_patch(appearance, parameters)) {
    return patch_search_work(prediction, parameters.patch);
  }
  Ellipse ellipse;
  if (!make_ellipse(prediction, parameters.gate, ellipse)) return work::kSearchItself;
  return work::kSearchItself + work::fast(2 * ellipse.half_x + 1, 2 * ellipse.half_y + 1) +
         SearchParameters::kMaxCorners * work::kDescriptor + 2 * work::kAlignment;
}

Status search_landmark(const ImageView& image, const PixelPrediction<float>& prediction,
                       const Appearance& appearance, const Matrix2<float>& warp,
                       const SearchParameters& parameters, SearchScratch& scratch,
                       Vector2<float>& pixel, SearchReport& report) {
  report = SearchReport{};
  report.work = work::kSearchItself;
  PatchWarp patch_warp;
  if (!to_patch_warp(warp, patch_warp)) return Status::kOutOfView;
  if (is_searched_by_patch(appearance, parameters)) {
    report.work = patch_search_work(prediction, parameters.patch);
    return search_patch(image, prediction, appearance.patch, patch_warp, parameters.patch, pixel);
  }
  Ellipse ellipse;
  if (!make_ellipse(prediction, parameters.gate, ellipse)) return Status::kSingular;

  Found best;
  const FreakPose pose = steer(warp, appearance.scale_index);
  const bool matched =
      match_corner(image, ellipse, appearance, pose, parameters, scratch, best, report);
  if (!appearance.has_patch) {
    if (!matched) return Status::kNotFound;
    pixel = Vector2<float>(static_cast<float>(best.x), static_cast<float>(best.y));
    report.by_descriptor = true;
    return Status::kOk;
  }
  if (matched &&
      align(image, appearance, patch_warp, static_cast<float>(best.x), static_cast<float>(best.y),
            parameters.min_correlation_q10, ellipse, pixel, report)) {
    report.by_descriptor = true;
    return Status::kOk;
  }
  const bool small = static_cast<float>(ellipse.half_x) <= parameters.direct_half_window_px &&
                     static_cast<float>(ellipse.half_y) <= parameters.direct_half_window_px;
  if (small && align(image, appearance, patch_warp, prediction.pixel.x(), prediction.pixel.y(),
                     parameters.min_direct_correlation_q10, ellipse, pixel, report)) {
    return Status::kOk;
  }
  return Status::kNotFound;
}

}  // namespace cairn

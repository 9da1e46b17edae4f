#include "cairn/tracking/patch_search.hpp"

#include "cairn/numeric/math.hpp"
#include "cairn/numeric/packed_symmetric.hpp"
#include "cairn/tracking/work_budget.hpp"

#include "patch_finder.hpp"

namespace cairn {
namespace {

/// The columns of row `y` that lie in the window, a pixel more on either side.
bool row_in_window(const PatchWindow& window, int y, int& first, int& last) {
  const float dv = static_cast<float>(y) - window.centre.y();
  const float slope = window.i01 * dv;
  const float square = slope * slope - window.i00 * (window.i11 * dv * dv - window.gate);
  if (!(square >= 0.0F)) return false;
  const float reach = sqrt(square) / window.i00;
  const float middle = window.centre.x() - slope / window.i00;
  first = round_to_int(middle - reach - 1.0F);
  last = round_to_int(middle + reach + 1.0F);
  return true;
}

/// What the search asks of a window.
struct FloatPlaces {
  const PatchWindow& window;

  int middle_x() const { return round_to_int(window.centre.x()); }
  int middle_y() const { return round_to_int(window.centre.y()); }
  int half_x() const { return window.half_x; }
  int half_y() const { return window.half_y; }
  int places() const { return window.places; }
  bool columns(int y, int& first, int& last) const { return row_in_window(window, y, first, last); }
  bool contains(int x, int y) const {
    return window.contains(static_cast<float>(x), static_cast<float>(y));
  }
  bool contains_q8(int x_q8, int y_q8) const {
    return window.contains(static_cast<float>(x_q8) / 256.0F, static_cast<float>(y_q8) / 256.0F);
  }
};

int half_window(float gate, float variance, int limit) {
  return clamp(round_to_int(sqrt(gate * variance) + 0.5F), 2, limit);
}

}  // namespace

bool make_patch_window(const PixelPrediction<float>& prediction,
                       const PatchSearchParameters& parameters, PatchWindow& window) {
  const Matrix2<float>& s = prediction.covariance;
  if (!invert_spd2(s(0, 0), s(0, 1), s(1, 1), window.i00, window.i01, window.i11)) return false;
  const int limit = parameters.max_half_window_px;
  window.centre = prediction.pixel;
  window.gate = parameters.gate;
  window.half_x = half_window(window.gate, s(0, 0), limit);
  window.half_y = half_window(window.gate, s(1, 1), limit);
  window.places = (window.half_x + 1) * (window.half_y + 1);
  if (window.places <= PatchSearchParameters::kMaxPlaces) return true;
  constexpr float kPlacesPerArea = 0.25F * kPi<float>;
  constexpr float kMost = static_cast<float>(PatchSearchParameters::kMaxPlaces);
  const float area = sqrt(s(0, 0) * s(1, 1) - s(0, 1) * s(0, 1));
  const auto along_border = static_cast<float>(window.half_x + window.half_y);
  const float places = kPlacesPerArea * area * window.gate + along_border;
  if (places <= kMost) {
    window.places = static_cast<int>(places);
    return true;
  }
  window.places = PatchSearchParameters::kMaxPlaces;
  window.gate *= kMost / places;
  window.half_x = half_window(window.gate, s(0, 0), limit);
  window.half_y = half_window(window.gate, s(1, 1), limit);
  return true;
}

int patch_search_work(const PixelPrediction<float>& prediction,
                      const PatchSearchParameters& parameters) {
  PatchWindow window;
  if (!make_patch_window(prediction, parameters, window)) return work::kPatchWindow;
  return patch_finder::work_of(window.places);
}

Status search_patch(const ImageView& image, const PixelPrediction<float>& prediction,
                    const Patch& patch, const PatchWarp& warp,
                    const PatchSearchParameters& parameters, Vector2<float>& pixel) {
  PatchWindow window;
  if (!make_patch_window(prediction, parameters, window)) return Status::kSingular;
  patch_finder::PlaceQ8 found;
  const Status status =
      patch_finder::find_patch(image, FloatPlaces{window}, patch, warp, parameters, found);
  if (ok(status)) {
    pixel =
        Vector2<float>(static_cast<float>(found.x) / 256.0F, static_cast<float>(found.y) / 256.0F);
  }
  return status;
}

}  // namespace cairn

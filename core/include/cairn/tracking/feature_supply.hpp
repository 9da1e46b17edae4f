#pragma once

#include "cairn/base/fixed_vector.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/tracking/frame_context.hpp"
#include "cairn/tracking/work_budget.hpp"
#include "cairn/vision/fast.hpp"
#include "cairn/vision/image.hpp"

namespace cairn {

/// Proposes corners for new landmarks, spread evenly over the image: a grid of cells, of which
/// those without a landmark are searched in turn, a fixed number per frame, continuing where the
/// frame before stopped. `MaxImageWidth` bounds the width of a cell.
template <int MaxImageWidth>
class FeatureSupply {
 public:
  static constexpr int kColumns = 8;
  static constexpr int kRows = 6;
  static constexpr int kCells = kColumns * kRows;
  static constexpr int kMaxCellWidth = MaxImageWidth / kColumns + 1;
  static constexpr int kCornersPerCell = 6;
  static constexpr int kMaxOccupied = 192;
  using Scratch = FastScratch<kMaxCellWidth>;

  struct Parameters {
    int fast_threshold = 20;
    int min_score = 25;                ///< falls with the threshold
    int lowest_threshold = 6;          ///< of a picture with few corners
    int few_points = 12;               ///< known or found in a picture: fewer lower the threshold
    int cells_per_frame = 12;          ///< searched at most
    int min_margin_px = 29;            ///< to the image border: what a descriptor needs,
    float most_margin_share = 1.0F;    ///< but no more of the image height than this
    float margin_share = 0.084F;       ///< same, of the image height
    float min_distance_share = 0.03F;  ///< to the nearest known landmark, of the image height

    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const bool good = fast_threshold >= 1 && fast_threshold <= 254 && lowest_threshold >= 1 &&
                        lowest_threshold <= fast_threshold && few_points >= 0 && min_score >= 0 &&
                        cells_per_frame >= 0 && min_margin_px >= 0 && min_margin_px <= 4096 &&
                        is_share(most_margin_share) && is_share(margin_share) &&
                        is_share(min_distance_share);
      return good ? Status::kOk : Status::kBadConfig;
    }
  };
  struct Report {
    int cells_searched = 0;
    int corners = 0;
    int corners_dropped = 0;
  };

  /// Starts a frame: no pixel is occupied.
  void begin(int width, int height) {
    height_ = height;
    cell_width_ = (width + kColumns - 1) / kColumns;
    cell_height_ = (height + kRows - 1) / kRows;
    for (int& count : counts_) count = 0;
    occupied_.clear();
  }

  /// The most units of work that one cell takes.
  int cell_work() const { return work::fast(cell_width_, cell_height_); }

  /// A landmark or seed is seen at this pixel.
  void occupy(float u, float v) { occupy_pixel(static_cast<int>(u), static_cast<int>(v)); }
  void occupy_pixel(int x, int y) {
    const Place place{x, y};
    const int cell = cell_of(place.x, place.y);
    if (cell < 0) return;
    ++counts_[cell];
    occupied_.push_back(place);
  }

  /// Proposes nothing in cells of whose middle, a pixel, `leaves` says that points there leave the
  /// picture too soon.
  template <class Leaves>
  void close_cells(const Leaves& leaves) {
    for (int cell = 0; cell < kCells; ++cell) {
      const int row = cell / kColumns;
      const Vector2<float> place(static_cast<float>(cell % kColumns) + 0.5F,
                                 static_cast<float>(row) + 0.5F);
      const Vector2<float> size(static_cast<float>(cell_width_), static_cast<float>(cell_height_));
      if (leaves(Vector2<float>(place.cwiseProduct(size)))) ++counts_[cell];
    }
  }

  /// Up to `wanted` corners of empty cells into `corners`, as far as `budget` goes; returns how
  /// many. Where the picture has few corners the threshold falls from frame to frame, and it
  /// returns to its nominal value where there are enough. Cost: cells_per_frame FAST windows of one
  /// cell.
  int find(const ImageView& image, const Parameters& parameters, int wanted, Scratch& scratch,
           Corner* corners, Report& report, WorkBudget& budget) {
    if (threshold_ == 0) threshold_ = parameters.fast_threshold;
    const int known = occupied_.size();
    int found = 0;
    for (int step = 0; step < kCells; ++step) {
      if (found >= wanted || report.cells_searched >= parameters.cells_per_frame) break;
      if (!budget.affords(cell_work())) break;
      const int cell = next_;
      next_ = (next_ + kStride) % kCells;
      if (counts_[cell] > 0) continue;
      ++report.cells_searched;
      Corner best;
      if (!best_corner(image, cell, parameters, scratch, best, report, budget)) continue;
      corners[found++] = best;
      occupy_pixel(best.x, best.y);
    }
    adapt_threshold(parameters, known, found, found >= wanted);
    return found;
  }
  /// FAST's threshold in the next frame.
  int threshold() const { return threshold_; }

 private:
  // Coprime to the number of cells: neighbours in time are not neighbours in the image.
  static constexpr int kStride = 19;
  static constexpr int kHalfPatch_px = 8;

  struct Place {
    int x = 0;
    int y = 0;
  };

  int cell_of(int x, int y) const {
    if (x < 0 || y < 0) return -1;
    const int column = x / cell_width_;
    const int row = y / cell_height_;
    return column < kColumns && row < kRows ? row * kColumns + column : -1;
  }

  void adapt_threshold(const Parameters& parameters, int known, int found, bool enough) {
    if (enough) {
      threshold_ += threshold_ / 8 + 1;
    } else if (known + found < parameters.few_points) {
      threshold_ -= threshold_ / 4;
    }
    threshold_ = clamp(threshold_, parameters.lowest_threshold, parameters.fast_threshold);
  }

  static bool is_share(float value) { return value >= 0.0F && value <= 1.0F; }
  int share_of_height(float share) const {
    return static_cast<int>(share * static_cast<float>(height_));
  }
  int margin(const Parameters& parameters) const {
    const int share = share_of_height(parameters.margin_share);
    const int most = share_of_height(parameters.most_margin_share);
    const int allowed = most > kHalfPatch_px ? most : kHalfPatch_px;
    const int needed = parameters.min_margin_px < allowed ? parameters.min_margin_px : allowed;
    return share > needed ? share : needed;
  }
  /// A patch is 15 pixels wide in every picture.
  int min_distance(const Parameters& parameters) const {
    const int share = share_of_height(parameters.min_distance_share);
    return share > kHalfPatch_px ? share : kHalfPatch_px;
  }

  bool best_corner(const ImageView& image, int cell, const Parameters& parameters, Scratch& scratch,
                   Corner& best, Report& report, WorkBudget& budget) const {
    const int x0 = (cell % kColumns) * cell_width_;
    const int y0 = (cell / kColumns) * cell_height_;
    const int margin = this->margin(parameters);
    const Rect rect = intersect({x0, y0, x0 + cell_width_, y0 + cell_height_},
                                {margin, margin, image.width - margin, image.height - margin});
    if (rect.empty() || rect.width() > kMaxCellWidth) return false;
    Corner corners[kCornersPerCell];
    FastReport fast;
    if (!ok(detect_fast(image, rect, threshold_, scratch, corners, kCornersPerCell, fast))) {
      return false;
    }
    budget.spend(work::fast(rect.width(), rect.height(), fast.candidates));
    report.corners += fast.found;
    report.corners_dropped += fast.dropped;
    const int min_score = parameters.min_score * threshold_ / parameters.fast_threshold;
    const int distance = min_distance(parameters);
    bool any = false;
    for (int i = 0; i < fast.found - fast.dropped; ++i) {
      const Corner& c = corners[i];
      if (c.score < min_score || (any && c.score <= best.score)) continue;
      if (!is_clear(c, distance)) continue;
      best = c;
      any = true;
    }
    return any;
  }

  bool is_clear(const Corner& corner, int distance) const {
    for (const Place& p : occupied_) {
      const int dx = p.x - corner.x;
      const int dy = p.y - corner.y;
      if (dx * dx + dy * dy < distance * distance) return false;
    }
    return true;
  }

  FixedVector<Place, kMaxOccupied> occupied_;
  int counts_[kCells] = {};
  int cell_width_ = 1;
  int cell_height_ = 1;
  int height_ = 1;
  int next_ = 0;
  int threshold_ = 0;  ///< 0: nominal
};

/// FeatureSupply::find() within a tracker's frame: its budget and its counters.
template <int MaxImageWidth>
int propose_corners(FrameContext& frame, FeatureSupply<MaxImageWidth>& supply,
                    const typename FeatureSupply<MaxImageWidth>::Parameters& parameters, int wanted,
                    typename FeatureSupply<MaxImageWidth>::Scratch& scratch, Corner* corners) {
  typename FeatureSupply<MaxImageWidth>::Report report;
  const int found =
      supply.find(frame.image, parameters, wanted, scratch, corners, report, frame.work.budget());
  frame.report.corners += report.corners;
  frame.health.corners_dropped += static_cast<std::uint32_t>(report.corners_dropped);
  return found;
}

}  // namespace cairn

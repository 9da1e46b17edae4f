#include "cairn/vision/template_search.hpp"

#include <cstring>

#include "cairn/numeric/math.hpp"
#include "cairn/vision/detail/patch_rows.hpp"

namespace cairn {
namespace {

constexpr int kSide = SmallTemplate::kSide;
constexpr int kHalf = SmallTemplate::kHalf;
constexpr int kPixels = kSide * kSide;
constexpr int kPitch = kSide + 1;
constexpr int kMaxPlaces = 2 * kMaxSearchRadius + 1;
constexpr int kMaxColumns = kMaxPlaces + kSide - 1;
constexpr int kPlacesAtOnce = 4;
constexpr int kOneQ15 = 1 << 15;

/// Rows of 11 values and a zero, with what normalises them.
struct Reference {
  std::int16_t values[kSide * kPitch] = {};
  std::int32_t sum = 0;
  std::uint32_t spread = 0;  ///< kPixels^2 times the variance

  explicit Reference(const SmallTemplate& from) {
    std::int32_t squares = 0;
    for (int row = 0; row < kSide; ++row) {
      for (int column = 0; column < kSide; ++column) {
        const std::int32_t v = from.pixels[row * kSide + column];
        values[row * kPitch + column] = static_cast<std::int16_t>(v);
        sum += v;
        squares += v * v;
      }
    }
    spread = static_cast<std::uint32_t>(kPixels * squares - sum * sum);
  }
};

/// Sums over the 11 rows of each column of the window, for one row of places.
struct Columns {
  std::int32_t sums[kMaxColumns] = {};
  std::int32_t squares[kMaxColumns] = {};

  void add(const std::uint8_t* row, int count) {
    for (int i = 0; i < count; ++i) {
      const std::int32_t v = row[i];
      sums[i] += v;
      squares[i] += v * v;
    }
  }
  void move(const std::uint8_t* leaves, const std::uint8_t* enters, int count) {
    for (int i = 0; i < count; ++i) {
      const std::int32_t out = leaves[i];
      const std::int32_t in = enters[i];
      sums[i] += in - out;
      squares[i] += in * in - out * out;
    }
  }
};

/// A row of pixels, for products with rows of the template.
class PixelRow {
 public:
#if defined(__ARM_FEATURE_SIMD32)
  /// Each word holds a pixel and its right neighbour.
  PixelRow(const std::uint8_t* row, int count) {
    std::uint32_t left = row[0];
    for (int i = 0; i + 1 < count; ++i) {
      const std::uint32_t right = row[i + 1];
      words_[i] = left | (right << 16U);
      left = right;
    }
    words_[count - 1] = left;
    for (int i = count; i < count + kPlacesAtOnce; ++i) words_[i] = 0;
  }
  /// Adds to each of `places` sums the product of the pixels from there on with a template's row;
  /// the sums after them, up to a multiple of four, are spoiled. Unrolled by hand: the values stay
  /// in registers, and each word serves two places.
  void add_products(const std::int16_t* values, int places, std::int32_t* sums) const {
    std::uint32_t v[kPitch / 2];
    std::memcpy(v, values, sizeof v);
    const auto add = [](std::uint32_t pixels, std::uint32_t pair, std::int32_t& sum) {
      sum = vision::add_products(pixels, pair, sum);
    };
    for (int i = 0; i < places; i += kPlacesAtOnce) {
      const std::uint32_t* const w = words_ + i;
      std::int32_t a = sums[i];
      std::int32_t b = sums[i + 1];
      std::int32_t c = sums[i + 2];
      std::int32_t d = sums[i + 3];
      add(w[0], v[0], a);
      add(w[1], v[0], b);
      add(w[2], v[1], a);
      add(w[2], v[0], c);
      add(w[3], v[1], b);
      add(w[3], v[0], d);
      add(w[4], v[2], a);
      add(w[4], v[1], c);
      add(w[5], v[2], b);
      add(w[5], v[1], d);
      add(w[6], v[3], a);
      add(w[6], v[2], c);
      add(w[7], v[3], b);
      add(w[7], v[2], d);
      add(w[8], v[4], a);
      add(w[8], v[3], c);
      add(w[9], v[4], b);
      add(w[9], v[3], d);
      add(w[10], v[5], a);
      add(w[10], v[4], c);
      add(w[11], v[5], b);
      add(w[11], v[4], d);
      add(w[12], v[5], c);
      add(w[13], v[5], d);
      sums[i] = a;
      sums[i + 1] = b;
      sums[i + 2] = c;
      sums[i + 3] = d;
    }
  }

 private:
  std::uint32_t words_[kMaxColumns + kPlacesAtOnce];
#else
  PixelRow(const std::uint8_t* row, int /*count*/) : row_(row) {}
  void add_products(const std::int16_t* values, int places, std::int32_t* sums) const {
    for (int column = 0; column < kSide; ++column) {
      for (int i = 0; i < places; ++i) sums[i] += row_[i + column] * values[column];
    }
  }

 private:
  const std::uint8_t* row_;
#endif
};

/// Products of the template with the pixels at the places of kSide rows, each row of pixels read
/// once: a row of places is whole once the last row of its pixels was added.
class Products {
 public:
  explicit Products(const Rect& places) : places_(places) {}

  void add(const ImageView& image, int y, const Reference& reference) {
    const int columns = places_.width() + kSide - 1;
    const PixelRow row(image.row(y) + places_.x0 - kHalf, columns);
    for (int r = 0; r < kSide; ++r) {
      const int place = y + kHalf - r;
      if (place < places_.y0 || place >= places_.y1) continue;
      std::int32_t* const sums = sums_[place % kSide];
      if (r == 0) std::memset(sums, 0, sizeof sums_[0]);
      row.add_products(reference.values + r * kPitch, places_.width(), sums);
    }
  }
  const std::int32_t* at(int place_row) const { return sums_[place_row % kSide]; }

 private:
  Rect places_;
  std::int32_t sums_[kSide][kMaxPlaces + kPlacesAtOnce - 1];
};

/// What a row of places has of the correlation.
struct PlaceRow {
  std::int32_t covariance[kMaxPlaces];
  std::int32_t spread[kMaxPlaces];
};

/// The best place so far, and what it and its neighbours have of the correlation.
struct Best {
  struct Value {
    std::int32_t covariance = 0;
    std::int32_t spread = 0;

    /// Q15.
    std::int32_t correlation(const Reference& reference) const {
      const std::uint64_t squared = static_cast<std::uint64_t>(spread) * reference.spread;
      return static_cast<std::int32_t>((static_cast<std::int64_t>(covariance) * kOneQ15) /
                                       (static_cast<std::int64_t>(integer_sqrt(squared)) + 1));
    }
  };
  int x = -1;  ///< of the places
  int y = -1;
  std::int64_t score = 0;  ///< squared correlation times the template's spread
  Value centre;
  Value left;
  Value right;
  Value above;
  Value below;
};

/// Keeps the best of a row of places.
void try_row(int y, int places, const std::int32_t* products, const Columns& columns,
             const Reference& reference, PlaceRow& row, Best& best) {
  std::int32_t sum = 0;
  std::int32_t squares = 0;
  for (int i = 0; i < kSide - 1; ++i) {
    sum += columns.sums[i];
    squares += columns.squares[i];
  }
  for (int i = 0; i < places; ++i) {
    sum += columns.sums[i + kSide - 1];
    squares += columns.squares[i + kSide - 1];
    const std::int32_t covariance = kPixels * products[i] - sum * reference.sum;
    const std::int32_t spread = kPixels * squares - sum * sum;
    row.covariance[i] = covariance;
    row.spread[i] = spread;
    sum -= columns.sums[i];
    squares -= columns.squares[i];
    if (covariance <= 0 || spread <= 0) continue;
    // covariance^2 / spread > best.score; a division takes longer than the rest.
    const std::int64_t squared = static_cast<std::int64_t>(covariance) * covariance;
    if (squared >= (best.score + 1) * spread) {
      best.x = i;
      best.y = y;
      best.score = squared / spread;
    }
  }
}

/// After each row: the values at the best place and beside it. `row` is that of the places `y`.
void note_neighbours(int y, int places, const PlaceRow& above, const PlaceRow& row, Best& best) {
  const auto at = [](const PlaceRow& from, int i) {
    return Best::Value{from.covariance[i], from.spread[i]};
  };
  if (best.y + 1 == y) best.below = at(row, best.x);
  if (best.y != y || best.x == 0 || best.x + 1 >= places) return;
  best.centre = at(row, best.x);
  best.left = at(row, best.x - 1);
  best.right = at(row, best.x + 1);
  best.above = at(above, best.x);
}

/// Vertex of the parabola through three values of which the middle one is the largest, Q8.
std::int32_t vertex(std::int32_t before, std::int32_t middle, std::int32_t after) {
  const std::int32_t curvature = before - 2 * middle + after;
  return curvature < 0 ? 128 * (before - after) / curvature : 0;
}

}  // namespace

bool take_template(const ImageView& image, int x, int y, SmallTemplate& out) {
  if (x < kHalf || y < kHalf || x >= image.width - kHalf || y >= image.height - kHalf) return false;
  for (int row = 0; row < kSide; ++row) {
    std::memcpy(out.pixels + row * kSide, image.row(y - kHalf + row) + x - kHalf, kSide);
  }
  return true;
}

Status find_template(const ImageView& image, const SmallTemplate& reference, int x, int y,
                     int radius, int least_q15, TemplateMatch& match) {
  constexpr std::uint32_t kLeastSpread = 4U * kPixels * kPixels;  // 2 grey values rms
  const bool far_off =
      x < -radius || y < -radius || x > image.width + radius || y > image.height + radius;
  if (far_off) return Status::kNotFound;
  const Reference t(reference);
  const Rect places = intersect({x - radius, y - radius, x + radius + 1, y + radius + 1},
                                {kHalf, kHalf, image.width - kHalf, image.height - kHalf});
  if (t.spread < kLeastSpread || places.width() < 3 || places.height() < 3)
    return Status::kNotFound;
  const int columns_used = places.width() + kSide - 1;
  Columns columns;
  for (int i = 0; i < kSide; ++i) {
    columns.add(image.row(places.y0 - kHalf + i) + places.x0 - kHalf, columns_used);
  }
  Products products(places);
  for (int row = places.y0 - kHalf; row < places.y0 + kHalf; ++row) {
    products.add(image, row, t);
  }
  Best best;
  PlaceRow rows[2];
  for (int row = places.y0; row < places.y1; ++row) {
    PlaceRow& values = rows[row & 1];
    products.add(image, row + kHalf, t);
    if (row > places.y0) {
      columns.move(image.row(row - 1 - kHalf) + places.x0 - kHalf,
                   image.row(row + kHalf) + places.x0 - kHalf, columns_used);
    }
    try_row(row, places.width(), products.at(row), columns, t, values, best);
    if (row > places.y0) note_neighbours(row, places.width(), rows[(row - 1) & 1], values, best);
  }
  const bool inside =
      best.x > 0 && best.x < places.width() - 1 && best.y > places.y0 && best.y < places.y1 - 1;
  if (!inside) return Status::kNotFound;
  const std::int32_t correlation = best.centre.correlation(t);
  if (correlation < least_q15) return Status::kNotFound;
  match.correlation = correlation;
  match.x_q8 = 256 * (places.x0 + best.x) +
               vertex(best.left.correlation(t), correlation, best.right.correlation(t));
  match.y_q8 =
      256 * best.y + vertex(best.above.correlation(t), correlation, best.below.correlation(t));
  return Status::kOk;
}

}  // namespace cairn

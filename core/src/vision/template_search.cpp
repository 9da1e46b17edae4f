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

/// Of the pixels at p with the template.
std::int32_t product(const std::uint8_t* p, std::ptrdiff_t stride, const std::int16_t* values) {
  std::int32_t sum = 0;
  for (int row = 0; row < kSide; ++row, p += stride, values += kPitch) {
    for (int column = 0; column < kSide; ++column) sum += p[column] * values[column];
  }
  return sum;
}

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
    for (int i = count - 1; i < count + 1; ++i) words_[i] = i < count ? left : 0U;
  }
  /// Adds to each of `places` sums the product of the pixels from there on with a template's row.
  void add_products(const std::int16_t* values, int places, std::int32_t* sums) const {
    std::uint32_t v[kPitch / 2];
    std::memcpy(v, values, sizeof v);
    for (int i = 0; i < places; i += 2) {
      const std::uint32_t* const w = words_ + i;
      std::int32_t even = sums[i];
      std::int32_t odd = sums[i + 1];
      for (int k = 0; k < kPitch / 2; ++k) {
        even = vision::add_products(w[2 * k], v[k], even);
        odd = vision::add_products(w[2 * k + 1], v[k], odd);
      }
      sums[i] = even;
      sums[i + 1] = odd;
    }
  }

 private:
  std::uint32_t words_[kMaxColumns + 3];
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
  std::int32_t sums_[kSide][kMaxPlaces + 1];
};

struct Best {
  int x = -1;
  int y = -1;
  std::int64_t score = 0;  ///< squared correlation times the template's spread
};

/// Keeps the best of a row of places that starts at (x, y).
void try_row(int x, int y, int places, const std::int32_t* products, const Columns& columns,
             const Reference& reference, Best& best) {
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
    sum -= columns.sums[i];
    squares -= columns.squares[i];
    if (covariance <= 0 || spread <= 0) continue;
    // covariance^2 / spread > best.score; a division takes longer than the rest.
    const std::int64_t squared = static_cast<std::int64_t>(covariance) * covariance;
    if (squared >= (best.score + 1) * spread) best = {x + i, y, squared / spread};
  }
}

/// Correlation at one place, Q15.
std::int32_t correlation_at(const ImageView& image, int x, int y, const Reference& reference) {
  const std::uint8_t* const first = image.row(y - kHalf) + x - kHalf;
  std::int32_t sum = 0;
  std::int32_t squares = 0;
  const std::uint8_t* p = first;
  for (int row = 0; row < kSide; ++row, p += image.stride) {
    for (int column = 0; column < kSide; ++column) {
      const std::int32_t v = p[column];
      sum += v;
      squares += v * v;
    }
  }
  const std::int64_t covariance =
      kPixels * product(first, image.stride, reference.values) - sum * reference.sum;
  const auto spread = static_cast<std::uint32_t>(kPixels * squares - sum * sum);
  const std::uint32_t root = integer_sqrt(static_cast<std::uint64_t>(spread) * reference.spread);
  return static_cast<std::int32_t>((covariance * kOneQ15) / (static_cast<std::int64_t>(root) + 1));
}

/// Vertex of the parabola through three values of which the middle one is the largest, Q8.
std::int32_t vertex(std::int32_t before, std::int32_t middle, std::int32_t after) {
  const std::int32_t curvature = before - 2 * middle + after;
  return curvature < 0 ? 128 * (before - after) / curvature : 0;
}

}  // namespace

namespace detail {

void quarter_row(const ImageView& image, int row, std::uint8_t* out) {
  const int width = image.width / 4;
  const std::uint8_t* const first = image.row(4 * row);
  for (int x = 0; x < width; ++x) {
    std::uint32_t sum = 8;
    const std::uint8_t* p = first + static_cast<std::ptrdiff_t>(4) * x;
    for (int i = 0; i < 4; ++i, p += image.stride)
      sum += static_cast<std::uint32_t>(p[0]) + p[1] + p[2] + p[3];
    out[x] = static_cast<std::uint8_t>(sum / 16);
  }
}

}  // namespace detail

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
  for (int row = places.y0; row < places.y1; ++row) {
    products.add(image, row + kHalf, t);
    if (row > places.y0) {
      columns.move(image.row(row - 1 - kHalf) + places.x0 - kHalf,
                   image.row(row + kHalf) + places.x0 - kHalf, columns_used);
    }
    try_row(places.x0, row, places.width(), products.at(row), columns, t, best);
  }
  const bool inside =
      best.x > places.x0 && best.x < places.x1 - 1 && best.y > places.y0 && best.y < places.y1 - 1;
  if (!inside) return Status::kNotFound;
  const std::int32_t correlation = correlation_at(image, best.x, best.y, t);
  if (correlation < least_q15) return Status::kNotFound;
  match.correlation = correlation;
  match.x_q8 = 256 * best.x + vertex(correlation_at(image, best.x - 1, best.y, t), correlation,
                                     correlation_at(image, best.x + 1, best.y, t));
  match.y_q8 = 256 * best.y + vertex(correlation_at(image, best.x, best.y - 1, t), correlation,
                                     correlation_at(image, best.x, best.y + 1, t));
  return Status::kOk;
}

}  // namespace cairn

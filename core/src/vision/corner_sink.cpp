#include "corner_sink.hpp"

namespace cairn::vision {
namespace {

/// Both orders that corners are kept in are bits of one number: by score, then (lower 24 bits) the
/// later in raster order first. Coordinates are below 4,096.
constexpr std::uint32_t kByScore = 0xFFFFFFFFU;
constexpr std::uint32_t kLatestFirst = 0x00FFFFFFU;

std::uint32_t rank(const Corner& corner, std::uint32_t order) {
  const auto place = static_cast<std::uint32_t>(corner.y * ImageView::kMaxExtent + corner.x);
  return (static_cast<std::uint32_t>(corner.score) << 24U | (kLatestFirst - place)) & order;
}

/// Moves item `index` of a heap, lowest rank at its root, down to its place.
void sift_down(Corner* items, int count, int index, std::uint32_t order) {
  const Corner moving = items[index];
  const std::uint32_t moving_rank = rank(moving, order);
  for (int child = 2 * index + 1; child < count; child = 2 * index + 1) {
    if (child + 1 < count && rank(items[child + 1], order) < rank(items[child], order)) ++child;
    if (moving_rank <= rank(items[child], order)) break;
    items[index] = items[child];
    index = child;
  }
  items[index] = moving;
}

void make_heap(Corner* items, int count, std::uint32_t order) {
  for (int i = count / 2 - 1; i >= 0; --i) sift_down(items, count, i, order);
}

void sort_raster(Corner* items, int count) {
  make_heap(items, count, kLatestFirst);
  for (int last = count - 1; last > 0; --last) {
    const Corner latest = items[0];
    items[0] = items[last];
    items[last] = latest;
    sift_down(items, last, 0, kLatestFirst);
  }
}

}  // namespace

CornerSink::CornerSink(const Rect& rect, const FastCells& cells, Corner* corners, int* counts)
    : rect_(rect),
      cells_(cells),
      columns_(cells.columns(rect)),
      cell_count_(columns_ * cells.rows(rect)),
      corners_(corners),
      counts_(counts) {
  for (int i = 0; i < cell_count_; ++i) counts_[i] = 0;
}

void CornerSink::add(int x, int y, int score) {
  const int cell = (y - rect_.y0) / cells_.height * columns_ + (x - rect_.x0) / cells_.width;
  const Corner corner{static_cast<std::int16_t>(x), static_cast<std::int16_t>(y),
                      static_cast<std::uint8_t>(score)};
  Corner* const items = corners_ + cell * cells_.capacity;
  int& count = counts_[cell];
  ++found_;
  if (count < cells_.capacity) {
    items[count++] = corner;
    return;
  }
  ++dropped_;
  if (cells_.capacity == 0) return;
  if (count == cells_.capacity) {
    make_heap(items, cells_.capacity, kByScore);
    ++count;  // marks the heap
  }
  if (rank(items[0], kByScore) < rank(corner, kByScore)) {
    items[0] = corner;
    sift_down(items, cells_.capacity, 0, kByScore);
  }
}

void CornerSink::finish() {
  for (int i = 0; i < cell_count_; ++i) {
    if (counts_[i] <= cells_.capacity) continue;
    sort_raster(corners_ + i * cells_.capacity, cells_.capacity);
    counts_[i] = cells_.capacity;
  }
}

}  // namespace cairn::vision

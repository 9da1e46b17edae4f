#include "corner_sink.hpp"

namespace cairn::vision {
namespace {

bool later(const Corner& a, const Corner& b) {
  return a.y != b.y ? a.y > b.y : a.x > b.x;
}
/// Lower score, or of equal ones the later in raster order.
bool worse(const Corner& a, const Corner& b) {
  return a.score != b.score ? a.score < b.score : later(a, b);
}

/// Moves item `index` down until no child comes before it.
template <class Before>
void sift_down(Corner* items, int count, int index, Before before) {
  const Corner moving = items[index];
  for (int child = 2 * index + 1; child < count; child = 2 * index + 1) {
    if (child + 1 < count && before(items[child + 1], items[child])) ++child;
    if (!before(items[child], moving)) break;
    items[index] = items[child];
    index = child;
  }
  items[index] = moving;
}

template <class Before>
void make_heap(Corner* items, int count, Before before) {
  for (int i = count / 2 - 1; i >= 0; --i) sift_down(items, count, i, before);
}

void sort_raster(Corner* items, int count) {
  make_heap(items, count, later);
  for (int last = count - 1; last > 0; --last) {
    const Corner latest = items[0];
    items[0] = items[last];
    items[last] = latest;
    sift_down(items, last, 0, later);
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
  const int cell = cell_count_ == 1
                       ? 0
                       : (y - rect_.y0) / cells_.height * columns_ + (x - rect_.x0) / cells_.width;
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
    make_heap(items, cells_.capacity, worse);
    ++count;  // marks the heap
  }
  if (worse(items[0], corner)) {
    items[0] = corner;
    sift_down(items, cells_.capacity, 0, worse);
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

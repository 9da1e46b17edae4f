#include "cairn/vision/fast.hpp"

#include "fast_detector.hpp"

namespace cairn::detail {

Status detect_fast(const ImageView& image, const Rect& rect, int threshold, const FastCells& cells,
                   const FastBuffers& buffers, Corner* corners, int* counts, FastReport& report) {
  return vision::detect_fast_with<vision::NativeLanes>(image, rect, threshold, cells, buffers,
                                                       corners, counts, report);
}

}  // namespace cairn::detail

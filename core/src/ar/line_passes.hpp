#pragma once

#include "cairn/ar/line_drawing.hpp"
#include "cairn/ar/object_drawing.hpp"

namespace cairn::detail {

/// The halos of an object's lines, or the lines.
struct LinePass {
  const DrawStyle& style;
  const MutableImageView& image;
  bool halo;
  int segments = 0;
  int pixels = 0;
  int left_out = 0;

  /// False, counted as left out: the pass has written all pixels that it may.
  bool has_room() {
    const bool room = pixels < style.max_pixels;
    left_out += room ? 0 : 1;
    return room;
  }
  /// Draws one straight piece by draw_line() or draw_line_in_integers().
  template <class DrawLine>
  void draw(const LineQ8& line, const DrawLine& draw_line) {
    const int width = halo ? style.halo_width_q8 : style.line_width_q8;
    const int written = draw_line(image, line, width, halo ? style.halo_grey : style.line_grey);
    segments += written > 0 ? 1 : 0;
    pixels += written;
  }
};

/// Halos first, so that none covers a line. kOutOfView where no pixel was written.
template <class DrawPass>
Status draw_passes(const DrawStyle& style, const MutableImageView& image, DrawReport& report,
                   const DrawPass& draw_pass) {
  for (int k = style.halo_width_q8 > 0 ? 0 : 1; k < 2; ++k) {
    LinePass pass = {style, image, k == 0};
    draw_pass(pass);
    report.segments += pass.segments;
    report.pixels += pass.pixels;
    report.left_out += pass.left_out;
  }
  return report.pixels > 0 ? Status::kOk : Status::kOutOfView;
}

}  // namespace cairn::detail

// Corners, descriptors, patches, searches and lines on pictures of odd sizes and strides.
#include <vector>

#include "cairn/ar/line_drawing.hpp"
#include "cairn/tracking/active_search.hpp"
#include "cairn/vision/fast.hpp"
#include "cairn/vision/freak.hpp"
#include "cairn/vision/hamming.hpp"
#include "cairn/vision/patch.hpp"
#include "cairn/vision/shrunk_image.hpp"
#include "cairn/vision/small_picture.hpp"
#include "cairn/vision/texture_points.hpp"
#include "cairn/vision/warped_search.hpp"

#include "fuzz_input.hpp"

namespace cairn::fuzz {
namespace {

constexpr int kMostWidth = 128;
constexpr int kCapacity = 24;

ImageView view_of(const ExactPicture& picture) {
  return {picture.bytes.get(), picture.width, picture.height, picture.stride};
}

void try_corners(Input& input, const ImageView& image) {
  static FastScratch<kMostWidth> scratch;
  const Rect rect{input.between(-50, 250), input.between(-50, 250), input.between(-50, 300),
                  input.between(-50, 300)};
  const int threshold = input.below(256);
  FastReport report;
  if (input.flag()) {
    Corner corners[kCapacity];
    const int capacity = input.below(kCapacity + 1);
    if (!ok(detect_fast(image, rect, threshold, scratch, corners, capacity, report))) return;
    PROMISE(6, report.found - report.dropped <= capacity);
    const Rect inside = intersect(rect, {0, 0, image.width, image.height});
    for (int i = 0; i < report.found - report.dropped; ++i) {
      PROMISE(11, corners[i].x >= inside.x0 && corners[i].x < inside.x1);
      PROMISE(11, corners[i].y >= inside.y0 && corners[i].y < inside.y1);
    }
    return;
  }
  const FastCells cells{1 + input.below(60), 1 + input.below(60), input.below(4)};
  const Rect inside = intersect(rect, {0, 0, image.width, image.height});
  const int count = cells.columns(inside) * cells.rows(inside);
  std::vector<Corner> corners(static_cast<std::size_t>(count * cells.capacity));
  std::vector<int> counts(static_cast<std::size_t>(count));
  const Status status = detect_fast_cells(image, rect, threshold, cells, scratch, corners.data(),
                                          counts.data(), report);
  for (const int in_cell : counts) PROMISE(6, !ok(status) || in_cell <= cells.capacity);
}

void try_descriptors(Input& input, const ImageView& image) {
  Descriptor descriptor;
  const int x = input.between(-10, 260);
  const int y = input.between(-10, 260);
  std::uint8_t bin = 0;
  static_cast<void>(describe_freak(image, x, y, descriptor, bin));
  const FreakPose pose{input.byte(), input.byte()};
  static_cast<void>(describe_freak(image, x, y, pose, descriptor));
  PROMISE(6, freak_margin(static_cast<int>(input.word())) <= 65);
}

void try_patches(Input& input, const ImageView& image) {
  int x = input.flag() ? input.between(0, 51200) : static_cast<int>(input.word());
  int y = input.flag() ? input.between(0, 51200) : static_cast<int>(input.word());
  Patch patch = {};
  if (!ok(extract_patch(image, x, y, patch))) return;
  PatchWarp warp = {};
  std::int32_t numbers[sizeof(PatchWarp) / sizeof(std::int32_t)];
  for (std::int32_t& number : numbers) {
    number = input.flag() ? input.between(-1000, 1000) : static_cast<std::int32_t>(input.word());
  }
  static_assert(sizeof numbers == sizeof warp, "a warp of 32-bit numbers");
  if (input.flag()) std::memcpy(&warp, numbers, sizeof warp);
  PatchAlignment report;
  x += input.between(-600, 600);
  y += input.between(-600, 600);
  const int before_x = x;
  const int before_y = y;
  const Status status = align_patch(image, patch, warp, x, y, report);
  PROMISE(3, ok(status) || (x == before_x && y == before_y));
}

void try_search(Input& input, const ImageView& image) {
  static SearchScratch scratch;
  PixelPrediction<float> prediction;
  prediction.pixel = Vector2<float>(input.number(0.0F, 200.0F), input.number(0.0F, 200.0F));
  prediction.covariance(0, 0) = input.number(0.1F, 200.0F);
  prediction.covariance(1, 1) = input.number(0.1F, 200.0F);
  prediction.covariance(1, 0) = prediction.covariance(0, 1) = input.number(-1.0F, 1.0F);
  Appearance appearance;
  appearance.has_patch = input.flag();
  for (std::uint8_t& byte : appearance.descriptor.bytes) byte = input.byte();
  Matrix2<float> warp = Matrix2<float>::Identity();
  if (input.flag()) warp(input.below(2), input.below(2)) = input.number(-2.0F, 2.0F);
  SearchParameters parameters;
  if (input.flag()) parameters.method = SearchMethod::kPatch;
  if (input.byte() > 230) parameters.gate = input.wild();
  if (!ok(parameters.validate())) return;
  const int most = most_search_work(prediction, appearance, parameters);
  Vector2<float> pixel(-7.0F, -7.0F);
  SearchReport report;
  const Status status =
      search_landmark(image, prediction, appearance, warp, parameters, scratch, pixel, report);
  PROMISE(6, report.work <= most);
  if (ok(status)) PROMISE(4, pixel.allFinite());
}

PatchWarp warp(Input& input) {
  PatchWarp made;
  std::int32_t* const numbers[] = {&made.xx, &made.xy, &made.yx, &made.yy};
  for (std::int32_t* number : numbers) {
    if (input.flag()) *number += input.between(-40000, 40000);
  }
  if (input.byte() > 240) *numbers[input.below(4)] = static_cast<std::int32_t>(input.word());
  return made;
}

void try_templates(Input& input, const ImageView& image) {
  const auto whole = [&] {
    return input.byte() > 10 ? input.between(-20, 150) : static_cast<int>(input.word());
  };
  SmallTemplate reference;
  const int x = whole();
  if (!take_template(image, x, whole(), reference)) return;
  const int radius = 1 + input.below(kMaxSearchRadius);
  const int least_q15 = input.between(-32768, 32768);
  TemplateMatch match;
  match.x_q8 = match.y_q8 = -7;
  const int at_x = whole();
  const int at_y = whole();
  const auto q8 = [](int v) { return v > -1000 && v < 1000 ? 256 * v + 77 : v; };
  Status status = Status::kNotFound;
  switch (input.below(3)) {
    case 0:
      status = find_template(image, reference, at_x, at_y, radius, least_q15, match);
      break;
    case 1:
      status = find_warped_template(image, reference, warp(input), q8(at_x), q8(at_y),
                                    1 + (radius - 1) % kMaxWarpedRadius, least_q15, match);
      break;
    default:
      status = find_warped_template_widely(image, reference, warp(input), q8(at_x), q8(at_y),
                                           radius < 2 ? 2 : radius, least_q15, match);
      break;
  }
  PROMISE(3, ok(status) || (match.x_q8 == -7 && match.y_q8 == -7));
  if (!ok(status)) return;
  PROMISE(11, match.x_q8 >= 0 && match.x_q8 <= 256 * (image.width - 1));
  PROMISE(11, match.y_q8 >= 0 && match.y_q8 <= 256 * (image.height - 1));
}

void try_small_pictures(Input& input, const ImageView& image) {
  static SmallPicture before;
  SmallPicture present;
  const bool small = image.width < SmallPicture::kColumns || image.height < SmallPicture::kRows;
  PROMISE(1, present.take(image) != small);
  for (int i = input.below(20); i > 0; --i) {
    before.cells[input.word() % (SmallPicture::kColumns * SmallPicture::kRows)] = input.byte();
  }
  const PictureShift shift = best_shift(present, before);
  PROMISE(4, is_finite(shift.score));
  PROMISE(6, shift.dx >= -13 && shift.dx <= 13 && shift.dy >= -9 && shift.dy <= 9);
}

void try_textures(Input& input, const ImageView& image) {
  static ShrunkImage<kMostWidth, kMostWidth> shrunk;
  static TexturePoints<kMostWidth, kMostWidth> points;
  shrunk.take(image);
  const ImageView small = shrunk.view();
  PROMISE(6, small.width == image.width / shrunk.factor());
  points.begin(image.width, image.height);
  points.rate(image);
  for (int i = input.below(6); i > 0; --i) {
    const auto pixel = [&] { return static_cast<float>(input.between(-200, 400)); };
    const float x = pixel();
    points.close(x, pixel(), static_cast<float>(input.byte()));
  }
  if (input.flag()) points.keep_best(1 + input.below(4), 1 + input.below(20));
  const int margin = 3 + input.below(30);
  for (int best = points.best(); best >= 0; best = points.best()) {
    const TexturePoint point = points.refine(best, image, margin);
    if (point.score > 0.0F) {
      PROMISE(11, point.x >= margin && point.x < image.width - margin);
      PROMISE(11, point.y >= margin && point.y < image.height - margin);
    }
    points.close(best);
  }
}

void try_hamming(Input& input) {
  constexpr int kMost = 12;
  Descriptor queries[kMost];
  Descriptor candidates[kMost];
  Corner corners[kMost];
  const int asked = input.below(kMost + 1);
  const int given = input.below(kMost + 1);
  for (int i = 0; i < kMost; ++i) {
    queries[i].bytes[input.below(4)] = input.byte();
    candidates[i].bytes[input.below(4)] = input.byte();
    corners[i].x = input.byte();
    corners[i].y = input.byte();
  }
  HammingMatch matches[kMost];
  HammingMatch scratch[kMost];
  const int limit = input.between(0, kNoPrefixLimit);
  cross_match_hamming({queries, asked}, {candidates, given}, limit, matches, scratch);
  for (int q = 0; q < asked; ++q) PROMISE(6, matches[q].index >= -1 && matches[q].index < given);
  const Rect window{input.between(-20, 260), 0, input.between(-20, 260), input.byte()};
  const HammingMatch match =
      match_hamming_in(window, queries[0], {corners, given}, {candidates, given}, limit);
  PROMISE(6, match.index >= -1 && match.index < given);
}

/// Draws into the middle of a larger block and looks beside it.
void try_lines(Input& input) {
  const int width = 1 + input.below(60);
  const int height = 1 + input.below(60);
  const int stride = width + input.below(9);
  constexpr std::uint8_t kGuard = 0x5A;
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(stride * height), kGuard);
  const auto coordinate = [&] {
    return input.flag() ? input.between(-20000, 40000) : static_cast<std::int32_t>(input.word());
  };
  const LineQ8 line{coordinate(), coordinate(), coordinate(), coordinate()};
  const int drawn = draw_line({bytes.data(), width, height, stride}, line,
                              static_cast<int>(input.word()), input.byte());
  PROMISE(6, drawn >= 0 && drawn <= width * height);
  for (int y = 0; y < height; ++y) {
    for (int x = width; x < stride; ++x) {
      PROMISE(11, bytes[static_cast<std::size_t>(y * stride + x)] == kGuard);
    }
  }
}

}  // namespace
}  // namespace cairn::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace cairn::fuzz;
  Input input(bytes, size);
  const int kind = input.below(9);
  if (kind == 4) {
    try_lines(input);
    return 0;
  }
  if (kind == 8) {
    try_hamming(input);
    return 0;
  }
  const int width = 1 + input.below(kMostWidth);
  const int height = 1 + input.below(input.byte() > 200 ? kMostWidth : kMostWidth / 3);
  const ExactPicture picture(width, height, width + input.below(17), input);
  const cairn::ImageView image = view_of(picture);
  switch (kind) {
    case 0:
      try_corners(input, image);
      break;
    case 1:
      try_descriptors(input, image);
      break;
    case 2:
      try_patches(input, image);
      break;
    case 5:
      try_templates(input, image);
      break;
    case 6:
      try_small_pictures(input, image);
      break;
    case 7:
      try_textures(input, image);
      break;
    default:
      try_search(input, image);
      break;
  }
  return 0;
}

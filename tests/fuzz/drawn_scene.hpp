#pragma once

#include <vector>

#include "cairn/runtime/augmentation.hpp"

#include "tracker_scene.hpp"

namespace cairn::fuzz {

/// Draws an object of a tracker as a camera at `T_map_camera` sees it, and looks beside the picture
/// (promise 11).
template <class Tracker>
void draw_frame(const Tracker& tracker, const Rigid<float>& T_map_camera,
                ObjectPlacement& placement, Input& input) {
  constexpr int kWidth = SmallConfig::kMaxImageWidth;
  constexpr int kHeight = SmallConfig::kMaxImageHeight;
  constexpr std::uint8_t kGuard = 0x5A;
  static Augmenter augmenter;
  static std::vector<std::uint8_t> pixels;
  const int stride = kWidth + input.below(4);
  pixels.assign(static_cast<std::size_t>(stride) * kHeight, kGuard);
  const NoAllocation none;
  PROMISE(1, ok(make_cairn(0.1F + 0.01F * input.byte(), augmenter.shape())));
  augmenter.initialise(Augmenter::Parameters());
  Rigid<float> T_map_object;
  if (find_object_place(tracker, placement, T_map_object)) {
    PROMISE(4, good_pose(T_map_object));
    PROMISE(1, ok(augmenter.place(T_map_object)));
  }
  FrameReport report;
  report.T_map_camera = input.flag() ? T_map_camera : T_map_object;
  augment(tracker, augmenter, placement, {pixels.data(), kWidth, kHeight, stride}, TickSource(),
          report);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = kWidth; x < stride; ++x) {
      PROMISE(11, pixels[static_cast<std::size_t>(y * stride + x)] == kGuard);
    }
  }
}

/// An object at a pixel of a map of features.
template <class Filter>
void place_at(const Filter& filter, Input& input) {
  const Vector2<float> pixel(input.number(0.0F, 200.0F), input.number(0.0F, 200.0F));
  Random random(input.byte());
  Rigid<float> T_map_object;
  const NoAllocation none;
  if (place_at_pixel(filter, pixel, random, T_map_object)) PROMISE(4, good_pose(T_map_object));
}

}  // namespace cairn::fuzz

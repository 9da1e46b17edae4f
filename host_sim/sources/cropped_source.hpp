#pragma once

#include <memory>
#include <optional>
#include <string>

#include "host_sim/sources/frame_source.hpp"

namespace cairn::host {

/// A part of a picture, px.
struct PictureCrop {
  int width = 0;
  int height = 0;
  std::optional<int> left, top;  ///< absent: the middle of the picture
};

/// WIDTHxHEIGHT or WIDTHxHEIGHT+LEFT+TOP. Throws UsageError for anything else.
PictureCrop parse_crop(const std::string& text);

/// Leaves the part `crop` of the pictures of `source`, and moves the principal point and the scene
/// points with it. Throws UsageError where the part is not inside the picture or does not hold the
/// principal point.
std::unique_ptr<FrameSource> crop_source(std::unique_ptr<FrameSource> source,
                                         const PictureCrop& crop);

}  // namespace cairn::host

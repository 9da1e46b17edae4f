#pragma once

#include <cstdint>

namespace cairn::host {

/// What cairn_sim and its viewer, a program of its own, say to each other over a pair of sockets.
/// The window's libraries then cost nothing where nobody looks, and take only the viewer with them
/// where there is no display.

/// From cairn_sim: a picture, its height * width * 3 bytes (BGR) after this.
struct ViewPicture {
  std::int32_t width = 0;
  std::int32_t height = 0;
  std::int32_t wait_ms = 1;  ///< how long to wait for a key
};

/// The viewer's answer to each picture.
struct ViewAnswer {
  static constexpr std::int32_t kNoKey = -1;
  static constexpr std::int32_t kClosed = -2;  ///< the window is gone
  std::int32_t key = kNoKey;                   ///< as cv::waitKey() gives it
};

}  // namespace cairn::host

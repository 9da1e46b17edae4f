#pragma once

#include <cstdint>

#include "cairn/tracking/frame_report.hpp"
#include "cairn/vision/image.hpp"

#include "board.h"

/// board.h in the types of the C++ interface.
inline bool board_wait_for_frame(cairn::ImageView& image, std::int64_t& t_us) {
  cairn_image from;
  if (!board_wait_for_frame(&from, &t_us)) return false;
  image = {from.data, from.width, from.height, from.stride};
  return true;
}

inline bool board_odometry_until(std::int64_t t_us, cairn::OdometrySample& sample) {
  using Kind = cairn::OdometrySample::Kind;
  cairn_odometry from;
  if (!board_odometry_until(t_us, &from)) return false;
  sample = {from.t_us, from.kind == CAIRN_ACKERMANN ? Kind::kAckermann : Kind::kTwist,
            from.speed_mps, from.turn};
  return true;
}

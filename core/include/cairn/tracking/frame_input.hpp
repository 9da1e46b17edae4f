#pragma once

#include <cstdint>

#include "cairn/base/health.hpp"
#include "cairn/base/status.hpp"
#include "cairn/geometry/camera.hpp"
#include "cairn/vision/image.hpp"

namespace cairn {

/// Which frames a tracker accepts: images of its camera's size, in the order of their time.
class FrameInput {
 public:
  /// Starts anew, before the first frame.
  void reset() {
    *this = FrameInput();
    initialised_ = true;
  }
  bool initialised() const { return initialised_; }

  /// kBadConfig for an impossible camera, or one with larger images.
  static Status check_camera(const PinholeCamera<float>& camera, int max_width, int max_height) {
    const Status status = camera.validate();
    if (!ok(status)) return status;
    return camera.width > max_width || camera.height > max_height ? Status::kBadConfig
                                                                  : Status::kOk;
  }

  /// kNotInitialised; kInvalidArgument: no image, or not the camera's size; kDuplicate,
  /// kTimeBackwards: counted in `health`.
  Status check(const ImageView& image, const PinholeCamera<float>& camera, std::int64_t t_us,
               Health& health) const {
    if (!initialised_) return Status::kNotInitialised;
    if (!image.valid() || image.width != camera.width || image.height != camera.height) {
      return Status::kInvalidArgument;
    }
    if (has_frame_ && t_us <= last_t_us_) {
      ++health.time_errors;
      return t_us == last_t_us_ ? Status::kDuplicate : Status::kTimeBackwards;
    }
    return Status::kOk;
  }

  /// Takes the time of a frame that check() passed. Returns the time since the frame before it, us;
  /// 0 for the first.
  std::int64_t accept(std::int64_t t_us) {
    const std::int64_t step_us = has_frame_ ? t_us - last_t_us_ : 0;
    last_t_us_ = t_us;
    has_frame_ = true;
    return step_us;
  }

 private:
  bool initialised_ = false;
  bool has_frame_ = false;
  std::int64_t last_t_us_ = 0;
};

}  // namespace cairn

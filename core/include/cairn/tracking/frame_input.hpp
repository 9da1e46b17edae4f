#pragma once

#include <cstdint>

#include "cairn/base/health.hpp"
#include "cairn/base/status.hpp"
#include "cairn/base/time.hpp"
#include "cairn/geometry/camera.hpp"
#include "cairn/tracking/input_clock.hpp"
#include "cairn/vision/image.hpp"

namespace cairn {

/// Time between two frames of a tracker.
struct FrameStep {
  std::int64_t us = 0;        ///< at most the largest step; 0 for the first frame
  bool gap = false;           ///< longer than the largest step, or of unknown length
  int missed = 0;             ///< frames that should have come in between
  std::int64_t frame_us = 0;  ///< what one of the frames in the step stands for

  float seconds() const { return static_cast<float>(us) * 1e-6F; }
  float seconds_of_a_frame() const { return static_cast<float>(frame_us) * 1e-6F; }
};

/// Which frames a tracker accepts: images of its camera's size, in the order of their time.
class FrameInput {
 public:
  static constexpr std::int64_t kLongestStepUs = 60000000;  ///< that may be set as the largest

  /// Starts anew, before the first frame. `max_step_us`: the largest step, > 0.
  void reset(std::int64_t max_step_us) {
    *this = FrameInput();
    initialised_ = true;
    max_step_us_ = max_step_us;
  }
  bool initialised() const { return initialised_; }

  /// kBadConfig for an impossible camera, or one with larger images.
  static Status check_camera(const PinholeCamera<float>& camera, int max_width, int max_height) {
    const Status status = camera.validate();
    if (!ok(status)) return status;
    return camera.width > max_width || camera.height > max_height ? Status::kBadConfig
                                                                  : Status::kOk;
  }

  /// kNotInitialised; counted in `health`: kInvalidArgument (no image, or not the camera's size),
  /// kDuplicate, kTimeBackwards and, for a stamp that `clock` does not believe, kTimeGap. Where
  /// the frame confirms that the clock was set back, times count on from it.
  Status check(const ImageView& image, const PinholeCamera<float>& camera, std::int64_t t_us,
               InputClock& clock, Health& health) {
    if (!initialised_) return Status::kNotInitialised;
    if (!image.valid() || image.width != camera.width || image.height != camera.height) {
      ++health.images_refused;
      return Status::kInvalidArgument;
    }
    Status status = clock.take(InputClock::Source::kFrame, t_us);
    if (ok(status) && clock.was_set_back()) restart_clock();
    if (ok(status) && has_frame_ && !restarted_ && t_us <= last_t_us_) {
      status = t_us == last_t_us_ ? Status::kDuplicate : Status::kTimeBackwards;
    }
    if (!ok(status)) ++health.time_errors;
    return status;
  }

  /// The clock was set back: the next frame comes after a gap of unknown length.
  void restart_clock() { restarted_ = has_frame_; }

  /// Takes the time of a frame that check() passed. Returns the step from the frame before it.
  FrameStep accept(std::int64_t t_us, Health& health) {
    FrameStep step;
    if (has_frame_) {
      const std::int64_t since_us = restarted_ ? max_step_us_ + 1 : difference_us(t_us, last_t_us_);
      step.gap = since_us > max_step_us_;
      step.us = step.gap ? max_step_us_ : since_us;
      step.missed = missed_in(since_us);
      step.frame_us = step.missed > 0 ? usual_step_us_ : step.us;
      follow_rate(step.us);
      health.frame_gaps += static_cast<std::uint32_t>(step.missed);
    }
    last_t_us_ = t_us;
    has_frame_ = true;
    restarted_ = false;
    return step;
  }

 private:
  int missed_in(std::int64_t since_us) const {
    constexpr std::int64_t kMost = 1000000;
    if (usual_step_us_ == 0 || since_us - usual_step_us_ <= usual_step_us_ / 2) return 0;
    const std::int64_t missed = (since_us - usual_step_us_ / 2) / usual_step_us_;
    return static_cast<int>(missed < kMost ? missed : kMost);
  }
  /// A gap counts as two steps at most, so that it does not pass for the camera's rate.
  void follow_rate(std::int64_t step_us) {
    if (usual_step_us_ == 0) {
      usual_step_us_ = step_us;
      return;
    }
    const std::int64_t seen = step_us < 2 * usual_step_us_ ? step_us : 2 * usual_step_us_;
    usual_step_us_ += (seen - usual_step_us_) / 8;
    if (usual_step_us_ < 1) usual_step_us_ = 1;
  }

  bool initialised_ = false;
  bool has_frame_ = false;
  bool restarted_ = false;  ///< the last frame's time is of another clock
  std::int64_t max_step_us_ = 0;
  std::int64_t last_t_us_ = 0;
  std::int64_t usual_step_us_ = 0;  ///< low-passed
};

}  // namespace cairn

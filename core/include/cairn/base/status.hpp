#pragma once

#include <cstdint>

namespace cairn {

/// Result of every operation that can be refused. On anything but `kOk` the object that the call
/// was made on is unchanged to the bit, unless the function says otherwise.
enum class [[nodiscard]] Status : std::uint8_t{
    kOk = 0,
    kInvalidArgument,  ///< a size, pointer, index or range is outside its documented domain
    kNonFiniteInput,   ///< NaN or infinity came in
    kBadConfig,        ///< a parameter or calibration value is impossible (for example fx <= 0)
    kDuplicate,        ///< same time stamp as the last accepted input, or an id that is in use
    kTimeBackwards,    ///< older than the last accepted input
    kTimeGap,          ///< further ahead than the configured largest step
    kNotInitialised,   ///< called before initialise()
    kNotFound,         ///< no such landmark, feature or record
    kFull,             ///< a bounded container has no room and nothing may be replaced
    kSingular,         ///< an innovation covariance is not positive definite: update skipped
    kGated,            ///< innovation outside its Mahalanobis gate: update skipped
    kNoConsensus,      ///< RANSAC found too few inliers: update skipped
    kOutOfView,        ///< point behind the camera, too close to it, or outside the image
    kDegenerate,       ///< geometry does not determine the answer (parallax, collinear points)
    kLowTexture,       ///< fewer features than tracking needs
    kVersionMismatch,  ///< stored data of another format version or capacity
    kCorrupt,          ///< stored data fails its length or checksum test
    kBudgetExceeded,   ///< the frame's work budget was spent before the work was done
    kLost,             ///< no pose: tracking is lost
    kRepeatedImage,    ///< the same bytes as the frame before: nothing was measured
};

constexpr bool ok(Status status) {
  return status == Status::kOk;
}

/// Stable lower-case name, for logs and messages.
const char* to_string(Status status);

}  // namespace cairn

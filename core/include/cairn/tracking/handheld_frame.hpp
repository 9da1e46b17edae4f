#pragma once

#include "cairn/geometry/pose_refinement.hpp"
#include "cairn/tracking/expected_search.hpp"
#include "cairn/tracking/feature_supply.hpp"
#include "cairn/tracking/frame_context.hpp"
#include "cairn/tracking/frame_scratch.hpp"
#include "cairn/tracking/relocaliser.hpp"

namespace cairn {

/// Capacities of the hand-held library. An image is compared with the whole library within a few
/// frames, so that the camera has moved little when the pose found is confirmed: the library is
/// bounded for that. Without odometry relocalisation takes more features, and seeks the pose from
/// the best matches alone.
template <class Config>
struct HandheldLibraryConfig : Config {
  static constexpr int kLibraryLandmarks =
      Config::kLibraryLandmarks < 256 ? Config::kLibraryLandmarks : 256;
  static constexpr int kRelocalisationFeatures = 144;
  static constexpr int kRelocalisationMatches = 40;
};

/// Memory of the confirmation of a place: library landmarks found, and the pose that they agree on.
struct ConfirmationScratch : ExpectedScratch<24> {
  PoseObservation<float> observations[kMaxVisible];
  std::uint8_t inlier[kMaxVisible];
};

/// Memory of one step of a hand-held frame.
template <class Config>
using HandheldScratch =
    FrameScratch<typename FeatureSupply<Config::kMaxImageWidth>::Scratch,
                 typename Relocaliser<HandheldLibraryConfig<Config>>::Scratch, ConfirmationScratch>;

/// What HandheldTracker hands to its parts for one frame.
template <class Config>
struct HandheldFrame : FrameContext {
  HandheldFrame(const FrameContext& context, HandheldScratch<Config>& memory)
      : FrameContext(context), scratch(memory) {}

  HandheldScratch<Config>& scratch;
};

}  // namespace cairn

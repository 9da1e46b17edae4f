#pragma once

#include "cairn/map/shared_map.hpp"
#include "cairn/planar/types.hpp"
#include "cairn/tracking/expected_search.hpp"
#include "cairn/tracking/feature_supply.hpp"
#include "cairn/tracking/frame_context.hpp"
#include "cairn/tracking/frame_scratch.hpp"
#include "cairn/tracking/relocaliser.hpp"

namespace cairn {

/// Memory of one step of a vehicle's frame.
template <class Config>
using VehicleScratch =
    FrameScratch<typename FeatureSupply<Config::kMaxImageWidth>::Scratch,
                 typename Relocaliser<Config>::Scratch, ExpectedScratch<Config::kMaxLandmarks>>;

/// What FrameTracker hands to its parts for one frame: also the map that it shares with the map
/// builder, and memory.
template <class Config>
struct VehicleFrame : FrameContext {
  VehicleFrame(const FrameContext& context, SharedMap<Config>& shared,
               VehicleScratch<Config>& memory)
      : FrameContext(context), map(shared), scratch(memory) {}

  SharedMap<Config>& map;
  VehicleScratch<Config>& scratch;
  PlanarPose<float> agreed;  ///< on which matches of an unsure pose agree
  bool agrees = false;       ///< whether they do
};

}  // namespace cairn

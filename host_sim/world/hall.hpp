#pragma once

#include <cstdint>
#include <vector>

#include "cairn/geometry/types.hpp"

#include "host_sim/world/renderer.hpp"

namespace cairn::host {

/// The built-in world: a hall of 20 m x 20 m x 3.2 m about the origin, with pictures, windows and
/// doors on its walls, a tiled floor and furniture inside and outside a drive of 44 m.
struct Hall {
  Scene scene;
  /// 40 points on the walls and the furniture whose image is a corner (paper A's N = 40), m.
  std::vector<Vector3<double>> scene_points;
};

/// The same hall for the same seed: layout is fixed, what is painted follows the seed.
Hall build_hall(std::uint64_t seed);

}  // namespace cairn::host

#pragma once

#include <functional>
#include <vector>

#include "host_sim/experiments/turntable/turntable_experiment.hpp"

namespace cairn::host {

/// How features are found again in the images.
enum class Measurement {
  kPatch,  ///< normalised correlation of the warped patch in the 99 % ellipse, then alignment
  kFreak,  ///< FREAK at FAST corners of the ellipse, then alignment
};

/// The experiment of run_turntable() from rendered video instead of points: every variant in every
/// condition. Noise of 1 px becomes 6 grey values instead of 2; wrong matches beyond those of the
/// images come from the condition's outlier share where it is above the points' 5 %.
std::vector<TurntableCell> run_rendered_turntable(const TurntableConfig& config,
                                                  Measurement measurement,
                                                  const std::function<void(int, int)>& progress);

}  // namespace cairn::host

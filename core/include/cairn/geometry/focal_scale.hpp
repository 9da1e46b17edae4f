#pragma once

namespace cairn {

/// An estimated focal length, as a factor on the one that was told, with standard deviations: of
/// the estimate, and of what was told.
struct FocalScale {
  float value = 1.0F;
  float sigma = 0.0F;
  float told_sigma = 0.0F;
};

}  // namespace cairn

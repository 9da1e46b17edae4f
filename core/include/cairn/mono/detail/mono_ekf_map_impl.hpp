#pragma once

#include "cairn/mono/mono_ekf.hpp"

namespace cairn {

template <class T, int MaxFeatures, int MaxAnchors>
Status MonoEkf<T, MaxFeatures, MaxAnchors>::set_motion_noise(T velocity_noise, T rate_noise) {
  if (!is_finite(velocity_noise) || !is_finite(rate_noise)) return Status::kNonFiniteInput;
  if (velocity_noise < T(0) || rate_noise < T(0)) return Status::kInvalidArgument;
  parameters_.velocity_noise = velocity_noise;
  parameters_.rate_noise = rate_noise;
  return Status::kOk;
}

}  // namespace cairn

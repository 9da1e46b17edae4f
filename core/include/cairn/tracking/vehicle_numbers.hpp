#pragma once

#include "cairn/map/fixed_visibility.hpp"
#include "cairn/tracking/fixed_seed_motion.hpp"
#include "cairn/tracking/fixed_seed_odometry.hpp"
#include "cairn/tracking/seed_odometry.hpp"

namespace cairn {

template <int MaxLandmarks>
class FixedVehicleSlam;

/// In which numbers a vehicle's frame is computed beside its filter: those of the filter.
/// `Estimate`: VehicleEstimate<Filter>.
template <class Filter>
struct VehicleNumbers {
  static constexpr bool kIntegers = false;
  template <int MaxSeeds, int MaxKeyframes>
  using SeedOdometry = cairn::SeedOdometry<MaxSeeds, MaxKeyframes>;
  using LandmarkViews = cairn::LandmarkViews<float>;
  using StayingInView = cairn::StayingInView;

  template <class Estimate>
  static Rigid<float> T_world_camera(const Estimate& estimate) {
    return estimate.T_world_camera();
  }
  template <class Seeds>
  static std::uint32_t saturations(const Filter&, const Seeds&) {
    return 0;
  }
};

template <int MaxLandmarks>
struct VehicleNumbers<FixedVehicleSlam<MaxLandmarks>> {
  static constexpr bool kIntegers = true;
  template <int MaxSeeds, int MaxKeyframes>
  using SeedOdometry = FixedSeedOdometry<MaxSeeds, MaxKeyframes>;
  using LandmarkViews = FixedLandmarkViews;
  using StayingInView = FixedStayingInView;

  template <class Estimate>
  static FixedRigid T_world_camera(const Estimate& estimate) {
    return estimate.filter().T_world_camera(estimate.T_vehicle_camera());
  }
  template <class Seeds>
  static std::uint32_t saturations(const FixedVehicleSlam<MaxLandmarks>& filter,
                                   const Seeds& seeds) {
    return filter.saturations() + seeds.saturations();
  }
};

}  // namespace cairn

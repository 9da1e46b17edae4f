#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "host_sim/base/planar_types.hpp"

namespace cairn::host {

/// One planar SLAM filter under test, with known association of Cartesian sightings.
class FilterUnderTest {
 public:
  FilterUnderTest() = default;
  FilterUnderTest(const FilterUnderTest&) = delete;
  FilterUnderTest& operator=(const FilterUnderTest&) = delete;
  virtual ~FilterUnderTest() = default;

  virtual void initialise(const Pose2& pose, const Eigen::Matrix3d& covariance) = 0;
  /// One odometry increment of the Euler model, the one the simulated world moves by.
  virtual void predict(const Increment& step) = 0;
  /// Updates with the known landmarks as one batch, then adds the new ones. `sigma_m`: standard
  /// deviation of each coordinate.
  virtual void update(const std::vector<PointSighting>& sightings, double sigma_m) = 0;
  virtual PoseEstimate pose() const = 0;
  /// False when the landmark is not in the map.
  virtual bool landmark(int landmark, LandmarkEstimate& estimate) const = 0;
  virtual int dimension() const = 0;
  /// Results that did not fit their format, of a filter in fixed point.
  virtual std::int64_t saturations() const { return 0; }
};

/// A filter by its name on the command line, for maps of up to `landmarks` landmarks. Throws
/// std::invalid_argument, naming the known filters, for another name or too large a map.
std::unique_ptr<FilterUnderTest> make_filter_under_test(const std::string& name, int landmarks);

}  // namespace cairn::host

#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host_sim/base/planar_types.hpp"

namespace cairn::host {

/// One planar SLAM filter under test, with known association of Cartesian sightings.
class PlanarFilter {
 public:
  PlanarFilter() = default;
  PlanarFilter(const PlanarFilter&) = delete;
  PlanarFilter& operator=(const PlanarFilter&) = delete;
  virtual ~PlanarFilter() = default;

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
};

/// A filter by its name on the command line, for maps of up to `landmarks` landmarks. Throws
/// std::invalid_argument, naming the known filters, for another name or too large a map.
std::unique_ptr<PlanarFilter> make_planar_filter(const std::string& name, int landmarks);

/// Names that make_planar_filter knows, in the order of the tables.
std::vector<std::string> planar_filter_names();

}  // namespace cairn::host

#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cairn/base/health.hpp"
#include "cairn/estimation/observation.hpp"
#include "cairn/planar/increment.hpp"
#include "cairn/planar/observation/range_bearing.hpp"
#include "cairn/planar/types.hpp"

#include "host_sim/base/planar_types.hpp"

namespace cairn::host {

/// A landmark of the map of a recorded run.
struct MappedLandmark {
  LandmarkId id = kNoLandmark;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< mean, world
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
};

struct LandmarkPosition {
  LandmarkId id = kNoLandmark;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
};

/// One of the core's filters in double, behind a face that the runner can choose at run time.
class RecordedFilter {
 public:
  RecordedFilter() = default;
  RecordedFilter(const RecordedFilter&) = delete;
  RecordedFilter& operator=(const RecordedFilter&) = delete;
  virtual ~RecordedFilter() = default;

  virtual Status initialise(const Pose2& pose, const Eigen::Matrix3d& covariance,
                            const PlanarParameters<double>& parameters) = 0;
  virtual Status predict(const PlanarIncrement<double>& increment) = 0;
  virtual Status widen_pose(double position_variance, double heading_variance) = 0;
  virtual Status update(const std::vector<RangeBearingObservation<double>>& observations,
                        double sensor_offset_m, UpdateReport& report) = 0;
  virtual Status add_landmark(LandmarkId id, const Eigen::Vector2d& y_vehicle,
                              const Eigen::Matrix2d& covariance, LandmarkId* replaced) = 0;
  virtual Status remove_landmark(LandmarkId id) = 0;
  virtual bool knows(LandmarkId id) const = 0;
  /// Where `observation` of landmark `id` was expected: squared Mahalanobis distance and log of the
  /// determinant of the innovation covariance. False where nothing can be said.
  virtual bool distance(const RangeBearingObservation<double>& observation, double sensor_offset_m,
                        double& squared, double& log_determinant) const = 0;
  /// Mean, the point of linearisation: what trajectory and map are written from.
  virtual Pose2 mean_pose() const = 0;
  /// Expected pose and its covariance: what the NEES is made of.
  virtual PoseEstimate estimate() const = 0;
  virtual std::vector<MappedLandmark> landmarks() const = 0;
  /// Mean positions alone: cheap enough for every scan.
  virtual void positions(std::vector<LandmarkPosition>& map) const = 0;
  virtual Health health() const = 0;
  /// Results that did not fit their format, of a filter in fixed point.
  virtual std::uint32_t saturations() const { return 0; }
  virtual int landmark_count() const = 0;
};

/// `group-iekf`, `lifted-iekf` or `ekf`, or without floating point `group-iekf-fixed` or
/// `ekf-fixed`, with room for 32 landmarks, or for 768 (lifted-iekf: 192) when `large`. Throws
/// UsageError for another name.
std::unique_ptr<RecordedFilter> make_recorded_filter(const std::string& name, bool large);

}  // namespace cairn::host

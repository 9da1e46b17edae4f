#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Dense>

#include "cairn/planar/types.hpp"

namespace cairn::host {

/// Odometry of the tracked point, held from `t_s` until the next sample. `density` times a duration
/// is the covariance of (distance, turn) over it; a noise of standard deviation s, independent from
/// sample to sample, has the density s^2 times the sample's period.
struct RecordedOdometry {
  double t_s = 0.0;
  double speed_mps = 0.0;
  double turn_radps = 0.0;
  Eigen::Matrix2d density = Eigen::Matrix2d::Zero();
};

/// One sighting; `landmark` 0 where the sensor does not tell which it is.
struct RecordedSighting {
  int landmark = 0;
  double range_m = 0.0;
  double bearing_rad = 0.0;
};

/// Sightings of one instant.
struct RecordedScan {
  double t_s = 0.0;
  std::vector<RecordedSighting> sightings;
};

/// True pose, or position alone.
struct RecordedTruth {
  double t_s = 0.0;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double heading = 0.0;
};

/// What the landmark sensor is taken to be.
struct SightingNoise {
  double range_sigma_m = 0.1;
  double range_sigma_per_m = 0.0;  ///< added to range_sigma_m, times the range
  double bearing_sigma_rad = 0.02;
};

/// A recorded drive past point landmarks, as the planar filters need it. Times start at zero.
struct Recording {
  std::string name;
  std::vector<RecordedOdometry> odometry;
  std::vector<RecordedScan> scans;
  std::vector<RecordedTruth> truth;
  bool truth_has_heading = true;
  bool known_landmarks = true;  ///< sightings carry identities
  std::map<int, Eigen::Vector2d> true_landmarks;
  double sensor_offset_m = 0.0;  ///< ahead of the tracked point, on the vehicle's x axis
  double end_s = 0.0;
  SightingNoise noise;
  double slip_density = 0.0;  ///< m^2/s per axis: motion that odometry does not see
  std::vector<std::filesystem::path> inputs;
  std::string note;  ///< what was assumed or changed
};

/// What a profile adds to a data set's own statement of its noise.
enum class RecordingProfile {
  kPlain,       ///< times and values as recorded, constant noise, slip noise where it is needed
  kStated,      ///< as kPlain with the stated noise alone: no slip noise
  kCalibrated,  ///< stamps shifted, turn rate scaled, range noise growing with range
};

/// Folder of the 17-cylinder data set: odom_gt.csv, obs.csv, landmarks.csv.
Recording read_lost_in_the_woods(const std::filesystem::path& folder, RecordingProfile profile);

/// Folder of a UTIAS MRCLAM data set, and the robot's number: RobotN_Odometry.dat,
/// RobotN_Measurement.dat, RobotN_Groundtruth.dat, Landmark_Groundtruth.dat, Barcodes.dat.
/// Barcodes are mapped to subjects; sightings of robots (subjects 1 to 5) and of barcodes that no
/// subject has are dropped.
Recording read_mrclam(const std::filesystem::path& folder, int robot, RecordingProfile profile);

/// Folder of Victoria Park: odom.csv, trees.csv, gps.csv. The tracked point is the laser's foot on
/// the rear axle, 0.5 m left of the axle's centre, so that the laser lies on the x axis: its speed
/// is the car's minus 0.5 m times the turn rate, exactly.
Recording read_victoria_park(const std::filesystem::path& folder);

/// True state at `t_s`, interpolated; false outside of the truth or in a gap of more than
/// `largest_gap_s`.
bool truth_at(const Recording& recording, double t_s, double largest_gap_s, RecordedTruth& truth);

}  // namespace cairn::host

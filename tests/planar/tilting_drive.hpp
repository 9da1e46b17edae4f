#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/planar/planar_slam.hpp"

#include "tilting_vehicle.hpp"
#include "vga_camera.hpp"

// Drives along a street with a body that pitches and rolls: is a filter as unsure as it says?
// The road follows the body: what is left of a tilt after a while was the road's slope. So the
// street turns about the vehicle by what its tilt loses.

namespace cairn::planar_test {

/// A drive along a street of points, seen by a camera on a body that tilts.
struct Street {
  explicit Street(unsigned seed) : generator(seed) {
    std::uniform_real_distribution<double> along(2.0, 90.0);
    std::uniform_real_distribution<double> across(-8.0, 8.0);
    std::uniform_real_distribution<double> up(0.0, 4.0);
    for (int i = 0; i < 220; ++i) {
      points.push_back({along(generator), across(generator), up(generator)});
    }
  }
  double normal(double sigma) { return sigma * gauss(generator); }
  /// About the vehicle at `pose` (x, y, heading).
  void turn(const Vector3<double>& pose, const VehicleTilt<double>& from,
            const VehicleTilt<double>& to) {
    const Quaternion<double> heading(Eigen::AngleAxisd(pose(2), Eigen::Vector3d::UnitZ()));
    const Quaternion<double> turn =
        heading * to.R_level_vehicle() * from.R_level_vehicle().conjugate() * heading.conjugate();
    const Vector3<double> at(pose(0), pose(1), 0.0);
    for (Vector3<double>& p : points) p = at + turn * (p - at);
  }

  std::mt19937_64 generator;
  std::normal_distribution<double> gauss{0.0, 1.0};
  std::vector<Vector3<double>> points;
};

struct Consistency {
  double pose = 0.0;    ///< mean normalised estimation error squared, 3 degrees of freedom
  double tilt = 0.0;    ///< the same, 2
  double travel = 0.0;  ///< the same of the direction of travel at the end of the drive, 1
  double nis = 0.0;     ///< per degree of freedom
  double heading_rad = 0.0;
  double inlier_share = 0.0;
};

enum class Floor : std::uint8_t { kFollows, kFlat };

/// What a filter is told of vehicles whose body tilts as suspension() says, `tilt_scale` times as
/// far, and which travel beside their x axis by an angle of `travel_rad`, standard deviation.
struct Vehicle {
  TiltParameters<double> known;
  double tilt_scale = 1.0;
  Floor floor = Floor::kFollows;
  double known_travel_rad = 0.0;
  double travel_rad = 0.0;
};

template <class Filter>
Consistency drive(int runs, const Vehicle& vehicle) {
  constexpr int kFrames = 120;
  constexpr double kStep_s = 0.1;
  constexpr double kPixel = 0.5;
  const TiltParameters<double> body = suspension();
  PinholeCamera<double> camera = test::vga_camera<double>();
  Consistency out;
  int samples = 0;
  int matched = 0;
  int inliers = 0;
  double nis = 0.0;
  int dof = 0;
  for (int run = 0; run < runs; ++run) {
    Street street(1000 + run);
    Filter filter;
    PlanarParameters<double> parameters;
    parameters.tilt = vehicle.known;
    parameters.travel_sigma_rad = vehicle.known_travel_rad;
    parameters.reacquire_after = 0;
    parameters.gate = 18.42;
    PlanarPose<double> start;
    EXPECT_TRUE(ok(filter.initialise(start, Matrix3<double>::Identity() * 1e-6, parameters)));
    Vector3<double> truth{street.normal(1e-3), street.normal(1e-3), street.normal(1e-3)};
    VehicleTilt<double> tilt{vehicle.tilt_scale * street.normal(body.sigma_pitch_rad),
                             vehicle.tilt_scale * street.normal(body.sigma_roll_rad)};
    const double travel = vehicle.travel_rad > 0.0 ? street.normal(vehicle.travel_rad) : 0.0;
    Random random(run);
    std::vector<bool> in_map(street.points.size(), false);
    for (int frame = 0; frame < kFrames; ++frame) {
      const double turn = 0.02 * std::sin(0.1 * frame);
      PlanarIncrement<double> increment;
      increment.model = IncrementModel::kExactArc;
      increment.covariance << 4e-4, 0.0, 0.0, 2.5e-5;
      const double distance = 0.5;
      truth(0) += distance * std::cos(truth(2) + 0.5 * turn + travel);
      truth(1) += distance * std::sin(truth(2) + 0.5 * turn + travel);
      truth(2) += turn;
      increment.distance_m = distance + street.normal(0.02);
      increment.turn_rad = turn + street.normal(0.005);
      const double decay = body.decay(kStep_s);
      const Vector2<double> noise = body.noise(decay);
      if (vehicle.floor == Floor::kFollows) {
        street.turn(truth, tilt, {decay * tilt.pitch, decay * tilt.roll});
      }
      tilt.pitch = decay * tilt.pitch + vehicle.tilt_scale * street.normal(std::sqrt(noise(0)));
      tilt.roll = decay * tilt.roll + vehicle.tilt_scale * street.normal(std::sqrt(noise(1)));
      EXPECT_TRUE(ok(filter.predict(increment)));
      EXPECT_TRUE(ok(filter.predict_tilt(kStep_s)));

      const Rigid<double> T_world_level{
          Quaternion<double>(Eigen::AngleAxisd(truth(2), Eigen::Vector3d::UnitZ())),
          {truth(0), truth(1), 0.0}};
      const Rigid<double> T_vehicle_world = (T_world_level * tilt.T_level_vehicle()).inverse();
      const Rigid<double> T_camera_world = mounting().inverse() * T_vehicle_world;
      std::vector<PixelMatch<double>> matches;
      std::vector<int> fresh;
      for (std::size_t i = 0; i < street.points.size(); ++i) {
        Vector2<double> pixel;
        const Vector3<double> p = T_camera_world * street.points[i];
        if (p.z() < 3.0 || p.z() > 25.0 || !ok(camera.project(p, pixel)) ||
            !camera.contains(pixel)) {
          continue;
        }
        const auto id = static_cast<LandmarkId>(i + 1);
        const int slot = filter.find(id);
        if (slot < 0) {
          if (!in_map[i]) fresh.push_back(static_cast<int>(i));
          continue;
        }
        PixelMatch<double> match;
        match.id = id;
        match.slot = slot;
        match.pixel = pixel + Vector2<double>{street.normal(kPixel), street.normal(kPixel)};
        matches.push_back(match);
      }
      UpdateReport report;
      if (matches.size() > 2) {
        static_cast<void>(filter.update_pixels(camera, mounting(), kPixel, matches.data(),
                                               static_cast<int>(matches.size()), random, report));
        for (const PixelMatch<double>& match : matches) inliers += match.inlier ? 1 : 0;
        matched += static_cast<int>(matches.size());
        nis += static_cast<double>(report.nis);
        dof += report.nis_dof;
      }
      for (int slot = filter.landmark_count() - 1; slot >= 0; --slot) {
        const auto& point = street.points[filter.landmark_id(slot) - 1];
        if (point.x() >= truth(0)) continue;
        EXPECT_TRUE(ok(filter.remove_landmark(slot)));
      }
      for (const int i : fresh) {
        if (filter.landmark_count() >= 20) break;
        const Vector3<double> y = T_vehicle_world * street.points[i];
        const Vector3<double> seen =
            y + Vector3<double>{street.normal(0.1), street.normal(0.05), street.normal(0.05)};
        const Matrix3<double> R = Vector3<double>(0.01, 0.0025, 0.0025).asDiagonal();
        in_map[i] = ok(filter.add_landmark(static_cast<LandmarkId>(i + 1), seen, R));
      }
      if (frame < 5) continue;
      ++samples;
      const PlanarPose<double> pose = filter.pose();
      const Vector3<double> error(pose.position.x() - truth(0), pose.position.y() - truth(1),
                                  wrap_angle(pose.heading - truth(2)));
      out.pose += error.dot(filter.pose_covariance().inverse() * error);
      out.heading_rad += error.z() * error.z();
      if (filter.tilts()) {
        const Vector2<double> off(filter.tilt().pitch - tilt.pitch, filter.tilt().roll - tilt.roll);
        out.tilt += off.dot(filter.tilt_covariance().inverse() * off);
      }
    }
    const DirectionOfTravel<double> told = filter.travel();
    if (told.variance > 0.0) out.travel += square(told.angle_rad - travel) / told.variance / runs;
  }
  out.pose /= samples;
  out.tilt /= samples;
  out.heading_rad = std::sqrt(out.heading_rad / samples);
  out.nis = nis / dof;
  out.inlier_share = static_cast<double>(inliers) / matched;
  return out;
}

}  // namespace cairn::planar_test

#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "cairn/numeric/random.hpp"
#include "cairn/planar/fixed/fixed_group_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"

namespace cairn::planar_test {

/// Pixels of landmarks as an observation of PlanarSlam::update(): all at the present mean, without
/// the consensus of update_pixels().
struct PixelObservation {
  LandmarkId id = kNoLandmark;
  Vector2<double> pixel = Vector2<double>::Zero();
};
struct PixelSensor {
  CameraView<double> view;

  Status check(const PixelObservation&) const { return Status::kOk; }
  bool linearise(const PixelObservation& observation, const RelativeFrame<double>&,
                 const double* relative, const RelativeCovariance<double>& covariance,
                 LinearisedObservation<double, 3>& out) const {
    Vector3<double> p_camera;
    if (!view.linearise(relative, covariance, out, p_camera)) return false;
    for (int i = 0; i < 2; ++i) out.innovation[i] += observation.pixel(i);
    return true;
  }
};

/// A vehicle with a camera that drives through landmarks with height, for the filter without
/// floating point and its like in double: both get the same numbers, those that fit the formats.
template <int MaxLandmarks>
class FixedCameraDrive {
 public:
  using FixedFilter = FixedGroupSlam<MaxLandmarks, 3>;
  /// With a slot to spare, see take_motion_in().
  using DoubleFilter = GroupIekfSlam<double, MaxLandmarks + 1, 3>;
  static constexpr int kWorld = 60;

  FixedCameraDrive(std::uint64_t seed, bool tilts, double rest_sigmas = 0.0, double gate = 1e9)
      : random_(seed), fixed_draws_(seed), double_draws_(seed) {
    fixed_camera_.width = 640;
    fixed_camera_.height = 480;
    fixed_camera_.fx = FixedPixel::nearest(400.0);
    fixed_camera_.fy = FixedPixel::nearest(402.0);
    fixed_camera_.cx = FixedPixel::nearest(319.5);
    fixed_camera_.cy = FixedPixel::nearest(239.5);
    fixed_camera_.k1 = FixedTangent::nearest(-0.12);
    fixed_camera_.k2 = FixedTangent::nearest(0.04);
    fixed_camera_.p1 = FixedTangent::nearest(0.001);
    camera_.fx = 400.0;
    camera_.fy = 402.0;
    camera_.cx = 319.5;
    camera_.cy = 239.5;
    camera_.k1 = fixed_camera_.k1.to_double();
    camera_.k2 = fixed_camera_.k2.to_double();
    camera_.p1 = fixed_camera_.p1.to_double();
    camera_.width = 640;
    camera_.height = 480;
    // Ahead and 4 degrees down, 0.35 m before the axle, 1 m high.
    const double half = 0.5 * (1.5707963267948966 + 0.07);
    const Quaternion<double> down(std::cos(half), std::sin(half), 0.0, 0.0);
    const Quaternion<double> q =
        Quaternion<double>(std::sqrt(0.5), 0.0, 0.0, -std::sqrt(0.5)) * down.conjugate();
    mount_.w = FixedRatio::nearest(q.w());
    mount_.x = FixedRatio::nearest(q.x());
    mount_.y = FixedRatio::nearest(q.y());
    mount_.z = FixedRatio::nearest(q.z());
    mount_.origin[0] = FixedLength::nearest(0.35);
    mount_.origin[2] = FixedLength::nearest(1.0);
    T_vehicle_camera_.rotation = {mount_.w.to_double(), mount_.x.to_double(), mount_.y.to_double(),
                                  mount_.z.to_double()};
    for (int i = 0; i < 3; ++i) T_vehicle_camera_.translation(i) = mount_.origin[i].to_double();

    FixedPoseCovariance covariance;
    const auto variance = FixedVariance::nearest(0.01);
    covariance.position = {variance, {}, variance};
    covariance.heading = FixedVariance::nearest(1e-3);
    Matrix3<double> of_double = Matrix3<double>::Zero();
    of_double(0, 0) = of_double(1, 1) = variance.to_double();
    of_double(2, 2) = covariance.heading.to_double();
    FixedPlanarParameters fixed_parameters;
    fixed_parameters.gate = FixedScore::nearest(gate);
    PlanarParameters<double> parameters;
    parameters.gate = gate;
    fixed_parameters.rest_sigmas = FixedScore::nearest(rest_sigmas);
    parameters.rest_sigmas = rest_sigmas;
    if (tilts) {
      fixed_parameters.tilt.sigma_pitch = FixedAngle::nearest(0.01);
      fixed_parameters.tilt.sigma_roll = FixedAngle::nearest(0.02);
      parameters.tilt.sigma_pitch_rad = fixed_parameters.tilt.sigma_pitch.to_double();
      parameters.tilt.sigma_roll_rad = fixed_parameters.tilt.sigma_roll.to_double();
    }
    good_ = ok(fixed_->initialise({}, covariance, fixed_parameters)) &&
            ok(double_->initialise({}, of_double, parameters));
    for (auto& landmark : world_) {
      landmark = {20.0 * (uniform() - 0.5), 20.0 * (uniform() - 0.5), 2.5 * uniform()};
    }
  }

  bool good() const { return good_; }
  FixedFilter& fixed() { return *fixed_; }
  DoubleFilter& reference() { return *double_; }
  int used() const { return used_; }
  const FixedCamera& camera() const { return fixed_camera_; }
  const FixedMount& mount() const { return mount_; }

  /// 0.1 s of a circle, by odometry with noise.
  void move(double distance_m = 0.1, double turn_rad = 0.02) {
    FixedIncrement step;
    const bool rests = distance_m == 0.0 && turn_rad == 0.0;
    step.distance = FixedOffset::nearest(distance_m + (rests ? 0.0 : 0.004 * normal()));
    step.turn = FixedAngle::nearest(turn_rad + (rests ? 0.0 : 0.003 * normal()));
    step.distance_variance = FixedVariance::nearest(1.6e-5);
    step.turn_variance = FixedVariance::nearest(9e-6);
    step.model = IncrementModel::kExactArc;
    PlanarIncrement<double> increment;
    increment.distance_m = step.distance.to_double();
    increment.turn_rad = step.turn.to_double();
    increment.covariance << step.distance_variance.to_double(), 0.0, 0.0,
        step.turn_variance.to_double();
    increment.model = step.model;
    const FixedOffset dt = FixedOffset::nearest(0.1);
    good_ = good_ && ok(fixed_->predict(step)) && ok(double_->predict(increment)) &&
            ok(fixed_->predict_tilt(dt)) && ok(double_->predict_tilt(dt.to_double()));
    const double middle = heading_ + 0.5 * turn_rad;
    position_ += distance_m * Vector2<double>(std::cos(middle), std::sin(middle));
    heading_ += turn_rad;
    if (double_->tilts()) {
      tilt_.pitch = 0.9 * tilt_.pitch + 0.004 * normal();
      tilt_.roll = 0.9 * tilt_.roll + 0.008 * normal();
    }
  }

  /// Pixels of what is in view and known; new landmarks by their point and its noise.
  void look(double sigma = 0.5) {
    const FixedPixel sigma_px = FixedPixel::nearest(sigma);
    std::vector<FixedPixelMatch> matches;
    std::vector<int> unknown;
    match(sigma, 0.0, matches, unknown);
    std::vector<PixelObservation> seen;
    for (const FixedPixelMatch& match : matches) seen.push_back({match.id, pixel_of(match)});
    FixedUpdateReport report;
    UpdateReport expected;
    const auto count = static_cast<int>(matches.size());
    good_ = good_ && ok(fixed_->update_pixels(fixed_camera_, mount_, sigma_px, matches.data(),
                                              count, report));
    PixelSensor sensor{double_view(sigma_px.to_double())};
    good_ =
        good_ && ok(double_->update(Span<PixelObservation>{seen.data(), count}, sensor, expected));
    good_ = good_ && report.nis_dof == expected.nis_dof &&
            std::abs(report.nis.to_double() - static_cast<double>(expected.nis)) <
                2e-2 * (1.0 + static_cast<double>(expected.nis));
    used_ += report.nis_dof / 2;
    add_all(unknown);
  }

  /// The same by the consensus of both filters, where a share of the pixels lies anywhere: half of
  /// them within 40 px of the landmark's. Whether both used the same.
  bool agree(double outliers, double sigma = 0.5) {
    const FixedPixel sigma_px = FixedPixel::nearest(sigma);
    std::vector<FixedPixelMatch> matches;
    std::vector<int> unknown;
    match(sigma, outliers, matches, unknown);
    std::vector<PixelMatch<double>> expected(matches.size());
    for (std::size_t k = 0; k < matches.size(); ++k) {
      expected[k].id = matches[k].id;
      expected[k].pixel = pixel_of(matches[k]);
    }
    const auto count = static_cast<int>(matches.size());
    FixedUpdateReport report;
    UpdateReport reference;
    const Status status = fixed_->update_pixels(fixed_camera_, mount_, sigma_px, matches.data(),
                                                count, fixed_draws_, report);
    bool same = status == double_->update_pixels(camera_, T_vehicle_camera_, sigma_px.to_double(),
                                                 expected.data(), count, double_draws_, reference);
    same = same && report.matches == reference.matches && report.gated == reference.gated &&
           report.hypotheses == reference.hypotheses &&
           report.low_innovation == reference.low_innovation &&
           report.high_innovation == reference.high_innovation &&
           report.nis_dof == reference.nis_dof;
    for (std::size_t k = 0; k < matches.size(); ++k) {
      same = same && matches[k].inlier == expected[k].inlier;
    }
    good_ = good_ && (ok(status) || status == Status::kNoConsensus);
    if (!ok(status)) ++without_consensus_;
    hypotheses_ += report.hypotheses;
    rescued_ += report.high_innovation;
    used_ += report.nis_dof / 2;
    add_all(unknown);
    return same;
  }
  /// PlanarSlam takes the noise of the odometry in where the best hypothesis has moved the mean,
  /// the fixed filter before: so does the reference after this.
  void take_motion_in() {
    if (double_->landmark_count() == 0) return;
    constexpr LandmarkId kPlace = 1000;
    good_ = good_ && ok(double_->add_position(kPlace)) &&
            ok(double_->remove_landmark(double_->find(kPlace)));
  }
  int hypotheses() const { return hypotheses_; }
  int rescued() const { return rescued_; }
  int without_consensus() const { return without_consensus_; }
  int outliers() const { return outliers_; }

  void add(int i) {
    const Vector3<double> body = in_body(world_[static_cast<std::size_t>(i)]);
    const auto id = static_cast<LandmarkId>(i + 1);
    FixedLength y[3];
    Vector3<double> at;
    for (int k = 0; k < 3; ++k) {
      y[k] = FixedLength::nearest(body(k) + 0.05 * normal());
      at(k) = y[k].to_double();
    }
    const FixedCovariance3 noise = {FixedVariance::nearest(0.004),  FixedVariance::nearest(0.001),
                                    FixedVariance::nearest(0.0025), FixedVariance::nearest(-0.0005),
                                    FixedVariance::nearest(0.0004), FixedVariance::nearest(0.002)};
    Matrix3<double> R;
    R << noise.xx.to_double(), noise.xy.to_double(), noise.xz.to_double(), noise.xy.to_double(),
        noise.yy.to_double(), noise.yz.to_double(), noise.xz.to_double(), noise.yz.to_double(),
        noise.zz.to_double();
    good_ = good_ && ok(fixed_->add_landmark(id, y, noise)) && ok(double_->add_landmark(id, at, R));
  }

  void forget(LandmarkId id) {
    const int slot = fixed_->find(id);
    if (slot < 0) return;
    good_ = good_ && ok(fixed_->remove_landmark(slot)) &&
            ok(double_->remove_landmark(double_->find(id)));
  }

  CameraView<double> double_view(double sigma) const {
    const Rigid<double> mounted = double_->tilts()
                                      ? double_->tilt().T_level_vehicle() * T_vehicle_camera_
                                      : T_vehicle_camera_;
    CameraView<double> view(camera_, mounted, sigma);
    sin_cos(double_->mean_pose().heading, view.frame.sine, view.frame.cosine);
    view.tilts = double_->tilts();
    return view;
  }
  const PinholeCamera<double>& double_camera() const { return camera_; }
  const Rigid<double>& double_mount() const { return T_vehicle_camera_; }

  /// Largest difference of the means, m and rad.
  double mean_difference() const {
    const FixedPose pose = fixed_->mean_pose();
    const PlanarPose<double> expected = double_->mean_pose();
    double largest = std::abs(wrap_angle(pose.heading.to_double() - expected.heading));
    const auto note = [&largest](double a, double b) {
      largest = std::max(largest, std::abs(a - b));
    };
    note(pose.x.to_double(), expected.position.x());
    note(pose.y.to_double(), expected.position.y());
    note(fixed_->tilt().pitch.to_double(), double_->tilt().pitch);
    note(fixed_->tilt().roll.to_double(), double_->tilt().roll);
    for (int slot = 0; slot < fixed_->landmark_count(); ++slot) {
      const int other = double_->find(fixed_->landmark_id(slot));
      if (other < 0) return HUGE_VAL;
      const FixedLandmark landmark = fixed_->mean_landmark(slot);
      const Vector3<double> p = double_->mean_landmark(other);
      note(landmark.x.to_double(), p.x());
      note(landmark.y.to_double(), p.y());
      note(fixed_->landmark_height(slot).to_double(), p.z());
    }
    return largest;
  }

  /// Largest difference of the covariances of heights, tilt, pose and places, of the deviations.
  double covariance_difference() const {
    double largest = 0.0;
    const auto note = [&largest](double a, double b, double scale) {
      largest = std::max(largest, std::abs(a - b) / scale);
    };
    FixedPose pose;
    FixedPoseCovariance c;
    fixed_->pose(pose, c);
    const Matrix3<double> p = double_->pose_covariance();
    note(c.position.xx.to_double(), p(0, 0), p(0, 0));
    note(c.position.xy.to_double(), p(1, 0), std::sqrt(p(0, 0) * p(1, 1)));
    note(c.position.yy.to_double(), p(1, 1), p(1, 1));
    note(c.heading.to_double(), p(2, 2), p(2, 2));
    if (double_->tilts()) {
      const FixedCovariance2 t = fixed_->tilt_covariance();
      const Matrix2<double> q = double_->tilt_covariance();
      note(t.xx.to_double(), q(0, 0), q(0, 0));
      note(t.xy.to_double(), q(1, 0), std::sqrt(q(0, 0) * q(1, 1)));
      note(t.yy.to_double(), q(1, 1), q(1, 1));
    }
    for (int slot = 0; slot < fixed_->landmark_count(); ++slot) {
      const int other = double_->find(fixed_->landmark_id(slot));
      if (other < 0) return HUGE_VAL;
      const Matrix3<double> l = double_->landmark_covariance(other);
      const FixedCovariance2 xy = fixed_->landmark(slot).covariance;
      note(fixed_->landmark_height_variance(slot).to_double(), l(2, 2), l(2, 2));
      note(xy.xx.to_double(), l(0, 0), l(0, 0));
      note(xy.xy.to_double(), l(1, 0), std::sqrt(l(0, 0) * l(1, 1)));
      note(xy.yy.to_double(), l(1, 1), l(1, 1));
    }
    return largest;
  }

 private:
  static Vector2<double> pixel_of(const FixedPixelMatch& match) {
    return {match.pixel[0].to_double(), match.pixel[1].to_double()};
  }
  /// Pixels of what is in view: those known, and who is not.
  void match(double sigma, double outliers, std::vector<FixedPixelMatch>& matches,
             std::vector<int>& unknown) {
    for (int i = 0; i < kWorld; ++i) {
      Vector2<double> pixel;
      const Vector3<double> body = in_body(world_[static_cast<std::size_t>(i)]);
      if (!sees(body, pixel)) continue;
      const auto id = static_cast<LandmarkId>(i + 1);
      if (fixed_->find(id) < 0) {
        unknown.push_back(i);
        continue;
      }
      if (outliers > 0.0 && uniform() < outliers) {
        ++outliers_;
        if (uniform() < 0.5) {
          pixel.y() += 80.0 * (uniform() - 0.5);
          pixel.x() += 80.0 * (uniform() - 0.5);
        } else {
          pixel.x() = 640.0 * uniform();
          pixel.y() = 480.0 * uniform();
        }
      }
      FixedPixelMatch match;
      match.id = id;
      for (int k = 0; k < 2; ++k) {
        match.pixel[k] = FixedPixel::nearest(pixel(k) + sigma * normal());
      }
      matches.push_back(match);
    }
  }
  void add_all(const std::vector<int>& unknown) {
    for (const int i : unknown) {
      if (fixed_->landmark_count() < MaxLandmarks) add(i);
    }
  }
  /// A world point in the tilted vehicle's axes.
  Vector3<double> in_body(const Vector3<double>& p) const {
    const double dx = p.x() - position_.x();
    const double dy = p.y() - position_.y();
    const double c = std::cos(heading_);
    const double s = std::sin(heading_);
    const Vector3<double> level(c * dx + s * dy, c * dy - s * dx, p.z());
    return tilt_.T_level_vehicle().inverse() * level;
  }
  bool sees(const Vector3<double>& body, Vector2<double>& pixel) const {
    const Vector3<double> p = T_vehicle_camera_.inverse() * body;
    return p.z() > 0.8 && p.z() < 12.0 && ok(camera_.project(p, pixel)) &&
           camera_.contains(pixel, 5.0);
  }
  double uniform() { return random_.next() / 4294967296.0; }
  /// Near enough to a normal deviate.
  double normal() {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum;
  }

  Random random_;
  Random fixed_draws_;
  Random double_draws_;
  FixedCamera fixed_camera_;
  FixedMount mount_;
  PinholeCamera<double> camera_;
  Rigid<double> T_vehicle_camera_;
  std::array<Vector3<double>, kWorld> world_;
  Vector2<double> position_ = Vector2<double>::Zero();
  double heading_ = 0.0;
  VehicleTilt<double> tilt_;
  std::unique_ptr<FixedFilter> fixed_ = std::make_unique<FixedFilter>();
  std::unique_ptr<DoubleFilter> double_ = std::make_unique<DoubleFilter>();
  bool good_ = false;
  int used_ = 0;
  int hypotheses_ = 0;
  int rescued_ = 0;
  int without_consensus_ = 0;
  int outliers_ = 0;
};

}  // namespace cairn::planar_test

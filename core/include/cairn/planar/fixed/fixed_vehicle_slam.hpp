#pragma once

#include "cairn/geometry/fixed_rigid.hpp"
#include "cairn/planar/fixed/fixed_group_slam.hpp"
#include "cairn/planar/fixed/float_messages.hpp"

namespace cairn {

/// FixedGroupSlam of landmarks with height behind the messages of GroupIekfSlam<float>, for the
/// trackers: VehicleTracker<Config, FixedVehicleSlam<Config::kMaxLandmarks>> runs where there is no
/// floating-point unit. Messages become fixed point and back by their bits: nothing here computes
/// with floats.
///
/// Members: as PlanarSlam's of the same names. A message that is not finite or does not fit is
/// refused, kInvalidArgument; a camera with a rational or a fisheye lens, kBadConfig.
template <int MaxLandmarks>
class FixedVehicleSlam {
  using Core = FixedGroupSlam<MaxLandmarks, 3>;

 public:
  using Scalar = float;
  static constexpr int kMaxLandmarks = MaxLandmarks;
  static constexpr int kLandmarkDim = 3;
  static constexpr int kStates = Core::kStates;
  static constexpr int kMaxObservations = Core::kMaxObservations;
  static constexpr bool kHasWorldLandmarks = true;
  static constexpr bool kTilts = true;
  using LandmarkVector = Vector3<float>;
  using LandmarkMatrix = Matrix3<float>;
  using Placement = typename Core::Placement;

  /// kBadConfig for a lens that has no fixed form.
  static Status check_camera(const PinholeCamera<float>& camera) {
    FixedCamera fixed;
    return fixed_of(camera, fixed);
  }

  Status initialise(const PlanarPose<float>& pose, const Matrix3<float>& covariance,
                    const PlanarParameters<float>& parameters = PlanarParameters<float>{});

  Status predict(const PlanarIncrement<float>& increment) {
    std::uint32_t lost = 0;
    const FixedIncrement fixed = fixed_of(increment, lost);
    return lost == 0 ? core_.predict(fixed) : Status::kInvalidArgument;
  }
  Status predict_tilt(float dt_s) {
    std::uint32_t lost = 0;
    const auto fixed = fixed_of<FixedOffset>(dt_s, lost);
    return lost == 0 ? core_.predict_tilt(fixed) : Status::kInvalidArgument;
  }
  Status widen_pose(float position_variance, float heading_variance) {
    return with_variances(position_variance, heading_variance,
                          [&](FixedVariance p, FixedVariance h) { return core_.widen_pose(p, h); });
  }
  Status slip_laterally(float variance) {
    return with_variances(variance, 0.0F,
                          [&](FixedVariance v, FixedVariance) { return core_.slip_laterally(v); });
  }
  Status drift_world(float position_variance, float heading_variance) {
    return with_variances(
        position_variance, heading_variance,
        [&](FixedVariance p, FixedVariance h) { return core_.drift_world(p, h); });
  }

  Status predict_pixel(int slot, const PinholeCamera<float>& camera,
                       const Rigid<float>& T_vehicle_camera, float sigma_px,
                       PixelPrediction<float>& prediction) const;
  /// The same without messages in float.
  Status predict_pixel(int slot, const PinholeCamera<float>& camera,
                       const Rigid<float>& T_vehicle_camera, float sigma_px,
                       FixedPixelPrediction& prediction) const;
  Status update_pixels(const PinholeCamera<float>& camera, const Rigid<float>& T_vehicle_camera,
                       float sigma_px, PixelMatch<float>* matches, int count, Random& random,
                       UpdateReport& report);
  void set_ransac(const OnePointRansacParameters& ransac) {
    std::uint32_t lost = 0;
    const FixedRansacParameters fixed = fixed_of(ransac, lost);
    if (lost == 0 && ok(core_.set_ransac(fixed))) parameters_.ransac = ransac;
  }
  Status update_height(LandmarkId id, float height_m, float sigma_m, float gate);

  Status add_landmark(LandmarkId id, const LandmarkVector& y_vehicle, const LandmarkMatrix& R,
                      LandmarkId* replaced = nullptr);
  Status add_position(LandmarkId id) { return core_.add_position(id); }
  Status add_landmark_on_path(LandmarkId id, const LandmarkVector& y_vehicle,
                              const LandmarkMatrix& R, LandmarkId past,
                              const Matrix<float, 3, 2>& by_path, LandmarkId* replaced = nullptr);
  Status add_frame_position(LandmarkId id, const LandmarkVector& p_world,
                            const LandmarkMatrix& covariance, LandmarkId reference = kNoLandmark);
  Status add_framed_landmark(LandmarkId id, const LandmarkVector& p_world,
                             const LandmarkMatrix& covariance, LandmarkId origin, LandmarkId ahead,
                             LandmarkId* replaced = nullptr);
  Status widen_frame(LandmarkId origin, LandmarkId ahead, float position_variance,
                     float heading_variance) {
    return with_variances(
        position_variance, heading_variance,
        [&](FixedVariance p, FixedVariance h) { return core_.widen_frame(origin, ahead, p, h); });
  }
  Status remove_landmark(int slot) { return core_.remove_landmark(slot); }

  Placement place(const PlanarPose<float>& pose, float position_variance, float heading_variance) {
    std::uint32_t lost = 0;
    return core_.place(fixed_of(pose, lost), fixed_of<FixedVariance>(position_variance, lost),
                       fixed_of<FixedVariance>(heading_variance, lost));
  }
  void put_back(const Placement& before) { core_.put_back(before); }
  bool recentre() { return core_.recentre(); }

  bool initialised() const { return core_.initialised(); }
  int landmark_count() const { return core_.landmark_count(); }
  LandmarkId landmark_id(int slot) const { return core_.landmark_id(slot); }
  int find(LandmarkId id) const { return id == kNoLandmark ? -1 : core_.find(id); }
  int state_size() const { return core_.state_size(); }
  const PlanarParameters<float>& parameters() const { return parameters_; }
  const Health& health() const { return core_.health(); }
  /// As FixedPlanarSlam::saturations().
  std::uint32_t saturations() const { return core_.saturations(); }
  void hash(Hash64& hash) const { core_.hash(hash); }
  const Core& core() const { return core_; }

  bool tilts() const { return core_.tilts(); }
  VehicleTilt<float> tilt() const {
    return {float_of(core_.tilt().pitch), float_of(core_.tilt().roll)};
  }
  Matrix2<float> tilt_covariance() const { return float_of(core_.tilt_covariance()); }
  Vector2<float> tilt_noise(float dt_s) const;

  PlanarPose<float> mean_pose() const { return float_of(core_.mean_pose()); }
  /// Of a camera on the tilted vehicle, at the mean.
  FixedRigid T_world_camera(const Rigid<float>& T_vehicle_camera) const;
  LandmarkVector mean_landmark(int slot) const { return at(core_.mean_landmark(slot), slot); }
  /// The same without messages in float.
  void mean_landmark(int slot, FixedCoordinate (&place)[3]) const {
    const FixedLandmark landmark = core_.mean_landmark(slot);
    place[0] = landmark.x;
    place[1] = landmark.y;
    place[2] = core_.landmark_height(slot);
  }
  PlanarPose<float> pose() const {
    FixedPose mean;
    FixedPoseCovariance covariance;
    core_.pose(mean, covariance);
    return float_of(mean);
  }
  Matrix3<float> pose_covariance() const {
    FixedPose mean;
    FixedPoseCovariance covariance;
    core_.pose(mean, covariance);
    return float_of(covariance);
  }
  Matrix3<float> own_pose_covariance() const { return float_of(core_.own_pose_covariance()); }
  Matrix3<float> framed_pose_covariance(LandmarkId origin, LandmarkId ahead) const {
    return float_of(core_.framed_pose_covariance(origin, ahead));
  }
  LandmarkVector landmark_position(int slot) const { return at(core_.landmark(slot), slot); }
  LandmarkMatrix landmark_covariance(int slot) const {
    return float_of(core_.landmark_covariance(slot));
  }
  LandmarkMatrix relative_landmark_covariance(int slot) const {
    return float_of(core_.relative_landmark_covariance(slot));
  }

 private:
  template <class Use>
  static Status with_variances(float position, float heading, const Use& use) {
    std::uint32_t lost = 0;
    const auto p = fixed_of<FixedVariance>(position, lost);
    const auto h = fixed_of<FixedVariance>(heading, lost);
    return lost == 0 ? use(p, h) : Status::kInvalidArgument;
  }
  template <class F>
  static void of_vector(const Vector3<float>& v, F (&out)[3], std::uint32_t& lost) {
    for (int axis = 0; axis < 3; ++axis) out[axis] = fixed_of<F>(v(axis), lost);
  }
  LandmarkVector at(const FixedLandmark& landmark, int slot) const {
    return {float_of(landmark.x), float_of(landmark.y), float_of(core_.landmark_height(slot))};
  }

  Core core_;
  PlanarParameters<float> parameters_;
};

template <int MaxLandmarks>
Status FixedVehicleSlam<MaxLandmarks>::initialise(const PlanarPose<float>& pose,
                                                  const Matrix3<float>& covariance,
                                                  const PlanarParameters<float>& parameters) {
  std::uint32_t lost = 0;
  const FixedPose fixed_pose = fixed_of(pose, lost);
  const FixedPoseCovariance fixed_covariance = fixed_pose_covariance_of(covariance, lost);
  const FixedPlanarParameters fixed_parameters = fixed_of(parameters, lost);
  if (lost != 0) return Status::kInvalidArgument;
  const Status status = core_.initialise(fixed_pose, fixed_covariance, fixed_parameters);
  if (ok(status)) parameters_ = parameters;
  return status;
}

template <int MaxLandmarks>
Status FixedVehicleSlam<MaxLandmarks>::predict_pixel(int slot, const PinholeCamera<float>& camera,
                                                     const Rigid<float>& T_vehicle_camera,
                                                     float sigma_px,
                                                     PixelPrediction<float>& prediction) const {
  FixedPixelPrediction expected;
  const Status status = predict_pixel(slot, camera, T_vehicle_camera, sigma_px, expected);
  if (ok(status)) float_of(expected, prediction);
  return status;
}

template <int MaxLandmarks>
Status FixedVehicleSlam<MaxLandmarks>::predict_pixel(int slot, const PinholeCamera<float>& camera,
                                                     const Rigid<float>& T_vehicle_camera,
                                                     float sigma_px,
                                                     FixedPixelPrediction& prediction) const {
  std::uint32_t lost = 0;
  FixedCamera fixed;
  const Status status = fixed_of(camera, fixed);
  if (!ok(status)) return status;
  const FixedMount mount = fixed_of(T_vehicle_camera, lost);
  const auto sigma = fixed_of<FixedPixel>(sigma_px, lost);
  if (lost != 0) return Status::kNonFiniteInput;
  return core_.expect_pixel(slot, fixed, mount, sigma, prediction);
}

template <int MaxLandmarks>
Status FixedVehicleSlam<MaxLandmarks>::update_pixels(const PinholeCamera<float>& camera,
                                                     const Rigid<float>& T_vehicle_camera,
                                                     float sigma_px, PixelMatch<float>* matches,
                                                     int count, Random& random,
                                                     UpdateReport& report) {
  report = UpdateReport{};
  if (count < 0 || count > kMaxObservations) return Status::kInvalidArgument;
  std::uint32_t lost = 0;
  FixedCamera fixed;
  Status status = fixed_of(camera, fixed);
  if (!ok(status)) return status;
  FixedPixelMatch found[kMaxObservations];
  for (int i = 0; i < count; ++i) {
    found[i].id = matches[i].id;
    for (int axis = 0; axis < 2; ++axis) {
      found[i].pixel[axis] = fixed_of<FixedPixel>(matches[i].pixel(axis), lost);
    }
  }
  const FixedMount mount = fixed_of(T_vehicle_camera, lost);
  const auto sigma = fixed_of<FixedPixel>(sigma_px, lost);
  if (lost != 0) return Status::kNonFiniteInput;
  FixedUpdateReport did;
  status = core_.update_pixels(fixed, mount, sigma, found, count, random, did);
  for (int i = 0; i < count; ++i) matches[i].inlier = found[i].inlier;
  report.matches = did.matches;
  report.hypotheses = did.hypotheses;
  report.low_innovation = did.low_innovation;
  report.high_innovation = did.high_innovation;
  report.gated = did.gated;
  report.nis = float_of(did.nis);
  report.nis_dof = did.nis_dof;
  return status;
}

template <int MaxLandmarks>
Status FixedVehicleSlam<MaxLandmarks>::update_height(LandmarkId id, float height_m, float sigma_m,
                                                     float gate) {
  std::uint32_t lost = 0;
  const auto height = fixed_of<FixedLength>(height_m, lost);
  const auto sigma = fixed_of<FixedLength>(sigma_m, lost);
  const auto limit = fixed_of<FixedScore>(gate, lost);
  return lost == 0 ? core_.update_height(id, height, sigma, limit) : Status::kInvalidArgument;
}

template <int MaxLandmarks>
Status FixedVehicleSlam<MaxLandmarks>::add_landmark(LandmarkId id, const LandmarkVector& y_vehicle,
                                                    const LandmarkMatrix& R, LandmarkId* replaced) {
  std::uint32_t lost = 0;
  FixedLength y[3];
  of_vector(y_vehicle, y, lost);
  const FixedCovariance3 noise = fixed_of(R, lost);
  return lost == 0 ? core_.add_landmark(id, y, noise, replaced) : Status::kInvalidArgument;
}

template <int MaxLandmarks>
Status FixedVehicleSlam<MaxLandmarks>::add_landmark_on_path(
    LandmarkId id, const LandmarkVector& y_vehicle, const LandmarkMatrix& R, LandmarkId past,
    const Matrix<float, 3, 2>& by_path, LandmarkId* replaced) {
  std::uint32_t lost = 0;
  FixedLength y[3];
  of_vector(y_vehicle, y, lost);
  FixedLength path[3][2];
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 2; ++k) path[i][k] = fixed_of<FixedLength>(by_path(i, k), lost);
  }
  const FixedCovariance3 noise = fixed_of(R, lost);
  if (lost != 0) return Status::kInvalidArgument;
  return core_.add_landmark_on_path(id, y, noise, past, path, replaced);
}

template <int MaxLandmarks>
Status FixedVehicleSlam<MaxLandmarks>::add_frame_position(LandmarkId id,
                                                          const LandmarkVector& p_world,
                                                          const LandmarkMatrix& covariance,
                                                          LandmarkId reference) {
  std::uint32_t lost = 0;
  FixedCoordinate p[3];
  of_vector(p_world, p, lost);
  const FixedCovariance3 noise = fixed_of(covariance, lost);
  return lost == 0 ? core_.add_frame_position(id, p, noise, reference) : Status::kInvalidArgument;
}

template <int MaxLandmarks>
Status FixedVehicleSlam<MaxLandmarks>::add_framed_landmark(LandmarkId id,
                                                           const LandmarkVector& p_world,
                                                           const LandmarkMatrix& covariance,
                                                           LandmarkId origin, LandmarkId ahead,
                                                           LandmarkId* replaced) {
  std::uint32_t lost = 0;
  FixedCoordinate p[3];
  of_vector(p_world, p, lost);
  const FixedCovariance3 noise = fixed_of(covariance, lost);
  if (lost != 0) return Status::kInvalidArgument;
  return core_.add_framed_landmark(id, p, noise, origin, ahead, replaced);
}

template <int MaxLandmarks>
FixedRigid FixedVehicleSlam<MaxLandmarks>::T_world_camera(
    const Rigid<float>& T_vehicle_camera) const {
  std::uint32_t none = 0;
  const FixedPose pose = core_.mean_pose();
  FixedRigid T_world_vehicle = turn_about(2, pose.heading);
  T_world_vehicle.translation[0] = pose.x;
  T_world_vehicle.translation[1] = pose.y;
  if (tilts()) {
    const FixedTilt tilt = core_.tilt();
    T_world_vehicle = T_world_vehicle.times(turn_about(1, tilt.pitch), none)
                          .times(turn_about(0, tilt.roll), none);
  }
  return T_world_vehicle.times(fixed_rigid_of(T_vehicle_camera, none), none);
}

template <int MaxLandmarks>
Vector2<float> FixedVehicleSlam<MaxLandmarks>::tilt_noise(float dt_s) const {
  if (!tilts()) return Vector2<float>::Zero();
  std::uint32_t lost = 0;
  const FixedCovariance2 noise = core_.tilt_noise(fixed_of<FixedOffset>(dt_s, lost));
  return {float_of(noise.xx), float_of(noise.yy)};
}

}  // namespace cairn

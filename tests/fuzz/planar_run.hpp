#pragma once

#include "cairn/numeric/math.hpp"
#include "cairn/planar/fixed/fixed_vehicle_slam.hpp"
#include "cairn/planar/planar_slam.hpp"

#include "fuzz_input.hpp"

namespace cairn::fuzz {

inline constexpr int kLandmarks = 6;
inline constexpr int kPlanarSteps = 24;

inline PinholeCamera<float> planar_camera() {
  PinholeCamera<float> c;
  c.fx = c.fy = 250.0F;
  c.cx = 159.5F;
  c.cy = 119.5F;
  c.width = 320;
  c.height = 240;
  return c;
}

/// Looks ahead.
inline Rigid<float> planar_mount() {
  return {{0.5F, -0.5F, 0.5F, -0.5F}, {0.1F, 0.0F, 1.0F}};
}

/// Whether a filter takes what cameras do not measure: points, ranges, places in the world.
template <class Filter>
inline constexpr bool kTakesPoints = true;
template <int MaxLandmarks>
inline constexpr bool kTakesPoints<FixedVehicleSlam<MaxLandmarks>> = false;

/// Calls of a planar filter of landmarks with height, with arbitrary values in any order.
template <class Filter>
class PlanarRun {
 public:
  explicit PlanarRun(Input& input) {
    PlanarParameters<float> parameters;
    if (Filter::kTilts && input.flag()) parameters.tilt = TiltParameters<float>::rover();
    parameters.replace_after = input.below(3);
    PROMISE(1,
            ok(filter_.initialise(PlanarPose<float>(), 1e-6F * Matrix3f::Identity(), parameters)));
    for (int i = input.below(kLandmarks); i > 0; --i) {
      const Vector3<float> at(1.0F + static_cast<float>(i), 0.8F * static_cast<float>(i) - 2.0F,
                              0.5F);
      PROMISE(1, ok(filter_.add_landmark(static_cast<LandmarkId>(i), at,
                                         0.01F * Matrix3f::Identity())));
    }
  }

  void step(Input& input) {
    const Before before(filter_);
    const NoAllocation none;
    const Status status = call(input);
    // A gate and a singular covariance leave the estimate alone, too; pixels that disagree may end
    // a rest, whose noise then counts.
    const bool may_end_rest = status == Status::kNoConsensus && same_pose(before.object(), filter_);
    PROMISE(3, ok(status) || may_end_rest || before.unchanged());
    check();
  }

 private:
  using Matrix3f = Matrix3<float>;

  Status call(Input& input) {
    switch (input.below(18)) {
      case 0:
      case 1:
        return predict(input);
      case 2:
        return filter_.add_landmark(id(input), place(input), covariance(input, 1e-4F, 1.0F));
      case 3:
      case 4:
        return pixels(input);
      case 5:
        if constexpr (kTakesPoints<Filter>) return points(input);
        return predict(input);
      case 6:
        if constexpr (kTakesPoints<Filter>) return ranges(input);
        return pixels(input);
      case 7:
        return filter_.update_height(id(input), input.number(-1.0F, 3.0F),
                                     input.number(1e-3F, 0.2F), input.number(1.0F, 11.0F));
      case 8:
        return filter_.add_position(id(input));
      case 9:
        return filter_.remove_landmark(input.below(kLandmarks + 2) - 1);
      case 10:
        return filter_.widen_pose(input.number(0.0F, 1.0F), input.number(0.0F, 0.1F));
      case 11:
        return filter_.slip_laterally(input.number(0.0F, 0.1F));
      case 12:
        return filter_.drift_world(input.number(0.0F, 1e-2F), input.number(0.0F, 1e-3F));
      case 13:
        return filter_.predict_tilt(input.number(0.0F, 1.0F));
      case 14:
        return on_path(input);
      case 15:
        return moved(input);
      case 16:
        return restart(input);
      default:
        return world(input);
    }
  }

  Status restart(Input& input) {
    PlanarPose<float> pose;
    pose.position = Vector2<float>(input.number(-20.0F, 20.0F), input.number(-20.0F, 20.0F));
    pose.heading = input.number(-3.1F, 3.1F);
    PlanarParameters<float> parameters;
    float* const numbers[] = {&parameters.gate,
                              &parameters.reacquire_position_m,
                              &parameters.reacquire_heading_rad,
                              &parameters.reacquire_landmark_m,
                              &parameters.rest_sigmas,
                              &parameters.ransac_threshold,
                              &parameters.rescue_gate,
                              &parameters.tilt.sigma_pitch_rad,
                              &parameters.tilt.sigma_roll_rad,
                              &parameters.tilt.time_constant_s,
                              &parameters.ransac.probability,
                              &parameters.ransac.min_inlier_share};
    constexpr int kNumbers = sizeof numbers / sizeof numbers[0];
    if (Filter::kTilts && input.flag()) parameters.tilt = TiltParameters<float>::car();
    if (input.byte() > 200) *numbers[input.below(kNumbers)] = input.wild();
    if (input.byte() > 200) parameters.reacquire_after = static_cast<int>(input.word());
    if (input.byte() > 200) parameters.ransac.max_hypotheses = static_cast<int>(input.word());
    return filter_.initialise(pose, covariance(input, 0.0F, 0.1F), parameters);
  }

  /// Recognised elsewhere, and perhaps not.
  Status moved(Input& input) {
    PlanarPose<float> pose = filter_.mean_pose();
    pose.position += Vector2<float>(0.01F * input.byte() - 1.28F, 0.01F * input.byte() - 1.28F);
    pose.heading = wrap_angle(pose.heading + 0.01F * input.byte());
    const auto before = filter_.place(pose, 0.01F * input.byte(), 0.001F * input.byte());
    if (input.flag()) filter_.put_back(before);
    static_cast<void>(filter_.recentre());
    return Status::kOk;
  }

  Status on_path(Input& input) {
    Matrix<float, 3, 2> by_path;
    for (int i = 0; i < 6; ++i) by_path(i / 2, i % 2) = input.number(-2.0F, 2.0F);
    return filter_.add_landmark_on_path(id(input), place(input), covariance(input, 1e-4F, 1.0F),
                                        id(input), by_path);
  }

  Status predict(Input& input) {
    const auto model = input.flag() ? IncrementModel::kEuler : IncrementModel::kExactArc;
    if (input.flag()) {
      return filter_.predict(ackermann_increment(
          input.number(-2.0F, 2.0F), input.number(-0.7F, 0.7F), input.number(0.0F, 0.2F),
          input.number(0.2F, 2.0F), input.number(0.0F, 0.3F), input.number(0.0F, 0.2F), model));
    }
    return filter_.predict(twist_increment(input.number(-2.0F, 2.0F), input.number(-1.5F, 1.5F),
                                           input.number(0.0F, 0.2F), input.number(0.0F, 0.3F),
                                           input.number(0.0F, 0.3F), model));
  }

  Status pixels(Input& input) {
    PixelMatch<float> matches[kLandmarks];
    const int count = input.below(kLandmarks + 1);
    const float sigma = input.number(0.01F, 2.0F);
    for (int i = 0; i < count; ++i) {
      PixelMatch<float>& match = matches[i];
      match.slot = input.flag() ? i : input.below(kLandmarks + 2) - 1;
      const bool there = match.slot >= 0 && match.slot < filter_.landmark_count();
      match.id = there && input.byte() < 250 ? filter_.landmark_id(match.slot) : id(input);
      PixelPrediction<float> expected;
      const bool seen = there && ok(filter_.predict_pixel(match.slot, planar_camera(),
                                                          planar_mount(), 0.5F, expected));
      match.pixel = seen ? expected.pixel : Vector2<float>(160.0F, 120.0F);
      match.pixel += Vector2<float>(input.number(-3.0F, 3.0F), input.number(-3.0F, 3.0F));
      match.descriptor_distance = input.byte();
    }
    // What a tracker asks of two matches that agree, and of many.
    OnePointRansacParameters ransac = PlanarParameters<float>().ransac;
    if (input.flag()) {
      ransac.min_inliers = 1 + input.below(4);
      ransac.min_inlier_share = static_cast<float>(input.below(5)) / 4.0F;
    }
    filter_.set_ransac(ransac);
    UpdateReport report;
    return filter_.update_pixels(planar_camera(), planar_mount(), sigma, matches, count, random_,
                                 report);
  }

  Status points(Input& input) {
    PointObservation<float> seen[2];
    for (PointObservation<float>& point : seen) {
      point.id = id(input);
      point.y = place(input).template head<2>();
      point.R = covariance(input, 1e-4F, 0.1F).template topLeftCorner<2, 2>();
    }
    UpdateReport report;
    return filter_.update_points({seen, 1 + input.below(2)}, report);
  }

  Status ranges(Input& input) {
    RangeBearingObservation<float> seen;
    seen.id = id(input);
    seen.range = input.number(0.0F, 10.0F);
    seen.bearing = input.number(-3.2F, 3.2F);
    seen.sigma_range = input.number(1e-3F, 0.3F);
    seen.sigma_bearing = input.number(1e-3F, 0.1F);
    UpdateReport report;
    return filter_.update_range_bearing({&seen, 1}, input.number(-0.5F, 0.5F), report);
  }

  Status world(Input& input) {
    const LandmarkId reference = input.flag() ? id(input) : kNoLandmark;
    const LandmarkId ahead = id(input);
    switch (input.below(4)) {
      case 0:
        if constexpr (kTakesPoints<Filter>) {
          return filter_.add_world_landmark(id(input), place(input), covariance(input, 1e-4F, 0.1F),
                                            reference);
        }
        return Status::kOk;
      case 1:
        return filter_.add_frame_position(id(input), place(input), covariance(input, 1e-4F, 0.1F),
                                          reference);
      case 2:
        return filter_.add_framed_landmark(id(input), place(input), covariance(input, 1e-4F, 0.1F),
                                           reference, ahead);
      default: {
        const Status status = filter_.widen_frame(reference, ahead, input.number(0.0F, 0.1F),
                                                  input.number(0.0F, 0.01F));
        if (ok(status)) static_cast<void>(filter_.framed_pose_covariance(reference, ahead));
        return status;
      }
    }
  }

  static LandmarkId id(Input& input) {
    return static_cast<LandmarkId>(input.below(kLandmarks + 3));
  }
  static Vector3<float> place(Input& input) {
    return {input.number(-2.0F, 8.0F), input.number(-4.0F, 4.0F), input.number(-1.0F, 3.0F)};
  }
  static Matrix3f covariance(Input& input, float low, float high) {
    Matrix3f result = Matrix3f::Zero();
    for (int i = 0; i < 3; ++i) result(i, i) = input.number(low, high);
    if (input.byte() > 240) result(1, 0) = result(0, 1) = input.wild();
    return result;
  }

  static bool same_pose(const Filter& a, const Filter& b) {
    const PlanarPose<float> one = a.mean_pose();
    const PlanarPose<float> other = b.mean_pose();
    return one.position == other.position && one.heading == other.heading;
  }

  void check() const {
    const PlanarPose<float> pose = filter_.pose();
    PROMISE(4, pose.position.allFinite() && is_finite(pose.heading));
    check_covariance(filter_.pose_covariance());
    check_covariance(filter_.own_pose_covariance());
    const Matrix2<float> tilt = filter_.tilt_covariance();
    PROMISE(4, tilt.allFinite() && is_finite(filter_.tilt().pitch));
    PROMISE(5, tilt(0, 0) >= 0.0F && tilt(1, 1) >= 0.0F);
    PROMISE(6, filter_.landmark_count() <= kLandmarks);
    for (int slot = 0; slot < filter_.landmark_count(); ++slot) {
      PROMISE(4, filter_.landmark_position(slot).allFinite());
      check_covariance(filter_.landmark_covariance(slot));
      PROMISE(4, filter_.relative_landmark_covariance(slot).allFinite());
    }
  }
  static void check_covariance(const Matrix3f& covariance) {
    PROMISE(4, covariance.allFinite());
    for (int i = 0; i < 3; ++i) PROMISE(5, covariance(i, i) >= 0.0F);
  }

  Filter filter_;
  Random random_{1};
};

}  // namespace cairn::fuzz

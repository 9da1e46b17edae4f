#pragma once

#include "cairn/planar/fixed/fixed_group_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"

// A frame of a vehicle whose body tilts, for the filter without floating point and for its like in
// float: odometry, tilt, the windows of all landmarks, the consensus and its update.

namespace cairn::planar_test {

inline constexpr int kPixelMapLandmarks = 20;

/// What the pixels of a frame are beside their windows' middles.
struct PixelPattern {
  int seen = 0;         ///< matches
  int every_other = 0;  ///< one in so many is off, each elsewhere; 1: all

  bool off(int k) const { return k % every_other == every_other - 1; }
  /// Axis i of match k, in hundredths of a pixel.
  int offset(int k, int i) const {
    const int small = ((7 * k + 3 * i) % 5 - 2) * 10;
    if (!off(k)) return small;
    const int far = 1000 * (1 + k / 2) + 300 * i;
    return small + (k % 2 == 0 ? far : -far);
  }
};

template <class Filter>
struct PixelCycles;

template <>
struct PixelCycles<FixedGroupSlam<kPixelMapLandmarks, 3>> {
  FixedGroupSlam<kPixelMapLandmarks, 3> filter;
  FixedCamera camera;
  FixedMount mount;
  FixedIncrement increment;
  FixedPixelMatch matches[kPixelMapLandmarks];
  FixedVector<FixedPlannedPixel, kPixelMapLandmarks> plan;
  Random random;
  int hypotheses = 0;

  bool start(int landmarks) {
    camera.width = 320;
    camera.height = 240;
    camera.fx = camera.fy = kFocal;
    camera.cx = kMiddle[0];
    camera.cy = kMiddle[1];
    mount.w = mount.y = kHalf;
    mount.x = mount.z = -kHalf;
    mount.origin[2] = kHeight;
    FixedPlanarParameters parameters;
    parameters.gate = FixedScore::most();
    parameters.tilt.sigma_pitch = parameters.tilt.sigma_roll = kTilt;
    FixedPoseCovariance covariance;
    covariance.position = {kVariance, {}, kVariance};
    covariance.heading = kVariance;
    bool good = ok(filter.initialise({}, covariance, parameters));
    for (int i = 0; i < landmarks; ++i) {
      const FixedLength y[3] = {FixedLength::from_raw(kX.raw() + kXStep.raw() * (i % 7)),
                                FixedLength::from_raw(kY.raw() + kYStep.raw() * (i % 11)),
                                FixedLength::from_raw(kZStep.raw() * (i % 5))};
      const FixedCovariance3 noise = {kNoise, {}, kNoise, {}, {}, kNoise};
      good = good && ok(filter.add_landmark(static_cast<LandmarkId>(i + 1), y, noise));
    }
    increment.distance = kStep;
    increment.turn = kTurn;
    increment.distance_variance = kStepVariance;
    increment.turn_variance = kTurnVariance;
    return good;
  }
  bool predict() { return ok(filter.predict(increment)); }
  bool predict_tilt() { return ok(filter.predict_tilt(kTime)); }
  bool windows(const PixelPattern& pattern) {
    if (!ok(filter.plan_pixels(camera, mount, kSigma, plan))) return false;
    if (plan.size() != filter.landmark_count()) return false;
    for (const FixedPlannedPixel& planned : plan) {
      const FixedPixelPrediction& window = planned.prediction;
      const int slot = window.slot;
      if (slot >= pattern.seen) continue;
      matches[slot].id = filter.landmark_id(slot);
      for (int i = 0; i < 2; ++i) {
        const int offset = pattern.offset(slot, i) * kHundredth;
        matches[slot].pixel[i] = FixedPixel::from_raw(window.pixel[i].raw() + offset);
      }
    }
    return true;
  }
  Status update(const PixelPattern& pattern) {
    FixedUpdateReport report;
    const Status status =
        filter.update_pixels(camera, mount, kSigma, matches, pattern.seen, random, report);
    hypotheses = report.hypotheses;
    return status;
  }

 private:
  static constexpr FixedPixel kFocal = FixedPixel::nearest(200.0);
  static constexpr FixedPixel kMiddle[2] = {FixedPixel::nearest(160.0), FixedPixel::nearest(120.0)};
  static constexpr FixedPixel kSigma = FixedPixel::nearest(0.5);
  static constexpr int kHundredth = (1 << FixedPixel::kFractionBits) / 100;
  static constexpr FixedRatio kHalf = FixedRatio::nearest(0.5);
  static constexpr FixedLength kHeight = FixedLength::nearest(1.0);
  static constexpr FixedLength kX = FixedLength::nearest(3.0);
  static constexpr FixedLength kXStep = FixedLength::nearest(0.1);
  static constexpr FixedLength kY = FixedLength::nearest(-2.0);
  static constexpr FixedLength kYStep = FixedLength::nearest(0.4);
  static constexpr FixedLength kZStep = FixedLength::nearest(0.3);
  static constexpr FixedOffset kStep = FixedOffset::nearest(0.002);
  static constexpr FixedOffset kTime = FixedOffset::nearest(0.1);
  static constexpr FixedAngle kTurn = FixedAngle::nearest(4e-5);
  static constexpr FixedAngle kTilt = FixedAngle::nearest(0.01);
  static constexpr FixedVariance kVariance = FixedVariance::nearest(0.01);
  static constexpr FixedVariance kNoise = FixedVariance::nearest(1e-4);
  static constexpr FixedVariance kStepVariance = FixedVariance::nearest(2.5e-5);
  static constexpr FixedVariance kTurnVariance = FixedVariance::nearest(1.45e-8);
};

template <>
struct PixelCycles<GroupIekfSlam<float, kPixelMapLandmarks, 3>> {
  GroupIekfSlam<float, kPixelMapLandmarks, 3> filter;
  PinholeCamera<float> camera{200.0F, 200.0F, 160.0F, 120.0F, 0, 0, 0, 0, 0, 320, 240};
  Rigid<float> T_vehicle_camera{{0.5F, -0.5F, 0.5F, -0.5F}, {0.0F, 0.0F, 1.0F}};
  PlanarIncrement<float> increment;
  PixelMatch<float> matches[kPixelMapLandmarks];
  Random random;
  int hypotheses = 0;

  bool start(int landmarks) {
    PlanarParameters<float> parameters;
    parameters.gate = 1e6F;
    parameters.tilt.sigma_pitch_rad = parameters.tilt.sigma_roll_rad = 0.01F;
    bool good = ok(filter.initialise({}, Matrix3<float>::Identity() * 0.01F, parameters));
    for (int i = 0; i < landmarks; ++i) {
      const Vector3<float> y(3.0F + 0.1F * static_cast<float>(i % 7),
                             -2.0F + 0.4F * static_cast<float>(i % 11),
                             0.3F * static_cast<float>(i % 5));
      good = good && ok(filter.add_landmark(static_cast<LandmarkId>(i + 1), y,
                                            Matrix3<float>::Identity() * 1e-4F));
    }
    increment.distance_m = 0.002F;
    increment.turn_rad = 4e-5F;
    increment.covariance << 2.5e-5F, 0.0F, 0.0F, 1.45e-8F;
    return good;
  }
  bool predict() { return ok(filter.predict(increment)); }
  bool predict_tilt() { return ok(filter.predict_tilt(0.1F)); }
  bool windows(const PixelPattern& pattern) {
    const int count = filter.landmark_count();
    for (int slot = 0; slot < count; ++slot) {
      PixelPrediction<float> window;
      if (!ok(filter.predict_pixel(slot, camera, T_vehicle_camera, 0.5F, window))) return false;
      if (slot >= pattern.seen) continue;
      matches[slot].id = filter.landmark_id(slot);
      matches[slot].slot = slot;
      for (int i = 0; i < 2; ++i) {
        matches[slot].pixel(i) =
            window.pixel(i) + 0.01F * static_cast<float>(pattern.offset(slot, i));
      }
    }
    return true;
  }
  Status update(const PixelPattern& pattern) {
    UpdateReport report;
    const Status status =
        filter.update_pixels(camera, T_vehicle_camera, 0.5F, matches, pattern.seen, random, report);
    hypotheses = report.hypotheses;
    return status;
  }
};

}  // namespace cairn::planar_test

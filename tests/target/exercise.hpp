#pragma once

#include <cstdint>

#include "cairn/base/hash.hpp"
#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/pose_ransac.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/numeric/random.hpp"
#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/fixed/fixed_group_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/vision/fast.hpp"
#include "cairn/vision/freak.hpp"
#include "cairn/vision/hamming.hpp"

/// The modules of the core one by one on made-up input, each reduced to one hash: where two targets
/// differ, this says in which module. Everything lies in the object; the caller places it.
namespace cairn_test {

class Exercise {
 public:
  static constexpr int kStages = 8;

  struct Stage {
    const char* name;
    std::uint64_t (Exercise::*run)();
  };
  static const Stage* stages();

 private:
  static constexpr int kWidth = 320;
  static constexpr int kHeight = 240;
  static constexpr int kMaxCorners = 256;
  static constexpr int kLandmarks = 16;

  std::uint64_t elementary_functions();
  std::uint64_t camera_model();
  std::uint64_t corners();
  std::uint64_t descriptors();
  std::uint64_t pose();
  std::uint64_t planar_ekf();
  std::uint64_t planar_group();
  std::uint64_t planar_fixed();

  void draw_image();
  template <class Filter>
  std::uint64_t drive(Filter& filter);

  std::uint8_t pixels_[kWidth * kHeight];
  cairn::FastScratch<kWidth> scratch_;
  cairn::Corner corners_[kMaxCorners];
  cairn::Descriptor descriptors_[kMaxCorners];
  cairn::PoseObservation<float> observations_[64];
  cairn::EkfSlam<float, kLandmarks> ekf_;
  cairn::GroupIekfSlam<float, kLandmarks> group_;
  cairn::FixedGroupSlam<kLandmarks> fixed_;
};

inline const Exercise::Stage* Exercise::stages() {
  static constexpr Stage list[kStages] = {
      {"elementary_functions", &Exercise::elementary_functions},
      {"camera_model", &Exercise::camera_model},
      {"corners", &Exercise::corners},
      {"descriptors", &Exercise::descriptors},
      {"pose", &Exercise::pose},
      {"planar_ekf", &Exercise::planar_ekf},
      {"planar_group", &Exercise::planar_group},
      {"planar_fixed", &Exercise::planar_fixed},
  };
  return list;
}

/// Uniform in [low, high) with 24 random bits, the same on every target. Never twice among the
/// arguments of one call: their order of evaluation is the compiler's (in braces it is fixed).
inline float uniform(cairn::Random& random, float low, float high) {
  return low + (high - low) * (static_cast<float>(random.next() >> 8U) * 5.9604644775390625e-8F);
}

inline float sine_of(float angle) {
  float sine = 0.0F;
  float cosine = 0.0F;
  cairn::sin_cos(angle, sine, cosine);
  return sine;
}

inline float cosine_of(float angle) {
  return sine_of(angle + cairn::kHalfPi<float>);
}

inline std::uint64_t Exercise::elementary_functions() {
  cairn::Random random(1);
  cairn::Hash64 hash;
  for (int i = 0; i < 20000; ++i) {
    float sine = 0.0F;
    float cosine = 0.0F;
    cairn::sin_cos(uniform(random, -100.0F, 100.0F), sine, cosine);
    hash.add(sine);
    hash.add(cosine);
    const float y = uniform(random, -3.0F, 3.0F);
    const float x = uniform(random, -3.0F, 3.0F);
    hash.add(cairn::atan2(y, x));
    hash.add(cairn::exp(uniform(random, -90.0F, 90.0F)));
    hash.add(cairn::log(uniform(random, 1e-6F, 1e6F)));
    hash.add(cairn::wrap_angle(uniform(random, -1e3F, 1e3F)));
    hash.add(cairn::sqrt(uniform(random, 0.0F, 1e9F)));
    hash.add(cairn::round_to_int(uniform(random, -1e10F, 1e10F)));
  }
  return hash.value();
}

inline cairn::PinholeCamera<float> exercise_camera() {
  return {260.0F, 261.0F, 159.5F, 119.5F, -0.25F, 0.08F, 1e-3F, -5e-4F, -0.01F, 320, 240};
}

inline std::uint64_t Exercise::camera_model() {
  cairn::PinholeCamera<float> rational = exercise_camera();
  rational.k4 = 0.3F;
  rational.k5 = -0.1F;
  rational.k6 = 0.02F;
  cairn::PinholeCamera<float> fisheye{260.0F, 261.0F, 159.5F, 119.5F, -0.02F, 0.01F,
                                      0.0F,   0.0F,   -4e-3F, 320,    240};
  fisheye.k4 = 1e-3F;
  fisheye.lens = cairn::Lens::kFisheye;
  const cairn::PinholeCamera<float> cameras[] = {exercise_camera(), rational, fisheye};
  cairn::Random random(2);
  cairn::Hash64 hash;
  for (int i = 0; i < 6000; ++i) {
    const cairn::PinholeCamera<float>& camera = cameras[i % 3];
    const cairn::Vector3<float> p{uniform(random, -3.0F, 3.0F), uniform(random, -3.0F, 3.0F),
                                  uniform(random, -1.0F, 8.0F)};
    cairn::Vector2<float> pixel = cairn::Vector2<float>::Zero();
    cairn::Matrix<float, 2, 3> jacobian = cairn::Matrix<float, 2, 3>::Zero();
    hash.add(static_cast<std::uint8_t>(camera.project(p, pixel, jacobian)));
    for (int k = 0; k < 2; ++k) hash.add(pixel(k));
    for (int k = 0; k < 6; ++k) hash.add(jacobian(k % 2, k / 2));
    const cairn::Vector3<float> ray =
        camera.unproject({uniform(random, 0.0F, 319.0F), uniform(random, 0.0F, 239.0F)});
    for (int k = 0; k < 3; ++k) hash.add(ray(k));
  }
  return hash.value();
}

/// Blocks of random grey with fine noise: corners of every strength.
inline void Exercise::draw_image() {
  cairn::Random random(3);
  for (int by = 0; by < kHeight; by += 12) {
    for (int bx = 0; bx < kWidth; bx += 16) {
      const int grey = 20 + random.below(200);
      for (int y = by; y < by + 12; ++y) {
        for (int x = bx; x < bx + 16; ++x) {
          pixels_[y * kWidth + x] = static_cast<std::uint8_t>(grey + random.below(9));
        }
      }
    }
  }
}

inline std::uint64_t Exercise::corners() {
  draw_image();
  cairn::Hash64 hash;
  const cairn::ImageView image{pixels_, kWidth, kHeight, kWidth};
  const cairn::Rect rects[] = {{0, 0, kWidth, kHeight}, {37, 41, 133, 92}, {300, 200, 320, 240}};
  for (const cairn::Rect& rect : rects) {
    for (const int threshold : {10, 20, 60}) {
      cairn::FastReport report;
      hash.add(static_cast<std::uint8_t>(
          cairn::detect_fast(image, rect, threshold, scratch_, corners_, kMaxCorners, report)));
      hash.add(report.found);
      for (int i = 0; i < report.found - report.dropped; ++i) {
        hash.add(static_cast<std::int32_t>(corners_[i].x));
        hash.add(static_cast<std::int32_t>(corners_[i].y));
        hash.add(corners_[i].score);
      }
    }
  }
  return hash.value();
}

inline std::uint64_t Exercise::descriptors() {
  draw_image();
  const cairn::ImageView image{pixels_, kWidth, kHeight, kWidth};
  cairn::FastReport report;
  cairn::Hash64 hash;
  hash.add(static_cast<std::uint8_t>(cairn::detect_fast(image, {0, 0, kWidth, kHeight}, 20,
                                                        scratch_, corners_, kMaxCorners, report)));
  const int count = report.found - report.dropped;
  int described = 0;
  for (int i = 0; i < count; ++i) {
    std::uint8_t bin = 0;
    if (!ok(cairn::describe_freak(image, corners_[i].x, corners_[i].y, descriptors_[described],
                                  bin))) {
      continue;
    }
    hash.add(bin);
    hash.add_bytes(descriptors_[described].bytes, cairn::Descriptor::kBytes);
    ++described;
  }
  hash.add(described);
  cairn::Random random(4);
  for (int i = 0; i < 32 && described > 0; ++i) {
    cairn::Descriptor query = descriptors_[random.below(described)];
    query.bytes[random.below(cairn::Descriptor::kBytes)] ^= 0x5AU;
    const cairn::HammingMatch match = cairn::match_hamming(query, {descriptors_, described});
    hash.add(match.index);
    hash.add(match.distance);
    hash.add(match.second_distance);
  }
  return hash.value();
}

inline std::uint64_t Exercise::pose() {
  const cairn::PinholeCamera<float> camera = exercise_camera();
  cairn::Random random(5);
  cairn::Rigid<float> T_camera_world;
  T_camera_world.rotation = cairn::rotation_exp<float>({0.1F, -0.2F, 0.15F});
  T_camera_world.translation = {0.2F, -0.1F, 0.5F};
  int count = 0;
  for (int i = 0; i < 64; ++i) {
    cairn::PoseObservation<float>& seen = observations_[count];
    seen = cairn::PoseObservation<float>{};
    seen.p_world = {uniform(random, -2.0F, 2.0F), uniform(random, -1.5F, 1.5F),
                    uniform(random, 2.0F, 6.0F)};
    if (!ok(camera.project(T_camera_world * seen.p_world, seen.pixel))) continue;
    seen.pixel.x() += uniform(random, -1.0F, 1.0F);
    seen.pixel.y() += uniform(random, -1.0F, 1.0F);
    if (i % 4 == 0) seen.pixel.x() = uniform(random, 0.0F, 319.0F);
    ++count;
  }
  cairn::Rigid<float> estimate_pose;
  cairn::PoseEstimate<float> estimate;
  cairn::PoseRansacReport<float> report;
  cairn::Hash64 hash;
  hash.add(static_cast<std::uint8_t>(
      cairn::estimate_pose_ransac(camera, observations_, count, cairn::PoseRansacOptions<float>{},
                                  random, estimate_pose, estimate, report)));
  for (int k = 0; k < 4; ++k) hash.add(estimate_pose.rotation.coeffs()(k));
  for (int k = 0; k < 3; ++k) hash.add(estimate_pose.translation(k));
  for (int k = 0; k < 36; ++k) hash.add(estimate.covariance(k / 6, k % 6));
  hash.add(estimate.inliers);
  hash.add(report.hypotheses);
  return hash.value();
}

/// Two loops among landmarks on a circle, some of them seen wrongly.
template <class Filter>
std::uint64_t Exercise::drive(Filter& filter) {
  cairn::Random random(6);
  cairn::Hash64 hash;
  cairn::Matrix3<float> covariance = cairn::Matrix3<float>::Identity();
  covariance(2, 2) = 0.03F;
  hash.add(static_cast<std::uint8_t>(filter.initialise(cairn::PlanarPose<float>{}, covariance)));
  const float dt = 0.1F;
  const float speed = 0.8F;
  const float rate = 0.2F;
  float x = 0.0F;
  float y = 0.0F;
  float heading = 0.0F;
  for (int step = 0; step < 600; ++step) {
    x += speed * dt * cosine_of(heading);
    y += speed * dt * sine_of(heading);
    heading = cairn::wrap_angle(heading + rate * dt);
    const float measured_speed = speed + uniform(random, -0.1F, 0.1F);
    const float measured_rate = rate + uniform(random, -0.02F, 0.02F);
    const auto increment =
        cairn::twist_increment<float>(measured_speed, measured_rate, dt, 0.1F, 0.02F);
    hash.add(static_cast<std::uint8_t>(filter.predict(increment)));
    if (step % 5 != 0) continue;

    cairn::FixedVector<cairn::PointObservation<float>, kLandmarks> seen;
    for (int i = 0; i < kLandmarks; ++i) {
      const float angle = 0.39269908F * static_cast<float>(i);
      const float east = 7.0F * cosine_of(angle) - x;
      const float north = 4.0F + 7.0F * sine_of(angle) - y;
      cairn::PointObservation<float> point;
      point.id = static_cast<cairn::LandmarkId>(i + 1);
      point.y.x() = cosine_of(heading) * east + sine_of(heading) * north;
      point.y.y() = -sine_of(heading) * east + cosine_of(heading) * north;
      if (point.y.x() < 0.2F || point.y.squaredNorm() > 64.0F) continue;
      point.y.x() += uniform(random, -0.05F, 0.05F);
      point.y.y() += uniform(random, -0.05F, 0.05F);
      if (random.below(20) == 0) point.y.y() += 2.0F;
      point.R = 0.01F * cairn::Matrix2<float>::Identity();
      if (filter.find(point.id) < 0) {
        hash.add(static_cast<std::uint8_t>(filter.add_landmark(point.id, point.y, point.R)));
      } else {
        seen.push_back(point);
      }
    }
    cairn::UpdateReport report;
    hash.add(static_cast<std::uint8_t>(filter.update_points(seen, report)));
    hash.add(report.gated);
    filter.hash(hash);
    const cairn::Matrix3<float> P = filter.pose_covariance();
    for (int k = 0; k < 9; ++k) hash.add(P(k / 3, k % 3));
  }
  return hash.value();
}

inline std::uint64_t Exercise::planar_ekf() {
  return drive(ekf_);
}

inline std::uint64_t Exercise::planar_group() {
  return drive(group_);
}

/// A circle of 16 landmarks, without floating point; sightings are off by up to 0.06 m.
inline std::uint64_t Exercise::planar_fixed() {
  cairn::Hash64 hash;
  cairn::Random random(9);
  const auto noise = [&random](int bits) { return random.below(1 << bits) - (1 << (bits - 1)); };
  cairn::FixedPoseCovariance covariance;
  covariance.heading = cairn::FixedVariance::from_raw(std::int64_t{1} << 34);
  hash.add(static_cast<std::uint8_t>(fixed_.initialise({}, covariance)));
  const auto variance = cairn::FixedVariance::from_raw(std::int64_t{1} << 36);
  cairn::FixedIncrement step;
  step.distance_variance = cairn::FixedVariance::from_raw(std::int64_t{1} << 30);
  step.turn_variance = cairn::FixedVariance::from_raw(std::int64_t{1} << 27);
  step.model = cairn::IncrementModel::kExactArc;
  for (int k = 0; k < 200; ++k) {
    step.distance = cairn::FixedOffset::from_raw((1 << 21) + noise(16));
    step.turn = cairn::FixedAngle::from_raw((1 << 23) + noise(18));
    hash.add(static_cast<std::uint8_t>(fixed_.predict(step)));
    const auto id = static_cast<cairn::LandmarkId>(k % kLandmarks + 1);
    // Where it stands from the true pose: on a circle of 6 m about the vehicle's own of 4 m.
    cairn::FixedRatio sine;
    cairn::FixedRatio cosine;
    const std::int64_t bearing = (std::int64_t{k % kLandmarks} << 27) - (std::int64_t{k + 1} << 23);
    cairn::sin_cos(cairn::wrapped_angle(bearing), sine, cosine);
    cairn::FixedPointObservation seen;
    seen.id = id;
    seen.x = cairn::FixedLength::from_raw((sine.raw() >> 10) * 6 + noise(17));
    seen.y = cairn::FixedLength::from_raw((4 << 20) - (cosine.raw() >> 10) * 6 + noise(17));
    seen.noise = {variance, {}, variance};
    cairn::FixedUpdateReport report;
    hash.add(static_cast<std::uint8_t>(fixed_.find(id) < 0
                                           ? fixed_.add_landmark(id, seen.x, seen.y, seen.noise)
                                           : fixed_.update_points({&seen, 1}, report)));
    fixed_.hash(hash);
  }
  return hash.value();
}

}  // namespace cairn_test

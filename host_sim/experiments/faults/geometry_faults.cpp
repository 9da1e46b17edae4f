#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include <Eigen/LU>
#include <fmt/format.h>

#include "cairn/geometry/pose_ransac.hpp"
#include "cairn/numeric/positive_definite.hpp"
#include "cairn/planar/group_iekf_slam.hpp"

#include "host_sim/experiments/faults/fault_classes.hpp"
#include "host_sim/experiments/faults/fault_scene.hpp"
#include "host_sim/trackers/state_hash.hpp"
#include "host_sim/world/gaussian.hpp"

namespace cairn::host {
namespace {

using Filter = GroupIekfSlam<float, 8, 3>;

PinholeCamera<float> some_camera() {
  PinholeCamera<float> camera;
  camera.fx = camera.fy = 250.0F;
  camera.cx = 159.5F;
  camera.cy = 119.5F;
  camera.width = 320;
  camera.height = 240;
  return camera;
}

double angle_between(const Quaternion<float>& a, const Quaternion<float>& b) {
  return static_cast<double>(rotation_log(Quaternion<float>(a.conjugate() * b)).norm());
}

constexpr double kFlip_rad = 0.3;

/// Squared Mahalanobis distance of the rotation, 3 degrees of freedom.
double rotation_nees(const Rigid<float>& pose, const Rigid<float>& truth,
                     const PoseEstimate<float>& estimate) {
  const Vector3<float> error =
      rotation_log(Quaternion<float>(pose.rotation.conjugate() * truth.rotation));
  const Matrix3<float> covariance = estimate.covariance.bottomRightCorner<3, 3>();
  return static_cast<double>(error.dot(covariance.inverse() * error));
}

/// One of many draws of a small plane seen from afar, whose tilt is nearly ambiguous.
struct PlaneDraw {
  Rigid<float> T_world_camera;
  std::vector<PoseObservation<float>> observations;
};

PlaneDraw draw_plane(GaussianRandom& random, double noise_px) {
  constexpr int kSide = 5;
  constexpr int kMiddle = kSide / 2;
  PlaneDraw draw;
  const double about_x = random.normal(0.3);
  const double about_y = random.normal(0.3);
  const Vector3<float> tilt(static_cast<float>(about_x), static_cast<float>(about_y), 0.0F);
  const Quaternion<float> rotation = rotation_exp(tilt);
  draw.T_world_camera = {rotation, rotation * Vector3<float>(0.0F, 0.0F, -3.0F)};
  const PinholeCamera<float> camera = some_camera();
  for (int i = 0; i < kSide * kSide; ++i) {
    PoseObservation<float> seen;
    const float step = 0.08F;
    const int column = i % kSide - kMiddle, row = i / kSide - kMiddle;
    seen.p_world =
        Vector3<float>(step * static_cast<float>(column), step * static_cast<float>(row), 0.0F);
    if (!ok(camera.project(draw.T_world_camera.inverse() * seen.p_world, seen.pixel))) continue;
    seen.pixel.x() += static_cast<float>(random.normal(noise_px));
    seen.pixel.y() += static_cast<float>(random.normal(noise_px));
    draw.observations.push_back(seen);
  }
  return draw;
}

/// A call that must be refused and leave the filter as it is.
FaultOutcome refused(Filter& filter, const char* what, Status expected,
                     const std::function<Status(Filter&)>& call) {
  FaultJudge judge(FaultComponent::kCalls, FaultMode::kGarbage, what,
                   fmt::format("{}, the state unchanged", cairn::to_string(expected)));
  const std::uint64_t before = hash_of_state(filter);
  const Status status = call(filter);
  judge.saw(cairn::to_string(status));
  judge.expect(status == expected, "another status");
  return judge.expect(hash_of_state(filter) == before, "changed").outcome();
}

/// Updates that leave nothing uncertain and contradict one another.
FaultOutcome very_sure_pixels(Filter& filter, const Rigid<float>& mount) {
  constexpr int kSeen = 5;
  FaultJudge judge(FaultComponent::kCalls, FaultMode::kGarbage,
                   "1000 updates by five pixels of sigma 1e-4 px that are off by up to 0.2 px",
                   "positive definite after each; repairs counted");
  for (LandmarkId id = 2; id <= kSeen; ++id) {
    const auto side = static_cast<float>(id) - 3.0F;
    static_cast<void>(filter.add_landmark(id, Vector3<float>(3.0F + side, 0.4F * side, 1.2F),
                                          1e-3F * Matrix3<float>::Identity()));
  }
  const std::uint32_t updates = filter.update_count();
  Random random(2);
  int bad = 0;
  for (int i = 0; i < 1000; ++i) {
    PixelMatch<float> matches[kSeen];
    int count = 0;
    for (int slot = 0; slot < filter.landmark_count(); ++slot) {
      PixelPrediction<float> expected;
      if (!ok(filter.predict_pixel(slot, some_camera(), mount, 1e-4F, expected))) continue;
      matches[count].id = filter.landmark_id(slot);
      matches[count].slot = slot;
      matches[count].pixel = expected.pixel;
      matches[count].pixel.x() += 0.1F * static_cast<float>((i + slot) % 5 - 2);
      ++count;
    }
    UpdateReport report;
    static_cast<void>(
        filter.update_pixels(some_camera(), mount, 1e-4F, matches, count, random, report));
    const Matrix3<float> covariance = filter.pose_covariance();
    if (!covariance.allFinite() || !positive_definite(covariance)) ++bad;
  }
  judge.saw(fmt::format("{} updates used something; not positive definite after {}",
                        filter.update_count() - updates, bad));
  judge.counted(grown_counters(Health(), filter.health()));
  return judge.expect(bad == 0, "not positive definite").outcome();
}

template <class T>
std::vector<T> edges() {
  using Limits = std::numeric_limits<T>;
  std::vector<T> values = {T(0),
                           T(1),
                           T(0.5),
                           T(0.05),
                           kPi<T>,
                           kHalfPi<T>,
                           T(1e4),
                           T(1e9),
                           Limits::min(),
                           Limits::denorm_min(),
                           Limits::max(),
                           Limits::epsilon(),
                           Limits::infinity()};
  const std::size_t count = values.size();
  for (std::size_t i = 0; i < count; ++i) {
    values.push_back(-values[i]);
    values.push_back(std::nextafter(values[i], T(10)));
    values.push_back(std::nextafter(values[i], T(-10)));
  }
  values.push_back(Limits::quiet_NaN());
  return values;
}

/// Calls the elementary functions and the camera at every edge and pair of edges. Number of answers
/// that are not finite although the status, or the domain, says that they are.
template <class T>
int not_finite_at_edges(int& calls) {
  int bad = 0;
  const auto count = [&](bool finite) {
    ++calls;
    if (!finite) ++bad;
  };
  const PinholeCamera<float> single = some_camera();
  PinholeCamera<T> camera;
  camera.fx = camera.fy = static_cast<T>(single.fx);
  camera.cx = static_cast<T>(single.cx);
  camera.cy = static_cast<T>(single.cy);
  camera.width = single.width;
  camera.height = single.height;
  camera.k1 = T(-0.2);
  for (const T a : edges<T>()) {
    T sine, cosine;
    sin_cos(a, sine, cosine);
    count(is_finite(sine) && is_finite(cosine));
    if (abs(a) <= T(1e4)) count(abs(wrap_angle(a)) <= kPi<T> + T(1e-3));
    if (is_finite(a)) count(is_finite(exp(a)) && is_finite(log(a)));
    for (const T b : edges<T>()) {
      if (is_finite(a) && is_finite(b)) count(is_finite(atan2(a, b)));
      for (const T z : {T(0), T(-1), T(0.05), T(1), std::numeric_limits<T>::max()}) {
        Vector2<T> pixel;
        const Status status = camera.project(Vector3<T>(a, b, z), pixel);
        if (ok(status) && is_finite(a) && is_finite(b)) count(pixel.allFinite());
      }
      Vector3<T> ray;
      if (ok(camera.unproject(Vector2<T>(a, b), ray))) count(ray.allFinite());
    }
  }
  return bad;
}

}  // namespace

FaultOutcomes inject_planar_ambiguity(const FaultScene& scene) {
  const int draws = scene.settings().brief ? 300 : 3000;
  FaultJudge judge(FaultComponent::kCalls, FaultMode::kWrong,
                   fmt::format("{} views of a plane of 25 px, noise 0.5 px", draws),
                   "a pose whose tilt is flipped is called ambiguous, or as uncertain as that");
  GaussianRandom random(scene.settings().seed);
  Random samples(scene.settings().seed);
  int flipped = 0, silent = 0, called = 0, refusals = 0;
  for (int i = 0; i < draws; ++i) {
    const PlaneDraw draw = draw_plane(random, 0.5);
    PoseRansacOptions<float> options;
    Rigid<float> pose;
    PoseEstimate<float> estimate;
    PoseRansacReport<float> report;
    const Status status = estimate_pose_ransac(some_camera(), draw.observations.data(),
                                               static_cast<int>(draw.observations.size()), options,
                                               samples, pose, estimate, report);
    if (!ok(status)) {
      ++refusals;
      continue;
    }
    if (report.ambiguous) ++called;
    if (angle_between(pose.rotation, draw.T_world_camera.rotation) < kFlip_rad) continue;
    ++flipped;
    if (!report.ambiguous &&
        rotation_nees(pose, draw.T_world_camera, estimate) > kOutside9999Dof3) {
      ++silent;
    }
  }
  judge.saw(fmt::format(
      "{} refused, {} called ambiguous, {} off by more than 17 deg, {} of these not called so and "
      "outside their own 99.99 %",
      refusals, called, flipped, silent));
  return {judge.expect(silent == 0, "flipped without a word").outcome()};
}

FaultOutcomes inject_singular_innovation(const FaultScene& /*scene*/) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const auto filter = std::make_unique<Filter>();
  static_cast<void>(filter->initialise(PlanarPose<float>(), 1e-6F * Matrix3<float>::Identity()));
  static_cast<void>(filter->add_landmark(1, Vector3<float>(3.0F, 0.2F, 1.0F),
                                         1e-6F * Matrix3<float>::Identity()));
  const Rigid<float> mount{{0.5F, -0.5F, 0.5F, -0.5F}, {0.0F, 0.0F, 1.0F}};
  PixelMatch<float> match;
  match.id = 1;
  match.slot = 0;
  match.pixel = Vector2<float>(140.0F, 119.0F);
  Random random(1);
  UpdateReport report;
  const auto pixels = [&](float sigma, const PixelMatch<float>& used) {
    return [&, sigma, used](Filter& f) {
      PixelMatch<float> matches[1] = {used};
      return f.update_pixels(some_camera(), mount, sigma, matches, 1, random, report);
    };
  };
  PixelMatch<float> not_a_number = match;
  not_a_number.pixel.x() = kNan;
  PointObservation<float> flat;
  flat.id = 1;
  flat.y = Vector2<float>(3.0F, 0.2F);
  flat.R.setZero();
  FaultOutcomes outcomes = {
      refused(*filter, "a pixel with sigma 0", Status::kInvalidArgument, pixels(0.0F, match)),
      refused(*filter, "a pixel that is NaN", Status::kNonFiniteInput, pixels(0.5F, not_a_number)),
      refused(*filter, "a height with sigma 0", Status::kInvalidArgument,
              [](Filter& f) { return f.update_height(1, 1.0F, 0.0F, 6.6F); }),
      refused(*filter, "a landmark without covariance", Status::kInvalidArgument,
              [](Filter& f) {
                return f.add_landmark(2, Vector3<float>(2.0F, 0.0F, 1.0F), Matrix3<float>::Zero());
              }),
      refused(*filter, "a landmark with an indefinite covariance", Status::kInvalidArgument,
              [](Filter& f) {
                return f.add_landmark(2, Vector3<float>(2.0F, 0.0F, 1.0F),
                                      -Matrix3<float>::Identity());
              })};
  outcomes.push_back(very_sure_pixels(*filter, mount));
  return outcomes;
}

FaultOutcomes inject_domain_edges(const FaultScene& /*scene*/) {
  FaultJudge judge(FaultComponent::kCalls, FaultMode::kGarbage,
                   "0, 1, limits, neighbours, NaN into the elementary functions and the camera",
                   "finite, or refused");
  int calls = 0;
  const int bad = not_finite_at_edges<float>(calls) + not_finite_at_edges<double>(calls);
  judge.saw(fmt::format("{} calls, {} not finite", calls, bad));
  return {judge.expect(bad == 0, "not finite").outcome()};
}

}  // namespace cairn::host

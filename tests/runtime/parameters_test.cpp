#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/runtime/handheld_tracker.hpp"
#include "cairn/runtime/vehicle_tracker.hpp"
#include "cairn/runtime/window_tracker.hpp"

#include "plane_scene.hpp"

namespace cairn {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

template <class Tracker>
std::uint64_t hash_of(const Tracker& tracker) {
  Hash64 hash;
  tracker.hash(hash);
  return hash.value();
}

/// GIVEN a hand-held tracker that has started.
template <class Tracker>
class Started {
 public:
  Started() { EXPECT_TRUE(ok(tracker_->initialise(camera_, {}))); }
  /// Whether parameters with a change are refused, and nothing else happens.
  template <class Change>
  bool refuses(Change change) {
    const std::uint64_t before = hash_of(*tracker_);
    typename Tracker::Parameters parameters;
    change(parameters);
    return tracker_->initialise(camera_, parameters) == Status::kBadConfig &&
           hash_of(*tracker_) == before;
  }

 private:
  PinholeCamera<float> camera_ = test::to_float(test::small_camera());
  std::unique_ptr<Tracker> tracker_ = std::make_unique<Tracker>();
};

/// GIVEN a vehicle's tracker that has started.
class ParametersOfAVehicle : public ::testing::Test {
 protected:
  using Filter = GroupIekfSlam<float, TinyConfig::kMaxLandmarks, 3>;
  using Tracker = FrameTracker<TinyConfig, Filter>;
  using Parameters = Tracker::Parameters;

  ParametersOfAVehicle() {
    start_.covariance = 1e-6F * Matrix3<float>::Identity();
    EXPECT_TRUE(ok(initialise({})));
    before_ = hash_of(*tracker_);
  }
  Status initialise(const Parameters& parameters) {
    return tracker_->initialise(test::to_float(test::small_camera()), mounting_, start_,
                                parameters);
  }
  /// Whether the change is refused as a bad one, with the tracker as it was.
  template <class Change>
  bool refuses(Change change) {
    Parameters parameters;
    change(parameters);
    const Status status = initialise(parameters);
    return status == Status::kBadConfig && hash_of(*tracker_) == before_;
  }

  std::unique_ptr<Tracker> tracker_ = std::make_unique<Tracker>();
  Rigid<float> mounting_;
  Tracker::Start start_;
  std::uint64_t before_ = 0;
};

TEST_F(ParametersOfAVehicle, OfOdometryAndCameraArePossible) {
  EXPECT_TRUE(refuses([](Parameters& p) { p.odometry.wheelbase_m = 0.0F; }));
  EXPECT_TRUE(refuses([](Parameters& p) { p.odometry.sigma_speed_mps = kNaN; }));
  EXPECT_TRUE(refuses([](Parameters& p) { p.sigma_px = 0.0F; }));
  EXPECT_TRUE(refuses([](Parameters& p) { p.sigma_px = kInf; }));
  EXPECT_TRUE(refuses([](Parameters& p) { p.floor.gate = -1.0F; }));
  EXPECT_TRUE(refuses([](Parameters& p) { p.filter.gate = kNaN; }));
  EXPECT_TRUE(refuses([](Parameters& p) { p.filter.gate = kInf; }));
  EXPECT_TRUE(refuses([](Parameters& p) { p.filter.rest_sigmas = kInf; }));
  EXPECT_TRUE(refuses([](Parameters& p) { p.filter.ransac.min_inlier_share = kNaN; }));
  EXPECT_TRUE(refuses([](Parameters& p) { p.filter.ransac.min_inlier_share = 1.5F; }));
}

TEST_F(ParametersOfAVehicle, OfItsPartsArePossible) {
  EXPECT_TRUE(refuses([](Parameters& p) { p.measurement.search.fast_threshold = 0; }));
  EXPECT_TRUE(refuses([](Parameters& p) { p.measurement.search.patch.gate = 0.0F; }));
  EXPECT_TRUE(refuses([](Parameters& p) { p.measurement.max_searches = -1; }));
  EXPECT_TRUE(refuses([](Parameters& p) { p.monitor.min_match_ratio = kNaN; }));
  EXPECT_TRUE(refuses([](Parameters& p) { p.monitor.min_inliers = 0; }));
  EXPECT_TRUE(refuses([](Parameters& p) { p.monitor.uncertain_s_to_lost = kInf; }));
  EXPECT_TRUE(refuses([](Parameters& p) { p.local_map.supply.min_distance_share = 1.5F; }));
  EXPECT_TRUE(refuses([](Parameters& p) { p.local_map.seeds.sigma_px = 0.0F; }));
  EXPECT_TRUE(refuses([](Parameters& p) { p.map_reuse.archive.mature_sightings = 0; }));
  EXPECT_TRUE(refuses([](Parameters& p) { p.map_reuse.archive.drift.position_m = kNaN; }));
  EXPECT_TRUE(
      refuses([](Parameters& p) { p.map_reuse.relocalisation.engine.samples_per_step = 0; }));
  EXPECT_TRUE(refuses([](Parameters& p) { p.map_reuse.library_slots_per_frame = -1; }));
  for (const float bad : {kNaN, kInf, 0.0F}) {
    EXPECT_TRUE(refuses([bad](Parameters& p) {
      p.map_reuse.relocalisation.engine.ransac.refinement.huber_sigma = bad;
    }));
    EXPECT_TRUE(refuses([bad](Parameters& p) {
      p.map_reuse.relocalisation.engine.ransac.refinement.inlier_gate = bad;
    }));
  }
  EXPECT_TRUE(refuses(
      [](Parameters& p) { p.map_reuse.relocalisation.engine.ransac.ambiguity_share = kInf; }));
}

TEST_F(ParametersOfAVehicle, OfWorkAndTimeArePossible) {
  EXPECT_TRUE(refuses([](Parameters& p) { p.work_limit = -1; }));
  EXPECT_TRUE(refuses([](Parameters& p) { p.max_frames_without_mapping = -1; }));
  EXPECT_TRUE(refuses([](Parameters& p) { p.max_step_us = 0; }));
  EXPECT_TRUE(
      refuses([](Parameters& p) { p.max_step_us = std::numeric_limits<std::int64_t>::max(); }));
}

TEST_F(ParametersOfAVehicle, MountingIsARigidTransform) {
  mounting_.rotation = Quaternion<float>(0.0F, 0.0F, 0.0F, 0.0F);
  EXPECT_EQ(initialise({}), Status::kBadConfig);
  mounting_.rotation = Quaternion<float>(1.01F, 0.0F, 0.0F, 0.0F);
  EXPECT_EQ(initialise({}), Status::kBadConfig);
  mounting_.rotation = Quaternion<float>(0.9995F, 0.0F, 0.0F, 0.0F);
  mounting_.translation.z() = kNaN;
  EXPECT_EQ(initialise({}), Status::kNonFiniteInput);
  mounting_.translation.z() = 1.0F;
  EXPECT_EQ(hash_of(*tracker_), before_);
  EXPECT_EQ(initialise({}), Status::kOk);
}

TEST_F(ParametersOfAVehicle, StartIsAPoseWithACovariance) {
  start_.covariance(0, 0) = -1.0F;
  EXPECT_EQ(initialise({}), Status::kInvalidArgument);
  start_.covariance(0, 0) = kNaN;
  EXPECT_EQ(initialise({}), Status::kNonFiniteInput);
  EXPECT_EQ(hash_of(*tracker_), before_);
}

TEST(ParametersOfAHandheldTracker, ArePossible) {
  Started<HandheldTracker<TinyConfig>> tracker;
  EXPECT_TRUE(tracker.refuses([](auto& p) { p.map_reuse.archive.mature_sightings = 0; }));
  EXPECT_TRUE(tracker.refuses([](auto& p) { p.map_reuse.min_found_ratio = kNaN; }));
  EXPECT_TRUE(tracker.refuses([](auto& p) { p.start.block_frames = 0; }));
  EXPECT_TRUE(tracker.refuses([](auto& p) { p.local_map.target_features = 0; }));
  EXPECT_TRUE(tracker.refuses([](auto& p) { p.max_step_us = 0; }));
  EXPECT_TRUE(tracker.refuses([](auto& p) { p.filter.sigma_px = 0.0F; }));
  EXPECT_TRUE(tracker.refuses([](auto& p) { p.filter.ransac.min_inlier_share = kNaN; }));
  EXPECT_TRUE(tracker.refuses([](auto& p) { p.filter.enough_inlier_share = kInf; }));
}

TEST(ParametersOfAWindow, ArePossible) {
  Started<WindowTracker<TinyConfig>> tracker;
  EXPECT_TRUE(tracker.refuses([](auto& p) { p.lens_sigma = -1.0F; }));
  EXPECT_TRUE(tracker.refuses([](auto& p) { p.window.focal_sigma = kNaN; }));
  EXPECT_TRUE(tracker.refuses([](auto& p) { p.memory.seek_samples = 0; }));
  EXPECT_TRUE(tracker.refuses([](auto& p) { p.memory.same_share = kNaN; }));
  EXPECT_TRUE(tracker.refuses([](auto& p) { p.memory.seek_landmarks = 61; }));
  EXPECT_TRUE(tracker.refuses([](auto& p) { p.rotation.inflation = kNaN; }));
}

}  // namespace
}  // namespace cairn

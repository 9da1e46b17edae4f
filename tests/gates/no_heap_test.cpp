// The core on the host with allocators that abort while it runs: no frame, of any content,
// allocates.

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>

#include <gtest/gtest.h>

#include "cairn/base/config.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/runtime/handheld_tracker.hpp"
#include "cairn/runtime/vehicle_tracker.hpp"

#include "tests/target/exercise.hpp"

namespace {

bool forbidden = false;

void check_allowed() {
  if (forbidden) std::abort();
}

struct NoHeap {
  NoHeap() { forbidden = true; }
  ~NoHeap() { forbidden = false; }
  NoHeap(const NoHeap&) = delete;
  NoHeap& operator=(const NoHeap&) = delete;
};

}  // namespace

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void __libc_free(void*);

void* malloc(std::size_t size) {
  check_allowed();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  check_allowed();
  return __libc_calloc(count, size);
}
void* realloc(void* block, std::size_t size) {
  check_allowed();
  return __libc_realloc(block, size);
}
void free(void* block) {
  check_allowed();
  __libc_free(block);
}
}

namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;
constexpr int kFrames = 20;

/// A wall of random blocks that slides past: something to find again from frame to frame.
void draw(int frame, std::uint8_t* pixels) {
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      cairn::Random block(static_cast<std::uint64_t>((x + 2 * frame) / 11 * 1000 + y / 13));
      pixels[y * kWidth + x] = static_cast<std::uint8_t>(30 + block.below(190));
    }
  }
}

cairn::PinholeCamera<float> camera() {
  cairn::PinholeCamera<float> c;
  c.fx = 260.0F;
  c.fy = 260.0F;
  c.cx = 159.5F;
  c.cy = 119.5F;
  c.width = kWidth;
  c.height = kHeight;
  return c;
}

TEST(NoHeapDeathTest, TheGuardItselfBites) {
  EXPECT_DEATH(
      {
        const NoHeap guard;
        auto* volatile block = new int(3);
        delete block;
      },
      "");
}

TEST(NoHeap, ModulesAllocateNothing) {
  const auto exercise = std::make_unique<cairn_test::Exercise>();
  for (int i = 0; i < cairn_test::Exercise::kStages; ++i) {
    const auto stage = cairn_test::Exercise::stages()[i];
    const NoHeap guard;
    EXPECT_NE(((*exercise).*stage.run)(), 0U);
  }
}

TEST(NoHeap, VehicleTrackerAllocatesNothing) {
  using Config = cairn::TinyConfig;
  using Tracker =
      cairn::VehicleTracker<Config, cairn::GroupIekfSlam<float, Config::kMaxLandmarks, 3>>;
  const auto tracker = std::make_unique<Tracker>();
  const auto pixels = std::make_unique<std::uint8_t[]>(kWidth * kHeight);
  cairn::Rigid<float> T_vehicle_camera;
  T_vehicle_camera.rotation = {0.5F, -0.5F, 0.5F, -0.5F};
  T_vehicle_camera.translation = {0.0F, 0.0F, 1.0F};
  typename Tracker::Start start;
  start.covariance = 1e-4F * cairn::Matrix3<float>::Identity();
  ASSERT_EQ(tracker->initialise(camera(), T_vehicle_camera, start, {}), cairn::Status::kOk);
  int found = 0;
  for (int i = 0; i < kFrames; ++i) {
    draw(i, pixels.get());
    cairn::FrameReport report;
    cairn::OdometrySample sample;
    sample.t_us = 33333LL * i + 1;
    sample.speed_mps = 0.1F;
    const NoHeap guard;
    static_cast<void>(tracker->add_odometry(sample));
    static_cast<void>(tracker->process_frame({pixels.get(), kWidth, kHeight, kWidth},
                                             33333LL * (i + 1), {}, report));
    found += report.corners;
  }
  EXPECT_GT(found, 0);
}

TEST(NoHeap, HandheldTrackerAllocatesNothing) {
  using Tracker = cairn::HandheldTracker<cairn::TinyConfig>;
  const auto tracker = std::make_unique<Tracker>();
  const auto pixels = std::make_unique<std::uint8_t[]>(kWidth * kHeight);
  ASSERT_EQ(tracker->initialise(camera(), {}), cairn::Status::kOk);
  int matched = 0;
  for (int i = 0; i < kFrames; ++i) {
    draw(i, pixels.get());
    cairn::FrameReport report;
    const NoHeap guard;
    static_cast<void>(tracker->process_frame({pixels.get(), kWidth, kHeight, kWidth},
                                             33333LL * (i + 1), {}, report));
    matched += report.matches;
  }
  EXPECT_GT(matched, 0);
}

}  // namespace

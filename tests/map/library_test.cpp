#include "cairn/map/library.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "map_fixture.hpp"

namespace cairn {
namespace {

using test::LandmarkMaker;
using test::SmallConfig;
using Library = MapLibrary<SmallConfig>;

/// Equal in all but id and place: equal retention scores.
LibraryLandmark<float> twin(LandmarkMaker& maker, LandmarkId id) {
  auto l = maker.landmark(id);
  l.p_map = Vector3<float>(static_cast<float>(id), 0, 0);
  l.views[0].T_map_reference.translation = l.p_map + Vector3<float>(0, 2, 0);
  l.views[0].focal_px = 500;
  l.covariance = 1e-4F * Matrix3<float>::Identity();
  l.searches = 10;
  l.sightings = 5;
  return l;
}

std::set<LandmarkId> ids(const Library& library) {
  std::set<LandmarkId> result;
  for (int slot = 0; slot < library.size(); ++slot) result.insert(library[slot].id);
  return result;
}

void expect_neighbours_agree_with_brute_force(const Library& library) {
  for (int a = 0; a < library.size(); ++a) {
    int expected = 0;
    const auto& la = library[a];
    for (int b = 0; b < library.size(); ++b) {
      if (a == b) continue;
      const auto& lb = library[b];
      const float reach = 0.025F * ((la.views[0].T_map_reference.translation - la.p_map).norm() +
                                    (lb.views[0].T_map_reference.translation - lb.p_map).norm());
      expected += (la.p_map - lb.p_map).norm() < reach ? 1 : 0;
    }
    ASSERT_EQ(library.neighbours(a), expected);
    ASSERT_EQ(library.retention_score(a), landmark_score(la) * 16 / (1 + expected));
  }
}

TEST(LandmarkScore, GrowsWithReliabilitySightingsAndPrecision) {
  LandmarkMaker maker(1);
  auto l = twin(maker, 1);
  const int base = landmark_score(l);
  EXPECT_GT(base, 0);
  l.sightings = 9;
  EXPECT_GT(landmark_score(l), base);
  l.sightings = 5;
  l.searches = 40;
  EXPECT_LT(landmark_score(l), base);
  l.searches = 10;
  l.covariance *= 100.0F;
  EXPECT_LT(landmark_score(l), base);
  l.covariance.setZero();
  l.sightings = l.searches = 65535;
  EXPECT_GT(landmark_score(l), 65000);
  EXPECT_LE(landmark_score(l), 65535);
}

TEST(LandmarkScore, CountersSaturateWithoutLosingTheirRatio) {
  LandmarkMaker maker(1);
  auto l = twin(maker, 1);
  l.searches = 65535;
  l.sightings = 60000;
  l.record(true);
  EXPECT_EQ(l.searches, 32768);
  EXPECT_EQ(l.sightings, 30001);
}

TEST(MapLibrary, AFullLibraryReplacesTheLowestRetentionScore) {
  LandmarkMaker maker(2);
  Library library;
  Health health;
  for (LandmarkId id = 1; id <= 24; ++id) {
    auto l = twin(maker, id);
    l.sightings = static_cast<std::uint16_t>(id == 7 ? 2 : 6);
    ASSERT_EQ(library.insert(l, health), Status::kOk);
  }
  EXPECT_EQ(health.landmarks_added, 24U);
  EXPECT_EQ(library.insert(twin(maker, 3), health), Status::kDuplicate);

  EXPECT_EQ(library.insert(twin(maker, 50), health), Status::kOk);  // 5 sightings beat 2
  EXPECT_EQ(health.landmarks_replaced, 1U);
  EXPECT_LT(library.find(7), 0);
  EXPECT_GE(library.find(50), 0);

  auto poor = twin(maker, 51);
  poor.sightings = 1;
  const auto before = ids(library);
  const std::uint32_t revision = library.revision();
  EXPECT_EQ(library.insert(poor, health), Status::kFull);
  EXPECT_EQ(health.landmarks_refused, 1U);
  EXPECT_EQ(ids(library), before);
  EXPECT_EQ(library.revision(), revision);
}

TEST(MapLibrary, TiesAreSettledByIdWhateverTheOrderOfArrival) {
  std::vector<LandmarkId> order;
  for (LandmarkId id = 2; id <= 48; id += 2) order.push_back(id);
  std::mt19937 engine(3);
  for (int run = 0; run < 20; ++run) {
    std::shuffle(order.begin(), order.end(), engine);
    LandmarkMaker maker(4);
    Library library;
    Health health;
    for (const LandmarkId id : order) ASSERT_TRUE(ok(library.insert(twin(maker, id), health)));
    auto better = twin(maker, 90);
    better.sightings = 8;
    ASSERT_EQ(library.insert(better, health), Status::kOk);
    EXPECT_LT(library.find(48), 0) << "of equals the youngest goes";
    // Of equals, an older id gets in and a younger one does not.
    EXPECT_EQ(library.insert(twin(maker, 47), health), Status::kFull);
    EXPECT_EQ(library.insert(twin(maker, 45), health), Status::kOk);
    EXPECT_LT(library.find(46), 0);
  }
}

TEST(MapLibrary, ACrowdedPlaceGivesWayFirst) {
  LandmarkMaker maker(5);
  Library library;
  Health health;
  for (LandmarkId id = 1; id <= 24; ++id) {
    auto l = twin(maker, id);
    if (id > 20) {  // four at one place, better than the others one by one
      l.p_map = Vector3<float>(100, 0.001F * static_cast<float>(id), 0);
      l.views[0].T_map_reference.translation = l.p_map + Vector3<float>(0, 2, 0);
      l.sightings = 7;
    }
    ASSERT_TRUE(ok(library.insert(l, health)));
  }
  ASSERT_EQ(library.insert(twin(maker, 40), health), Status::kOk);
  EXPECT_LT(library.find(24), 0);
  expect_neighbours_agree_with_brute_force(library);
}

TEST(MapLibrary, BookkeepingSurvivesARandomLife) {
  LandmarkMaker maker(6);
  Library library;
  Health health;
  LandmarkId next = 1;
  int accepted = 0;
  for (int step = 0; step < 1500; ++step) {
    const unsigned action = maker.bits() % 10U;
    if (action < 5) {
      auto l = maker.landmark(next++);
      l.p_map *= 0.05F;  // a small room: many neighbours
      l.views[0].T_map_reference.translation = l.p_map + Vector3<float>(0, 0, 3);
      accepted += ok(library.insert(l, health)) ? 1 : 0;
    } else if (!library.empty()) {
      const int slot = static_cast<int>(maker.bits() % static_cast<unsigned>(library.size()));
      auto l = library[slot];
      if (action < 8) {
        ASSERT_EQ(library.record(l.id, action == 6), Status::kOk);
      } else {
        l.p_map += 0.05F * maker.position(1);
        ASSERT_EQ(library.update(l), Status::kOk);
      }
    }
    expect_neighbours_agree_with_brute_force(library);
  }
  EXPECT_EQ(health.landmarks_added + health.landmarks_replaced, static_cast<unsigned>(accepted));
  EXPECT_GT(health.landmarks_replaced, 0U);
  EXPECT_GT(health.landmarks_refused, 0U);
}

TEST(MapLibrary, RefusesWhatCannotBeALandmark) {
  LandmarkMaker maker(7);
  Library library;
  Health health;
  const auto good = maker.landmark(1);
  const auto status_of = [&](auto&& change) {
    auto l = good;
    change(l);
    return library.insert(l, health);
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  constexpr Status kInvalid = Status::kInvalidArgument;
  EXPECT_EQ(status_of([](auto& l) { l.id = kNoLandmark; }), kInvalid);
  EXPECT_EQ(status_of([&](auto& l) { l.p_map.x() = nan; }), Status::kNonFiniteInput);
  EXPECT_EQ(status_of([&](auto& l) { l.covariance(2, 1) = nan; }), Status::kNonFiniteInput);
  EXPECT_EQ(status_of([](auto& l) { l.covariance(1, 1) = -1; }), kInvalid);
  EXPECT_EQ(status_of([](auto& l) { l.view_count = 0; }), kInvalid);
  EXPECT_EQ(status_of([](auto& l) { l.view_count = 2; }), kInvalid);
  EXPECT_EQ(status_of([](auto& l) { ++(l.sightings = l.searches); }), kInvalid);
  EXPECT_EQ(status_of([](auto& l) { l.views[0].focal_px = 0; }), kInvalid);
  EXPECT_EQ(status_of([](auto& l) { l.views[0].pose.scale_index = 25; }), kInvalid);
  EXPECT_EQ(status_of([](auto& l) { l.views[0].T_map_reference.rotation.w() += 3; }), kInvalid);
  EXPECT_EQ(status_of([](auto& l) { l.views[0].T_map_reference.translation = l.p_map; }), kInvalid);
  EXPECT_EQ(library.update(good), Status::kNotFound);
  EXPECT_EQ(library.record(1, true), Status::kNotFound);
  EXPECT_EQ(library.size(), 0);
  EXPECT_EQ(library.revision(), 0U);
}

}  // namespace
}  // namespace cairn

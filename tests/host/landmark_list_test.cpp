#include "host_sim/trackers/landmark_list.hpp"

#include <gtest/gtest.h>

namespace cairn::host {
namespace {

/// GIVEN a map that lies 1 m beside the filter's world, turned by a quarter to the left.
struct TurnedMap {
  struct Filter {
    int landmark_count() const { return 1; }
    LandmarkId landmark_id(int) const { return 7; }
    Vector3<float> landmark_position(int) const { return {1.0F, 2.0F, 0.5F}; }
    Matrix3<float> landmark_covariance(int) const {
      return Vector3<float>(0.04F, 0.01F, 0.09F).asDiagonal();
    }
    int find(LandmarkId id) const { return id == 7 ? 0 : -1; }
  };
  struct Archived {
    LandmarkId id = kNoLandmark;
    Vector3<float> p_map = Vector3<float>::Zero();
    Matrix3<float> covariance = Matrix3<float>::Zero();
  };
  /// The archived record of the filter's landmark, and one that is in the library alone.
  struct Library {
    Archived landmarks[2] = {{7, {2.0F, 0.0F, 0.5F}, Matrix3<float>::Identity()},
                             {9, {5.0F, 6.0F, 1.0F}, Matrix3<float>::Identity()}};
    int size() const { return 2; }
    const Archived& operator[](int slot) const { return landmarks[slot]; }
  };

  const Filter& filter() const { return filter_; }
  const Library& library() const { return library_; }
  Rigid<float> T_world_map() const {
    return {Quaternion<float>(0.70710678F, 0.0F, 0.0F, 0.70710678F), {1.0F, 0.0F, 0.0F}};
  }

  Filter filter_;
  Library library_;
};

TEST(LandmarkList, IsInTheFrameOfTheMap) {
  const std::vector<MapLandmark> all = landmarks_in_map(TurnedMap{});
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].id, 7U);
  EXPECT_TRUE(all[0].active);
  EXPECT_LT((all[0].p_map - Vector3<double>(2.0, 0.0, 0.5)).norm(), 1e-6)
      << "where its archived record has it";
  EXPECT_NEAR(all[0].covariance(0, 0), 0.01, 1e-6);
  EXPECT_NEAR(all[0].covariance(1, 1), 0.04, 1e-6);
  EXPECT_NEAR(all[0].covariance(2, 2), 0.09, 1e-6);
  EXPECT_EQ(all[1].id, 9U);
  EXPECT_FALSE(all[1].active);
  EXPECT_EQ(all[1].p_map, Vector3<double>(5.0, 6.0, 1.0));
}

}  // namespace
}  // namespace cairn::host

// KITTI in the folders as it is downloaded.
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "data_set_pictures.hpp"
#include "host_sim/sources/data_sets.hpp"
#include "input_messages.hpp"
#include "temporary_folder.hpp"

namespace cairn::host {
namespace {

namespace fs = std::filesystem;

constexpr const char* kKittiCalibration =
    "P0: 60 0 32 0 0 60 24 0 0 0 1 0\nP1: 60 0 32 -32 0 60 24 0 0 0 1 0\n"
    "P2: 70 0 30 7 0 70 22 0 0 0 1 0\nP3: 60 0 32 0 0 60 24 0 0 0 1 0\nTr: 1 0 0 0 0 1 0 0 0 0 1 "
    "0\n";

TEST(Kitti, PublicLayoutHasItsPosesBesideTheSequences) {
  const TemporaryFolder folder;
  const std::string sequence = "dataset/sequences/00/";
  std::string poses;
  for (int i = 0; i < 3; ++i) {
    picture(folder.path() / sequence / "image_0" / ("00000" + std::to_string(i) + ".png"), 64, 48);
    poses += "1 0 0 0 0 1 0 0 0 0 1 " + std::to_string(i) + "\n";
  }
  folder.write(sequence + "calib.txt", kKittiCalibration);
  folder.write(sequence + "times.txt", "0.0\n0.103736\n0.207472\n");
  folder.write("dataset/poses/00.txt", poses);
  for (const char* slash : {"", "/"}) {
    const auto source =
        make_kitti_source((folder.path() / sequence).parent_path().string() + slash, {}, 1);
    EXPECT_EQ(source->info().camera.fx, 60.0);
    const std::vector<Frame> frames = all_frames(*source);
    ASSERT_EQ(frames.size(), 3U);
    EXPECT_EQ(frames[1].t_us, 103736);
    const Vector3<double> ahead =
        frames[2].true_T_world_camera->translation - frames[0].true_T_world_camera->translation;
    EXPECT_NEAR((ahead - Vector3<double>(2.0, 0.0, 0.0)).norm(), 0.0, 1e-9);
    ASSERT_EQ(frames[2].odometry.size(), 1U);
    EXPECT_NEAR(frames[2].odometry[0].speed_mps, 1.0 / 0.103736, 0.5);
  }
  EXPECT_TRUE(says(message_of([&] { make_kitti_source(folder.path() / "dataset", {}, 1); }),
                   {"dataset", "one sequence", "sequences/00"}));
  // Without true poses, as the sequences of the benchmark are.
  fs::remove(folder.path() / "dataset/poses/00.txt");
  const auto source = make_kitti_source(folder.path() / sequence, {}, 1);
  EXPECT_FALSE(source->info().odometry.has_value());
  EXPECT_TRUE(says(source->info().note, {"no true poses", "hand-held"}));
  EXPECT_FALSE(all_frames(*source).front().true_T_world_camera.has_value());
}

/// WHEN a picture is missing, THEN those behind it keep their times and poses: rows belong to
/// numbers, from 0 or from the first picture on.
TEST(Kitti, RowsBelongToNumbers) {
  const TemporaryFolder folder;
  folder.write("calib.txt", kKittiCalibration);
  const auto rows = [&](int count) {
    std::string poses;
    std::string times;
    for (int i = 0; i < count; ++i) {
      poses += "1 0 0 0 0 1 0 0 0 0 1 " + std::to_string(i) + "\n";
      times += std::to_string(0.1 * i) + "\n";
    }
    folder.write("poses.txt", poses);
    folder.write("times.txt", times);
  };
  const auto show = [&](const std::vector<int>& numbers) {
    fs::remove_all(folder.path() / "image_0");
    for (const int n : numbers) {
      char name[32];
      std::snprintf(name, sizeof name, "%06d.png", n);
      picture(folder.path() / "image_0" / name, 64, 48);
    }
  };
  /// Rows that the times and the poses of the frames are of.
  const auto taken = [&] {
    std::vector<int> found;
    for (const Frame& frame : all_frames(*make_kitti_source(folder.path(), {}, 1))) {
      found.push_back(static_cast<int>(frame.t_us / 100000));
      EXPECT_NEAR(frame.true_T_world_vehicle->translation.x(), found.back(), 1e-6);
    }
    return found;
  };
  using Rows = std::vector<int>;
  show({0, 1, 3, 4});
  rows(5);
  EXPECT_EQ(taken(), (Rows{0, 1, 3, 4}));
  rows(4);  // a row for each picture that is there
  EXPECT_EQ(taken(), (Rows{0, 1, 2, 3}));
  show({100, 101, 103});
  rows(200);  // of the whole sequence
  EXPECT_EQ(taken(), (Rows{100, 101, 103}));
  rows(4);  // of the clip
  EXPECT_EQ(taken(), (Rows{0, 1, 3}));
  show({100, 101, 104, 105});
  rows(5);
  const std::string said = message_of([&] { make_kitti_source(folder.path(), {}, 1); });
  EXPECT_TRUE(says(said, {"000104.png", "000101.png", "5", "poses.txt"}));
  show({0, 1, 2});
  rows(2);
  EXPECT_TRUE(says(message_of([&] { make_kitti_source(folder.path(), {}, 1); }),
                   {"poses.txt", "each of the 3 images"}));
  // 10 Hz without times.
  show({7, 8, 10});
  rows(3);
  fs::remove(folder.path() / "times.txt");
  const std::vector<Frame> frames = all_frames(*make_kitti_source(folder.path(), {}, 1));
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[2].t_us, 300000);
}

TEST(Kitti, ColourPicturesHaveTheirOwnCamera) {
  const TemporaryFolder folder;
  picture(folder.path() / "image_2/000000.png", 64, 48);
  folder.write("calib.txt", kKittiCalibration);
  folder.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  const auto source = make_kitti_source(folder.path(), {}, 1);
  EXPECT_EQ(source->info().camera.fx, 70.0);
  const std::vector<Frame> frames = all_frames(*source);
  // 0.1 m to the left of camera 0; the vehicle's y points left, and its origin is the same.
  const Vector3<double> left(1.08, -0.32 + 0.1, 1.65);
  EXPECT_NEAR((source->info().T_vehicle_camera.translation - left).norm(), 0.0, 1e-9);
  EXPECT_NEAR((frames[0].true_T_world_camera->translation - left).norm(), 0.0, 1e-9);
  EXPECT_NEAR(frames[0].true_T_world_vehicle->translation.norm(), 0.0, 1e-9);
}

/// WHEN the car turns about its origin near the rear axle, THEN its camera moves sideways and the
/// odometry says a turn without way.
TEST(Kitti, OriginIsBelowTheImu) {
  const TemporaryFolder folder;
  folder.write("calib.txt", kKittiCalibration);
  for (const char* name : {"000000.png", "000001.png"}) {
    picture(folder.path() / "image_0" / name, 64, 48);
  }
  // To the left by 0.1 rad about the point 1.08 m behind and 0.32 m left of camera 0, in its axes.
  const double c = std::cos(0.1);
  const double s = std::sin(0.1);
  const double x = -0.32 - (c * -0.32 - s * -1.08);
  const double z = -1.08 - (s * -0.32 + c * -1.08);
  char turned[256];
  std::snprintf(turned, sizeof turned,
                "1 0 0 0 0 1 0 0 0 0 1 0\n%.9f 0 %.9f %.9f 0 1 0 0 %.9f 0 %.9f %.9f\n", c, -s, x, s,
                c, z);
  folder.write("poses.txt", turned);
  const auto source = make_kitti_source(folder.path(), {}, 1);
  const std::vector<Frame> frames = all_frames(*source);
  ASSERT_EQ(frames.size(), 2U);
  const Vector3<double> place = source->info().T_vehicle_camera.translation;
  EXPECT_NEAR((place - Vector3<double>(1.08, -0.32, 1.65)).norm(), 0.0, 1e-9);
  EXPECT_NEAR(frames[1].true_T_world_vehicle->translation.norm(), 0.0, 1e-6);
  EXPECT_GT(frames[1].true_T_world_camera->translation.y() -
                frames[0].true_T_world_camera->translation.y(),
            0.1);
  ASSERT_EQ(frames[1].odometry.size(), 1U);
  EXPECT_NEAR(frames[1].odometry[0].speed_mps, 0.0, 0.5);
  EXPECT_NEAR(frames[1].odometry[0].turn, 1.0, 0.05);
}

void write_kitti_raw(const TemporaryFolder& folder) {
  const std::string drive = "2011_09_26/2011_09_26_drive_0001_sync/";
  const std::string oxts = drive + "oxts/data/";
  std::string camera_times, oxts_times;
  for (int i = 0; i < 4; ++i) {
    const std::string name = "000000000" + std::to_string(i);
    picture(folder.path() / drive / "image_00/data" / (name + ".png"), 64, 48);
    char text[512];
    std::snprintf(text, sizeof text, "2011-09-26 13:02:25.%d50000000\n", 1 + i);
    camera_times += text;
    std::snprintf(text, sizeof text, "2011-09-26 13:02:25.%d40000000\n", 1 + i);
    oxts_times += text;
    // 10 m/s to the north: yaw 90 degrees; 1 m a step.
    std::snprintf(text, sizeof text,
                  "%.12f 8.4 110.0 0 0 1.5707963267948966 10 0 10 0 0 0 0 9.8 0 0 9.8 0 0 0.02 0 0 "
                  "0.02 0.1 0.1 4 10 4 4 0\n",
                  49.0 + i / 6378137.0 * 180.0 / M_PI);
    folder.write(oxts + name + ".txt", text);
  }
  folder.write(drive + "image_00/timestamps.txt", camera_times);
  folder.write(drive + "oxts/timestamps.txt", oxts_times);
  folder.write("2011_09_26/calib_cam_to_cam.txt",
               "calib_time: 09-Jan-2012 13:57:47\nS_00: 70 52\nK_00: 61 0 35 0 61 26 0 0 1\n"
               "D_00: -0.1 0.01 0 0 0\nS_rect_00: 64 48\nR_rect_00: 1 0 0 0 1 0 0 0 1\n"
               "P_rect_00: 60 0 32 0 0 60 24 0 0 0 1 0\n");
  folder.write("2011_09_26/calib_velo_to_cam.txt",
               "calib_time: 15\nR: 0 -1 0 0 0 -1 1 0 0\nT: 0 -0.08 -0.27\n");
  folder.write("2011_09_26/calib_imu_to_velo.txt", "R: 1 0 0 0 1 0 0 0 1\nT: -0.81 0.32 -0.8\n");
}

TEST(KittiRaw, OxtsIsOdometryAndTruth) {
  const TemporaryFolder folder;
  write_kitti_raw(folder);
  const fs::path drive = folder.path() / "2011_09_26/2011_09_26_drive_0001_sync";
  ASSERT_TRUE(is_kitti_raw(drive));
  EXPECT_FALSE(is_kitti_raw(folder.path()));
  const auto source = make_kitti_raw_source(drive, {});
  EXPECT_EQ(source->info().camera.fx, 60.0);
  // 0.81 + 0.27 m ahead of the IMU, 0.93 + 0.8 - 0.08 m above the ground.
  const Vector3<double> place = source->info().T_vehicle_camera.translation;
  EXPECT_NEAR((place - Vector3<double>(1.08, -0.32, 1.65)).norm(), 0.0, 1e-9);
  const std::vector<Frame> frames = all_frames(*source);
  ASSERT_EQ(frames.size(), 4U);
  EXPECT_EQ(frames[0].t_us, 1317042145150000);
  EXPECT_TRUE(frames[0].odometry.empty());
  ASSERT_EQ(frames[1].odometry.size(), 1U);
  EXPECT_EQ(frames[1].odometry[0].t_us, 1317042145240000);
  EXPECT_EQ(frames[1].odometry[0].speed_mps, 10.0F);
  EXPECT_EQ(frames[1].odometry[0].turn, 0.02F);
  // A tenth of the way from one pose to the next, northwards.
  const Vector3<double> vehicle = frames[1].true_T_world_vehicle->translation;
  EXPECT_NEAR(vehicle.y(), 1.1, 1e-3);
  EXPECT_NEAR(vehicle.x(), 0.0, 1e-6);
  EXPECT_NEAR(vehicle.z(), -0.93, 1e-9);
  const Vector3<double> ahead = frames[1].true_T_world_vehicle->rotation * Vector3<double>::UnitX();
  EXPECT_NEAR(ahead.y(), 1.0, 1e-9);
}

TEST(KittiRaw, WhatIsMissingOrWrongIsNamed) {
  const TemporaryFolder folder;
  write_kitti_raw(folder);
  const fs::path drive = folder.path() / "2011_09_26/2011_09_26_drive_0001_sync";
  const std::string name = "2011_09_26/2011_09_26_drive_0001_sync/";
  const auto problem = [&] { return message_of([&] { make_kitti_raw_source(drive, {}); }); };
  EXPECT_EQ(problem(), "no error");
  folder.write(name + "oxts/timestamps.txt", "2011-09-26 13:02:25.14\n2011-09-26 13:02\n");
  EXPECT_TRUE(says(problem(), {"oxts/timestamps.txt:2", "2011-09-26 13:02:25"}));
  folder.write(name + "oxts/timestamps.txt", "2011-09-26 13:02:25.14\n");
  EXPECT_TRUE(says(problem(), {"oxts/timestamps.txt", "0000000001.txt", "1 lines"}));
  write_kitti_raw(folder);
  folder.write(name + "oxts/data/0000000002.txt", "1 2 3\n");
  EXPECT_TRUE(says(problem(), {"0000000002.txt:1", "30 numbers"}));
  write_kitti_raw(folder);
  picture(drive / "image_00/data/0000000000.png", 60, 48);
  EXPECT_TRUE(says(problem(), {"0000000000.png", "S_rect_00", "60x48"}));
  write_kitti_raw(folder);
  fs::remove(folder.path() / "2011_09_26/calib_imu_to_velo.txt");
  EXPECT_TRUE(says(problem(), {"2011_09_26/calib_imu_to_velo.txt", "no such file"}));
}

}  // namespace
}  // namespace cairn::host

#include "host_sim/sources/gyro_file.hpp"

#include <gtest/gtest.h>

#include "input_messages.hpp"
#include "temporary_folder.hpp"

namespace cairn::host {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;

TEST(GyroFile, ReadsWhatDataSetsAndPhonesWrite) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& text) {
    return read_gyro(folder.write("gyro.csv", text));
  };

  const auto plain = read("t_us,wx_radps,wy_radps,wz_radps\n-5000,0.1,-0.2,0.3\n0,1,2,3\n");
  ASSERT_EQ(plain.size(), 2U);
  EXPECT_EQ(plain[0].t_us, -5000);
  EXPECT_EQ(plain[0].rate_radps, Vector3<float>(0.1F, -0.2F, 0.3F));

  // EuRoC and TUM-VI: ns since 1970, a comment as header, the accelerometer behind.
  const auto euroc = read(
      "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
      "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\r\n"
      "1403636579758555392,-0.09,0.14,0.07,8.1,-0.3,-2.6\r\n"
      "1403636579763555584,-0.1,0.13,0.08,8.2,-0.4,-2.5\r\n");
  ASSERT_EQ(euroc.size(), 2U);
  EXPECT_EQ(euroc[1].t_us, 1403636579763556);
  EXPECT_EQ(euroc[1].rate_radps, Vector3<float>(-0.1F, 0.13F, 0.08F));

  // A message of ROS and an app that records video with it.
  for (const char* header :
       {"__time,/imu/angular_velocity/x,/imu/angular_velocity/y,/imu/angular_velocity/z",
        "Timestamp[nanosecond],gx[rad/s],gy[rad/s],gz[rad/s]"}) {
    const auto samples =
        read(std::string(header) + "\n1403636579758555392,1,2,3\n1403636579763555584,1,2,3\n");
    ASSERT_EQ(samples.size(), 2U) << header;
    EXPECT_EQ(samples[1].t_us, 1403636579763556) << header;
    EXPECT_EQ(samples[1].rate_radps, Vector3<float>(1.0F, 2.0F, 3.0F)) << header;
  }

  // An app of a phone, its columns in another order, its unit another.
  const auto phone = read(
      "\"Time (s)\";\"Gyroscope z (deg/s)\";\"Gyroscope x (deg/s)\";\"Gyroscope y (deg/s)\"\n"
      "0,01;90;0;0\n0,02;0;180;-90\n");
  ASSERT_EQ(phone.size(), 2U);
  EXPECT_EQ(phone[1].t_us, 20000);
  EXPECT_NEAR(phone[0].rate_radps.z(), 90.0 * kDegree, 1e-6);
  EXPECT_NEAR(phone[1].rate_radps.x(), 180.0 * kDegree, 1e-6);
  EXPECT_NEAR(phone[1].rate_radps.y(), -90.0 * kDegree, 1e-6);
}

TEST(GyroFile, ATimeWithoutAUnitIsInSecondsOrSince1970) {
  const TemporaryFolder folder;
  const auto first_us = [&](const std::string& first, const std::string& second) {
    const std::string text = "t,wx,wy,wz\n" + first + ",0,0,0\n" + second + ",0,0,0\n";
    return read_gyro(folder.write("gyro.csv", text)).front().t_us;
  };
  EXPECT_EQ(first_us("12.5", "12.505"), 12500000);
  EXPECT_EQ(first_us("1700000000.25", "1700000000.26"), 1700000000250000);
  EXPECT_EQ(first_us("1700000000250", "1700000000260"), 1700000000250000);
  EXPECT_EQ(first_us("1700000000250000000", "1700000000260000000"), 1700000000250000);
  const std::string other = message_of([&] { first_us("5000000000000", "5000005000000"); });
  EXPECT_TRUE(says(other, {"gyro.csv:2", "since 1970", "t_ns"}));
}

TEST(GyroFile, RefusesByLineAndColumn) {
  const TemporaryFolder folder;
  const auto problem = [&](const std::string& text) {
    return message_of([&] { read_gyro(folder.write("g.csv", text)); });
  };
  const std::string header = "t_us,wx_radps,wy_radps,wz_radps\n";
  EXPECT_EQ(problem(header + "0,0,0,0\n5000,200,-200,0\n"), "no error");
  EXPECT_TRUE(
      says(problem(header + "0,0,0,0\n5000,0,250,0\n"), {"g.csv:3", "wy_radps", "200", "250"}));
  EXPECT_TRUE(says(problem(header + "0,0,0,0\n5000,0,0,nan\n"), {"g.csv:3", "wz_radps", "nan"}));
  EXPECT_TRUE(says(problem(header + "0,0,0,0\n0,0,0,0\n"), {"g.csv:3", "increasing"}));
  EXPECT_TRUE(says(problem(header + "9000,0,0,0\n5000,0,0,0\n"), {"g.csv:3", "increasing"}));
  EXPECT_TRUE(says(problem(header + "0,0,0\n"), {"g.csv:2", "4 fields", "3"}));
  EXPECT_TRUE(says(problem(header + "0,0,0,0\n"), {"g.csv", "two or more"}));
  EXPECT_TRUE(says(problem(""), {"g.csv", "empty"}));
  EXPECT_TRUE(says(problem("t_us,wx,wy\n0,0,0\n"), {"g.csv:1", "wz_radps"}));
  EXPECT_TRUE(says(problem("wx,wy,wz\n0,0,0\n"), {"g.csv:1", "t_s"}));
  EXPECT_TRUE(says(problem("t_us,gyro_x,gyro_y,gyro_z\n0,0,0,0\n"), {"gyro_x", "unit"}));
  EXPECT_TRUE(says(problem("t_us,wx,wx,wy,wz\n0,0,0,0,0\n"), {"g.csv:1", "wx", "two"}));
}

TEST(ImuFile, ReadsEurocAndKalibr) {
  const TemporaryFolder folder;
  const ImuFile euroc = read_imu_file(folder.write(
      "sensor.yaml",
      "#Default imu sensor yaml file\nsensor_type: imu\nT_BS:\n  cols: 4\n  rows: 4\n"
      "  data: [0, -1, 0, 0.1,\n   1, 0, 0, 0.2,\n   0, 0, 1, 0.3,\n   0, 0, 0, 1]\n"
      "rate_hz: 200\ngyroscope_noise_density: 1.6968e-04\ngyroscope_random_walk: 1.9393e-05\n"));
  EXPECT_DOUBLE_EQ(euroc.noise_density.value_or(0.0), 1.6968e-4);
  EXPECT_DOUBLE_EQ(euroc.bias_walk.value_or(0.0), 1.9393e-5);
  ASSERT_TRUE(euroc.T_body_imu.has_value());
  const Vector3<double> turned = euroc.T_body_imu->rotation * Vector3<double>(1.0, 0.0, 0.0);
  EXPECT_LT((turned - Vector3<double>(0.0, 1.0, 0.0)).norm(), 1e-9);
  EXPECT_EQ(euroc.T_body_imu->translation, Vector3<double>(0.1, 0.2, 0.3));

  const ImuFile kalibr = read_imu_file(
      folder.write("imu.yaml", "imu0:\n  gyroscope_noise_density: 0.001\n  rostopic: /imu0\n"));
  EXPECT_DOUBLE_EQ(kalibr.noise_density.value_or(0.0), 1e-3);
  EXPECT_FALSE(kalibr.bias_walk.has_value() || kalibr.T_body_imu.has_value());
}

TEST(ImuFile, RefusesByKey) {
  const TemporaryFolder folder;
  const auto problem = [&](const std::string& text) {
    return message_of([&] { read_imu_file(folder.write("imu.yaml", text)); });
  };
  const auto pose = [&](const std::string& numbers) {
    return problem("gyroscope_noise_density: 0.001\nT_BS: [" + numbers + "]\n");
  };
  EXPECT_EQ(pose("1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1"), "no error");
  EXPECT_TRUE(says(pose("1,0,0,0, 0,1,0,0, 0,0,1,0"), {"T_BS", "4x4"}));
  EXPECT_TRUE(says(pose("1,0,0,0, 0,1,0,0, 0,0,1,word, 0,0,0,1"), {"T_BS", "word"}));
  EXPECT_TRUE(says(pose("1,0,0,0, 0,1,0,0, 0,0,2,0, 0,0,0,1"), {"T_BS", "rotation"}));
  EXPECT_TRUE(says(pose("1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,2"), {"T_BS", "last row"}));
  for (const char* value : {"-1", "0", "2", "1e-4x", "nan", "[1, 2]"}) {
    const std::string said = problem(std::string("gyroscope_noise_density: ") + value + "\n");
    EXPECT_TRUE(says(said, {"imu.yaml", "gyroscope_noise_density", "above 0"})) << value;
  }
  EXPECT_TRUE(says(problem("imu0:\n  gyroscope_random_walk: x\n"), {"imu0.gyroscope_random_walk"}));
  EXPECT_TRUE(says(problem("accelerometer_noise_density: 0.01\n"), {"gyroscope_noise_density"}));
}

}  // namespace
}  // namespace cairn::host

#include "host_sim/sources/odometry_file.hpp"

#include <gtest/gtest.h>

#include "input_messages.hpp"
#include "temporary_folder.hpp"

namespace cairn::host {
namespace {

TEST(OdometryFile, SamplesOutsideTheDomainAreRefusedByLine) {
  const TemporaryFolder folder;
  const auto problem = [&](const std::string& text) {
    return message_of([&] { read_odometry(folder.write("o.csv", text)); });
  };
  const std::string twist = "t_s,speed_mps,yaw_rate_radps\n0,1,0\n";
  const std::string steering = "t_s,speed_mps,steering_rad,wheelbase_m\n0,1,0,0.5\n";
  EXPECT_EQ(problem(twist + "0.1,-3,9.9\n"), "no error");
  EXPECT_EQ(problem(steering + "0.1,-0.3,1.4,0.5\n"), "no error");
  EXPECT_TRUE(says(problem(twist + "1,1,200\n"), {"o.csv:3", "yaw_rate_radps", "10", "200"}));
  EXPECT_TRUE(says(problem(twist + "1,500,0\n"), {"o.csv:3", "speed_mps", "100", "500"}));
  EXPECT_TRUE(says(problem(steering + "1,1,20,0.5\n"), {"o.csv:3", "steering_rad", "1.4", "20"}));
  EXPECT_TRUE(says(problem(twist + "0.9,1,5\n"), {"o.csv:3", "yaw_rate_radps", "4.5 rad"}));
  EXPECT_TRUE(says(problem(steering + "0.9,9,1.3,0.5\n"), {"o.csv:3", "steering_rad", "turn"}));
  EXPECT_TRUE(says(problem(steering + "1,1,0,0.6\n"), {"o.csv:3", "wheelbase_m", "same", "0.6"}));
  EXPECT_TRUE(says(problem("t_s,speed_mps,steering_rad,wheelbase_m\n0,1,0,-1\n"),
                   {"o.csv:2", "wheelbase_m", "above 0"}));
  EXPECT_TRUE(says(problem(twist + "0,1,0\n"), {"o.csv:3", "increasing", "0.000000 s"}));
  EXPECT_TRUE(says(problem(twist), {"o.csv", "two or more"}));
  EXPECT_TRUE(says(problem("t_s,speed_mps,steering_rad\n0,1,0\n"), {"o.csv:1", "wheelbase_m"}));
}

TEST(OdometryFile, AYawRateBesideASteeringAngleIsUsedAndThatIsSaid) {
  const TemporaryFolder folder;
  const OdometryFile both = read_odometry(
      folder.write("o.csv",
                   "t_s,speed_mps,steering_rad,wheelbase_m,yaw_rate_radps\n0,1,0.1,2,0.3\n"
                   "0.1,1,0.1,2,0.3\n"));
  EXPECT_TRUE(says(both.warning, {"o.csv", "yaw rate", "steering"}));
  EXPECT_FLOAT_EQ(both.samples[0].turn, 0.3F);
  EXPECT_EQ(both.samples[0].kind, OdometrySample::Kind::kTwist);
  EXPECT_TRUE(read_odometry(folder.write("o.csv", "t_s,speed_mps,yaw_rate_radps\n0,1,0\n0.1,1,0\n"))
                  .warning.empty());
}

TEST(OdometryFile, TheTurnThatIsMissingOrOfAnUnknownUnitIsNamed) {
  const TemporaryFolder folder;
  const auto problem = [&](const std::string& header) {
    return message_of([&] { read_odometry(folder.write("o.csv", header + "\n0,1,0\n0.1,1,0\n")); });
  };
  EXPECT_TRUE(says(problem("t_s,speed_mps,yaw_rate_rads"), {"'yaw_rate_rads'", "found 'rads'"}));
  EXPECT_TRUE(says(problem("t_s,speed_mps,steering_wheel_deg"), {"'steering_wheel_deg'", "unit"}));
  EXPECT_TRUE(says(problem("t_s,speed_mps,heading"),
                   {"yaw_rate_radps", "steering_rad", "wheelbase_m", "heading"}));
}

TEST(OdometryFile, ReadsWhatRosWrites) {
  const TemporaryFolder folder;
  const OdometryFile echo = read_odometry(folder.write(
      "o.csv",
      "%time,field.header.seq,field.header.stamp,field.header.frame_id,"
      "field.twist.twist.linear.x,field.twist.twist.linear.y,field.twist.twist.angular.z\n"
      "1700000000000000000,1,1700000000000000000,odom,1.5,0,-0.25\n"
      "1700000000100000000,2,1700000000100000000,odom,1.5,0,-0.25\n"));
  ASSERT_EQ(echo.samples.size(), 2U);
  EXPECT_EQ(echo.samples[1].t_us, 1700000000100000);
  EXPECT_FLOAT_EQ(echo.samples[1].speed_mps, 1.5F);
  EXPECT_FLOAT_EQ(echo.samples[1].turn, -0.25F);
}

TEST(OdometryFile, UnitsOfTheHeaderAreConverted) {
  const TemporaryFolder folder;
  const OdometryFile odometry = read_odometry(
      folder.write("o.csv", "Yaw rate [deg/s],Speed (km/h),t_ms\n90,36,0\n-90,-36,500\n"));
  ASSERT_EQ(odometry.samples.size(), 2U);
  EXPECT_EQ(odometry.samples[1].t_us, 500000);
  EXPECT_FLOAT_EQ(odometry.samples[0].speed_mps, 10.0F);
  EXPECT_FLOAT_EQ(odometry.samples[1].turn, -1.5707963F);
  EXPECT_DOUBLE_EQ(odometry.model.period_s, 0.5);
}

}  // namespace
}  // namespace cairn::host

#include "host_sim/reports/verdict.hpp"

#include <gtest/gtest.h>

#include "input_messages.hpp"

namespace cairn::host {
namespace {

using nlohmann::json;

json good_summary() {
  return {{"frames", 200},
          {"tracked", 198},
          {"not_tracked", {{"no_depth", 2}}},
          {"lost", 0},
          {"relocalised", 0},
          {"interrupted_by", nullptr},
          {"input", {{"warnings", json::array()}, {"damaged", false}}},
          {"nees", {{"mean", 2.8}, {"dof", 3}}},
          {"nis", {{"mean", 38.0}, {"dof", 40.0}}},
          {"registration_px", {{"mean", 1.5}}},
          {"trajectory", {{"ate_rmse_m", 0.012}, {"aligned", "sim3"}}},
          {"latency_ms", {{"over_budget", 0.0}, {"budget", 41.57}, {"p99", 3.2}}}};
}

/// "grade text" of every point, a line each.
std::string text_of(const Verdict& verdict) {
  std::string text = verdict.headline + "\n";
  const json whole = to_json(verdict);
  for (const json& point : whole["points"]) {
    text += point["grade"].get<std::string>() + " " + point["text"].get<std::string>() + "\n";
  }
  return text;
}

TEST(Verdict, OfAGoodRun) {
  const std::string text = text_of(judge(good_summary(), 640));
  EXPECT_TRUE(says(text, {"Tracked well\n", "good Tracked in 198 of 200 frames (99.0 %)",
                          "in the others: no landmark yet whose distance is known (2)",
                          "good The covariance of the pose is right: NEES 2.8, 3",
                          "good Landmarks are where", "good Virtual objects stay in place",
                          "note Path 0.012 m (rms) from the truth, after the best similarity",
                          "good 0.00 % of the frames took longer than the budget of 41.57 ms"}));
  EXPECT_EQ(text.find("bad "), std::string::npos);
}

TEST(Verdict, NamesTheSuspectPartOfTheMount) {
  json summary = good_summary();
  const json right = {{"off", 0.2}, {"sigma", 0.3}, {"suspect", false}};
  summary["mount"] = {
      {"yaw_deg", right}, {"pitch_deg", right}, {"roll_deg", right}, {"focal_percent", right}};
  EXPECT_EQ(text_of(judge(summary, 640)).find("is off by"), std::string::npos);
  summary["mount"]["yaw_deg"] = {{"off", -4.8}, {"sigma", 0.3}, {"suspect", true}};
  EXPECT_TRUE(says(text_of(judge(summary, 640)),
                   {"Tracked, with reservations\nbad The camera's yaw", "off by -4.8 +- 0.3 deg"}));
}

TEST(Verdict, SaysWhenTheFocalLengthIsNotAsTold) {
  json summary = good_summary();
  const auto text_with = [&](double value, double sigma, double told) {
    summary["focal_scale"] = {{"value", value}, {"sigma", sigma}, {"told_sigma", told}};
    return text_of(judge(summary, 640));
  };
  EXPECT_TRUE(says(text_with(1.084, 0.012, 0.1),
                   {"note The focal length seems to be 8.4 % longer than told, +- 1.2 %"}));
  EXPECT_TRUE(says(text_with(0.9, 0.02, 0.2), {"seems to be 10.0 % shorter than told, +- 2.0 %"}));
  EXPECT_TRUE(says(text_with(1.02, 0.02, 0.2), {"good The focal length is as told: 2.0 % longer"}));
  EXPECT_TRUE(says(text_with(1.02, 0.12, 0.2), {"stays as guessed, +- 12 %"}));
  EXPECT_EQ(text_with(1.01, 0.01, 0.1).find("focal"), std::string::npos);
}

TEST(Verdict, SaysWhatIsWrongWithTheOdometrysYawRate) {
  json summary = good_summary();
  summary["odometry_yaw"] = {{"ratio", 0.97}, {"suspect", false}, {"suspect_frames", 0}};
  EXPECT_EQ(text_of(judge(summary, 640)).find("yaw rate"), std::string::npos);
  summary["odometry_yaw"] = {{"ratio", -0.98}, {"suspect", true}, {"suspect_frames", 90}};
  EXPECT_TRUE(says(text_of(judge(summary, 640)),
                   {"bad The odometry's yaw rate is not that of the pictures", "wrong sign"}));
  summary["odometry_yaw"]["ratio"] = 48.2;
  EXPECT_TRUE(says(text_of(judge(summary, 640)), {"in degrees per second"}));
  summary["odometry_yaw"] = {{"ratio", nullptr}, {"suspect", false}, {"suspect_frames", 12}};
  EXPECT_TRUE(says(text_of(judge(summary, 640)), {"note The odometry's yaw rate", "12 frames"}));
}

/// WHEN the direction of travel differs from the mount by more than three sigmas, THEN that is
/// said.
TEST(Verdict, SaysWhereTheVehicleDrives) {
  json summary = good_summary();
  const auto text_with = [&](double left_deg, double sigma_deg) {
    summary["travel"] = {{"left_deg", left_deg}, {"sigma_deg", sigma_deg}};
    return text_of(judge(summary, 640));
  };
  EXPECT_TRUE(
      says(text_with(0.42, 0.08), {"Tracked well",
                                   "note The vehicle drives 0.4 degrees to the left of where the "
                                   "camera's mount says, +- 0.08"}));
  EXPECT_TRUE(says(text_with(-0.31, 0.1), {"drives 0.3 degrees to the right of"}));
  EXPECT_EQ(text_with(-0.29, 0.1).find("drives"), std::string::npos);
  EXPECT_EQ(text_with(0.04, 0.01).find("drives"), std::string::npos) << "0.0 degrees is nothing";
  summary["travel"] = nullptr;
  EXPECT_EQ(text_of(judge(summary, 640)).find("drives"), std::string::npos);
}

TEST(Verdict, NamesWhatIsBadFirst) {
  json summary = good_summary();
  summary["nees"]["mean"] = 9.4;
  const std::string overconfident = text_of(judge(summary, 640));
  EXPECT_TRUE(
      says(overconfident, {"Tracked, with reservations\nbad The pose is further", "NEES 9.4"}));

  summary = good_summary();
  summary["nis"]["mean"] = 3.3;
  EXPECT_TRUE(
      says(text_of(judge(summary, 640)), {"Tracked well", "note Landmarks are nearer", "NIS 3.3"}));
  summary["nis"]["mean"] = 70.0;
  EXPECT_TRUE(says(text_of(judge(summary, 640)), {"bad Landmarks are further", "calibration"}));

  summary = good_summary();
  summary["registration_px"]["mean"] = 8.0;
  EXPECT_TRUE(
      says(text_of(judge(summary, 640)), {"bad Virtual objects drift", "8.00 px", "1.25 %"}));
  summary["latency_ms"]["over_budget"] = 0.02;
  EXPECT_TRUE(says(text_of(judge(summary, 640)), {"bad 2.00 % of the frames took longer"}));
  summary["input"]["warnings"] = {"no calibration: a guess", "covers 31 %"};
  EXPECT_TRUE(
      says(text_of(judge(summary, 640)), {"bad no calibration: a guess", "note covers 31 %"}));
  summary["input"]["damaged"] = true;
  summary["interrupted_by"] = 2;
  EXPECT_TRUE(
      says(text_of(judge(summary, 640)), {"bad Interrupted after 200", "bad The input ended"}));
}

TEST(Verdict, OfARunThatDidNotTrack) {
  json summary = good_summary();
  for (const char* key : {"nees", "nis", "registration_px"}) summary[key]["mean"] = nullptr;
  summary["trajectory"]["ate_rmse_m"] = nullptr;
  summary["tracked"] = 120;
  summary["lost"] = 40;
  EXPECT_TRUE(
      says(text_of(judge(summary, 640)), {"Tracked in part\nbad Tracked in 120 of 200",
                                          "note The pose was lost in 40", "note No truth"}));
  summary["tracked"] = 10;
  EXPECT_TRUE(says(text_of(judge(summary, 640)), {"Not tracked\n"}));
  summary["frames"] = 0;
  EXPECT_TRUE(says(text_of(judge(summary, 640)), {"Not tracked\n"}));
}

TEST(Verdict, AStartOfASecondIsSaidAndNotHeldAgainstTheRun) {
  json summary = good_summary();
  summary["frames"] = 51;
  summary["tracked"] = 48;
  EXPECT_TRUE(says(text_of(judge(summary, 640)), {"Tracked in part\nbad Tracked in 48 of 51"}));
  summary["start"] = {{"frames", 3}, {"s", 0.3}};
  EXPECT_TRUE(says(text_of(judge(summary, 640)),
                   {"Tracked well\n",
                    "good Tracked in 48 of 51 frames (94.1 %, 100.0 % after the start); in the"}));
  summary["start"]["s"] = 1.1;
  EXPECT_TRUE(says(text_of(judge(summary, 640)), {"Tracked in part\nbad Tracked in 48 of 51"}));
  summary["start"] = nullptr;
  EXPECT_TRUE(says(text_of(judge(summary, 640)), {"Tracked in part\nbad Tracked in 48 of 51"}));
}

TEST(Verdict, SaysWhyACameraInTheHandFailed) {
  json summary = good_summary();
  summary["mode"] = "handheld";
  summary["tracked"] = 0;
  summary["not_tracked"] = {{"low_texture", 200}};
  EXPECT_TRUE(says(text_of(judge(summary, 640)),
                   {"Not tracked\n", "too little to see for a start (dark, blank", "(200)",
                    "note A start needs a picture with texture"}));
  summary["tracked"] = 120;
  summary["lost"] = 80;
  summary["not_tracked"] = {{"lost", 80}};
  const std::string lost = text_of(judge(summary, 640));
  EXPECT_TRUE(says(lost, {"in the others: lost (80)", "note A camera in the hand is lost where"}));
  EXPECT_EQ(lost.find("A start needs"), std::string::npos);
  summary["mode"] = "vehicle";
  EXPECT_EQ(text_of(judge(summary, 640)).find("in the hand"), std::string::npos);
}

TEST(Verdict, SaysWhatAnUncertainPoseRestsOn) {
  json summary = good_summary();
  summary["mode"] = "handheld";
  summary["uncertain"] = {{"frames", 50}, {"extrapolated", 0}};
  const std::string few = text_of(judge(summary, 640));
  EXPECT_EQ(few.find("uncertain"), std::string::npos);
  EXPECT_EQ(few.find("extrapolated"), std::string::npos);
  summary["uncertain"] = {{"frames", 150}, {"extrapolated", 0}};
  EXPECT_TRUE(says(text_of(judge(summary, 640)), {"Tracked, with reservations\nbad In 150 of the",
                                                  "only while the camera moves sideways"}));
  summary["uncertain"] = {{"frames", 50}, {"extrapolated", 5}};
  EXPECT_TRUE(says(text_of(judge(summary, 640)), {"Tracked well", "note In 5 of the tracked"}));
  summary["uncertain"]["extrapolated"] = 30;
  EXPECT_TRUE(says(text_of(judge(summary, 640)), {"bad In 30 of the tracked frames too few"}));
}

TEST(Verdict, TellsOtherProgramsFromASlowTracker) {
  json summary = good_summary();
  json& latency = summary["latency_ms"];
  latency["over_budget"] = 0.03;
  latency["on_core"] = {{"over_budget", 0.0}, {"p99", 4.2}};
  const std::string busy = text_of(judge(summary, 640));
  EXPECT_TRUE(says(busy, {"Tracked well", "note Other programs held this machine up", "3.00 %",
                          "99 % at most 4.20 ms"}));
  latency["on_core"]["over_budget"] = 0.02;
  EXPECT_TRUE(says(text_of(judge(summary, 640)), {"bad 3.00 % of the frames took longer"}));
}

}  // namespace
}  // namespace cairn::host

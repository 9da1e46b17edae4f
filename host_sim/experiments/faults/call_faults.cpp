#include <fmt/format.h>

#include "host_sim/experiments/faults/fault_classes.hpp"
#include "host_sim/experiments/faults/fault_scene.hpp"
#include "host_sim/experiments/faults/pictures.hpp"

namespace cairn::host {
namespace {

FaultOutcome wrong_size(const FaultScene& scene, const std::string& what, const cv::Mat& picture) {
  FaultJudge judge(FaultComponent::kFrames, FaultMode::kGarbage, what + " for 1 s",
                   "each refused as invalid_argument, the state unchanged, not lost");
  const FaultDrive drive = scene.drive(
      kOneSecond, [&picture](int /*k*/, FaultStep& step) { step.frame.grey = picture; });
  describe(judge, drive);
  expect_honest(judge, drive);
  judge.expect(drive.refused == kOneSecond, fmt::format("{} refused", drive.refused));
  const auto status = drive.statuses.find("invalid_argument");
  judge.expect(status != drive.statuses.end() && status->second == kOneSecond,
               "not by invalid_argument");
  return judge.outcome();
}

}  // namespace

FaultOutcomes inject_wrong_pictures(const FaultScene& scene) {
  const cv::Mat picture = scene.frames().front().grey;
  const int width = picture.cols;
  const int height = picture.rows;
  return {wrong_size(scene, "no picture", cv::Mat()),
          wrong_size(scene, "one row less", picture(cv::Rect(0, 0, width, height - 1)).clone()),
          wrong_size(scene, "one column less", picture(cv::Rect(0, 0, width - 1, height)).clone()),
          wrong_size(scene, "twice the size", cv::Mat(2 * height, 2 * width, CV_8UC1, {90})),
          wrong_size(scene, "one pixel", cv::Mat(1, 1, CV_8UC1, {90}))};
}

FaultOutcomes inject_short_work(const FaultScene& scene) {
  FaultOutcomes outcomes;
  const int usual = scene.settings().work_limit;
  for (const int limit : {0, usual / 50, usual / 10}) {
    FaultJudge judge(FaultComponent::kWork, FaultMode::kSlow,
                     fmt::format("{} units of work a frame for 1 s", limit),
                     "a pose in every frame, counted, back to normal within 5 frames");
    const std::unique_ptr<Tracker> tracker = scene.tracker();
    int answered = 0;
    int frames = 0;
    const FaultDrive drive =
        scene.drive(*tracker, scene.settings().from, kOneSecond + 1, [&](int k, FaultStep&) {
          ++frames;
          static_cast<void>(tracker->set_work_limit(k < kOneSecond ? limit : usual));
        });
    answered = drive.frames - drive.refused;
    describe(judge, drive);
    judge.saw(fmt::format("most work {}", drive.most_work));
    expect_honest(judge, drive);
    judge.expect(answered == drive.frames, "frames without a pose");
    judge.expect(drive.grown.budget_exceeded > 0 || limit >= usual / 10, "not counted");
    judge.expect(drive.frames_to_return >= 0 && drive.frames_to_return <= 5,
                 "not back within 5 frames");
    outcomes.push_back(judge.outcome());
  }
  return outcomes;
}

FaultOutcomes inject_standing(const FaultScene& scene) {
  FaultJudge judge(FaultComponent::kFrames, FaultMode::kStuck,
                   "the vehicle stands, pictures with fresh noise, to the end",
                   "positive definite in every frame, not lost, never tracking while wrong");
  const std::vector<Frame>& frames = scene.frames();
  const Frame& still = frames[static_cast<std::size_t>(scene.settings().from - 1)];
  const std::uint64_t seed = scene.settings().seed;
  const FaultDrive drive = scene.drive(scene.rest(), [&](int k, FaultStep& step) {
    step.frame.grey = grain(still.grey, seed + static_cast<std::uint64_t>(k));
    step.frame.true_T_world_camera = still.true_T_world_camera;
    step.frame.true_T_world_vehicle = still.true_T_world_vehicle;
    for (OdometrySample& sample : step.frame.odometry) sample.speed_mps = 0.0F;
  });
  describe(judge, drive);
  expect_honest(judge, drive);
  judge.expect(drive.losses == 0, "lost");
  return {judge.outcome()};
}

}  // namespace cairn::host

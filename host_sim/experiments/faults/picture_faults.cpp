#include <algorithm>

#include <fmt/format.h>

#include "host_sim/experiments/faults/fault_classes.hpp"
#include "host_sim/experiments/faults/fault_scene.hpp"
#include "host_sim/experiments/faults/pictures.hpp"

namespace cairn::host {
namespace {

constexpr const char* kHonestInWork = "never tracking while wrong; work within the limit";

using PictureChange = std::function<cv::Mat(int k, const cv::Mat& picture)>;

Injection show(const PictureChange& change) {
  return [change](int k, FaultStep& step) { step.frame.grey = change(k, step.frame.grey); };
}

FaultJudge frames_judge(FaultMode mode, const std::string& injected, const std::string& expected) {
  return {FaultComponent::kFrames, mode, injected, expected};
}

/// Pictures changed for two seconds; what every drive must keep.
FaultOutcome honest_drive(const FaultScene& scene, FaultMode mode, const std::string& injected,
                          const PictureChange& change) {
  FaultJudge judge = frames_judge(mode, injected + " for 2 s", kHonestInWork);
  const FaultDrive drive = scene.drive(kTwoSeconds, show(change));
  describe(judge, drive);
  return expect_honest(judge, drive).outcome();
}

FaultOutcome drop(const FaultScene& scene, int count) {
  const bool few = count <= 10;
  FaultJudge judge = frames_judge(
      FaultMode::kOff, fmt::format("{} frame(s) dropped in a row", count),
      few ? "not lost, never tracking while wrong" : "back within 2 s, never tracking while wrong");
  const FaultDrive drive =
      scene.drive(count, [](int /*k*/, FaultStep& step) { step.dropped = true; });
  describe(judge, drive);
  expect_honest(judge, drive);
  if (few) judge.expect(drive.losses == 0, "lost");
  if (!few) {
    judge.expect(drive.frames_to_return >= 0 && drive.frames_to_return <= kTwoSeconds,
                 "not back within 2 s");
  }
  return judge.outcome();
}

}  // namespace

FaultOutcomes inject_dropped_frames(const FaultScene& scene) {
  FaultOutcomes outcomes = {drop(scene, 1), drop(scene, 10), drop(scene, 100)};
  FaultJudge judge = frames_judge(FaultMode::kIntermittent, "each 3rd frame dropped for 2 s",
                                  "not lost, never tracking while wrong");
  const FaultDrive drive =
      scene.drive(kTwoSeconds, [](int k, FaultStep& step) { step.dropped = k % 3 == 2; });
  describe(judge, drive);
  outcomes.push_back(expect_honest(judge, drive).expect(drive.losses == 0, "lost").outcome());
  FaultJudge slow = frames_judge(FaultMode::kSlow, "one frame in four for 2 s",
                                 "not lost, never tracking while wrong");
  const FaultDrive slowly =
      scene.drive(kTwoSeconds, [](int k, FaultStep& step) { step.dropped = k % 4 != 0; });
  describe(slow, slowly);
  outcomes.push_back(expect_honest(slow, slowly).expect(slowly.losses == 0, "lost").outcome());
  return outcomes;
}

FaultOutcomes inject_blind_frames(const FaultScene& scene) {
  const std::uint64_t seed = scene.settings().seed;
  FaultOutcomes outcomes = {
      honest_drive(scene, FaultMode::kOff, "black",
                   [](int, const cv::Mat& picture) { return flat(picture, 0); }),
      honest_drive(scene, FaultMode::kWrong, "white",
                   [](int, const cv::Mat& picture) { return flat(picture, 255); }),
      honest_drive(scene, FaultMode::kWrong, "a tenth of the light",
                   [](int, const cv::Mat& picture) { return dimmed(picture, 0.1); }),
      honest_drive(scene, FaultMode::kGarbage, "noise", [seed](int k, const cv::Mat& picture) {
        return noise(picture, seed + static_cast<std::uint64_t>(k));
      })};
  FaultJudge judge = frames_judge(FaultMode::kStuck, "frozen picture for 2 s",
                                  "repeated pictures counted, never tracking while wrong");
  cv::Mat frozen;
  const FaultDrive drive = scene.drive(kTwoSeconds, [&frozen](int k, FaultStep& step) {
    if (k == 0) frozen = step.frame.grey;
    step.frame.grey = frozen;
  });
  describe(judge, drive);
  expect_honest(judge, drive);
  if (scene.vehicle()) judge.expect(drive.grown.repeated_images > 0, "not counted");
  outcomes.push_back(judge.outcome());
  return outcomes;
}

FaultOutcomes inject_corrupted_frames(const FaultScene& scene) {
  const std::uint64_t seed = scene.settings().seed;
  cv::Mat before;
  const auto from = static_cast<std::size_t>(scene.settings().from);
  const auto other = scene.frames()[from / 2].grey;
  return {honest_drive(scene, FaultMode::kGarbage, "torn: the lower half is the last frame's",
                       [&before](int, const cv::Mat& picture) {
                         const cv::Mat result = before.empty() ? picture : torn(picture, before);
                         before = picture;
                         return result;
                       }),
          honest_drive(scene, FaultMode::kGarbage, "torn: the lower half is of another place",
                       [other](int, const cv::Mat& picture) { return torn(picture, other); }),
          honest_drive(scene, FaultMode::kGarbage, "rows shifted by a wrong stride",
                       [](int, const cv::Mat& picture) { return skewed(picture); }),
          honest_drive(scene, FaultMode::kGarbage, "one bit in 100 pixels flipped",
                       [seed](int k, const cv::Mat& picture) {
                         return flipped_bits(picture, picture.rows * picture.cols / 100,
                                             seed + static_cast<std::uint64_t>(k));
                       }),
          honest_drive(scene, FaultMode::kOff, "left half black",
                       [](int, const cv::Mat& picture) { return half_black(picture); }),
          honest_drive(scene, FaultMode::kStuck, "dirt on the lens",
                       [](int, const cv::Mat& picture) { return dirty(picture); })};
}

FaultOutcomes inject_aliases(const FaultScene& scene) {
  const cv::Mat first = scene.frames()[static_cast<std::size_t>(scene.settings().from / 2)].grey;
  const std::uint64_t seed = scene.settings().seed;
  return {honest_drive(scene, FaultMode::kWrong, "checkerboard",
                       [seed](int k, const cv::Mat& picture) {
                         return grain(checkerboard(picture, 16),
                                      seed + static_cast<std::uint64_t>(k));
                       }),
          honest_drive(scene, FaultMode::kWrong, "one tile repeated",
                       [](int, const cv::Mat& picture) { return tiled(picture, 40); }),
          honest_drive(scene, FaultMode::kWrong, "mirrored",
                       [](int, const cv::Mat& picture) { return mirrored(picture); }),
          honest_drive(scene, FaultMode::kWrong, "a picture of an earlier place, with fresh noise",
                       [first, seed](int k, const cv::Mat&) {
                         return grain(first, seed + static_cast<std::uint64_t>(k));
                       })};
}

FaultOutcomes inject_flicker(const FaultScene& scene) {
  constexpr int kFlicker = 120;
  constexpr int kMostLosses = 4;  // each takes half a second of darkness
  FaultJudge judge =
      frames_judge(FaultMode::kIntermittent, "black and light, half a second each, for 4 s",
                   "at most one loss a second, no reset, never tracking while wrong");
  const FaultDrive drive = scene.drive(kFlicker, [](int k, FaultStep& step) {
    if (k / 15 % 2 == 0) step.frame.grey = flat(step.frame.grey, 0);
  });
  describe(judge, drive);
  expect_honest(judge, drive);
  judge.saw(fmt::format("{} losses", drive.losses));
  judge.expect(drive.losses <= kMostLosses, fmt::format("{} losses", drive.losses));
  judge.expect(drive.grown.resets == 0, "reset");
  return {judge.outcome()};
}

FaultOutcomes inject_kidnapping(const FaultScene& scene) {
  const int length = scene.settings().brief ? 60 : 100;
  const auto cut = [&](const char* injected, FaultMode mode, const Injection& injection) {
    FaultJudge judge =
        frames_judge(mode, fmt::format("{} for {} frames", injected, length),
                     "said; never tracking while wrong; the return is reported, not promised");
    const FaultDrive drive = scene.drive(length, injection);
    describe(judge, drive);
    expect_honest(judge, drive);
    const auto tracking = drive.states.find("tracking");
    const int sure = tracking == drive.states.end() ? 0 : tracking->second;
    judge.expect(sure < drive.frames - length / 2, "said nothing");
    return judge.outcome();
  };
  const std::vector<Frame>& frames = scene.frames();
  return {cut("black", FaultMode::kOff,
              [](int, FaultStep& step) { step.frame.grey = flat(step.frame.grey, 0); }),
          cut("the drive's first pictures, backwards", FaultMode::kWrong,
              [&frames, length](int k, FaultStep& step) {
                const auto i = static_cast<std::size_t>(std::max(0, length - k));
                step.frame.grey = frames[std::min(i, frames.size() - 1)].grey;
              })};
}

}  // namespace cairn::host

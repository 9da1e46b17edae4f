#include "host_sim/reports/verdict.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "host_sim/base/names.hpp"

namespace cairn::host {
namespace {

using nlohmann::json;

constexpr double kEnoughTracked = 0.95;
constexpr double kSomeTracked = 0.5;
constexpr double kMostOverBudget = 0.01;
constexpr double kLongestStart_s = 1.0;  // up to which a start is said and not judged
constexpr double kMostExtrapolated = 0.05;
constexpr double kMostUncertain = 0.5;
constexpr double kNeesTooLarge = 2.0;  // over its degrees of freedom
constexpr double kNeesSmall = 0.3;
constexpr double kNisTooLarge = 1.5;
constexpr double kNisSmall = 0.3;
constexpr double kFocalSigmas = 3.0;
constexpr double kLeastFocalPercent = 1.0;
constexpr double kGuessPercent = 15.0;  // sigma of what is no calibration
constexpr double kTravelSigmas = 3.0;
constexpr double kLeastTravelDegrees = 0.05;  // what is written as 0.1
constexpr double kMostRegistration = 0.01;    // of the picture's width

constexpr const char* kWhyLost =
    "A camera in the hand is lost where it turns or moves faster than the landmarks can be "
    "followed, "
    "where little is in the picture, or where it is dark, blurred or covered: move slower there";
constexpr const char* kWhyNoStart =
    "A start needs a picture with texture, sharp and lit, and a camera that moves sideways";

/// A reason of `not_tracked` for people.
std::string words_of(const std::string& reason) {
  constexpr std::pair<const char*, const char*> kWords[] = {
      {"no_odometry", "no odometry yet"},
      {"no_new_image", "the same picture again"},
      {"no_work", "the work limit left nothing for it"},
      {"no_corners", "no corners in the picture (dark, blank, blurred or covered?)"},
      {"seeds_lost", "new points were lost before their distance was known"},
      {"no_depth", "no landmark yet whose distance is known"},
      {"not_found", "the landmarks were not found where they were expected"},
      {"no_consensus", "the landmarks found did not agree with one another"},
      {"low_texture", "too little to see for a start (dark, blank, blurred or covered?)"},
      {"starting", "before the start"},
      {"lost", "lost"},
      {"lost_low_texture", "lost, with too little to see"}};
  for (const auto& [key, words] : kWords) {
    if (reason == key) return words;
  }
  return reason;
}

class Judge {
 public:
  Judge(const json& summary, int image_width) : summary_(summary), image_width_(image_width) {}

  Verdict judge() {
    judge_inputs();
    judge_tracking();
    judge_mount();
    judge_ground();
    judge_focal();
    judge_yaw();
    judge_travel();
    judge_gyro();
    judge_consistency();
    judge_errors();
    judge_budget();
    Verdict verdict{headline(), std::move(points_)};
    std::stable_sort(
        verdict.points.begin(), verdict.points.end(),
        [](const VerdictPoint& a, const VerdictPoint& b) { return a.grade > b.grade; });
    return verdict;
  }

 private:
  template <class... Arguments>
  void say(Grade grade, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    points_.push_back({grade, fmt::format(format, std::forward<Arguments>(arguments)...)});
  }

  double tracked_share() const {
    const auto frames = summary_["frames"].get<double>();
    return frames > 0.0 ? summary_["tracked"].get<double>() / frames : 0.0;
  }

  /// Frames of a start that took no longer than one may.
  int start_frames() const {
    if (!summary_.contains("start") || summary_["start"].is_null()) return 0;
    const json& start = summary_["start"];
    return start["s"].get<double>() <= kLongestStart_s ? start["frames"].get<int>() : 0;
  }

  /// Of the frames after the start.
  double share_after_start() const {
    const double frames = summary_["frames"].get<double>() - start_frames();
    return frames > 0.0 ? summary_["tracked"].get<double>() / frames : 0.0;
  }

  std::string headline() const {
    const double share = share_after_start();
    const bool bad = std::any_of(points_.begin(), points_.end(), [](const VerdictPoint& point) {
      return point.grade == Grade::kBad;
    });
    if (share >= kEnoughTracked) return bad ? "Tracked, with reservations" : "Tracked well";
    return share >= kSomeTracked ? "Tracked in part" : "Not tracked";
  }

  void judge_inputs() {
    const json& input = summary_["input"];
    if (!summary_["interrupted_by"].is_null()) {
      say(Grade::kBad, "Interrupted after {} frames", summary_["frames"].get<int>());
    }
    if (input["damaged"].get<bool>()) say(Grade::kBad, "The input ended early: it is damaged");
    for (const json& warning : input["warnings"]) {
      const auto text = warning.get<std::string>();
      say(text.rfind("no calibration", 0) == 0 ? Grade::kBad : Grade::kNote, "{}", text);
    }
  }

  void judge_tracking() {
    std::string reasons;
    for (const auto& [reason, frames] : summary_["not_tracked"].items()) {
      reasons += fmt::format("{}{} ({})", reasons.empty() ? "" : ", ", words_of(reason),
                             frames.get<int>());
    }
    const double share = tracked_share();
    const int start = start_frames();
    say(share_after_start() >= kEnoughTracked ? Grade::kGood : Grade::kBad,
        "Tracked in {} of {} frames ({:.1f} %{}){}", summary_["tracked"].get<int>(),
        summary_["frames"].get<int>(), 100.0 * share,
        start > 0 ? fmt::format(", {:.1f} % after the start", 100.0 * share_after_start()) : "",
        share < 1.0 && !reasons.empty() ? "; in the others: " + reasons : std::string());
    judge_uncertain();
    if (const int lost = summary_["lost"].get<int>(); lost > 0) {
      say(Grade::kNote, "The pose was lost in {} frames and found again {} times", lost,
          summary_["relocalised"].get<int>());
      if (is_handheld()) say(Grade::kNote, "{}", kWhyLost);
    }
    if (is_handheld() && summary_["tracked"].get<int>() == 0) {
      say(Grade::kNote, "{}", kWhyNoStart);
    }
  }

  bool is_handheld() const { return summary_.value("mode", "") == "handheld"; }

  void judge_uncertain() {
    if (!summary_.contains("uncertain")) return;
    const auto frames = summary_["tracked"].get<double>();
    const int extrapolated = summary_["uncertain"]["extrapolated"].get<int>();
    const int uncertain = summary_["uncertain"]["frames"].get<int>();
    if (extrapolated > 0) {
      say(extrapolated > kMostExtrapolated * frames ? Grade::kBad : Grade::kNote,
          "In {} of the tracked frames too few landmarks were found again: the pose there is "
          "extrapolated from the motion before",
          extrapolated);
    }
    if (is_handheld() && uncertain - extrapolated > kMostUncertain * frames) {
      say(Grade::kBad,
          "In {} of the tracked frames the pose is called uncertain: distances show only while the "
          "camera moves sideways",
          uncertain);
    }
  }

  void judge_mount() {
    struct Part {
      const char* key;
      const char* name;
      const char* unit;
    };
    constexpr Part kParts[] = {
        {"yaw_deg", "yaw on the vehicle (or the principal point's column)", "deg"},
        {"pitch_deg", "pitch on the vehicle (or the principal point's row)", "deg"},
        {"roll_deg", "roll on the vehicle", "deg"},
        {"focal_percent", "focal length (or the odometry's yaw rate)", "%"}};
    if (!summary_.contains("mount") || summary_["mount"].is_null()) return;
    for (const Part& part : kParts) {
      const json& offset = summary_["mount"][part.key];
      if (!offset["suspect"].get<bool>()) continue;
      say(Grade::kBad, "The camera's {} is off by {:+.1f} +- {:.1f} {}", part.name,
          offset["off"].get<double>(), offset["sigma"].get<double>(), part.unit);
    }
  }

  void judge_ground() {
    if (!summary_.contains("ground") || summary_["ground"].is_null()) return;
    const json& ground = summary_["ground"];
    if (ground["suspect"].get<bool>()) {
      say(Grade::kBad,
          "By the pictures the ground lies {:.2f} times as far below the camera as its height "
          "says: "
          "the speed is in another unit (km/h for m/s: 3.6), or the camera's height is wrong",
          ground["ratio"].get<double>());
    } else if (const int frames = ground["suspect_frames"].get<int>(); frames > 0) {
      say(Grade::kNote,
          "Speed or camera height did not fit the ground in {} frames, and do at the end", frames);
    }
  }

  /// Said where it is not as told, or where what was told was a guess that the motion confirmed.
  void judge_focal() {
    if (!summary_.contains("focal_scale") || summary_["focal_scale"].is_null()) return;
    const json& focal = summary_["focal_scale"];
    const double off = 100.0 * (focal["value"].get<double>() - 1.0);
    const double sigma = 100.0 * focal["sigma"].get<double>();
    const double told = 100.0 * focal["told_sigma"].get<double>();
    const char* const which = off < 0.0 ? "shorter" : "longer";
    if (std::abs(off) > kFocalSigmas * sigma && std::abs(off) > kLeastFocalPercent) {
      say(Grade::kNote,
          "The focal length seems to be {:.1f} % {} than told, +- {:.1f} %; it was tracked with "
          "that",
          std::abs(off), which, sigma);
    } else if (told > kGuessPercent && sigma < 0.5 * told) {
      say(Grade::kGood, "The focal length is as told: {:.1f} % {}, +- {:.1f} %", std::abs(off),
          which, sigma);
    } else if (told > kGuessPercent) {
      say(Grade::kNote,
          "The motion does not show the focal length: it stays as guessed, +- {:.0f} %", sigma);
    }
  }

  void judge_yaw() {
    if (!summary_.contains("odometry_yaw") || summary_["odometry_yaw"].is_null()) return;
    const json& yaw = summary_["odometry_yaw"];
    const int frames = yaw["suspect_frames"].get<int>();
    if (frames == 0) return;
    const double ratio = yaw["ratio"].is_null() ? 0.0 : yaw["ratio"].get<double>();
    if (yaw["suspect"].get<bool>()) {
      say(Grade::kBad, "The odometry's yaw rate is not that of the pictures: {}",
          meaning_of_yaw(ratio));
    } else {
      say(Grade::kNote,
          "The odometry's yaw rate was not that of the pictures in {} frames, and is at the end",
          frames);
    }
  }

  void judge_travel() {
    if (!summary_.contains("travel") || summary_["travel"].is_null()) return;
    const auto left = summary_["travel"]["left_deg"].get<double>();
    const auto sigma = summary_["travel"]["sigma_deg"].get<double>();
    if (std::abs(left) <= std::max(kTravelSigmas * sigma, kLeastTravelDegrees)) return;
    say(Grade::kNote,
        "The vehicle drives {:.1f} degrees to the {} of where the camera's mount says, +- {:.2f}; "
        "it was tracked with that",
        std::abs(left), left > 0.0 ? "left" : "right", sigma);
  }

  void judge_gyro() {
    if (!summary_.contains("gyro") || summary_["gyro"].is_null()) return;
    const json& gyro = summary_["gyro"];
    const auto trust = gyro["trust"].get<std::string>();
    if (trust == "contradicted") {
      say(Grade::kBad, "{}", gyro["meaning"].get<std::string>());
    } else if (trust == "unproven") {
      say(Grade::kNote, "{}", gyro["meaning"].get<std::string>());
    }
  }

  void judge_consistency() {
    const json& nees = summary_["nees"];
    if (!nees["mean"].is_null()) {
      const auto mean = nees["mean"].get<double>();
      const auto dof = nees["dof"].get<double>();
      if (mean > kNeesTooLarge * dof) {
        say(Grade::kBad,
            "The pose is further from the truth than its covariance says: NEES {:.1f}, {:.0f} is "
            "consistent",
            mean, dof);
      } else {
        say(mean < kNeesSmall * dof ? Grade::kNote : Grade::kGood,
            "The covariance of the pose is {}: NEES {:.1f}, {:.0f} is consistent",
            mean < kNeesSmall * dof ? "cautious" : "right", mean, dof);
      }
    }
    const json& nis = summary_["nis"];
    if (nis["mean"].is_null()) return;
    const auto mean = nis["mean"].get<double>();
    const auto dof = nis["dof"].get<double>();
    if (mean > kNisTooLarge * dof) {
      say(Grade::kBad,
          "Landmarks are further from where they were expected than the filter says (calibration, "
          "time stamps, mounting?): NIS {:.1f} at {:.1f} degrees of freedom",
          mean, dof);
    } else if (mean < kNisSmall * dof) {
      say(Grade::kNote,
          "Landmarks are nearer to where they were expected than the filter says: NIS {:.1f} at "
          "{:.1f} degrees of freedom",
          mean, dof);
    } else {
      say(Grade::kGood,
          "Landmarks are where the filter expects them: NIS {:.1f} at {:.1f} degrees "
          "of freedom",
          mean, dof);
    }
  }

  void judge_errors() {
    const json& registration = summary_["registration_px"]["mean"];
    if (!registration.is_null()) {
      const auto mean = registration.get<double>();
      const bool good = mean <= kMostRegistration * image_width_;
      say(good ? Grade::kGood : Grade::kBad,
          "Virtual objects {}: registration error {:.2f} px on average, {:.2f} % of the width",
          good ? "stay in place" : "drift", mean, 100.0 * mean / image_width_);
    }
    const json& trajectory = summary_["trajectory"];
    if (trajectory["ate_rmse_m"].is_null()) {
      say(Grade::kNote, "No truth to compare the path with");
    } else {
      say(Grade::kNote, "Path {:.3f} m (rms) from the truth{}",
          trajectory["ate_rmse_m"].get<double>(),
          trajectory["aligned"] == "sim3" ? ", after the best similarity" : "");
    }
  }

  void judge_budget() {
    const json& latency = summary_["latency_ms"];
    const auto over = latency["over_budget"].get<double>();
    const auto budget = latency["budget"].get<double>();
    const bool by_others = over > kMostOverBudget && latency.contains("on_core") &&
                           latency["on_core"]["over_budget"].get<double>() <= kMostOverBudget;
    if (by_others) {
      const json& on_core = latency["on_core"];
      say(Grade::kNote,
          "Other programs held this machine up: by the clock {:.2f} % of the frames took longer "
          "than "
          "the budget of {:g} ms, of the processor's time {:.2f} %, and 99 % at most {:.2f} ms",
          100.0 * over, budget, 100.0 * on_core["over_budget"].get<double>(),
          on_core["p99"].get<double>());
      return;
    }
    say(over <= kMostOverBudget ? Grade::kGood : Grade::kBad,
        "{:.2f} % of the frames took longer than the budget of {:g} ms on this machine; 99 % took "
        "at "
        "most {:.2f} ms",
        100.0 * over, budget, latency["p99"].get<double>());
  }

  const json& summary_;
  int image_width_;
  std::vector<VerdictPoint> points_;
};

const char* name_of(Grade grade) {
  switch (grade) {
    case Grade::kGood:
      return "good";
    case Grade::kBad:
      return "bad";
    case Grade::kNote:
      break;
  }
  return "note";
}

}  // namespace

Verdict judge(const json& summary, int image_width) {
  return Judge(summary, image_width).judge();
}

json to_json(const Verdict& verdict) {
  json points = json::array();
  for (const VerdictPoint& point : verdict.points) {
    points.push_back({{"grade", name_of(point.grade)}, {"text", point.text}});
  }
  return {{"headline", verdict.headline}, {"points", points}};
}

}  // namespace cairn::host

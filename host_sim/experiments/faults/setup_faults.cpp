#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "host_sim/experiments/faults/fault_classes.hpp"
#include "host_sim/experiments/faults/fault_files.hpp"
#include "host_sim/experiments/faults/fault_scene.hpp"
#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/running/mount_run.hpp"

namespace cairn::host {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegree = kPi<double> / 180.0;

using Setup = std::function<void(SourceInfo&)>;

/// A calibration or a mount that no tracker may start with.
FaultOutcome refused_setup(const FaultScene& scene, FaultComponent component, const char* what,
                           const Setup& change) {
  FaultJudge judge(component, FaultMode::kGarbage, what, "refused before the first frame");
  SourceInfo info = scene.info();
  change(info);
  std::string message = "accepted";
  try {
    static_cast<void>(make_tracker(scene.options(), info));
  } catch (const InputError& error) {
    message = error.what();
  }
  judge.saw(message);
  return judge.expect(message != "accepted", "accepted").outcome();
}

void say_suspicions(FaultJudge& judge, const std::optional<MountOffset>& offset) {
  if (!offset.has_value()) return;
  for (int part = 0; part < MountOffset::kParts; ++part) {
    if (!offset->suspect[part]) continue;
    judge.saw("suspect: " + describe(*offset, static_cast<MountOffset::Part>(part)));
  }
}

void say_suspicion(FaultJudge& judge, const std::optional<GroundCheck>& ground) {
  if (!ground.has_value() || !ground->suspect()) return;
  judge.saw(fmt::format("suspect: ground {:.2f} camera heights below the camera", ground->ratio()));
}

/// One that can be meant and is wrong. Told and not promised: MountCheck sees the angles, and a
/// focal length only as well as odometry knows the yaw; GroundCheck the camera's height.
FaultOutcome wrong_setup(const FaultScene& scene, FaultComponent component, const char* what,
                         const Setup& change) {
  FaultJudge judge(component, FaultMode::kWrong, what,
                   "finite and positive definite; what it claims is reported");
  SourceInfo info = scene.info();
  change(info);
  const int first = scene.settings().brief ? scene.settings().from / 2 : 0;
  TrackerOptions options = scene.options();
  start_at(scene.frames()[static_cast<std::size_t>(first)], options);
  const std::unique_ptr<Tracker> tracker = make_tracker(options, info);
  const FaultDrive drive = scene.drive(*tracker, first, 0, Injection());
  describe(judge, drive);
  if (drive.not_finite + drive.not_positive > 0) {
    return judge.expect(false, "not finite or not positive definite").outcome();
  }
  judge.saw(fmt::format("{} of {} frames say tracking outside 99.99 %", drive.false_claims,
                        drive.frames));
  say_suspicions(judge, tracker->mount_offset());
  say_suspicion(judge, tracker->ground());
  return judge.reported();
}

/// A camera file whose text a reader must refuse, naming `key`.
FaultOutcome refused_file(const char* what, const std::string& text, const char* key) {
  FaultJudge judge(FaultComponent::kCalibration, FaultMode::kGarbage,
                   fmt::format("camera file: {}", what), fmt::format("refused, naming {}", key));
  const FaultFile file("camera.yaml", text);
  std::string message = "accepted";
  try {
    static_cast<void>(read_camera_file(file.path()));
  } catch (const InputError& error) {
    message = file.without_folder(error.what());
  }
  judge.saw(message);
  return judge.expect(message.find(key) != std::string::npos, "not named").outcome();
}

FaultOutcomes refused_setups(const FaultScene& scene) {
  const auto calibration = [&](const char* what, const Setup& change) {
    return refused_setup(scene, FaultComponent::kCalibration, what, change);
  };
  FaultOutcomes outcomes = {
      calibration("fx = 0", [](SourceInfo& s) { s.camera.fx = 0.0; }),
      calibration("fy negative", [](SourceInfo& s) { s.camera.fy = -s.camera.fy; }),
      calibration("fx NaN", [](SourceInfo& s) { s.camera.fx = kNan; }),
      calibration("cx outside of the picture",
                  [](SourceInfo& s) { s.camera.cx = 2.0 * s.camera.width; }),
      calibration("a distortion that folds", [](SourceInfo& s) { s.camera.k1 = -2.0; }),
      calibration("no size", [](SourceInfo& s) { s.camera.width = 0; }),
      refused_file("no fx", "fy: 250\ncx: 160\ncy: 120\nwidth: 320\nheight: 240\n", "fx"),
      refused_file("fx is no number",
                   "fx: abc\nfy: 250\ncx: 160\ncy: 120\nwidth: 320\nheight: 240\n", "fx"),
      refused_file("cx outside", "fx: 250\nfy: 250\ncx: 900\ncy: 120\nwidth: 320\nheight: 240\n",
                   "principal"),
  };
  if (scene.vehicle()) {
    outcomes.push_back(refused_setup(scene, FaultComponent::kMount, "mount NaN", [](SourceInfo& s) {
      s.T_vehicle_camera.translation.x() = kNan;
    }));
    outcomes.push_back(
        refused_setup(scene, FaultComponent::kMount, "mount rotation without length",
                      [](SourceInfo& s) { s.T_vehicle_camera.rotation.coeffs().setZero(); }));
  }
  return outcomes;
}

/// Turned about the camera's own axis `axis` by `angle`.
void turn(SourceInfo& info, const Vector3<double>& axis, double angle) {
  info.T_vehicle_camera.rotation =
      info.T_vehicle_camera.rotation * rotation_exp(Vector3<double>(angle * axis));
}

}  // namespace

FaultOutcomes inject_bad_calibration(const FaultScene& scene) {
  FaultOutcomes outcomes = refused_setups(scene);
  const auto wrong = [&](FaultComponent component, const char* what, const Setup& change) {
    outcomes.push_back(wrong_setup(scene, component, what, change));
  };
  wrong(FaultComponent::kCalibration, "focal length 5 % too long", [](SourceInfo& s) {
    s.camera.fx *= 1.05;
    s.camera.fy *= 1.05;
  });
  if (scene.settings().brief) return outcomes;
  wrong(FaultComponent::kCalibration, "principal point 3 % of the width off",
        [](SourceInfo& s) { s.camera.cx += 0.03 * s.camera.width; });
  wrong(FaultComponent::kCalibration, "barrel taken for pincushion",
        [](SourceInfo& s) { s.camera.k1 += 0.1; });
  if (!scene.vehicle()) return outcomes;
  wrong(FaultComponent::kMount, "camera 20 % too high",
        [](SourceInfo& s) { s.T_vehicle_camera.translation.z() *= 1.2; });
  wrong(FaultComponent::kMount, "pitch 2 deg off",
        [](SourceInfo& s) { turn(s, Vector3<double>::UnitX(), 2.0 * kDegree); });
  wrong(FaultComponent::kMount, "yaw 5 deg off",
        [](SourceInfo& s) { turn(s, Vector3<double>::UnitY(), 5.0 * kDegree); });
  return outcomes;
}

}  // namespace cairn::host

#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cairn::host {

class FaultScene;

/// What a fault is put into.
enum class FaultComponent : std::uint8_t {
  kFrames,
  kOdometry,
  kGyro,
  kTime,
  kCalibration,
  kMount,
  kMap,
  kLog,
  kWork,
  kMemory,
  kCalls,
};

/// How it fails, in the usual words of failure injection.
enum class FaultMode : std::uint8_t {
  kOff,
  kStuck,
  kGarbage,
  kWrong,
  kSlow,
  kDelayed,
  kIntermittent,
};

const char* to_string(FaultComponent component);
const char* to_string(FaultMode mode);

enum class FaultVerdict : std::uint8_t {
  kPass,
  kFail,
  kReported,  ///< a figure that is told and not promised
  kSkipped,   ///< the input has no such component
};

const char* to_string(FaultVerdict verdict);

/// One injection and what became of it.
struct FaultOutcome {
  std::string id;  ///< F01 to F24
  FaultComponent component = FaultComponent::kFrames;
  FaultMode mode = FaultMode::kOff;
  std::string injected;
  std::string expected;
  std::string seen;
  std::string counters;  ///< of Health, as they grew: "name +n"
  FaultVerdict verdict = FaultVerdict::kPass;
};

/// A class of faults: a row of the table in docs/results/faults.md.
struct FaultClass {
  const char* id;
  const char* title;
  std::vector<FaultOutcome> (*inject)(const FaultScene& scene);
};

/// F01 to F24, in this order.
const std::vector<FaultClass>& fault_classes();

/// Collects what does not hold of an outcome.
class FaultJudge {
 public:
  FaultJudge(FaultComponent component, FaultMode mode, std::string injected, std::string expected);

  /// `broken` says what is wrong where `holds` is false.
  FaultJudge& expect(bool holds, const std::string& broken);
  FaultJudge& saw(const std::string& figure);
  FaultJudge& counted(const std::string& counters);
  FaultOutcome outcome() const;
  /// The figures alone: nothing is promised of this one.
  FaultOutcome reported() const;
  /// Not injected, because `reason`.
  FaultOutcome skipped(const std::string& reason) const;

 private:
  FaultOutcome outcome_;
  std::string broken_;
};

}  // namespace cairn::host

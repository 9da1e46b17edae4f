#include "host_sim/experiments/faults/fault.hpp"

#include <utility>

namespace cairn::host {
namespace {

void append(std::string& list, const std::string& item) {
  if (item.empty()) return;
  if (!list.empty()) list += "; ";
  list += item;
}

}  // namespace

const char* to_string(FaultComponent component) {
  switch (component) {
    case FaultComponent::kFrames:
      return "frames";
    case FaultComponent::kOdometry:
      return "odometry";
    case FaultComponent::kGyro:
      return "gyro";
    case FaultComponent::kTime:
      return "time";
    case FaultComponent::kCalibration:
      return "calibration";
    case FaultComponent::kMount:
      return "mount";
    case FaultComponent::kMap:
      return "map";
    case FaultComponent::kLog:
      return "log";
    case FaultComponent::kWork:
      return "work";
    case FaultComponent::kMemory:
      return "memory";
    case FaultComponent::kCalls:
      return "calls";
  }
  return "unknown";
}

const char* to_string(FaultMode mode) {
  switch (mode) {
    case FaultMode::kOff:
      return "off";
    case FaultMode::kStuck:
      return "stuck";
    case FaultMode::kGarbage:
      return "garbage";
    case FaultMode::kWrong:
      return "wrong";
    case FaultMode::kSlow:
      return "slow";
    case FaultMode::kDelayed:
      return "delayed";
    case FaultMode::kIntermittent:
      return "intermittent";
  }
  return "unknown";
}

const char* to_string(FaultVerdict verdict) {
  switch (verdict) {
    case FaultVerdict::kPass:
      return "pass";
    case FaultVerdict::kFail:
      return "FAIL";
    case FaultVerdict::kReported:
      return "reported";
    case FaultVerdict::kSkipped:
      return "skipped";
  }
  return "unknown";
}

FaultJudge::FaultJudge(FaultComponent component, FaultMode mode, std::string injected,
                       std::string expected) {
  outcome_.component = component;
  outcome_.mode = mode;
  outcome_.injected = std::move(injected);
  outcome_.expected = std::move(expected);
}

FaultJudge& FaultJudge::expect(bool holds, const std::string& broken) {
  if (!holds) append(broken_, broken);
  return *this;
}

FaultJudge& FaultJudge::saw(const std::string& figure) {
  append(outcome_.seen, figure);
  return *this;
}

FaultJudge& FaultJudge::counted(const std::string& counters) {
  append(outcome_.counters, counters);
  return *this;
}

FaultOutcome FaultJudge::outcome() const {
  FaultOutcome result = outcome_;
  if (!broken_.empty()) {
    result.verdict = FaultVerdict::kFail;
    result.seen += (result.seen.empty() ? "" : "; ") + std::string("BROKEN: ") + broken_;
  }
  return result;
}

FaultOutcome FaultJudge::reported() const {
  FaultOutcome result = outcome_;
  result.verdict = FaultVerdict::kReported;
  if (!broken_.empty()) result.seen += (result.seen.empty() ? "" : "; ") + broken_;
  return result;
}

FaultOutcome FaultJudge::skipped(const std::string& reason) const {
  FaultOutcome result = outcome_;
  result.verdict = FaultVerdict::kSkipped;
  result.seen = reason;
  return result;
}

}  // namespace cairn::host

#include "cairn/base/status.hpp"

namespace cairn {

const char* to_string(Status status) {
  switch (status) {
    case Status::kOk:
      return "ok";
    case Status::kInvalidArgument:
      return "invalid_argument";
    case Status::kNonFiniteInput:
      return "non_finite_input";
    case Status::kBadConfig:
      return "bad_config";
    case Status::kDuplicate:
      return "duplicate";
    case Status::kTimeBackwards:
      return "time_backwards";
    case Status::kTimeGap:
      return "time_gap";
    case Status::kNotInitialised:
      return "not_initialised";
    case Status::kNotFound:
      return "not_found";
    case Status::kFull:
      return "full";
    case Status::kSingular:
      return "singular";
    case Status::kGated:
      return "gated";
    case Status::kNoConsensus:
      return "no_consensus";
    case Status::kOutOfView:
      return "out_of_view";
    case Status::kDegenerate:
      return "degenerate";
    case Status::kLowTexture:
      return "low_texture";
    case Status::kVersionMismatch:
      return "version_mismatch";
    case Status::kCorrupt:
      return "corrupt";
    case Status::kBudgetExceeded:
      return "budget_exceeded";
    case Status::kLost:
      return "lost";
    case Status::kRepeatedImage:
      return "repeated_image";
  }
  return "unknown";
}

}  // namespace cairn

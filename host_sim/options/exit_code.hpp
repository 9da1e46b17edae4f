#pragma once

#include <csignal>

namespace cairn::host {

/// What cairn_sim returns to the shell.
enum class ExitCode : int {
  kOk = 0,
  kCheckFailed = 1,    ///< the job ran, and what it checks does not hold
  kUsage = 2,          ///< the command line is wrong
  kInputInvalid = 3,   ///< an input is unreadable or invalid
  kOutputFailed = 4,   ///< a result cannot be written
  kHungUp = 129,       ///< as by SIGINT: the terminal is gone
  kInterrupted = 130,  ///< SIGINT; what was done until then is written, and marked
  kTerminated = 143,   ///< the same by SIGTERM
};

/// Of a run that a signal ended.
inline ExitCode interrupted_by(int signal) {
  if (signal == SIGHUP) return ExitCode::kHungUp;
  return signal == SIGINT ? ExitCode::kInterrupted : ExitCode::kTerminated;
}

}  // namespace cairn::host

#pragma once

namespace cairn::host {

/// What cairn_sim returns to the shell.
enum class ExitCode : int {
  kOk = 0,
  kCheckFailed = 1,    ///< the job ran, and what it checks does not hold
  kUsage = 2,          ///< the command line is wrong
  kInputInvalid = 3,   ///< an input is unreadable or invalid
  kOutputFailed = 4,   ///< a result cannot be written
  kInterrupted = 130,  ///< SIGINT; what was done until then is written, and marked
  kTerminated = 143,   ///< the same by SIGTERM
};

}  // namespace cairn::host

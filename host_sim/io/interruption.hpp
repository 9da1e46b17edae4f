#pragma once

namespace cairn::host {

/// While one exists, SIGINT, SIGTERM and SIGHUP (unless it was ignored before, as by nohup) are
/// remembered instead of ending the program: a loop asks
/// interrupted() and comes to its end, so that what it has is written whole. A second signal ends
/// the program at once. One at a time.
class InterruptionGuard {
 public:
  InterruptionGuard();
  ~InterruptionGuard();
  InterruptionGuard(const InterruptionGuard&) = delete;
  InterruptionGuard& operator=(const InterruptionGuard&) = delete;
};

/// The signal that came while a guard was there, else 0.
int interrupted();

}  // namespace cairn::host

#pragma once

namespace cairn::host {

/// How far a command is, as "run 3 of 20" in one line of the terminal, cleared by the last. Nothing
/// where standard error is no terminal.
void show_progress(const char* what, int done, int total);
inline void show_runs(int done, int total) {
  show_progress("run", done, total);
}

}  // namespace cairn::host

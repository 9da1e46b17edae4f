#pragma once

#include <string>
#include <vector>

namespace cairn::host {

/// How a child process ended.
struct ChildEnd {
  int start_error = 0;  ///< errno where the program could not be started, else 0
  int code = 0;         ///< exit code
  int signal = 0;       ///< that ended it, else 0
  std::string output;   ///< what it wrote to standard output
  std::string errors;   ///< and to standard error

  bool succeeded() const { return start_error == 0 && code == 0 && signal == 0; }
  /// There is no such program.
  bool not_found() const;
  /// The signal, where one ended the child or a child of its own: exit code 128 + N then means
  /// signal N. Else 0.
  int fatal_signal() const;
};

/// Runs `command`, the program and its arguments, and waits for its end. No shell comes between:
/// every argument arrives as it is. A program without a slash is looked for in PATH. The child
/// reads `input` as its standard input. Throws std::system_error when the system has no room for
/// files in memory.
ChildEnd run_child(const std::vector<std::string>& command, const std::string& input = {});

/// The end in words, such as "ended with code 132 (Illegal instruction)", followed by the last line
/// of `errors` where there is one.
std::string describe(const ChildEnd& end);

}  // namespace cairn::host

#include "host_sim/run/report.hpp"

#include <array>
#include <cstdio>
#include <sys/wait.h>

#include <fmt/format.h>

#include "host_sim/run/report_script.hpp"

namespace cairn::host {
namespace {

constexpr int kNoMatplotlib = 4;  // as report.py returns it
constexpr int kCommandNotFound = 127;

std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

int run_script(const std::string& python, const std::filesystem::path& folder) {
  const std::string command = fmt::format("{} - {} 2>&1", python, quoted(folder.string()));
  std::FILE* pipe = popen(command.c_str(), "w");
  if (pipe == nullptr) return kCommandNotFound;
  std::fputs(kReportScript, pipe);
  const int status = pclose(pipe);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

std::optional<std::string> write_report(const std::filesystem::path& folder) {
  int result = kCommandNotFound;
  // A python3 of the user's own may lack matplotlib where Debian's has it.
  for (const char* python : {"python3", "/usr/bin/python3"}) {
    result = run_script(python, folder);
    if (result == 0) return std::nullopt;
    if (result != kNoMatplotlib && result != kCommandNotFound) break;
  }
  if (result == kCommandNotFound) return "report.html not made: python3 is missing";
  if (result == kNoMatplotlib) {
    return "report.html not made: python3 has no matplotlib (Debian: python3-matplotlib)";
  }
  return fmt::format("report.html not made: python3 ended with code {}", result);
}

}  // namespace cairn::host

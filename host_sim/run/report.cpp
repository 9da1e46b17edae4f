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

int run_script(const std::string& python, const char* script, const std::filesystem::path& folder) {
  const std::string command = fmt::format("{} - {} 2>&1", python, quoted(folder.string()));
  std::FILE* pipe = popen(command.c_str(), "w");
  if (pipe == nullptr) return kCommandNotFound;
  std::fputs(script, pipe);
  const int status = pclose(pipe);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// Makes `product`; nothing on success, else what is missing.
std::optional<std::string> make(const char* product, const char* script,
                                const std::filesystem::path& folder) {
  int result = kCommandNotFound;
  // A python3 of the user's own may lack matplotlib where Debian's has it.
  for (const char* python : {"python3", "/usr/bin/python3"}) {
    result = run_script(python, script, folder);
    if (result == 0) return std::nullopt;
    if (result != kNoMatplotlib && result != kCommandNotFound) break;
  }
  if (result == kCommandNotFound) return fmt::format("{} not made: python3 is missing", product);
  if (result == kNoMatplotlib) {
    return fmt::format("{} not made: python3 has no matplotlib (Debian: python3-matplotlib)",
                       product);
  }
  return fmt::format("{} not made: python3 ended with code {}", product, result);
}

}  // namespace

std::optional<std::string> write_report(const std::filesystem::path& folder) {
  return make("report.html", kReportScript, folder);
}

std::optional<std::string> draw_timing(const std::filesystem::path& folder) {
  return make("timing.png", kTimingScript, folder);
}

}  // namespace cairn::host

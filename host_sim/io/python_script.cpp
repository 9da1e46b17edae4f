#include "host_sim/io/python_script.hpp"

#include <fmt/format.h>

#include "host_sim/io/child_process.hpp"
#include "host_sim/io/output_file.hpp"

namespace cairn::host {
namespace {

constexpr int kNoMatplotlib = 4;
constexpr int kCannotWrite = 5;

/// Runs the script on standard input, named by the first argument. Modules of the working folder
/// stay out of it: any file there may have the name of one.
constexpr const char* kRunner =
    "import sys; sys.path[:] = [p for p in sys.path if p]; sys.argv.pop(0); "
    "exec(compile(sys.stdin.buffer.read(), sys.argv[0], 'exec'))";

}  // namespace

std::optional<std::string> draw_with_python(const std::string& product, const PythonScript& script,
                                            const std::filesystem::path& folder) {
  std::string text;
  for (std::size_t i = 0; i < script.count; ++i) text += script.texts[i];
  bool found = false;
  for (const char* python : {"python3", "/usr/bin/python3"}) {
    const ChildEnd end = run_child({python, "-c", kRunner, script.name, folder.string()}, text);
    if (end.succeeded()) return std::nullopt;
    if (end.not_found()) continue;
    if (end.code == kCannotWrite) throw OutputError(folder / product, describe(end));
    if (end.code != kNoMatplotlib) {
      return fmt::format("{} not made: {} {}", product, python, describe(end));
    }
    found = true;
  }
  if (!found) return fmt::format("{} not made: python3 is missing", product);
  return fmt::format("{} not made: python3 has no matplotlib (Debian: python3-matplotlib)",
                     product);
}

}  // namespace cairn::host

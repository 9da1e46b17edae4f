#include "host_sim/commands/info_command.hpp"

#include <fmt/core.h>

#include "cairn/base/config.hpp"
#include "cairn/base/health.hpp"
#include "cairn/tracking/frame_report.hpp"
#include "cairn/vision/freak.hpp"

#include "host_sim/reports/build_info.hpp"

namespace cairn::host {
namespace {

template <class Config>
void print_capacities(const char* name) {
  fmt::print(
      "  {:<8} image {}x{}, {} landmarks, {} handheld features, {} archived, {} candidates\n", name,
      Config::kMaxImageWidth, Config::kMaxImageHeight, Config::kMaxLandmarks, Config::kMaxFeatures,
      Config::kLibraryLandmarks, Config::kMaxSeeds);
}

void print_info() {
  const BuildInfo build = build_info();
  fmt::print("cairn {}\n", build.version);
  fmt::print("compiler  {}\nflags     {}\nCPU       {}\n", build.compiler, build.flags, build.cpu);
  fmt::print("capacities\n");
  print_capacities<DefaultConfig>("default");
  print_capacities<TinyConfig>("tiny");
  print_capacities<LargeConfig>("large");
  fmt::print("sizes, bytes\n  descriptor {}\n  frame report {}\n  health {}\n", sizeof(Descriptor),
             sizeof(FrameReport), sizeof(Health));
}

}  // namespace

void register_info_command(CommandContext& context) {
  context.app.add_subcommand("info", "Print version, build flags, capacities and sizes")
      ->callback(print_info);
}

}  // namespace cairn::host

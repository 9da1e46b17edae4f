#include "host_sim/commands/run_kinds.hpp"

namespace cairn::host {

const std::vector<RunKind>& run_kinds() {
  static const std::vector<RunKind> kinds = {};
  return kinds;
}

}  // namespace cairn::host

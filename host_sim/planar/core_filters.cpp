#include <stdexcept>

#include <fmt/format.h>

#include "host_sim/planar/filter.hpp"
#include "host_sim/planar/reference/invariant_ekf.hpp"
#include "host_sim/planar/reference/reduced_lifted.hpp"
#include "host_sim/planar/reference/world_ekf.hpp"

namespace cairn::host {
namespace {

struct FilterKind {
  const char* name;
  std::unique_ptr<PlanarFilter> (*make)(int landmarks);
};

template <WorldEkf::Kind Kind>
std::unique_ptr<PlanarFilter> make_world_ekf(int) {
  return std::make_unique<WorldEkf>(Kind);
}

template <ReducedLifted::Noise Noise>
std::unique_ptr<PlanarFilter> make_reduced(int) {
  return std::make_unique<ReducedLifted>(Noise);
}

std::unique_ptr<PlanarFilter> make_invariant(int) {
  return std::make_unique<InvariantEkf>();
}

const std::vector<FilterKind>& filter_kinds() {
  static const std::vector<FilterKind> kinds = {
      {"reduced-jacobian", make_reduced<ReducedLifted::Noise::kJacobian>},
      {"reduced-moments", make_reduced<ReducedLifted::Noise::kMoments>},
      {"dense-ekf", make_world_ekf<WorldEkf::Kind::kStandard>},
      {"fej-ekf", make_world_ekf<WorldEkf::Kind::kFirstEstimates>},
      {"iterated-ekf", make_world_ekf<WorldEkf::Kind::kIterated>},
      {"ukf", make_world_ekf<WorldEkf::Kind::kUnscented>},
      {"ri-ekf", make_invariant},
  };
  return kinds;
}

}  // namespace

std::unique_ptr<PlanarFilter> make_planar_filter(const std::string& name, int landmarks) {
  std::string known;
  for (const auto& kind : filter_kinds()) {
    if (name == kind.name) return kind.make(landmarks);
    known += fmt::format("{}{}", known.empty() ? "" : ", ", kind.name);
  }
  throw std::invalid_argument(fmt::format("filter '{}': expected one of {}", name, known));
}

std::vector<std::string> planar_filter_names() {
  std::vector<std::string> names;
  for (const auto& kind : filter_kinds()) names.emplace_back(kind.name);
  return names;
}

}  // namespace cairn::host

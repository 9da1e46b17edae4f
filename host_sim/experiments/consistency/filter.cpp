#include "host_sim/experiments/consistency/filter.hpp"

#include <stdexcept>

#include <fmt/format.h>

#include "host_sim/experiments/consistency/core_filters.hpp"
#include "host_sim/experiments/consistency/reference/invariant_ekf.hpp"
#include "host_sim/experiments/consistency/reference/reduced_lifted.hpp"
#include "host_sim/experiments/consistency/reference/world_ekf.hpp"

namespace cairn::host {
namespace {

struct FilterKind {
  const char* name;
  int capacity;
  std::unique_ptr<FilterUnderTest> (*make)();
};

constexpr int kUnlimited = 100000;

template <WorldEkf::Kind Kind>
std::unique_ptr<FilterUnderTest> make_world_ekf() {
  return std::make_unique<WorldEkf>(Kind);
}

template <ReducedLifted::Noise Noise>
std::unique_ptr<FilterUnderTest> make_reduced() {
  return std::make_unique<ReducedLifted>(Noise);
}

std::unique_ptr<FilterUnderTest> make_invariant() {
  return std::make_unique<InvariantEkf>();
}

const std::vector<FilterKind>& filter_kinds() {
  static const std::vector<FilterKind> kinds = {
      {"ekf", kSimulatedCapacity, make_core_ekf},
      {"ekf-float", kSimulatedCapacity, make_core_ekf_float},
      {"group-iekf", kSimulatedCapacity, make_core_group_iekf},
      {"group-iekf-float", kSimulatedCapacity, make_core_group_iekf_float},
      {"group-iekf-fixed", kSimulatedCapacity, make_core_group_iekf_fixed},
      {"ekf-fixed", kSimulatedCapacity, make_core_ekf_fixed},
      {"lifted-iekf", kSimulatedCapacity, make_core_lifted_iekf},
      {"lifted-iekf-moments", kSimulatedCapacity, make_core_lifted_iekf_moments},
      {"reduced-jacobian", kUnlimited, make_reduced<ReducedLifted::Noise::kJacobian>},
      {"reduced-moments", kUnlimited, make_reduced<ReducedLifted::Noise::kMoments>},
      {"dense-ekf", kUnlimited, make_world_ekf<WorldEkf::Kind::kStandard>},
      {"fej-ekf", kUnlimited, make_world_ekf<WorldEkf::Kind::kFirstEstimates>},
      {"iterated-ekf", kUnlimited, make_world_ekf<WorldEkf::Kind::kIterated>},
      {"ukf", kUnlimited, make_world_ekf<WorldEkf::Kind::kUnscented>},
      {"ri-ekf", kUnlimited, make_invariant},
  };
  return kinds;
}

}  // namespace

std::unique_ptr<FilterUnderTest> make_filter_under_test(const std::string& name, int landmarks) {
  std::string known;
  for (const auto& kind : filter_kinds()) {
    if (name == kind.name) {
      if (landmarks > kind.capacity) {
        throw std::invalid_argument(
            fmt::format("filter '{}' holds at most {} landmarks", name, kind.capacity));
      }
      return kind.make();
    }
    known += fmt::format("{}{}", known.empty() ? "" : ", ", kind.name);
  }
  throw std::invalid_argument(fmt::format("filter '{}': expected one of {}", name, known));
}

}  // namespace cairn::host

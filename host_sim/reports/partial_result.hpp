#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "host_sim/base/shard.hpp"

namespace cairn::host {

/// What one shard of an experiment leaves, or several joined.
struct PartialResult {
  std::string experiment;   ///< the command's name
  nlohmann::json settings;  ///< all that the results depend on; equal in every shard
  int shard_count = 1;
  std::vector<int> shards;               ///< done, ascending
  std::map<int, nlohmann::json> pieces;  ///< by number
};

PartialResult make_partial(const std::string& experiment, nlohmann::json settings,
                           const Shard& shard);

/// partial.cbor in `folder` (RFC 8949: numbers keep every bit), with the version of this program.
void write_partial(const PartialResult& part, const std::filesystem::path& folder);

/// InputError where there is none, or of another version of this program.
PartialResult read_partial(const std::filesystem::path& folder);

/// The shards in `folders` as one. InputError where they are not of one experiment or one is there
/// twice; UsageError where some are missing.
PartialResult join_partials(const std::vector<std::filesystem::path>& folders);

}  // namespace cairn::host

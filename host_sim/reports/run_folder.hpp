#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "host_sim/io/output_file.hpp"

namespace cairn::host {

/// What every command writes into its folder of results. Each throws OutputError, naming the file,
/// where it cannot be written; a file is then not there.

/// Creates `folder` and those above it.
void make_folder(const std::filesystem::path& folder);

/// Throws UsageError where `folder` holds any file: results go into a folder of their own.
void refuse_full_folder(const std::filesystem::path& folder);

/// Removes what an earlier run left in `folder`: the files that a run writes (docs/reference/
/// outputs.md) and their parts, so that none of them stands beside this run's. Others are left
/// alone.
void remove_earlier_run(const std::filesystem::path& folder);

/// `value` as indented text in `path`.
void write_json(const std::filesystem::path& path, const nlohmann::json& value);

/// How a result came about.
struct Manifest {
  std::string command_line;
  std::optional<std::uint64_t> seed;  ///< left out where nothing is random
  nlohmann::json config;
  nlohmann::json source;  ///< left out when null
  nlohmann::json inputs = nlohmann::json::object();
};

/// manifest.json in `folder`: `manifest` and how this program was built.
void write_manifest(const std::filesystem::path& folder, const Manifest& manifest);

/// Version, compiler, flags and CPU; common to the manifests of every command.
nlohmann::json build_manifest();

/// Name and hash of each file. InputError where one cannot be read.
nlohmann::json hashes_of(const std::vector<std::filesystem::path>& files);

/// FNV-1a 64 of a file's bytes as 16 hexadecimal digits.
std::string hash_of_file(const std::filesystem::path& path);

}  // namespace cairn::host

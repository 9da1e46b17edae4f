#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace cairn::host {

/// What every command writes into its folder of results. Each throws InputError, naming the file,
/// where it cannot be written.

/// Creates `folder` and those above it.
void make_folder(const std::filesystem::path& folder);

/// `value` as indented text in `path`.
void write_json(const std::filesystem::path& path, const nlohmann::json& value);

/// `text` as it is.
void write_text(const std::filesystem::path& path, const std::string& text);

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

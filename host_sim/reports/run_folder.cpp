#include "host_sim/reports/run_folder.hpp"

#include <fstream>
#include <system_error>

#include <fmt/format.h>

#include "cairn/base/hash.hpp"

#include "host_sim/io/input_error.hpp"
#include "host_sim/reports/build_info.hpp"

namespace cairn::host {

using nlohmann::json;

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw OutputError(folder, "cannot be created: " + error.message());
}

void refuse_full_folder(const std::filesystem::path& folder) {
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) return;
  if (std::filesystem::is_empty(folder, error)) return;
  throw UsageError(
      fmt::format("--out {}: holds files already; --force removes those of an earlier "
                  "run and leaves all others, or choose another folder",
                  folder.string()));
}

void remove_earlier_run(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> old;
  for (const char* name :
       {"report.html", "overlay.mp4", "overlay.avi", "overlay.part.mp4", "overlay.part.avi",
        "summary.json", "frames.csv", "tracking.csv", "trajectory.tum", "truth.tum",
        "trajectory_kitti.txt", "truth_kitti.txt", "samples.csv", "landmarks.csv",
        "uncertainty.csv", "health.csv", "manifest.json"}) {
    old.push_back(folder / name);
    old.push_back(part_of(folder / name));
  }
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    const bool picture = name.rfind("overlay-", 0) == 0 &&
                         name.find_first_not_of("0123456789", 8) == 14 &&
                         (name.substr(14) == ".jpg" || name.substr(14) == ".jpg.part");
    if (picture) old.push_back(entry.path());
  }
  for (const std::filesystem::path& path : old) {
    std::filesystem::remove(path, error);
    if (error) throw OutputError(path, "an earlier run's cannot be removed: " + error.message());
  }
}

void write_json(const std::filesystem::path& path, const json& value) {
  // Names of files need not be UTF-8; JSON must.
  write_text(path, value.dump(2, ' ', false, json::error_handler_t::replace) + '\n');
}

void write_manifest(const std::filesystem::path& folder, const Manifest& manifest) {
  json document = build_manifest();
  document["command"] = manifest.command_line;
  if (manifest.seed.has_value()) document["seed"] = *manifest.seed;
  document["config"] = manifest.config;
  if (!manifest.source.is_null()) document["source"] = manifest.source;
  document["inputs"] = manifest.inputs;
  write_json(folder / "manifest.json", document);
}

json build_manifest() {
  const BuildInfo build = build_info();
  return {{"version", build.version},
          {"compiler", build.compiler},
          {"flags", build.flags},
          {"cpu", build.cpu}};
}

json hashes_of(const std::vector<std::filesystem::path>& files) {
  json hashes = json::array();
  for (const std::filesystem::path& path : files) {
    hashes.push_back({{"file", path.string()}, {"hash", hash_of_file(path)}});
  }
  return hashes;
}

std::string hash_of_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path, "cannot be read");
  Hash64 hash;
  char buffer[65536];
  while (file.read(buffer, sizeof buffer) || file.gcount() > 0) {
    for (std::streamsize i = 0; i < file.gcount(); ++i) {
      hash.add(static_cast<std::uint8_t>(buffer[i]));
    }
  }
  return fmt::format("{:016x}", hash.value());
}

}  // namespace cairn::host

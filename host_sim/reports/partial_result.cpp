#include "host_sim/reports/partial_result.hpp"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include "host_sim/io/input_error.hpp"
#include "host_sim/io/output_file.hpp"
#include "host_sim/reports/build_info.hpp"
#include "host_sim/reports/run_folder.hpp"

namespace cairn::host {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr const char* kFile = "partial.cbor";

PartialResult from_json(const json& document) {
  const auto version = document.at("version").get<std::string>();
  if (version != build_info().version) {
    throw std::invalid_argument(
        fmt::format("written by version {}, expected {}", version, build_info().version));
  }
  PartialResult part;
  document.at("experiment").get_to(part.experiment);
  part.settings = document.at("settings");
  document.at("shard_count").get_to(part.shard_count);
  document.at("shards").get_to(part.shards);
  for (const json& piece : document.at("pieces")) {
    part.pieces[piece.at(0).get<int>()] = piece.at(1);
  }
  return part;
}

void add(PartialResult& whole, const PartialResult& part, const fs::path& file) {
  if (part.experiment != whole.experiment) {
    throw InputError(file, fmt::format("expected a shard of '{}' as the first folder holds, found "
                                       "'{}'",
                                       whole.experiment, part.experiment));
  }
  if (part.settings != whole.settings || part.shard_count != whole.shard_count) {
    throw InputError(file,
                     "not of the same experiment as the first folder: seed, settings or the "
                     "number of shards differ");
  }
  for (const int shard : part.shards) {
    if (std::count(whole.shards.begin(), whole.shards.end(), shard) > 0) {
      throw InputError(file, fmt::format("shard {} is there twice", shard));
    }
    whole.shards.push_back(shard);
  }
  whole.pieces.insert(part.pieces.begin(), part.pieces.end());
}

void check_complete(const PartialResult& whole) {
  std::string missing;
  for (int shard = 1; shard <= whole.shard_count; ++shard) {
    if (std::count(whole.shards.begin(), whole.shards.end(), shard) == 0) {
      missing += fmt::format(" {}/{}", shard, whole.shard_count);
    }
  }
  if (!missing.empty()) throw UsageError(fmt::format("merge: shards are missing:{}", missing));
}

}  // namespace

PartialResult make_partial(const std::string& experiment, json settings, const Shard& shard) {
  return {experiment, std::move(settings), shard.count, {shard.index}, {}};
}

void write_partial(const PartialResult& part, const fs::path& folder) {
  json pieces = json::array();
  for (const auto& [number, piece] : part.pieces) pieces.push_back({number, piece});
  const json document = {{"version", build_info().version}, {"experiment", part.experiment},
                         {"settings", part.settings},       {"shard_count", part.shard_count},
                         {"shards", part.shards},           {"pieces", std::move(pieces)}};
  const std::vector<std::uint8_t> bytes = json::to_cbor(document);
  make_folder(folder);
  write_text(folder / kFile, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

PartialResult read_partial(const fs::path& folder) {
  const fs::path path = folder / kFile;
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path, "cannot be read; expected what an experiment's --shard wrote");
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  try {
    return from_json(json::from_cbor(bytes));
  } catch (const std::exception& error) {
    throw InputError(path, fmt::format("not the shard of an experiment: {}", error.what()));
  }
}

PartialResult join_partials(const std::vector<fs::path>& folders) {
  PartialResult whole = read_partial(folders.front());
  for (std::size_t i = 1; i < folders.size(); ++i) {
    add(whole, read_partial(folders[i]), folders[i] / kFile);
  }
  std::sort(whole.shards.begin(), whole.shards.end());
  check_complete(whole);
  return whole;
}

}  // namespace cairn::host

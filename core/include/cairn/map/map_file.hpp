#pragma once

#include <cstdint>

#include "cairn/base/status.hpp"
#include "cairn/map/detail/map_codec.hpp"
#include "cairn/map/library.hpp"

namespace cairn {

/// Where a map is written to: flash page buffer, file, socket. `write` takes `count` bytes and
/// returns whether all of them were taken.
struct ByteSink {
  bool (*write)(void* context, const std::uint8_t* bytes, int count) = nullptr;
  void* context = nullptr;
};

/// Where a map is read from. `read_at` delivers exactly `count` bytes from `offset` on and returns
/// whether it could; the same offset must give the same bytes during one load.
struct ByteSource {
  bool (*read_at)(void* context, std::uint32_t offset, std::uint8_t* bytes, int count) = nullptr;
  void* context = nullptr;
  std::uint32_t size = 0;  ///< bytes that there are
};

/// Why a map file was refused.
enum class MapFileFault : std::uint8_t {
  kNone = 0,
  kUnreadable,  ///< the source failed, or has fewer bytes than the file says
  kMagic,       ///< not a Cairn map
  kVersion,     ///< another format version
  kCapacity,    ///< more landmarks, or more views a landmark, than this build holds
  kLength,      ///< the length field does not agree with the counts, or bytes follow the end
  kChecksum,    ///< CRC-32 wrong
  kValue,       ///< a value that no saved map can hold; ids not ascending
};

/// Stable lower-case name, for logs and messages.
const char* to_string(MapFileFault fault);

inline constexpr std::uint32_t kMapFileVersion = 1;
inline constexpr int kMapHeaderBytes = 32;
inline constexpr int kMapTrailerBytes = 4;

/// What a map file says about itself.
struct MapFileInfo {
  std::uint32_t version = 0;
  std::uint32_t landmarks = 0;
  std::uint32_t views = 0;  ///< per landmark record
  std::uint32_t payload_bytes = 0;
  LandmarkId next_id = 1;  ///< smallest id above all that were ever given out
  MapFileFault fault = MapFileFault::kNone;
};

/// Bytes that save_map writes for `landmarks` landmarks with `views` views each.
std::uint32_t map_file_bytes(int landmarks, int views);

/// Writes the library, landmarks in ascending id, so that equal content gives equal bytes. Format:
/// docs/reference/map-file.md. kInvalidArgument: no sink, or next_id not above every id.
/// kBudgetExceeded: the sink refused bytes; what it took so far is not a valid map.
/// Cost: n^2 id comparisons and n records.
template <class Config, int Views>
Status save_map(const MapLibrary<Config, Views>& library, LandmarkId next_id, const ByteSink& sink);

/// Replaces the content of `library` by a saved map. The source is read twice: once to check magic,
/// version, capacity, length, CRC-32 and every value, once to load. kVersionMismatch (fault
/// kVersion, kCapacity), kCorrupt (every other fault): library unchanged, `info.fault` has the
/// reason. kInvalidArgument: no source. A source that gives other bytes the second time is kCorrupt
/// with fault kUnreadable, and only then the library is left empty; load into the back buffer of
/// MapExchange where that matters.
template <class Config, int Views>
Status load_map(const ByteSource& source, MapLibrary<Config, Views>& library, MapFileInfo& info);

namespace detail {

/// Checks everything but the records; on kOk `info` is filled and the length is plausible.
Status read_map_header(const ByteSource& source, int capacity, int views, MapFileInfo& info,
                       Crc32& crc);
/// Reads the trailer and compares it with the CRC-32 of what was read.
Status check_map_trailer(const ByteSource& source, const Crc32& crc, MapFileInfo& info);
/// Writes the header.
Status write_map_header(const ByteSink& sink, int landmarks, int views, LandmarkId next_id,
                        Crc32& crc);
Status write_map_trailer(const ByteSink& sink, const Crc32& crc);

inline Status refuse(MapFileFault fault, MapFileInfo& info) {
  info.fault = fault;
  return fault == MapFileFault::kVersion || fault == MapFileFault::kCapacity
             ? Status::kVersionMismatch
             : Status::kCorrupt;
}

/// Reads and validates record `index`, whose id must be above `previous_id`.
template <class Config, int Views>
MapFileFault read_map_record(const ByteSource& source, int index, LandmarkId previous_id,
                             LandmarkId next_id, Crc32& crc,
                             typename MapLibrary<Config, Views>::Landmark& landmark) {
  constexpr int kBytes = landmark_bytes<Views>();
  RecordReader<kBytes> record;
  const std::uint32_t offset = static_cast<std::uint32_t>(kMapHeaderBytes + index * kBytes);
  if (!source.read_at(source.context, offset, record.data(), kBytes)) {
    return MapFileFault::kUnreadable;
  }
  crc.add(record.data(), kBytes);
  const bool good = read_landmark(record, landmark) &&
                    ok(MapLibrary<Config, Views>::validate(landmark)) &&
                    landmark.id > previous_id && landmark.id < next_id;
  return good ? MapFileFault::kNone : MapFileFault::kValue;
}

/// One pass over the records. With `target` the landmarks are inserted as they come.
template <class Config, int Views>
Status scan_map(const ByteSource& source, MapFileInfo& info, MapLibrary<Config, Views>* target,
                Health& health) {
  Crc32 crc;
  Status status = read_map_header(source, Config::kLibraryLandmarks, Views, info, crc);
  if (!ok(status)) return status;
  LandmarkId previous_id = kNoLandmark;
  MapFileFault value_fault = MapFileFault::kNone;
  for (int i = 0; i < static_cast<int>(info.landmarks) && i < Config::kLibraryLandmarks; ++i) {
    typename MapLibrary<Config, Views>::Landmark landmark;
    const MapFileFault fault =
        read_map_record<Config, Views>(source, i, previous_id, info.next_id, crc, landmark);
    if (fault == MapFileFault::kUnreadable) return refuse(fault, info);
    // A wrong value in a damaged file is damage: the checksum speaks first.
    if (fault != MapFileFault::kNone) value_fault = fault;
    previous_id = landmark.id;
    if (target != nullptr && value_fault == MapFileFault::kNone &&
        !ok(target->insert(landmark, health))) {
      value_fault = MapFileFault::kValue;
    }
  }
  status = check_map_trailer(source, crc, info);
  if (!ok(status)) return status;
  return value_fault == MapFileFault::kNone ? Status::kOk : refuse(value_fault, info);
}

}  // namespace detail

template <class Config, int Views>
Status save_map(const MapLibrary<Config, Views>& library, LandmarkId next_id,
                const ByteSink& sink) {
  if (sink.write == nullptr) return Status::kInvalidArgument;
  for (int slot = 0; slot < library.size(); ++slot) {
    if (library[slot].id >= next_id) return Status::kInvalidArgument;
  }
  detail::Crc32 crc;
  Status status = detail::write_map_header(sink, library.size(), Views, next_id, crc);
  LandmarkId previous_id = kNoLandmark;
  for (int i = 0; i < library.size() && ok(status); ++i) {
    int next = -1;
    for (int slot = 0; slot < library.size(); ++slot) {
      if (library[slot].id <= previous_id) continue;
      if (next < 0 || library[slot].id < library[next].id) next = slot;
    }
    if (next < 0) break;
    previous_id = library[next].id;
    detail::RecordWriter<detail::landmark_bytes<Views>()> record;
    detail::write_landmark(library[next], record);
    crc.add(record.data(), record.size());
    if (!sink.write(sink.context, record.data(), record.size())) status = Status::kBudgetExceeded;
  }
  return ok(status) ? detail::write_map_trailer(sink, crc) : status;
}

template <class Config, int Views>
Status load_map(const ByteSource& source, MapLibrary<Config, Views>& library, MapFileInfo& info) {
  if (source.read_at == nullptr) return Status::kInvalidArgument;
  Health unused;
  MapLibrary<Config, Views>* const check_only = nullptr;
  info = MapFileInfo();
  const Status checked = detail::scan_map(source, info, check_only, unused);
  if (!ok(checked)) return checked;
  library.clear();
  const Status loaded = detail::scan_map(source, info, &library, unused);
  if (!ok(loaded)) {
    library.clear();
    info.fault = MapFileFault::kUnreadable;
    return Status::kCorrupt;
  }
  return Status::kOk;
}

}  // namespace cairn

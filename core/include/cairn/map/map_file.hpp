#pragma once

#include <cstdint>

#include "cairn/base/status.hpp"
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

}  // namespace cairn

#include "cairn/map/detail/map_file_impl.hpp"

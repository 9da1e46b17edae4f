#include "cairn/map/map_file.hpp"

namespace cairn {
namespace {

constexpr std::uint8_t kMagic[8] = {'C', 'A', 'I', 'R', 'N', 'M', 'A', 'P'};

// Reflected CRC-32, four bits at a time: 64 bytes of table instead of 1024.
constexpr std::uint32_t kCrcNibble[16] = {0x00000000U, 0x1DB71064U, 0x3B6E20C8U, 0x26D930ACU,
                                          0x76DC4190U, 0x6B6B51F4U, 0x4DB26158U, 0x5005713CU,
                                          0xEDB88320U, 0xF00F9344U, 0xD6D6A3E8U, 0xCB61B38CU,
                                          0x9B64C2B0U, 0x86D3D2D4U, 0xA00AE278U, 0xBDBDF21CU};

std::uint32_t record_bytes(std::uint32_t views) {
  return static_cast<std::uint32_t>(detail::kLandmarkHeadBytes) +
         views * static_cast<std::uint32_t>(detail::kViewBytes);
}

}  // namespace

const char* to_string(MapFileFault fault) {
  switch (fault) {
    case MapFileFault::kNone:
      return "none";
    case MapFileFault::kUnreadable:
      return "unreadable";
    case MapFileFault::kMagic:
      return "magic";
    case MapFileFault::kVersion:
      return "version";
    case MapFileFault::kCapacity:
      return "capacity";
    case MapFileFault::kLength:
      return "length";
    case MapFileFault::kChecksum:
      return "checksum";
    case MapFileFault::kValue:
      return "value";
  }
  return "unknown";
}

std::uint32_t map_file_bytes(int landmarks, int views) {
  return static_cast<std::uint32_t>(kMapHeaderBytes + kMapTrailerBytes) +
         static_cast<std::uint32_t>(landmarks) * record_bytes(static_cast<std::uint32_t>(views));
}

namespace detail {

void Crc32::add(const std::uint8_t* bytes, int count) {
  for (int i = 0; i < count; ++i) {
    state_ ^= bytes[i];
    state_ = (state_ >> 4U) ^ kCrcNibble[state_ & 15U];
    state_ = (state_ >> 4U) ^ kCrcNibble[state_ & 15U];
  }
}

Status read_map_header(const ByteSource& source, int capacity, int views, MapFileInfo& info,
                       Crc32& crc) {
  RecordReader<kMapHeaderBytes> header;
  if (source.size < static_cast<std::uint32_t>(kMapHeaderBytes + kMapTrailerBytes) ||
      !source.read_at(source.context, 0, header.data(), kMapHeaderBytes)) {
    return refuse(MapFileFault::kUnreadable, info);
  }
  crc.add(header.data(), kMapHeaderBytes);
  for (const std::uint8_t expected : kMagic) {
    if (header.get8() != expected) return refuse(MapFileFault::kMagic, info);
  }
  info.version = header.get32();
  info.views = header.get32();
  info.landmarks = header.get32();
  info.payload_bytes = header.get32();
  info.next_id = header.get32();
  const std::uint32_t reserved = header.get32();
  if (info.version != kMapFileVersion) return refuse(MapFileFault::kVersion, info);
  if (info.views != static_cast<std::uint32_t>(views) ||
      info.landmarks > static_cast<std::uint32_t>(capacity)) {
    return refuse(MapFileFault::kCapacity, info);
  }
  if (info.payload_bytes != info.landmarks * record_bytes(info.views)) {
    return refuse(MapFileFault::kLength, info);
  }
  const std::uint32_t total = map_file_bytes(static_cast<int>(info.landmarks), views);
  if (source.size < total) return refuse(MapFileFault::kUnreadable, info);
  if (source.size > total) return refuse(MapFileFault::kLength, info);
  if (reserved != 0) return refuse(MapFileFault::kValue, info);
  return Status::kOk;
}

Status check_map_trailer(const ByteSource& source, const Crc32& crc, MapFileInfo& info) {
  RecordReader<kMapTrailerBytes> trailer;
  const std::uint32_t offset = static_cast<std::uint32_t>(kMapHeaderBytes) + info.payload_bytes;
  if (!source.read_at(source.context, offset, trailer.data(), kMapTrailerBytes)) {
    return refuse(MapFileFault::kUnreadable, info);
  }
  return trailer.get32() == crc.value() ? Status::kOk : refuse(MapFileFault::kChecksum, info);
}

Status write_map_header(const ByteSink& sink, int landmarks, int views, LandmarkId next_id,
                        Crc32& crc) {
  RecordWriter<kMapHeaderBytes> header;
  header.put_bytes(kMagic, 8);
  header.put32(kMapFileVersion);
  header.put32(static_cast<std::uint32_t>(views));
  header.put32(static_cast<std::uint32_t>(landmarks));
  header.put32(static_cast<std::uint32_t>(landmarks) *
               record_bytes(static_cast<std::uint32_t>(views)));
  header.put32(next_id);
  header.put32(0);
  crc.add(header.data(), header.size());
  return sink.write(sink.context, header.data(), header.size()) ? Status::kOk
                                                                : Status::kBudgetExceeded;
}

Status write_map_trailer(const ByteSink& sink, const Crc32& crc) {
  RecordWriter<kMapTrailerBytes> trailer;
  trailer.put32(crc.value());
  return sink.write(sink.context, trailer.data(), trailer.size()) ? Status::kOk
                                                                  : Status::kBudgetExceeded;
}

}  // namespace detail
}  // namespace cairn

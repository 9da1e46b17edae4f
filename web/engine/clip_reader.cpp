#include "clip_reader.hpp"

#include <cstring>

#include "jpeg.h"

namespace cairn_web {
namespace {

using namespace cairn::detail;
using cairn::Status;

constexpr char kClipMagic[] = "CAIRNCLP";
constexpr std::uint8_t kPackedFrame = 5;
constexpr std::size_t kCrcBytes = 4;
constexpr std::size_t kSizeAt = 4;  // of the payload's size in a record's head

template <std::size_t Count>
void copy(const std::uint8_t* from, std::uint8_t (&to)[Count]) {
  std::memcpy(to, from, Count);
}

bool is(const LogRecord type, std::uint8_t byte) {
  return static_cast<std::uint8_t>(type) == byte;
}

}  // namespace

Status ClipReader::open(const std::uint8_t* clip, std::size_t size, cairn::InputLogHeader& header) {
  *this = ClipReader();
  if (clip == nullptr || size < kLogMagicBytes ||
      std::memcmp(clip, kClipMagic, kLogMagicBytes) != 0) {
    return Status::kCorrupt;
  }
  clip_ = clip;
  size_ = size;
  at_ = kLogMagicBytes;
  Record record;
  if (!read_record(record) || !is(LogRecord::kHeader, record.type)) return Status::kCorrupt;
  LogHeaderParts parts;
  parts.has_lens = record.size == kLogHeaderBytes + kLogLensBytes;
  if (record.size != kLogHeaderBytes && !parts.has_lens) return Status::kCorrupt;
  std::uint8_t bytes[kLogHeaderBytes];
  copy(record.payload, bytes);
  if (parts.has_lens) copy(record.payload + kLogHeaderBytes, parts.lens);
  const Status status = decode_header(bytes, parts, header);
  if (!ok(status)) return status;
  width_ = header.camera.width;
  height_ = header.camera.height;
  return Status::kOk;
}

Status ClipReader::next(cairn::LogEvent& event, cairn::OdometrySample& sample,
                        cairn::LogFrame& frame, std::uint8_t* pixels) {
  if (width_ == 0) return Status::kNotInitialised;
  Record record;
  if (!read_record(record)) return Status::kCorrupt;
  if (record.type == kPackedFrame) {
    event = cairn::LogEvent::kFrame;
    return read_frame(record, frame, pixels);
  }
  if (is(LogRecord::kOdometry, record.type) && record.size == kLogOdometryBytes) {
    event = cairn::LogEvent::kOdometry;
    ++samples_;
    std::uint8_t bytes[kLogOdometryBytes];
    copy(record.payload, bytes);
    return decode_odometry(bytes, sample);
  }
  event = cairn::LogEvent::kEnd;
  return is_end(record) ? Status::kOk : Status::kCorrupt;
}

bool ClipReader::read_record(Record& record) {
  const std::size_t left = size_ - at_;
  if (left < kLogRecordHeadBytes + kCrcBytes) return false;
  const std::uint8_t* const start = clip_ + at_;
  std::uint8_t bytes[4];
  copy(start + kSizeAt, bytes);
  record = {start[0], start + kLogRecordHeadBytes, decode_u32(bytes)};
  if (record.size > left - kLogRecordHeadBytes - kCrcBytes) return false;
  const int covered = kLogRecordHeadBytes + static_cast<int>(record.size);
  copy(start + covered, bytes);
  if (decode_u32(bytes) != crc32(0, start, covered)) return false;
  at_ += static_cast<std::size_t>(covered) + kCrcBytes;
  return true;
}

Status ClipReader::read_frame(const Record& record, cairn::LogFrame& frame, std::uint8_t* pixels) {
  if (record.size < kLogFrameHeadBytes) return Status::kCorrupt;
  std::uint8_t head[kLogFrameHeadBytes];
  copy(record.payload, head);
  int width = 0;
  int height = 0;
  decode_frame_head(head, frame, width, height);
  ++frames_;
  const bool good = width == width_ && height == height_ &&
                    web_decode_jpeg(record.payload + kLogFrameHeadBytes,
                                    record.size - kLogFrameHeadBytes, width, height, pixels);
  return good ? Status::kOk : Status::kCorrupt;
}

/// The end, with the right counts, and nothing behind it.
bool ClipReader::is_end(const Record& record) const {
  if (!is(LogRecord::kEnd, record.type) || record.size != kLogEndBytes || at_ != size_) {
    return false;
  }
  std::uint8_t bytes[kLogEndBytes];
  copy(record.payload, bytes);
  std::uint32_t samples = 0;
  std::uint32_t frames = 0;
  decode_end(bytes, samples, frames);
  return samples == samples_ && frames == frames_;
}

}  // namespace cairn_web

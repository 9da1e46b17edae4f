#include "clip_log.hpp"

#include <cstring>

#include "cairn/runtime/input_log.hpp"

#include "jpeg.h"

namespace cairn_web {
namespace {

using namespace cairn::detail;

constexpr char kClipMagic[] = "CAIRNCLP";
constexpr std::uint8_t kPackedFrame = 5;
constexpr std::size_t kCrcBytes = 4;
constexpr int kSizeAt = 4;  // of the payload's size in a record's head

}  // namespace

void ClipLog::open(const std::uint8_t* clip, std::size_t size) {
  clip_ = clip;
  size_ = size;
  at_ = 0;
  started_ = false;
  piece_ = piece_count_ = 0;
}

int ClipLog::read(std::uint8_t* bytes, int count) {
  int done = 0;
  while (done < count) {
    if (piece_ == piece_count_ && !open_record()) break;
    Piece& piece = pieces_[piece_];
    const int part = piece.count < count - done ? piece.count : count - done;
    std::memcpy(bytes + done, piece.bytes, static_cast<std::size_t>(part));
    piece.bytes += part;
    piece.count -= part;
    done += part;
    if (piece.count == 0) ++piece_;
  }
  return done;
}

bool ClipLog::open_record() {
  piece_ = piece_count_ = 0;
  const std::uint8_t* const record = clip_ + at_;
  const std::size_t left = size_ - at_;
  if (!started_) {
    if (left < kLogMagicBytes || std::memcmp(record, kClipMagic, kLogMagicBytes) != 0) return false;
    encode_magic(magic_);
    add(magic_, kLogMagicBytes);
    at_ += kLogMagicBytes;
    started_ = true;
    return true;
  }
  if (left < kLogRecordHeadBytes + kCrcBytes) return false;
  std::uint8_t size_bytes[4];
  std::memcpy(size_bytes, record + kSizeAt, sizeof size_bytes);
  const std::uint32_t payload = decode_u32(size_bytes);
  if (payload > left - kLogRecordHeadBytes - kCrcBytes) return false;
  const int covered = kLogRecordHeadBytes + static_cast<int>(payload);
  if (record[0] == kPackedFrame) {
    std::uint8_t crc[kCrcBytes];
    encode_u32(crc32(0, record, covered), crc);
    if (std::memcmp(crc, record + covered, kCrcBytes) != 0 ||
        !unpack_frame(record + kLogRecordHeadBytes, payload)) {
      return false;
    }
  } else {
    add(record, covered + static_cast<int>(kCrcBytes));
  }
  at_ += static_cast<std::size_t>(covered) + kCrcBytes;
  return true;
}

bool ClipLog::unpack_frame(const std::uint8_t* payload, std::uint32_t size) {
  if (size < kLogFrameHeadBytes) return false;
  std::uint8_t frame_head[kLogFrameHeadBytes];
  std::memcpy(frame_head, payload, sizeof frame_head);
  cairn::LogFrame frame;
  int width = 0;
  int height = 0;
  decode_frame_head(frame_head, frame, width, height);
  if (width > kMaxWidth || height > kMaxHeight ||
      !web_decode_jpeg(payload + kLogFrameHeadBytes, size - kLogFrameHeadBytes, width, height,
                       pixels_)) {
    return false;
  }
  const int count = width * height;
  std::uint8_t record_head[kLogRecordHeadBytes];
  encode_record_head(LogRecord::kFrame, static_cast<std::uint32_t>(kLogFrameHeadBytes + count),
                     record_head);
  std::memcpy(head_, record_head, sizeof record_head);
  std::memcpy(head_ + sizeof record_head, frame_head, sizeof frame_head);
  encode_u32(crc32(crc32(0, head_, sizeof head_), pixels_, count), crc_);
  add(head_, sizeof head_);
  add(pixels_, count);
  add(crc_, sizeof crc_);
  return true;
}

}  // namespace cairn_web

#pragma once

#include <cstddef>
#include <cstdint>

#include "cairn/runtime/input_log.hpp"

namespace cairn_web {

/// Reads a clip: an input log (cairn/runtime/input_log.hpp) whose pictures are packed. It starts
/// with "CAIRNCLP" in place of "CAIRNLOG", and in place of records of type 3 it has records of type
/// 5, whose payload is the frame's head of 20 bytes, as in the log, and a grey JPEG of the camera's
/// size. Everything else is the log's, byte for byte.
class ClipReader {
 public:
  /// First call. The clip stays the caller's, and must outlive the reading. Errors as
  /// cairn::InputLogReader::open().
  cairn::Status open(const std::uint8_t* clip, std::size_t size, cairn::InputLogHeader& header);

  /// The next event; a frame's pixels go to `pixels`, without gaps between rows: room for the
  /// header camera's width * height. kCorrupt for what is no clip, or not whole; kNotInitialised
  /// before open().
  cairn::Status next(cairn::LogEvent& event, cairn::OdometrySample& sample, cairn::LogFrame& frame,
                     std::uint8_t* pixels);

  /// Bytes of the clip up to the record that was read last.
  std::size_t used() const { return at_; }

 private:
  struct Record {
    std::uint8_t type = 0;
    const std::uint8_t* payload = nullptr;
    std::uint32_t size = 0;
  };

  bool read_record(Record& record);
  cairn::Status read_frame(const Record& record, cairn::LogFrame& frame, std::uint8_t* pixels);
  bool is_end(const Record& record) const;

  const std::uint8_t* clip_ = nullptr;
  std::size_t size_ = 0;
  std::size_t at_ = 0;
  int width_ = 0;
  int height_ = 0;
  std::uint32_t samples_ = 0;
  std::uint32_t frames_ = 0;
};

}  // namespace cairn_web

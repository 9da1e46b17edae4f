#pragma once

#include <cstddef>
#include <cstdint>

namespace cairn_web {

/// A clip, read as the input log that it stands for: a source for cairn::InputLogReader.
///
/// A clip is an input log (cairn/runtime/input_log.hpp) whose pictures are packed: it starts with
/// "CAIRNCLP" in place of "CAIRNLOG", and in place of records of type 3 it has records of type 5,
/// whose payload is the frame's head of 20 bytes, as in the log, and a grey JPEG of the camera's
/// size. Everything else is the log's, byte for byte.
class ClipLog {
 public:
  static constexpr int kMaxWidth = 640;
  static constexpr int kMaxHeight = 480;

  /// Starts at the beginning of a clip, which stays the caller's and must outlive the reading.
  void open(const std::uint8_t* clip, std::size_t size);

  /// The log's next bytes; fewer than `count` at the end of the clip and where it is damaged.
  int read(std::uint8_t* bytes, int count);

  /// Bytes of the clip that were used so far.
  std::size_t used() const { return at_; }

 private:
  static constexpr int kPieces = 3;
  struct Piece {
    const std::uint8_t* bytes = nullptr;
    int count = 0;
  };

  bool open_record();
  bool unpack_frame(const std::uint8_t* payload, std::uint32_t size);
  void add(const std::uint8_t* bytes, int count) { pieces_[piece_count_++] = {bytes, count}; }

  const std::uint8_t* clip_ = nullptr;
  std::size_t size_ = 0;
  std::size_t at_ = 0;
  bool started_ = false;
  Piece pieces_[kPieces];  // of the record that is being read
  int piece_count_ = 0;
  int piece_ = 0;
  std::uint8_t magic_[8] = {};
  std::uint8_t head_[28] = {};
  std::uint8_t crc_[4] = {};
  std::uint8_t pixels_[kMaxWidth * kMaxHeight] = {};
};

}  // namespace cairn_web

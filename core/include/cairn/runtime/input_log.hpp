#pragma once

#include <cstdint>

#include "cairn/runtime/detail/input_log_bytes.hpp"
#include "cairn/runtime/input_log_content.hpp"
#include "cairn/vision/image.hpp"

namespace cairn {

/// Writes an input log. Sink: `bool write(const std::uint8_t* bytes, int count)`, false when the
/// bytes could not be stored; every call then returns kFull.
template <class Sink>
class InputLogWriter {
 public:
  explicit InputLogWriter(Sink& sink) : sink_(sink) {}

  /// First call. kBadConfig as InputLogHeader::validate().
  Status begin(const InputLogHeader& header) {
    const Status valid = header.validate();
    if (!ok(valid)) return valid;
    width_ = header.camera.width;
    height_ = header.camera.height;
    std::uint8_t magic[detail::kLogMagicBytes];
    detail::encode_magic(magic);
    if (!sink_.write(magic, detail::kLogMagicBytes)) return Status::kFull;
    std::uint8_t bytes[detail::kLogHeaderBytes];
    detail::encode_header(header, bytes);
    detail::LogHeaderParts parts;
    parts.has_lens = detail::has_lens_bytes(header.camera);
    parts.has_gyro = header.with_gyro;
    parts.has_readout = !header.readout.instant();
    open_record(detail::LogRecord::kHeader,
                static_cast<std::uint32_t>(detail::kLogHeaderBytes + parts.size()));
    put(bytes, detail::kLogHeaderBytes);
    if (parts.has_lens) {
      detail::encode_lens(header.camera, parts.lens);
      put(parts.lens, detail::kLogLensBytes);
    }
    if (parts.has_gyro) {
      detail::encode_gyro(header.gyro, parts.gyro);
      put(parts.gyro, detail::kLogGyroBytes);
    }
    if (parts.has_readout) {
      detail::encode_readout(header.readout, parts.readout);
      put(parts.readout, detail::kLogReadoutBytes);
    }
    return close_record();
  }

  Status odometry(const OdometrySample& sample) {
    std::uint8_t bytes[detail::kLogOdometryBytes];
    detail::encode_odometry(sample, bytes);
    ++samples_;
    return record(detail::LogRecord::kOdometry, bytes);
  }

  /// Domain: the header has with_gyro.
  Status angular_rate(const AngularRateSample& sample) {
    std::uint8_t bytes[detail::kLogAngularRateBytes];
    detail::encode_angular_rate(sample, bytes);
    ++samples_;
    return record(detail::LogRecord::kAngularRate, bytes);
  }

  /// kInvalidArgument unless the image has the size of the header's camera.
  Status frame(const LogFrame& frame, const ImageView& image) {
    if (!image.valid() || image.width != width_ || image.height != height_) {
      return Status::kInvalidArgument;
    }
    std::uint8_t head[detail::kLogFrameHeadBytes];
    detail::encode_frame_head(frame, width_, height_, head);
    ++frames_;
    open_record(detail::LogRecord::kFrame,
                static_cast<std::uint32_t>(detail::kLogFrameHeadBytes + width_ * height_));
    put(head, detail::kLogFrameHeadBytes);
    for (int y = 0; y < height_; ++y) put(image.row(y), width_);
    return close_record();
  }

  /// Last call.
  Status end() {
    std::uint8_t bytes[detail::kLogEndBytes];
    detail::encode_end(samples_, frames_, bytes);
    return record(detail::LogRecord::kEnd, bytes);
  }

 private:
  template <int Count>
  Status record(detail::LogRecord type, const std::uint8_t (&payload)[Count]) {
    open_record(type, Count);
    put(payload, Count);
    return close_record();
  }
  void open_record(detail::LogRecord type, std::uint32_t payload_bytes) {
    crc_ = 0;
    stored_ = true;
    std::uint8_t head[detail::kLogRecordHeadBytes];
    detail::encode_record_head(type, payload_bytes, head);
    put(head, detail::kLogRecordHeadBytes);
  }
  void put(const std::uint8_t* bytes, int count) {
    crc_ = detail::crc32(crc_, bytes, count);
    stored_ = stored_ && sink_.write(bytes, count);
  }
  Status close_record() {
    std::uint8_t bytes[4];
    detail::encode_u32(crc_, bytes);
    return stored_ && sink_.write(bytes, 4) ? Status::kOk : Status::kFull;
  }

  Sink& sink_;
  int width_ = 0;
  int height_ = 0;
  std::uint32_t samples_ = 0;
  std::uint32_t frames_ = 0;
  std::uint32_t crc_ = 0;
  bool stored_ = true;
};

/// Reads an input log. Source: `int read(std::uint8_t* bytes, int count)`, the number of bytes
/// read. Whatever the bytes are, it ends in a Status and reads no more than the log's own sizes
/// allow.
template <class Source>
class InputLogReader {
 public:
  explicit InputLogReader(Source& source) : source_(source) {}

  /// First call. kCorrupt for anything but an input log, kVersionMismatch for one of another
  /// version, kBadConfig for impossible values; `header` is set on kOk alone.
  Status open(InputLogHeader& header) {
    std::uint8_t magic[detail::kLogMagicBytes];
    if (!get(magic, detail::kLogMagicBytes) || !detail::is_magic(magic)) return Status::kCorrupt;
    detail::LogRecord type{};
    std::uint32_t size = 0;
    std::uint8_t bytes[detail::kLogHeaderBytes];
    detail::LogHeaderParts parts;
    if (!ok(open_record(type, size)) || type != detail::LogRecord::kHeader) return Status::kCorrupt;
    if (size < detail::kLogHeaderBytes || !parts.of_size(size - detail::kLogHeaderBytes) ||
        !get(bytes, detail::kLogHeaderBytes) ||
        (parts.has_lens && !get(parts.lens, detail::kLogLensBytes)) ||
        (parts.has_gyro && !get(parts.gyro, detail::kLogGyroBytes)) ||
        (parts.has_readout && !get(parts.readout, detail::kLogReadoutBytes)) || !close_record()) {
      return Status::kCorrupt;
    }
    InputLogHeader decoded;
    const Status status = detail::decode_header(bytes, parts, decoded);
    if (!ok(status)) return status;
    header = decoded;
    width_ = decoded.camera.width;
    height_ = decoded.camera.height;
    with_gyro_ = parts.has_gyro;
    opened_ = true;
    return Status::kOk;
  }

  /// Next event. A sample goes to `sample`, one of a gyroscope to angular_rate(), a frame to
  /// `frame` and the pixels to `image`, whose size must be the header camera's (kInvalidArgument).
  /// kCorrupt when the log is cut short or damaged; outputs may then hold anything. kNotInitialised
  /// before open(). Bounded by the frame's size.
  Status next(LogEvent& event, OdometrySample& sample, LogFrame& frame, MutableImageView image) {
    if (!opened_) return Status::kNotInitialised;
    if (image.data == nullptr || image.width != width_ || image.height != height_ ||
        image.stride < width_) {
      return Status::kInvalidArgument;
    }
    detail::LogRecord type{};
    std::uint32_t size = 0;
    const Status status = open_record(type, size);
    if (!ok(status)) return status;
    switch (type) {
      case detail::LogRecord::kOdometry:
        event = LogEvent::kOdometry;
        return read_odometry(size, sample);
      case detail::LogRecord::kFrame:
        event = LogEvent::kFrame;
        return read_frame(size, frame, image);
      case detail::LogRecord::kEnd:
        event = LogEvent::kEnd;
        return read_end(size);
      case detail::LogRecord::kAngularRate:
        event = LogEvent::kAngularRate;
        return with_gyro_ ? read_angular_rate(size) : Status::kCorrupt;
      case detail::LogRecord::kHeader:
        break;
    }
    return Status::kCorrupt;
  }

  /// The gyroscope's sample of the last event, kAngularRate.
  const AngularRateSample& angular_rate() const { return angular_rate_; }

 private:
  Status read_angular_rate(std::uint32_t size) {
    std::uint8_t bytes[detail::kLogAngularRateBytes];
    if (size != detail::kLogAngularRateBytes || !get(bytes, detail::kLogAngularRateBytes) ||
        !close_record()) {
      return Status::kCorrupt;
    }
    ++samples_;
    detail::decode_angular_rate(bytes, angular_rate_);
    return Status::kOk;
  }

  Status read_odometry(std::uint32_t size, OdometrySample& sample) {
    std::uint8_t bytes[detail::kLogOdometryBytes];
    if (size != detail::kLogOdometryBytes || !get(bytes, detail::kLogOdometryBytes) ||
        !close_record()) {
      return Status::kCorrupt;
    }
    ++samples_;
    return detail::decode_odometry(bytes, sample);
  }

  Status read_frame(std::uint32_t size, LogFrame& frame, MutableImageView image) {
    std::uint8_t head[detail::kLogFrameHeadBytes];
    if (size != static_cast<std::uint32_t>(detail::kLogFrameHeadBytes + width_ * height_) ||
        !get(head, detail::kLogFrameHeadBytes)) {
      return Status::kCorrupt;
    }
    int width = 0;
    int height = 0;
    detail::decode_frame_head(head, frame, width, height);
    if (width != width_ || height != height_) return Status::kCorrupt;
    for (int y = 0; y < height_; ++y) {
      if (!get(image.row(y), width_)) return Status::kCorrupt;
    }
    ++frames_;
    return close_record() ? Status::kOk : Status::kCorrupt;
  }

  Status read_end(std::uint32_t size) {
    std::uint8_t bytes[detail::kLogEndBytes];
    if (size != detail::kLogEndBytes || !get(bytes, detail::kLogEndBytes) || !close_record()) {
      return Status::kCorrupt;
    }
    std::uint32_t samples = 0;
    std::uint32_t frames = 0;
    detail::decode_end(bytes, samples, frames);
    return samples == samples_ && frames == frames_ ? Status::kOk : Status::kCorrupt;
  }

  Status open_record(detail::LogRecord& type, std::uint32_t& size) {
    crc_ = 0;
    std::uint8_t head[detail::kLogRecordHeadBytes];
    if (!get(head, detail::kLogRecordHeadBytes)) return Status::kCorrupt;
    return detail::decode_record_head(head, type, size);
  }
  bool close_record() {
    const std::uint32_t expected = crc_;
    std::uint8_t bytes[4];
    return get(bytes, 4) && detail::decode_u32(bytes) == expected;
  }
  bool get(std::uint8_t* bytes, int count) {
    if (source_.read(bytes, count) != count) return false;
    crc_ = detail::crc32(crc_, bytes, count);
    return true;
  }

  Source& source_;
  int width_ = 0;
  int height_ = 0;
  std::uint32_t samples_ = 0;
  std::uint32_t frames_ = 0;
  std::uint32_t crc_ = 0;
  AngularRateSample angular_rate_;
  bool with_gyro_ = false;
  bool opened_ = false;
};

}  // namespace cairn

#pragma once

#include <cstdint>

#include "cairn/base/status.hpp"
#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/planar/tilt.hpp"
#include "cairn/tracking/angular_rate.hpp"
#include "cairn/tracking/frame_report.hpp"
#include "cairn/vision/image.hpp"

namespace cairn {

/// Input log: everything that a run's result depends on, in one stream of bytes that replays on any
/// target. Little endian. "CAIRNLOG", then records of {u8 type, u8[3] zero, u32 payload bytes,
/// payload, u32 CRC-32 (IEEE 802.3) of all before it in the record}: one header, then odometry and
/// frames in time order, then one end record with their counts. A log of a rational or a fisheye
/// lens has a header with 16 bytes more and version kInputLogLensVersion; one whose focal length is
/// estimated, with either header, has kInputLogFocalVersion; one with a gyroscope has
/// 48 bytes more behind either, its samples among the odometry's and frames, and
/// kInputLogGyroVersion.
inline constexpr std::uint16_t kInputLogVersion = 3;
inline constexpr std::uint16_t kInputLogLensVersion = 4;
inline constexpr std::uint16_t kInputLogFocalVersion = 5;
inline constexpr std::uint16_t kInputLogGyroVersion = 6;

enum class LogMode : std::uint8_t { kVehicle = 0, kHandheld = 1 };
enum class LogFilter : std::uint8_t {
  kGroupIekf = 0,
  kLiftedIekf = 1,
  kEkf = 2,
  kMono = 3,
  kWindow = 4
};

/// What a tracker is set up with. Float throughout: the host rounds once, when it writes the log,
/// so that boards without double read the same numbers.
struct InputLogHeader {
  LogMode mode = LogMode::kVehicle;
  LogFilter filter = LogFilter::kGroupIekf;
  OdometrySample::Kind odometry_kind = OdometrySample::Kind::kTwist;
  bool adaptive_fading = false;
  float fading = 1.0F;  ///< fading-memory factor S, 1 <= S <= 2
  /// Of the focal length, in 1/10,000 of it, at most 10,000. kWindow alone.
  std::uint16_t focal_sigma_e4 = 0;
  std::uint64_t seed = 1;
  std::int64_t start_t_us = 0;  ///< time of the start pose: the first frame's
  PinholeCamera<float> camera;
  Rigid<float> T_vehicle_camera;
  float speed_sigma_mps = 0.0F;
  float turn_sigma = 0.0F;   ///< rad/s (kTwist) or rad (kAckermann)
  float wheelbase_m = 0.0F;  ///< kAckermann alone
  float odometry_period_s = 0.1F;
  float frame_rate_hz = 30.0F;
  float start_x_m = 0.0F;
  float start_y_m = 0.0F;
  float start_theta_rad = 0.0F;
  float start_position_variance = 0.0F;
  float start_heading_variance = 0.0F;
  TiltParameters<float> tilt;  ///< of the vehicle's body
  bool with_gyro = false;      ///< the log has samples of a gyroscope
  GyroParameters gyro;

  /// kBadConfig unless every value is finite and in its domain.
  Status validate() const;
};

struct LogFrame {
  static constexpr std::int32_t kOwnWorkLimit = -1;

  std::uint32_t number = 0;
  std::int64_t t_us = 0;
  std::int32_t work_limit = kOwnWorkLimit;  ///< units (WorkBudget), or the tracker's own
};

enum class LogEvent : std::uint8_t { kOdometry, kFrame, kEnd, kAngularRate };

namespace detail {

inline constexpr int kLogMagicBytes = 8;
inline constexpr int kLogRecordHeadBytes = 8;
inline constexpr int kLogHeaderBytes = 148;
inline constexpr int kLogLensBytes = 16;  // k4, k5, k6, u32 lens
inline constexpr int kLogGyroBytes = 48;  // R_camera_gyro, six numbers, u64 gap
inline constexpr int kLogOdometryBytes = 20;
inline constexpr int kLogAngularRateBytes = 20;
inline constexpr int kLogFrameHeadBytes = 20;
inline constexpr int kLogEndBytes = 8;

enum class LogRecord : std::uint8_t {
  kHeader = 1,
  kOdometry = 2,
  kFrame = 3,
  kEnd = 4,
  kAngularRate = 5
};

/// CRC-32 as zlib's crc32(): start with 0, feed the result back in.
std::uint32_t crc32(std::uint32_t crc, const std::uint8_t* bytes, int count);

void encode_magic(std::uint8_t (&bytes)[kLogMagicBytes]);
bool is_magic(const std::uint8_t (&bytes)[kLogMagicBytes]);
void encode_record_head(LogRecord type, std::uint32_t payload_bytes,
                        std::uint8_t (&bytes)[kLogRecordHeadBytes]);
/// kCorrupt when the head is no head of a record.
Status decode_record_head(const std::uint8_t (&bytes)[kLogRecordHeadBytes], LogRecord& type,
                          std::uint32_t& payload_bytes);
void encode_u32(std::uint32_t value, std::uint8_t (&bytes)[4]);
std::uint32_t decode_u32(const std::uint8_t (&bytes)[4]);
/// Whether a camera needs the bytes of encode_lens() behind its header.
bool has_lens_bytes(const PinholeCamera<float>& camera);
void encode_header(const InputLogHeader& header, std::uint8_t (&bytes)[kLogHeaderBytes]);
void encode_lens(const PinholeCamera<float>& camera, std::uint8_t (&bytes)[kLogLensBytes]);
void encode_gyro(const GyroParameters& gyro, std::uint8_t (&bytes)[kLogGyroBytes]);
/// `lens`, `gyro`: the kLogLensBytes and kLogGyroBytes behind the header, or null.
/// kVersionMismatch, or kBadConfig as InputLogHeader::validate().
Status decode_header(const std::uint8_t (&bytes)[kLogHeaderBytes], const std::uint8_t* lens,
                     const std::uint8_t* gyro, InputLogHeader& header);
void encode_odometry(const OdometrySample& sample, std::uint8_t (&bytes)[kLogOdometryBytes]);
/// kCorrupt for an unknown kind. The numbers are the tracker's to judge.
Status decode_odometry(const std::uint8_t (&bytes)[kLogOdometryBytes], OdometrySample& sample);
void encode_angular_rate(const AngularRateSample& sample,
                         std::uint8_t (&bytes)[kLogAngularRateBytes]);
/// The numbers are the tracker's to judge.
void decode_angular_rate(const std::uint8_t (&bytes)[kLogAngularRateBytes],
                         AngularRateSample& sample);
void encode_frame_head(const LogFrame& frame, int width, int height,
                       std::uint8_t (&bytes)[kLogFrameHeadBytes]);
void decode_frame_head(const std::uint8_t (&bytes)[kLogFrameHeadBytes], LogFrame& frame, int& width,
                       int& height);
void encode_end(std::uint32_t samples, std::uint32_t frames, std::uint8_t (&bytes)[kLogEndBytes]);
void decode_end(const std::uint8_t (&bytes)[kLogEndBytes], std::uint32_t& samples,
                std::uint32_t& frames);

}  // namespace detail

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
    const bool with_lens = detail::has_lens_bytes(header.camera);
    const int more =
        (with_lens ? detail::kLogLensBytes : 0) + (header.with_gyro ? detail::kLogGyroBytes : 0);
    open_record(detail::LogRecord::kHeader,
                static_cast<std::uint32_t>(detail::kLogHeaderBytes + more));
    put(bytes, detail::kLogHeaderBytes);
    if (with_lens) {
      std::uint8_t lens[detail::kLogLensBytes];
      detail::encode_lens(header.camera, lens);
      put(lens, detail::kLogLensBytes);
    }
    if (header.with_gyro) {
      std::uint8_t gyro[detail::kLogGyroBytes];
      detail::encode_gyro(header.gyro, gyro);
      put(gyro, detail::kLogGyroBytes);
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
    std::uint8_t lens[detail::kLogLensBytes];
    std::uint8_t gyro[detail::kLogGyroBytes];
    if (!ok(open_record(type, size)) || type != detail::LogRecord::kHeader) return Status::kCorrupt;
    const auto has = [size](int more) {
      return size == static_cast<std::uint32_t>(detail::kLogHeaderBytes + more);
    };
    const bool has_both = has(detail::kLogLensBytes + detail::kLogGyroBytes);
    const bool has_lens = has_both || has(detail::kLogLensBytes);
    const bool has_gyro = has_both || has(detail::kLogGyroBytes);
    if ((!has(0) && !has_lens && !has_gyro) || !get(bytes, detail::kLogHeaderBytes) ||
        (has_lens && !get(lens, detail::kLogLensBytes)) ||
        (has_gyro && !get(gyro, detail::kLogGyroBytes)) || !close_record()) {
      return Status::kCorrupt;
    }
    InputLogHeader decoded;
    const Status status =
        detail::decode_header(bytes, has_lens ? lens : nullptr, has_gyro ? gyro : nullptr, decoded);
    if (!ok(status)) return status;
    header = decoded;
    width_ = decoded.camera.width;
    height_ = decoded.camera.height;
    with_gyro_ = has_gyro;
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

#pragma once

#include <cstdint>

#include "cairn/runtime/input_log_content.hpp"

// The bytes of an input log's records: into and out of arrays of their size.

namespace cairn::detail {

inline constexpr int kLogMagicBytes = 8;
inline constexpr int kLogRecordHeadBytes = 8;
inline constexpr int kLogHeaderBytes = 148;
inline constexpr int kLogLensBytes = 16;    // k4, k5, k6, u32 lens
inline constexpr int kLogGyroBytes = 48;    // R_camera_gyro, six numbers, u64 gap
inline constexpr int kLogReadoutBytes = 8;  // row and column time
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
void encode_readout(const ReadoutTimes& readout, std::uint8_t (&bytes)[kLogReadoutBytes]);

/// What a header's record holds behind the header, in this order.
struct LogHeaderParts {
  bool has_lens = false;
  bool has_gyro = false;
  bool has_readout = false;
  std::uint8_t lens[kLogLensBytes];
  std::uint8_t gyro[kLogGyroBytes];
  std::uint8_t readout[kLogReadoutBytes];

  /// False where no such parts have so many bytes.
  bool of_size(std::uint32_t bytes) {
    const auto is = [bytes](int size) { return bytes == static_cast<std::uint32_t>(size); };
    for (int parts = 0; parts < 8; ++parts) {
      has_lens = (parts & 1) != 0;
      has_gyro = (parts & 2) != 0;
      has_readout = (parts & 4) != 0;
      if (is(size())) return true;
    }
    return false;
  }
  int size() const {
    return (has_lens ? kLogLensBytes : 0) + (has_gyro ? kLogGyroBytes : 0) +
           (has_readout ? kLogReadoutBytes : 0);
  }
};
/// kVersionMismatch, or kBadConfig as InputLogHeader::validate().
Status decode_header(const std::uint8_t (&bytes)[kLogHeaderBytes], const LogHeaderParts& parts,
                     InputLogHeader& header);
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

}  // namespace cairn::detail

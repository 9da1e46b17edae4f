#include "cairn/runtime/input_log.hpp"

#include <cstring>

namespace cairn {
namespace {

constexpr char kMagic[] = "CAIRNLOG";

/// Little-endian fields one after the other, into or out of an array that the caller sized.
class Packer {
 public:
  explicit Packer(std::uint8_t* at) : at_(at) {}

  void u8(std::uint8_t value) { *at_++ = value; }
  void u16(std::uint16_t value) {
    u8(static_cast<std::uint8_t>(value & 0xFFU));
    u8(static_cast<std::uint8_t>(value >> 8U));
  }
  void u32(std::uint32_t value) {
    u16(static_cast<std::uint16_t>(value & 0xFFFFU));
    u16(static_cast<std::uint16_t>(value >> 16U));
  }
  void u64(std::uint64_t value) {
    u32(static_cast<std::uint32_t>(value & 0xFFFFFFFFU));
    u32(static_cast<std::uint32_t>(value >> 32U));
  }
  void f32(float value) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    u32(bits);
  }

 private:
  std::uint8_t* at_;
};

class Unpacker {
 public:
  explicit Unpacker(const std::uint8_t* at) : at_(at) {}

  std::uint8_t u8() { return *at_++; }
  std::uint16_t u16() {
    const std::uint32_t low = u8();
    const std::uint32_t high = u8();
    return static_cast<std::uint16_t>(low | (high << 8U));
  }
  std::uint32_t u32() {
    const std::uint32_t low = u16();
    const std::uint32_t high = u16();
    return low | (high << 16U);
  }
  std::uint64_t u64() {
    const std::uint64_t low = u32();
    const std::uint64_t high = u32();
    return low | (high << 32U);
  }
  float f32() {
    const std::uint32_t bits = u32();
    float value = 0.0F;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }

 private:
  const std::uint8_t* at_;
};

std::uint16_t version_of(bool with_readout, bool with_gyro, bool with_focal, bool with_lens) {
  if (with_readout) return kInputLogReadoutVersion;
  if (with_gyro) return kInputLogGyroVersion;
  if (with_focal) return kInputLogFocalVersion;
  return with_lens ? kInputLogLensVersion : kInputLogVersion;
}

}  // namespace

namespace detail {

std::uint32_t crc32(std::uint32_t crc, const std::uint8_t* bytes, int count) {
  // Reflected polynomial 0xEDB88320, four bits at a time.
  static constexpr std::uint32_t kNibble[16] = {0x00000000U, 0x1DB71064U, 0x3B6E20C8U, 0x26D930ACU,
                                                0x76DC4190U, 0x6B6B51F4U, 0x4DB26158U, 0x5005713CU,
                                                0xEDB88320U, 0xF00F9344U, 0xD6D6A3E8U, 0xCB61B38CU,
                                                0x9B64C2B0U, 0x86D3D2D4U, 0xA00AE278U, 0xBDBDF21CU};
  crc = ~crc;
  for (int i = 0; i < count; ++i) {
    crc ^= bytes[i];
    crc = (crc >> 4U) ^ kNibble[crc & 15U];
    crc = (crc >> 4U) ^ kNibble[crc & 15U];
  }
  return ~crc;
}

void encode_magic(std::uint8_t (&bytes)[kLogMagicBytes]) {
  std::memcpy(bytes, kMagic, kLogMagicBytes);
}

bool is_magic(const std::uint8_t (&bytes)[kLogMagicBytes]) {
  return std::memcmp(bytes, kMagic, kLogMagicBytes) == 0;
}

void encode_record_head(LogRecord type, std::uint32_t payload_bytes,
                        std::uint8_t (&bytes)[kLogRecordHeadBytes]) {
  Packer pack(bytes);
  pack.u32(static_cast<std::uint32_t>(type));
  pack.u32(payload_bytes);
}

Status decode_record_head(const std::uint8_t (&bytes)[kLogRecordHeadBytes], LogRecord& type,
                          std::uint32_t& payload_bytes) {
  Unpacker unpack(bytes);
  const std::uint32_t value = unpack.u32();
  if (value < 1U || value > 5U) return Status::kCorrupt;
  type = static_cast<LogRecord>(value);
  payload_bytes = unpack.u32();
  return Status::kOk;
}

void encode_u32(std::uint32_t value, std::uint8_t (&bytes)[4]) {
  Packer(bytes).u32(value);
}

std::uint32_t decode_u32(const std::uint8_t (&bytes)[4]) {
  return Unpacker(bytes).u32();
}

bool has_lens_bytes(const PinholeCamera<float>& camera) {
  return camera.is_rational() || camera.lens != Lens::kRadialTangential;
}

void encode_lens(const PinholeCamera<float>& camera, std::uint8_t (&bytes)[kLogLensBytes]) {
  Packer pack(bytes);
  for (const float value : {camera.k4, camera.k5, camera.k6}) pack.f32(value);
  pack.u32(static_cast<std::uint32_t>(camera.lens));
}

void encode_header(const InputLogHeader& header, std::uint8_t (&bytes)[kLogHeaderBytes]) {
  std::memset(bytes, 0, kLogHeaderBytes);
  Packer pack(bytes);
  pack.u16(version_of(!header.readout.instant(), header.with_gyro, header.focal_sigma_e4 > 0,
                      has_lens_bytes(header.camera)));
  pack.u8(static_cast<std::uint8_t>(header.mode));
  pack.u8(static_cast<std::uint8_t>(header.filter));
  pack.u8(static_cast<std::uint8_t>(header.odometry_kind));
  pack.u8(header.adaptive_fading ? 1 : 0);
  pack.u16(static_cast<std::uint16_t>(header.camera.width));
  pack.u16(static_cast<std::uint16_t>(header.camera.height));
  pack.u16(header.focal_sigma_e4);
  pack.f32(header.fading);
  pack.u64(header.seed);
  pack.u64(static_cast<std::uint64_t>(header.start_t_us));
  const PinholeCamera<float>& c = header.camera;
  for (const float value : {c.fx, c.fy, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2, c.k3}) pack.f32(value);
  const Rigid<float>& T = header.T_vehicle_camera;
  for (const float value : {T.rotation.w(), T.rotation.x(), T.rotation.y(), T.rotation.z(),
                            T.translation.x(), T.translation.y(), T.translation.z()}) {
    pack.f32(value);
  }
  for (const float value :
       {header.speed_sigma_mps, header.turn_sigma, header.wheelbase_m, header.odometry_period_s,
        header.frame_rate_hz, header.start_x_m, header.start_y_m, header.start_theta_rad,
        header.start_position_variance, header.start_heading_variance, header.tilt.sigma_pitch_rad,
        header.tilt.sigma_roll_rad, header.tilt.time_constant_s}) {
    pack.f32(value);
  }
}

void encode_gyro(const GyroParameters& gyro, std::uint8_t (&bytes)[kLogGyroBytes]) {
  Packer pack(bytes);
  const Quaternion<float>& q = gyro.R_camera_gyro;
  for (const float value :
       {q.w(), q.x(), q.y(), q.z(), gyro.noise_density, gyro.bias_sigma_radps, gyro.bias_walk,
        gyro.scale_sigma, gyro.time_sigma_s, gyro.range_radps}) {
    pack.f32(value);
  }
  pack.u64(static_cast<std::uint64_t>(gyro.max_gap_us));
}

void encode_readout(const ReadoutTimes& readout, std::uint8_t (&bytes)[kLogReadoutBytes]) {
  Packer pack(bytes);
  pack.f32(readout.row_time_s);
  pack.f32(readout.column_time_s);
}

namespace {

void decode_gyro(const std::uint8_t* bytes, GyroParameters& gyro) {
  Unpacker unpack(bytes);
  Quaternion<float>& q = gyro.R_camera_gyro;
  for (float* value : {&q.w(), &q.x(), &q.y(), &q.z(), &gyro.noise_density, &gyro.bias_sigma_radps,
                       &gyro.bias_walk, &gyro.scale_sigma, &gyro.time_sigma_s, &gyro.range_radps}) {
    *value = unpack.f32();
  }
  gyro.max_gap_us = static_cast<std::int64_t>(unpack.u64());
}

}  // namespace

Status decode_header(const std::uint8_t (&bytes)[kLogHeaderBytes], const LogHeaderParts& parts,
                     InputLogHeader& header) {
  Unpacker unpack(bytes);
  const std::uint16_t version = unpack.u16();
  const bool with_focal = parts.has_gyro || parts.has_readout || version == kInputLogFocalVersion;
  if (version != version_of(parts.has_readout, parts.has_gyro, with_focal, parts.has_lens)) {
    return Status::kVersionMismatch;
  }
  const std::uint8_t mode = unpack.u8();
  const std::uint8_t filter = unpack.u8();
  const std::uint8_t odometry_kind = unpack.u8();
  const std::uint8_t adaptive = unpack.u8();
  if (mode > 1 || filter > 5 || odometry_kind >= OdometrySample::kKindCount || adaptive > 1)
    return Status::kBadConfig;
  header.mode = static_cast<LogMode>(mode);
  header.filter = static_cast<LogFilter>(filter);
  header.odometry_kind = static_cast<OdometrySample::Kind>(odometry_kind);
  header.adaptive_fading = adaptive == 1;
  header.camera.width = unpack.u16();
  header.camera.height = unpack.u16();
  const std::uint16_t focal_sigma_e4 = unpack.u16();
  header.focal_sigma_e4 = with_focal ? focal_sigma_e4 : std::uint16_t{0};
  header.fading = unpack.f32();
  header.seed = unpack.u64();
  header.start_t_us = static_cast<std::int64_t>(unpack.u64());
  PinholeCamera<float>& c = header.camera;
  for (float* value : {&c.fx, &c.fy, &c.cx, &c.cy, &c.k1, &c.k2, &c.p1, &c.p2, &c.k3}) {
    *value = unpack.f32();
  }
  if (parts.has_lens) {
    Unpacker unpack_lens(parts.lens);
    for (float* value : {&c.k4, &c.k5, &c.k6}) *value = unpack_lens.f32();
    const std::uint32_t model = unpack_lens.u32();
    if (model > 1U) return Status::kBadConfig;
    c.lens = static_cast<Lens>(model);
  }
  header.with_gyro = parts.has_gyro;
  if (parts.has_gyro) decode_gyro(parts.gyro, header.gyro);
  if (parts.has_readout) {
    Unpacker unpack_readout(parts.readout);
    header.readout.row_time_s = unpack_readout.f32();
    header.readout.column_time_s = unpack_readout.f32();
  }
  Rigid<float>& T = header.T_vehicle_camera;
  for (float* value : {&T.rotation.w(), &T.rotation.x(), &T.rotation.y(), &T.rotation.z(),
                       &T.translation.x(), &T.translation.y(), &T.translation.z()}) {
    *value = unpack.f32();
  }
  for (float* value :
       {&header.speed_sigma_mps, &header.turn_sigma, &header.wheelbase_m, &header.odometry_period_s,
        &header.frame_rate_hz, &header.start_x_m, &header.start_y_m, &header.start_theta_rad,
        &header.start_position_variance, &header.start_heading_variance,
        &header.tilt.sigma_pitch_rad, &header.tilt.sigma_roll_rad, &header.tilt.time_constant_s}) {
    *value = unpack.f32();
  }
  return header.validate();
}

void encode_odometry(const OdometrySample& sample, std::uint8_t (&bytes)[kLogOdometryBytes]) {
  Packer pack(bytes);
  pack.u64(static_cast<std::uint64_t>(sample.t_us));
  pack.u32(static_cast<std::uint32_t>(sample.kind));
  pack.f32(sample.speed_mps);
  pack.f32(sample.turn);
}

Status decode_odometry(const std::uint8_t (&bytes)[kLogOdometryBytes], OdometrySample& sample) {
  Unpacker unpack(bytes);
  const auto t_us = static_cast<std::int64_t>(unpack.u64());
  const std::uint32_t kind = unpack.u32();
  if (kind >= OdometrySample::kKindCount) return Status::kCorrupt;
  sample.t_us = t_us;
  sample.kind = static_cast<OdometrySample::Kind>(kind);
  sample.speed_mps = unpack.f32();
  sample.turn = unpack.f32();
  return Status::kOk;
}

void encode_angular_rate(const AngularRateSample& sample,
                         std::uint8_t (&bytes)[kLogAngularRateBytes]) {
  Packer pack(bytes);
  pack.u64(static_cast<std::uint64_t>(sample.t_us));
  for (int i = 0; i < 3; ++i) pack.f32(sample.rate_radps(i));
}

void decode_angular_rate(const std::uint8_t (&bytes)[kLogAngularRateBytes],
                         AngularRateSample& sample) {
  Unpacker unpack(bytes);
  sample.t_us = static_cast<std::int64_t>(unpack.u64());
  for (int i = 0; i < 3; ++i) sample.rate_radps(i) = unpack.f32();
}

void encode_frame_head(const LogFrame& frame, int width, int height,
                       std::uint8_t (&bytes)[kLogFrameHeadBytes]) {
  Packer pack(bytes);
  pack.u64(static_cast<std::uint64_t>(frame.t_us));
  pack.u32(frame.number);
  pack.u16(static_cast<std::uint16_t>(width));
  pack.u16(static_cast<std::uint16_t>(height));
  pack.u32(static_cast<std::uint32_t>(frame.work_limit));
}

void decode_frame_head(const std::uint8_t (&bytes)[kLogFrameHeadBytes], LogFrame& frame, int& width,
                       int& height) {
  Unpacker unpack(bytes);
  frame.t_us = static_cast<std::int64_t>(unpack.u64());
  frame.number = unpack.u32();
  width = unpack.u16();
  height = unpack.u16();
  frame.work_limit = static_cast<std::int32_t>(unpack.u32());
}

void encode_end(std::uint32_t samples, std::uint32_t frames, std::uint8_t (&bytes)[kLogEndBytes]) {
  Packer pack(bytes);
  pack.u32(samples);
  pack.u32(frames);
}

void decode_end(const std::uint8_t (&bytes)[kLogEndBytes], std::uint32_t& samples,
                std::uint32_t& frames) {
  Unpacker unpack(bytes);
  samples = unpack.u32();
  frames = unpack.u32();
}

}  // namespace detail
}  // namespace cairn

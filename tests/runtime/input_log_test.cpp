#include "cairn/runtime/input_log.hpp"

#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace cairn {
namespace {

struct Memory {
  std::vector<std::uint8_t> bytes;
  std::size_t at = 0;

  bool write(const std::uint8_t* data, int count) {
    bytes.insert(bytes.end(), data, data + count);
    return true;
  }
  int read(std::uint8_t* data, int count) {
    const std::size_t rest = bytes.size() - at;
    const std::size_t got = std::min(rest, static_cast<std::size_t>(count));
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), got, data);
    at += got;
    return static_cast<int>(got);
  }
};

constexpr int kWidth = 12;
constexpr int kHeight = 5;

InputLogHeader make_header() {
  InputLogHeader header;
  header.mode = LogMode::kVehicle;
  header.filter = LogFilter::kLiftedIekf;
  header.odometry_kind = OdometrySample::Kind::kAckermann;
  header.adaptive_fading = true;
  header.fading = 1.009F;
  header.start_t_us = -7;
  header.seed = 0x123456789ABCDEF0ULL;
  header.camera = {10.0F, 11.0F, 6.0F, 2.5F, 0.1F, -0.2F, 0.01F, -0.02F, 0.3F, kWidth, kHeight};
  header.T_vehicle_camera.rotation = Quaternion<float>(0.5F, -0.5F, 0.5F, -0.5F);
  header.T_vehicle_camera.translation = {0.1F, -0.2F, 0.3F};
  header.wheelbase_m = 2.83F;
  header.start_heading_variance = 0.03F;
  header.tilt = {0.01F, 0.02F, 1.5F};
  return header;
}

OdometrySample make_sample(int i) {
  OdometrySample sample;
  sample.t_us = -5'000'000'000LL + 1000LL * i;
  sample.kind = OdometrySample::Kind::kAckermann;
  sample.speed_mps = 0.5F + 0.25F * static_cast<float>(i);
  sample.turn = -0.1F;
  return sample;
}

std::vector<std::uint8_t> make_pixels(int seed) {
  std::vector<std::uint8_t> pixels(kWidth * kHeight);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    pixels[i] = static_cast<std::uint8_t>(31U * i + static_cast<std::size_t>(seed));
  }
  return pixels;
}

Memory make_log() {
  Memory memory;
  InputLogWriter<Memory> writer(memory);
  EXPECT_EQ(writer.begin(make_header()), Status::kOk);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(writer.odometry(make_sample(i)), Status::kOk);
    const auto pixels = make_pixels(i);
    EXPECT_EQ(writer.frame({static_cast<std::uint32_t>(100 + i), 1000LL * i},
                           {pixels.data(), kWidth, kHeight, kWidth}),
              Status::kOk);
  }
  EXPECT_EQ(writer.end(), Status::kOk);
  return memory;
}

struct Replay {
  Status status = Status::kOk;
  InputLogHeader header;
  std::vector<OdometrySample> samples;
  std::vector<AngularRateSample> rates;
  std::vector<LogFrame> frames;
  std::vector<std::vector<std::uint8_t>> images;
};

Replay read_log(Memory memory) {
  memory.at = 0;
  Replay replay;
  InputLogReader<Memory> reader(memory);
  replay.status = reader.open(replay.header);
  std::vector<std::uint8_t> pixels(kWidth * kHeight);
  LogEvent event = LogEvent::kOdometry;
  while (ok(replay.status)) {
    OdometrySample sample;
    LogFrame frame;
    replay.status = reader.next(event, sample, frame, {pixels.data(), kWidth, kHeight, kWidth});
    if (!ok(replay.status) || event == LogEvent::kEnd) break;
    if (event == LogEvent::kOdometry) replay.samples.push_back(sample);
    if (event == LogEvent::kAngularRate) replay.rates.push_back(reader.angular_rate());
    if (event == LogEvent::kFrame) {
      replay.frames.push_back(frame);
      replay.images.push_back(pixels);
    }
  }
  return replay;
}

InputLogHeader make_gyro_header() {
  InputLogHeader header = make_header();
  header.mode = LogMode::kHandheld;
  header.filter = LogFilter::kWindow;
  header.focal_sigma_e4 = 1000;
  header.with_gyro = true;
  header.gyro.R_camera_gyro = Quaternion<float>(0.5F, 0.5F, -0.5F, 0.5F);
  header.gyro.noise_density = 2e-4F;
  header.gyro.bias_sigma_radps = 0.03F;
  header.gyro.bias_walk = 2e-5F;
  header.gyro.scale_sigma = 0.02F;
  header.gyro.time_sigma_s = 0.004F;
  header.gyro.range_radps = 8.7F;
  header.gyro.max_gap_us = 20000;
  return header;
}

Memory make_gyro_log(const InputLogHeader& header) {
  Memory memory;
  InputLogWriter<Memory> writer(memory);
  EXPECT_EQ(writer.begin(header), Status::kOk);
  EXPECT_EQ(writer.angular_rate({1234567890123, {0.5F, -1.5F, 2.5F}}), Status::kOk);
  const auto pixels = make_pixels(0);
  EXPECT_EQ(writer.frame({7, 1234567890200}, {pixels.data(), kWidth, kHeight, kWidth}),
            Status::kOk);
  EXPECT_EQ(writer.end(), Status::kOk);
  return memory;
}

TEST(InputLog, CarriesAGyroscope) {
  for (const bool with_lens : {false, true}) {
    InputLogHeader expected = make_gyro_header();
    if (with_lens) expected.camera.k5 = 0.01F;
    const Replay replay = read_log(make_gyro_log(expected));
    ASSERT_EQ(replay.status, Status::kOk);
    ASSERT_TRUE(replay.header.with_gyro);
    EXPECT_EQ(replay.header.focal_sigma_e4, 1000);
    EXPECT_EQ(replay.header.camera.k5, expected.camera.k5);
    const GyroParameters& gyro = replay.header.gyro;
    EXPECT_EQ(gyro.R_camera_gyro.coeffs(), expected.gyro.R_camera_gyro.coeffs());
    EXPECT_EQ(gyro.noise_density, expected.gyro.noise_density);
    EXPECT_EQ(gyro.bias_sigma_radps, expected.gyro.bias_sigma_radps);
    EXPECT_EQ(gyro.bias_walk, expected.gyro.bias_walk);
    EXPECT_EQ(gyro.scale_sigma, expected.gyro.scale_sigma);
    EXPECT_EQ(gyro.time_sigma_s, expected.gyro.time_sigma_s);
    EXPECT_EQ(gyro.range_radps, expected.gyro.range_radps);
    EXPECT_EQ(gyro.max_gap_us, expected.gyro.max_gap_us);
    ASSERT_EQ(replay.rates.size(), 1U);
    EXPECT_EQ(replay.rates[0].t_us, 1234567890123);
    EXPECT_EQ(replay.rates[0].rate_radps, Vector3<float>(0.5F, -1.5F, 2.5F));
    EXPECT_EQ(replay.frames.size(), 1U);
  }
}

TEST(InputLog, CarriesARollingShutterWithEveryOtherPart) {
  for (const int parts : {0, 1, 2, 3}) {
    InputLogHeader expected = make_gyro_header();
    expected.with_gyro = (parts & 1) != 0;
    if ((parts & 2) != 0) expected.camera.k5 = 0.01F;
    expected.readout = {50e-6F, -10e-6F};
    Memory memory;
    InputLogWriter<Memory> writer(memory);
    ASSERT_EQ(writer.begin(expected), Status::kOk);
    ASSERT_EQ(writer.end(), Status::kOk);
    const Replay replay = read_log(memory);
    ASSERT_EQ(replay.status, Status::kOk) << parts;
    EXPECT_EQ(replay.header.readout.row_time_s, expected.readout.row_time_s);
    EXPECT_EQ(replay.header.readout.column_time_s, expected.readout.column_time_s);
    EXPECT_EQ(replay.header.with_gyro, expected.with_gyro);
    EXPECT_EQ(replay.header.focal_sigma_e4, 1000);
    EXPECT_EQ(replay.header.camera.k5, expected.camera.k5);
  }
  InputLogHeader impossible = make_gyro_header();
  impossible.readout.row_time_s = 1.0F;
  Memory memory;
  EXPECT_EQ(InputLogWriter<Memory>(memory).begin(impossible), Status::kBadConfig);
}

TEST(InputLog, RefusesAGyroscopeThatIsImpossibleAndSamplesWithoutOne) {
  InputLogHeader header = make_gyro_header();
  header.gyro.noise_density = -1.0F;
  Memory memory;
  InputLogWriter<Memory> writer(memory);
  EXPECT_EQ(writer.begin(header), Status::kBadConfig);
  header = make_gyro_header();
  header.with_gyro = false;
  EXPECT_EQ(read_log(make_gyro_log(header)).status, Status::kCorrupt);
}

TEST(InputLog, ReadsBackWhatWasWritten) {
  const Replay replay = read_log(make_log());
  ASSERT_EQ(replay.status, Status::kOk);
  const InputLogHeader expected = make_header();
  EXPECT_EQ(replay.header.filter, expected.filter);
  EXPECT_EQ(replay.header.mode, expected.mode);
  EXPECT_EQ(replay.header.seed, expected.seed);
  EXPECT_EQ(replay.header.start_t_us, expected.start_t_us);
  EXPECT_TRUE(replay.header.adaptive_fading);
  EXPECT_EQ(replay.header.camera.k3, expected.camera.k3);
  EXPECT_EQ(replay.header.camera.width, kWidth);
  EXPECT_EQ(replay.header.T_vehicle_camera.rotation.coeffs(),
            expected.T_vehicle_camera.rotation.coeffs());
  EXPECT_EQ(replay.header.wheelbase_m, expected.wheelbase_m);
  EXPECT_EQ(replay.header.start_heading_variance, expected.start_heading_variance);
  EXPECT_EQ(replay.header.tilt.sigma_pitch_rad, expected.tilt.sigma_pitch_rad);
  EXPECT_EQ(replay.header.tilt.sigma_roll_rad, expected.tilt.sigma_roll_rad);
  EXPECT_EQ(replay.header.tilt.time_constant_s, expected.tilt.time_constant_s);
  ASSERT_EQ(replay.samples.size(), 3U);
  ASSERT_EQ(replay.frames.size(), 3U);
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    EXPECT_EQ(replay.samples[k].t_us, make_sample(i).t_us);
    EXPECT_EQ(replay.samples[k].speed_mps, make_sample(i).speed_mps);
    EXPECT_EQ(replay.frames[k].number, 100U + k);
    EXPECT_EQ(replay.images[k], make_pixels(i));
  }
}

TEST(InputLog, CrcIsTheStandardOne) {
  const std::uint8_t digits[] = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  EXPECT_EQ(detail::crc32(0, digits, 9), 0xCBF43926U);
  EXPECT_EQ(detail::crc32(detail::crc32(0, digits, 4), digits + 4, 5), 0xCBF43926U);
}

TEST(InputLog, AnyCutIsCorrupt) {
  const Memory whole = make_log();
  for (std::size_t length = 0; length < whole.bytes.size(); ++length) {
    Memory cut = whole;
    cut.bytes.resize(length);
    ASSERT_EQ(read_log(cut).status, Status::kCorrupt) << "cut to " << length << " bytes";
  }
}

TEST(InputLog, AnyFlippedBitIsFound) {
  const Memory whole = make_log();
  for (std::size_t i = 0; i < whole.bytes.size(); ++i) {
    Memory damaged = whole;
    damaged.bytes[i] ^= static_cast<std::uint8_t>(1U << (i % 8U));
    ASSERT_FALSE(ok(read_log(damaged).status)) << "byte " << i;
  }
}

TEST(InputLog, RefusesAnImpossibleHeader) {
  Memory memory;
  InputLogWriter<Memory> writer(memory);
  InputLogHeader header = make_header();
  header.camera.fx = 0.0F;
  EXPECT_EQ(writer.begin(header), Status::kBadConfig);
  header = make_header();
  header.start_x_m = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(writer.begin(header), Status::kBadConfig);
  header = make_header();
  header.fading = 0.5F;
  EXPECT_EQ(writer.begin(header), Status::kBadConfig);
  header = make_header();
  header.T_vehicle_camera.rotation = Quaternion<float>(0.0F, 0.0F, 0.0F, 0.0F);
  EXPECT_EQ(writer.begin(header), Status::kBadConfig);
  EXPECT_TRUE(memory.bytes.empty());
}

TEST(InputLog, KeepsALensBesideThePlainOne) {
  const std::size_t plain = make_log().bytes.size();
  for (const Lens lens : {Lens::kRadialTangential, Lens::kFisheye}) {
    InputLogHeader header = make_header();
    PinholeCamera<float>& camera = header.camera;
    camera.lens = lens;
    camera.k1 = camera.k2 = camera.k3 = camera.p1 = camera.p2 = 0.0F;
    camera.k4 = 0.01F;
    camera.k5 = camera.k6 = lens == Lens::kFisheye ? 0.0F : 0.002F;
    Memory memory;
    InputLogWriter<Memory> writer(memory);
    ASSERT_EQ(writer.begin(header), Status::kOk);
    ASSERT_EQ(writer.end(), Status::kOk);
    EXPECT_LT(memory.bytes.size(), plain);
    const Replay replay = read_log(memory);
    ASSERT_EQ(replay.status, Status::kOk);
    EXPECT_EQ(replay.header.camera.lens, lens);
    EXPECT_EQ(replay.header.camera.k4, camera.k4);
    EXPECT_EQ(replay.header.camera.k5, camera.k5);
    EXPECT_EQ(replay.header.camera.k6, camera.k6);
  }
}

TEST(InputLog, KeepsHowWellTheFocalLengthIsKnown) {
  for (const bool rational : {false, true}) {
    InputLogHeader header = make_header();
    header.focal_sigma_e4 = 1500;
    if (rational) header.camera.k4 = 0.01F;
    Memory memory;
    InputLogWriter<Memory> writer(memory);
    ASSERT_EQ(writer.begin(header), Status::kOk);
    ASSERT_EQ(writer.end(), Status::kOk);
    EXPECT_EQ(memory.bytes[detail::kLogMagicBytes + detail::kLogRecordHeadBytes],
              kInputLogFocalVersion);
    const Replay replay = read_log(memory);
    ASSERT_EQ(replay.status, Status::kOk);
    EXPECT_EQ(replay.header.focal_sigma_e4, 1500);
    EXPECT_EQ(replay.header.camera.k4, header.camera.k4);
  }
  InputLogHeader header = make_header();
  header.focal_sigma_e4 = 10001;
  EXPECT_EQ(header.validate(), Status::kBadConfig);
}

TEST(InputLog, RefusesAnotherVersion) {
  Memory memory = make_log();
  const std::size_t payload = detail::kLogMagicBytes + detail::kLogRecordHeadBytes;
  memory.bytes[payload] = kInputLogVersion + 1;
  const std::uint32_t crc = detail::crc32(0, memory.bytes.data() + detail::kLogMagicBytes,
                                          detail::kLogRecordHeadBytes + detail::kLogHeaderBytes);
  std::uint8_t bytes[4];
  detail::encode_u32(crc, bytes);
  std::copy_n(
      bytes, 4,
      memory.bytes.begin() + static_cast<std::ptrdiff_t>(payload + detail::kLogHeaderBytes));
  EXPECT_EQ(read_log(memory).status, Status::kVersionMismatch);
}

TEST(InputLog, FrameOfAnotherSizeIsRefusedByWriterAndReader) {
  Memory memory;
  InputLogWriter<Memory> writer(memory);
  ASSERT_EQ(writer.begin(make_header()), Status::kOk);
  const auto pixels = make_pixels(0);
  EXPECT_EQ(writer.frame({1, 2}, {pixels.data(), kWidth - 1, kHeight, kWidth}),
            Status::kInvalidArgument);

  Memory log = make_log();
  InputLogReader<Memory> reader(log);
  InputLogHeader header;
  LogEvent event = LogEvent::kEnd;
  OdometrySample sample;
  LogFrame frame;
  std::vector<std::uint8_t> storage(kWidth * kHeight);
  const MutableImageView image{storage.data(), kWidth, kHeight, kWidth};
  EXPECT_EQ(reader.next(event, sample, frame, image), Status::kNotInitialised);
  ASSERT_EQ(reader.open(header), Status::kOk);
  EXPECT_EQ(reader.next(event, sample, frame, {storage.data(), kWidth, kHeight - 1, kWidth}),
            Status::kInvalidArgument);
}

}  // namespace
}  // namespace cairn

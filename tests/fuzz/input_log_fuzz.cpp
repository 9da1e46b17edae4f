// InputLogReader on arbitrary bytes; records get right checksums where the first byte says so. What
// it reads sets trackers up and goes to a gyroscope. And what InputLogWriter writes can be read.
#include <algorithm>
#include <vector>

#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/runtime/replay.hpp"
#include "cairn/tracking/handheld_gyro.hpp"

#include "tracker_scene.hpp"

namespace cairn::fuzz {
namespace {

struct Source {
  const std::uint8_t* bytes;
  std::size_t left;

  int read(std::uint8_t* to, int count) {
    const std::size_t some = std::min(left, static_cast<std::size_t>(count));
    if (some > 0) std::memcpy(to, bytes, some);
    bytes += some;
    left -= some;
    return static_cast<int>(some);
  }
};

/// Puts the right checksum behind every record whose length fits.
void seal(std::vector<std::uint8_t>& log) {
  std::size_t at = detail::kLogMagicBytes;
  while (at + detail::kLogRecordHeadBytes + 4 <= log.size()) {
    std::uint8_t length[4];
    std::memcpy(length, log.data() + at + 4, 4);
    const std::size_t record = detail::kLogRecordHeadBytes + detail::decode_u32(length);
    if (record > log.size() || at + record + 4 > log.size()) return;
    std::uint8_t crc[4];
    detail::encode_u32(detail::crc32(0, log.data() + at, static_cast<int>(record)), crc);
    std::memcpy(log.data() + at + record, crc, 4);
    at += record + 4;
  }
}

/// A header that is accepted sets a tracker up, or the tracker says why not and stays as it was.
void try_start(const InputLogHeader& header) {
  using Filter = GroupIekfSlam<float, SmallConfig::kMaxLandmarks, 3>;
  static VehicleTracker<SmallConfig, Filter> vehicle;
  static HandheldTracker<SmallConfig> handheld;
  static WindowTracker<SmallConfig> window;
  const auto start = [&](auto& tracker) {
    const Before before(tracker);
    PROMISE(3, ok(start_replay(header, tracker)) || before.unchanged());
  };
  start(vehicle);
  start(handheld);
  start(window);
}

void read_events(InputLogReader<Source>& reader, const InputLogHeader& header, std::size_t size) {
  OdometrySample sample;
  LogFrame frame;
  LogEvent event = LogEvent::kOdometry;
  HandheldGyro gyro;
  if (header.with_gyro) {
    PROMISE(8, ok(header.gyro.validate()));
    gyro.reset(header.gyro);
  }
  const int width = header.camera.width;
  const int height = header.camera.height;
  if (width > 512 || height > 512) return;
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width) *
                                   static_cast<std::size_t>(height));
  const MutableImageView image{pixels.data(), width, height, width};
  // Every event takes at least a record's head from the source.
  for (std::size_t events = 0; ok(reader.next(event, sample, frame, image)); ++events) {
    PROMISE(6, events <= size / detail::kLogRecordHeadBytes);
    if (event == LogEvent::kEnd) break;
    if (event == LogEvent::kAngularRate) {
      PROMISE(8, header.with_gyro);
      Health counts;
      static_cast<void>(gyro.add(reader.angular_rate(), counts));
    }
    if (event == LogEvent::kFrame) {
      gyro.take_frame(frame.t_us);
      PROMISE(4, gyro.turn().rotation.allFinite() && gyro.turn().variance >= 0.0F);
    }
  }
}

void read(std::vector<std::uint8_t>& log, bool sealed) {
  if (sealed) seal(log);
  Source source{log.data(), log.size()};
  InputLogReader<Source> reader(source);
  InputLogHeader header;
  OdometrySample sample;
  LogFrame frame;
  LogEvent event = LogEvent::kOdometry;
  PROMISE(3, reader.next(event, sample, frame, {}) == Status::kNotInitialised);
  if (!ok(reader.open(header))) return;
  PROMISE(8, ok(header.validate()));
  try_start(header);
  read_events(reader, header, log.size());
}

struct Sink {
  std::vector<std::uint8_t> bytes;
  std::size_t room;

  bool write(const std::uint8_t* from, int count) {
    if (bytes.size() + static_cast<std::size_t>(count) > room) return false;
    bytes.insert(bytes.end(), from, from + count);
    return true;
  }
};

InputLogHeader header_of(Input& input) {
  InputLogHeader header;
  header.mode = input.flag() ? LogMode::kVehicle : LogMode::kHandheld;
  header.camera = test::to_float(scene_camera());
  header.camera.width = 1 + input.below(12);
  header.camera.height = 1 + input.below(12);
  header.with_gyro = input.flag();
  if (input.flag()) header.camera.k1 = input.number(-0.1F, 0.1F);
  if (input.flag()) header.camera.k4 = input.number(-0.1F, 0.1F);
  if (input.flag()) header.readout.row_time_s = input.number(0.0F, 1e-3F);
  if (input.flag()) header.start_theta_rad = input.wild();
  return header;
}

/// One event of each kind that a log may have; what was read must be what was written.
void write_and_read(Input& input) {
  const InputLogHeader header = header_of(input);
  Sink sink{{}, input.byte() > 30 ? 8192U : input.word() % 512U};
  InputLogWriter<Sink> writer(sink);
  if (!ok(writer.begin(header))) return;
  const int width = header.camera.width;
  const int height = header.camera.height;
  const ExactPicture picture(width, height, width + input.below(3), input);
  OdometrySample sample;
  sample.t_us = input.time();
  sample.speed_mps = input.number(-2.0F, 2.0F);
  AngularRateSample rate;
  rate.t_us = input.time();
  LogFrame frame;
  frame.t_us = input.time();
  bool whole = ok(writer.odometry(sample));
  if (header.with_gyro) whole = ok(writer.angular_rate(rate)) && whole;
  whole = ok(writer.frame(frame, {picture.bytes.get(), width, height, picture.stride})) && whole;
  whole = ok(writer.end()) && whole;
  if (!whole) return;

  Source source{sink.bytes.data(), sink.bytes.size()};
  InputLogReader<Source> reader(source);
  InputLogHeader again;
  PROMISE(8, ok(reader.open(again)));
  PROMISE(8, again.camera.k1 == header.camera.k1 && again.with_gyro == header.with_gyro);
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width * height));
  OdometrySample read_sample;
  LogFrame read_frame;
  LogEvent event = LogEvent::kEnd;
  const auto next = [&] {
    return reader.next(event, read_sample, read_frame, {pixels.data(), width, height, width});
  };
  const Status first = next();
  PROMISE(8, ok(first) || !is_finite(sample.speed_mps));
  if (!ok(first)) return;
  PROMISE(8, read_sample.t_us == sample.t_us && read_sample.speed_mps == sample.speed_mps);
  if (header.with_gyro) PROMISE(8, ok(next()) && reader.angular_rate().t_us == rate.t_us);
  PROMISE(8, ok(next()) && event == LogEvent::kFrame && read_frame.t_us == frame.t_us);
  for (int y = 0; y < height; ++y) {
    PROMISE(8, std::memcmp(pixels.data() + y * width, picture.bytes.get() + y * picture.stride,
                           static_cast<std::size_t>(width)) == 0);
  }
  PROMISE(8, ok(next()) && event == LogEvent::kEnd);
}

}  // namespace
}  // namespace cairn::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace cairn::fuzz;
  if (size < 1) return 0;
  const unsigned kind = bytes[0] & 3U;
  if (kind == 3) {
    Input input(bytes + 1, size - 1);
    write_and_read(input);
  } else {
    std::vector<std::uint8_t> log(bytes + 1, bytes + size);
    read(log, (kind & 1U) != 0);
  }
  return 0;
}

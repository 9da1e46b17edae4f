// InputLogReader on arbitrary bytes; records get right checksums where the first byte says so. What
// it reads goes to a tracker.
#include <algorithm>
#include <vector>

#include "cairn/runtime/input_log.hpp"
#include "cairn/tracking/handheld_gyro.hpp"

#include "fuzz_input.hpp"

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

}  // namespace
}  // namespace cairn::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace cairn;
  using namespace cairn::fuzz;
  if (size < 1) return 0;
  std::vector<std::uint8_t> log(bytes + 1, bytes + size);
  if ((bytes[0] & 1U) != 0) seal(log);
  Source source{log.data(), log.size()};
  InputLogReader<Source> reader(source);
  InputLogHeader header;
  OdometrySample sample;
  LogFrame frame;
  LogEvent event = LogEvent::kOdometry;
  PROMISE(3, reader.next(event, sample, frame, {}) == Status::kNotInitialised);
  if (!ok(reader.open(header))) return 0;
  PROMISE(8, ok(header.validate()));
  HandheldGyro gyro;
  if (header.with_gyro) {
    PROMISE(8, ok(header.gyro.validate()));
    gyro.reset(header.gyro);
  }
  const int width = header.camera.width;
  const int height = header.camera.height;
  if (width > 512 || height > 512) return 0;
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
  return 0;
}

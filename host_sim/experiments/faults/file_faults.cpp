#include <cstring>

#include <fmt/format.h>

#include "cairn/map/map_file.hpp"
#include "cairn/runtime/input_log.hpp"

#include "host_sim/experiments/faults/fault_classes.hpp"
#include "host_sim/experiments/faults/fault_core.hpp"
#include "host_sim/experiments/faults/fault_files.hpp"
#include "host_sim/io/csv_file.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/io/pose_file.hpp"
#include "host_sim/sources/odometry_file.hpp"

namespace cairn::host {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Reads what `bytes` points to.
ByteSource source_of(const Bytes*& bytes) {
  return {[](void* context, std::uint32_t offset, std::uint8_t* to, int count) {
            const Bytes& from = **static_cast<const Bytes**>(context);
            if (offset + static_cast<std::size_t>(count) > from.size()) return false;
            std::memcpy(to, from.data() + offset, static_cast<std::size_t>(count));
            return true;
          },
          &bytes, static_cast<std::uint32_t>(bytes->size())};
}

/// The map that a drive over the scene leaves.
template <class Core>
Bytes saved_map(const FaultScene& scene, Core& core) {
  CoreRun<Core> run(scene, core);
  static_cast<void>(run.start());
  for (int i = 0; i < static_cast<int>(scene.frames().size()); ++i) static_cast<void>(run.step(i));
  FaultBytes bytes;
  static_cast<void>(core.save_map({[](void* context, const std::uint8_t* from, int count) {
                                     return static_cast<FaultBytes*>(context)->write(from, count);
                                   },
                                   &bytes}));
  return bytes.bytes;
}

/// An input log of some frames of the scene.
Bytes some_log(const FaultScene& scene) {
  FaultBytes bytes;
  InputLogWriter<FaultBytes> writer(bytes);
  const TrackerOptions& options = scene.options();
  static_cast<void>(
      writer.begin(to_log_header(options, scene.info(), scene.frames().front().t_us)));
  for (int i = 0; i < 2; ++i) {
    const Frame& frame = scene.frames()[static_cast<std::size_t>(i)];
    for (const OdometrySample& sample : frame.odometry) {
      static_cast<void>(writer.odometry(sample));
    }
    static_cast<void>(writer.frame(
        {static_cast<std::uint32_t>(frame.number), frame.t_us, LogFrame::kOwnWorkLimit},
        to_view(frame.grey)));
  }
  static_cast<void>(writer.end());
  return bytes.bytes;
}

/// Status at which the reading of a log ends; kOk after a whole one.
Status read_log(const Bytes& log) {
  FaultBytes bytes{log};
  InputLogReader<FaultBytes> reader(bytes);
  InputLogHeader header;
  Status status = reader.open(header);
  if (!ok(status)) return status;
  cv::Mat picture(header.camera.height, header.camera.width, CV_8UC1);
  LogEvent event = LogEvent::kOdometry;
  OdometrySample sample;
  LogFrame frame;
  do {
    status = reader.next(event, sample, frame, to_mutable_view(picture));
  } while (ok(status) && event != LogEvent::kEnd);
  return status;
}

/// The log's header record with another version and a right checksum.
Bytes with_version(Bytes log, std::uint8_t version) {
  constexpr std::size_t kPayload = detail::kLogMagicBytes + detail::kLogRecordHeadBytes;
  log[kPayload] = version;
  const std::uint32_t crc = detail::crc32(0, log.data() + detail::kLogMagicBytes,
                                          detail::kLogRecordHeadBytes + detail::kLogHeaderBytes);
  std::uint8_t bytes[4];
  detail::encode_u32(crc, bytes);
  std::memcpy(log.data() + kPayload + detail::kLogHeaderBytes, bytes, sizeof bytes);
  return log;
}

/// A changed map that a running tracker must refuse.
template <class Core>
FaultOutcome refused_map(Core& core, const char* what, const Bytes& map, MapFileFault expected) {
  FaultJudge judge(FaultComponent::kMap, FaultMode::kWrong, what,
                   fmt::format("refused for {}, the tracker unchanged", to_string(expected)));
  const std::uint64_t before = hash_of_state(core);
  MapFileInfo info;
  const Bytes* from = &map;
  const Status status = core.load_map(source_of(from), info);
  judge.saw(fmt::format("{} ({}): version {}, {} landmarks of {} views", cairn::to_string(status),
                        to_string(info.fault), info.version, info.landmarks, info.views));
  judge.expect(!ok(status) && info.fault == expected, "not refused so");
  return judge.expect(hash_of_state(core) == before, "changed").outcome();
}

/// Cuts at every `step`th byte, then flips a bit in every `step`th.
template <class Core>
FaultOutcome damaged_map(Core& core, const Bytes& map, std::size_t step) {
  FaultJudge judge(FaultComponent::kMap, FaultMode::kGarbage,
                   fmt::format("a map of {} bytes cut, and with a bit flipped, at each {}. byte",
                               map.size(), step),
                   "refused each time, the tracker unchanged");
  int tries = 0, accepted = 0, changed = 0;
  const std::uint64_t before = hash_of_state(core);
  const auto attempt = [&](const Bytes& damaged) {
    MapFileInfo info;
    const Bytes* from = &damaged;
    ++tries;
    if (ok(core.load_map(source_of(from), info))) ++accepted;
    if (hash_of_state(core) != before) ++changed;
  };
  for (std::size_t at = 0; at < map.size(); at += step) {
    attempt(Bytes(map.begin(), map.begin() + static_cast<std::ptrdiff_t>(at)));
    Bytes flipped = map;
    flipped[at] = static_cast<std::uint8_t>(flipped[at] ^ (1U << (at % 8)));
    attempt(flipped);
  }
  judge.saw(fmt::format("{} tries, {} accepted, {} changed the tracker", tries, accepted, changed));
  return judge.expect(accepted == 0 && changed == 0, "damage taken").outcome();
}

FaultOutcome damaged_log(const Bytes& log, std::size_t step) {
  FaultJudge judge(FaultComponent::kLog, FaultMode::kGarbage,
                   fmt::format("a log of {} bytes cut, and with a bit flipped, at each {}. byte",
                               log.size(), step),
                   "refused each time");
  int tries = 0, accepted = 0;
  for (std::size_t at = 0; at < log.size(); at += step) {
    tries += 2;
    if (ok(read_log(Bytes(log.begin(), log.begin() + static_cast<std::ptrdiff_t>(at))))) ++accepted;
    Bytes flipped = log;
    flipped[at] = static_cast<std::uint8_t>(flipped[at] ^ (1U << (at % 8)));
    if (ok(read_log(flipped))) ++accepted;
  }
  judge.saw(fmt::format("{} tries, {} accepted", tries, accepted));
  return judge.expect(accepted == 0, "damage taken").outcome();
}

/// A text file with one damaged line, which the reader must name.
template <class Read>
FaultOutcome damaged_line(const char* what, const char* name, const std::string& text,
                          const char* line, Read read) {
  FaultJudge judge(FaultComponent::kLog, FaultMode::kGarbage, what,
                   fmt::format("refused, naming {}", line));
  const FaultFile file(name, text);
  std::string message = "accepted";
  try {
    read(file.path());
  } catch (const InputError& error) {
    message = file.without_folder(error.what());
  }
  judge.saw(message);
  return judge.expect(message.find(line) != std::string::npos, "line not named").outcome();
}

}  // namespace

FaultOutcomes inject_other_versions(const FaultScene& scene) {
  return with_core<DefaultConfig>(scene, [&](auto type) {
    using Core = typename decltype(type)::Type;
    const auto core = std::make_unique<Core>();
    const Bytes map = saved_map(scene, *core);
    Bytes version = map;
    version[8] = 9;
    Bytes many = map;
    many[18] = 1;  // 65,536 landmarks more
    Bytes views = map;
    views[12] = 4;
    FaultOutcomes outcomes = {
        refused_map(*core, "map of version 9", version, MapFileFault::kVersion),
        refused_map(*core, "map of 65,536 landmarks", many, MapFileFault::kCapacity),
        refused_map(*core, "map with 4 views a landmark", views, MapFileFault::kCapacity)};
    FaultJudge judge(FaultComponent::kLog, FaultMode::kWrong, "input log of version 9",
                     "version_mismatch");
    const Status status = read_log(with_version(some_log(scene), 9));
    judge.saw(
        fmt::format("{}: this build reads version {}", cairn::to_string(status), kInputLogVersion));
    outcomes.push_back(judge.expect(status == Status::kVersionMismatch, "not said").outcome());
    return outcomes;
  });
}

FaultOutcomes inject_damaged_files(const FaultScene& scene) {
  FaultOutcomes outcomes = {
      damaged_line("odometry with a letter in line 3", "odometry.csv",
                   "t_us,speed_mps,yaw_rate_radps\n0,0.5,0\n100000,0.5x,0\n200000,0.5,0\n",
                   ":3:", [](const auto& path) { static_cast<void>(read_odometry(path)); }),
      damaged_line("odometry that goes back in line 4", "odometry.csv",
                   "t_us,speed_mps,yaw_rate_radps\n0,0.5,0\n100000,0.5,0\n50000,0.5,0\n",
                   ":4:", [](const auto& path) { static_cast<void>(read_odometry(path)); }),
      damaged_line("odometry with a field too few in line 2", "odometry.csv",
                   "t_us,speed_mps,yaw_rate_radps\n0,0.5\n",
                   ":2:", [](const auto& path) { static_cast<void>(read_odometry(path)); }),
      damaged_line("poses with NaN in line 2", "truth.tum", "0 0 0 0 0 0 0 1\n1 nan 0 0 0 0 0 1\n",
                   ":2:", [](const auto& path) { static_cast<void>(read_tum(path)); })};
  with_core<DefaultConfig>(scene, [&](auto type) {
    using Core = typename decltype(type)::Type;
    const auto core = std::make_unique<Core>();
    const Bytes map = saved_map(scene, *core);
    outcomes.push_back(damaged_map(*core, map, scene.settings().brief ? 7 : 1));
    const Bytes log = some_log(scene);
    outcomes.push_back(damaged_log(log, log.size() / (scene.settings().brief ? 200 : 2000)));
  });
  return outcomes;
}

}  // namespace cairn::host

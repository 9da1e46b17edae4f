// How often every piece of the core runs in one frame: the largest count of each over all frames of
// the inputs, written as one coverage profile, which loop_bounds.py compares with the listed
// bounds.
//
//   loop_count --profile FILE [--log LOG]... [--search TRIES [--seed N]]
//
// --log: replays an input log. --search: tries stress scenes, each evolved from the most expensive
// so far, and prints the most expensive. Built by Clang with its profile counters (preset
// host-loops).

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "cairn/base/config.hpp"
#include "cairn/numeric/random.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/runtime/augmentation.hpp"
#include "cairn/runtime/replay.hpp"

#include "host_sim/world/stress_scene.hpp"

extern "C" {
std::uint64_t* __llvm_profile_begin_counters(void);
std::uint64_t* __llvm_profile_end_counters(void);
void __llvm_profile_set_filename(const char* name);
int __llvm_profile_write_file(void);
}

namespace {

using cairn::host::StressRenderer;
using cairn::host::StressScene;
using Vehicle =
    cairn::VehicleTracker<cairn::DefaultConfig,
                          cairn::GroupIekfSlam<float, cairn::DefaultConfig::kMaxLandmarks, 3>>;
using Handheld = cairn::HandheldTracker<cairn::DefaultConfig>;

/// The profile's counters of one frame at a time, and the largest that any frame reached.
class Counters {
 public:
  Counters()
      : begin_(__llvm_profile_begin_counters()),
        end_(__llvm_profile_end_counters()),
        largest_(static_cast<std::size_t>(end_ - begin_), 0) {}

  void start_frame() { std::fill(begin_, end_, std::uint64_t{0}); }

  /// The sum over all pieces of the code: what a search makes large.
  std::uint64_t end_frame() {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < largest_.size(); ++i) {
      sum += begin_[i];
      largest_[i] = std::max(largest_[i], begin_[i]);
    }
    return sum;
  }

  /// The runtime appends to what the file holds, and does so once more at the end of the program.
  bool write(const char* path) const {
    std::copy(largest_.begin(), largest_.end(), begin_);
    std::remove(path);
    __llvm_profile_set_filename(path);
    const bool written = __llvm_profile_write_file() == 0;
    std::fill(begin_, end_, std::uint64_t{0});
    return written;
  }

 private:
  std::uint64_t* begin_;
  std::uint64_t* end_;
  std::vector<std::uint64_t> largest_;
};

/// A tracker with what it draws: copied whole, so that a run can go on from any frame.
template <class Tracker>
struct Machine {
  Tracker tracker;
  cairn::Augmenter augmenter;
  cairn::ObjectPlacement placement{{3.5F, 0.7F, 0.0F}, cairn::Random(1)};

  bool start(const cairn::InputLogHeader& header) {
    cairn::VirtualObject shape;
    if (!cairn::ok(cairn::start_replay(header, tracker)) ||
        !cairn::ok(cairn::make_cairn(1.0F, shape))) {
      return false;
    }
    augmenter.initialise(shape, cairn::Augmenter::Parameters{});
    return true;
  }

  std::uint64_t frame(const std::vector<cairn::OdometrySample>& odometry, std::int64_t t_us,
                      const cairn::MutableImageView& image, Counters& counters) {
    counters.start_frame();
    for (const cairn::OdometrySample& sample : odometry) {
      static_cast<void>(cairn::replay_odometry(sample, tracker));
    }
    cairn::FrameReport report;
    report.status = tracker.process_frame(image, t_us, cairn::TickSource{}, report);
    cairn::augment(tracker, augmenter, placement, image, cairn::TickSource{}, report);
    return counters.end_frame();
  }
};

struct FileBytes {
  std::ifstream stream;
  int read(std::uint8_t* bytes, int count) {
    stream.read(reinterpret_cast<char*>(bytes), count);
    return static_cast<int>(stream.gcount());
  }
};

template <class Tracker>
bool replay(cairn::InputLogReader<FileBytes>& reader, const cairn::InputLogHeader& header,
            Counters& counters) {
  const auto machine = std::make_unique<Machine<Tracker>>();
  if (!machine->start(header)) return false;
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(header.camera.width) *
                                   static_cast<std::size_t>(header.camera.height));
  const cairn::MutableImageView image{pixels.data(), header.camera.width, header.camera.height,
                                      header.camera.width};
  std::vector<cairn::OdometrySample> odometry;
  cairn::LogEvent event = cairn::LogEvent::kEnd;
  cairn::OdometrySample sample;
  cairn::LogFrame frame;
  while (cairn::ok(reader.next(event, sample, frame, image))) {
    if (event == cairn::LogEvent::kEnd) return true;
    if (event == cairn::LogEvent::kOdometry) {
      odometry.push_back(sample);
      continue;
    }
    if (event == cairn::LogEvent::kAngularRate) {
      static_cast<void>(cairn::replay_angular_rate(reader.angular_rate(), machine->tracker));
      continue;
    }
    cairn::replay_work_limit(frame, machine->tracker);
    machine->frame(odometry, frame.t_us, image, counters);
    odometry.clear();
  }
  return false;
}

bool replay_log(const std::string& path, Counters& counters) {
  FileBytes bytes{std::ifstream(path, std::ios::binary)};
  cairn::InputLogReader<FileBytes> reader(bytes);
  cairn::InputLogHeader header;
  if (!cairn::ok(reader.open(header))) return false;
  return header.mode == cairn::LogMode::kHandheld ? replay<Handheld>(reader, header, counters)
                                                  : replay<Vehicle>(reader, header, counters);
}

constexpr int kWarmFrames = 40;    // until the map is full
constexpr int kAttackFrames = 6;   // judged
constexpr std::size_t kKept = 12;  // most expensive scenes, of which new ones evolve
constexpr std::size_t kWarmKept = 48;
constexpr int kSavedEvery =
    250;  // tries after which the profile is written, should the search be ended

/// Where the attack is all that differs, the frames before it need not be computed again.
std::string warm_key(StressScene scene) {
  const StressScene standard;
  scene.attack = standard.attack;
  scene.attack_every = standard.attack_every;
  scene.attack_size = standard.attack_size;
  scene.attack_seed = standard.attack_seed;
  scene.attack_step_mm = standard.attack_step_mm;
  scene.lie_mm = standard.lie_mm;
  return scene.text();
}

template <class Tracker>
class Trial {
 public:
  explicit Trial(Counters& counters) : counters_(counters) {}

  /// Most expensive attacked frame.
  std::uint64_t cost(const StressScene& scene) {
    const StressRenderer renderer(scene);
    const std::string key = warm_key(scene);
    auto found = warm_.find(key);
    if (found == warm_.end()) {
      if (warm_.size() >= kWarmKept) warm_.erase(warm_.begin());
      auto machine = std::make_unique<Machine<Tracker>>();
      if (!machine->start(renderer.header())) return 0;
      run(*machine, renderer, 0, kWarmFrames, scene);
      found = warm_.emplace(key, std::move(machine)).first;
    }
    *trial_ = *found->second;
    return run(*trial_, renderer, kWarmFrames, kWarmFrames + kAttackFrames, scene);
  }

 private:
  std::uint64_t run(Machine<Tracker>& machine, const StressRenderer& renderer, int from, int to,
                    const StressScene& scene) {
    std::uint64_t worst = 0;
    std::vector<cairn::OdometrySample> odometry;
    for (int frame = from; frame < to; ++frame) {
      renderer.draw(frame, pixels_.data());
      odometry.clear();
      if (scene.handheld == 0) odometry.push_back(renderer.odometry(frame));
      worst = std::max(worst, machine.frame(odometry, renderer.t_us(frame), image_, counters_));
    }
    return worst;
  }

  Counters& counters_;
  std::map<std::string, std::unique_ptr<Machine<Tracker>>> warm_;
  std::unique_ptr<Machine<Tracker>> trial_ = std::make_unique<Machine<Tracker>>();
  std::vector<std::uint8_t> pixels_ =
      std::vector<std::uint8_t>(cairn::host::kStressWidth * cairn::host::kStressHeight);
  cairn::MutableImageView image_{pixels_.data(), cairn::host::kStressWidth,
                                 cairn::host::kStressHeight, cairn::host::kStressWidth};
};

bool is_attack(const StressScene::Field& field) {
  return std::strncmp(field.name, "attack", 6) == 0 || std::strcmp(field.name, "lie_mm") == 0;
}

bool is_fixed(const StressScene::Field& field) {
  for (const char* name : {"handheld", "frames", "attack_from"}) {
    if (std::strcmp(field.name, name) == 0) return true;
  }
  return false;
}

void mutate(StressScene& scene, const StressScene::Field& field, cairn::Random& random) {
  int& value = scene.*field.value;
  const int span = field.high - field.low + 1;
  if (random.below(2) == 0 || span < 8) {
    value = field.low + random.below(span);
    return;
  }
  const int step = 1 + std::abs(value) / 4;
  value = std::clamp(value + random.below(2 * step + 1) - step, field.low, field.high);
}

StressScene evolved(const StressScene& parent, cairn::Random& random) {
  StressScene child = parent;
  const bool attack_alone = random.below(8) != 0;
  for (int changes = 1 + random.below(3); changes > 0;) {
    const auto& field =
        StressScene::fields()[static_cast<std::size_t>(random.below(StressScene::kFieldCount))];
    if (is_fixed(field) || is_attack(field) != attack_alone) continue;
    mutate(child, field, random);
    --changes;
  }
  return child;
}

struct Found {
  std::uint64_t cost;
  StressScene scene;
};

/// Evolves scenes of one mode, the most expensive of which are kept.
template <class Tracker>
class Search {
 public:
  Search(int handheld, std::uint64_t seed, Counters& counters)
      : handheld_(handheld), random_(seed), trial_(counters) {}

  void step() {
    const StressScene scene = next();
    ++tries_;
    const std::uint64_t cost = trial_.cost(scene);
    const bool known = std::any_of(kept_.begin(), kept_.end(),
                                   [&](const Found& each) { return each.cost == cost; });
    if (known) return;
    kept_.push_back({cost, scene});
    std::sort(kept_.begin(), kept_.end(),
              [](const Found& a, const Found& b) { return a.cost > b.cost; });
    if (kept_.size() > kKept) kept_.pop_back();
    if (kept_.front().cost != cost) return;
    std::printf("%s, try %d: %llu  %s\n", handheld_ != 0 ? "handheld" : "vehicle", tries_,
                static_cast<unsigned long long>(cost), scene.text().c_str());
    std::fflush(stdout);
  }

 private:
  StressScene next() {
    const auto& named = cairn::host::named_stress_scenes();
    StressScene scene;
    if (static_cast<std::size_t>(tries_) < named.size()) {
      scene.set(named[static_cast<std::size_t>(tries_)].name);
    } else {
      const int parent = random_.below(static_cast<int>(kept_.size()));
      scene = evolved(kept_[static_cast<std::size_t>(parent)].scene, random_);
    }
    scene.handheld = handheld_;
    scene.attack_from = kWarmFrames;
    scene.frames = kWarmFrames + kAttackFrames;
    return scene;
  }

  int handheld_;
  int tries_ = 0;
  cairn::Random random_;
  Trial<Tracker> trial_;
  std::vector<Found> kept_;
};

bool search(int tries, std::uint64_t seed, const char* profile, Counters& counters) {
  Search<Vehicle> vehicle(0, seed, counters);
  Search<Handheld> handheld(1, seed, counters);
  for (int i = 0; i < tries; ++i) {
    if (i % 2 == 0) {
      vehicle.step();
    } else {
      handheld.step();
    }
    if (i % kSavedEvery != kSavedEvery - 1) continue;
    std::printf("%d tries\n", i + 1);
    std::fflush(stdout);
    if (!counters.write(profile)) return false;
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  Counters counters;
  const char* profile = nullptr;
  int tries = 0;
  std::uint64_t seed = 1;
  std::vector<std::string> logs;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string name = argv[i];
    if (name == "--profile") profile = argv[i + 1];
    if (name == "--log") logs.emplace_back(argv[i + 1]);
    if (name == "--search") tries = std::atoi(argv[i + 1]);
    if (name == "--seed") seed = std::strtoull(argv[i + 1], nullptr, 10);
  }
  if (profile == nullptr || argc % 2 == 0) {
    std::fprintf(stderr,
                 "usage: loop_count --profile FILE [--log LOG]... [--search TRIES [--seed N]]\n");
    return 2;
  }
  for (const std::string& log : logs) {
    if (replay_log(log, counters)) continue;
    std::fprintf(stderr, "loop_count: %s: expected a whole input log of 640x480\n", log.c_str());
    return 3;
  }
  return search(tries, seed, profile, counters) && counters.write(profile) ? 0 : 1;
}

// The monocular filter on the target itself: a camera that swings before a cloud of points, every
// feature measured in every frame and none turned into a point, so that the state is the largest.
//
//   mono_target [--count 1] [--limit-25 N] [--limit-50 N]
//
// Prints the hash of the filter after the run, the same on every target. With --count the
// instructions of a frame's filter part (prediction, search regions, update); a worst frame above
// its limit is exit status 1. Counting needs an emulator whose clock advances 64 ns with every
// instruction.

#include <cstdint>

#include "cairn/mono/mono_ekf.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/numeric/random.hpp"
#include "cairn/port/port.h"

#include "text.hpp"

namespace {

using cairn::ok;
using cairn::PixelMatch;
using cairn::Rigid;
using cairn::Vector2;
using cairn::Vector3;
using cairn_test::write;
using cairn_test::write_decimal;

constexpr int kFrames = 60;
constexpr int kBirthsPerFrame = 5;  // one anchor each: as many anchors as there can be
constexpr float kStep = 0.04F;

cairn::PinholeCamera<float> camera() {
  cairn::PinholeCamera<float> c;
  c.fx = c.fy = 300.0F;
  c.cx = 179.5F;
  c.cy = 119.5F;
  c.width = 360;
  c.height = 240;
  return c;
}

float uniform(cairn::Random& random, float low, float high) {
  return low + (high - low) * (static_cast<float>(random.next() >> 8U) * 5.9604644775390625e-8F);
}

float sine(float angle) {
  float s = 0.0F;
  float c = 0.0F;
  cairn::sin_cos(angle, s, c);
  return s;
}

Rigid<float> pose(int frame) {
  const float t = kStep * static_cast<float>(frame);
  const Vector3<float> phi(0.03F * sine(1.3F * t), 0.05F * sine(0.8F * t), 0.02F * sine(t));
  const Vector3<float> r(0.2F * sine(t), 0.1F * sine(1.7F * t), 0.05F * t);
  return {cairn::rotation_exp(phi), r};
}

template <int Features>
class Run {
 public:
  void start() {
    for (Vector3<float>& p : points_) {
      const float depth = uniform(random_, 1.6F, 3.5F);
      const float x = uniform(random_, -0.4F, 0.4F);
      p = {depth * x, depth * uniform(random_, -0.22F, 0.22F), depth};
    }
    cairn::MonoParameters<float> parameters;
    parameters.linearity_threshold = 0.0F;
    good_ = ok(filter_.initialise(camera(), parameters));
  }

  void frame(int k) {
    const Rigid<float> T_camera_world = pose(k).inverse();
    std::uint64_t spent = 0;
    const std::uint32_t begin = cairn_port_ticks();
    if (k > 0) good_ = ok(filter_.predict(kStep)) && good_;
    int count = 0;
    for (int slot = 0; slot < filter_.feature_count(); ++slot) {
      cairn::PixelPrediction<float> prediction;
      if (!ok(filter_.predict_feature(slot, prediction))) continue;
      matches_[count].id = prediction.id;
      matches_[count++].slot = slot;
    }
    spent += cairn_port_ticks() - begin;
    for (int i = 0; i < count; ++i) {
      matches_[i].pixel = measure(T_camera_world, matches_[i].id);
    }
    const std::uint32_t update_begin = cairn_port_ticks();
    cairn::UpdateReport report;
    if (count > 0) good_ = ok(filter_.update(matches_, count, random_, report)) && good_;
    spent += cairn_port_ticks() - update_begin;
    for (int i = 0; i < kBirthsPerFrame && filter_.feature_count() < Features; ++i) {
      const auto id = static_cast<cairn::LandmarkId>(filter_.feature_count() + 1);
      good_ = ok(filter_.add_feature(id, measure(T_camera_world, id))) && good_;
    }
    if (filter_.feature_count() < Features || 2 * Features != report.nis_dof) return;
    ++full_frames_;
    sum_ += spent;
    if (spent > worst_) worst_ = spent;
  }

  /// Prints the results; true when the run was as intended and the worst frame within `limit`.
  bool finish(bool count, std::uint64_t limit) {
    cairn::Hash64 hash;
    filter_.hash(hash);
    write("features ");
    write_decimal(Features);
    write(", states ");
    write_decimal(static_cast<std::uint64_t>(filter_.state_size()));
    write(", bytes ");
    write_decimal(sizeof filter_);
    write(", hash ");
    cairn_test::write_hex64(hash.value());
    write("\n");
    bool good = good_ && full_frames_ > kFrames / 2;
    if (!good) write("the run was not as intended\n");
    if (!count) return good;
    const std::uint64_t worst = instructions(worst_);
    write("instructions a frame: mean ");
    write_decimal(instructions(sum_ / static_cast<std::uint64_t>(full_frames_ + 1)));
    write(", worst ");
    write_decimal(worst);
    good = good && worst <= limit;
    write(worst <= limit ? ", within the limit\n" : ", ABOVE THE LIMIT\n");
    return good;
  }

 private:
  static std::uint64_t instructions(std::uint64_t ticks) {
    return ticks * 15625000U / cairn_port_ticks_per_second();
  }

  Vector2<float> measure(const Rigid<float>& T_camera_world, cairn::LandmarkId id) {
    Vector2<float> pixel = Vector2<float>::Zero();
    (void)camera().project(Vector3<float>(T_camera_world * points_[id - 1U]), pixel);
    pixel.x() += uniform(random_, -0.8F, 0.8F);
    pixel.y() += uniform(random_, -0.8F, 0.8F);
    return pixel;
  }

  cairn::Random random_{7};
  cairn::MonoEkf<float, Features> filter_;
  PixelMatch<float> matches_[Features];
  Vector3<float> points_[Features];
  std::uint64_t sum_ = 0;
  std::uint64_t worst_ = 0;
  int full_frames_ = 0;
  bool good_ = true;
};

Run<25> small_run;
Run<50> large_run;

template <class AnyRun>
bool run(AnyRun& r, bool count, int limit) {
  r.start();
  for (int k = 0; k < kFrames; ++k) r.frame(k);
  return r.finish(count, static_cast<std::uint64_t>(limit));
}

}  // namespace

int main(int argc, char** argv) {
  const bool count = *cairn_test::argument(argc, argv, "--count", "0") == '1';
  const auto limit = [&](const char* name) {
    return cairn_test::parse_decimal(cairn_test::argument(argc, argv, name, "100000000"));
  };
  const bool small = run(small_run, count, limit("--limit-25"));
  const bool large = run(large_run, count, limit("--limit-50"));
  return small && large ? 0 : 1;
}

#pragma once

#include <cstdint>

#include "cairn/mono/mono_ekf.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/numeric/random.hpp"

namespace cairn_test {

/// A camera that swings before a cloud of points, every feature measured in every frame and none
/// turned into a point, so that the state is the largest. `Clock::now()` is read around the filter
/// part of a frame: prediction, search regions, update. All storage is inside.
template <int Features, class Clock>
class SwingRun {
 public:
  using Filter = cairn::MonoEkf<float, Features>;
  using Ticks = typename Clock::Sum;
  static constexpr int kFrames = 60;

  /// The whole run, from its start.
  void run() {
    start();
    for (int k = 0; k < kFrames; ++k) frame(k);
  }

  const Filter& filter() const { return filter_; }
  /// Nothing was refused, and the map was full most of the time.
  bool as_intended() const { return good_ && full_frames_ > kFrames / 2; }
  /// Frames with a full map and every feature measured, and the ticks of their filter part.
  int full_frames() const { return full_frames_; }
  Ticks sum() const { return sum_; }
  Ticks worst() const { return worst_; }

 private:
  static constexpr int kNewFeaturesPerFrame =
      5;  // one anchor each: as many anchors as there can be
  static constexpr float kStep = 0.04F;

  static cairn::PinholeCamera<float> camera() {
    cairn::PinholeCamera<float> c;
    c.fx = c.fy = 300.0F;
    c.cx = 179.5F;
    c.cy = 119.5F;
    c.width = 360;
    c.height = 240;
    return c;
  }

  static float uniform(cairn::Random& random, float low, float high) {
    return low + (high - low) * (static_cast<float>(random.next() >> 8U) * 5.9604644775390625e-8F);
  }

  static float sine(float angle) {
    float s = 0.0F;
    float c = 0.0F;
    cairn::sin_cos(angle, s, c);
    return s;
  }

  static cairn::Rigid<float> pose(int frame) {
    const float t = kStep * static_cast<float>(frame);
    const cairn::Vector3<float> phi(0.03F * sine(1.3F * t), 0.05F * sine(0.8F * t),
                                    0.02F * sine(t));
    const cairn::Vector3<float> r(0.2F * sine(t), 0.1F * sine(1.7F * t), 0.05F * t);
    return {cairn::rotation_exp(phi), r};
  }

  void start() {
    random_ = cairn::Random(7);
    sum_ = worst_ = Ticks{};
    full_frames_ = 0;
    for (cairn::Vector3<float>& p : points_) {
      const float depth = uniform(random_, 1.6F, 3.5F);
      const float x = uniform(random_, -0.4F, 0.4F);
      p = {depth * x, depth * uniform(random_, -0.22F, 0.22F), depth};
    }
    cairn::MonoParameters<float> parameters;
    parameters.linearity_threshold = 0.0F;
    good_ = ok(filter_.initialise(camera(), parameters));
  }

  void frame(int k) {
    const cairn::Rigid<float> T_camera_world = pose(k).inverse();
    Ticks spent{};
    const auto begin = Clock::now();
    if (k > 0) good_ = ok(filter_.predict(kStep)) && good_;
    int count = 0;
    for (int slot = 0; slot < filter_.feature_count(); ++slot) {
      cairn::PixelPrediction<float> prediction;
      if (!ok(filter_.predict_feature(slot, prediction))) continue;
      matches_[count].id = prediction.id;
      matches_[count++].slot = slot;
    }
    spent += Clock::now() - begin;
    for (int i = 0; i < count; ++i) {
      matches_[i].pixel = measure(T_camera_world, matches_[i].id);
    }
    const auto update_begin = Clock::now();
    cairn::UpdateReport report;
    if (count > 0) good_ = ok(filter_.update(matches_, count, random_, report)) && good_;
    spent += Clock::now() - update_begin;
    for (int i = 0; i < kNewFeaturesPerFrame && filter_.feature_count() < Features; ++i) {
      const auto id = static_cast<cairn::LandmarkId>(filter_.feature_count() + 1);
      good_ = ok(filter_.add_feature(id, measure(T_camera_world, id))) && good_;
    }
    if (filter_.feature_count() < Features || 2 * Features != report.nis_dof) return;
    ++full_frames_;
    sum_ += spent;
    if (spent > worst_) worst_ = spent;
  }

  cairn::Vector2<float> measure(const cairn::Rigid<float>& T_camera_world, cairn::LandmarkId id) {
    cairn::Vector2<float> pixel = cairn::Vector2<float>::Zero();
    (void)camera().project(cairn::Vector3<float>(T_camera_world * points_[id - 1U]), pixel);
    pixel.x() += uniform(random_, -0.8F, 0.8F);
    pixel.y() += uniform(random_, -0.8F, 0.8F);
    return pixel;
  }

  cairn::Random random_{7};
  Filter filter_;
  cairn::PixelMatch<float> matches_[Features];
  cairn::Vector3<float> points_[Features];
  Ticks sum_{};
  Ticks worst_{};
  int full_frames_ = 0;
  bool good_ = true;
};

}  // namespace cairn_test

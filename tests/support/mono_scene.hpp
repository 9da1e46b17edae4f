#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "cairn/base/hash.hpp"
#include "cairn/estimation/observation.hpp"
#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/numeric/random.hpp"

namespace cairn::test {

template <class Filter>
std::uint64_t hash_of(const Filter& filter) {
  Hash64 hash;
  filter.hash(hash);
  return hash.value();
}

/// Points in front of a camera that swings sideways and turns: matches without images.
class MonoScene {
 public:
  explicit MonoScene(std::uint32_t seed = 7, double noise_px = 0.3)
      : engine_(seed), normal_(0.0, noise_px) {
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (int i = 0; i < 400; ++i) {
      points_.push_back(Vector3<double>{2.5 * uniform(engine_), 1.6 * uniform(engine_),
                                        2.2 + 0.9 * uniform(engine_)});
    }
  }

  template <class T>
  static PinholeCamera<T> camera() {
    PinholeCamera<T> c;
    c.fx = T(310);
    c.fy = T(305);
    c.cx = T(181);
    c.cy = T(118);
    c.width = 360;
    c.height = 240;
    return c;
  }

  Rigid<double> T_world_camera() const {
    const double t = 0.04 * frame_;
    const Vector3<double> phi(0.05 * std::sin(1.3 * t), 0.25 * std::sin(0.8 * t),
                              0.04 * std::sin(t));
    return {rotation_exp(phi),
            Vector3<double>(0.3 * std::sin(t), 0.1 * std::sin(1.7 * t), 0.08 * t)};
  }

  /// True pixel of the point that carries `id`; outside the image where it is not seen.
  Vector2<double> pixel(LandmarkId id) const {
    const Vector3<double> p = T_world_camera().inverse() * points_[id - 1];
    Vector2<double> out(-1000.0, -1000.0);
    (void)camera<double>().project(p, out);
    return out;
  }

  /// Fills the filter up to `count` features from points in view.
  template <class Filter>
  void add_features(Filter& filter, int count) {
    for (int tries = 0; tries < 4000 && filter.feature_count() < count; ++tries) {
      next_ = next_ % static_cast<LandmarkId>(points_.size()) + 1;
      const Vector2<double> seen = pixel(next_);
      if (!camera<double>().contains(seen, 10.0) || filter.find(next_) >= 0) continue;
      const Vector2<double> measured = measure(next_);
      added_.push_back(measured);
      (void)filter.add_feature(next_, measured.template cast<typename Filter::Scalar>());
    }
  }

  /// Noisy matches of every feature in view, in slot order.
  template <class Filter>
  auto matches(const Filter& filter) {
    using T = typename Filter::Scalar;
    std::vector<PixelMatch<T>> out;
    for (int slot = 0; slot < filter.feature_count(); ++slot) {
      PixelMatch<T> match;
      match.id = filter.feature_id(slot);
      match.slot = slot;
      if (!camera<double>().contains(pixel(match.id))) continue;
      match.pixel = measure(match.id).template cast<T>();
      out.push_back(match);
    }
    return out;
  }

  /// Moves on by one frame and lets the filter follow.
  template <class Filter>
  void step(Filter& filter, Random& random) {
    using T = typename Filter::Scalar;
    ++frame_;
    UpdateReport report;
    (void)filter.predict(T(0.04));
    auto found = matches(filter);
    (void)filter.update(found.data(), static_cast<int>(found.size()), random, report);
  }

  void advance() { ++frame_; }
  /// Pixels of the features added since clear_added().
  const std::vector<Vector2<double>>& added() const { return added_; }
  void clear_added() { added_.clear(); }

 private:
  Vector2<double> measure(LandmarkId id) {
    const Vector2<double> p = pixel(id);
    const double du = normal_(engine_);
    return {p.x() + du, p.y() + normal_(engine_)};
  }
  std::mt19937 engine_;
  std::normal_distribution<double> normal_;
  std::vector<Vector3<double>> points_;
  int frame_ = 0;
  LandmarkId next_ = 0;
  std::vector<Vector2<double>> added_;
};

}  // namespace cairn::test

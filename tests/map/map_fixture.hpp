#pragma once

#include <random>

#include "cairn/base/config.hpp"
#include "cairn/map/library.hpp"

namespace cairn::test {

struct SmallConfig : DefaultConfig {
  static constexpr int kLibraryLandmarks = 24;
};

/// Landmarks in a room of 10 m, each described from 2 to 4 m away.
class LandmarkMaker {
 public:
  explicit LandmarkMaker(unsigned seed) : engine_(seed) {}

  float uniform(float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(engine_);
  }
  unsigned bits() { return static_cast<unsigned>(engine_()); }

  Descriptor descriptor() {
    Descriptor d;
    for (std::uint8_t& b : d.bytes) b = static_cast<std::uint8_t>(bits());
    return d;
  }
  Descriptor flipped(const Descriptor& d, int count) {
    Descriptor result = d;
    for (int i = 0; i < count; ++i) {
      const unsigned bit = bits() % 512U;
      result.bytes[bit / 8] = static_cast<std::uint8_t>(result.bytes[bit / 8] ^ (1U << (bit % 8)));
    }
    return result;
  }
  Vector3<float> position(float half_width) {
    const float x = uniform(-half_width, half_width);
    const float y = uniform(-half_width, half_width);
    const float z = uniform(-half_width, half_width);
    return {x, y, z};
  }

  template <int Views = 1>
  LibraryLandmark<float, Views> landmark(LandmarkId id) {
    LibraryLandmark<float, Views> l;
    l.id = id;
    l.p_map = position(5);
    const float sigma = uniform(0.005F, 0.05F);
    l.covariance = sigma * sigma * Matrix3<float>::Identity();
    l.searches = static_cast<std::uint16_t>(bits() % 40U);
    l.sightings = static_cast<std::uint16_t>(bits() % (l.searches + 1U));
    l.view_count = static_cast<std::uint8_t>(1U + bits() % static_cast<unsigned>(Views));
    for (int v = 0; v < l.view_count; ++v) {
      auto& view = l.views[v];
      view.descriptor = descriptor();
      view.pose.orientation_bin = static_cast<std::uint8_t>(bits());
      view.pose.scale_index = static_cast<std::uint8_t>(bits() % 25U);
      view.focal_px = uniform(300, 700);
      view.T_map_reference.rotation = rotation_exp(position(1.7F));
      const Vector3<float> direction = position(1).normalized();
      view.T_map_reference.translation = l.p_map + uniform(2, 4) * direction;
    }
    return l;
  }

 private:
  std::mt19937 engine_;
};

}  // namespace cairn::test

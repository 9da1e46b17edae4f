// Ticks of the map library's operations by its size: one line per capacity and operation.
//
// usage: library_cost
// archive: a landmark into a full library; visible: the landmarks in view of one pose; slice: one
// frame's share of matching while lost; whole: all of it.

#include <cstdint>

#include "cairn/base/config.hpp"
#include "cairn/base/health.hpp"
#include "cairn/map/library.hpp"
#include "cairn/map/library_matcher.hpp"
#include "cairn/map/visibility.hpp"
#include "cairn/numeric/random.hpp"
#include "cairn/port/port.h"

#include "text.hpp"

namespace {

using cairn_test::write;
using cairn_test::write_decimal;

constexpr int kFeatures = 64;
constexpr int kPairsPerFrame = 2048;

template <int Landmarks>
struct Config : cairn::DefaultConfig {
  static constexpr int kLibraryLandmarks = Landmarks;
};

float uniform(cairn::Random& random, float low, float high) {
  return low + (high - low) * static_cast<float>(random.below(65536)) / 65535.0F;
}

cairn::Descriptor descriptor(cairn::Random& random) {
  cairn::Descriptor result;
  for (std::uint8_t& byte : result.bytes) byte = static_cast<std::uint8_t>(random.below(256));
  return result;
}

cairn::LibraryLandmark<float> landmark(cairn::LandmarkId id, cairn::Random& random) {
  cairn::LibraryLandmark<float> result;
  result.id = id;
  result.p_map = {uniform(random, -5, 5), uniform(random, -5, 5), uniform(random, 2, 8)};
  result.covariance = 1e-4F * cairn::Matrix3<float>::Identity();
  result.searches = 20;
  result.sightings = static_cast<std::uint16_t>(random.below(20));
  result.view_count = 1;
  result.views[0].descriptor = descriptor(random);
  result.views[0].focal_px = 500.0F;
  return result;
}

void print(int landmarks, const char* operation, std::uint32_t ticks) {
  write_decimal(static_cast<std::uint64_t>(landmarks));
  write(" ");
  write(operation);
  write(" ");
  write_decimal(ticks);
  write("\n");
}

template <int Landmarks>
void measure() {
  static cairn::MapLibrary<Config<Landmarks>> library;
  static cairn::LibraryMatcher<Config<Landmarks>, kFeatures> matcher;
  static cairn::VisibleLandmark<float> visible[64];
  cairn::Random random(1);
  cairn::Health health;
  cairn::LandmarkId id = 1;
  while (library.size() < Landmarks) {
    static_cast<void>(library.insert(landmark(id, random), health));
    ++id;
  }
  const cairn::LibraryLandmark<float> newcomer = landmark(id, random);
  std::uint32_t start = cairn_port_ticks();
  static_cast<void>(library.insert(newcomer, health));
  print(Landmarks, "archive", cairn_port_ticks() - start);

  cairn::PinholeCamera<float> camera;
  camera.fx = camera.fy = 500.0F;
  camera.cx = 320.0F;
  camera.cy = 240.0F;
  camera.width = 640;
  camera.height = 480;
  start = cairn_port_ticks();
  static_cast<void>(cairn::find_visible(library, camera, cairn::Rigid<float>{},
                                        cairn::VisibilityOptions<float>{}, {}, visible, 64));
  print(Landmarks, "visible", cairn_port_ticks() - start);

  for (int i = 0; i < kFeatures; ++i) {
    static_cast<void>(matcher.add_feature({1.0F, 1.0F}, descriptor(random)));
  }
  start = cairn_port_ticks();
  bool done = matcher.step(library, kPairsPerFrame, {});
  const std::uint32_t slice = cairn_port_ticks() - start;
  print(Landmarks, "slice", slice);
  while (!done) done = matcher.step(library, kPairsPerFrame, {});
  print(Landmarks, "whole", cairn_port_ticks() - start);
}

}  // namespace

int main() {
  measure<64>();
  measure<256>();
  measure<1024>();
  return 0;
}

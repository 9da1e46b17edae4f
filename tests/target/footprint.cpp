// Prints what a tracker's storage is made of on this target, in bytes: one line per tracker and
// configuration. filter: state and covariance; map: landmarks and seeds; vision: detector,
// search and scratch; tracker: all of it.

#include <cstddef>

#include "cairn/base/config.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/runtime/handheld_tracker.hpp"
#include "cairn/runtime/vehicle_tracker.hpp"

#include "text.hpp"

namespace {

using cairn_test::write;
using cairn_test::write_decimal;

struct Parts {
  std::size_t filter;
  std::size_t map;
  std::size_t vision;
  std::size_t tracker;
};

template <class Supply>
constexpr std::size_t vision_bytes() {
  union Scratch {
    cairn::SearchScratch search;
    typename Supply::Scratch supply;
  };
  return sizeof(Supply) + sizeof(Scratch);
}

template <class Config>
constexpr Parts vehicle() {
  using Filter = cairn::GroupIekfSlam<float, Config::kMaxLandmarks, 3>;
  using Tracker = cairn::VehicleTracker<Config, Filter>;
  return {sizeof(Filter),
          sizeof(cairn::TrackedLandmarks<Config::kMaxLandmarks>) +
              sizeof(typename Tracker::Frames::LocalMap::Seeds),
          vision_bytes<typename Tracker::Supply>(), sizeof(Tracker)};
}

template <class Config>
constexpr Parts handheld() {
  using Tracker = cairn::HandheldTracker<Config>;
  return {sizeof(typename Tracker::Filter), sizeof(cairn::TrackedLandmarks<Config::kMaxFeatures>),
          vision_bytes<typename Tracker::Supply>(), sizeof(Tracker)};
}

void print(const char* name, const Parts& parts) {
  write(name);
  for (const std::size_t bytes : {parts.filter, parts.map, parts.vision, parts.tracker}) {
    write(" ");
    write_decimal(bytes);
  }
  write("\n");
}

}  // namespace

int main() {
  print("vehicle_tiny", vehicle<cairn::TinyConfig>());
  print("vehicle", vehicle<cairn::DefaultConfig>());
  print("vehicle_large", vehicle<cairn::LargeConfig>());
  print("handheld_tiny", handheld<cairn::TinyConfig>());
  print("handheld", handheld<cairn::DefaultConfig>());
  print("handheld_large", handheld<cairn::LargeConfig>());
  return 0;
}

#pragma once

namespace cairn {

/// Capacities of one build of the core: template parameter of filters, tracker and map, so that
/// several can live side by side. Everything that a frame's work is a product of is fixed here.
struct DefaultConfig {
  using Scalar = float;
  static constexpr int kMaxImageWidth = 640;
  static constexpr int kMaxImageHeight = 480;
  static constexpr int kMaxLandmarks = 64;            ///< active: in the filter's state
  static constexpr int kMaxFeatures = 32;             ///< MonoEkf features
  static constexpr int kLibraryLandmarks = 256;       ///< archived
  static constexpr int kMaxSeeds = 32;                ///< seen, not yet in the filter
  static constexpr int kMaxKeyframes = 8;             ///< past positions in the filter's state
  static constexpr int kRelocalisationFeatures = 96;  ///< of an image that is relocalised
  static constexpr int kRelocalisationMatches = 96;   ///< the best of their matches, for the pose
};

struct TinyConfig : DefaultConfig {
  static constexpr int kMaxImageWidth = 320;
  static constexpr int kMaxImageHeight = 240;
  static constexpr int kMaxLandmarks = 16;
  static constexpr int kMaxFeatures = 16;
  static constexpr int kLibraryLandmarks = 48;
  static constexpr int kMaxSeeds = 16;
  static constexpr int kRelocalisationFeatures = 48;
  static constexpr int kRelocalisationMatches = 48;
};

struct LargeConfig : DefaultConfig {
  static constexpr int kMaxImageWidth = 1280;
  static constexpr int kMaxImageHeight = 960;
  static constexpr int kMaxLandmarks = 128;
  static constexpr int kMaxFeatures = 50;
  static constexpr int kLibraryLandmarks = 1024;
  static constexpr int kMaxSeeds = 64;
  static constexpr int kRelocalisationFeatures = 128;
  static constexpr int kRelocalisationMatches = 128;
};

}  // namespace cairn

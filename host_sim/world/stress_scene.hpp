#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "cairn/runtime/input_log_content.hpp"

namespace cairn::host {

/// A synthetic input made to be expensive: a textured plane that the camera passes or drives at,
/// with frames of another kind thrown in. All of it is integers and a seed, so that it is the same
/// everywhere and a search can change it. 640x480.
///
/// A field is set by name (`set`), in the range that `fields()` gives.
struct StressScene {
  int handheld = 0;  ///< 0: vehicle with odometry, 1: video alone
  int seed = 1;
  int frames = 60;
  int texture = 0;      ///< Texture
  int cell_px = 6;      ///< size of its elements
  int density = 40;     ///< percent, kDots
  int contrast = 200;   ///< grey levels
  int along = 0;        ///< 0: the camera passes the plane, 1: drives at it
  int step_mm = 30;     ///< distance travelled per frame
  int depth_mm = 5000;  ///< of the plane at the start
  int turn_after = 0;   ///< frames after which the camera turns back; 0: never
  int period_us = 33333;
  int noise = 2;            ///< grey levels of each pixel, to both sides
  int attack = 0;           ///< Attack
  int attack_from = 40;     ///< first frame that is attacked
  int attack_every = 1;     ///< frames from one attacked frame to the next
  int attack_size = 8;      ///< px
  int attack_seed = 0;      ///< of the attacked frames' own draws
  int attack_step_mm = -1;  ///< step_mm from the first attack on; -1: as before
  int lie_mm = 0;        ///< by so much too long is the distance of an attacked frame by odometry
  int turn_sigma = 2;    ///< odometry noise as stated, mrad/s
  int speed_sigma = 20;  ///< same, mm/s

  enum Texture { kDots, kChecker, kNoise, kAlike, kTextureCount };
  enum Attack { kNone, kNoiseFrame, kCheckerFrame, kJitter, kCut, kBlank, kAttackCount };

  struct Field {
    const char* name;
    int StressScene::*value;
    int low;
    int high;
  };
  static constexpr int kFieldCount = 22;
  static const std::array<Field, kFieldCount>& fields();

  /// `text` is name=value, or the name of a scene, whose fields are then set. False for an unknown
  /// name or a value out of range.
  bool set(const std::string& text);
  /// Every field that differs from its default, as `set` takes it, with spaces between.
  std::string text() const;
  bool attacked(int frame) const;
};

/// Scenes by name: each drives one part of a frame to its worst case.
struct NamedStressScene {
  const char* name;
  const char* fields;  ///< as StressScene::set takes them, with spaces between
  const char* what;
};
const std::vector<NamedStressScene>& named_stress_scenes();

inline constexpr int kStressWidth = 640;
inline constexpr int kStressHeight = 480;

/// A scene's frames and odometry.
class StressRenderer {
 public:
  explicit StressRenderer(const StressScene& scene);

  /// Camera, places and noises of the scene.
  InputLogHeader header() const;
  std::int64_t t_us(int frame) const { return static_cast<std::int64_t>(frame) * scene_.period_us; }
  /// From the frame before to this one.
  OdometrySample odometry(int frame) const;
  void draw(int frame, std::uint8_t* pixels) const;

 private:
  int way_mm(int frame) const;
  void draw_plane(int frame, int seed_of_tile, std::uint8_t* pixels) const;

  StressScene scene_;
  std::vector<std::uint8_t> tile_;
};

}  // namespace cairn::host

#include "host_sim/world/stress_scene.hpp"

#include <algorithm>
#include <charconv>
#include <sstream>

#include "cairn/numeric/random.hpp"

namespace cairn::host {
namespace {

constexpr int kTile = 1024;  // texture pixels; repeats
constexpr float kFocal = 500.0F;
constexpr int kJitterTile = 40;
constexpr int kNearest_mm = 300;

std::uint8_t clamped(int value) {
  return static_cast<std::uint8_t>(std::clamp(value, 0, 255));
}

/// A number of its own for each (seed, index), without a state.
std::uint32_t mixed(std::uint32_t seed, std::uint32_t index) {
  std::uint32_t x = seed * 0x9E3779B9U + index;
  x = (x ^ (x >> 16U)) * 0x7FEB352DU;
  x = (x ^ (x >> 15U)) * 0x846CA68BU;
  return x ^ (x >> 16U);
}

void draw_square(int x0, int y0, int size, std::uint8_t grey, std::vector<std::uint8_t>& tile) {
  for (int y = y0; y < y0 + size; ++y) {
    for (int x = x0; x < x0 + size; ++x) tile[(y % kTile) * kTile + x % kTile] = grey;
  }
}

void draw_dots(const StressScene& scene, int seed, std::vector<std::uint8_t>& tile) {
  Random random(static_cast<std::uint64_t>(seed));
  const int count = kTile * kTile / (scene.cell_px * scene.cell_px) * scene.density / 100;
  for (int i = 0; i < count; ++i) {
    const int size = (scene.cell_px + 1) / 2 + random.below(scene.cell_px / 2 + 1);
    const int x = random.below(kTile);
    const int y = random.below(kTile);
    const int grey = 128 + random.below(scene.contrast + 1) - scene.contrast / 2;
    draw_square(x, y, size, clamped(grey), tile);
  }
}

/// The same mark on every place of a grid.
void draw_alike(const StressScene& scene, std::vector<std::uint8_t>& tile) {
  const int size = scene.cell_px;
  const int pitch = 4 * size;
  const std::uint8_t dark = clamped(128 - scene.contrast / 2);
  const std::uint8_t light = clamped(128 + scene.contrast / 2);
  for (int y = 0; y + pitch <= kTile; y += pitch) {
    for (int x = 0; x + pitch <= kTile; x += pitch) {
      draw_square(x, y, 2 * size, dark, tile);
      draw_square(x + size, y, size, light, tile);
    }
  }
}

std::vector<std::uint8_t> make_tile(const StressScene& scene, int seed) {
  std::vector<std::uint8_t> tile(static_cast<std::size_t>(kTile) * kTile, 128);
  if (scene.texture == StressScene::kDots) {
    draw_dots(scene, seed, tile);
    return tile;
  }
  if (scene.texture == StressScene::kAlike) {
    draw_alike(scene, tile);
    return tile;
  }
  for (int y = 0; y < kTile; ++y) {
    for (int x = 0; x < kTile; ++x) {
      const int column = x / scene.cell_px;
      const int row = y / scene.cell_px;
      const auto index = static_cast<std::uint32_t>(row * kTile + column);
      const int offset =
          scene.texture == StressScene::kChecker
              ? ((row + column) % 2) * scene.contrast
              : static_cast<int>(mixed(static_cast<std::uint32_t>(seed), index) % 256U) *
                    scene.contrast / 255;
      tile[y * kTile + x] = clamped(128 - scene.contrast / 2 + offset);
    }
  }
  return tile;
}

void add_noise(int amplitude, std::uint32_t seed, std::uint8_t* pixels) {
  if (amplitude == 0) return;
  const auto span = static_cast<std::uint32_t>(2 * amplitude + 1);
  for (int i = 0; i < kStressWidth * kStressHeight; ++i) {
    const std::uint32_t draw = mixed(seed, static_cast<std::uint32_t>(i)) >> 8U;
    pixels[i] = clamped(pixels[i] + static_cast<int>((draw * span) >> 24U) - amplitude);
  }
}

void draw_checker(int cell, std::uint8_t* pixels) {
  for (int y = 0; y < kStressHeight; ++y) {
    for (int x = 0; x < kStressWidth; ++x) {
      pixels[y * kStressWidth + x] = (x / cell + y / cell) % 2 != 0 ? 255 : 0;
    }
  }
}

/// Every square of the image moves on its own: each landmark is found, and no two agree.
void jitter(int reach, std::uint32_t seed, std::uint8_t* pixels) {
  const std::vector<std::uint8_t> still(pixels, pixels + kStressWidth * kStressHeight);
  const auto span = static_cast<std::uint32_t>(2 * reach + 1);
  for (int y = 0; y < kStressHeight; ++y) {
    for (int x = 0; x < kStressWidth; ++x) {
      const int square = y / kJitterTile * 64 + x / kJitterTile;
      const std::uint32_t draw = mixed(seed, static_cast<std::uint32_t>(square));
      const int u = x + static_cast<int>(draw % span) - reach;
      const int v = y + static_cast<int>((draw >> 16U) % span) - reach;
      pixels[y * kStressWidth + x] = still[std::clamp(v, 0, kStressHeight - 1) * kStressWidth +
                                           std::clamp(u, 0, kStressWidth - 1)];
    }
  }
}

}  // namespace

const std::array<StressScene::Field, StressScene::kFieldCount>& StressScene::fields() {
  static const std::array<Field, kFieldCount> all = {{
      {"handheld", &StressScene::handheld, 0, 1},
      {"seed", &StressScene::seed, 1, 1000000},
      {"frames", &StressScene::frames, 1, 1000},
      {"texture", &StressScene::texture, 0, kTextureCount - 1},
      {"cell_px", &StressScene::cell_px, 1, 64},
      {"density", &StressScene::density, 1, 200},
      {"contrast", &StressScene::contrast, 0, 255},
      {"along", &StressScene::along, 0, 1},
      {"step_mm", &StressScene::step_mm, 0, 400},
      {"depth_mm", &StressScene::depth_mm, 1000, 30000},
      {"turn_after", &StressScene::turn_after, 0, 200},
      {"period_us", &StressScene::period_us, 5000, 400000},
      {"noise", &StressScene::noise, 0, 60},
      {"attack", &StressScene::attack, 0, kAttackCount - 1},
      {"attack_from", &StressScene::attack_from, 1, 1000},
      {"attack_every", &StressScene::attack_every, 1, 20},
      {"attack_size", &StressScene::attack_size, 1, 40},
      {"attack_seed", &StressScene::attack_seed, 0, 1000000},
      {"attack_step_mm", &StressScene::attack_step_mm, -1, 400},
      {"lie_mm", &StressScene::lie_mm, -400, 400},
      {"turn_sigma", &StressScene::turn_sigma, 0, 1000},
      {"speed_sigma", &StressScene::speed_sigma, 0, 2000},
  }};
  return all;
}

const std::vector<NamedStressScene>& named_stress_scenes() {
  static const std::vector<NamedStressScene> all = {
      {"noise", "attack=1 attack_from=40 frames=52", "white noise instead of every frame"},
      {"noise-flashes", "attack=1 attack_from=40 attack_every=3 frames=56",
       "a frame of white noise now and again"},
      {"checkerboard", "attack=2 attack_from=40 attack_every=3 frames=56",
       "a checkerboard of full contrast now and again"},
      {"windows-overlap",
       "along=1 step_mm=60 turn_after=28 frames=56 period_us=100000 speed_sigma=500 "
       "turn_sigma=200",
       "the widest search windows, drawing together"},
      {"map-in-view", "along=1 turn_after=60 step_mm=40 frames=110",
       "a full map with every landmark in view"},
      {"all-alike", "texture=3 cell_px=5 frames=56", "every descriptor alike"},
      {"no-consensus", "attack=3 attack_size=3 attack_from=40 attack_every=2 frames=56",
       "matches of which no two agree"},
      {"scene-cut", "attack=4 attack_from=40 attack_every=2 frames=60",
       "every landmark replaced at once"},
      {"lost-full-library",
       "density=25 contrast=120 step_mm=120 attack=4 attack_from=400 attack_seed=7 frames=450",
       "a full library searched for a place that it does not contain"},
      {"crowded-full-library",
       "density=70 step_mm=120 attack=4 attack_from=400 attack_seed=7 frames=440",
       "a full library, and then a place with too many corners to be searched for in it"},
      {"lost-small-library",
       "density=25 contrast=120 step_mm=30 attack=4 attack_from=200 attack_seed=7 frames=320",
       "a library of a few dozen landmarks searched for a place that it does not contain"},
      {"evolved-vehicle",
       "seed=268363 frames=46 density=39 contrast=92 along=1 step_mm=40 depth_mm=3019 "
       "turn_after=60 period_us=43943 noise=3 attack=1 attack_size=16 attack_seed=336178 "
       "lie_mm=-351 turn_sigma=521 speed_sigma=758",
       "the most expensive that a search found for the vehicle"},
      {"evolved-handheld",
       "frames=46 cell_px=7 contrast=212 step_mm=33 depth_mm=6360 attack=1 attack_seed=1 "
       "attack_step_mm=399 speed_sigma=1246",
       "the most expensive that a search found for a hand-held camera"},
  };
  return all;
}

bool StressScene::set(const std::string& text) {
  for (const NamedStressScene& scene : named_stress_scenes()) {
    if (text != scene.name) continue;
    std::istringstream values(scene.fields);
    for (std::string value; values >> value;) set(value);
    return true;
  }
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) return false;
  for (const Field& field : fields()) {
    if (text.compare(0, equals, field.name) != 0) continue;
    int value = 0;
    const char* end = text.data() + text.size();
    const auto parsed = std::from_chars(text.data() + equals + 1, end, value);
    if (parsed.ec != std::errc() || parsed.ptr != end) return false;
    if (value < field.low || value > field.high) return false;
    this->*field.value = value;
    return true;
  }
  return false;
}

std::string StressScene::text() const {
  const StressScene standard;
  std::string result;
  for (const Field& field : fields()) {
    if (this->*field.value == standard.*field.value) continue;
    if (!result.empty()) result += ' ';
    result += std::string(field.name) + '=' + std::to_string(this->*field.value);
  }
  return result;
}

bool StressScene::attacked(int frame) const {
  return attack != kNone && frame >= attack_from && (frame - attack_from) % attack_every == 0;
}

StressRenderer::StressRenderer(const StressScene& scene)
    : scene_(scene), tile_(make_tile(scene, scene.seed)) {}

/// Forth and back, so that the plane is never passed.
int StressRenderer::way_mm(int frame) const {
  const int first = scene_.attack_from;
  if (scene_.attack != StressScene::kNone && scene_.attack_step_mm >= 0 && frame > first) {
    return way_mm(first) + scene_.attack_step_mm * (frame - first);
  }
  if (scene_.turn_after == 0) return frame * scene_.step_mm;
  const int phase = frame % (2 * scene_.turn_after);
  return scene_.step_mm * (phase <= scene_.turn_after ? phase : 2 * scene_.turn_after - phase);
}

InputLogHeader StressRenderer::header() const {
  InputLogHeader header;
  header.mode = scene_.handheld != 0 ? LogMode::kHandheld : LogMode::kVehicle;
  header.filter = scene_.handheld != 0 ? LogFilter::kMono : LogFilter::kGroupIekf;
  header.seed = static_cast<std::uint64_t>(scene_.seed);
  header.camera = {kFocal, kFocal, 319.5F, 239.5F,       0.0F,         0.0F,
                   0.0F,   0.0F,   0.0F,   kStressWidth, kStressHeight};
  // Camera to the front, or to the left.
  header.T_vehicle_camera.rotation = scene_.along != 0
                                         ? Quaternion<float>(0.5F, -0.5F, 0.5F, -0.5F)
                                         : Quaternion<float>(0.70710678F, -0.70710678F, 0.0F, 0.0F);
  header.T_vehicle_camera.translation = {0.0F, 0.0F, 1.0F};
  header.speed_sigma_mps = static_cast<float>(scene_.speed_sigma) * 1e-3F;
  header.turn_sigma = static_cast<float>(scene_.turn_sigma) * 1e-3F;
  header.odometry_period_s = static_cast<float>(scene_.period_us) * 1e-6F;
  header.frame_rate_hz = 1e6F / static_cast<float>(scene_.period_us);
  header.start_position_variance = 1e-6F;
  header.start_heading_variance = 1e-6F;
  return header;
}

OdometrySample StressRenderer::odometry(int frame) const {
  OdometrySample sample;
  sample.t_us = t_us(frame);
  const int lie = scene_.attacked(frame) ? scene_.lie_mm : 0;
  const int way = frame > 0 ? way_mm(frame) - way_mm(frame - 1) + lie : 0;
  sample.speed_mps = static_cast<float>(way) * 1e3F / static_cast<float>(scene_.period_us);
  return sample;
}

void StressRenderer::draw(int frame, std::uint8_t* pixels) const {
  const bool attacked = scene_.attacked(frame);
  const int own_seed = attacked ? scene_.attack_seed : 0;
  const std::uint32_t seed =
      mixed(static_cast<std::uint32_t>(scene_.seed),
            mixed(static_cast<std::uint32_t>(own_seed), static_cast<std::uint32_t>(frame)));
  const int attack = attacked ? scene_.attack : static_cast<int>(StressScene::kNone);
  if (attack == StressScene::kCheckerFrame) return draw_checker(scene_.attack_size, pixels);
  if (attack == StressScene::kBlank || attack == StressScene::kNoiseFrame) {
    std::fill_n(pixels, kStressWidth * kStressHeight, std::uint8_t{128});
    if (attack == StressScene::kNoiseFrame) add_noise(127, seed, pixels);
    return;
  }
  draw_plane(frame, attack == StressScene::kCut ? scene_.seed + own_seed + frame : scene_.seed,
             pixels);
  if (attack == StressScene::kJitter) jitter(scene_.attack_size, seed, pixels);
  add_noise(scene_.noise, seed, pixels);
}

/// Bilinear in 16.8 fixed point.
void StressRenderer::draw_plane(int frame, int seed_of_tile, std::uint8_t* pixels) const {
  const std::vector<std::uint8_t> other =
      seed_of_tile == scene_.seed ? std::vector<std::uint8_t>() : make_tile(scene_, seed_of_tile);
  const std::vector<std::uint8_t>& tile = other.empty() ? tile_ : other;
  const std::int64_t way = way_mm(frame);
  const std::int64_t depth = scene_.along != 0
                                 ? std::max<std::int64_t>(scene_.depth_mm - way, kNearest_mm)
                                 : scene_.depth_mm;
  // Texture pixels per image pixel, and the plane's way sideways, both in 1/256.
  const std::int64_t scale = 256 * depth / scene_.depth_mm;
  const std::int64_t aside =
      scene_.along != 0 ? 0 : static_cast<std::int64_t>(kFocal) * 256 * way / scene_.depth_mm;
  const auto centre = std::int64_t{kTile} * 256 * 8;
  for (int y = 0; y < kStressHeight; ++y) {
    const std::int64_t v = centre + (2 * y - kStressHeight + 1) * scale / 2;
    const auto row = static_cast<int>((v >> 8) % kTile);
    const auto fv = static_cast<int>(v & 255);
    const std::uint8_t* upper = &tile[static_cast<std::size_t>(row) * kTile];
    const std::uint8_t* lower = &tile[static_cast<std::size_t>((row + 1) % kTile) * kTile];
    for (int x = 0; x < kStressWidth; ++x) {
      const std::int64_t u = centre + aside + (2 * x - kStressWidth + 1) * scale / 2;
      const auto left = static_cast<int>((u >> 8) % kTile);
      const auto fu = static_cast<int>(u & 255);
      const int right = (left + 1) % kTile;
      const int above = upper[left] * (256 - fu) + upper[right] * fu;
      const int below = lower[left] * (256 - fu) + lower[right] * fu;
      pixels[y * kStressWidth + x] =
          static_cast<std::uint8_t>((above * (256 - fv) + below * fv + 32768) >> 16);
    }
  }
}

}  // namespace cairn::host

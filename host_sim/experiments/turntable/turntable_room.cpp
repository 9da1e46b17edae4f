#include "host_sim/experiments/turntable/turntable_room.hpp"

#include <cmath>
#include <utility>

#include "host_sim/experiments/turntable/turntable_score.hpp"
#include "host_sim/world/hall_textures.hpp"
#include "host_sim/world/renderer.hpp"
#include "host_sim/world/sensor.hpp"

namespace cairn::host {
namespace {

using Point = Vector3<double>;

constexpr double kHalfX = 3.0, kHalfY = 1.5, kHalfZ = 2.8;  // x right, y down, z forward
constexpr double kPxPerM = 200.0;

class RoomBuilder {
 public:
  explicit RoomBuilder(std::uint64_t seed) : random_(seed ^ 0x7ab1eULL) {}

  Scene build() {
    add_walls();
    add_floor_and_ceiling();
    // Direction from the first view, distance, half sizes: m and rad.
    add_box(-0.35, 1.9, {0.25, 0.35, 0.2}, 0.9);
    add_box(0.15, 2.2, {0.35, 0.5, 0.3}, 0.8);
    add_box(0.55, 1.5, {0.2, 0.2, 0.2}, 0.5);
    add_box(0.95, 2.1, {0.3, 0.6, 0.3}, 0.6);
    add_box(1.45, 1.7, {0.25, 0.3, 0.25}, 0.8);
    return std::move(scene_);
  }

 private:
  void add(const Point& left_top, const Point& right, const Point& down, const cv::Mat& image,
           int gain) {
    scene_.textures.emplace_back(image);
    scene_.quads.push_back(
        {left_top, right, down, static_cast<int>(scene_.textures.size()) - 1, gain});
  }

  void add_walls() {
    const Point corners[4] = {{-kHalfX, -kHalfY, kHalfZ},
                              {kHalfX, -kHalfY, kHalfZ},
                              {kHalfX, -kHalfY, -kHalfZ},
                              {-kHalfX, -kHalfY, -kHalfZ}};
    const int gains[4] = {256, 240, 250, 232};
    for (int wall = 0; wall < 4; ++wall) {
      const Point right = corners[(wall + 1) % 4] - corners[wall];
      add_panels(corners[wall], right, {0.0, 2.0 * kHalfY, 0.0}, gains[wall]);
    }
  }

  /// A surface of four by two painted panels.
  void add_panels(const Point& left_top, const Point& right, const Point& down, int gain) {
    const Point across = right / 4.0;
    const Point below = down / 2.0;
    for (int i = 0; i < 8; ++i) {
      add(left_top + (i % 4) * across + (i / 4) * below, across, below,
          paint_poster(static_cast<int>(across.norm() * kPxPerM),
                       static_cast<int>(below.norm() * kPxPerM), random_),
          gain);
    }
  }

  void add_floor_and_ceiling() {
    add_panels({-kHalfX, kHalfY, kHalfZ}, {2.0 * kHalfX, 0.0, 0.0}, {0.0, 0.0, -2.0 * kHalfZ}, 236);
    add_panels({-kHalfX, -kHalfY, -kHalfZ}, {2.0 * kHalfX, 0.0, 0.0}, {0.0, 0.0, 2.0 * kHalfZ},
               256);
  }

  void add_box(double azimuth, double distance, const Point& half, double y) {
    const Point c(distance * std::sin(azimuth), y, distance * std::cos(azimuth));
    const double x = half.x(), h = half.y(), z = half.z();
    const auto side = [&](const Point& left_top, const Point& right, int gain) {
      const cv::Mat image = paint_poster(static_cast<int>(2.0 * right.norm() * kPxPerM),
                                         static_cast<int>(4.0 * h * kPxPerM), random_);
      add(c + left_top, right, {0.0, 2.0 * h, 0.0}, image, gain);
    };
    side({-x, -h, -z}, {2.0 * x, 0.0, 0.0}, 256);
    side({-x, -h, z}, {0.0, 0.0, -2.0 * z}, 236);
    side({x, -h, -z}, {0.0, 0.0, 2.0 * z}, 240);
    side({x, -h, z}, {-2.0 * x, 0.0, 0.0}, 226);
    add(c + Point(-x, -h, z), {2.0 * x, 0.0, 0.0}, {0.0, 0.0, -2.0 * z},
        paint_table_top(static_cast<int>(2.0 * x * kPxPerM), static_cast<int>(2.0 * z * kPxPerM),
                        random_),
        250);
  }

  GaussianRandom random_;
  Scene scene_;
};

}  // namespace

std::vector<cv::Mat> render_turntable(const PointsScenario& scenario, double noise_grey) {
  PointsScenario exact = scenario;
  exact.focal_error = exact.principal_error_px = 0.0;
  const Scene scene = RoomBuilder(scenario.seed).build();
  Renderer renderer(believed_camera<double>(exact));
  Sensor::Settings settings;
  settings.noise_sigma = noise_grey;
  settings.seed = scenario.seed;
  Sensor sensor(settings);
  std::vector<cv::Mat> video;
  cv::Mat ideal;
  for (const TurntablePose& pose : turntable_poses(scenario.motion)) {
    const int number = static_cast<int>(video.size());
    renderer.render(scene, {Quaternion<double>(pose.rotation), pose.position}, ideal);
    cv::Mat grey;
    sensor.expose(ideal, number, number / scenario.motion.fps, grey);
    video.push_back(grey);
  }
  return video;
}

}  // namespace cairn::host

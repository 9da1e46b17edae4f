#include "host_sim/world/hall.hpp"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "host_sim/world/hall_textures.hpp"

namespace cairn::host {
namespace {

constexpr double kHalf = 10.0;
constexpr double kHeight = 3.2;
constexpr double kWallPxPerM = 144.0;
constexpr double kFloorPxPerM = 120.0;
constexpr double kCeilingPxPerM = 40.0;
constexpr double kFurniturePxPerM = 200.0;

enum class Kind { kCrate, kBooks, kCabinet, kPillar, kTable };

/// Blue, green, red of 128 grey, about as bright as that.
const cv::Vec3b kWallTints[4] = {
    {112, 126, 136}, {122, 130, 124}, {116, 128, 130}, {128, 128, 124}};
const cv::Vec3b kFloorTint(104, 124, 144);
const cv::Vec3b kCeilingTint(128, 128, 128);

cv::Vec3b tint_of(Kind kind) {
  switch (kind) {
    case Kind::kCrate:
      return {64, 122, 164};
    case Kind::kBooks:
      return {100, 118, 156};
    case Kind::kCabinet:
      return {150, 130, 112};
    case Kind::kPillar:
      return {124, 128, 128};
    default:
      return {84, 122, 156};
  }
}

/// A box on the floor: centre, extents, all along the axes.
struct Furniture {
  Kind kind;
  double x, y;
  double size_x, size_y, size_z;
  double base_z = 0.0;
};

const std::vector<Furniture>& furniture() {
  static const std::vector<Furniture> list = {
      // inside the drive
      {Kind::kBooks, -2.6, -2.9, 2.2, 0.5, 1.9},
      {Kind::kBooks, 2.9, 2.2, 0.5, 2.2, 1.9},
      {Kind::kCabinet, 1.2, -3.4, 1.6, 0.6, 0.95},
      {Kind::kCabinet, -3.2, 1.4, 0.6, 1.6, 0.95},
      {Kind::kPillar, -3.6, -3.6, 0.5, 0.5, kHeight},
      {Kind::kPillar, 3.6, -3.6, 0.5, 0.5, kHeight},
      {Kind::kPillar, 3.6, 3.6, 0.5, 0.5, kHeight},
      {Kind::kPillar, -3.6, 3.6, 0.5, 0.5, kHeight},
      {Kind::kCrate, 3.4, -0.9, 0.8, 0.8, 0.8},
      {Kind::kCrate, 3.3, -0.85, 0.5, 0.5, 0.5, 0.8},
      {Kind::kCrate, -1.3, 3.4, 0.9, 0.7, 0.7},
      {Kind::kCrate, 1.0, 3.6, 0.6, 0.6, 0.6},
      {Kind::kTable, 0.0, 0.0, 1.8, 1.0, 0.75},
      // outside the drive, along the walls
      {Kind::kBooks, -6.6, -9.6, 2.4, 0.5, 2.0},
      {Kind::kCabinet, 2.6, -9.5, 1.8, 0.6, 0.9},
      {Kind::kCrate, 8.9, -8.7, 0.9, 0.9, 0.9},
      {Kind::kCrate, 8.0, -9.2, 0.7, 0.7, 0.7},
      {Kind::kBooks, 9.6, -6.3, 0.5, 2.2, 2.0},
      {Kind::kCabinet, 9.5, 2.4, 0.6, 1.8, 0.9},
      {Kind::kCrate, 8.8, 8.9, 1.0, 0.8, 0.8},
      {Kind::kCrate, 8.9, 8.8, 0.5, 0.5, 0.5, 0.8},
      {Kind::kBooks, 6.5, 9.6, 2.2, 0.5, 2.0},
      {Kind::kCabinet, -2.8, 9.5, 1.6, 0.6, 0.9},
      {Kind::kCrate, -8.8, 8.7, 0.8, 0.9, 0.9},
      {Kind::kBooks, -9.6, 6.55, 0.5, 2.3, 2.0},
      {Kind::kCabinet, -9.5, -2.2, 0.6, 1.8, 0.9},
      {Kind::kCrate, -8.9, -8.6, 0.8, 0.8, 0.8},
      {Kind::kTable, 7.9, 5.6, 0.9, 1.4, 0.75},
      {Kind::kTable, -7.9, -5.4, 0.9, 1.4, 0.75},
  };
  return list;
}

std::vector<WallPicture> pictures_of(int wall) {
  const double shift = 0.15 * wall;
  return {{1.2 + shift, 1.25, 1.3, 1.0},
          {6.6 + shift, 1.35, 1.1, 0.8},
          {12.4 + shift, 1.15, 0.9, 1.25},
          {13.7 + shift, 1.4, 1.0, 0.75},
          {17.6 - shift, 1.2, 1.2, 1.05}};
}

class HallBuilder {
 public:
  explicit HallBuilder(std::uint64_t seed) : random_(seed ^ 0x4a11ULL) {}

  Hall build() {
    add_walls();
    add_floor_and_ceiling();
    int number = 1;
    for (const Furniture& item : furniture()) add_furniture(item, number++);
    return std::move(hall_);
  }

 private:
  int add_texture(const cv::Mat& image) {
    hall_.scene.textures.emplace_back(image);
    return static_cast<int>(hall_.scene.textures.size()) - 1;
  }

  void add_quad(const Vector3<double>& origin, const Vector3<double>& edge_s,
                const Vector3<double>& edge_t, int texture, int gain, const cv::Vec3b& tint) {
    hall_.scene.quads.push_back({origin, edge_s, edge_t, texture, gain, tint});
  }

  void add_walls() {
    // Seen from inside: left end, direction to the right, as the texture runs.
    const Vector3<double> left_top[4] = {{kHalf, -kHalf, kHeight},
                                         {kHalf, kHalf, kHeight},
                                         {-kHalf, kHalf, kHeight},
                                         {-kHalf, -kHalf, kHeight}};
    const Vector3<double> right[4] = {{-1, 0, 0}, {0, -1, 0}, {1, 0, 0}, {0, 1, 0}};
    const int gains[4] = {250, 232, 256, 240};
    const Vector3<double> down(0, 0, -kHeight);
    for (int wall = 0; wall < 4; ++wall) {
      const std::vector<WallPicture> pictures = pictures_of(wall);
      const int texture =
          add_texture(paint_wall(2 * kHalf, kHeight, kWallPxPerM, wall, pictures, random_));
      add_quad(left_top[wall], 2 * kHalf * right[wall], down, texture, gains[wall],
               kWallTints[wall]);
      for (const WallPicture& picture : pictures) {
        const Vector3<double> foot = left_top[wall] + Vector3<double>(0, 0, -kHeight);
        const double top = picture.bottom_m + picture.height_m;
        hall_.scene_points.push_back(foot + picture.left_m * right[wall] +
                                     Vector3<double>(0, 0, top));
        hall_.scene_points.push_back(foot + (picture.left_m + picture.width_m) * right[wall] +
                                     Vector3<double>(0, 0, picture.bottom_m));
      }
    }
  }

  void add_floor_and_ceiling() {
    const int side = round_to_int(2 * kHalf * kFloorPxPerM);
    cv::Mat floor = paint_floor(side, kFloorPxPerM, random_);
    draw_lane(floor);
    for (const Furniture& item : furniture()) darken_below(floor, item);
    add_quad({-kHalf, kHalf, 0}, {2 * kHalf, 0, 0}, {0, -2 * kHalf, 0}, add_texture(floor), 256,
             kFloorTint);
    const int ceiling_side = round_to_int(2 * kHalf * kCeilingPxPerM);
    add_quad({-kHalf, -kHalf, kHeight}, {2 * kHalf, 0, 0}, {0, 2 * kHalf, 0},
             add_texture(paint_ceiling(ceiling_side, kCeilingPxPerM, random_)), 215, kCeilingTint);
  }

  static cv::Point floor_px(double x, double y) {
    return {round_to_int((x + kHalf) * kFloorPxPerM), round_to_int((kHalf - y) * kFloorPxPerM)};
  }

  static void draw_lane(cv::Mat& floor) {
    for (const double half : {4.9, 7.0}) {
      cv::rectangle(floor, floor_px(-half, half), floor_px(half, -half), cv::Scalar(215), 7);
    }
    const double middle = 5.95;
    for (int side = 0; side < 4; ++side) {
      for (const double along : {-3.6, -1.2, 1.2, 3.6}) {
        const double c[4] = {1, 0, -1, 0};
        const double s[4] = {0, 1, 0, -1};
        const auto place = [&](double forward, double left) {
          const double x = along + forward;
          const double y = -middle + left;
          return floor_px(c[side] * x - s[side] * y, s[side] * x + c[side] * y);
        };
        const std::vector<cv::Point> arrow = {
            place(0.45, 0.0),    place(0.05, 0.3),   place(0.05, 0.12), place(-0.45, 0.12),
            place(-0.45, -0.12), place(0.05, -0.12), place(0.05, -0.3)};
        const cv::Point* points = arrow.data();
        const int count = static_cast<int>(arrow.size());
        cv::fillPoly(floor, &points, &count, 1, cv::Scalar(225), cv::LINE_AA);
      }
    }
  }

  static void darken_below(cv::Mat& floor, const Furniture& item) {
    if (item.base_z > 0.0) return;
    const double margin = 0.12;
    const cv::Point a =
        floor_px(item.x - 0.5 * item.size_x - margin, item.y + 0.5 * item.size_y + margin);
    const cv::Point b =
        floor_px(item.x + 0.5 * item.size_x + margin, item.y - 0.5 * item.size_y - margin);
    const cv::Rect area = cv::Rect(a, b) & cv::Rect(0, 0, floor.cols, floor.rows);
    cv::Mat part = floor(area);
    part.convertTo(part, -1, 0.55, 0.0);
    const cv::Rect around = cv::Rect(area.x - 20, area.y - 20, area.width + 40, area.height + 40) &
                            cv::Rect(0, 0, floor.cols, floor.rows);
    cv::Mat blurred = floor(around);
    cv::blur(blurred, blurred, {15, 15});
  }

  cv::Mat paint_side(const Furniture& item, double width_m, double height_m, bool front,
                     int number) {
    const int width = std::max(16, round_to_int(width_m * kFurniturePxPerM));
    const int height = std::max(16, round_to_int(height_m * kFurniturePxPerM));
    switch (item.kind) {
      case Kind::kCrate:
        return paint_crate(width, height, number, random_);
      case Kind::kBooks:
        return front ? paint_books(width, height, kFurniturePxPerM, random_)
                     : paint_poster(width, height, random_);
      case Kind::kCabinet:
        return paint_cabinet(width, height, random_);
      case Kind::kPillar:
        return paint_pillar(width, height, number, random_);
      default:
        return paint_table_top(width, height, random_);
    }
  }

  void add_box(const Furniture& item, int number) {
    const Vector3<double> low(item.x - 0.5 * item.size_x, item.y - 0.5 * item.size_y, item.base_z);
    const Vector3<double> high(item.x + 0.5 * item.size_x, item.y + 0.5 * item.size_y,
                               item.base_z + item.size_z);
    const Vector3<double> down(0, 0, -item.size_z);
    const Vector3<double> ex(item.size_x, 0, 0);
    const Vector3<double> ey(0, item.size_y, 0);
    const auto touches_wall = [](double c) { return std::abs(c) > kHalf - 0.2; };
    const bool wide = item.size_x >= item.size_y;
    struct Side {
      Vector3<double> origin, edge_s;
      double outward;  // coordinate along the outward axis
      bool front;
      int gain;
    };
    const Side sides[4] = {{{low.x(), low.y(), high.z()}, ex, low.y(), wide, 250},
                           {{high.x(), low.y(), high.z()}, ey, high.x(), !wide, 225},
                           {{high.x(), high.y(), high.z()}, -ex, high.y(), wide, 256},
                           {{low.x(), high.y(), high.z()}, -ey, low.x(), !wide, 235}};
    for (const Side& side : sides) {
      if (touches_wall(side.outward)) continue;
      const cv::Mat image = paint_side(item, side.edge_s.norm(), item.size_z, side.front, number);
      add_quad(side.origin, side.edge_s, down, add_texture(image), side.gain, tint_of(item.kind));
    }
    if (item.kind != Kind::kPillar) {
      const cv::Mat top =
          paint_table_top(std::max(16, round_to_int(item.size_x * kFurniturePxPerM)),
                          std::max(16, round_to_int(item.size_y * kFurniturePxPerM)), random_);
      add_quad({low.x(), high.y(), high.z()}, ex, -ey, add_texture(top), 256, tint_of(item.kind));
    }
  }

  void add_furniture(const Furniture& item, int number) {
    if (item.kind != Kind::kTable) {
      add_box(item, number);
      return;
    }
    const double thickness = 0.08;
    const double leg = 0.08;
    add_box({Kind::kTable, item.x, item.y, item.size_x, item.size_y, thickness,
             item.size_z - thickness},
            number);
    for (const double sx : {-1.0, 1.0}) {
      for (const double sy : {-1.0, 1.0}) {
        add_box({Kind::kTable, item.x + sx * 0.5 * (item.size_x - leg),
                 item.y + sy * 0.5 * (item.size_y - leg), leg, leg, item.size_z - thickness},
                number);
      }
    }
    add_box({Kind::kCrate, item.x + 0.1, item.y - 0.1, 0.36, 0.3, 0.26, item.size_z}, number);
  }

  GaussianRandom random_;
  Hall hall_;
};

}  // namespace

Hall build_hall(std::uint64_t seed) {
  return HallBuilder(seed).build();
}

}  // namespace cairn::host

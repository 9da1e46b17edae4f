#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "host_sim/world/gaussian.hpp"

namespace cairn::host {

/// Painted surfaces of the hall, 8-bit grey. Sizes are in pixels; every picture is a function of
/// the generator's state alone.
cv::Mat paint_floor(int side_px, double px_per_m, GaussianRandom& random);
cv::Mat paint_ceiling(int side_px, double px_per_m, GaussianRandom& random);

/// A framed picture on a wall: its place in metres from the wall's left end and the floor.
struct WallPicture {
  double left_m;
  double bottom_m;
  double width_m;
  double height_m;
};
cv::Mat paint_wall(double length_m, double height_m, double px_per_m, int number,
                   const std::vector<WallPicture>& pictures, GaussianRandom& random);

cv::Mat paint_crate(int width_px, int height_px, int label, GaussianRandom& random);
cv::Mat paint_books(int width_px, int height_px, double px_per_m, GaussianRandom& random);
cv::Mat paint_cabinet(int width_px, int height_px, GaussianRandom& random);
cv::Mat paint_poster(int width_px, int height_px, GaussianRandom& random);
cv::Mat paint_pillar(int width_px, int height_px, int label, GaussianRandom& random);
cv::Mat paint_table_top(int width_px, int height_px, GaussianRandom& random);

}  // namespace cairn::host

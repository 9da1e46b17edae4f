#pragma once

#include <string>

#include <opencv2/core.hpp>

#include "host_sim/world/gaussian.hpp"

namespace cairn::host {

// What the hall's surfaces are painted with.

/// Smooth random shading added to a surface: a coarse grid of levels, enlarged.
void add_mottle(cv::Mat& image, int cell_px, double amplitude, GaussianRandom& random);
void add_vertical_shade(cv::Mat& image, double top_gain, double bottom_gain);
void box(cv::Mat& image, const cv::Rect& rect, int level);
void label(cv::Mat& image, const std::string& text, cv::Point centre, double height_px, int level);
void draw_landscape(cv::Mat& area, GaussianRandom& random);
/// One in a frame: a landscape, shapes, a notice or blocks.
void draw_picture(cv::Mat& image, const cv::Rect& place, int style, GaussianRandom& random);

}  // namespace cairn::host

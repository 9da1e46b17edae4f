#pragma once

#include <filesystem>
#include <vector>

#include <opencv2/core.hpp>

#include "cairn/vision/fast.hpp"
#include "cairn/vision/freak.hpp"

namespace cairn::host {

struct Feature {
  Corner corner;
  std::uint8_t orientation_bin = 0;
  Descriptor descriptor;
};

ImageView view_of(const cv::Mat& grey);

/// Grey image as OpenCV's IMREAD_GRAYSCALE reads it. Throws InputError when it cannot be read or is
/// larger than the core takes.
cv::Mat read_grey(const std::filesystem::path& file);

/// All FAST corners of the image, raster order.
std::vector<Corner> detect_corners(const cv::Mat& grey, int threshold);

/// The `count` corners of highest score and those equal in score to the last of them (all when
/// `count` is 0), strongest first, equal ones in raster order.
std::vector<Corner> strongest(std::vector<Corner> corners, int count);

/// Self-oriented FREAK of the corners far enough from the border; the others are left out.
std::vector<Feature> describe_corners(const cv::Mat& grey, const std::vector<Corner>& corners);

std::string to_hex(const Descriptor& descriptor);

/// Columns x,y,score.
void write_corners(const std::vector<Corner>& corners, const std::filesystem::path& file);
/// Columns x,y,orientation_bin_of_256,descriptor_hex (byte 0 first).
void write_features(const std::vector<Feature>& features, const std::filesystem::path& file);

}  // namespace cairn::host

#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core.hpp>

#include "host_sim/io/picture_header.hpp"

namespace cairn::host {

/// Most pixels that a picture may have; one that has more is refused before it is decoded.
inline constexpr std::int64_t kMostPixels = std::int64_t{1} << 27;

/// Which values of 16-bit pictures are shown as black and white.
struct GreyLevels {
  int black = 0;
  int white = 65535;
};

/// What is damaged in the data of a JPEG, in words; empty where nothing is.
using JpegCheck = std::string (*)(std::string_view bytes);
/// From now on a JPEG in which `check` finds damage is refused: find_jpeg_damage() in cairn_sim.
/// Without it damage is not noticed, and a program need not be linked with libjpeg. To be called
/// before pictures are read.
void set_jpeg_check(JpegCheck check);

/// Reads a picture (PNG, JPEG, PGM, PPM, BMP) as 8-bit grey, as OpenCV's IMREAD_GRAYSCALE does; one
/// of 16 bits is mapped by `levels`. Bytes behind the picture's end are left alone. Throws
/// InputError when it cannot be read, is cut short or (set_jpeg_check()) damaged, has 16 bits and
/// there are no `levels`, or is not of `size` (an empty size takes any).
void read_grey_image(const std::filesystem::path& path, const cv::Size& size, cv::Mat& grey,
                     const std::optional<GreyLevels>& levels = std::nullopt);

/// Reads a picture of 8 bits as BGR; of a grey one the three are equal. Throws as
/// read_grey_image().
cv::Mat read_colour_image(const std::filesystem::path& path, const cv::Size& size);

/// The header of a picture file. Throws InputError where it is no picture that is read.
PictureHeader read_picture_header_of(const std::filesystem::path& path);

/// Levels for a sequence of 16-bit pictures, whatever number of bits they really use: all but one
/// in ten thousand of their pixels at each end lie between them. Reads every picture. Throws
/// InputError as read_grey_image().
GreyLevels find_grey_levels(const std::vector<std::filesystem::path>& pictures);

}  // namespace cairn::host

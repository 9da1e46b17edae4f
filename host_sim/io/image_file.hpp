#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace cairn::host {

/// Reads a picture as 8-bit grey (as OpenCV's IMREAD_GRAYSCALE does). Throws InputError when it
/// cannot be read, is cut short, or is not of `size` (an empty size takes any).
void read_grey_image(const std::filesystem::path& path, const cv::Size& size, cv::Mat& grey);

/// A file of a numbered sequence.
struct NumberedFile {
  int number = 0;
  std::filesystem::path path;
};

/// Files in `folder` whose name is `prefix` (any, when there is none given), digits and one of
/// `suffixes`, by number. Numbers may start anywhere and have gaps. Throws InputError when there is
/// no such file.
std::vector<NumberedFile> list_numbered_files(const std::filesystem::path& folder,
                                              const std::optional<std::string>& prefix,
                                              const std::vector<std::string>& suffixes);

}  // namespace cairn::host

#include "host_sim/io/image_file.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <fstream>
#include <iterator>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "host_sim/io/input_error.hpp"
#include "host_sim/io/text_file.hpp"

namespace cairn::host {
namespace {

constexpr std::size_t kTrailerBytes = 1024;

bool has_in_tail(const std::vector<char>& bytes, const char* mark, std::size_t length) {
  const std::size_t tail = std::min(bytes.size(), kTrailerBytes);
  return std::search(bytes.end() - static_cast<std::ptrdiff_t>(tail), bytes.end(), mark,
                     mark + length) != bytes.end();
}

/// OpenCV decodes a JPEG that was cut short and fills the rest with grey; the end mark tells.
bool is_cut_short(const std::vector<char>& bytes) {
  if (bytes.size() > 2 && std::memcmp(bytes.data(), "\xFF\xD8", 2) == 0) {
    return !has_in_tail(bytes, "\xFF\xD9", 2);
  }
  if (bytes.size() > 8 && std::memcmp(bytes.data(), "\x89PNG", 4) == 0) {
    return !has_in_tail(bytes, "IEND", 4);
  }
  return false;
}

std::optional<int> number_in(const std::string& name, const std::optional<std::string>& prefix,
                             const std::string& suffix) {
  if (name.size() <= suffix.size() ||
      name.compare(name.size() - suffix.size(), suffix.size(), suffix) != 0) {
    return std::nullopt;
  }
  const std::string stem = name.substr(0, name.size() - suffix.size());
  const std::size_t digits = stem.find_last_not_of("0123456789") + 1;  // npos + 1 = 0
  if (prefix.has_value() && stem.substr(0, digits) != *prefix) return std::nullopt;
  int number = 0;
  const char* end = stem.data() + stem.size();
  const auto parsed = std::from_chars(stem.data() + digits, end, number);
  if (parsed.ec != std::errc() || parsed.ptr != end) return std::nullopt;
  return number;
}

}  // namespace

void read_grey_image(const std::filesystem::path& path, const cv::Size& size, cv::Mat& grey) {
  require_file(path, "an image");
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  if (!file && !file.eof()) throw InputError(path, "cannot be read");
  if (bytes.empty()) throw InputError(path, "expected an image, found an empty file");
  if (is_cut_short(bytes)) {
    throw InputError(path, "expected a whole image; the file is cut short");
  }
  try {
    grey = cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
  } catch (const cv::Exception&) {
    grey.release();
  }
  if (grey.empty()) throw InputError(path, "expected an image (PNG, JPEG, PGM, ...) that decodes");
  if (!size.empty() && grey.size() != size) {
    throw InputError(path, fmt::format("expected {}x{} pixels as the camera has, found {}x{}",
                                       size.width, size.height, grey.cols, grey.rows));
  }
}

std::vector<NumberedFile> list_numbered_files(const std::filesystem::path& folder,
                                              const std::optional<std::string>& prefix,
                                              const std::vector<std::string>& suffixes) {
  require_folder(folder, "a folder of images");
  std::vector<NumberedFile> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    for (const std::string& suffix : suffixes) {
      const std::optional<int> number = number_in(name, prefix, suffix);
      if (number.has_value()) files.push_back({*number, entry.path()});
    }
  }
  if (files.empty()) {
    throw InputError(folder, fmt::format("expected images named {}NUMBER{}", prefix.value_or(""),
                                         fmt::join(suffixes, " or ")));
  }
  std::sort(files.begin(), files.end(), [](const NumberedFile& a, const NumberedFile& b) {
    return a.number < b.number || (a.number == b.number && a.path < b.path);
  });
  for (std::size_t i = 1; i < files.size(); ++i) {
    if (files[i].number == files[i - 1].number) {
      throw InputError(files[i].path, "expected one image for each number, found a second one");
    }
  }
  return files;
}

}  // namespace cairn::host

#include "host_sim/io/image_file.hpp"

#include <algorithm>
#include <array>
#include <fstream>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "host_sim/io/input_error.hpp"
#include "host_sim/io/text_file.hpp"

namespace cairn::host {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestPictureFile = std::uintmax_t{1} << 30;
constexpr std::size_t kHeaderBytes = std::size_t{1} << 18;
constexpr double kShareBeyondLevels = 1e-4;
JpegCheck jpeg_check = nullptr;

constexpr const char* kExpected = "expected an image (PNG, JPEG, PGM, PPM or BMP) that decodes";

std::string read_bytes(const fs::path& path, std::size_t most) {
  require_file(path, "an image");
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) throw InputError(path, "cannot be read");
  if (size == 0) throw InputError(path, "expected an image, found an empty file");
  if (size > kLargestPictureFile) {
    throw InputError(path,
                     fmt::format("expected an image of at most {} bytes", kLargestPictureFile));
  }
  std::string bytes(std::min<std::size_t>(most, size), '\0');
  std::ifstream file(path, std::ios::binary);
  if (!file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) {
    throw InputError(path, "cannot be read");
  }
  return bytes;
}

PictureHeader checked_header(const fs::path& path, std::string_view bytes) {
  const std::optional<PictureHeader> header = read_picture_header(bytes);
  if (!header.has_value()) throw InputError(path, kExpected);
  if (header->width < 1 || header->height < 1 ||
      std::int64_t{header->width} * header->height > kMostPixels) {
    throw InputError(path, fmt::format("expected an image of 1 to {} pixels, found {}x{}",
                                       kMostPixels, header->width, header->height));
  }
  if (header->bits < 16 && header->brightest < 255) {
    throw InputError(
        path, fmt::format("expected grey levels up to 255, found up to {}", header->brightest));
  }
  return *header;
}

[[noreturn]] void refuse_size(const fs::path& path, const cv::Size& size, int width, int height) {
  throw InputError(path, fmt::format("expected {}x{} pixels as the camera has, found {}x{}",
                                     size.width, size.height, width, height));
}

enum class Decoded { kGrey, kGreyOfAnyDepth, kColour };

int imread_mode(Decoded as) {
  if (as == Decoded::kColour) return cv::IMREAD_COLOR;
  return as == Decoded::kGrey ? cv::IMREAD_GRAYSCALE : cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH;
}

cv::Mat decode(const fs::path& path, const cv::Size& size, Decoded as) {
  std::string bytes = read_bytes(path, kLargestPictureFile);
  const PictureHeader header = checked_header(path, bytes);
  if (!header.whole) throw InputError(path, "expected a whole image; the file is cut short");
  // A JPEG may be turned by a quarter when it is decoded.
  if (!size.empty() && size != cv::Size(header.width, header.height) &&
      size != cv::Size(header.height, header.width)) {
    refuse_size(path, size, header.width, header.height);
  }
  if (header.bits == 16 && as != Decoded::kGreyOfAnyDepth) {
    throw InputError(path, "expected 8 bits a pixel, found 16: convert the pictures");
  }
  if (jpeg_check != nullptr && bytes.rfind("\xFF\xD8", 0) == 0) {
    const std::string damage = jpeg_check(bytes);
    if (!damage.empty()) {
      throw InputError(path,
                       fmt::format("expected a whole image; its data is damaged ({})", damage));
    }
  }
  // OpenCV wants a blank behind the last number of a text file.
  if (bytes.rfind("P2", 0) == 0 || bytes.rfind("P3", 0) == 0) bytes += '\n';
  cv::Mat picture;
  try {
    const cv::Mat encoded(1, static_cast<int>(bytes.size()), CV_8UC1, bytes.data());
    picture = cv::imdecode(encoded, imread_mode(as));
  } catch (const cv::Exception&) {
    picture.release();
  }
  if (picture.empty()) throw InputError(path, kExpected);
  if (!size.empty() && picture.size() != size) refuse_size(path, size, picture.cols, picture.rows);
  return picture;
}

}  // namespace

void set_jpeg_check(JpegCheck check) {
  jpeg_check = check;
}

void read_grey_image(const fs::path& path, const cv::Size& size, cv::Mat& grey,
                     const std::optional<GreyLevels>& levels) {
  const cv::Mat picture =
      decode(path, size, levels.has_value() ? Decoded::kGreyOfAnyDepth : Decoded::kGrey);
  if (picture.depth() == CV_8U) {
    grey = picture;
    return;
  }
  const double scale = 255.0 / std::max(1, levels->white - levels->black);
  picture.convertTo(grey, CV_8U, scale, -scale * levels->black);
}

cv::Mat read_colour_image(const fs::path& path, const cv::Size& size) {
  return decode(path, size, Decoded::kColour);
}

PictureHeader read_picture_header_of(const fs::path& path) {
  const std::string beginning = read_bytes(path, kHeaderBytes);
  if (read_picture_header(beginning).has_value()) return checked_header(path, beginning);
  return checked_header(path, read_bytes(path, kLargestPictureFile));
}

GreyLevels find_grey_levels(const std::vector<fs::path>& pictures) {
  std::vector<std::uint64_t> histogram(65536, 0);
  std::uint64_t pixels = 0;
  for (const fs::path& path : pictures) {
    const cv::Mat picture = decode(path, {}, Decoded::kGreyOfAnyDepth);
    if (picture.depth() != CV_16U) throw InputError(path, "expected 16 bits a pixel as before it");
    for (int y = 0; y < picture.rows; ++y) {
      const auto* row = picture.ptr<std::uint16_t>(y);
      for (int x = 0; x < picture.cols; ++x) ++histogram[row[x]];
    }
    pixels += picture.total();
  }
  const auto beyond = static_cast<std::uint64_t>(kShareBeyondLevels * static_cast<double>(pixels));
  GreyLevels levels;
  std::uint64_t below = 0;
  while (levels.black < 65535 &&
         (below += histogram[static_cast<std::size_t>(levels.black)]) <= beyond) {
    ++levels.black;
  }
  std::uint64_t above = 0;
  while (levels.white > levels.black &&
         (above += histogram[static_cast<std::size_t>(levels.white)]) <= beyond) {
    --levels.white;
  }
  return levels;
}

}  // namespace cairn::host

#include "host_sim/calibration/calibration_pictures.hpp"

#include <algorithm>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "host_sim/io/image_file.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/io/picture_folder.hpp"
#include "host_sim/sources/media.hpp"

namespace cairn::host {
namespace {

namespace fs = std::filesystem;

constexpr double kSlot_s = 0.25;
constexpr int kSharpnessSide_px = 640;

/// Variance of the Laplacian (Pech-Pacheco et al. 2000): falls with motion blur.
double sharpness(const cv::Mat& grey) {
  cv::Mat small = grey, laplacian;
  const int side = std::max(grey.cols, grey.rows);
  if (side > kSharpnessSide_px) {
    const double factor = static_cast<double>(kSharpnessSide_px) / side;
    cv::resize(grey, small, {}, factor, factor, cv::INTER_AREA);
  }
  cv::Laplacian(small, laplacian, CV_16S);
  cv::Scalar mean, deviation;
  cv::meanStdDev(laplacian, mean, deviation);
  return deviation[0];
}

using Take = std::function<void(const std::string& name, const cv::Mat& grey, int expected)>;

void take_folder(const fs::path& folder, const Take& take) {
  const std::vector<fs::path> files = list_picture_files(folder);
  const int bits = read_picture_header_of(files.front()).bits;
  std::optional<GreyLevels> levels;
  if (bits == 16) levels = find_grey_levels(files);
  cv::Size size;
  for (const fs::path& file : files) {
    cv::Mat grey;
    read_grey_image(file, {}, grey, levels);
    if (!size.empty() && grey.size() != size) {
      throw InputError(file, fmt::format("expected {}x{} pixels as the pictures before it have, "
                                         "found {}x{}: a calibration is of one size, and of a "
                                         "camera that is not turned",
                                         size.width, size.height, grey.cols, grey.rows));
    }
    size = grey.size();
    take(file.filename().string(), grey, static_cast<int>(files.size()));
  }
}

void take_video(const fs::path& file, int most, const Take& take) {
  const std::unique_ptr<Media> video = open_video(file, {}, {});
  const MediaInfo& info = video->info();
  double slot_s = kSlot_s;
  int expected = most;
  if (info.span.has_value()) {
    const double length_s = 1e-6 * static_cast<double>(info.span->length_us());
    slot_s = std::max(slot_s, length_s / most);
    expected = std::min(most, static_cast<int>(length_s / slot_s) + 1);
  }
  const auto slot_us = static_cast<std::int64_t>(1e6 * slot_s);
  cv::Mat grey, best;
  MediaFrame frame;
  int best_number = 0;
  double best_sharpness = -1.0;
  std::int64_t slot = 0;
  const auto close_slot = [&] {
    if (best_sharpness >= 0.0) take(fmt::format("frame {}", best_number), best, expected);
    best_sharpness = -1.0;
  };
  while (video->next(frame, grey)) {
    if (frame.t_us / slot_us != slot) close_slot();
    slot = frame.t_us / slot_us;
    const double s = sharpness(grey);
    if (s <= best_sharpness) continue;
    best_sharpness = s;
    best_number = frame.number;
    grey.copyTo(best);
  }
  close_slot();
}

}  // namespace

void take_calibration_pictures(const fs::path& media, int most, const Take& take) {
  if (fs::is_directory(media)) {
    take_folder(media, take);
  } else {
    take_video(media, most, take);
  }
}

}  // namespace cairn::host

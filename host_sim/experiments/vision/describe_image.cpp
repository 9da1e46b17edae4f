#include "host_sim/experiments/vision/describe_image.hpp"

#include <algorithm>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <opencv2/imgcodecs.hpp>

#include "host_sim/io/input_error.hpp"
#include "host_sim/io/output_file.hpp"

namespace cairn::host {
namespace {

void require(Status status, const char* what) {
  if (!ok(status)) throw std::runtime_error(fmt::format("{}: {}", what, to_string(status)));
}

}  // namespace

ImageView view_of(const cv::Mat& grey) {
  return {grey.data, grey.cols, grey.rows, static_cast<int>(grey.step)};
}

cv::Mat read_grey(const std::filesystem::path& file) {
  cv::Mat grey;
  try {
    grey = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  } catch (const cv::Exception& error) {
    throw InputError(file, error.what());
  }
  if (grey.empty()) throw InputError(file, "not an image that OpenCV can read");
  constexpr int kMax = ImageView::kMaxExtent;
  if (grey.cols > kMax || grey.rows > kMax) {
    throw InputError(file, fmt::format("{}x{} pixels, at most {}x{} can be processed", grey.cols,
                                       grey.rows, kMax, kMax));
  }
  return grey;
}

std::vector<Corner> detect_corners(const cv::Mat& grey, int threshold) {
  const auto scratch = std::make_unique<FastScratch<ImageView::kMaxExtent>>();
  // Suppression leaves at most one corner in each 2x2 pixels.
  const int capacity = (grey.cols + 1) / 2 * ((grey.rows + 1) / 2);
  std::vector<Corner> corners(static_cast<std::size_t>(capacity));
  FastReport report;
  require(detect_fast(view_of(grey), {0, 0, grey.cols, grey.rows}, threshold, *scratch,
                      corners.data(), capacity, report),
          "FAST");
  corners.resize(static_cast<std::size_t>(report.found - report.dropped));
  return corners;
}

std::vector<Corner> strongest(std::vector<Corner> corners, int count) {
  std::stable_sort(corners.begin(), corners.end(),
                   [](const Corner& a, const Corner& b) { return a.score > b.score; });
  auto end = static_cast<std::size_t>(count);
  if (count == 0 || end >= corners.size()) return corners;
  while (end < corners.size() && corners[end].score == corners[end - 1].score) ++end;
  corners.resize(end);
  return corners;
}

std::vector<Feature> describe_corners(const cv::Mat& grey, const std::vector<Corner>& corners) {
  std::vector<Feature> features;
  for (const Corner& corner : corners) {
    Feature feature;
    feature.corner = corner;
    const Status status = describe_freak(view_of(grey), corner.x, corner.y, feature.descriptor,
                                         feature.orientation_bin);
    if (status == Status::kOutOfView) continue;
    require(status, "FREAK");
    features.push_back(feature);
  }
  return features;
}

std::string to_hex(const Descriptor& descriptor) {
  return fmt::format("{:02x}", fmt::join(descriptor.bytes, ""));
}

void write_corners(const std::vector<Corner>& corners, const std::filesystem::path& file) {
  OutputFile out(file);
  out.print("x,y,score\n");
  for (const Corner& c : corners) out.print("{},{},{}\n", c.x, c.y, c.score);
  out.finish();
}

void write_features(const std::vector<Feature>& features, const std::filesystem::path& file) {
  OutputFile out(file);
  out.print("x,y,orientation_bin_of_256,descriptor_hex\n");
  for (const Feature& f : features) {
    out.print("{},{},{},{}\n", f.corner.x, f.corner.y, f.orientation_bin, to_hex(f.descriptor));
  }
  out.finish();
}

}  // namespace cairn::host

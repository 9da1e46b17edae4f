#pragma once

#include <filesystem>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "host_sim/sources/frame_source.hpp"

namespace cairn::host {

/// Writes a picture, dark on its left half.
inline void picture(const std::filesystem::path& path, int width, int height, int type = CV_8UC1) {
  std::filesystem::create_directories(path.parent_path());
  cv::Mat image(height, width, type, cv::Scalar(type == CV_16UC1 ? 3000 : 90));
  image(cv::Rect(0, 0, width / 2, height)).setTo(type == CV_16UC1 ? 1000 : 30);
  cv::imwrite(path.string(), image);
}

inline std::vector<Frame> all_frames(FrameSource& source) {
  std::vector<Frame> frames;
  Frame frame;
  while (source.next(frame)) {
    frames.push_back(frame);
    frames.back().grey = frame.grey.clone();
  }
  return frames;
}

}  // namespace cairn::host

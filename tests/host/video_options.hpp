#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "host_sim/sources/video_source.hpp"
#include "temporary_folder.hpp"

namespace cairn::host {

inline constexpr const char* kVideoCamera =
    "fx: 250\nfy: 250\ncx: 160\ncy: 120\nwidth: 320\nheight: 240\n";

/// Options for a folder of grey pictures 0.png ... with the camera file.
inline VideoOptions pictures(const TemporaryFolder& folder, int count) {
  const cv::Mat image(240, 320, CV_8UC1, cv::Scalar(50));
  std::filesystem::create_directories(folder.path() / "pictures");
  for (int i = 0; i < count; ++i) {
    cv::imwrite((folder.path() / "pictures" / (std::to_string(i) + ".png")).string(), image);
  }
  VideoOptions options;
  options.media = folder.path() / "pictures";
  options.camera = folder.write("camera.yaml", kVideoCamera);
  return options;
}

/// What a source gave, to its end.
struct Ran {
  std::vector<int> numbers;
  std::vector<std::int64_t> t_us;
  SourceInfo info;
};

inline Ran run(FrameSource& source) {
  Ran ran;
  Frame frame;
  while (source.next(frame)) {
    ran.numbers.push_back(frame.number);
    ran.t_us.push_back(frame.t_us);
  }
  ran.info = source.info();
  return ran;
}

inline Ran run(const VideoOptions& options) {
  return run(*make_video_source(options));
}

/// Options for a video with the same camera file.
inline VideoOptions video(const TemporaryFolder& folder, const std::filesystem::path& media) {
  VideoOptions options;
  options.media = media;
  options.camera = folder.write("camera.yaml", kVideoCamera);
  return options;
}

/// Three pictures with something to encode.
inline std::vector<cv::Mat> noise_frames() {
  std::vector<cv::Mat> frames(3);
  for (cv::Mat& frame : frames) {
    frame.create(240, 320, CV_8UC1);
    cv::randu(frame, 0, 255);
    cv::GaussianBlur(frame, frame, {5, 5}, 2);
  }
  return frames;
}

}  // namespace cairn::host

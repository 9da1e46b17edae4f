#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <sys/types.h>

#include <opencv2/core.hpp>

namespace cairn::host {

/// Throws UsageError, saying why, where no window can be opened: there is no display, or this build
/// has no viewer (the program cairn_view beside this one).
void require_viewer();

/// A window that shows a run while it runs. Keys: space pauses and goes on, `.` or `s` shows the
/// next frame and pauses, `q` or Escape ends the run, as closing the window does.
class LiveView {
 public:
  /// Starts the viewer. Throws as require_viewer().
  explicit LiveView(const std::string& title);
  ~LiveView();
  LiveView(const LiveView&) = delete;
  LiveView& operator=(const LiveView&) = delete;

  /// Shows a picture (8-bit BGR) until the frame's time has come, and while the run is paused.
  /// False when the run is to end. Throws UsageError where the first picture cannot be shown; a
  /// viewer that ends later ends the view alone.
  bool show(const cv::Mat& picture, std::int64_t t_us);

 private:
  /// A key, or what ViewAnswer has in place of one.
  std::int32_t exchange(const cv::Mat& picture, int wait_ms);
  int wait_ms(std::int64_t t_us);
  [[noreturn]] void refuse();

  int socket_ = -1;
  int errors_ = -1;  ///< what the viewer says
  pid_t viewer_ = -1;
  bool paused_ = false;
  bool shown_ = false;
  std::int64_t first_t_us_ = 0;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace cairn::host

#include "host_sim/running/live_view.hpp"

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include "host_sim/io/input_error.hpp"
#include "host_sim/io/interruption.hpp"
#include "host_sim/view/view_protocol.hpp"

namespace cairn::host {
namespace {

constexpr int kLongestWait_ms = 1000;
constexpr int kPausedWait_ms = 100;  // how soon Ctrl-C is noticed
constexpr std::int32_t kEscape = 27;

std::filesystem::path viewer_program() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path() / "cairn_view";
}

bool has_display() {
  const auto given = [](const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr && *value != '\0';
  };
  return given("DISPLAY") || given("WAYLAND_DISPLAY");
}

bool send_all(int socket, const void* bytes, std::size_t count) {
  const auto* from = static_cast<const char*>(bytes);
  while (count > 0) {
    const ssize_t sent = send(socket, from, count, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    from += sent;
    count -= static_cast<std::size_t>(sent);
  }
  return true;
}

bool receive(int socket, ViewAnswer& answer) {
  for (;;) {
    const ssize_t got = recv(socket, &answer, sizeof answer, MSG_WAITALL);
    if (got < 0 && errno == EINTR) continue;
    return got == static_cast<ssize_t>(sizeof answer);
  }
}

/// The last line that the viewer wrote to standard error.
std::string last_words(int file) {
  std::array<char, 4096> text{};
  const off_t length = lseek(file, 0, SEEK_END);
  const off_t from = std::max<off_t>(0, length - static_cast<off_t>(text.size()));
  const ssize_t got = pread(file, text.data(), text.size(), from);
  std::string words(text.data(), got > 0 ? static_cast<std::size_t>(got) : 0);
  while (!words.empty() && (words.back() == '\n' || words.back() == ' ')) words.pop_back();
  return words.substr(words.rfind('\n') + 1);
}

}  // namespace

void require_viewer() {
  if (!has_display()) {
    throw UsageError("--view: no display: neither DISPLAY nor WAYLAND_DISPLAY is set");
  }
  if (!std::filesystem::exists(viewer_program())) {
    throw UsageError(
        fmt::format("--view: {} is missing: this build has no window, because OpenCV's "
                    "highgui was not there",
                    viewer_program().string()));
  }
}

LiveView::LiveView(const std::string& title) {
  require_viewer();
  std::array<int, 2> ends{};
  errors_ = memfd_create("cairn_view", MFD_CLOEXEC);
  if (errors_ < 0 || socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    throw UsageError("--view: the system has no room for a viewer");
  }
  socket_ = ends[0];
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, ends[1], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&files, errors_, STDERR_FILENO);
  // Ctrl-C is the run's: the viewer ends when its socket closes.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  std::string path = viewer_program().string();
  std::string name = title;
  std::array<char*, 3> words = {path.data(), name.data(), nullptr};
  const int error = posix_spawn(&viewer_, path.c_str(), &files, &attributes, words.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  close(ends[1]);
  if (error != 0) {
    viewer_ = -1;
    throw UsageError(fmt::format("--view: {} cannot be started", path));
  }
}

LiveView::~LiveView() {
  if (socket_ >= 0) close(socket_);
  if (errors_ >= 0) close(errors_);
  if (viewer_ > 0) waitpid(viewer_, nullptr, 0);
}

bool LiveView::show(const cv::Mat& picture, std::int64_t t_us) {
  if (socket_ < 0) return true;
  if (!shown_) {
    first_t_us_ = t_us;
    start_ = std::chrono::steady_clock::now();
  }
  while (interrupted() == 0) {
    const std::int32_t key = exchange(picture, paused_ ? kPausedWait_ms : wait_ms(t_us));
    if (key == ViewAnswer::kClosed) return false;
    if (socket_ < 0) return true;
    if (key == ViewAnswer::kNoKey) {
      if (paused_) continue;
      return true;
    }
    const std::int32_t letter = key & 0xff;
    if (letter == 'q' || letter == kEscape) return false;
    if (letter == '.' || letter == 's') {
      paused_ = true;
      return true;
    }
    if (letter != ' ') continue;
    paused_ = !paused_;
    if (paused_) continue;
    // The time of the pause does not count.
    first_t_us_ = t_us;
    start_ = std::chrono::steady_clock::now();
  }
  return false;
}

int LiveView::wait_ms(std::int64_t t_us) {
  const std::int64_t due_us = t_us - first_t_us_;
  const std::int64_t now_us = std::chrono::duration_cast<std::chrono::microseconds>(
                                  std::chrono::steady_clock::now() - start_)
                                  .count();
  // A run that cannot keep up, or a gap in the times, starts a new count.
  if (now_us - due_us > 1000 * kLongestWait_ms || due_us - now_us > 1000 * kLongestWait_ms) {
    first_t_us_ = t_us;
    start_ = std::chrono::steady_clock::now();
  }
  return static_cast<int>(std::clamp<std::int64_t>((due_us - now_us) / 1000, 1, kLongestWait_ms));
}

std::int32_t LiveView::exchange(const cv::Mat& picture, int wait_ms) {
  const cv::Mat whole = picture.isContinuous() ? picture : picture.clone();
  const ViewPicture head{whole.cols, whole.rows, wait_ms};
  ViewAnswer answer;
  if (send_all(socket_, &head, sizeof head) &&
      send_all(socket_, whole.data, whole.total() * whole.elemSize()) && receive(socket_, answer)) {
    shown_ = true;
    return answer.key;
  }
  if (!shown_) refuse();
  close(socket_);
  socket_ = -1;
  fmt::print(stderr, "cairn_sim: the viewer ended; the run goes on without it\n");
  return ViewAnswer::kNoKey;
}

void LiveView::refuse() {
  close(socket_);
  socket_ = -1;
  waitpid(viewer_, nullptr, 0);
  viewer_ = -1;
  throw UsageError(fmt::format("--view: no window could be opened: {}", last_words(errors_)));
}

}  // namespace cairn::host

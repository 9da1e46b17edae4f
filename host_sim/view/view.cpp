// The window of `cairn_sim run --view`, which starts this program and sends it pictures.
//
// usage: cairn_view TITLE   with a socket as standard input (view_protocol.hpp)

#include <cstdio>
#include <sys/socket.h>
#include <unistd.h>

#include <opencv2/highgui.hpp>

#include "host_sim/view/view_protocol.hpp"

namespace {

using cairn::host::ViewAnswer;
using cairn::host::ViewPicture;

constexpr int kMostPixels = 1 << 26;

bool read_all(void* bytes, std::size_t count) {
  auto* to = static_cast<char*>(bytes);
  while (count > 0) {
    const ssize_t got = read(STDIN_FILENO, to, count);
    if (got <= 0) return false;
    to += got;
    count -= static_cast<std::size_t>(got);
  }
  return true;
}

std::int32_t key_within(const char* title, int wait_ms) {
  const int key = cv::waitKeyEx(wait_ms < 1 ? 1 : wait_ms);
  if (key >= 0) return key;
  const bool open = cv::getWindowProperty(title, cv::WND_PROP_VISIBLE) >= 1.0;
  return open ? ViewAnswer::kNoKey : ViewAnswer::kClosed;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: cairn_view TITLE, with a socket as standard input\n", stderr);
    return 2;
  }
  cv::namedWindow(argv[1], cv::WINDOW_AUTOSIZE | cv::WINDOW_GUI_NORMAL);
  ViewPicture head;
  cv::Mat picture;
  while (read_all(&head, sizeof head)) {
    if (head.width <= 0 || head.height <= 0 || head.width > kMostPixels / head.height) return 2;
    picture.create(head.height, head.width, CV_8UC3);
    if (!read_all(picture.data, picture.total() * picture.elemSize())) return 2;
    cv::imshow(argv[1], picture);
    const ViewAnswer answer{key_within(argv[1], head.wait_ms)};
    if (send(STDIN_FILENO, &answer, sizeof answer, MSG_NOSIGNAL) != sizeof answer) return 0;
  }
  return 0;
}

#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>

namespace cairn::host {

/// Writes Motion JPEG into a QuickTime file with a duration of every frame in ms: a video of
/// variable rate, as phones make them. `frames` are taken in turn.
class QuickTimeFile {
 public:
  /// `turned`: the file says that its pictures are to be shown turned by a quarter, as upright
  /// phones do.
  QuickTimeFile(const std::vector<cv::Mat>& frames, const std::vector<int>& durations_ms,
                bool turned = false)
      : size_(frames.front().size()), turned_(turned) {
    for (std::size_t i = 0; i < durations_ms.size(); ++i) {
      std::vector<unsigned char> jpeg;
      cv::imencode(".jpg", frames[i % frames.size()], jpeg);
      jpegs_.emplace_back(jpeg.begin(), jpeg.end());
      total_ += static_cast<std::uint32_t>(durations_ms[i]);
      steps_ += number(1, 4) + number(static_cast<std::uint32_t>(durations_ms[i]), 4);
    }
  }

  void write(const std::filesystem::path& path) const {
    std::ofstream(path, std::ios::binary) << bytes();
  }

  std::string bytes() const {
    const std::string type = box("ftyp", "qt  " + number(0x200, 4) + "qt  ");
    std::string data, sizes, places;
    for (const std::string& jpeg : jpegs_) {
      places += number(static_cast<std::uint32_t>(type.size() + 8 + data.size()), 4);
      sizes += number(static_cast<std::uint32_t>(jpeg.size()), 4);
      data += jpeg;
    }
    const auto count = static_cast<std::uint32_t>(jpegs_.size());
    const std::string table =
        box("stbl", full("stsd", number(1, 4) + entry()) + full("stts", number(count, 4) + steps_) +
                        full("stsc", number(1, 4) + number(1, 4) + number(1, 4) + number(1, 4)) +
                        full("stsz", number(0, 4) + number(count, 4) + sizes) +
                        full("stco", number(count, 4) + places));
    const std::string reference =
        box("dinf", full("dref", number(1, 4) + box("alis", number(1, 4))));
    const std::string media = box(
        "mdia", full("mdhd", number(0, 8) + number(1000, 4) + number(total_, 4) + number(0, 4)) +
                    full("hdlr", "mhlrvide" + number(0, 12) + std::string(1, '\0')) +
                    box("minf", full("vmhd", number(0, 8)) + reference + table));
    const std::string track_header =
        box("tkhd", number(7, 4) + number(0, 8) + number(1, 4) + number(0, 4) + number(total_, 4) +
                        number(0, 16) + (turned_ ? quarter_turn() : identity()) +
                        number(width() << 16U, 4) + number(height() << 16U, 4));
    const std::string header = full("mvhd", number(0, 8) + number(1000, 4) + number(total_, 4) +
                                                number(65536, 4) + number(256, 2) + number(0, 10) +
                                                identity() + number(0, 24) + number(2, 4));
    return type + box("mdat", data) + box("moov", header + box("trak", track_header + media));
  }

 private:
  static std::string number(std::uint32_t value, int bytes) {
    std::string text;
    for (int i = bytes; i-- > 0;) {
      text += i < 4 ? static_cast<char>(static_cast<unsigned char>(value >> (8U * i))) : '\0';
    }
    return text;
  }
  static std::string box(const std::string& kind, const std::string& body) {
    return number(static_cast<std::uint32_t>(8 + body.size()), 4) + kind + body;
  }
  static std::string full(const std::string& kind, const std::string& body) {
    return box(kind, number(0, 4) + body);
  }
  static std::string identity() {
    return number(65536, 4) + number(0, 12) + number(65536, 4) + number(0, 12) +
           number(0x40000000, 4);
  }
  static std::string quarter_turn() {
    return number(0, 4) + number(65536, 4) + number(0, 4) + number(0xFFFF0000U, 4) + number(0, 16) +
           number(0x40000000, 4);
  }
  std::uint32_t width() const { return static_cast<std::uint32_t>(size_.width); }
  std::uint32_t height() const { return static_cast<std::uint32_t>(size_.height); }
  std::string entry() const {
    return box("jpeg", number(0, 6) + number(1, 2) + number(0, 16) + number(width(), 2) +
                           number(height(), 2) + number(72 << 16, 4) + number(72 << 16, 4) +
                           number(0, 4) + number(1, 2) + "\x05MJPEG" + number(0, 26) +
                           number(24, 2) + number(0xFFFF, 2));
  }

  cv::Size size_;
  bool turned_;
  std::vector<std::string> jpegs_;
  std::string steps_;
  std::uint32_t total_ = 0;
};

}  // namespace cairn::host

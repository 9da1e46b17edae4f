#include "host_sim/io/picture_header.hpp"

#include <cctype>
#include <cstdint>
#include <cstdlib>

namespace cairn::host {
namespace {

/// Bytes by position; what lies behind the end reads as 0 and is noticed by has().
class Bytes {
 public:
  explicit Bytes(std::string_view bytes) : bytes_(bytes) {}

  std::size_t size() const { return bytes_.size(); }
  bool has(std::size_t at, std::size_t count) const {
    return at <= bytes_.size() && count <= bytes_.size() - at;
  }
  std::uint32_t byte(std::size_t at) const {
    return at < bytes_.size() ? static_cast<unsigned char>(bytes_[at]) : 0U;
  }
  std::uint32_t big(std::size_t at, int count) const {
    std::uint32_t value = 0;
    for (int i = 0; i < count; ++i) value = value << 8U | byte(at + static_cast<std::size_t>(i));
    return value;
  }
  std::uint32_t little(std::size_t at, int count) const {
    std::uint32_t value = 0;
    for (int i = count; i-- > 0;) value = value << 8U | byte(at + static_cast<std::size_t>(i));
    return value;
  }
  std::string_view text(std::size_t at, std::size_t count) const {
    return has(at, count) ? bytes_.substr(at, count) : std::string_view();
  }

 private:
  std::string_view bytes_;
};

/// Sides above 2^30 are none: the caller's limits refuse them, sums of theirs do not overflow.
int side(std::uint32_t value) {
  return static_cast<int>(value < (1U << 30U) ? value : (1U << 30U));
}

std::optional<PictureHeader> read_png(const Bytes& bytes) {
  if (bytes.text(12, 4) != "IHDR" || !bytes.has(16, 13)) return std::nullopt;
  PictureHeader header;
  header.width = side(bytes.big(16, 4));
  header.height = side(bytes.big(20, 4));
  header.bits = static_cast<int>(bytes.byte(24));
  header.brightest = header.bits == 16 ? 65535 : 255;
  for (std::size_t at = 8; bytes.has(at, 12);) {  // length, kind, data, checksum
    const std::size_t length = bytes.big(at, 4);
    if (!bytes.has(at, length + 12)) break;
    if (bytes.text(at + 4, 4) == "IEND") header.whole = true;
    if (header.whole) break;
    at += length + 12;
  }
  return header;
}

bool is_frame_header(std::uint32_t marker) {
  return marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
}

/// Position of the next marker at or behind `at` that is not part of a scan's data.
std::size_t next_marker(const Bytes& bytes, std::size_t at) {
  for (; bytes.has(at, 2); ++at) {
    const std::uint32_t code = bytes.byte(at + 1);
    const bool restart = code >= 0xD0 && code <= 0xD7;
    if (bytes.byte(at) == 0xFF && code != 0x00 && code != 0xFF && !restart) return at;
  }
  return bytes.size();
}

std::optional<PictureHeader> read_jpeg(const Bytes& bytes) {
  std::optional<PictureHeader> header;
  for (std::size_t at = next_marker(bytes, 2); bytes.has(at, 2); at = next_marker(bytes, at)) {
    const std::uint32_t marker = bytes.byte(at + 1);
    if (marker == 0xD9) {
      if (header.has_value()) header->whole = true;
      return header;
    }
    if (is_frame_header(marker) && bytes.has(at, 9) && !header.has_value()) {
      header.emplace();
      header->bits = static_cast<int>(bytes.byte(at + 4));
      header->height = side(bytes.big(at + 5, 2));
      header->width = side(bytes.big(at + 7, 2));
    }
    at += 2 + bytes.big(at + 2, 2);  // the marker and its segment
  }
  return header;
}

/// Numbers of a PNM header, separated by white space and comments.
class PnmNumbers {
 public:
  explicit PnmNumbers(const Bytes& bytes) : bytes_(bytes) {}

  /// Empty where there is none; a number at the end of the bytes may be cut.
  std::optional<std::uint32_t> next(bool may_end = false) {
    while (bytes_.has(at_, 1) && (std::isspace(byte()) != 0 || byte() == '#')) {
      if (byte() == '#') {
        while (bytes_.has(at_, 1) && byte() != '\n') ++at_;
      } else {
        ++at_;
      }
    }
    std::uint32_t value = 0;
    const std::size_t start = at_;
    while (bytes_.has(at_, 1) && std::isdigit(byte()) != 0 && value < 100000000U) {
      value = 10 * value + static_cast<std::uint32_t>(byte() - '0');
      ++at_;
    }
    const bool complete = may_end || bytes_.has(at_, 1);
    return at_ > start && complete ? std::optional(value) : std::nullopt;
  }
  bool has_more(std::uint64_t count) {
    while (count > 0 && next(true).has_value()) --count;
    return count == 0;
  }
  std::size_t data() const { return at_ + 1; }

 private:
  int byte() const { return static_cast<int>(bytes_.byte(at_)); }

  const Bytes& bytes_;
  std::size_t at_ = 2;
};

std::optional<PictureHeader> read_pnm(const Bytes& bytes) {
  const char kind = static_cast<char>(bytes.byte(1));
  PnmNumbers numbers(bytes);
  const auto width = numbers.next();
  const auto height = numbers.next();
  const auto brightest = numbers.next();
  if (!width || !height || !brightest || *brightest == 0 || *brightest > 65535) return std::nullopt;
  PictureHeader header;
  header.width = side(*width);
  header.height = side(*height);
  header.brightest = static_cast<int>(*brightest);
  header.bits = *brightest > 255 ? 16 : 8;
  const bool text = kind == '2' || kind == '3';
  const std::uint64_t channels = kind == '6' || kind == '3' ? 3 : 1;
  const std::uint64_t samples = std::uint64_t{*width} * *height * channels;
  header.whole = text ? numbers.has_more(samples)
                      : bytes.size() >= numbers.data() + samples * (header.bits == 16 ? 2 : 1);
  return header;
}

std::optional<PictureHeader> read_bmp(const Bytes& bytes) {
  if (!bytes.has(0, 34)) return std::nullopt;
  PictureHeader header;
  const auto height = static_cast<std::int32_t>(bytes.little(22, 4));
  header.width = side(bytes.little(18, 4));
  header.height = side(static_cast<std::uint32_t>(std::abs(static_cast<std::int64_t>(height))));
  const std::uint64_t row =
      (std::uint64_t{bytes.little(28, 2)} * bytes.little(18, 4) + 31) / 32 * 4;
  const bool compressed = bytes.little(30, 4) == 1 || bytes.little(30, 4) == 2;
  const std::uint64_t end =
      bytes.little(10, 4) +
      (compressed ? bytes.little(34, 4) : row * static_cast<std::uint64_t>(header.height));
  header.whole = bytes.size() >= end;
  return header;
}

}  // namespace

std::optional<PictureHeader> read_picture_header(std::string_view text) {
  const Bytes bytes(text);
  if (text.rfind("\x89PNG\r\n\x1a\n", 0) == 0) return read_png(bytes);
  if (text.rfind("\xFF\xD8", 0) == 0) return read_jpeg(bytes);
  if (text.rfind("BM", 0) == 0) return read_bmp(bytes);
  const bool pnm =
      bytes.byte(0) == 'P' && bytes.byte(1) >= '2' && bytes.byte(1) <= '6' && bytes.byte(1) != '4';
  return pnm ? read_pnm(bytes) : std::nullopt;
}

}  // namespace cairn::host

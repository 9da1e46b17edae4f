// The vision front end on the target itself: compares it with the expected outputs and counts its
// instructions.
//
//   vision_target --golden FOLDER [--count 1]
//
// FOLDER holds NAME.pgm, NAME_fast.csv and NAME_freak.csv. Exit status 0: equal, 1: not, 77: no
// such folder. Counting needs an emulator whose clock advances 64 ns with every instruction.

#include <cstdint>
#include <initializer_list>

#include "cairn/numeric/random.hpp"
#include "cairn/port/files.h"
#include "cairn/port/port.h"
#include "cairn/vision/fast.hpp"
#include "cairn/vision/freak.hpp"
#include "cairn/vision/hamming.hpp"
#include "cairn/vision/patch.hpp"

#include "text.hpp"

namespace {

using cairn::Corner;
using cairn::Descriptor;
using cairn::ImageView;
using cairn::Status;
using cairn_test::write;
using cairn_test::write_decimal;

constexpr int kMaxPixels = 1024 * 800;
constexpr int kMaxText = 256 * 1024;
constexpr int kMaxCorners = 8000;

#ifdef CAIRN_PORT_FRAMES_SECTION  // where a board keeps its input frames
#define CAIRN_IN_FRAME_MEMORY __attribute__((section(".frames")))
#else
#define CAIRN_IN_FRAME_MEMORY
#endif
CAIRN_IN_FRAME_MEMORY std::uint8_t pixels[kMaxPixels];
CAIRN_IN_FRAME_MEMORY char text[kMaxText];
Corner corners[kMaxCorners];
Descriptor descriptors[256];
cairn::FastScratch<1024> scratch;

/// Whole file into `buffer`; its length, or -1.
int read_file(const char* folder, const char* name, const char* ending, void* buffer,
              int capacity) {
  char path[256];
  int n = 0;
  for (const char* part : {folder, "/", name, ending}) {
    for (; *part != '\0' && n < 255; ++part) path[n++] = *part;
  }
  path[n] = '\0';
  const std::int32_t file = cairn_file_open(path);
  if (file < 0) return -1;
  const std::int32_t size = cairn_file_size(file);
  std::int32_t got = -1;
  if (size >= 0 && size <= capacity) {
    got = cairn_file_read(file, buffer, static_cast<std::uint32_t>(size));
  }
  cairn_file_close(file);
  return got;
}

/// Reads numbers and fields out of `text`.
class Reader {
 public:
  explicit Reader(int size) : end_(text + size) {}
  bool more() const { return at_ < end_; }
  void skip_line() {
    while (more() && *at_++ != '\n') {
    }
  }
  int number() {
    int value = 0;
    for (; more() && *at_ >= '0' && *at_ <= '9'; ++at_) value = 10 * value + (*at_ - '0');
    if (more()) ++at_;
    return value;
  }
  int hex_byte() {
    const int high = digit();
    return 16 * high + digit();
  }
  const char* position() const { return at_; }

 private:
  int digit() {
    const char c = more() ? *at_++ : '0';
    return c <= '9' ? c - '0' : c - 'a' + 10;
  }
  const char* at_ = text;
  const char* end_;
};

/// Image `name` into `pixels`; an invalid view when there is none.
ImageView read_image(const char* folder, const char* name) {
  const int header = read_file(folder, name, ".pgm", pixels, kMaxPixels);
  if (header < 0) return {};
  // "P5\nW H\n255\n" then the pixels: small enough to be parsed where it is.
  const std::uint8_t* at = pixels + 3;
  int values[3] = {};
  for (int& value : values) {
    for (; *at >= '0' && *at <= '9'; ++at) value = 10 * value + (*at - '0');
    ++at;
  }
  return {at, values[0], values[1], values[0]};
}

bool check_fast(const char* folder, const char* name, const ImageView& image) {
  const int size = read_file(folder, name, "_fast.csv", text, kMaxText);
  cairn::FastReport report;
  const Status status = cairn::detect_fast(image, {0, 0, image.width, image.height}, 20, scratch,
                                           corners, kMaxCorners, report);
  Reader reader(size);
  reader.skip_line();
  int i = 0;
  bool equal = size > 0 && ok(status) && report.dropped == 0;
  for (; equal && reader.more(); ++i) {
    equal = i < report.found && corners[i].x == reader.number() &&
            corners[i].y == reader.number() && corners[i].score == reader.number();
  }
  write(name);
  write(": corners ");
  write_decimal(static_cast<std::uint64_t>(report.found));
  equal = equal && i == report.found;
  write(equal ? " equal\n" : " DIFFER\n");
  return equal;
}

bool check_freak(const char* folder, const char* name, const ImageView& image) {
  const int size = read_file(folder, name, "_freak.csv", text, kMaxText);
  Reader reader(size);
  reader.skip_line();
  int count = 0;
  bool equal = size > 0;
  for (; equal && reader.more(); ++count) {
    const int x = reader.number();
    const int y = reader.number();
    Descriptor descriptor;
    std::uint8_t bin = 0;
    equal = ok(describe_freak(image, x, y, descriptor, bin)) && bin == reader.number();
    for (const std::uint8_t byte : descriptor.bytes) equal = equal && byte == reader.hex_byte();
    reader.skip_line();
  }
  write(name);
  write(": descriptors ");
  write_decimal(static_cast<std::uint64_t>(count));
  write(equal ? " equal\n" : " DIFFER\n");
  return equal;
}

/// Instructions since `start`.
std::uint64_t instructions_since(std::uint32_t start) {
  const std::uint32_t ticks = cairn_port_ticks() - start;
  return static_cast<std::uint64_t>(ticks) * 15625000U / cairn_port_ticks_per_second();
}

void report_ratio(const char* name, const char* what, std::uint64_t instructions,
                  std::uint64_t per) {
  const std::uint64_t hundredths = instructions * 100 / per;
  write(name);
  write(what);
  write_decimal(hundredths / 100);
  write(hundredths % 100 < 10 ? ".0" : ".");
  write_decimal(hundredths % 100);
  write("\n");
}

void count_fast(const char* name, const ImageView& image) {
  const ImageView crop{image.data, image.width < 640 ? image.width : 640,
                       image.height < 480 ? image.height : 480, image.stride};
  const auto area = static_cast<std::uint64_t>(crop.width * crop.height);
  for (const int threshold : {20, 40, 10}) {
    cairn::FastReport report;
    const std::uint32_t start = cairn_port_ticks();
    (void)cairn::detect_fast(crop, {0, 0, crop.width, crop.height}, threshold, scratch, corners,
                             kMaxCorners, report);
    const std::uint64_t instructions = instructions_since(start);
    write(name);
    write(": FAST threshold ");
    write_decimal(static_cast<std::uint64_t>(threshold));
    write(", corners ");
    write_decimal(static_cast<std::uint64_t>(report.candidates));
    write("/");
    write_decimal(static_cast<std::uint64_t>(report.found));
    report_ratio("", ", instructions per pixel ", instructions, area);
  }
}

void count_freak(const char* name, const ImageView& image) {
  cairn::FastReport report;
  (void)cairn::detect_fast(image, {24, 24, image.width - 23, image.height - 23}, 20, scratch,
                           corners, 200, report);
  const int n = report.found - report.dropped;
  if (n == 0) return;
  std::uint8_t bin = 0;
  std::uint32_t start = cairn_port_ticks();
  for (int i = 0; i < n; ++i) {
    (void)describe_freak(image, corners[i].x, corners[i].y, descriptors[i], bin);
  }
  report_ratio(name, ": FREAK self-oriented ", instructions_since(start),
               static_cast<std::uint64_t>(n));
  for (const int scale : {0, 8, 16, 24}) {
    int described = 0;
    start = cairn_port_ticks();
    for (int i = 0; i < n; ++i) {
      const cairn::FreakPose pose{static_cast<std::uint8_t>(17 * i),
                                  static_cast<std::uint8_t>(scale)};
      if (ok(describe_freak(image, corners[i].x, corners[i].y, pose, descriptors[i]))) ++described;
    }
    const std::uint64_t instructions = instructions_since(start);
    write(name);
    write(": FREAK steered, scale index ");
    write_decimal(static_cast<std::uint64_t>(scale));
    report_ratio("", ", ", instructions, static_cast<std::uint64_t>(described));
  }
}

void count_patch(const char* name, const ImageView& image) {
  cairn::FastReport report;
  (void)cairn::detect_fast(image, {24, 24, image.width - 23, image.height - 23}, 20, scratch,
                           corners, 100, report);
  const int n = report.found - report.dropped;
  std::uint64_t steps = 0;
  std::uint64_t aligned = 0;
  std::uint64_t extraction = 0;
  std::uint64_t preparation = 0;
  std::uint64_t alignment = 0;
  for (int i = 0; i < n; ++i) {
    cairn::Patch patch;
    cairn::PatchAlignment report_of_one;
    int x = corners[i].x * 256;
    int y = corners[i].y * 256;
    std::uint32_t start = cairn_port_ticks();
    (void)extract_patch(image, x, y, patch);
    extraction += instructions_since(start);
    x += 150;
    y -= 100;
    cairn::PatchTemplate reference;
    start = cairn_port_ticks();
    Status status = reference.prepare(patch, cairn::PatchWarp{});
    if (!ok(status)) continue;
    const std::uint64_t prepared = instructions_since(start);
    start = cairn_port_ticks();
    status = align_patch(image, reference, x, y, report_of_one);
    if (!ok(status)) continue;
    alignment += instructions_since(start);
    preparation += prepared;
    ++aligned;
    steps += report_of_one.iterations;
  }
  if (aligned == 0) return;
  report_ratio(name, ": patch taken ", extraction, static_cast<std::uint64_t>(n));
  report_ratio(name, ": patch template prepared ", preparation, aligned);
  report_ratio(name, ": patch aligned with it ", alignment, aligned);
  report_ratio(name, ": steps per alignment ", steps, aligned);
}

/// The worst that a camera can deliver: every pixel is looked at and most of the corners found are
/// too many.
void count_noise() {
  constexpr int kWidth = 640;
  constexpr int kHeight = 480;
  cairn::Random random(3);
  for (int i = 0; i < kWidth * kHeight; ++i)
    pixels[i] = static_cast<std::uint8_t>(random.below(256));
  const ImageView image{pixels, kWidth, kHeight, kWidth};
  for (const int threshold : {20, 60, 120}) {
    cairn::FastReport report;
    const std::uint32_t start = cairn_port_ticks();
    (void)cairn::detect_fast(image, {0, 0, kWidth, kHeight}, threshold, scratch, corners, 500,
                             report);
    const std::uint64_t instructions = instructions_since(start);
    write("noise: FAST threshold ");
    write_decimal(static_cast<std::uint64_t>(threshold));
    write(", corners ");
    write_decimal(static_cast<std::uint64_t>(report.candidates));
    write("/");
    write_decimal(static_cast<std::uint64_t>(report.found));
    write(", dropped ");
    write_decimal(static_cast<std::uint64_t>(report.dropped));
    report_ratio("", ", instructions per pixel ", instructions, kWidth * kHeight);
  }
}

/// Differing bits of the first 16 bytes of two descriptors.
int prefix_distance(int i, int j) {
  Descriptor a;
  Descriptor b;
  for (int k = 0; k < 16; ++k) {
    a.bytes[k] = descriptors[i].bytes[k];
    b.bytes[k] = descriptors[j].bytes[k];
  }
  return cairn::hamming_distance(a, b);
}

void count_hamming() {
  cairn::Random random(1);
  for (Descriptor& d : descriptors) {
    for (std::uint8_t& byte : d.bytes) byte = static_cast<std::uint8_t>(random.below(256));
  }
  int sum = 0;
  for (const int limit : {cairn::kNoPrefixLimit, 57}) {
    const std::uint32_t start = cairn_port_ticks();
    for (int i = 0; i < 64; ++i) {
      sum += cairn::match_hamming(descriptors[i], {descriptors + 64, 128}, limit).distance;
    }
    const std::uint64_t instructions = instructions_since(start);
    int kept = 0;
    for (int i = 0; i < 64; ++i) {
      for (int j = 64; j < 192; ++j) kept += prefix_distance(i, j) <= limit ? 1 : 0;
    }
    write("Hamming, of 1000 pairs ");
    write_decimal(static_cast<std::uint64_t>(kept) * 1000 / (64 * 128));
    report_ratio("", " pass the prefix limit, instructions per pair ", instructions, 64 * 128);
  }
  if (sum == 0) write("impossible\n");
}

}  // namespace

int main(int argc, char** argv) {
  const char* const folder = cairn_test::argument(argc, argv, "--golden", ".");
  const bool count = *cairn_test::argument(argc, argv, "--count", "0") == '1';
  bool equal = true;
  int images = 0;
  for (const char* name : {"graf1", "graf3", "churchill1", "kitchen000", "desk00", "blocks"}) {
    const ImageView image = read_image(folder, name);
    if (!image.valid()) continue;
    ++images;
    equal = check_fast(folder, name, image) && equal;
    equal = check_freak(folder, name, image) && equal;
    if (!count) continue;
    count_fast(name, image);
    count_freak(name, image);
    count_patch(name, image);
  }
  if (images == 0) {
    write("skipped: no expected outputs in ");
    write(folder);
    write("\n");
    return 77;
  }
  if (count) {
    count_noise();
    count_hamming();
  }
  return equal ? 0 : 1;
}

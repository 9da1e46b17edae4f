// Writes the input log that a clip stands for: what programs replay that know no clips.
//
// usage: unpack_clip CLIP LOG

#include <cstdio>
#include <fstream>
#include <iterator>
#include <vector>

#include "clip_log.hpp"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: unpack_clip CLIP LOG\n", stderr);
    return 2;
  }
  std::ifstream in(argv[1], std::ios::binary);
  const std::vector<std::uint8_t> clip{std::istreambuf_iterator<char>(in), {}};
  static cairn_web::ClipLog log;
  log.open(clip.data(), clip.size());
  std::ofstream out(argv[2], std::ios::binary);
  std::vector<std::uint8_t> bytes(1U << 16U);
  for (int got = static_cast<int>(bytes.size()); got == static_cast<int>(bytes.size());) {
    got = log.read(bytes.data(), got);
    out.write(reinterpret_cast<const char*>(bytes.data()), got);
  }
  if (clip.empty() || log.used() != clip.size()) {
    std::fprintf(stderr, "unpack_clip: %s: no clip, or damaged at byte %zu\n", argv[1], log.used());
    return 3;
  }
  if (!out.flush()) {
    std::fprintf(stderr, "unpack_clip: %s: cannot be written\n", argv[2]);
    return 4;
  }
  return 0;
}

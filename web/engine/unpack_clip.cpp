// Writes the input log that a clip stands for: what programs replay that know no clips.
//
// usage: unpack_clip CLIP LOG
// Exit status 2 for a wrong call, 3 for what is no whole clip, 4 where LOG cannot be written.

#include <cstdio>
#include <fstream>
#include <iterator>
#include <vector>

#include "clip_reader.hpp"

namespace {

struct Sink {
  std::ofstream file;
  bool write(const std::uint8_t* bytes, int count) {
    return static_cast<bool>(file.write(reinterpret_cast<const char*>(bytes), count));
  }
};

/// kFull: the log cannot be written.
cairn::Status unpack(const std::vector<std::uint8_t>& clip, cairn_web::ClipReader& reader,
                     Sink& sink) {
  cairn::InputLogHeader header;
  cairn::Status status = reader.open(clip.data(), clip.size(), header);
  if (!ok(status)) return status;
  cairn::InputLogWriter<Sink> writer(sink);
  status = writer.begin(header);
  const auto count = static_cast<std::size_t>(header.camera.width * header.camera.height);
  std::vector<std::uint8_t> pixels(count);
  const cairn::ImageView image{pixels.data(), header.camera.width, header.camera.height,
                               header.camera.width};
  cairn::LogEvent event = cairn::LogEvent::kFrame;
  while (ok(status)) {
    cairn::OdometrySample sample;
    cairn::LogFrame frame;
    status = reader.next(event, sample, frame, pixels.data());
    if (!ok(status)) return status;
    if (event == cairn::LogEvent::kEnd) return writer.end();
    status =
        event == cairn::LogEvent::kFrame ? writer.frame(frame, image) : writer.odometry(sample);
  }
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: unpack_clip CLIP LOG\n", stderr);
    return 2;
  }
  std::ifstream in(argv[1], std::ios::binary);
  const std::vector<std::uint8_t> clip{std::istreambuf_iterator<char>(in), {}};
  cairn_web::ClipReader reader;
  Sink sink{std::ofstream(argv[2], std::ios::binary)};
  const cairn::Status status = unpack(clip, reader, sink);
  if (!sink.file.flush() || status == cairn::Status::kFull) {
    std::fprintf(stderr, "unpack_clip: %s: cannot be written\n", argv[2]);
    return 4;
  }
  if (!ok(status)) {
    std::fprintf(stderr, "unpack_clip: %s: no whole clip (%s at byte %zu)\n", argv[1],
                 to_string(status), reader.used());
    return 3;
  }
  return 0;
}

#include "host_sim/run/instruction_count.hpp"

#include <cstdlib>
#include <fstream>
#include <sys/wait.h>

#include <fmt/format.h>

// Different bodies, so that they stay three functions.
extern "C" {
__attribute__((noinline)) void cairn_mark_frame_begin() {
  __asm volatile("" ::: "memory");
}
__attribute__((noinline)) void cairn_mark_stage() {
  __asm volatile("nop" ::: "memory");
}
__attribute__((noinline)) void cairn_mark_frame_end() {
  __asm volatile("nop\nnop" ::: "memory");
}
}

namespace cairn::host {
namespace {

namespace fs = std::filesystem;

std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

int shell(const std::string& command) {
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// Instructions between two marks, and the mark that ended them.
struct Piece {
  std::string mark;
  double instructions = 0.0;
};

std::vector<Piece> read_pieces(const fs::path& path) {
  std::vector<Piece> pieces;
  std::ifstream file(path);
  const std::string trigger = "desc: Trigger: ";
  const std::string totals = "totals: ";
  std::string mark;
  for (std::string line; std::getline(file, line);) {
    if (line.compare(0, trigger.size(), trigger) == 0) mark = line.substr(trigger.size());
    if (line.compare(0, totals.size(), totals) != 0) continue;
    pieces.push_back({mark, std::strtod(line.c_str() + totals.size(), nullptr)});
  }
  return pieces;
}

bool ends(const Piece& piece, const char* name) {
  return piece.mark.find(name) != std::string::npos;
}

/// Pieces of one frame: odometry, five between the tracker's six ticks, one to the drawing's first,
/// the drawing, the rest.
std::optional<std::vector<double>> stages_of(const std::vector<double>& pieces) {
  if (pieces.size() != 8) return std::nullopt;
  return std::vector<double>{pieces[1], pieces[0] + pieces[2], pieces[3], pieces[4], pieces[6]};
}

std::vector<FrameInstructions> frames_of(const std::vector<Piece>& all) {
  std::vector<FrameInstructions> frames;
  std::vector<double> pieces;
  for (const Piece& piece : all) {
    if (ends(piece, "cairn_mark_frame_begin")) {
      pieces.clear();
      continue;
    }
    pieces.push_back(piece.instructions);
    if (!ends(piece, "cairn_mark_frame_end")) continue;
    FrameInstructions frame;
    for (const double each : pieces) frame.total += each;
    frame.stages = stages_of(pieces);
    frames.push_back(std::move(frame));
  }
  return frames;
}

}  // namespace

TickSource marking_ticks() {
  return {[](void*) -> std::uint32_t {
            cairn_mark_stage();
            return 0;
          },
          nullptr};
}

std::vector<FrameInstructions> count_instructions(const fs::path& log, const fs::path& folder,
                                                  std::string& problem) {
  if (shell("valgrind --version >/dev/null 2>&1") != 0) {
    problem = "instructions not counted: valgrind is not installed";
    return {};
  }
  const fs::path out = folder / "callgrind.out";
  const std::string command = fmt::format(
      "valgrind --quiet --tool=callgrind --combine-dumps=yes --dump-line=no "
      "--dump-before=cairn_mark_frame_begin --dump-before=cairn_mark_stage "
      "--dump-before=cairn_mark_frame_end --callgrind-out-file={} {} replay {} --marked "
      ">/dev/null 2>&1",
      quoted(out.string()), quoted(fs::read_symlink("/proc/self/exe").string()),
      quoted(log.string()));
  const int result = shell(command);
  std::vector<FrameInstructions> frames = frames_of(read_pieces(out));
  std::error_code ignored;
  fs::remove(out, ignored);
  if (result != 0 || frames.empty()) {
    problem = fmt::format("instructions not counted: valgrind ended with code {}", result);
  }
  return frames;
}

}  // namespace cairn::host

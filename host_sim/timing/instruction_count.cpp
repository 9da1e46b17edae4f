#include "host_sim/timing/instruction_count.hpp"

#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <numeric>
#include <sstream>

#include <fmt/format.h>

#include "host_sim/io/child_process.hpp"
#include "host_sim/replay/frame_marks.hpp"

namespace cairn::host {
namespace {

namespace fs = std::filesystem;

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

/// Which pieces of a frame belong to which stage, as cairn_count_frames prints it.
using StageBits = std::array<std::uint32_t, kStageCount>;

std::vector<StageBits> read_stages(const std::string& text) {
  std::vector<StageBits> frames;
  std::istringstream lines(text);
  for (std::string word; lines >> word;) {
    StageBits bits{};
    for (std::uint32_t& each : bits) lines >> std::hex >> each;
    frames.push_back(bits);
  }
  return frames;
}

/// The piece before the first mark holds the odometry; piece k + 1 follows mark k.
FrameInstructions frame_of(const std::vector<double>& pieces, const StageBits& bits) {
  FrameInstructions frame;
  frame.total = std::accumulate(pieces.begin(), pieces.end(), 0.0);
  frame.stages[static_cast<int>(Stage::kPosePrediction)] = pieces.front();
  for (int stage = 0; stage < kStageCount; ++stage) {
    for (std::size_t k = 0; k + 1 < pieces.size(); ++k) {
      if ((bits[stage] >> k & 1U) != 0U) frame.stages[stage] += pieces[k + 1];
    }
  }
  return frame;
}

std::vector<FrameInstructions> frames_of(const std::vector<Piece>& all,
                                         const std::vector<StageBits>& stages) {
  std::vector<FrameInstructions> frames;
  std::vector<double> pieces;
  for (const Piece& piece : all) {
    if (ends(piece, kFrameBeginMark)) {
      pieces.clear();
      continue;
    }
    pieces.push_back(piece.instructions);
    if (!ends(piece, kFrameEndMark)) continue;
    if (frames.size() == stages.size()) return {};
    frames.push_back(frame_of(pieces, stages[frames.size()]));
  }
  return frames.size() == stages.size() ? frames : std::vector<FrameInstructions>{};
}

/// valgrind replaces %p and the like in a file's name.
std::string without_patterns(const std::string& name) {
  std::string result;
  for (const char c : name) result += c == '%' ? std::string("%%") : std::string(1, c);
  return result;
}

std::vector<std::string> callgrind_command(const fs::path& program, const fs::path& log,
                                           const fs::path& out) {
  std::vector<std::string> command = {"valgrind", "--quiet", "--tool=callgrind",
                                      "--combine-dumps=yes", "--dump-line=no"};
  for (const char* mark : {kFrameBeginMark, kStageMark, kFrameEndMark}) {
    command.push_back(fmt::format("--dump-before={}", mark));
  }
  command.push_back("--callgrind-out-file=" + without_patterns(out.string()));
  command.push_back(program.string());
  command.push_back(log.string());
  return command;
}

std::string why_not(const ChildEnd& end) {
  if (end.not_found()) return "valgrind is not installed";
  if (end.fatal_signal() == SIGILL) {
    return fmt::format("valgrind {}: it does not know an instruction of this processor",
                       describe(end));
  }
  return fmt::format("valgrind {}", describe(end));
}

}  // namespace

InstructionCounts count_instructions(const fs::path& log, const fs::path& folder) {
  const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / "cairn_count_frames";
  const auto none = [](const std::string& why) {
    return InstructionCounts{{}, "instructions not counted: " + why};
  };
  if (!fs::exists(program)) return none(fmt::format("{} is missing", program.string()));
  const fs::path out = folder / "callgrind.out";
  const ChildEnd end = run_child(callgrind_command(program, log, out));
  std::vector<FrameInstructions> frames = frames_of(read_pieces(out), read_stages(end.output));
  std::error_code ignored;
  fs::remove(out, ignored);
  if (!end.succeeded()) return none(why_not(end));
  if (frames.empty()) return none("callgrind wrote no counts of frames");
  return {std::move(frames), {}};
}

}  // namespace cairn::host

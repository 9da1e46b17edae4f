#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace cairn::host {

enum class Grade : std::uint8_t { kGood, kNote, kBad };

/// One thing that a run shows, as a sentence.
struct VerdictPoint {
  Grade grade = Grade::kNote;
  std::string text;
};

/// Whether a run went well, for a reader who sees nothing else.
struct Verdict {
  std::string headline;
  std::vector<VerdictPoint> points;  ///< the bad ones first
};

/// Judges `summary` (docs/reference/outputs.md) of a run on pictures of `image_width` px. Bad are:
/// fewer than 95 % of the frames tracked, a lens that is guessed, an input that ended early, an
/// interruption, more than 1 % of the frames above the budget, a mean NEES above twice its degrees
/// of freedom, a mean NIS above 1.5 times its own, and a mean registration error above 1 % of the
/// width.
Verdict judge(const nlohmann::json& summary, int image_width);

/// headline, and points of `grade` (good, note, bad) and `text`.
nlohmann::json to_json(const Verdict& verdict);

}  // namespace cairn::host

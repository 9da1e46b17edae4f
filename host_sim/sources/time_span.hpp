#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace cairn::host {

/// First and last of some times, us.
struct TimeSpan {
  std::int64_t first_us = 0;
  std::int64_t last_us = 0;

  std::int64_t length_us() const { return last_us - first_us; }
};

/// In seconds, as messages say it.
std::string to_string(const TimeSpan& span);

/// Middle of the steps between increasing times, us; 0 for fewer than two.
std::int64_t median_step_us(const std::vector<std::int64_t>& times_us);

/// Checks that a recording of `times_us` beside the frames can be theirs: it overlaps the frames'
/// time by a tenth or more, and its median step is from `least_us` to `most_us` (a time in another
/// unit is a thousand times off). Throws InputError naming `file`, what it holds and both spans.
/// Returns a warning where it covers a part of the frames' time alone.
std::optional<std::string> check_overlap(const std::filesystem::path& file, const std::string& what,
                                         const std::vector<std::int64_t>& times_us,
                                         const TimeSpan& frames, std::int64_t least_us,
                                         std::int64_t most_us);

/// Checks that frames follow one another in 1 ms to 10 s. Throws InputError naming `file`.
void check_frame_times(const std::filesystem::path& file,
                       const std::vector<std::int64_t>& times_us);

}  // namespace cairn::host

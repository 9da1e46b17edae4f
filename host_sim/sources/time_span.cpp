#include "host_sim/sources/time_span.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "host_sim/io/input_error.hpp"

namespace cairn::host {
namespace {

constexpr double kLeastShareCovered = 0.1;
constexpr double kShareCoveredWithoutWarning = 0.99;
constexpr std::int64_t kSameInstant_us = 20000;
constexpr std::int64_t kLeastFrameStep_us = 1000;
constexpr std::int64_t kMostFrameStep_us = 10000000;

double seconds(std::int64_t t_us) {
  return 1e-6 * static_cast<double>(t_us);
}

}  // namespace

std::string to_string(const TimeSpan& span) {
  return fmt::format("{:.3f} s to {:.3f} s", seconds(span.first_us), seconds(span.last_us));
}

std::int64_t median_step_us(const std::vector<std::int64_t>& times_us) {
  if (times_us.size() < 2) return 0;
  std::vector<std::int64_t> steps;
  steps.reserve(times_us.size() - 1);
  for (std::size_t i = 1; i < times_us.size(); ++i) steps.push_back(times_us[i] - times_us[i - 1]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

std::optional<std::string> check_overlap(const std::filesystem::path& file, const std::string& what,
                                         const std::vector<std::int64_t>& times_us,
                                         const TimeSpan& frames, std::int64_t least_us,
                                         std::int64_t most_us) {
  const TimeSpan given{times_us.front(), times_us.back()};
  const std::int64_t step = median_step_us(times_us);
  const std::string spans =
      fmt::format("the frames' time, {}; {} is from {}", to_string(frames), what, to_string(given));
  if (times_us.size() > 1 && (step < least_us || step > most_us)) {
    throw InputError(
        file, fmt::format("expected steps of {:.6g} s to {:.6g} s in {}, found {:.6g} s: is the "
                          "unit of its times right? Expected {}",
                          seconds(least_us), seconds(most_us), what, seconds(step), spans));
  }
  const std::int64_t slack = std::max(step, kSameInstant_us);
  const std::int64_t first = std::max(frames.first_us, given.first_us - slack);
  const std::int64_t last = std::min(frames.last_us, given.last_us + slack);
  const double share = frames.length_us() > 0 ? static_cast<double>(last - first) /
                                                    static_cast<double>(frames.length_us())
                                              : (last >= first ? 1.0 : 0.0);
  if (share < kLeastShareCovered) {
    throw InputError(file,
                     fmt::format("expected times on the clock of the frames, over {}. The times of "
                                 "frames can be given by --times",
                                 spans));
  }
  if (share >= kShareCoveredWithoutWarning) return std::nullopt;
  return fmt::format("{}: covers {:.0f} % of {}", file.string(), 100.0 * share, spans);
}

void check_frame_times(const std::filesystem::path& file,
                       const std::vector<std::int64_t>& times_us) {
  const std::int64_t step = median_step_us(times_us);
  if (times_us.size() < 2 || (step >= kLeastFrameStep_us && step <= kMostFrameStep_us)) return;
  throw InputError(
      file, fmt::format("expected frames that follow one another in {:.6g} s to {:.6g} s, "
                        "found {:.6g} s: is the unit of the times right?",
                        seconds(kLeastFrameStep_us), seconds(kMostFrameStep_us), seconds(step)));
}

}  // namespace cairn::host

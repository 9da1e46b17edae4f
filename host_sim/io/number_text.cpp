#include "host_sim/io/number_text.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

namespace cairn::host {
namespace {

constexpr std::size_t kLongestRun = 40;
constexpr std::size_t kShownDigits = 8;

bool is_digit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}

}  // namespace

std::string number_problem(std::string_view text, double& value) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const char* const end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, value);
  if (parsed.ptr != end) return "a number";
  if (parsed.ec == std::errc::result_out_of_range) return "a number of 2.3e-308 to 1.7e308";
  return parsed.ec == std::errc() && std::isfinite(value) ? "" : "a number";
}

std::string with_short_numbers(std::string_view message) {
  std::string text;
  while (!message.empty()) {
    const auto other = std::find_if_not(message.begin(), message.end(), is_digit);
    const auto run = static_cast<std::size_t>(other - message.begin());
    if (run > kLongestRun) {
      text += fmt::format("{}... ({} digits)", message.substr(0, kShownDigits), run);
      message.remove_prefix(run);
    } else {
      const std::size_t taken = std::max<std::size_t>(run, 1);
      text += message.substr(0, taken);
      message.remove_prefix(taken);
    }
  }
  return text;
}

}  // namespace cairn::host

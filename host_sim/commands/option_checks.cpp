#include "host_sim/commands/option_checks.hpp"

#include <charconv>
#include <cstdint>
#include <limits>

#include <fmt/format.h>

#include "host_sim/io/number_text.hpp"

namespace cairn::host {
namespace {

bool is_whole(const std::string& text, std::uint64_t& value) {
  const char* const end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, value);
  return parsed.ec == std::errc() && parsed.ptr == end;
}

}  // namespace

CLI::Validator above_zero() {
  return CLI::Validator(
      [](const std::string& text) {
        double value = 0.0;
        const bool good = number_problem(text, value).empty() && value > 0.0;
        return good ? std::string()
                    : fmt::format("expected a number above zero, up to 1.7e308, found '{}'", text);
      },
      "ABOVE 0");
}

CLI::Validator count() {
  return CLI::Validator(
      [](const std::string& text) {
        std::uint64_t value = 0;
        const bool good = is_whole(text, value) && value > 0 &&
                          value <= std::uint64_t{std::numeric_limits<int>::max()};
        return good ? std::string()
                    : fmt::format("expected a whole number above zero, found '{}'", text);
      },
      "ABOVE 0");
}

CLI::Validator not_negative() {
  return CLI::Validator(
      [](const std::string& text) {
        double value = 0.0;
        const bool good = number_problem(text, value).empty() && value >= 0.0;
        return good ? std::string()
                    : fmt::format("expected a number of 0 to 1.7e308, found '{}'", text);
      },
      "AT LEAST 0");
}

CLI::Validator between(double low, double high) {
  return CLI::Validator(
      [low, high](const std::string& text) {
        double value = 0.0;
        const bool good = number_problem(text, value).empty() && value >= low && value <= high;
        return good ? std::string()
                    : fmt::format("expected a number from {} to {}, found '{}'", low, high, text);
      },
      fmt::format("{} to {}", low, high));
}

CLI::Validator seed_number() {
  return CLI::Validator(
      [](const std::string& text) {
        std::uint64_t value = 0;
        return is_whole(text, value)
                   ? std::string()
                   : fmt::format("expected a whole number from 0 to 2^64 - 1, found '{}'", text);
      },
      "0 to 2^64 - 1");
}

std::vector<std::string> given_options(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() > 0) names.push_back(option->get_name());
  }
  return names;
}

}  // namespace cairn::host

#include "host_sim/commands/option_checks.hpp"

#include <charconv>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

namespace cairn::host {
namespace {

template <class T>
bool parse(const std::string& text, T& value) {
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, value);
  return parsed.ec == std::errc() && parsed.ptr == end;
}

}  // namespace

CLI::Validator above_zero() {
  return CLI::Validator(
      [](const std::string& text) {
        double value = 0.0;
        const bool good = parse(text, value) && value > 0.0 && std::isfinite(value);
        return good ? std::string() : fmt::format("expected a number above zero, found '{}'", text);
      },
      "ABOVE 0");
}

CLI::Validator not_negative() {
  return CLI::Validator(
      [](const std::string& text) {
        double value = 0.0;
        const bool good = parse(text, value) && value >= 0.0 && std::isfinite(value);
        return good ? std::string()
                    : fmt::format("expected a number of at least zero, found '{}'", text);
      },
      "AT LEAST 0");
}

CLI::Validator seed_number() {
  return CLI::Validator(
      [](const std::string& text) {
        std::uint64_t value = 0;
        return parse(text, value)
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

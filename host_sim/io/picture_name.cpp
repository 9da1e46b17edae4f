#include "host_sim/io/picture_name.hpp"

#include <cctype>
#include <charconv>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "host_sim/io/input_error.hpp"

namespace cairn::host {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kYear2100_s = 4100000000;

/// Lengths of the numbers of a date and time: 20240131_235959, also with milliseconds, both without
/// a gap, and 2024-01-31_23-59-59.
const std::vector<std::vector<std::size_t>> kDateForms = {
    {8, 6}, {8, 9}, {14}, {17}, {4, 2, 2, 2, 2, 2}};

bool is_date_time(const std::string& digits) {
  const auto part = [&](std::size_t at, std::size_t count) {
    return std::stoi(digits.substr(at, count));
  };
  const int year = part(0, 4), month = part(4, 2), day = part(6, 2);
  return year >= 1990 && year <= 2099 && month >= 1 && month <= 12 && day >= 1 && day <= 31 &&
         part(8, 2) <= 23 && part(10, 2) <= 59 && part(12, 2) <= 59;
}

}  // namespace

bool is_digit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}

std::int64_t to_number(const fs::path& path, const std::string& digits) {
  std::int64_t number = 0;
  const char* end = digits.data() + digits.size();
  if (std::from_chars(digits.data(), end, number).ec != std::errc()) {
    throw InputError(path, fmt::format("expected a number of at most 64 bits ({}) in the name",
                                       std::numeric_limits<std::int64_t>::max()));
  }
  return number;
}

PictureName::PictureName(const fs::path& file) : path(file), texts(1) {
  for (const char c : file.stem().string()) {
    if (is_digit(c)) {
      if (numbers.size() < texts.size()) numbers.emplace_back();
      numbers.back() += c;
    } else {
      if (texts.size() == numbers.size()) texts.emplace_back();
      texts.back() += c;
    }
  }
  if (texts.size() == numbers.size()) texts.emplace_back();
}

std::optional<std::size_t> PictureName::decimal_seconds() const {
  constexpr std::size_t kDigitsSince2001 = 10;
  const bool alone = numbers.size() == 2 && texts[0].empty() && texts[2].empty();
  for (std::size_t i = 0; i + 1 < numbers.size(); ++i) {
    if (texts[i + 1] == "." && (alone || numbers[i].size() == kDigitsSince2001)) return i;
  }
  return std::nullopt;
}

/// The fraction is taken from its digits, not from a float.
std::int64_t decimal_time_us(const PictureName& name, std::size_t seconds_index) {
  const std::int64_t seconds = to_number(name.path, name.numbers[seconds_index]);
  if (seconds > kYear2100_s) {
    throw InputError(name.path, "expected seconds with decimals up to the year 2100 as its name");
  }
  std::string fraction = name.numbers[seconds_index + 1];
  const bool up = fraction.size() > 6 && fraction[6] >= '5';
  fraction.resize(6, '0');
  return 1000000 * seconds + to_number(name.path, fraction) + (up ? 1 : 0);
}

bool ends_in_date_time(const PictureName& name) {
  // 10-00-00.033: a fraction of the second behind it.
  const bool has_fraction = name.numbers.size() > 1 && name.texts[name.numbers.size() - 1] == ".";
  const std::size_t count = name.numbers.size() - (has_fraction ? 1 : 0);
  for (const std::vector<std::size_t>& form : kDateForms) {
    if (count < form.size()) continue;
    const std::size_t skipped = count - form.size();
    std::string digits;
    for (std::size_t i = 0; i < form.size() && name.numbers[skipped + i].size() == form[i]; ++i) {
      digits += name.numbers[skipped + i];
    }
    if (digits.size() == std::accumulate(form.begin(), form.end(), std::size_t{0})) {
      return is_date_time(digits);
    }
  }
  return false;
}

}  // namespace cairn::host

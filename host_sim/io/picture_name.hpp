#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace cairn::host {

/// The name of a picture without its ending, taken apart: text, number, text, ... , text.
struct PictureName {
  explicit PictureName(const std::filesystem::path& file);

  std::filesystem::path path;
  std::vector<std::string> texts;    ///< one more than numbers; may be empty
  std::vector<std::string> numbers;  ///< digits, with leading zeros

  /// Which number is the seconds of a time with decimals, such as 1305031102.975304; none where
  /// there is none. It is the whole name, or a time since 1970 anywhere in it.
  std::optional<std::size_t> decimal_seconds() const;
  /// Name and ending, for messages.
  std::string shown() const { return path.filename().string(); }
};

bool is_digit(char c);

/// Digits as a number. Throws InputError naming `path` where it has more than 63 bits.
std::int64_t to_number(const std::filesystem::path& path, const std::string& digits);

/// The time whose seconds are number `seconds` of a name, us. Throws InputError beyond the year
/// 2100.
std::int64_t decimal_time_us(const PictureName& name, std::size_t seconds);

/// Whether a name ends in a date with time of day: 20240131235959, 20240131_235959, either with
/// three digits of milliseconds behind, or 2024-01-31_23-59-59.
bool ends_in_date_time(const PictureName& name);

}  // namespace cairn::host

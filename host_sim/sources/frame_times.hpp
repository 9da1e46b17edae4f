#pragma once

#include <cstdint>
#include <filesystem>
#include <map>

namespace cairn::host {

/// Times of frames by their numbers, from a CSV file with the column `frame` and a time column
/// (docs/reference/command-line.md). Both increase strictly. Throws InputError naming line and
/// column.
class FrameTimes {
 public:
  explicit FrameTimes(const std::filesystem::path& path);

  /// Throws InputError where there is no row for the frame.
  std::int64_t t_us(int frame) const;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::map<std::int64_t, std::int64_t> times_;
};

}  // namespace cairn::host

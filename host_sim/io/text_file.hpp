#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "cairn/geometry/rigid.hpp"

namespace cairn::host {

struct TextLine {
  int number = 0;  ///< from 1
  std::string text;
};

/// Throws InputError unless `path` is a file / a folder; `what` names it in the message.
void require_file(const std::filesystem::path& path, const std::string& what);
void require_folder(const std::filesystem::path& path, const std::string& what);

/// Lines of a text file without blank ones and those that start with '#'; a carriage return at the
/// end is dropped. Throws InputError when the file cannot be read.
std::vector<TextLine> read_lines(const std::filesystem::path& path);

/// Fields of a line, separated by any run of blanks and tabs, or each by one comma.
std::vector<std::string_view> split_blanks(std::string_view text);
std::vector<std::string_view> split_commas(std::string_view text);

/// The whole field as a finite number; throws InputError naming file, line and `what` otherwise.
double parse_number(std::string_view field, const std::filesystem::path& path, int line,
                    const std::string& what);

/// A line of exactly `count` numbers separated by blanks; `what` says what they are.
std::vector<double> parse_numbers(const TextLine& line, std::size_t count,
                                  const std::filesystem::path& path, const std::string& what);

/// Numbers of a CSV file with a header line, as columns asked for by name. Other columns are
/// ignored, but every row must have as many fields as the header.
class CsvTable {
 public:
  explicit CsvTable(const std::filesystem::path& path);

  bool has(const std::string& column) const;
  /// Index for number(); throws InputError naming the column when it is missing.
  std::size_t column(const std::string& name) const;
  std::size_t rows() const { return lines_.size(); }
  double number(std::size_t row, std::size_t column) const;
  /// Same, refusing anything but an integer.
  int integer(std::size_t row, std::size_t column) const;
  int line(std::size_t row) const { return lines_[row].number; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::vector<std::string> header_;
  std::vector<TextLine> lines_;
  std::vector<std::vector<std::string_view>> fields_;
};

}  // namespace cairn::host

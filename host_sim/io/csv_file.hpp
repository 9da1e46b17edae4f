#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/io/text_file.hpp"

namespace cairn::host {

/// Rows of a CSV file with a header line, one at a time: memory does not grow with the file.
///
/// Fields are separated by commas, semicolons, tabs or blanks, as the header is; they may stand in
/// double quotes (RFC 4180, without line breaks inside). Where they are not separated by commas a
/// decimal comma is read as a point. Names of columns are compared without regard to case, with
/// blanks as underscores. A header that is a comment (#) directly before the first row of numbers
/// counts. Rows of empty fields are skipped; every other row must have as many fields as the
/// header.
class CsvReader {
 public:
  /// Reads the header. Throws InputError where there is none.
  explicit CsvReader(const std::filesystem::path& path);

  /// Names of the columns in order.
  const std::vector<std::string>& header() const { return header_; }
  bool has(const std::string& column) const;
  /// Index for number(); throws InputError where the column is missing or there twice, naming it
  /// and the columns that there are.
  std::size_t column(const std::string& name) const;

  /// Reads the next row; false after the last. Throws InputError naming the line.
  bool next();
  int line() const { return row_.number; }
  /// Of the row that next() read, a finite number; throws InputError naming line and column.
  double number(std::size_t column) const;
  /// Same, an integer of at most 64 bits.
  std::int64_t integer(std::size_t column) const;
  const std::filesystem::path& path() const { return lines_.path(); }
  /// Throws InputError naming the row's line and `column`.
  [[noreturn]] void fail(std::size_t column, const std::string& problem) const;

 private:
  std::vector<std::string> split(std::string_view text, int line) const;
  void choose_separator(std::string_view header);
  bool take_row();

  LineReader lines_;
  char separator_ = ',';
  std::vector<std::string> header_;
  TextLine row_;
  std::vector<std::string> fields_;
  bool first_row_is_read_ = false;  ///< the header was the comment before it
};

}  // namespace cairn::host

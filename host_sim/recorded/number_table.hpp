#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace cairn::host {

/// Rows of finite numbers read from a text file, with the line each came from.
struct NumberTable {
  std::filesystem::path file;
  std::vector<std::vector<double>> rows;
  std::vector<int> lines;
};

/// How the text is laid out.
struct TableFormat {
  std::string header;  ///< first line, compared exactly; empty: no header. '#' starts a comment
  bool commas = true;  ///< otherwise blanks and tabs
  int columns = 0;     ///< numbers in every row
  bool increasing = false;  ///< the first column must not decrease
};

/// Reads a whole file of at most 256 MB strictly: every line that is neither blank nor a comment
/// holds exactly `columns` finite numbers. Throws InputError naming file, line and what was
/// expected.
NumberTable read_number_table(const std::filesystem::path& file, const TableFormat& format);

}  // namespace cairn::host

#include "host_sim/recorded/number_table.hpp"

#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "host_sim/io/input_error.hpp"
#include "host_sim/io/text_file.hpp"

namespace cairn::host {
namespace {

constexpr std::uintmax_t kLargestFile = std::uintmax_t{1} << 28;

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

/// Numbers of one line; false where one is malformed or not finite.
bool parse_line(const std::string& line, bool commas, std::vector<double>& numbers) {
  const char* at = line.data();
  const char* end = at + line.size();
  const auto skip_blanks = [&] {
    while (at != end && is_blank(*at)) ++at;
  };
  skip_blanks();
  while (at != end) {
    double value = 0.0;
    const auto parsed = std::from_chars(at, end, value);
    if (parsed.ec != std::errc() || !std::isfinite(value)) return false;
    numbers.push_back(value);
    at = parsed.ptr;
    const char* before = at;
    skip_blanks();
    if (at == end) return true;
    if (commas) {
      if (*at != ',') return false;
      ++at;
      skip_blanks();
      if (at == end) return false;
    } else if (at == before) {
      return false;
    }
  }
  return true;
}

}  // namespace

NumberTable read_number_table(const std::filesystem::path& file, const TableFormat& format) {
  std::error_code error;
  if (std::filesystem::file_size(file, error) > kLargestFile && !error) {
    throw InputError(file, fmt::format("expected at most {} bytes", kLargestFile));
  }
  LineReader lines(file);
  NumberTable table;
  table.file = file;
  TextLine line;
  if (!format.header.empty() && (!lines.next(line) || line.text != format.header)) {
    throw InputError(file, 1, fmt::format("expected the header '{}'", format.header));
  }
  while (lines.next(line)) {
    std::vector<double> numbers;
    const bool good = parse_line(line.text, format.commas, numbers);
    if (!good || static_cast<int>(numbers.size()) != format.columns) {
      throw InputError(file, line.number,
                       fmt::format("expected {} finite numbers separated by {}", format.columns,
                                   format.commas ? "commas" : "blanks"));
    }
    if (format.increasing && !table.rows.empty() && numbers[0] < table.rows.back()[0]) {
      throw InputError(file, line.number,
                       fmt::format("expected a time of at least {:.3f} s, that of the line before",
                                   table.rows.back()[0]));
    }
    table.rows.push_back(numbers);
    table.lines.push_back(line.number);
  }
  if (table.rows.empty()) throw InputError(file, "expected at least one row of numbers");
  return table;
}

}  // namespace cairn::host

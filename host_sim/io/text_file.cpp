#include "host_sim/io/text_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

#include <fmt/format.h>

#include "host_sim/io/input_error.hpp"

namespace cairn::host {
namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

}  // namespace

void require_file(const std::filesystem::path& path, const std::string& what) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    throw InputError(path, fmt::format("no such file; expected {}", what));
  }
  if (!std::filesystem::is_regular_file(path, error)) {
    throw InputError(path, fmt::format("not a file; expected {}", what));
  }
}

void require_folder(const std::filesystem::path& path, const std::string& what) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    throw InputError(path, fmt::format("no such folder; expected {}", what));
  }
  if (!std::filesystem::is_directory(path, error)) {
    throw InputError(path, fmt::format("not a folder; expected {}", what));
  }
}

std::vector<TextLine> read_lines(const std::filesystem::path& path) {
  require_file(path, "a text file");
  std::ifstream file(path);
  if (!file) throw InputError(path, "cannot be opened for reading");
  std::vector<TextLine> lines;
  std::string text;
  for (int number = 1; std::getline(file, text); ++number) {
    if (!text.empty() && text.back() == '\r') text.pop_back();
    const std::string_view content = trimmed(text);
    if (content.empty() || content.front() == '#') continue;
    lines.push_back({number, text});
  }
  if (file.bad()) throw InputError(path, "reading failed");
  return lines;
}

std::vector<std::string_view> split_blanks(std::string_view text) {
  std::vector<std::string_view> fields;
  std::size_t position = 0;
  while ((position = text.find_first_not_of(" \t", position)) != std::string_view::npos) {
    const std::size_t end = std::min(text.find_first_of(" \t", position), text.size());
    fields.push_back(text.substr(position, end - position));
    position = end;
  }
  return fields;
}

std::vector<std::string_view> split_commas(std::string_view text) {
  std::vector<std::string_view> fields;
  std::size_t position = 0;
  while (true) {
    const std::size_t comma = text.find(',', position);
    fields.push_back(trimmed(text.substr(position, comma - position)));
    if (comma == std::string_view::npos) return fields;
    position = comma + 1;
  }
}

double parse_number(std::string_view field, const std::filesystem::path& path, int line,
                    const std::string& what) {
  double value = 0.0;
  const char* begin = field.data();
  const char* end = begin + field.size();
  if (begin != end && *begin == '+') ++begin;
  const auto parsed = std::from_chars(begin, end, value);
  if (parsed.ec != std::errc() || parsed.ptr != end || !std::isfinite(value)) {
    throw InputError(path, line, fmt::format("{}: expected a number, found '{}'", what, field));
  }
  return value;
}

std::vector<double> parse_numbers(const TextLine& line, std::size_t count,
                                  const std::filesystem::path& path, const std::string& what) {
  const std::vector<std::string_view> fields = split_blanks(line.text);
  if (fields.size() != count) {
    throw InputError(path, line.number,
                     fmt::format("expected {} numbers ({}), found {}", count, what, fields.size()));
  }
  std::vector<double> values;
  values.reserve(count);
  for (const std::string_view field : fields) {
    values.push_back(parse_number(field, path, line.number, what));
  }
  return values;
}

CsvTable::CsvTable(const std::filesystem::path& path) : path_(path), lines_(read_lines(path)) {
  if (lines_.empty()) throw InputError(path, "expected a header line, found an empty file");
  for (const std::string_view name : split_commas(lines_.front().text)) {
    header_.emplace_back(name);
  }
  lines_.erase(lines_.begin());
  fields_.reserve(lines_.size());
  for (const TextLine& line : lines_) {
    fields_.push_back(split_commas(line.text));
    if (fields_.back().size() != header_.size()) {
      throw InputError(path, line.number,
                       fmt::format("expected {} fields as in the header, found {}", header_.size(),
                                   fields_.back().size()));
    }
  }
}

bool CsvTable::has(const std::string& column) const {
  return std::find(header_.begin(), header_.end(), column) != header_.end();
}

std::size_t CsvTable::column(const std::string& name) const {
  const auto found = std::find(header_.begin(), header_.end(), name);
  if (found == header_.end()) {
    throw InputError(path_, 1, fmt::format("expected a column '{}' in the header", name));
  }
  return static_cast<std::size_t>(found - header_.begin());
}

double CsvTable::number(std::size_t row, std::size_t column) const {
  return parse_number(fields_[row][column], path_, lines_[row].number, header_[column]);
}

int CsvTable::integer(std::size_t row, std::size_t column) const {
  const double value = number(row, column);
  if (value != std::floor(value) || std::abs(value) > 1e9) {
    throw InputError(
        path_, lines_[row].number,
        fmt::format("{}: expected an integer, found '{}'", header_[column], fields_[row][column]));
  }
  return static_cast<int>(value);
}

}  // namespace cairn::host

#include "host_sim/io/csv_file.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host_sim/io/input_error.hpp"

namespace cairn::host {
namespace {

std::string normalised(std::string_view name) {
  std::string result;
  for (const char c : trimmed(name)) {
    const bool blank = c == ' ' || c == '\t';
    result += blank ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return result;
}

bool is_number(const std::string& field) {
  double value = 0.0;
  const auto parsed = std::from_chars(field.data(), field.data() + field.size(), value);
  return !field.empty() && parsed.ptr == field.data() + field.size();
}

bool is_blank(const std::vector<std::string>& fields) {
  return std::all_of(fields.begin(), fields.end(), [](const auto& f) { return f.empty(); });
}

/// The field in quotes that begins at `at`; `at` is then behind its closing quote.
std::string quoted_field(std::string_view text, std::size_t& at, const std::filesystem::path& path,
                         int line) {
  std::string field;
  for (++at; at < text.size(); ++at) {
    if (text[at] != '"') {
      field += text[at];
    } else if (at + 1 < text.size() && text[at + 1] == '"') {
      field += text[at++];
    } else {
      ++at;
      return field;
    }
  }
  throw InputError(path, line, "expected a closing quote (\") in the line of its field");
}

}  // namespace

CsvReader::CsvReader(const std::filesystem::path& path) : lines_(path) {
  if (!lines_.next(row_)) throw InputError(path, "expected a header line, found an empty file");
  if (row_.text.rfind("sep=", 0) == 0 && row_.text.size() == 5 && !lines_.next(row_)) {
    throw InputError(path, "expected a header line behind 'sep='");
  }
  choose_separator(row_.text);
  fields_ = split(row_.text, row_.number);
  std::vector<std::string> names;
  if (std::any_of(fields_.begin(), fields_.end(), is_number)) {
    names = split(lines_.comment(), row_.number);
  }
  const bool named_above =
      names.size() == fields_.size() && std::none_of(names.begin(), names.end(), is_number);
  if (!named_above && std::all_of(fields_.begin(), fields_.end(), is_number)) {
    throw InputError(path, row_.number, "expected a header line with names, found numbers");
  }
  if (named_above) {
    first_row_is_read_ = true;
    for (const std::string& name : names) header_.push_back(normalised(name));
    return;
  }
  for (const std::string& name : fields_) header_.push_back(normalised(name));
}

/// Outside of quotes, in this order: a semicolon, a comma, a tab, else blanks.
void CsvReader::choose_separator(std::string_view header) {
  std::string plain;
  bool quoted = false;
  for (const char c : header) {
    if (c == '"') quoted = !quoted;
    if (!quoted) plain += c;
  }
  for (const char candidate : {';', ',', '\t'}) {
    separator_ = candidate;
    if (plain.find(candidate) != std::string::npos) return;
  }
  separator_ = ' ';
}

std::vector<std::string> CsvReader::split(std::string_view text, int line) const {
  std::vector<std::string> fields;
  std::size_t at = 0;
  while (true) {
    at = std::min(text.find_first_not_of(separator_ == '\t' ? " " : " \t", at), text.size());
    if (separator_ == ' ' && at == text.size()) return fields;
    if (at < text.size() && text[at] == '"') {
      fields.push_back(quoted_field(text, at, path(), line));
      const std::size_t rest = text.find_first_not_of(" \t", at);
      const bool ends = rest == std::string_view::npos || text[rest] == separator_;
      if (!ends && separator_ != ' ') {
        throw InputError(path(), line, "expected the next field behind a closing quote (\")");
      }
      at = separator_ == ' ' ? at : std::min(rest, text.size());
    } else {
      const std::size_t end =
          std::min(separator_ == ' ' ? text.find_first_of(" \t", at) : text.find(separator_, at),
                   text.size());
      fields.emplace_back(trimmed(text.substr(at, end - at)));
      at = end;
    }
    if (separator_ == ' ') continue;
    if (at == text.size()) return fields;
    ++at;
  }
}

bool CsvReader::has(const std::string& column) const {
  return std::find(header_.begin(), header_.end(), column) != header_.end();
}

std::size_t CsvReader::column(const std::string& name) const {
  const auto found = std::find(header_.begin(), header_.end(), name);
  if (found == header_.end()) {
    throw InputError(path(), 1,
                     fmt::format("expected a column '{}' in the header, found {}", name,
                                 fmt::join(header_, ", ")));
  }
  if (std::find(found + 1, header_.end(), name) != header_.end()) {
    throw InputError(path(), 1, fmt::format("expected one column '{}', found two", name));
  }
  return static_cast<std::size_t>(found - header_.begin());
}

bool CsvReader::take_row() {
  if (first_row_is_read_) {
    first_row_is_read_ = false;
    return true;
  }
  if (!lines_.next(row_)) return false;
  fields_ = split(row_.text, row_.number);
  return true;
}

bool CsvReader::next() {
  do {
    if (!take_row()) return false;
  } while (is_blank(fields_));
  const std::size_t given = fields_.size();
  while (fields_.size() > header_.size() && fields_.back().empty()) fields_.pop_back();
  if (fields_.size() != header_.size()) {
    throw InputError(
        path(), row_.number,
        fmt::format("expected {} fields as in the header, found {}{}", header_.size(), given,
                    given == 2 * header_.size() && separator_ == ','
                        ? " (decimal commas need semicolons between fields)"
                        : ""));
  }
  return true;
}

double CsvReader::number(std::size_t column) const {
  std::string field = fields_[column];
  const std::size_t comma = field.find(',');
  if (separator_ != ',' && comma != std::string::npos && field.find('.') == std::string::npos) {
    field[comma] = '.';
  }
  return parse_number(field, path(), row_.number, header_[column]);
}

std::int64_t CsvReader::integer(std::size_t column) const {
  const std::string& field = fields_[column];
  std::int64_t value = 0;
  const auto parsed = std::from_chars(field.data(), field.data() + field.size(), value);
  if (parsed.ec != std::errc() || parsed.ptr != field.data() + field.size()) {
    fail(column, fmt::format("expected an integer, found '{}'", field));
  }
  return value;
}

void CsvReader::fail(std::size_t column, const std::string& problem) const {
  throw InputError(path(), row_.number, fmt::format("{}: {}", header_[column], problem));
}

}  // namespace cairn::host

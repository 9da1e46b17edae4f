#include "host_sim/io/text_file.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>

#include <fmt/format.h>

#include "host_sim/io/input_error.hpp"
#include "host_sim/io/number_text.hpp"

namespace cairn::host {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::size_t kLongestLine = 65536;
constexpr double kLargestTime_us = 4.6e18;  // 2^62

std::ifstream open_text(const std::filesystem::path& path) {
  require_file(path, "a text file");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path, "cannot be opened for reading");
  const int first = file.get();
  const int second = file.get();
  if ((first == 0xFF && second == 0xFE) || (first == 0xFE && second == 0xFF)) {
    throw InputError(path, "expected UTF-8 text, found UTF-16: save it as UTF-8");
  }
  file.clear();
  file.seekg(0);
  return file;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

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

std::string read_text(const std::filesystem::path& path, std::size_t limit,
                      const std::string& what) {
  std::ifstream file = open_text(path);
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error || size > limit) {
    throw InputError(path, fmt::format("expected {} of at most {} bytes, found {}", what, limit,
                                       error ? "no size" : fmt::format("{}", size)));
  }
  std::string text(static_cast<std::size_t>(size), '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.gcount() != static_cast<std::streamsize>(text.size())) {
    throw InputError(path, "reading failed");
  }
  if (text.rfind(kByteOrderMark, 0) == 0) text.erase(0, kByteOrderMark.size());
  if (text.find('\0') != std::string::npos) {
    throw InputError(path, "expected text, found a zero byte");
  }
  return text;
}

LineReader::LineReader(const std::filesystem::path& path) : path_(path), file_(open_text(path)) {}

bool LineReader::read(std::string& text) {
  text.clear();
  int c = file_.get();
  if (c == std::ifstream::traits_type::eof()) {
    if (file_.bad()) throw InputError(path_, "reading failed");
    return false;
  }
  ++number_;
  for (; c != std::ifstream::traits_type::eof() && c != '\n'; c = file_.get()) {
    if (c == '\r') {
      if (file_.peek() == '\n') file_.get();
      break;
    }
    if (c == '\0') throw InputError(path_, number_, "expected text, found a zero byte");
    if (text.size() == kLongestLine) {
      throw InputError(path_, number_,
                       fmt::format("expected lines of at most {} characters", kLongestLine));
    }
    text.push_back(static_cast<char>(c));
  }
  if (number_ == 1 && text.rfind(kByteOrderMark, 0) == 0) text.erase(0, kByteOrderMark.size());
  return true;
}

bool LineReader::next(TextLine& line) {
  comment_.clear();
  while (read(line.text)) {
    const std::string_view content = trimmed(line.text);
    if (content.empty()) continue;
    if (content.front() == '#') {
      comment_ = content.substr(1);
      continue;
    }
    line.number = number_;
    return true;
  }
  return false;
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

double parse_number(std::string_view field, const std::filesystem::path& path, int line,
                    const std::string& what) {
  double value = 0.0;
  const std::string problem = number_problem(field, value);
  if (!problem.empty()) {
    throw InputError(path, line, fmt::format("{}: expected {}, found '{}'", what, problem, field));
  }
  return value;
}

std::vector<double> parse_numbers(const TextLine& line, std::size_t count,
                                  const std::filesystem::path& path, const std::string& what) {
  const std::vector<std::string_view> fields = split_blanks(line.text);
  if (fields.size() != count) {
    throw InputError(path, line.number,
                     fmt::format("expected {} numbers separated by blanks ({}), found {}", count,
                                 what, fields.size()));
  }
  std::vector<double> values;
  values.reserve(count);
  for (const std::string_view field : fields) {
    values.push_back(parse_number(field, path, line.number, what));
  }
  return values;
}

std::int64_t parse_time_us(double value, double unit_us, const std::filesystem::path& path,
                           int line) {
  const double t_us = value * unit_us;
  if (!(std::abs(t_us) < kLargestTime_us)) {
    throw InputError(
        path, line,
        fmt::format("expected a time within 146,000 years of 0, found {} s", 1e-6 * t_us));
  }
  return std::llround(t_us);
}

}  // namespace cairn::host

#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace cairn::host {

/// Throws InputError unless `path` is a file / a folder; `what` names it in the message.
void require_file(const std::filesystem::path& path, const std::string& what);
void require_folder(const std::filesystem::path& path, const std::string& what);

/// The whole file without a UTF-8 byte order mark. Throws InputError when it is larger than `limit`
/// bytes, cannot be read, is UTF-16 or holds zero bytes; `what` names it in the message.
std::string read_text(const std::filesystem::path& path, std::size_t limit,
                      const std::string& what);

struct TextLine {
  int number = 0;  ///< from 1
  std::string text;
};

/// Lines of a text file, one at a time, so that memory does not grow with the file. Lines end in
/// LF, CR LF or CR; the last one needs no end. A UTF-8 byte order mark is skipped.
class LineReader {
 public:
  /// Throws InputError when the file cannot be read or is UTF-16.
  explicit LineReader(const std::filesystem::path& path);

  /// The next line that is neither blank nor a comment (#); false after the last. Throws InputError
  /// for a line of more than 65,536 characters or with a zero byte: it is no text.
  bool next(TextLine& line);
  /// The comment directly before the line that next() gave, without its '#'; empty: none.
  const std::string& comment() const { return comment_; }
  const std::filesystem::path& path() const { return path_; }

 private:
  bool read(std::string& text);

  std::filesystem::path path_;
  std::ifstream file_;
  std::string comment_;
  int number_ = 0;
};

/// `text` without blanks and tabs at its ends.
std::string_view trimmed(std::string_view text);

/// Fields of a line, separated by any run of blanks and tabs.
std::vector<std::string_view> split_blanks(std::string_view text);

/// The whole field as a finite number; throws InputError naming file, line and `what` otherwise.
double parse_number(std::string_view field, const std::filesystem::path& path, int line,
                    const std::string& what);

/// A line of exactly `count` numbers separated by blanks; `what` says what they are.
std::vector<double> parse_numbers(const TextLine& line, std::size_t count,
                                  const std::filesystem::path& path, const std::string& what);

/// `value` units of `unit_us` microseconds as a time, rounded. Throws InputError naming the line
/// when it is further than 146,000 years from 0: differences of times then fit 64 bits.
std::int64_t parse_time_us(double value, double unit_us, const std::filesystem::path& path,
                           int line);

}  // namespace cairn::host

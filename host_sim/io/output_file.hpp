#pragma once

#include <cstddef>
#include <filesystem>
#include <iterator>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace cairn::host {

/// A file of results cannot be written. The program ends with exit code 4.
class OutputError : public std::runtime_error {
 public:
  OutputError(const std::filesystem::path& file, const std::string& problem);
};

/// The name under which a file is written until it is complete: its own and ".part".
std::filesystem::path part_of(const std::filesystem::path& path);

/// A file of results that is there whole or not at all: it is written under part_of(path) and gets
/// its name in finish(), in place of an older file. Without finish() nothing is left.
class OutputFile {
 public:
  /// Throws OutputError, as every function here. A device or a pipe is written to as it is.
  explicit OutputFile(std::filesystem::path path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  template <class... Arguments>
  void print(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(buffer_), format, std::forward<Arguments>(arguments)...);
    if (buffer_.size() >= kBuffer) flush();
  }
  void write(std::string_view bytes);
  /// Everything is on the disk, under its name.
  void finish();

 private:
  static constexpr std::size_t kBuffer = 65536;

  void flush();
  [[noreturn]] void fail();

  std::filesystem::path path_;
  std::filesystem::path part_;
  std::string buffer_;
  int descriptor_ = -1;
};

/// `text` as it is in `path`, whole or not at all.
void write_text(const std::filesystem::path& path, std::string_view text);

}  // namespace cairn::host

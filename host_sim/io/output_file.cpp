#include "host_sim/io/output_file.hpp"

#include <cerrno>
#include <cstdio>
#include <fcntl.h>
#include <system_error>
#include <unistd.h>

namespace cairn::host {
namespace {

std::string reason(int error) {
  return "cannot be written: " + std::generic_category().message(error);
}

/// A device, pipe or socket: there is no putting a file in its place.
bool is_special(const std::filesystem::path& path) {
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(path, ignored);
  return exists(status) && !is_regular_file(status) && !is_directory(status);
}

/// Empty: there is none.
void remove_part(const std::filesystem::path& part) {
  if (!part.empty()) unlink(part.c_str());
}

}  // namespace

OutputError::OutputError(const std::filesystem::path& file, const std::string& problem)
    : std::runtime_error(fmt::format("{}: {}", file.string(), problem)) {}

std::filesystem::path part_of(const std::filesystem::path& path) {
  std::filesystem::path part = path;
  part += ".part";
  return part;
}

OutputFile::OutputFile(std::filesystem::path path)
    : path_(std::move(path)), part_(is_special(path_) ? std::filesystem::path() : part_of(path_)) {
  const std::filesystem::path& written = part_.empty() ? path_ : part_;
  const int flags = part_.empty() ? O_WRONLY : O_WRONLY | O_CREAT | O_TRUNC;
  descriptor_ = open(written.c_str(), flags | O_CLOEXEC, 0666);
  if (descriptor_ < 0) throw OutputError(path_, reason(errno));
}

OutputFile::~OutputFile() {
  if (descriptor_ < 0) return;
  close(descriptor_);
  remove_part(part_);
}

void OutputFile::write(std::string_view bytes) {
  buffer_.append(bytes);
  if (buffer_.size() >= kBuffer) flush();
}

void OutputFile::flush() {
  std::size_t done = 0;
  while (done < buffer_.size()) {
    const ssize_t count = ::write(descriptor_, buffer_.data() + done, buffer_.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) fail();
    done += static_cast<std::size_t>(count);
  }
  buffer_.clear();
}

void OutputFile::finish() {
  flush();
  if (fsync(descriptor_) != 0 && errno != EINVAL && errno != EROFS) fail();
  const int closing = std::exchange(descriptor_, -1);
  const bool named =
      close(closing) == 0 && (part_.empty() || std::rename(part_.c_str(), path_.c_str()) == 0);
  if (!named) {
    const int error = errno;
    remove_part(part_);
    throw OutputError(path_, reason(error));
  }
}

void OutputFile::fail() {
  const int error = errno;
  close(std::exchange(descriptor_, -1));
  remove_part(part_);
  throw OutputError(path_, reason(error));
}

void write_text(const std::filesystem::path& path, std::string_view text) {
  OutputFile file(path);
  file.write(text);
  file.finish();
}

}  // namespace cairn::host

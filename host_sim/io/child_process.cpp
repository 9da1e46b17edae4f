#include "host_sim/io/child_process.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>

#include <fmt/format.h>

namespace cairn::host {
namespace {

constexpr int kCodeOfSignals = 128;

/// A file without a name, in memory: unlike a pipe it takes any length while nobody reads.
class MemoryFile {
 public:
  MemoryFile() : descriptor_(memfd_create("cairn", MFD_CLOEXEC)) {
    if (descriptor_ < 0) fail();
  }
  ~MemoryFile() { close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  int descriptor() const { return descriptor_; }

  /// To be read from its beginning.
  void fill(const std::string& text) {
    std::size_t done = 0;
    while (done < text.size()) {
      const ssize_t count = write(descriptor_, text.data() + done, text.size() - done);
      if (count < 0) fail();
      done += static_cast<std::size_t>(count);
    }
    if (lseek(descriptor_, 0, SEEK_SET) != 0) fail();
  }

  std::string contents() const {
    std::string text;
    std::array<char, 4096> block{};
    for (;;) {
      const ssize_t count =
          pread(descriptor_, block.data(), block.size(), static_cast<off_t>(text.size()));
      if (count <= 0) return text;
      text.append(block.data(), static_cast<std::size_t>(count));
    }
  }

 private:
  [[noreturn]] static void fail() {
    throw std::system_error(errno, std::generic_category(), "file in memory");
  }

  int descriptor_;
};

/// What becomes of the child's three standard files.
class StandardFiles {
 public:
  StandardFiles(const MemoryFile& input, const MemoryFile& output, const MemoryFile& errors) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_adddup2(&actions_, input.descriptor(), STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions_, output.descriptor(), STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions_, errors.descriptor(), STDERR_FILENO);
  }
  ~StandardFiles() { posix_spawn_file_actions_destroy(&actions_); }
  StandardFiles(const StandardFiles&) = delete;
  StandardFiles& operator=(const StandardFiles&) = delete;

  const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

int wait_for(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) throw std::system_error(errno, std::generic_category(), "waitpid");
  }
  return status;
}

std::string last_line(const std::string& text) {
  const std::size_t last = text.find_last_not_of(" \n\r\t");
  if (last == std::string::npos) return {};
  const std::size_t before = text.find_last_of('\n', last);
  const std::size_t first = before == std::string::npos ? 0 : before + 1;
  return text.substr(first, last + 1 - first);
}

}  // namespace

bool ChildEnd::not_found() const {
  return start_error == ENOENT || start_error == ENOTDIR;
}

int ChildEnd::fatal_signal() const {
  if (signal != 0) return signal;
  const int from_code = code - kCodeOfSignals;
  return sigabbrev_np(from_code) != nullptr ? from_code : 0;
}

ChildEnd run_child(const std::vector<std::string>& command, const std::string& input) {
  MemoryFile input_file;
  const MemoryFile output_file;
  const MemoryFile errors_file;
  input_file.fill(input);
  const StandardFiles files(input_file, output_file, errors_file);
  std::vector<std::string> words = command;
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  ChildEnd end;
  pid_t child = 0;
  end.start_error =
      posix_spawnp(&child, arguments.front(), files.get(), nullptr, arguments.data(), environ);
  if (end.start_error != 0) return end;
  const int status = wait_for(child);
  if (WIFSIGNALED(status)) end.signal = WTERMSIG(status);
  if (WIFEXITED(status)) end.code = WEXITSTATUS(status);
  end.output = output_file.contents();
  end.errors = errors_file.contents();
  return end;
}

std::string describe(const ChildEnd& end) {
  if (end.start_error != 0) {
    return fmt::format("cannot be started ({})", std::generic_category().message(end.start_error));
  }
  const int signal = end.fatal_signal();
  std::string text = end.signal != 0 ? fmt::format("was ended by signal {}", end.signal)
                                     : fmt::format("ended with code {}", end.code);
  const char* name = sigdescr_np(signal);  // none for 0 and for signals that programs define
  if (name != nullptr) text += fmt::format(" ({})", name);
  const std::string line = last_line(end.errors);
  return line.empty() ? text : fmt::format("{}: {}", text, line);
}

}  // namespace cairn::host

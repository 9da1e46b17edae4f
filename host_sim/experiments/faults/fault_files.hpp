#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace cairn::host {

/// A file in a folder of its own for a reader to fail on; gone with the object.
class FaultFile {
 public:
  FaultFile(const std::string& name, const std::string& contents);
  ~FaultFile();
  FaultFile(const FaultFile&) = delete;
  FaultFile& operator=(const FaultFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// `message` with the file's name alone.
  std::string without_folder(const std::string& message) const;

 private:
  std::filesystem::path folder_;
  std::filesystem::path path_;
};

/// Bytes in memory as sink and source of maps and logs.
struct FaultBytes {
  std::vector<std::uint8_t> bytes;
  std::size_t position = 0;

  bool write(const std::uint8_t* from, int count);
  int read(std::uint8_t* to, int count);
};

}  // namespace cairn::host

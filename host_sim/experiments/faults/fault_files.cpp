#include "host_sim/experiments/faults/fault_files.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "host_sim/io/input_error.hpp"

namespace cairn::host {

FaultFile::FaultFile(const std::string& name, const std::string& contents) {
  std::string pattern = (std::filesystem::temp_directory_path() / "cairn-fault-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw InputError(pattern, "cannot be created");
  folder_ = pattern;
  path_ = folder_ / name;
  std::ofstream(path_, std::ios::binary) << contents;
}

FaultFile::~FaultFile() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

std::string FaultFile::without_folder(const std::string& message) const {
  std::string result = message;
  const std::string folder = folder_.string() + "/";
  const std::size_t at = result.find(folder);
  if (at != std::string::npos) result.erase(at, folder.size());
  return result;
}

bool FaultBytes::write(const std::uint8_t* from, int count) {
  bytes.insert(bytes.end(), from, from + count);
  return true;
}

int FaultBytes::read(std::uint8_t* to, int count) {
  const std::size_t left = std::min(static_cast<std::size_t>(count), bytes.size() - position);
  std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(position), left, to);
  position += left;
  return static_cast<int>(left);
}

}  // namespace cairn::host

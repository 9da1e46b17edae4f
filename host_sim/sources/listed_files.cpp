#include "host_sim/sources/listed_files.hpp"

#include <fmt/format.h>

#include "host_sim/io/input_error.hpp"

namespace cairn::host {

std::filesystem::path inside_folder(const std::filesystem::path& file,
                                    const std::filesystem::path& list, int line) {
  std::filesystem::path plain = file.lexically_normal();
  if (plain.is_absolute() || plain.empty() || *plain.begin() == "..") {
    throw InputError(
        list, line,
        fmt::format("expected a file inside the list's folder, found '{}'", file.string()));
  }
  return plain;
}

}  // namespace cairn::host

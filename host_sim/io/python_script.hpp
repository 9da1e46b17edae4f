#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace cairn::host {

/// A Python script that draws with matplotlib, carried inside the program so that it needs no file
/// of its own (cairn_embed_script() in host_sim/CMakeLists.txt). Its argument is a folder; it ends
/// with code 4 where there is no matplotlib.
struct PythonScript {
  const char* name;
  const char* const* texts;  ///< its parts and itself, one after the other
  std::size_t count;
};

/// Lets `script` make `product` from the files in `folder`, with the python3 in PATH or, where that
/// has no matplotlib, Debian's own. Nothing on success, else a sentence that says what is missing:
/// the numbers are complete without pictures.
std::optional<std::string> draw_with_python(const std::string& product, const PythonScript& script,
                                            const std::filesystem::path& folder);

}  // namespace cairn::host

#pragma once

#include <filesystem>

namespace cairn::host {

/// A file that line `line` of `list` names, relative to the list's folder. Throws InputError for a
/// path that leads out of it.
std::filesystem::path inside_folder(const std::filesystem::path& file,
                                    const std::filesystem::path& list, int line);

}  // namespace cairn::host

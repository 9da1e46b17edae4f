#pragma once

#include <string>

namespace cairn::host {

/// The source that a file or folder is when its kind was not named: that of the data set whose
/// files the folder holds, otherwise `video:`. Empty where `path` does not exist.
std::string source_of_path(const std::string& path);

}  // namespace cairn::host

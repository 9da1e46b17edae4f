#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

namespace cairn::host {

/// The text of a file of keys and values, at most 8 MB; `what` names it in messages. Throws
/// InputError as read_text().
std::string read_config_text(const std::filesystem::path& path, const std::string& what);

/// Keys and values as a tree of objects, arrays and strings (numbers too are the text of the file;
/// nothing is null). Parsed are YAML, JSON, and OpenCV's FileStorage in YAML (`%YAML:1.0`) and XML,
/// where a matrix is an object of rows, cols and data. `path` is for messages.
///
/// Throws InputError naming file and line for a text that is malformed, holds more than one
/// document, a key twice, an alias, more than 32 levels or more than 500,000 values: no calibration
/// does, and hostile files do.
nlohmann::json parse_config_document(const std::filesystem::path& path, const std::string& text);

}  // namespace cairn::host

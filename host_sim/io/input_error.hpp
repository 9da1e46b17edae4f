#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace cairn::host {

/// An input that cannot be read or is invalid. `what()` reads
/// `FILE[:LINE]: ['KEY': ]PROBLEM`, where the problem says what was expected. The program ends with
/// exit code 3.
class InputError : public std::runtime_error {
 public:
  InputError(const std::filesystem::path& file, const std::string& problem);
  /// `line` counts from 1.
  InputError(const std::filesystem::path& file, int line, const std::string& problem);
  InputError(const std::filesystem::path& file, const std::string& key, const std::string& problem);
};

/// Options that do not go together, found after parsing. The program ends with exit code 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace cairn::host

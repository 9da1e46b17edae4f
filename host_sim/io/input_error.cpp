#include "host_sim/io/input_error.hpp"

#include <fmt/format.h>

namespace cairn::host {

InputError::InputError(const std::filesystem::path& file, const std::string& problem)
    : std::runtime_error(fmt::format("{}: {}", file.string(), problem)) {}

InputError::InputError(const std::filesystem::path& file, int line, const std::string& problem)
    : std::runtime_error(fmt::format("{}:{}: {}", file.string(), line, problem)) {}

InputError::InputError(const std::filesystem::path& file, const std::string& key,
                       const std::string& problem)
    : std::runtime_error(fmt::format("{}: key '{}': {}", file.string(), key, problem)) {}

}  // namespace cairn::host

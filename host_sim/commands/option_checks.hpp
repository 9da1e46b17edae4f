#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace cairn::host {

/// Checks of an option's number, with messages that say what was expected.
CLI::Validator above_zero();
/// A whole number from 1.
CLI::Validator count();
CLI::Validator not_negative();
/// A number from `low` to `high`: CLI::Range alone would take nan for one.
CLI::Validator between(double low, double high);
/// A whole number of 64 bits without sign: CLI11 alone would take -3 for 2^64 - 3.
CLI::Validator seed_number();

/// Long names of the options that the command line gives.
std::vector<std::string> given_options(const CLI::App& command);

}  // namespace cairn::host

#pragma once

#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace cairn::host {

/// The one of `known` that `word` was meant to be: the fewest letters to insert, leave out, change
/// or swap (Damerau 1964), a third of the word at most. None where no word is so near.
std::optional<std::string> nearest_word(const std::string& word,
                                        const std::vector<std::string>& known);

/// "; did you mean 'WORD'?", or empty.
std::string did_you_mean(const std::string& word, const std::vector<std::string>& known);

/// Names of the commands.
std::vector<std::string> command_names(const CLI::App& app);

/// --NAME of every option of a command.
std::vector<std::string> option_names(const CLI::App& command);

/// A message of CLI11 on a value that is not in an option's list, in the words of all others and
/// with the nearest value; any other message as it is.
std::string with_suggestion(const std::string& message);

/// What is wrong with the words of a command line as far as names go: an unknown command or option,
/// with the nearest known one. Empty: nothing. `arguments` without the program's name.
std::string unknown_word(const CLI::App& app, const std::vector<std::string>& arguments);

}  // namespace cairn::host

#include "host_sim/commands/suggestion.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace cairn::host {
namespace {

constexpr std::size_t kLettersPerMistake = 3;

/// Optimal string alignment distance.
std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t k = 0; k <= b.size(); ++k) {
      if (i == 0 || k == 0) {
        d[i][k] = i + k;
        continue;
      }
      d[i][k] = std::min(
          {d[i - 1][k] + 1, d[i][k - 1] + 1, d[i - 1][k - 1] + (a[i - 1] == b[k - 1] ? 0U : 1U)});
      if (i > 1 && k > 1 && a[i - 1] == b[k - 2] && a[i - 2] == b[k - 1]) {
        d[i][k] = std::min(d[i][k], d[i - 2][k - 2] + 1);
      }
    }
  }
  return d[a.size()][b.size()];
}

}  // namespace

std::optional<std::string> nearest_word(const std::string& word,
                                        const std::vector<std::string>& known) {
  std::optional<std::string> nearest;
  std::size_t least = std::max<std::size_t>(1, word.size() / kLettersPerMistake) + 1;
  for (const std::string& candidate : known) {
    const std::size_t d = distance(word, candidate);
    if (d >= least) continue;
    least = d;
    nearest = candidate;
  }
  return nearest;
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& known) {
  const auto nearest = nearest_word(word, known);
  return nearest ? fmt::format("; did you mean '{}'?", *nearest) : std::string();
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands(nullptr)) {
    names.push_back(command->get_name());
    const std::vector<std::string>& aliases = command->get_aliases();
    names.insert(names.end(), aliases.begin(), aliases.end());
  }
  return names;
}

std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

std::string with_suggestion(const std::string& message) {
  const std::string middle = " not in {";
  const std::size_t list = message.find(middle);
  const std::size_t option = message.find(": ");
  const std::size_t end = message.find('}', list);
  if (list == std::string::npos || end == std::string::npos || option >= list) return message;
  const std::string word = message.substr(option + 2, list - option - 2);
  const std::size_t first = list + middle.size();
  const std::vector<std::string> known =
      CLI::detail::split(message.substr(first, end - first), ',');
  return fmt::format("{}: expected one of {}, found '{}'{}{}", message.substr(0, option),
                     fmt::join(known, ", "), word, did_you_mean(word, known),
                     message.substr(end + 1));
}

std::string unknown_word(const CLI::App& app, const std::vector<std::string>& arguments) {
  if (arguments.empty() || arguments[0].empty() || arguments[0][0] == '-') return {};
  const std::vector<std::string> commands = command_names(app);
  if (std::find(commands.begin(), commands.end(), arguments[0]) == commands.end()) {
    std::vector<std::string> known = {"--version", "--help"};  // as near as 'vision' to 'version'
    known.insert(known.end(), commands.begin(), commands.end());
    return fmt::format("unknown command '{}': expected one of {}{}", arguments[0],
                       fmt::join(commands, ", "), did_you_mean(arguments[0], known));
  }
  const std::vector<std::string> options = option_names(*app.get_subcommand(arguments[0]));
  for (const std::string& argument : arguments) {
    if (argument == "--") break;
    const std::string name = argument.substr(0, argument.find('='));
    if (name.rfind("--", 0) != 0) continue;
    if (std::find(options.begin(), options.end(), name) != options.end()) continue;
    return fmt::format("{}: unknown option '{}'{}", arguments[0], name,
                       did_you_mean(name, options));
  }
  return {};
}

}  // namespace cairn::host

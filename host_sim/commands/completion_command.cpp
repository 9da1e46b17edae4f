#include "host_sim/commands/completion_command.hpp"

#include <memory>

#include <fmt/format.h>

#include "host_sim/commands/run_kinds.hpp"
#include "host_sim/commands/suggestion.hpp"

namespace cairn::host {
namespace {

constexpr const char* kShells = "bash zsh";

/// The values of an option that takes one of a list, as CLI11 shows them: TEXT:{a,b}.
std::vector<std::string> values_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{');
  const std::size_t close = type.find('}', open == std::string::npos ? 0 : open);
  if (open == std::string::npos || close == std::string::npos) return {};
  return CLI::detail::split(type.substr(open + 1, close - open - 1), ',');
}

std::string sources() {
  std::string words;
  for (const RunKind& kind : run_kinds()) {
    words += fmt::format(" {}{}", kind.name, kind.argument.empty() ? "" : ":");
  }
  return words;
}

/// Lines of the two `case`s: values by "COMMAND OPTION", and words by COMMAND.
std::string values_cases(const CLI::App& app) {
  std::string text;
  for (const CLI::App* command : app.get_subcommands(nullptr)) {
    for (const CLI::Option* option : command->get_options()) {
      const std::vector<std::string> values = values_of(*option);
      if (values.empty() || option->get_lnames().empty()) continue;
      text += fmt::format("    '{} --{}') words='{}' ;;\n", command->get_name(),
                          option->get_lnames().front(), fmt::join(values, " "));
    }
  }
  return text;
}

std::string words_cases(const CLI::App& app) {
  std::string text;
  for (const CLI::App* command : app.get_subcommands(nullptr)) {
    const std::string name = command->get_name();
    std::string plain;
    if (command->get_option_no_throw("SOURCE") != nullptr) plain = sources();
    if (name == "help") plain = fmt::format(" {}", fmt::join(command_names(app), " "));
    if (name == "completion") plain = kShells;
    text += fmt::format("      {})\n        options='{}'\n        plain='{}' ;;\n", name,
                        fmt::join(option_names(*command), " "), plain);
  }
  return text;
}

std::string script(const CLI::App& app, bool for_zsh) {
  std::string text = "# Completion of cairn_sim. bash: source it. zsh: the same, after compinit.\n";
  if (for_zsh) text += "autoload -U +X bashcompinit && bashcompinit\n";
  text +=
      "_cairn_sim() {\n"
      "  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]}\n"
      "  local words='' options='' plain=''\n"
      "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n";
  text += fmt::format("    COMPREPLY=($(compgen -W '{} --help --version' -- \"$cur\"))\n",
                      fmt::join(command_names(app), " "));
  text +=
      "    return\n"
      "  fi\n"
      "  case \"${COMP_WORDS[1]} $prev\" in\n";
  text += values_cases(app);
  text +=
      "  esac\n"
      "  if [ -z \"$words\" ]; then\n"
      "    case \"${COMP_WORDS[1]}\" in\n";
  text += words_cases(app);
  text +=
      "    esac\n"
      "    case \"$cur\" in\n"
      "      -*) words=$options ;;\n"
      "      *) case \"$prev\" in -*) words='' ;; *) words=$plain ;; esac ;;\n"
      "    esac\n"
      "  fi\n"
      "  COMPREPLY=($(compgen -W \"$words\" -- \"$cur\"))\n"
      "  case \"${COMPREPLY[0]-}\" in\n"
      "    *:) type compopt >/dev/null 2>&1 && compopt -o nospace 2>/dev/null ;;\n"
      "  esac\n"
      "  return 0\n"
      "}\n"
      "complete -o default -F _cairn_sim cairn_sim\n";
  return text;
}

}  // namespace

void register_completion_command(CommandContext& context) {
  CLI::App* command =
      context.app.add_subcommand("completion", "Print a script that completes in a shell");
  const auto shell = std::make_shared<std::string>();
  command->add_option("SHELL", *shell, "Which shell")
      ->required()
      ->check(CLI::IsMember(CLI::detail::split(kShells, ' ')));
  command->callback(
      [&context, shell] { fmt::print("{}", script(context.app, shell->front() == 'z')); });
}

}  // namespace cairn::host

#include "host_sim/commands/help_command.hpp"

#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "host_sim/commands/suggestion.hpp"
#include "host_sim/io/input_error.hpp"

namespace cairn::host {

void register_help_command(CommandContext& context) {
  CLI::App* command = context.app.add_subcommand("help", "Print the options of a command");
  const auto name = std::make_shared<std::string>();
  command->add_option("COMMAND", *name, "Which one; without it, the commands");
  command->callback([&context, name] {
    if (name->empty()) {
      // App::help() would print that of this command: it is the one that was given.
      const CLI::App& app = context.app;
      fmt::print("{}",
                 app.get_formatter()->make_help(&app, app.get_name(), CLI::AppFormatMode::Normal));
      return;
    }
    const std::vector<std::string> known = command_names(context.app);
    if (std::find(known.begin(), known.end(), *name) == known.end()) {
      throw UsageError(fmt::format("unknown command '{}': expected one of {}{}", *name,
                                   fmt::join(known, ", "), did_you_mean(*name, known)));
    }
    fmt::print("{}", context.app.get_subcommand(*name)->help());
  });
}

}  // namespace cairn::host

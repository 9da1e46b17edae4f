#include <cerrno>
#include <csignal>
#include <cstdio>
#include <exception>
#include <iostream>
#include <string>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "cairn/version.hpp"

#include "host_sim/commands/command.hpp"
#include "host_sim/commands/suggestion.hpp"
#include "host_sim/io/image_file.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/io/jpeg_check.hpp"
#include "host_sim/io/number_text.hpp"
#include "host_sim/io/output_file.hpp"

namespace {

using cairn::host::ExitCode;

/// As a shell takes it for one word: in quotes where it has characters with a meaning.
std::string as_word(const std::string& argument) {
  constexpr const char* kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=.,:/@%";
  if (!argument.empty() && argument.find_first_not_of(kPlain) == std::string::npos) return argument;
  std::string word = "'";
  for (const char c : argument) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

/// The command line of the manifest, which can be pasted into a shell.
std::string join_arguments(int argc, char** argv) {
  std::string line = "cairn_sim";
  for (int i = 1; i < argc; ++i) line += " " + as_word(argv[i]);
  return line;
}

/// Says what went wrong, and gives the code back.
ExitCode failed(const std::exception& error, ExitCode code) {
  fmt::print(stderr, "cairn_sim: {}\n", cairn::host::with_short_numbers(error.what()));
  return code;
}

ExitCode run(int argc, char** argv) {
  cairn::host::set_jpeg_check(cairn::host::find_jpeg_damage);
  CLI::App app{"Cairn on the host: worlds, data sets, experiments and reports", "cairn_sim"};
  app.set_version_flag("--version", std::string("cairn_sim ") + cairn::kVersion);
  app.require_subcommand(1);
  app.failure_message([](const CLI::App* command, const CLI::Error& error) {
    return cairn::host::with_suggestion(
        cairn::host::with_short_numbers(CLI::FailureMessage::simple(command, error)));
  });
  cairn::host::CommandContext context{app, join_arguments(argc, argv)};
  cairn::host::register_commands(context);
  try {
    const std::string unknown =
        cairn::host::unknown_word(app, std::vector<std::string>(argv + 1, argv + argc));
    if (!unknown.empty()) throw cairn::host::UsageError(unknown);
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? ExitCode::kOk : ExitCode::kUsage;
  } catch (const cairn::host::UsageError& error) {
    return failed(error, ExitCode::kUsage);
  } catch (const cairn::host::InputError& error) {
    return failed(error, ExitCode::kInputInvalid);
  } catch (const cairn::host::OutputError& error) {
    return failed(error, ExitCode::kOutputFailed);
  }
  return context.exit_code;
}

/// What was printed must have arrived: a pipe's reader is gone, or a disk is full.
ExitCode with_printed(ExitCode code) {
  std::cout.flush();
  const bool printed = std::cout.good() && std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  if (printed) return code;
  std::fprintf(stderr, "cairn_sim: standard output cannot be written\n");
  return code == ExitCode::kOk ? ExitCode::kOutputFailed : code;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a limit of a file's size is an error of writing
  try {
    return static_cast<int>(with_printed(run(argc, argv)));
  } catch (const std::system_error& error) {
    std::fprintf(stderr, "cairn_sim: %s\n", error.what());
    const bool full = error.code().value() == ENOSPC || error.code().value() == EDQUOT;
    return static_cast<int>(full ? ExitCode::kOutputFailed : ExitCode::kCheckFailed);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "cairn_sim: %s\n", error.what());
    return static_cast<int>(ExitCode::kCheckFailed);
  }
}

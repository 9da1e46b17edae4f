#include "host_sim/io/child_process.hpp"

#include <csignal>

#include <gtest/gtest.h>

namespace cairn::host {
namespace {

/// The command line of the child itself; the product starts no shell.
ChildEnd run_script(const std::string& script) {
  return run_child({"sh", "-c", script});
}

TEST(ChildProcess, ArgumentsArriveAsTheyAre) {
  const ChildEnd end =
      run_child({"printf", "%s|", "o'; touch X; echo '", "\"$(touch Y)\"", "", "*"});
  EXPECT_TRUE(end.succeeded());
  EXPECT_EQ(end.output, "o'; touch X; echo '|\"$(touch Y)\"||*|");
}

TEST(ChildProcess, AnyLengthGoesInAndOut) {
  const std::string text(3000000, 'x');
  const ChildEnd end = run_child({"cat"}, text);
  EXPECT_TRUE(end.succeeded());
  EXPECT_TRUE(end.output == text);
  EXPECT_EQ(run_child({"cat"}).output, "");
}

TEST(ChildProcess, SaysHowItEnded) {
  const ChildEnd code = run_script("echo out; echo first >&2; echo last >&2; exit 3");
  EXPECT_FALSE(code.succeeded());
  EXPECT_EQ(code.code, 3);
  EXPECT_EQ(code.output, "out\n");
  EXPECT_EQ(code.errors, "first\nlast\n");
  EXPECT_EQ(code.fatal_signal(), 0);
  EXPECT_EQ(describe(code), "ended with code 3: last");
  EXPECT_EQ(describe(run_script("exit 200")), "ended with code 200");
}

TEST(ChildProcess, KnowsASignalByItselfAndBehindAShell) {
  const ChildEnd itself = run_script("kill -ILL $$");
  EXPECT_FALSE(itself.succeeded());
  EXPECT_EQ(itself.signal, SIGILL);
  EXPECT_EQ(itself.fatal_signal(), SIGILL);
  EXPECT_EQ(describe(itself), "was ended by signal 4 (Illegal instruction)");
  const ChildEnd behind = run_script("exit 132");
  EXPECT_EQ(behind.signal, 0);
  EXPECT_EQ(behind.fatal_signal(), SIGILL);
  EXPECT_EQ(describe(behind), "ended with code 132 (Illegal instruction)");
}

TEST(ChildProcess, SaysWhyItWasNotStarted) {
  const ChildEnd missing = run_child({"no-such-program"});
  EXPECT_FALSE(missing.succeeded());
  EXPECT_TRUE(missing.not_found());
  EXPECT_EQ(describe(missing), "cannot be started (No such file or directory)");
  const ChildEnd folder = run_child({"/"});
  EXPECT_FALSE(folder.not_found());
  EXPECT_EQ(describe(folder), "cannot be started (Permission denied)");
}

}  // namespace
}  // namespace cairn::host

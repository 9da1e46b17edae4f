// Runs every registered test and prints what failed; exit status 1 when something did.

#include <gtest/gtest.h>

#include "tests/target/text.hpp"

namespace testing::internal {
namespace {

Case* tests = nullptr;
int failures = 0;

}  // namespace

void print(const char* text) {
  cairn_test::write(text);
}

void print(bool value) {
  print(value ? "true" : "false");
}

void print(std::uint64_t value) {
  cairn_test::write_decimal(value);
}

void print(std::int64_t value) {
  if (value < 0) print("-");
  print(value < 0 ? 0U - static_cast<std::uint64_t>(value) : static_cast<std::uint64_t>(value));
}

/// Nine digits and a power of ten.
void print(double value) {
  if (!(value == value)) return print("nan");
  if (value < 0) {
    print("-");
    value = -value;
  }
  if (value > 1.7e308) return print("infinity");
  int exponent = 0;
  while (value >= 1e9) {
    value /= 10;
    ++exponent;
  }
  while (value > 0 && value < 1e8 && exponent > -330) {
    value *= 10;
    --exponent;
  }
  print(static_cast<std::uint64_t>(value));
  print("e");
  print(static_cast<std::int64_t>(exponent));
}

bool add(Case& test, const char* suite, const char* name, void (*run)()) {
  test = {suite, name, run, tests};
  tests = &test;
  return true;
}

void note_failure(const char* file, int line, const char* text) {
  ++failures;
  print(file);
  print(":");
  print(static_cast<std::int64_t>(line));
  print(": expected ");
  print(text);
}

}  // namespace testing::internal

int main() {
  using namespace testing::internal;
  int failed = 0;
  int count = 0;
  for (const Case* test = tests; test != nullptr; test = test->next) {
    const int before = failures;
    test->run();
    ++count;
    if (failures == before) continue;
    ++failed;
    print("FAILED ");
    print(test->suite);
    print(".");
    print(test->name);
    print("\n");
  }
  print(static_cast<std::int64_t>(count));
  print(" tests, ");
  print(static_cast<std::int64_t>(failed));
  print(" failed\n");
  return failed == 0 && count > 0 ? 0 : 1;
}

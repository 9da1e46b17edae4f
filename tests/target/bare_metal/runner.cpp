// Runs every registered test and prints what failed; exit status 1 when something did.

#include <gtest/gtest.h>

#include "tests/target/text.hpp"

namespace testing::internal {
namespace {

Case* tests = nullptr;
int failures = 0;
bool fatal_failure = false;

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

bool add(Case& test, const Case& filling) {
  test = filling;
  test.next = tests;
  tests = &test;
  return true;
}

void note_failure(const char* file, int line, const char* text, bool fatal) {
  ++failures;
  fatal_failure = fatal_failure || fatal;
  print(file);
  print(":");
  print(static_cast<std::int64_t>(line));
  print(": expected ");
  print(text);
}

}  // namespace testing::internal

bool testing::Test::HasFatalFailure() {
  return internal::fatal_failure;
}

void testing::Test::RecordProperty(const char* key, int value) {
  internal::print(key);
  internal::print(" ");
  internal::print(static_cast<std::int64_t>(value));
  internal::print("\n");
}

int main() {
  using namespace testing::internal;
  int failed = 0;
  int count = 0;
  const Case* suite = nullptr;
  for (const Case* test = tests; test != nullptr; test = test->next) {
    if (suite == nullptr || suite->set_up_suite != test->set_up_suite) {
      if (suite != nullptr) suite->tear_down_suite();
      test->set_up_suite();
      suite = test;
    }
    const int before = failures;
    fatal_failure = false;
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
  if (suite != nullptr) suite->tear_down_suite();
  print(static_cast<std::int64_t>(count));
  print(" tests, ");
  print(static_cast<std::int64_t>(failed));
  print(" failed\n");
  return failed == 0 && count > 0 ? 0 : 1;
}

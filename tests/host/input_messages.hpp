#pragma once

#include <initializer_list>
#include <string>

#include <gtest/gtest.h>

#include "host_sim/io/input_error.hpp"

namespace cairn::host {

/// What the InputError of `action` says, or "no error".
template <class Action>
std::string message_of(Action action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

/// Whether `message` holds every part.
inline testing::AssertionResult says(const std::string& message,
                                     std::initializer_list<const char*> parts) {
  for (const char* part : parts) {
    if (message.find(part) == std::string::npos) {
      return testing::AssertionFailure() << "'" << part << "' is not in: " << message;
    }
  }
  return testing::AssertionSuccess();
}

}  // namespace cairn::host

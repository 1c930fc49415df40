// What errors say, and what those about input have to be like.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"

namespace tetropolis::testing {

/// The message of the Error that `action` throws, of this kind if one is given; "" if there is
/// none.
template <typename Action>
std::string error_of(const Action& action, std::optional<ErrorKind> kind = std::nullopt) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind.value_or(error.kind())) << error.what();
    return error.what();
  }
  return "";
}

/// The message of the Error(kInput) that `action` throws; checks that it is one line with the path.
template <typename Action>
std::string input_error(const std::filesystem::path& path, const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_EQ(error.kind(), ErrorKind::kInput) << message;
    EXPECT_NE(message.find(path.string()), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message;
  }
  ADD_FAILURE() << path << ": no error";
  return "";
}

}  // namespace tetropolis::testing

// What errors about input have to be like.
#pragma once

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"

namespace tetropolis::testing {

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

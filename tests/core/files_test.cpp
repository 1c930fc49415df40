#include "core/files.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "support/errors.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

TEST(Files, FilesFoldersAndWhatLinksLeadToAreThere) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path file = folder / "file";
  std::ofstream(file) << "x";
  EXPECT_TRUE(is_there(file));
  EXPECT_TRUE(is_there(folder.path()));
  EXPECT_FALSE(is_there(folder / "nothing"));
  // A part of the path is a file: nothing can be there, which is an answer.
  EXPECT_FALSE(is_there(file / "below"));
  std::filesystem::create_symlink(file, folder / "link");
  EXPECT_TRUE(is_there(folder / "link"));
  std::filesystem::create_symlink(folder / "nothing", folder / "dangling");
  EXPECT_FALSE(is_there(folder / "dangling"));
}

TEST(Files, PathsThatCannotBeLookedAtAreErrorsThatNameThem) {
  const testing::TemporaryFolder folder;
  // These also stop those who may enter any folder.
  const std::filesystem::path loop = folder / "loop";
  std::filesystem::create_symlink(loop, loop);
  const std::filesystem::path endless = folder / std::string(5000, 'x');
  for (const std::filesystem::path& path : {loop, endless}) {
    const std::string message = testing::input_error(path, [&] { is_there(path); });
    EXPECT_NE(message.find(": cannot be read: "), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace tetropolis

// Where the tests find real data, and a scratch folder of their own.
#pragma once

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

namespace tetropolis::testing {

/// The folder named by TETROPOLIS_DATA joined with `relative`, a file of a data set; empty if the
/// variable is unset or the data set is not there. Throws std::runtime_error if only the file is
/// not.
std::filesystem::path data_path(const std::string& relative);

/// A new empty folder, removed when the object goes.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// The seed of this process' random tests: TETROPOLIS_TEST_SEED, or below a million, drawn anew for
/// each process. A test that fails prints it.
unsigned test_seed();

}  // namespace tetropolis::testing

/// Sets `variable` to the data file, or skips the test where the data is absent.
#define TETROPOLIS_REQUIRE_DATA(variable, relative)                                  \
  const std::filesystem::path variable = ::tetropolis::testing::data_path(relative); \
  if (variable.empty()) GTEST_SKIP() << "needs TETROPOLIS_DATA with " << (relative)

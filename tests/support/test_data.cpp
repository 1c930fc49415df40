#include "test_data.h"

#include <cstdio>
#include <cstdlib>
#include <map>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>
#include <unistd.h>

namespace tetropolis::testing {

namespace fs = std::filesystem;

fs::path data_path(const std::string& relative) {
  const char* root = std::getenv("TETROPOLIS_DATA");
  if (root == nullptr || *root == '\0') return {};
  const fs::path path = fs::path(root) / relative;
  if (fs::exists(path)) return path;
  // Where the data set is there, a file that is not has a wrong name.
  if (fs::exists(fs::path(root) / *fs::path(relative).begin()))
    throw std::runtime_error(relative + " is not in its data set; TETROPOLIS_DATA is " + root);
  return {};
}

namespace {

/// Folders of this process. Death tests leave by exit, which destroys no local object.
class LiveFolders {
 public:
  ~LiveFolders() {
    std::error_code ignored;
    for (const auto& [path, process] : made_by_)
      if (process == ::getpid()) fs::remove_all(path, ignored);
  }
  void add(const fs::path& path) { made_by_[path] = ::getpid(); }
  void remove(const fs::path& path) { made_by_.erase(path); }

 private:
  std::map<fs::path, pid_t> made_by_;
};

LiveFolders& live_folders() {
  static LiveFolders folders;
  return folders;
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (fs::temp_directory_path() / "tetropolis-test-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make " + pattern);
  path_ = pattern;
  live_folders().add(path_);
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  live_folders().remove(path_);
}

namespace {

/// Tells the seed with every test that fails.
class SeedTeller : public ::testing::EmptyTestEventListener {
  void OnTestEnd(const ::testing::TestInfo& test) override {
    if (test.result()->Failed()) std::printf("repeat with TETROPOLIS_TEST_SEED=%u\n", test_seed());
  }
};

const bool told = [] {
  ::testing::UnitTest::GetInstance()->listeners().Append(new SeedTeller);  // which owns it
  return true;
}();

}  // namespace

unsigned test_seed() {
  static const unsigned seed = [] {
    const char* text = std::getenv("TETROPOLIS_TEST_SEED");
    return text == nullptr ? std::random_device{}() % 1000000U
                           : static_cast<unsigned>(std::strtoul(text, nullptr, 10));
  }();
  return seed;
}

}  // namespace tetropolis::testing

#include "support/test_data.h"

#include <cstdlib>
#include <stdexcept>

#include <unistd.h>

namespace tetropolis::testing {

namespace fs = std::filesystem;

fs::path data_path(const std::string& relative) {
  const char* root = std::getenv("TETROPOLIS_DATA");
  if (root == nullptr || *root == '\0') return {};
  fs::path path = fs::path(root) / relative;
  return fs::exists(path) ? path : fs::path{};
}

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (fs::temp_directory_path() / "tetropolis-test-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make " + pattern);
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

unsigned test_seed() {
  const char* text = std::getenv("TETROPOLIS_TEST_SEED");
  return text == nullptr ? 1U : static_cast<unsigned>(std::strtoul(text, nullptr, 10));
}

}  // namespace tetropolis::testing

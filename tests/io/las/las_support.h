// What the tests of the LAS reader share.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"
#include "tetropolis/io/las/las.h"

#include "support/bytes.h"
#include "support/errors.h"
#include "support/test_data.h"

namespace tetropolis::testing {

namespace fs = std::filesystem;

template <typename Number>
std::string patched(std::string bytes, std::size_t at, Number value) {
  std::string number(sizeof value, '\0');
  std::memcpy(number.data(), &value, sizeof value);
  return bytes.replace(at, sizeof value, number);
}

inline PointsInput read_one(const fs::path& path, const ReadPointsOptions& options = {}) {
  const std::vector<fs::path> paths = {path};
  return read_points(paths, options);
}

/// Everything: no class left out.
inline ReadPointsOptions all_points() {
  ReadPointsOptions options;
  options.skipped_classes.clear();
  options.keep_withheld = true;
  return options;
}

inline std::string read_error(const fs::path& path) {
  return input_error(path, [&] { read_one(path); });
}

inline bool same(const PointCloud& a, const PointCloud& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z && a.classification == b.classification;
}

inline PointCloud random_cloud(std::size_t size, int largest_class) {
  std::mt19937 random(test_seed());
  std::uniform_real_distribution<double> xy(0, 500);
  std::uniform_real_distribution<double> z(-5, 60);
  std::uniform_int_distribution<int> code(0, largest_class);
  PointCloud cloud;
  for (std::size_t i = 0; i < size; ++i) {
    cloud.x.push_back(xy(random));
    cloud.y.push_back(xy(random));
    cloud.z.push_back(z(random));
    cloud.classification.push_back(static_cast<std::uint8_t>(code(random)));
  }
  return cloud;
}

}  // namespace tetropolis::testing

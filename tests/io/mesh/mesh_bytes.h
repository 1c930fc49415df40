// What the tests of the mesh formats share: a mesh, what a volume file must hold of it, and a
// cursor that reads binary files by hand.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"
#include "tetropolis/io/mesh/vtk.h"
#include "tetropolis/volume/column/boundary.h"

#include "support/bytes.h"
#include "support/explicit_mesh.h"
#include "support/small_city.h"

namespace tetropolis::testing {

/// As they lie in memory.
template <typename Number>
std::string bytes_of_numbers(const std::vector<Number>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)};
}

/// Reads bytes in order; running over the end throws.
class Cursor {
 public:
  explicit Cursor(std::string bytes) : bytes_(std::move(bytes)) {}
  explicit Cursor(const std::filesystem::path& path) : bytes_(bytes_of(path)) {}

  template <typename Number>
  Number take() {
    Number value{};
    std::memcpy(&value, need(sizeof value), sizeof value);
    return value;
  }
  template <typename Number>
  std::vector<Number> take(std::size_t count) {
    std::vector<Number> values(count);
    if (count > 0) std::memcpy(values.data(), need(count * sizeof(Number)), count * sizeof(Number));
    return values;
  }
  std::string text(std::size_t count) { return {need(count), count}; }
  std::string line() {
    const std::size_t end = bytes_.find('\n', at_);
    if (end == std::string::npos) throw std::runtime_error("no end of line");
    std::string result = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    return result;
  }
  void expect(const std::string& wanted) {
    const std::string found = bytes_.substr(at_, wanted.size());
    if (found != wanted)
      throw std::runtime_error("'" + wanted + "' expected, '" + found + "' found");
    at_ += wanted.size();
  }
  /// Moves behind the next `mark` and returns what was before it.
  std::string until(const std::string& mark) {
    const std::size_t end = bytes_.find(mark, at_);
    if (end == std::string::npos) throw std::runtime_error("no '" + mark + "'");
    std::string result = bytes_.substr(at_, end - at_);
    at_ = end + mark.size();
    return result;
  }
  std::size_t left() const { return bytes_.size() - at_; }

 private:
  const char* need(std::size_t count) {
    if (count > left()) throw std::runtime_error("the file is too short");
    at_ += count;
    return bytes_.data() + at_ - count;
  }
  std::string bytes_;
  std::size_t at_ = 0;
};

using Point3 = std::array<double, 3>;

/// The corners of each boundary face as points.
inline std::vector<std::array<Point3, 3>> corners_of(const SurfaceMesh& surface,
                                                     const Point3& shift) {
  std::vector<std::array<Point3, 3>> corners;
  for (const auto& triangle : surface.triangles) {
    std::array<Point3, 3> face{};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t c = 0; c < 3; ++c)
        face[i][c] = surface.points[static_cast<std::size_t>(triangle[i])][c] + shift[c];
    corners.push_back(face);
  }
  return corners;
}

/// A city fine enough for writers to work in several pieces, made once.
struct FormatsCity {
  MeshedCity city = meshed(small_city(hills), 3);
  SurfaceMesh boundary = extract_boundary(city.mesh);
  Placement placement{{1000, 2000, 0}, {319000, 6396000, 0}};
};

inline const FormatsCity& formats_city() {
  static const FormatsCity city;
  return city;
}

/// Hills without a building.
inline const FormatsCity& formats_terrain() {
  static const FormatsCity terrain = [] {
    SmallCity city = small_city(hills);
    city.footprints.clear();
    city.roofs.clear();
    MeshedCity mesh = meshed(city, 20);
    SurfaceMesh boundary = extract_boundary(mesh.mesh);
    return FormatsCity{std::move(mesh), std::move(boundary), {}};
  }();
  return terrain;
}

}  // namespace tetropolis::testing

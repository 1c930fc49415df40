// A volume whose geometry is known: cubes above a chess board of heights, each cut into six tets.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <utility>

#include "tetropolis/volume/tet_mesh.h"

namespace tetropolis::testing {

/// Fields of 1 m from (0, 0); the air over field (i, j) goes from z = height(i, j) to `top`. Field
/// heights of 0 are ground, others roofs of building 0.
struct TerracedCity {
  static constexpr int kWidth = 12, kDepth = 9, kTop = 10;
  std::array<std::array<int, kDepth>, kWidth> height{};
  TetMesh mesh;
};

/// Heights from 0 to 6, as many 0 as others; fields at the rim are ground.
inline TerracedCity terraced_city(std::mt19937& random) {
  TerracedCity city;
  constexpr int nx = TerracedCity::kWidth, ny = TerracedCity::kDepth, nz = TerracedCity::kTop;
  for (int i = 1; i + 1 < nx; ++i)
    for (int j = 1; j + 1 < ny; ++j)
      city.height[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] =
          static_cast<int>(random() % 2 * (1 + random() % 6));
  const auto node = [](int i, int j, int k) {
    return static_cast<std::int64_t>((k * (ny + 1) + j) * (nx + 1) + i);
  };
  for (int k = 0; k <= nz; ++k)
    for (int j = 0; j <= ny; ++j)
      for (int i = 0; i <= nx; ++i)
        city.mesh.points.push_back(
            {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
  // Along the paths from (0, 0, 0) to (1, 1, 1) (Kuhn's division), which fits that of neighbours.
  constexpr std::array<std::array<int, 3>, 6> kOrders = {
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j) {
      const int h = city.height[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
      for (int k = h; k < nz; ++k)
        for (std::size_t o = 0; o < kOrders.size(); ++o) {
          std::array<int, 3> at{i, j, k};
          std::array<std::int64_t, 4> cell{node(i, j, k)};
          for (std::size_t step = 0; step < 3; ++step) {
            ++at[static_cast<std::size_t>(kOrders[o][step])];
            cell[step + 1] = node(at[0], at[1], at[2]);
          }
          if (o >= 3) std::swap(cell[1], cell[2]);  // odd orders are turned round
          city.mesh.cells.push_back(cell);
          city.mesh.region.push_back(h > 0 ? 0 : -1);
        }
    }
  return city;
}

}  // namespace tetropolis::testing

#include "tetropolis/volume/cell_zones.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include <fmt/format.h>

#include "tetropolis/geometry/polygon.h"
#include "tetropolis/volume/column/column_mesh.h"

#include "core/parallel.h"
#include "core/sort_once.h"
#include "geometry/grid_index.h"

namespace tetropolis {

namespace {

/// A cell's centroid: place, and height above the ground.
struct Centroid {
  Point2 place;
  double height = 0;
};

/// Canopies, to be asked which one has a cell.
class Canopies {
 public:
  explicit Canopies(std::span<const Canopy> canopies) : canopies_(canopies) {
    for (const Canopy& canopy : canopies) {
      boxes_.push_back(bounds(canopy.area));
      box_.extend(boxes_.back());
    }
    index_ = index_on_grid(boxes_.size(), box_,
                           [&](const SquareGrid& grid, std::size_t i, const auto& use) {
                             if (!boxes_[i].empty()) grid.for_each_in(boxes_[i], use);
                           });
  }

  /// Numbers of those whose box meets `box`, ascending.
  void find(const Bounds2& box, std::vector<std::size_t>& found) const {
    found.clear();
    if (!box.intersects(box_)) return;
    index_.grid.for_each_in(box, [&](std::size_t square) {
      for (const std::uint32_t i : index_.rows[square])
        if (boxes_[i].intersects(box)) found.push_back(i);
    });
    sort_once(found);
  }

  /// 1 + the number of the first of `among` that has the cell, or 0.
  std::int32_t zone(const std::vector<std::size_t>& among, const Centroid& cell) const {
    for (const std::size_t i : among) {
      const Canopy& canopy = canopies_[i];
      if (cell.height > canopy.base && cell.height <= canopy.height &&
          contains(canopy.area, cell.place))
        return static_cast<std::int32_t>(i) + 1;
    }
    return 0;
  }

 private:
  std::span<const Canopy> canopies_;
  std::vector<Bounds2> boxes_;
  Bounds2 box_ = Bounds2::nothing();
  GridIndex index_{SquareGrid({}, 0), {}};
};

/// Where the stack over a triangle begins at its corners.
std::array<double, 3> ground_at_corners(const ColumnMesh& mesh, TriangleIndex t) {
  const auto& corners = mesh.ground.triangles[t];
  std::array<double, 3> ground{};
  for (std::size_t c = 0; c < 3; ++c) {
    const NodeIndex lowest =
        mesh.has_layers(t) ? layer_node(mesh, corners[c], 0) : mesh.floor_over(t, corners[c]);
    ground[c] = elevation(mesh, lowest);
  }
  return ground;
}

/// The region of open ground around vertex v, if there is one.
RegionIndex open_region(const ColumnMesh& mesh, VertexIndex v) {
  for (const RegionIndex region : mesh.regions[v])
    if (!mesh.ground.regions[region].is_building()) return region;
  return kNoRegion;
}

void zone_stack(const ColumnMesh& mesh, const Canopies& canopies,
                const std::vector<std::size_t>& among, TriangleIndex t, CellIndex first_tet,
                std::size_t first_prism, std::vector<std::int32_t>& zones) {
  const auto& corners = mesh.ground.triangles[t];
  const std::array<double, 3> ground = ground_at_corners(mesh, t);
  std::array<Point2, 3> at{};
  for (std::size_t c = 0; c < 3; ++c) at[c] = mesh.ground.vertices[corners[c]];
  const auto centroid = [&](const std::array<int, 3>& uses, double sum_of_z) {
    Centroid centre;
    const double count = uses[0] + uses[1] + uses[2];
    for (std::size_t c = 0; c < 3; ++c) {
      centre.place.x += uses[c] * at[c].x / count;
      centre.place.y += uses[c] * at[c].y / count;
      centre.height -= uses[c] * ground[c] / count;
    }
    centre.height += sum_of_z / count;
    return centre;
  };
  auto tet = static_cast<std::size_t>(first_tet.value());
  for_each_tet_over(mesh, t, [&](const std::array<NodeIndex, 4>& nodes) {
    std::array<int, 3> uses{1, 1, 1};
    double sum = 0;
    for (const NodeIndex n : nodes) sum += elevation(mesh, n);
    for (std::size_t c = 0; c < 3; ++c)
      if (nodes[3] == nodes[c] + 1) ++uses[c];
    zones[tet++] = canopies.zone(among, centroid(uses, sum));
  });
  const std::int32_t prisms = prism_count(mesh, t);
  for (std::int32_t k = 0; k < prisms; ++k) {
    double sum = 0;
    for (const VertexIndex v : corners)
      sum += elevation(mesh, prism_node(mesh, t, v, k)) +
             elevation(mesh, prism_node(mesh, t, v, k + 1));
    zones[first_prism + static_cast<std::size_t>(k)] =
        canopies.zone(among, centroid({2, 2, 2}, sum));
  }
}

/// The cells of a block of the upper part, which canopies seldom reach.
void zone_upper(const ColumnMesh& mesh, const Canopies& canopies, std::size_t row, CellIndex first,
                std::vector<std::int32_t>& zones) {
  std::vector<std::size_t> among;
  auto cell = static_cast<std::size_t>(first.value());
  for_each_tet_of(mesh, row, [&](const std::array<NodeIndex, 4>& nodes) {
    const std::size_t own = cell++;
    Centroid centre;
    for (const NodeIndex n : nodes) {
      const std::int64_t above = n.value() - mesh.column_nodes();
      const VertexIndex v =
          above >= 0 ? mesh.upper.vertex[static_cast<std::size_t>(above)]
                     : VertexIndex(std::upper_bound(mesh.first.begin(), mesh.first.end(), n) -
                                   mesh.first.begin() - 1);
      const RegionIndex region = open_region(mesh, v);
      if (region == kNoRegion) return;
      const bool layered = mesh.layers.count > 0;
      const NodeIndex ground = layered ? layer_node(mesh, v, 0) : mesh.floor(region, v);
      const Point2 place = mesh.ground.vertices[v];
      centre.place.x += place.x / 4;
      centre.place.y += place.y / 4;
      centre.height += (elevation(mesh, n) - elevation(mesh, ground)) / 4;
    }
    canopies.find({centre.place.x, centre.place.y, centre.place.x, centre.place.y}, among);
    zones[own] = canopies.zone(among, centre);
  });
}

}  // namespace

CellZones zone_cells(const ColumnMesh& mesh, std::span<const Canopy> canopies) {
  CellZones result;
  if (canopies.empty()) return result;
  for (const Canopy& canopy : canopies)
    result.zones.push_back({fmt::format("canopy_{}", result.zones.size() + 1), canopy.height,
                            canopy.base, canopy.leaf_area_density, 0});
  const std::vector<CellIndex> offsets = cell_offsets(mesh);
  const auto tets = static_cast<std::size_t>(offsets.back().value());
  result.of_cell.assign(tets + static_cast<std::size_t>(mesh.layers.cells()), 0);
  const Canopies index(canopies);
  constexpr std::size_t kRows = 4096;
  parallel_chunks(offsets.size() - 1, kRows, [&](std::size_t begin, std::size_t end) {
    std::vector<std::size_t> among;
    for (std::size_t row = begin; row < end; ++row) {
      if (row >= mesh.triangle_count()) {
        zone_upper(mesh, index, row, offsets[row], result.of_cell);
        continue;
      }
      const TriangleIndex t(row);
      if (mesh.inside_building(t)) continue;
      std::array<Point2, 3> corners{};
      for (std::size_t c = 0; c < 3; ++c)
        corners[c] = mesh.ground.vertices[mesh.ground.triangles[t][c]];
      index.find(bounds(corners), among);
      if (among.empty()) continue;
      const auto prism =
          mesh.layers.offsets.empty() ? 0 : static_cast<std::size_t>(mesh.layers.offsets[row]);
      zone_stack(mesh, index, among, t, offsets[row], tets + prism, result.of_cell);
    }
  });
  for (const std::int32_t zone : result.of_cell)
    if (zone > 0) ++result.zones[static_cast<std::size_t>(zone) - 1].cells;
  return result;
}

}  // namespace tetropolis

#include <array>
#include <atomic>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "tetropolis/io/mesh/vtk.h"

#include "mesh_input.h"
#include "vtk_cells.h"
#include "vtk_input.h"

namespace tetropolis {

namespace {

/// Least number that was noted, from any thread.
class Least {
 public:
  void note(std::uint64_t i) {
    std::uint64_t seen = value_.load();
    while (i < seen && !value_.compare_exchange_weak(seen, i)) {
    }
  }
  bool any() const { return value_ != kNone; }
  std::uint64_t value() const { return value_; }

 private:
  static constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();
  std::atomic<std::uint64_t> value_{kNone};
};

void require_whole_numbers(const VtkInput& file, const VtkArray& array) {
  if (array.type == VtkType::kFloat64 || array.type == VtkType::kFloat32)
    file.fail("array " + array.name + " does not hold whole numbers");
}

/// The number of the first value that is not wanted(number), if any is noted.
template <typename Wanted>
void compare(const VtkInput& file, const VtkArray& array, const Wanted& wanted, Least& wrong) {
  require_whole_numbers(file, array);
  file.read(array, [&](std::uint64_t first, auto values) {
    for (std::size_t i = 0; i < values.size(); ++i)
      if (static_cast<std::int64_t>(values[i]) != wanted(first + i)) {
        wrong.note(first + i);
        return;
      }
  });
}

/// A value of the file as the type it is wanted in.
template <typename Value, typename Stored>
Value to(const VtkInput& file, const VtkArray& array, Stored stored) {
  if constexpr (std::is_integral_v<Stored> && std::is_integral_v<Value>)
    if (!std::in_range<Value>(stored))
      file.fail("array " + array.name + " has the value " + std::to_string(stored) +
                ", which is too large");
  return static_cast<Value>(stored);
}

/// Rows of `Width` values each.
template <std::size_t Width, typename Value>
std::vector<std::array<Value, Width>> read_rows(const VtkInput& file, const VtkArray& array,
                                                std::uint64_t rows) {
  std::vector<std::array<Value, Width>> result(rows);
  file.read(array, [&](std::uint64_t first, auto values) {
    std::uint64_t row = first / Width, column = first % Width;
    for (const auto value : values) {
      result[row][column] = to<Value>(file, array, value);
      if (++column < Width) continue;
      column = 0;
      ++row;
    }
  });
  return result;
}

std::vector<std::array<double, 3>> read_points(const VtkInput& file) {
  return read_rows<3, double>(file, file.array("Points", file.points() * 3), file.points());
}

/// Connectivity of cells with `Corners` vertices each, checked against the number of points.
template <std::size_t Corners, typename Index>
std::vector<std::array<Index, Corners>> read_cells(const VtkInput& file) {
  const VtkArray array = file.array("connectivity", file.cells() * Corners);
  require_whole_numbers(file, array);
  Least wrong;
  compare(
      file, file.array("offsets", file.cells()),
      [](std::uint64_t c) { return static_cast<std::int64_t>(Corners * (c + 1)); }, wrong);
  if (wrong.any())
    file.fail("cell " + std::to_string(wrong.value()) + " does not have " +
              std::to_string(Corners) + " vertices");
  std::vector<std::array<Index, Corners>> cells(file.cells());
  const auto points = static_cast<std::int64_t>(file.points());
  file.read(array, [&](std::uint64_t first, auto values) {
    std::uint64_t cell = first / Corners, corner = first % Corners;
    for (const auto value : values) {
      cells[cell][corner] = to<Index>(file, array, value);
      if (cells[cell][corner] < 0 || cells[cell][corner] >= points) wrong.note(cell);
      if (++corner < Corners) continue;
      corner = 0;
      ++cell;
    }
  });
  if (!wrong.any()) return cells;
  for (const Index v : cells[wrong.value()])
    if (v < 0 || static_cast<std::uint64_t>(v) >= file.points())
      file.fail("cell " + std::to_string(wrong.value()) + " has the vertex " + std::to_string(v) +
                " of " + std::to_string(file.points()));
  return cells;
}

PatchNames patch_names(const VtkInput& file) {
  const auto numbers = file.field_numbers("patch_number");
  const auto texts = file.texts("patch_name");
  PatchNames names;
  for (std::size_t i = 0; i < numbers.size() && i < texts.size(); ++i) names[numbers[i]] = texts[i];
  return names;
}

}  // namespace

template <typename Value>
std::vector<Value> read_whole(const VtkInput& file, const std::string& name, std::uint64_t count) {
  const VtkArray array = file.array(name, count);
  require_whole_numbers(file, array);
  std::vector<Value> result(count);
  file.read(array, [&](std::uint64_t first, auto values) {
    for (std::size_t i = 0; i < values.size(); ++i)
      result[first + i] = to<Value>(file, array, values[i]);
  });
  return result;
}

std::vector<std::int32_t> read_numbers(const VtkInput& file, const std::string& name) {
  return read_whole<std::int32_t>(file, name, file.cells());
}

/// Cells of both kinds, those of `Small` corners and those of `Large`.
template <std::size_t Small, std::size_t Large, typename Index>
struct MixedCells {
  std::vector<std::array<Index, Small>> small;
  std::vector<std::array<Index, Large>> large;
  std::vector<std::uint8_t> is_large;  ///< Per cell of the file.
};

/// Cells of Small or Large corners each, checked against the number of points.
template <std::size_t Small, std::size_t Large, typename Index>
MixedCells<Small, Large, Index> read_mixed(const VtkInput& file) {
  const std::vector<std::int64_t> ends = read_whole<std::int64_t>(file, "offsets", file.cells());
  MixedCells<Small, Large, Index> cells;
  std::int64_t end = 0;
  for (std::size_t c = 0; c < ends.size(); ++c) {
    const std::int64_t corners = ends[c] - std::exchange(end, ends[c]);
    if (corners != std::int64_t{Small} && corners != std::int64_t{Large})
      file.fail("cell " + std::to_string(c) + " does not have " + std::to_string(Small) + " or " +
                std::to_string(Large) + " vertices");
    cells.is_large.push_back(corners == std::int64_t{Large} ? 1 : 0);
  }
  const std::vector<Index> corners =
      read_whole<Index>(file, "connectivity", static_cast<std::uint64_t>(end));
  auto next = corners.begin();
  const auto take = [&](std::size_t c, auto& cell) {
    for (Index& v : cell) {
      v = *next++;
      if (v < 0 || static_cast<std::uint64_t>(v) >= file.points())
        file.fail("cell " + std::to_string(c) + " has the vertex " + std::to_string(v) + " of " +
                  std::to_string(file.points()));
    }
  };
  for (std::size_t c = 0; c < ends.size(); ++c) {
    if (cells.is_large[c] != 0)
      take(c, cells.large.emplace_back());
    else
      take(c, cells.small.emplace_back());
  }
  return cells;
}

/// Quadrilaterals become two triangles, with a number each.
void read_triangles_and_quads(const VtkInput& file, SurfaceMesh& surface,
                              std::vector<std::int32_t>& patches,
                              std::vector<std::int32_t>& buildings) {
  const auto cells = read_mixed<3, 4, std::int32_t>(file);
  std::vector<std::int32_t> patch, building;
  auto triangle = cells.small.begin();
  auto quad = cells.large.begin();
  const auto add = [&](std::size_t c, const std::array<std::int32_t, 3>& corners) {
    surface.triangles.push_back(corners);
    patch.push_back(patches[c]);
    building.push_back(buildings[c]);
  };
  for (std::size_t c = 0; c < cells.is_large.size(); ++c) {
    if (cells.is_large[c] == 0) {
      add(c, *triangle++);
      continue;
    }
    const auto& q = *quad++;
    surface.quads.push_back(static_cast<std::int32_t>(surface.triangles.size()));
    add(c, {q[0], q[1], q[2]});
    add(c, {q[0], q[2], q[3]});
  }
  patches = std::move(patch);
  buildings = std::move(building);
}

/// Whether each cell has so many.
bool has_corners(const VtkInput& file, std::int64_t corners) {
  Least wrong;
  compare(
      file, file.array("offsets", file.cells()),
      [&](std::uint64_t c) { return corners * static_cast<std::int64_t>(c + 1); }, wrong);
  return !wrong.any();
}

/// Tets and wedges; tets come first in `mesh`, and so do their regions.
void read_tets_and_wedges(const VtkInput& file, TetMesh& mesh) {
  auto cells = read_mixed<4, 6, std::int64_t>(file);
  mesh.cells = std::move(cells.small);
  mesh.wedges = std::move(cells.large);
  for (auto& prism : mesh.wedges) prism = in_vtk_order(prism);
  const VtkArray types = file.array("types", file.cells());
  Least wrong;
  compare(
      file, types,
      [&](std::uint64_t c) { return std::int64_t{cells.is_large[c] != 0 ? kVtkWedge : kVtkTetra}; },
      wrong);
  if (wrong.any())
    file.fail("cell " + std::to_string(wrong.value()) +
              " is not of VTK type 10 or 13; only tets and wedges are supported");
  if (!file.has("region")) return;
  const std::vector<std::int32_t> region = read_numbers(file, "region");
  for (const std::uint8_t kind : {0, 1})
    for (std::size_t c = 0; c < region.size(); ++c)
      if (cells.is_large[c] == kind) mesh.region.push_back(region[c]);
}

TetMesh read_vtu(const std::filesystem::path& path) {
  const VtkInput file(path, "UnstructuredGrid", "NumberOfCells");
  require_room_for_mesh(path, file.points(), file.cells());
  TetMesh mesh;
  mesh.points = read_points(file);
  if (has_corners(file, 4)) {
    Least wrong;
    compare(
        file, file.array("types", file.cells()),
        [](std::uint64_t) { return std::int64_t{kVtkTetra}; }, wrong);
    if (wrong.any())
      file.fail("cell " + std::to_string(wrong.value()) +
                " is not of VTK type 10; only tets and wedges are supported");
    mesh.cells = read_cells<4, std::int64_t>(file);
    if (file.has("region")) mesh.region = read_numbers(file, "region");
  } else {
    read_tets_and_wedges(file, mesh);
  }
  file.require_end();
  return mesh;
}

SurfaceMesh read_vtp(const std::filesystem::path& path) {
  const VtkInput file(path, "PolyData", "NumberOfPolys");
  if (file.points() > static_cast<std::uint64_t>(std::numeric_limits<std::int32_t>::max()))
    file.fail("has more than 2^31 points");
  require_room_for_surface(path, file.points(), file.cells());
  SurfaceMesh surface;
  surface.points = read_points(file);
  std::vector<std::int32_t> patches = read_numbers(file, "patch");
  std::vector<std::int32_t> buildings = read_numbers(file, "building");
  if (has_corners(file, 3))
    surface.triangles = read_cells<3, std::int32_t>(file);
  else
    read_triangles_and_quads(file, surface, patches, buildings);
  set_patches(patches, patch_names(file), surface,
              [&](const std::string& what) { file.fail(what); });
  surface.building = {buildings.begin(), buildings.end()};
  file.require_end();
  return surface;
}

std::optional<Point3> read_vtk_origin(const std::filesystem::path& path) {
  const bool volume = path.extension() == ".vtu";
  const VtkInput file(path, volume ? "UnstructuredGrid" : "PolyData",
                      volume ? "NumberOfCells" : "NumberOfPolys");
  return point_from_text(file.origin());
}

}  // namespace tetropolis

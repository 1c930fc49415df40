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

std::vector<std::int32_t> read_numbers(const VtkInput& file, const std::string& name) {
  const VtkArray array = file.array(name, file.cells());
  require_whole_numbers(file, array);
  std::vector<std::int32_t> numbers(file.cells());
  file.read(array, [&](std::uint64_t first, auto values) {
    for (std::size_t i = 0; i < values.size(); ++i)
      numbers[first + i] = to<std::int32_t>(file, array, values[i]);
  });
  return numbers;
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

TetMesh read_vtu(const std::filesystem::path& path) {
  const VtkInput file(path, "UnstructuredGrid", "NumberOfCells");
  require_room_for_mesh(path, file.points(), file.cells());
  constexpr std::int64_t kVtkTetra = 10;
  Least wrong;
  compare(
      file, file.array("types", file.cells()), [](std::uint64_t) { return kVtkTetra; }, wrong);
  if (wrong.any())
    file.fail("cell " + std::to_string(wrong.value()) +
              " is not of VTK type 10; only tets are supported");
  TetMesh mesh;
  mesh.points = read_points(file);
  mesh.cells = read_cells<4, std::int64_t>(file);
  if (file.has("region")) mesh.region = read_numbers(file, "region");
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
  surface.triangles = read_cells<3, std::int32_t>(file);
  set_patches(read_numbers(file, "patch"), patch_names(file), surface,
              [&](const std::string& what) { file.fail(what); });
  const auto buildings = read_numbers(file, "building");
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

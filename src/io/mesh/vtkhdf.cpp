#include "tetropolis/io/mesh/vtkhdf.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "column_output.h"
#include "io/deferred/hdf5_functions.h"
#include "io/file/chunked_output.h"
#include "io/file/hdf5_file.h"
#include "io/file/hdf5_handle.h"
#include "io/file/hdf5_output.h"
#include "vtk_cells.h"

namespace tetropolis {

namespace {

static_assert(std::endian::native == std::endian::little, "HDF5 output writes native byte order");

/// The group that readers know the file by.
void make_root(const Hdf5File& file) {
  Hdf5Handle group(H5Gcreate2(file.id(), "VTKHDF", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                   H5Gclose);
  file.require(group.good());
  constexpr std::array<std::int64_t, 2> kVersion = {2, 0};
  constexpr hsize_t kNumbers = kVersion.size();
  const Hdf5Handle row(H5Screate_simple(1, &kNumbers, nullptr), H5Sclose);
  const Hdf5Handle version(
      H5Acreate2(group.id(), "Version", H5T_STD_I64LE, row.id(), H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose);
  file.require(H5Awrite(version.id(), H5T_NATIVE_INT64, kVersion.data()) >= 0);
  const std::string name = "UnstructuredGrid";
  const Hdf5Handle scalar(H5Screate(H5S_SCALAR), H5Sclose);
  const Hdf5Handle text(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(text.id(), name.size());
  H5Tset_strpad(text.id(), H5T_STR_NULLPAD);
  const Hdf5Handle type(
      H5Acreate2(group.id(), "Type", text.id(), scalar.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  file.require(H5Awrite(type.id(), text.id(), name.data()) >= 0);
}

}  // namespace

void write_vtkhdf(const std::filesystem::path& path, const ColumnMesh& mesh,
                  const Placement& placement, const Progress& progress, const CellZones& zones) {
  const std::vector<CellIndex> cells = cell_offsets(mesh);
  const auto nodes = static_cast<std::uint64_t>(mesh.node_count());
  const CellCounts counts = count_cells(mesh, cells);
  const std::uint64_t count = counts.all();
  std::vector<Hdf5Dataset> datasets{
      {"/VTKHDF/NumberOfPoints", Hdf5Type::kInt64, 1, 0},
      {"/VTKHDF/NumberOfCells", Hdf5Type::kInt64, 1, 0},
      {"/VTKHDF/NumberOfConnectivityIds", Hdf5Type::kInt64, 1, 0},
      {"/VTKHDF/Points", Hdf5Type::kFloat64, nodes, 3},
      {"/VTKHDF/Connectivity", Hdf5Type::kInt64, counts.corners(), 0},
      {"/VTKHDF/Offsets", Hdf5Type::kInt64, count + 1, 0},
      {"/VTKHDF/Types", Hdf5Type::kUint8, count, 0},
      {"/VTKHDF/CellData/region", Hdf5Type::kInt32, count, 0},
      {"/VTKHDF/FieldData/origin", Hdf5Type::kFloat64, 3, 0},
  };
  if (!zones.empty())
    datasets.insert(datasets.end() - 1, {"/VTKHDF/CellData/zone", Hdf5Type::kInt32, count, 0});
  Hdf5Output file(path, datasets, make_root);
  const auto write_numbers = [&](std::size_t size, const auto& number, const Progress& part = {}) {
    file.write_next(
        size,
        [&](std::size_t begin, std::size_t end, std::string& buffer) {
          for (std::size_t i = begin; i < end; ++i) append_raw(buffer, number(i));
        },
        part);
  };
  for (const std::uint64_t size : {nodes, count, std::uint64_t{counts.corners()}})
    write_numbers(1, [&](std::size_t) { return size; });
  write_all_points(file, mesh, placement, portion(progress, 0, 0.2));
  file.write_next(
      cell_rows(mesh, cells),
      [&](std::size_t begin, std::size_t end, std::string& buffer) {
        for (std::size_t row = begin; row < end; ++row)
          for_each_cell_of(mesh, cells, row, [&](const auto& nodes_of_cell) {
            for (const NodeIndex node : in_vtk_order(nodes_of_cell))
              append_raw(buffer, node.value());
          });
      },
      portion(progress, 0.2, 0.7));
  write_numbers(
      count + 1,
      [&](std::size_t i) {
        return static_cast<std::int64_t>(4 * i + 2 * (i - std::min(i, counts.tets)));
      },
      portion(progress, 0.7, 0.9));
  write_numbers(count, [&](std::size_t i) { return i < counts.tets ? kVtkTetra : kVtkWedge; });
  write_regions(file, mesh, cells, zones, portion(progress, 0.9, 1));
  write_numbers(3, [&](std::size_t i) { return placement.origin[i]; });
  file.commit();
}

}  // namespace tetropolis

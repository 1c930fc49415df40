#include <bit>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "tetropolis/io/atomic_file.h"
#include "tetropolis/io/vtk.h"

#include "chunked_output.h"
#include "column_output.h"

namespace tetropolis {

namespace {

static_assert(std::endian::native == std::endian::little, "VTK output writes native byte order");

constexpr std::uint8_t kVtkTetra = 10;
constexpr std::size_t kGrain = 2048;

/// One array of the appended section. `components` 0: left out of the tag.
struct ArraySpec {
  std::string_view type;
  std::string_view name;
  int components;
  std::uint64_t bytes;
};

/// The tag of an appended array, moving `offset` on behind it.
std::string array_tag(const ArraySpec& array, std::uint64_t& offset) {
  const std::string components =
      array.components > 0 ? fmt::format(" NumberOfComponents=\"{}\"", array.components) : "";
  std::string tag =
      fmt::format("<DataArray type=\"{}\" Name=\"{}\"{} format=\"appended\" offset=\"{}\"/>\n",
                  array.type, array.name, components, offset);
  offset += sizeof(std::uint64_t) + array.bytes;
  return tag;
}

void begin_array(AtomicFile& file, std::uint64_t bytes) {
  std::string header;
  append_raw(header, bytes);
  file.write(header);
}

std::string file_head(std::string_view type, const Placement& placement) {
  return fmt::format(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"{0}\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "<{0}>\n<FieldData>\n<DataArray type=\"Float64\" Name=\"origin\" NumberOfComponents=\"3\" "
      "NumberOfTuples=\"1\" format=\"ascii\">{1} {2} {3}</DataArray>\n</FieldData>\n",
      type, placement.origin[0], placement.origin[1], placement.origin[2]);
}

std::string file_middle(std::string_view type) {
  return fmt::format("</Piece>\n</{}>\n<AppendedData encoding=\"raw\">\n_", type);
}

constexpr std::string_view kFileTail = "\n</AppendedData>\n</VTKFile>\n";

void write_points(AtomicFile& file, const ColumnMesh& mesh, const Placement& placement,
                  std::uint64_t bytes) {
  begin_array(file, bytes);
  write_chunked(file, mesh.vertex_count(), kGrain,
                [&](std::size_t begin, std::size_t end, std::string& buffer) {
                  append_points(mesh, placement, begin, end, buffer);
                });
}

template <typename Integer>
void write_cells(AtomicFile& file, const ColumnMesh& mesh, std::uint64_t cells,
                 const Progress& progress) {
  begin_array(file, cells * 4 * sizeof(Integer));
  write_chunked(
      file, mesh.triangle_count(), kGrain,
      [&](std::size_t begin, std::size_t end, std::string& buffer) {
        for (std::size_t t = begin; t < end; ++t)
          for_each_tet_over(mesh, t, [&](const std::array<NodeIndex, 4>& tet) {
            std::array<Integer, 4> row{};
            for (std::size_t i = 0; i < 4; ++i) row[i] = static_cast<Integer>(tet[i]);
            append_raw(buffer, row);
          });
      },
      progress);
  begin_array(file, cells * sizeof(Integer));
  write_chunked(file, cells, kGrain * 64,
                [&](std::size_t begin, std::size_t end, std::string& buffer) {
                  for (std::size_t c = begin; c < end; ++c)
                    append_raw(buffer, static_cast<Integer>(4 * (c + 1)));
                });
  begin_array(file, cells);
  write_chunked(file, cells, kGrain * 256,
                [&](std::size_t begin, std::size_t end, std::string& buffer) {
                  buffer.append(end - begin, static_cast<char>(kVtkTetra));
                });
}

void write_regions(AtomicFile& file, const ColumnMesh& mesh, const std::vector<NodeIndex>& cells) {
  begin_array(file, static_cast<std::uint64_t>(cells.back()) * sizeof(std::int32_t));
  write_chunked(file, mesh.triangle_count(), kGrain,
                [&](std::size_t begin, std::size_t end, std::string& buffer) {
                  for (std::size_t t = begin; t < end; ++t)
                    for (NodeIndex c = cells[t]; c < cells[t + 1]; ++c)
                      append_raw(buffer, static_cast<std::int32_t>(mesh.ground.region[t]));
                });
}

}  // namespace

void write_vtu(const std::filesystem::path& path, const ColumnMesh& mesh,
               const Placement& placement, const Progress& progress) {
  const std::vector<NodeIndex> offsets = cell_offsets(mesh);
  const auto nodes = static_cast<std::uint64_t>(mesh.node_count());
  const auto cells = static_cast<std::uint64_t>(offsets.back());
  const bool small = cells * 4 < std::numeric_limits<std::int32_t>::max();
  const std::string_view integer = small ? "Int32" : "Int64";
  const std::uint64_t width = small ? 4 : 8;

  AtomicFile file(path);
  std::uint64_t offset = 0;
  const ArraySpec points{"Float64", "Points", 3, nodes * 24};
  const ArraySpec regions{"Int32", "region", 0, cells * 4};
  std::string head = file_head("UnstructuredGrid", placement);
  head += fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n", nodes, cells);
  head += "<Points>\n" + array_tag(points, offset) + "</Points>\n<Cells>\n";
  head += array_tag({integer, "connectivity", 0, cells * 4 * width}, offset);
  head += array_tag({integer, "offsets", 0, cells * width}, offset);
  head += array_tag({"UInt8", "types", 0, cells}, offset);
  head +=
      "</Cells>\n<CellData Scalars=\"region\">\n" + array_tag(regions, offset) + "</CellData>\n";
  head += file_middle("UnstructuredGrid");
  file.write(head);
  write_points(file, mesh, placement, points.bytes);
  if (small)
    write_cells<std::int32_t>(file, mesh, cells, progress);
  else
    write_cells<std::int64_t>(file, mesh, cells, progress);
  write_regions(file, mesh, offsets);
  file.write(kFileTail);
  file.commit();
}

void write_vtp(const std::filesystem::path& path, const SurfaceMesh& surface,
               const Placement& placement) {
  const std::uint64_t points = surface.points.size();
  const std::uint64_t faces = surface.triangles.size();
  AtomicFile file(path);
  std::uint64_t offset = 0;
  std::string head = file_head("PolyData", placement);
  head += fmt::format(
      "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
      "NumberOfPolys=\"{}\">\n",
      points, faces);
  head += "<Points>\n" + array_tag({"Float64", "Points", 3, points * 24}, offset);
  head += "</Points>\n<Polys>\n" + array_tag({"Int32", "connectivity", 0, faces * 12}, offset);
  head += array_tag({"Int32", "offsets", 0, faces * 4}, offset);
  head += "</Polys>\n<CellData Scalars=\"patch\">\n";
  head += array_tag({"Int32", "patch", 0, faces * 4}, offset);
  head += array_tag({"Int32", "building", 0, faces * 4}, offset);
  head += "</CellData>\n" + file_middle("PolyData");
  file.write(head);

  const auto write_array = [&](std::uint64_t bytes, std::size_t size, const auto& append) {
    begin_array(file, bytes);
    write_chunked(file, size, kGrain * 16,
                  [&](std::size_t begin, std::size_t end, std::string& buffer) {
                    for (std::size_t i = begin; i < end; ++i) append(i, buffer);
                  });
  };
  write_array(points * 24, points, [&](std::size_t i, std::string& buffer) {
    for (std::size_t c = 0; c < 3; ++c)
      append_raw(buffer, surface.points[i][c] + placement.shift[c]);
  });
  write_array(faces * 12, faces, [&](std::size_t i, std::string& buffer) {
    for (const std::int32_t v : surface.triangles[i]) append_raw(buffer, v);
  });
  write_array(faces * 4, faces, [&](std::size_t i, std::string& buffer) {
    append_raw(buffer, static_cast<std::int32_t>(3 * (i + 1)));
  });
  write_array(faces * 4, faces, [&](std::size_t i, std::string& buffer) {
    append_raw(buffer, static_cast<std::int32_t>(surface.patch[i]));
  });
  write_array(faces * 4, faces, [&](std::size_t i, std::string& buffer) {
    append_raw(buffer, static_cast<std::int32_t>(surface.building[i]));
  });
  file.write(kFileTail);
  file.commit();
}

}  // namespace tetropolis

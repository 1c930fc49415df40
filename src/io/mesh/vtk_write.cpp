#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tetropolis/io/mesh/vtk.h"

#include "column_output.h"
#include "io/file/chunked_output.h"
#include "vtk_cells.h"
#include "vtk_output.h"

namespace tetropolis {

namespace {

static_assert(std::endian::native == std::endian::little, "VTK output writes native byte order");

/// An array of the field data.
struct Field {
  std::string_view type;
  std::string_view name;
  std::uint64_t tuples;
  std::string bytes;
};

/// meshio ends the program at a file for it, a VTU, that has texts; there they are bytes.
enum class Texts { kStrings, kBytes };

Field text_field(std::string_view name, const std::vector<std::string>& texts, Texts as) {
  std::string bytes;
  for (const std::string& text : texts) {
    for (const char c : text)
      if (c != '\0') bytes += c;
    bytes += '\0';
  }
  const bool strings = as == Texts::kStrings;
  return {strings ? "String" : "UInt8", name, strings ? texts.size() : bytes.size(), bytes};
}

/// Of each building, in the order of their numbers in the cell data.
std::vector<Field> building_fields(std::span<const Building> buildings, Texts as) {
  if (buildings.empty()) return {};
  std::vector<std::string> ids, sources;
  Field ground{"Float64", "building_h_ground", buildings.size(), {}};
  Field roof{"Float64", "building_h_roof", buildings.size(), {}};
  for (const Building& building : buildings) {
    ids.push_back(building.id);
    const nlohmann::json list = building.source_ids;
    sources.push_back(list.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
    append_raw(ground.bytes, building.h_ground);
    append_raw(roof.bytes, building.h_roof);
  }
  return {text_field("building_id", ids, as), text_field("building_source_ids", sources, as),
          std::move(ground), std::move(roof)};
}

std::vector<Field> zone_fields(const CellZones& zones) {
  if (zones.empty()) return {};
  std::vector<std::string> names;
  Field density{"Float64", "zone_leaf_area_density", zones.zones.size(), {}};
  for (const CellZone& zone : zones.zones) {
    names.push_back(zone.name);
    append_raw(density.bytes, zone.leaf_area_density);
  }
  return {text_field("zone_name", names, Texts::kBytes), std::move(density)};
}

std::vector<Field> patch_fields(const PatchTable& patches) {
  std::vector<std::string> names;
  Field numbers{"Int32", "patch_number", patches.size(), {}};
  for (const PatchInfo& info : patches) {
    names.push_back(info.name);
    append_raw(numbers.bytes, static_cast<std::int32_t>(info.patch));
  }
  return {std::move(numbers), text_field("patch_name", names, Texts::kStrings)};
}

/// The file up to its piece. Call after the tags of the piece's arrays are made: fields lie behind
/// those.
std::string file_head(std::string_view type, const Placement& placement,
                      const std::vector<Field>& fields, VtkOutput& file) {
  std::string head = fmt::format(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"{0}\" {4}>\n"
      "<{0}>\n<FieldData>\n<DataArray type=\"Float64\" Name=\"origin\" NumberOfComponents=\"3\" "
      "NumberOfTuples=\"1\" format=\"ascii\">{1} {2} {3}</DataArray>\n",
      type, placement.origin[0], placement.origin[1], placement.origin[2], file.file_attributes());
  for (const Field& field : fields)
    head += file.tag({field.type, field.name, 0, field.bytes.size(), field.tuples});
  return head + "</FieldData>\n";
}

void write_fields(VtkOutput& file, const std::vector<Field>& fields) {
  for (const Field& field : fields)
    file.write_next(field.bytes.size(),
                    [&](std::size_t begin, std::size_t end, std::string& buffer) {
                      buffer.append(field.bytes, begin, end - begin);
                    });
}

std::string file_middle(std::string_view type) {
  return fmt::format("</Piece>\n</{}>\n<AppendedData encoding=\"raw\">\n_", type);
}

constexpr std::string_view kFileTail = "\n</AppendedData>\n</VTKFile>\n";

template <typename Integer>
void write_cells(VtkOutput& file, const ColumnMesh& mesh, const std::vector<CellIndex>& offsets,
                 const Progress& progress) {
  const auto tets = static_cast<std::size_t>(offsets.back());
  const std::size_t rows = offsets.size() - 1;
  const auto prisms = static_cast<std::size_t>(mesh.layers.cells());
  file.write_next(
      rows + prisms,
      [&](std::size_t begin, std::size_t end, std::string& buffer) {
        append_cells<Integer>(mesh, offsets, std::min(begin, rows), std::min(end, rows), buffer);
        for (std::size_t i = std::max(begin, rows); i < end; ++i) {
          const auto nodes = in_vtk_order(wedge(mesh, static_cast<std::int64_t>(i - rows)));
          for (const NodeIndex node : nodes) append_raw(buffer, static_cast<Integer>(node.value()));
        }
      },
      portion(progress, 0, 0.75));
  file.write_next(
      tets + prisms,
      [&](std::size_t begin, std::size_t end, std::string& buffer) {
        RawNumbers ends(buffer, (end - begin) * sizeof(Integer));
        for (std::size_t c = begin; c < end; ++c)
          ends.put(static_cast<Integer>(c < tets ? 4 * (c + 1) : 4 * tets + 6 * (c + 1 - tets)));
      },
      portion(progress, 0.75, 0.95));
  file.write_next(
      tets + prisms,
      [&](std::size_t begin, std::size_t end, std::string& buffer) {
        for (std::size_t c = begin; c < end; ++c)
          buffer += static_cast<char>(c < tets ? kVtkTetra : kVtkWedge);
      },
      portion(progress, 0.95, 1));
}

}  // namespace

void write_vtu(const std::filesystem::path& path, const ColumnMesh& mesh,
               const Placement& placement, const Progress& progress, Compression compression,
               std::span<const Building> buildings, const CellZones& zones) {
  const std::vector<CellIndex> offsets = cell_offsets(mesh);
  const auto nodes = static_cast<std::uint64_t>(mesh.node_count());
  const auto prisms = static_cast<std::size_t>(mesh.layers.cells());
  const std::size_t cells = std::size_t{offsets.back()} + prisms;
  const std::size_t corners = 4 * std::size_t{offsets.back()} + 6 * prisms;
  const bool small = corners < std::numeric_limits<std::int32_t>::max();
  const std::string_view integer = small ? "Int32" : "Int64";
  const std::uint64_t width = small ? 4 : 8;

  VtkOutput file(path, compression);
  std::vector<Field> fields = building_fields(buildings, Texts::kBytes);
  for (Field& field : zone_fields(zones)) fields.push_back(std::move(field));
  std::string piece =
      fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n", nodes, cells);
  piece += "<Points>\n" + file.tag({"Float64", "Points", 3, nodes * 24}) + "</Points>\n<Cells>\n";
  piece += file.tag({integer, "connectivity", 0, corners * width});
  piece += file.tag({integer, "offsets", 0, cells * width});
  piece += file.tag({"UInt8", "types", 0, cells});
  piece += "</Cells>\n<CellData Scalars=\"region\">\n";
  piece += file.tag({"Int32", "region", 0, cells * 4});
  if (!zones.empty()) piece += file.tag({"Int32", "zone", 0, cells * 4});
  piece += "</CellData>\n";
  file.write_head(file_head("UnstructuredGrid", placement, fields, file) + piece +
                  file_middle("UnstructuredGrid"));
  write_all_points(file, mesh, placement, portion(progress, 0, 0.2));
  const Progress of_cells = portion(progress, 0.2, 0.9);
  if (small)
    write_cells<std::int32_t>(file, mesh, offsets, of_cells);
  else
    write_cells<std::int64_t>(file, mesh, offsets, of_cells);
  write_regions(file, mesh, offsets, zones, portion(progress, 0.9, 1));
  write_fields(file, fields);
  file.commit(kFileTail);
}

void write_vtp(const std::filesystem::path& path, const SurfaceMesh& surface,
               const Placement& placement, Compression compression,
               std::span<const Building> buildings) {
  const std::uint64_t points = surface.points.size();
  const SurfaceFaces face(surface);
  const std::uint64_t faces = face.size(), corners = 3 * faces + surface.quads.size();
  VtkOutput file(path, compression);
  std::vector<Field> fields = patch_fields(surface.patches);
  for (Field& field : building_fields(buildings, Texts::kStrings))
    fields.push_back(std::move(field));
  std::string piece = fmt::format(
      "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
      "NumberOfPolys=\"{}\">\n",
      points, faces);
  piece += "<Points>\n" + file.tag({"Float64", "Points", 3, points * 24}) + "</Points>\n<Polys>\n";
  piece += file.tag({"Int32", "connectivity", 0, corners * 4});
  piece += file.tag({"Int32", "offsets", 0, faces * 4});
  piece += "</Polys>\n<CellData Scalars=\"patch\">\n";
  piece += file.tag({"Int32", "patch", 0, faces * 4});
  piece += file.tag({"Int32", "building", 0, faces * 4}) + "</CellData>\n";
  file.write_head(file_head("PolyData", placement, fields, file) + piece + file_middle("PolyData"));

  const auto write_array = [&](std::size_t size, const auto& append) {
    file.write_next(size, [&](std::size_t begin, std::size_t end, std::string& buffer) {
      for (std::size_t i = begin; i < end; ++i) append(i, buffer);
    });
  };
  write_array(points, [&](std::size_t i, std::string& buffer) {
    for (std::size_t c = 0; c < 3; ++c)
      append_raw(buffer, surface.points[i][c] + placement.shift[c]);
  });
  write_array(faces, [&](std::size_t i, std::string& buffer) {
    for (const std::int32_t v : face.corners(i)) append_raw(buffer, v);
  });
  write_array(faces, [&](std::size_t i, std::string& buffer) {
    append_raw(buffer, static_cast<std::int32_t>(3 * (i + 1) + face.quads_before(i + 1)));
  });
  write_array(faces, [&](std::size_t i, std::string& buffer) {
    append_raw(buffer, static_cast<std::int32_t>(surface.patch[face.triangle(i)]));
  });
  write_array(faces, [&](std::size_t i, std::string& buffer) {
    append_raw(buffer, surface.building[face.triangle(i)]);
  });
  write_fields(file, fields);
  file.commit(kFileTail);
}

}  // namespace tetropolis

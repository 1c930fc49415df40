#include "tetropolis/io/mesh/openfoam.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/city/roof_summary.h"
#include "tetropolis/core/error.h"

#include "column_output.h"
#include "core/infinity.h"
#include "io/file/atomic_file.h"
#include "io/file/chunked_output.h"
#include "write_internal_faces.h"

namespace tetropolis {

namespace {

static_assert(std::endian::native == std::endian::little,
              "OpenFOAM output writes native byte order");

using Label = std::int32_t;

struct Sizes {
  std::size_t internal;
  std::size_t boundary;
  std::size_t between_prisms;  ///< Of the internal ones, the last.
  std::size_t corners;         ///< Of all faces.
  std::size_t faces() const { return internal + boundary; }
};

std::string header(std::string_view format, std::string_view type, std::string_view object,
                   const std::string& note) {
  std::string text =
      fmt::format("FoamFile\n{{\n    version     2.0;\n    format      {};\n", format);
  if (format == "binary") text += "    arch        \"LSB;label=32;scalar=64\";\n";
  text += fmt::format("    class       {};\n", type);
  if (!note.empty()) text += fmt::format("    note        \"{}\";\n", note);
  return text +
         fmt::format("    location    \"constant/polyMesh\";\n    object      {};\n}}\n\n", object);
}

/// A binary list is its length, "(", the raw values and ")".
void begin_list(AtomicFile& file, std::size_t size) { file.write(fmt::format("{}\n(", size)); }
void end_list(AtomicFile& file) { file.write(")\n"); }

void write_points(AtomicFile& file, const ColumnMesh& mesh, const Placement& placement,
                  const Bounds2& town) {
  std::string note =
      fmt::format("origin {} {} {}", placement.origin[0], placement.origin[1], placement.origin[2]);
  const Bounds2 at = town.moved({placement.shift[0], placement.shift[1]});
  if (!town.empty()) note += fmt::format(" town {} {} {} {}", at.xmin, at.ymin, at.xmax, at.ymax);
  file.write(header("binary", "vectorField", "points", note));
  begin_list(file, static_cast<std::size_t>(mesh.node_count()));
  const auto bytes = static_cast<std::uint64_t>(mesh.node_count()) * 3 * sizeof(double);
  write_chunked(file, point_rows(mesh), grain_for(point_rows(mesh), bytes),
                [&](std::size_t begin, std::size_t end, std::string& buffer) {
                  append_points(mesh, placement, begin, end, buffer);
                });
  end_list(file);
}

/// The highest roof of what stands, so that a plan leaves the town as it is; minus infinity where
/// nothing does.
double highest_standing(std::span<const Building> buildings) {
  const auto is_planned = [](const std::string& id) { return id.starts_with(kPlannedPrefix); };
  double high = -kInfinity;
  for (const Building& building : buildings) {
    for (const RoofPart& part : building.parts)
      if (!is_planned(part.source_id)) high = std::max(high, range_of(part).high);
    if (building.parts.empty() &&
        !std::all_of(building.source_ids.begin(), building.source_ids.end(), is_planned))
      high = std::max(high, building.h_roof);
  }
  return high;
}

Bounds2 town_of(const SurfaceMesh& surface, std::span<const Building> buildings) {
  Bounds2 box = Bounds2::nothing();
  double low = kInfinity, high = -kInfinity;
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    if (!surface.patch_of(i).of_building()) continue;
    for (const std::int32_t p : surface.triangles[i]) {
      const auto& corner = surface.points[static_cast<std::size_t>(p)];
      box.extend(Point2{corner[0], corner[1]});
      low = std::min(low, corner[2]);
      high = std::max(high, corner[2]);
    }
  }
  if (const double standing = highest_standing(buildings); standing > low) high = standing;
  return box.empty() ? box : box.grown(high - low);
}

/// The boundary faces as they are written: those of the open ground within the town come first, so
/// that a case can make the others a patch of their own.
std::vector<std::size_t> order_of_faces(const SurfaceMesh& surface, const Bounds2& town) {
  const SurfaceFaces faces(surface);
  const auto is_in_town = [&](std::size_t f) {
    Point2 centre;
    for (const std::int32_t p : surface.triangles[faces.triangle(f)]) {
      const auto& corner = surface.points[static_cast<std::size_t>(p)];
      centre.x += corner[0] / 3;
      centre.y += corner[1] / 3;
    }
    return town.contains(centre);
  };
  std::vector<std::size_t> order(faces.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto ground = std::partition_point(order.begin(), order.end(), [&](std::size_t f) {
    return surface.patch[faces.triangle(f)] == Patch::kGround;
  });
  std::stable_partition(order.begin(), ground, is_in_town);
  return order;
}

/// Appends what append(f, buffer) does for the boundary faces, by their number, in that order.
template <typename Append>
void write_outer(AtomicFile& file, const std::vector<std::size_t>& order, const Append& append) {
  write_chunked(file, order.size(), kRowsPerChunk,
                [&](std::size_t begin, std::size_t end, std::string& buffer) {
                  for (std::size_t i = begin; i < end; ++i) append(order[i], buffer);
                });
}

/// A "compact" list of faces: offsets into the list of corners that follows, and that list.
/// Precondition: `order` moves triangles only.
void write_faces(AtomicFile& file, const ColumnMesh& mesh, const CellFaces& cells,
                 const SurfaceMesh& surface, const std::vector<std::size_t>& order,
                 const Sizes& sizes, const Progress& progress) {
  file.write(header("binary", "faceCompactList", "faces", ""));
  std::vector<std::size_t> quads{0};  // among the faces between prisms before each
  for (const CellFace& face : cells.between_prisms)
    quads.push_back(quads.back() + face.corners - 3);
  begin_list(file, sizes.faces() + 1);
  const SurfaceFaces outer(surface);
  const auto quads_before = [&, first = sizes.internal - sizes.between_prisms](std::size_t f) {
    const std::size_t prism = std::min(f, sizes.internal) - std::min(f, first);
    return quads[prism] + outer.quads_before(f - std::min(f, sizes.internal));
  };
  write_chunked(file, sizes.faces() + 1, kRowsPerChunk,
                [&](std::size_t begin, std::size_t end, std::string& buffer) {
                  for (std::size_t f = begin; f < end; ++f)
                    append_raw(buffer, static_cast<Label>(3 * f + quads_before(f)));
                });
  end_list(file);
  begin_list(file, sizes.corners);
  write_internal_faces(
      file, mesh, cells, sizes.internal * 3 * sizeof(Label),
      [](const auto& face, std::string& buffer) {
        for (std::size_t i = 0; i < corners_of(face); ++i)
          append_raw(buffer, static_cast<Label>(face.nodes[i].value()));
      },
      progress);
  write_outer(file, order, [&](std::size_t f, std::string& buffer) {
    for (const std::int32_t p : outer.corners(f))
      append_raw(buffer, static_cast<Label>(surface.node[static_cast<std::size_t>(p)].value()));
  });
  end_list(file);
}

std::string size_note(const ColumnMesh& mesh, const CellFaces& cells, const Sizes& sizes) {
  return fmt::format("nPoints:{}  nCells:{}  nFaces:{}  nInternalFaces:{}", mesh.node_count(),
                     cells.cells.back().value() + mesh.layers.cells(), sizes.faces(),
                     sizes.internal);
}

void write_owner(AtomicFile& file, const ColumnMesh& mesh, const CellFaces& cells,
                 const SurfaceMesh& surface, const std::vector<std::size_t>& order,
                 const Sizes& sizes, const Progress& progress) {
  file.write(header("binary", "labelList", "owner", size_note(mesh, cells, sizes)));
  begin_list(file, sizes.faces());
  write_internal_faces(
      file, mesh, cells, sizes.internal * sizeof(Label),
      [](const auto& face, std::string& buffer) {
        append_raw(buffer, static_cast<Label>(face.owner.value()));
      },
      progress);
  const SurfaceFaces outer(surface);
  write_outer(file, order, [&](std::size_t f, std::string& buffer) {
    append_raw(buffer, static_cast<Label>(surface.cell[outer.triangle(f)].value()));
  });
  end_list(file);
}

void write_neighbour(AtomicFile& file, const ColumnMesh& mesh, const CellFaces& cells,
                     const Sizes& sizes, const Progress& progress) {
  file.write(header("binary", "labelList", "neighbour", size_note(mesh, cells, sizes)));
  begin_list(file, sizes.internal);
  write_internal_faces(
      file, mesh, cells, sizes.internal * sizeof(Label),
      [](const auto& face, std::string& buffer) {
        append_raw(buffer, static_cast<Label>(face.neighbour.value()));
      },
      progress);
  end_list(file);
}

void write_patches(AtomicFile& file, const SurfaceMesh& surface, const Sizes& sizes) {
  file.write(header("ascii", "polyBoundaryMesh", "boundary", ""));
  const auto counts = count_by_patch(surface);
  std::string text = fmt::format("{}\n(\n", counts.size());
  std::size_t start = sizes.internal;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const auto count = static_cast<std::size_t>(counts[i].faces);
    const PatchInfo& info = surface.patches[i];
    // Those of single buildings have their roofs and walls in groups, too.
    std::string groups = info.is_solid() ? "1(wall)" : "";
    if (info.of_building() && info.patch != Patch::kRoof && info.patch != Patch::kWall)
      groups = info.kind == PatchKind::kRoof ? "2(wall roofs)" : "2(wall walls)";
    text += fmt::format(
        "    {}\n    {{\n        type            {};\n{}        nFaces          {};\n"
        "        startFace       {};\n    }}\n",
        info.name, info.is_solid() ? "wall" : "patch",
        groups.empty() ? "" : fmt::format("        inGroups        {};\n", groups), count, start);
    start += count;
  }
  file.write(text + ")\n");
}

/// Text: zones are small, and every version reads it.
void write_zones(AtomicFile& file, const CellZones& zones) {
  file.write(header("ascii", "regIOobject", "cellZones", ""));
  std::vector<std::vector<std::size_t>> cells(zones.zones.size());
  for (std::size_t c = 0; c < zones.of_cell.size(); ++c)
    if (zones.of_cell[c] > 0) cells[static_cast<std::size_t>(zones.of_cell[c]) - 1].push_back(c);
  file.write(fmt::format("{}\n(\n", zones.zones.size()));
  for (std::size_t i = 0; i < zones.zones.size(); ++i) {
    const CellZone& zone = zones.zones[i];
    std::string text = fmt::format("{}\n{{\n    type            cellZone;\n", zone.name);
    if (zone.leaf_area_density > 0)
      text +=
          fmt::format("    height          {};\n    base            {};\n    leafAreaDensity {};\n",
                      zone.height, zone.base, zone.leaf_area_density);
    text += fmt::format("    cellLabels      List<label>\n{}\n(\n", cells[i].size());
    for (const std::size_t c : cells[i]) text += fmt::format("{}\n", c);
    file.write(text + ")\n;\n}\n");
  }
  file.write(")\n");
}

Sizes count_faces(const std::filesystem::path& folder, const ColumnMesh& mesh,
                  const CellFaces& list, const SurfaceMesh& surface) {
  const std::size_t boundary = SurfaceFaces(surface).size();
  const auto tets = static_cast<std::size_t>(list.cells.back().value());
  const auto prisms = static_cast<std::size_t>(mesh.layers.cells());
  const std::int64_t cells = list.cells.back().value() + mesh.layers.cells();
  Sizes sizes{(4 * tets + 5 * prisms - boundary) / 2, boundary, list.between_prisms.size(), 0};
  sizes.corners = 3 * sizes.faces() + surface.quads.size();
  for (const CellFace& face : list.between_prisms) sizes.corners += face.corners - 3;
  if (sizes.corners > static_cast<std::size_t>(std::numeric_limits<Label>::max()))
    throw Error(ErrorKind::kInput,
                fmt::format("{}: {} cells are too many for OpenFOAM's 32-bit labels; use a larger "
                            "mesh size or another format",
                            final_path(folder).string(), cells));
  return sizes;
}

}  // namespace

void write_openfoam(const std::filesystem::path& folder, const ColumnMesh& mesh,
                    const SurfaceMesh& surface, const Placement& placement,
                    const Progress& progress, const CellZones& zones,
                    std::span<const Building> buildings) {
  require_boundary_of(mesh, surface);
  const CellFaces cells(mesh);
  const Sizes sizes = count_faces(folder, mesh, cells, surface);
  const Bounds2 town = town_of(surface, buildings);
  const std::vector<std::size_t> order = order_of_faces(surface, town);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw_cannot_write(folder, error.message());

  AtomicFile points(folder / "points");
  AtomicFile faces(folder / "faces");
  AtomicFile owner(folder / "owner");
  AtomicFile neighbour(folder / "neighbour");
  AtomicFile boundary(folder / "boundary");
  write_points(points, mesh, placement, town);
  write_faces(faces, mesh, cells, surface, order, sizes, portion(progress, 0.1, 0.5));
  write_owner(owner, mesh, cells, surface, order, sizes, portion(progress, 0.5, 0.75));
  write_neighbour(neighbour, mesh, cells, sizes, portion(progress, 0.75, 1));
  write_patches(boundary, surface, sizes);
  std::optional<AtomicFile> cell_zones;
  if (!zones.empty()) write_zones(cell_zones.emplace(folder / "cellZones"), zones);
  for (AtomicFile* file : {&points, &faces, &owner, &neighbour, &boundary}) file->commit();
  if (cell_zones)
    cell_zones->commit();
  else
    std::filesystem::remove(folder / "cellZones", error);
}

}  // namespace tetropolis

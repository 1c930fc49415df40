#include "tetropolis/io/mesh/fluent.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "column_output.h"
#include "io/file/atomic_file.h"
#include "io/file/chunked_output.h"
#include "write_internal_faces.h"

namespace tetropolis {

namespace {

// Numbers of zones; that of a patch is kFirstPatch more than its number, and those of cells that
// have one come after all patches.
constexpr int kNodeZone = 1, kCellZone = 2, kInteriorZone = 3, kFirstPatch = 10;

enum class Boundary { kInterior = 2, kWall = 3, kSymmetry = 7 };

int zone_of(Patch patch) { return kFirstPatch + static_cast<int>(patch); }

/// Cells zone by zone, those in none first; otherwise as write_vtu orders them.
class CellOrder {
 public:
  CellOrder(const CellZones& zones, const CellCounts& cells) : counts_(zones.zones.size() + 1) {
    counts_[0] = cells;
    if (zones.empty()) return;
    const auto kind = [&](std::size_t zone, std::size_t cell) -> std::size_t& {
      return cell < cells.tets ? counts_[zone].tets : counts_[zone].prisms;
    };
    for (std::size_t c = 0; c < cells.all(); ++c) {
      --kind(0, c);
      ++kind(static_cast<std::size_t>(zones.of_cell[c]), c);
    }
    std::vector<std::size_t> next(counts_.size(), 0);
    for (std::size_t z = 1; z < next.size(); ++z) next[z] = next[z - 1] + counts_[z - 1].all();
    place_.resize(cells.all());
    for (std::size_t c = 0; c < place_.size(); ++c)
      place_[c] = next[static_cast<std::size_t>(zones.of_cell[c])]++;
  }

  /// Those in no zone, and then in each zone.
  const std::vector<CellCounts>& counts() const { return counts_; }
  /// The number of a cell in the file.
  std::size_t number(CellIndex cell) const {
    return 1 + (place_.empty() ? std::size_t{cell} : place_[std::size_t{cell}]);
  }

 private:
  std::vector<CellCounts> counts_;
  std::vector<std::size_t> place_;  // empty where it is that of write_vtu
};

void write_points(AtomicFile& file, const ColumnMesh& mesh, const Placement& placement) {
  file.write(fmt::format("(10 ({:x} 1 {:x} 1 3)(\n", kNodeZone, mesh.node_count()));
  constexpr std::uint64_t kBytes = 45;  // of a row, about
  const auto bytes = static_cast<std::uint64_t>(mesh.node_count()) * kBytes;
  write_chunked(file, point_rows(mesh), grain_for(point_rows(mesh), bytes),
                [&](std::size_t begin, std::size_t end, std::string& buffer) {
                  for_each_point(
                      mesh, placement, begin, end, [&](NodeIndex, double x, double y, double z) {
                        fmt::format_to(std::back_inserter(buffer), "{} {} {}\n", x, y, z);
                      });
                });
  file.write("))\n");
}

/// Types of faces; where there are several, each face says how many corners it has.
constexpr int kMixed = 0, kTriangles = 3, kQuads = 4;

int type_of(std::size_t triangles, std::size_t quads) {
  return quads == 0 ? kTriangles : triangles == 0 ? kQuads : kMixed;
}

std::string begin_faces(int zone, std::size_t first, std::size_t last, Boundary boundary,
                        int type) {
  return fmt::format("(13 ({:x} {:x} {:x} {:x} {:x})(\n", zone, first + 1, last,
                     static_cast<int>(boundary), type);
}

/// `corners` nodes from `node`(0) on.
template <typename Node>
void append_corners(std::string& buffer, int type, std::size_t corners, const Node& node) {
  if (type == kMixed) fmt::format_to(std::back_inserter(buffer), "{:x} ", corners);
  for (std::size_t i = 0; i < corners; ++i)
    fmt::format_to(std::back_inserter(buffer), "{:x} ", node(i).value() + 1);
}

/// Right-hand normals point to the cell that is named first.
void write_interior(AtomicFile& file, const ColumnMesh& mesh, const CellFaces& faces,
                    const CellOrder& order, std::size_t count, const Progress& progress) {
  const int type = type_of(1, faces.between_prisms.size());
  file.write(begin_faces(kInteriorZone, 0, count, Boundary::kInterior, type));
  constexpr std::uint64_t kBytes = 35;
  write_internal_faces(
      file, mesh, faces, count * kBytes,
      [type, &order](const auto& face, std::string& buffer) {
        append_corners(buffer, type, corners_of(face),
                       [&](std::size_t i) { return face.nodes[i]; });
        fmt::format_to(std::back_inserter(buffer), "{:x} {:x}\n", order.number(face.neighbour),
                       order.number(face.owner));
      },
      progress);
  file.write("))\n");
}

void write_patch(AtomicFile& file, const SurfaceMesh& surface, const PatchFaces& range,
                 const CellOrder& order, std::size_t interior) {
  const Boundary boundary =
      surface.patches.of(range.patch).is_solid() ? Boundary::kWall : Boundary::kSymmetry;
  const int type = type_of(range.triangles, range.quads);
  const std::size_t first = interior + range.first;
  file.write(begin_faces(zone_of(range.patch), first, first + range.faces(), boundary, type));
  write_chunked(file, range.faces(), kRowsPerChunk,
                [&](std::size_t begin, std::size_t end, std::string& buffer) {
                  std::size_t f = begin;
                  for_each_face_of(surface, range, begin, end, [&](const auto& nodes) {
                    append_corners(buffer, type, nodes.size(), [&](std::size_t i) {
                      return nodes[nodes.size() - 1 - i];  // so that normals point inwards
                    });
                    fmt::format_to(std::back_inserter(buffer), "{:x} 0\n",
                                   order.number(cell_behind(surface, range, f++)));
                  });
                });
  file.write("))\n");
}

/// Cells of a zone; those of two types say which each has.
void write_cell_types(AtomicFile& file, int zone, std::size_t first, const CellCounts& cells) {
  constexpr int kFluid = 1, kTets = 2, kWedges = 6;
  const int type = cells.prisms == 0 ? kTets : kMixed;
  file.write(fmt::format("(12 ({:x} {:x} {:x} {:x} {:x})", zone, first + 1, first + cells.all(),
                         kFluid, type));
  if (type == kMixed) {
    file.write("(\n");
    write_chunked(file, cells.all(), kRowsPerChunk,
                  [&](std::size_t begin, std::size_t end, std::string& buffer) {
                    for (std::size_t c = begin; c < end; ++c) {
                      buffer += std::to_string(c < cells.tets ? kTets : kWedges);
                      buffer += c % 32 == 31 ? '\n' : ' ';
                    }
                  });
    file.write(")");
  }
  file.write(")\n");
}

}  // namespace

void write_fluent(const std::filesystem::path& path, const ColumnMesh& mesh,
                  const SurfaceMesh& surface, const Placement& placement, const Progress& progress,
                  const CellZones& zones) {
  require_boundary_of(mesh, surface);
  const CellFaces faces(mesh);
  const std::vector<PatchFaces> patches = faces_of_patches(surface);
  const CellCounts cells = count_cells(mesh, faces.cells);
  const CellOrder order(zones, cells);
  const std::size_t outer = count_faces(surface);
  const std::size_t interior = (4 * cells.tets + 5 * cells.prisms - outer) / 2;
  AtomicFile file(path);
  file.write(fmt::format("(0 \"Tetropolis origin {} {} {}\")\n(2 3)\n", placement.origin[0],
                         placement.origin[1], placement.origin[2]));
  file.write(fmt::format("(10 (0 1 {:x} 0 3))\n(12 (0 1 {:x} 0))\n(13 (0 1 {:x} 0))\n",
                         mesh.node_count(), cells.all(), interior + outer));
  // Per number of CellZones::of_cell, the number of the zone of cells.
  std::vector<int> cell_zones(zones.zones.size() + 1, kCellZone);
  int last_patch = 0;
  for (const PatchInfo& info : surface.patches)
    last_patch = std::max(last_patch, static_cast<int>(info.patch));
  for (std::size_t z = 1; z < cell_zones.size(); ++z)
    cell_zones[z] = kFirstPatch + last_patch + static_cast<int>(z);
  std::size_t first = 0;
  for (std::size_t z = 0; z < cell_zones.size(); ++z) {
    const CellCounts& in_zone = order.counts()[z];
    if (in_zone.all() > 0) write_cell_types(file, cell_zones[z], first, in_zone);
    first += in_zone.all();
  }
  write_points(file, mesh, placement);
  write_interior(file, mesh, faces, order, interior, portion(progress, 0.2, 1));
  for (const PatchFaces& range : patches) write_patch(file, surface, range, order, interior);
  file.write(fmt::format("(45 ({} fluid air)())\n(45 ({} interior inside)())\n", kCellZone,
                         kInteriorZone));
  for (std::size_t z = 1; z < cell_zones.size(); ++z)
    if (order.counts()[z].all() > 0)
      file.write(fmt::format("(45 ({} fluid {})())\n", cell_zones[z], zones.zones[z - 1].name));
  for (const PatchFaces& range : patches) {
    const PatchInfo& info = surface.patches.of(range.patch);
    file.write(fmt::format("(45 ({} {} {})())\n", zone_of(range.patch),
                           info.is_solid() ? "wall" : "symmetry", info.name));
  }
  file.commit();
}

}  // namespace tetropolis

#include "tetropolis/io/mesh/cgns.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/core/error.h"

#include "column_output.h"
#include "io/deferred/hdf5_functions.h"
#include "io/file/atomic_file.h"
#include "io/file/chunked_output.h"
#include "io/file/hdf5_file.h"
#include "io/file/hdf5_handle.h"
#include "io/file/hdf5_output.h"
#include "zone_blocks.h"

namespace tetropolis {

namespace {

static_assert(std::endian::native == std::endian::little, "CGNS output writes native byte order");

constexpr const char* kData = " data";  ///< The dataset of a node.
constexpr const char* kZonePath = "/Base/Zone1";
constexpr std::int32_t kTetra4 = 10, kPenta6 = 14, kTri3 = 5, kQuad4 = 7;  // ElementType_t

/// Makes the nodes of the tree: a node is a group, with its name, label and type as attributes, and
/// what it holds as a dataset.
class Tree {
 public:
  explicit Tree(const Hdf5File& file) : file_(file) {}

  /// A node without data, or one whose data are streamed later; `type`: of them.
  void node(const std::string& parent, const std::string& name, const char* label,
            const char* type) const {
    make(parent, name, label, type, [](const Hdf5Handle&) {});
  }

  void text(const std::string& parent, const std::string& name, const char* label,
            const std::string& value) const {
    const hsize_t size = value.size();
    make(parent, name, label, "C1", [&](const Hdf5Handle& group) {
      put(group, H5T_NATIVE_CHAR, std::span(&size, 1), value.data());
    });
  }

  /// `columns`: 0 for a list, else rows of so many.
  void numbers(const std::string& parent, const std::string& name, const char* label,
               const std::vector<std::int32_t>& values, hsize_t columns = 0) const {
    std::array<hsize_t, 2> shape{values.size(), columns};
    if (columns > 0) shape[0] /= columns;
    make(parent, name, label, "I4", [&](const Hdf5Handle& group) {
      put(group, H5T_NATIVE_INT32, std::span(shape).first(columns == 0 ? 1 : 2), values.data());
    });
  }

  void version(float value) const {
    constexpr hsize_t kOne = 1;
    make("", "CGNSLibraryVersion", "CGNSLibraryVersion_t", "R4", [&](const Hdf5Handle& group) {
      put(group, H5T_NATIVE_FLOAT, std::span(&kOne, 1), &value);
    });
  }

  /// What the library looks for in the root.
  void root() const {
    const Hdf5Handle root(H5Gopen2(file_.id(), "/", H5P_DEFAULT), H5Gclose);
    describe(root, "HDF5 MotherNode", "Root Node of HDF5 File", "MT");
    constexpr std::string_view kFormat("IEEE_LITTLE_32", 15);
    std::array<char, 33> library{};
    fmt::format_to_n(library.data(), library.size() - 1, "HDF5 Version {}.{}.{}", H5_VERS_MAJOR,
                     H5_VERS_MINOR, H5_VERS_RELEASE);
    const hsize_t format_size = kFormat.size(), library_size = library.size();
    put(root, H5T_NATIVE_CHAR, std::span(&format_size, 1), kFormat.data(), " format");
    put(root, H5T_NATIVE_CHAR, std::span(&library_size, 1), library.data(), " hdf5version");
  }

 private:
  /// fill(group) puts what the node holds.
  template <typename Fill>
  void make(const std::string& parent, const std::string& name, const char* label, const char* type,
            const Fill& fill) const {
    const Hdf5Handle creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
    // The library lists the children of a node in the order they were made.
    H5Pset_link_creation_order(creation.id(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
    H5Pset_obj_track_times(creation.id(), false);
    const Hdf5Handle group(H5Gcreate2(file_.id(), (parent + "/" + name).c_str(), H5P_DEFAULT,
                                      creation.id(), H5P_DEFAULT),
                           H5Gclose);
    file_.require(group.good());
    describe(group, name, label, type);
    const hsize_t one = 1;
    constexpr std::int32_t kNativeFlag = 1;
    const Hdf5Handle space(H5Screate_simple(1, &one, nullptr), H5Sclose);
    const Hdf5Handle flags(
        H5Acreate2(group.id(), "flags", H5T_NATIVE_INT32, space.id(), H5P_DEFAULT, H5P_DEFAULT),
        H5Aclose);
    file_.require(H5Awrite(flags.id(), H5T_NATIVE_INT32, &kNativeFlag) >= 0);
    fill(group);
  }

  void describe(const Hdf5Handle& group, const std::string& name, const char* label,
                const char* type) const {
    attribute(group, "name", name, 33);
    attribute(group, "label", label, 33);
    attribute(group, "type", type, 3);
  }

  void attribute(const Hdf5Handle& group, const char* name, std::string value,
                 std::size_t size) const {
    value.resize(size - 1, '\0');
    value.push_back('\0');
    const Hdf5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
    const Hdf5Handle text(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(text.id(), size);
    const Hdf5Handle made(
        H5Acreate2(group.id(), name, text.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    file_.require(H5Awrite(made.id(), text.id(), value.data()) >= 0);
  }

  void put(const Hdf5Handle& group, hid_t type, std::span<const hsize_t> shape, const void* values,
           const char* name = kData) const {
    const Hdf5Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                           H5Sclose);
    const Hdf5Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_obj_track_times(creation.id(), false);
    const Hdf5Handle set(
        H5Dcreate2(group.id(), name, type, space.id(), H5P_DEFAULT, creation.id(), H5P_DEFAULT),
        H5Dclose);
    file_.require(set.good() &&
                  H5Dwrite(set.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
  }

  const Hdf5File& file_;
};

/// A section of elements; their nodes are streamed later.
void make_section(const Tree& tree, const std::string& name, std::int32_t type, std::size_t first,
                  std::size_t last) {
  const std::string section = fmt::format("{}/{}", kZonePath, name);
  tree.numbers(kZonePath, name, "Elements_t", {type, 0});
  tree.numbers(section, "ElementRange", "IndexRange_t",
               {static_cast<std::int32_t>(first + 1), static_cast<std::int32_t>(last)});
  tree.node(section, "ElementConnectivity", "DataArray_t", "I4");
}

void make_condition(const Tree& tree, const std::string& name, std::size_t first,
                    std::size_t last) {
  const std::string conditions = fmt::format("{}/ZoneBC", kZonePath);
  const std::string condition = fmt::format("{}/{}", conditions, name);
  tree.text(conditions, name, "BC_t", "FamilySpecified");
  tree.numbers(condition, "PointRange", "IndexRange_t",
               {static_cast<std::int32_t>(first + 1), static_cast<std::int32_t>(last)}, 1);
  tree.text(condition, "GridLocation", "GridLocation_t", "FaceCenter");
  tree.text(condition, "FamilyName", "FamilyName_t", name);
}

/// A zone: its cells, which are neighbours in the numbering of elements, and its family.
void make_subregion(const Tree& tree, const std::string& name, const std::string& family,
                    std::size_t first, std::size_t last) {
  const std::string region = fmt::format("{}/{}", kZonePath, name);
  constexpr std::int32_t kOfCells = 3;  // dimensions
  tree.numbers(kZonePath, name, "ZoneSubRegion_t", {kOfCells});
  tree.numbers(region, "PointRange", "IndexRange_t",
               {static_cast<std::int32_t>(first + 1), static_cast<std::int32_t>(last)}, 1);
  tree.text(region, "GridLocation", "GridLocation_t", "CellCenter");
  tree.text(region, "FamilyName", "FamilyName_t", family);
}

/// Elements of one type: the cells, zone by zone, and then the faces patch by patch.
struct Section {
  std::string name;
  std::int32_t type = 0;
  std::size_t first = 0, count = 0;
  std::size_t corners = 0;  ///< Of each.
};

/// `blocks`: zone_blocks().
std::vector<Section> sections_of(const std::vector<ZoneBlock>& blocks, const CellZones& zones,
                                 const SurfaceMesh& surface,
                                 const std::vector<PatchFaces>& patches) {
  std::vector<Section> sections;
  std::size_t first = 0;
  const auto add = [&](const std::string& name, std::int32_t type, std::size_t count,
                       std::size_t corners) {
    if (count > 0) sections.push_back({name, type, first, count, corners});
    first += count;
  };
  add("air", kTetra4, blocks[0].count, 4);
  add("air_layers", kPenta6, blocks[1].count, 6);
  for (std::size_t z = 1; z < blocks.size() / 2; ++z) {
    const std::string& name = zones.zones[z - 1].name;
    const std::size_t tets = blocks[2 * z].count, prisms = blocks[2 * z + 1].count;
    add(name, kTetra4, tets, 4);
    add(tets > 0 ? fmt::format("layers_{}", z) : name, kPenta6, prisms, 6);
  }
  for (const PatchFaces& range : patches) {
    const std::string& name = surface.patches.of(range.patch).name;
    add(name, kTri3, range.triangles, 3);
    add(range.triangles > 0 ? fmt::format("quads_{}", static_cast<int>(range.patch)) : name, kQuad4,
        range.quads, 4);
  }
  return sections;
}

void make_tree(const Hdf5File& file, const ColumnMesh& mesh, const CellCounts& cells,
               const std::vector<ZoneBlock>& blocks, const CellZones& zones,
               const std::vector<Section>& sections, const SurfaceMesh& surface,
               const std::vector<PatchFaces>& patches, const Placement& placement) {
  const Tree tree(file);
  tree.root();
  tree.version(3.4F);
  tree.numbers("", "Base", "CGNSBase_t", {3, 3});
  tree.text("/Base", "origin", "Descriptor_t",
            fmt::format("{} {} {}", placement.origin[0], placement.origin[1], placement.origin[2]));
  for (const PatchFaces& range : patches) {
    const PatchInfo& info = surface.patches.of(range.patch);
    tree.node("/Base", info.name, "Family_t", "MT");
    tree.text("/Base/" + info.name, "FamBC", "FamilyBC_t",
              info.is_solid() ? "BCWall" : "BCFarfield");
  }
  for (const CellZone& zone : zones.zones)
    if (zone.cells > 0) tree.node("/Base", zone.name, "Family_t", "MT");
  tree.numbers(
      "/Base", "Zone1", "Zone_t",
      {static_cast<std::int32_t>(mesh.node_count()), static_cast<std::int32_t>(cells.all()), 0}, 1);
  tree.text(kZonePath, "ZoneType", "ZoneType_t", "Unstructured");
  const std::string coordinates = fmt::format("{}/GridCoordinates", kZonePath);
  tree.node(kZonePath, "GridCoordinates", "GridCoordinates_t", "MT");
  for (const char* name : {"CoordinateX", "CoordinateY", "CoordinateZ"})
    tree.node(coordinates, name, "DataArray_t", "R8");
  for (const Section& section : sections)
    make_section(tree, section.name, section.type, section.first, section.first + section.count);
  std::size_t first = blocks[0].count + blocks[1].count;
  for (std::size_t z = 1; z < blocks.size() / 2; ++z) {
    const std::size_t last = first + blocks[2 * z].count + blocks[2 * z + 1].count;
    if (last > first)
      make_subregion(tree, fmt::format("zone_{}", z), zones.zones[z - 1].name, first, last);
    first = last;
  }
  tree.node(kZonePath, "ZoneBC", "ZoneBC_t", "MT");
  for (const PatchFaces& range : patches)
    make_condition(tree, surface.patches.of(range.patch).name, cells.all() + range.first,
                   cells.all() + range.first + range.faces());
}

std::vector<Hdf5Dataset> streamed(const ColumnMesh& mesh, const std::vector<Section>& sections) {
  std::vector<Hdf5Dataset> datasets;
  for (const char* name : {"CoordinateX", "CoordinateY", "CoordinateZ"})
    datasets.push_back({fmt::format("{}/GridCoordinates/{}/{}", kZonePath, name, kData),
                        Hdf5Type::kFloat64, static_cast<std::uint64_t>(mesh.node_count()), 0});
  for (const Section& section : sections)
    datasets.push_back({fmt::format("{}/{}/ElementConnectivity/{}", kZonePath, section.name, kData),
                        Hdf5Type::kInt32, section.corners * section.count, 0});
  return datasets;
}

template <typename Nodes>
void append_element(const Nodes& nodes, std::string& buffer) {
  for (const NodeIndex node : nodes)
    append_raw(buffer, static_cast<std::int32_t>(node.value() + 1));
}

}  // namespace

void write_cgns(const std::filesystem::path& path, const ColumnMesh& mesh,
                const SurfaceMesh& surface, const Placement& placement, const Progress& progress,
                const CellZones& zones) {
  require_boundary_of(mesh, surface);
  const std::vector<CellIndex> offsets = cell_offsets(mesh);
  const std::vector<PatchFaces> patches = faces_of_patches(surface);
  const CellCounts cells = count_cells(mesh, offsets);
  if (cells.all() + count_faces(surface) >
      static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
    throw Error(ErrorKind::kInput,
                fmt::format("{}: {} cells are too many for 32-bit numbers; use a larger mesh size "
                            "or another format",
                            final_path(path).string(), cells.all()));
  const std::vector<ZoneBlock> blocks = zone_blocks(
      mesh, offsets, zones,
      [](std::size_t, const auto& nodes, std::string& buffer) { append_element(nodes, buffer); });
  const std::vector<Section> sections = sections_of(blocks, zones, surface, patches);
  const std::vector<Hdf5Dataset> datasets = streamed(mesh, sections);
  Hdf5Output file(path, datasets, [&](const Hdf5File& made) {
    make_tree(made, mesh, cells, blocks, zones, sections, surface, patches, placement);
  });
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double at = static_cast<double>(axis);
    file.write_next(
        point_rows(mesh),
        [&](std::size_t begin, std::size_t end, std::string& buffer) {
          for_each_point(mesh, placement, begin, end, [&](NodeIndex, double x, double y, double z) {
            append_raw(buffer, axis == 0 ? x : axis == 1 ? y : z);
          });
        },
        portion(progress, 0.1 * at, 0.1 * (at + 1)));
  }
  const auto write_cells = [&](std::size_t first, std::size_t last, const Progress& part) {
    file.write_next(
        last - first,
        [&](std::size_t begin, std::size_t end, std::string& buffer) {
          std::size_t next = first_cell_of(offsets, first + begin);
          for (std::size_t row = first + begin; row < first + end; ++row)
            for_each_cell_of(mesh, offsets, row, [&](const auto& nodes) {
              const std::size_t cell = next++;
              if (zones.empty() || zones.of_cell[cell] == 0) append_element(nodes, buffer);
            });
        },
        part);
  };
  const std::size_t rows = offsets.size() - 1;
  if (blocks[0].count > 0) write_cells(0, rows, portion(progress, 0.3, 0.8));
  if (blocks[1].count > 0) write_cells(rows, cell_rows(mesh, offsets), portion(progress, 0.8, 0.9));
  for (std::size_t b = 2; b < blocks.size(); ++b) {
    const std::string& elements = blocks[b].elements;
    if (!elements.empty())
      file.write_next(elements.size(),
                      [&](std::size_t begin, std::size_t end, std::string& buffer) {
                        buffer.append(elements, begin, end - begin);
                      });
  }
  for (const PatchFaces& range : patches)
    for (const bool quads : {false, true}) {
      const std::size_t first = quads ? range.triangles : 0;
      const std::size_t count = quads ? range.quads : range.triangles;
      if (count == 0) continue;
      file.write_next(count, [&](std::size_t begin, std::size_t end, std::string& buffer) {
        for_each_face_of(surface, range, first + begin, first + end,
                         [&](const auto& nodes) { append_element(nodes, buffer); });
      });
    }
  file.commit();
}

}  // namespace tetropolis

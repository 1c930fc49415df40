#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/io/mesh/xdmf.h"

#include "io/file/hdf5_input.h"
#include "io/file/input_file.h"
#include "io/file/positioned_file.h"
#include "mesh_input.h"
#include "xdmf_description.h"
#include "xdmf_layout.h"

namespace tetropolis {

namespace {

using namespace xdmf;
namespace fs = std::filesystem;

/// A description: XML, a few lines.
class Description {
 public:
  explicit Description(const fs::path& path)
      : path_(path), text_(PositionedFile(path).head(kLongest)) {
    is_boundary_ = text_.find(fmt::format(":{}</DataItem>", kFaces)) != std::string::npos;
    data_ = name_before(is_boundary_ ? kFaces : kTopology);
    volume_data_ = name_before(kGeometry);
    has_zones_ = text_.find(fmt::format(":{}</DataItem>", kZone)) != std::string::npos;
    is_mixed_ = is_of_type("Mixed");
    is_large_ = is_of_type(is_boundary_ ? kQuadrilateral.name : kWedge.name);
  }

  bool is_boundary() const { return is_boundary_; }
  /// The HDF5 file that it refers to, which is beside it, and that of the volume, which has the
  /// points.
  fs::path data() const { return path_.parent_path() / data_; }
  fs::path volume_data() const { return path_.parent_path() / volume_data_; }
  PatchNames patches() const { return names_in(text_); }
  /// Whether elements are of both kinds, or else of the one with more corners.
  bool is_mixed() const { return is_mixed_; }
  bool is_large() const { return is_large_; }

  /// Throws unless that is how data of these sizes are described: `elements` are cells or faces.
  void require(std::size_t nodes, const Elements& elements, const Point3& origin) const {
    const auto points = static_cast<std::int64_t>(nodes);
    const std::string expected =
        is_boundary_
            ? boundary_description(points, elements, patches(), origin, volume_data_, data_)
            : volume_description(points, elements, has_zones_, origin, data_);
    if (text_ == expected) return;
    const auto [is, should_be] =
        std::mismatch(text_.begin(), text_.end(), expected.begin(), expected.end());
    const auto line = 1 + std::count(text_.begin(), is, '\n');
    fail(fmt::format("does not describe the data that {} has, from line {} on", data_, line));
  }

 private:
  static constexpr std::int64_t kLongest = 1 << 16;

  bool is_of_type(std::string_view type) const {
    return text_.find(fmt::format("TopologyType=\"{}\"", type)) != std::string::npos;
  }

  /// The file in which it says that the dataset is.
  std::string name_before(const char* dataset) const {
    const std::string after = fmt::format(":{}</DataItem>", dataset);
    constexpr std::string_view kBefore = "Format=\"HDF\">";
    const std::size_t end = text_.find(after);
    const std::size_t begin = end == std::string::npos ? end : text_.rfind(kBefore, end);
    if (begin == std::string::npos) fail(fmt::format("does not refer to {}", dataset));
    std::string name = text_.substr(begin + kBefore.size(), end - begin - kBefore.size());
    if (fs::path(name) != fs::path(name).filename()) fail("refers to data in another folder");
    return name;
  }

  [[noreturn]] void fail(const std::string& what) const {
    fail_input(path_, what + "; only XDMF as tetropolis writes it can be read");
  }

  fs::path path_;
  std::string text_;
  bool is_boundary_ = false, has_zones_ = false, is_mixed_ = false, is_large_ = false;
  std::string data_, volume_data_;
};

Point3 read_origin(const Hdf5Input& file) {
  const auto numbers = file.read<double>(kOrigin);
  Point3 origin{};
  if (numbers.size() != origin.size()) file.fail("has an origin that is no point");
  std::copy(numbers.begin(), numbers.end(), origin.begin());
  return origin;
}

template <typename Row>
void require_corners(const Hdf5Input& file, const char* dataset, const std::vector<Row>& rows,
                     std::size_t points) {
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (const std::int64_t v : rows[r])
      if (v < 0 || static_cast<std::uint64_t>(v) >= points)
        file.fail(fmt::format("row {} of {} has the vertex {} of {}", r, dataset, v, points));
}

/// Elements of up to two kinds, and which is of the second.
template <std::size_t Small, std::size_t Large>
struct Topology {
  std::vector<std::array<std::int64_t, Small>> small;
  std::vector<std::array<std::int64_t, Large>> large;
  std::vector<std::uint8_t> is_large;

  Elements elements() const { return {std::ssize(small), std::ssize(large)}; }
};

/// How many there may be at most.
template <std::size_t Small, std::size_t Large>
std::uint64_t most_elements(const Hdf5Input& file, const char* dataset,
                            const Description& description) {
  if (description.is_mixed()) return file.rows<std::int64_t>(dataset) / (Small + 1);
  return description.is_large() ? file.rows<std::array<std::int64_t, Large>>(dataset)
                                : file.rows<std::array<std::int64_t, Small>>(dataset);
}

template <std::size_t Small, std::size_t Large>
Topology<Small, Large> read_topology(const Hdf5Input& file, const char* dataset,
                                     const Description& description, const Kind& small,
                                     const Kind& large) {
  Topology<Small, Large> topology;
  if (!description.is_mixed()) {
    if (description.is_large())
      topology.large = file.read<std::array<std::int64_t, Large>>(dataset);
    else
      topology.small = file.read<std::array<std::int64_t, Small>>(dataset);
    topology.is_large.assign(topology.small.size() + topology.large.size(),
                             description.is_large() ? 1 : 0);
    return topology;
  }
  const auto numbers = file.read<std::int64_t>(dataset);
  const auto take = [&](auto& elements, std::size_t at) {
    auto& corners = elements.emplace_back();
    if (numbers.size() - at < corners.size())
      file.fail(fmt::format("ends within an element of {}", dataset));
    std::copy_n(numbers.begin() + static_cast<std::ptrdiff_t>(at), corners.size(), corners.begin());
    return at + corners.size();
  };
  for (std::size_t at = 0; at < numbers.size();) {
    const bool is_large = numbers[at] == large.number;
    if (!is_large && numbers[at] != small.number)
      file.fail(fmt::format("has an element of type {} in {}", numbers[at], dataset));
    topology.is_large.push_back(is_large ? 1 : 0);
    at = is_large ? take(topology.large, at + 1) : take(topology.small, at + 1);
  }
  return topology;
}

/// The faces, of which quadrilaterals are two triangles, with a numbering of their own, in the
/// order of the volume's.
SurfaceMesh compact(const std::vector<std::array<double, 3>>& points,
                    const Topology<3, 4>& topology) {
  SurfaceMesh surface;
  constexpr std::int32_t kUnused = -1;
  std::vector<std::int32_t> number(points.size(), kUnused);
  const auto for_each_corner = [&](const auto& visit) {
    for (const auto& face : topology.small)
      for (const std::int64_t v : face) visit(number[static_cast<std::size_t>(v)]);
    for (const auto& face : topology.large)
      for (const std::int64_t v : face) visit(number[static_cast<std::size_t>(v)]);
  };
  for_each_corner([](std::int32_t& own) { own = 0; });
  for (std::size_t v = 0; v < points.size(); ++v) {
    if (number[v] == kUnused) continue;
    number[v] = static_cast<std::int32_t>(surface.points.size());
    surface.points.push_back(points[v]);
  }
  const auto add = [&](std::int64_t a, std::int64_t b, std::int64_t c) {
    surface.triangles.push_back({number[static_cast<std::size_t>(a)],
                                 number[static_cast<std::size_t>(b)],
                                 number[static_cast<std::size_t>(c)]});
  };
  surface.triangles.reserve(topology.small.size() + 2 * topology.large.size());
  auto triangle = topology.small.begin();
  auto quad = topology.large.begin();
  for (const std::uint8_t is_quad : topology.is_large) {
    if (is_quad == 0) {
      const auto& t = *triangle++;
      add(t[0], t[1], t[2]);
      continue;
    }
    const auto& q = *quad++;
    surface.quads.push_back(static_cast<std::int32_t>(surface.triangles.size()));
    add(q[0], q[1], q[2]);
    add(q[0], q[2], q[3]);
  }
  return surface;
}

/// Values of faces, for their triangles.
std::vector<std::int32_t> of_triangles(const std::vector<std::int32_t>& values,
                                       const Topology<3, 4>& topology) {
  if (topology.large.empty()) return values;
  std::vector<std::int32_t> result;
  for (std::size_t f = 0; f < values.size(); ++f)
    result.insert(result.end(), topology.is_large[f] != 0 ? 2 : 1, values[f]);
  return result;
}

TetMesh read_volume(const fs::path& path, const Description& description) {
  const Hdf5Input file(description.data());
  require_room_for_mesh(path, file.rows<std::array<double, 3>>(kGeometry),
                        most_elements<4, 6>(file, kTopology, description));
  TetMesh volume;
  volume.points = file.read<std::array<double, 3>>(kGeometry);
  Topology<4, 6> topology = read_topology<4, 6>(file, kTopology, description, kTetrahedron, kWedge);
  if (!std::is_sorted(topology.is_large.begin(), topology.is_large.end()))
    file.fail("has tets after prisms");
  volume.cells = std::move(topology.small);
  volume.wedges = std::move(topology.large);
  volume.region = file.read<std::int32_t>(kRegion);
  if (volume.region.size() != volume.cell_count()) file.fail("has not as many regions as cells");
  description.require(volume.points.size(), {std::ssize(volume.cells), std::ssize(volume.wedges)},
                      read_origin(file));
  require_corners(file, kTopology, volume.cells, volume.points.size());
  require_corners(file, kTopology, volume.wedges, volume.points.size());
  return volume;
}

SurfaceMesh read_boundary(const fs::path& path, const Description& description) {
  const Hdf5Input file(description.data()), volume(description.volume_data());
  const std::uint64_t most = most_elements<3, 4>(file, kFaces, description);
  require_room_for_surface(path, volume.rows<std::array<double, 3>>(kGeometry), most);
  if (most > std::numeric_limits<std::int32_t>::max() / 6)
    file.fail("has more boundary faces than can be read");
  const auto points = volume.read<std::array<double, 3>>(kGeometry);
  const Topology<3, 4> faces =
      read_topology<3, 4>(file, kFaces, description, kTriangle, kQuadrilateral);
  const auto patches = file.read<std::int32_t>(kPatch);
  const auto buildings = file.read<std::int32_t>(kBuilding);
  if (patches.size() != faces.is_large.size() || buildings.size() != faces.is_large.size())
    file.fail("has not as many tags as boundary faces");
  description.require(points.size(), faces.elements(), read_origin(file));
  require_corners(file, kFaces, faces.small, points.size());
  require_corners(file, kFaces, faces.large, points.size());

  SurfaceMesh surface = compact(points, faces);
  set_patches(of_triangles(patches, faces), description.patches(), surface,
              [&](const std::string& what) { file.fail(what); });
  const std::vector<std::int32_t> of_each = of_triangles(buildings, faces);
  surface.building = {of_each.begin(), of_each.end()};
  return surface;
}

}  // namespace

std::variant<TetMesh, SurfaceMesh> read_xdmf(const fs::path& path) {
  const Description description(path);
  if (description.is_boundary()) return read_boundary(path, description);
  return read_volume(path, description);
}

Point3 read_xdmf_origin(const fs::path& path) {
  return read_origin(Hdf5Input(Description(path).data()));
}

}  // namespace tetropolis

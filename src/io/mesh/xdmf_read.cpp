#include <algorithm>
#include <array>
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
  }

  bool is_boundary() const { return is_boundary_; }
  /// The HDF5 file that it refers to, which is beside it, and that of the volume, which has the
  /// points.
  fs::path data() const { return path_.parent_path() / data_; }
  fs::path volume_data() const { return path_.parent_path() / volume_data_; }
  PatchNames patches() const { return names_in(text_); }

  /// Throws unless that is how data of these sizes are described: `elements` are cells or faces.
  void require(std::size_t nodes, std::size_t elements, const Point3& origin) const {
    const auto rows = static_cast<std::int64_t>(elements),
               points = static_cast<std::int64_t>(nodes);
    const std::string expected =
        is_boundary_ ? boundary_description(points, rows, patches(), origin, volume_data_, data_)
                     : volume_description(points, rows, has_zones_, origin, data_);
    if (text_ == expected) return;
    const auto [is, should_be] =
        std::mismatch(text_.begin(), text_.end(), expected.begin(), expected.end());
    const auto line = 1 + std::count(text_.begin(), is, '\n');
    fail(fmt::format("does not describe the data that {} has, from line {} on", data_, line));
  }

 private:
  static constexpr std::int64_t kLongest = 1 << 16;

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
  bool is_boundary_ = false, has_zones_ = false;
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

/// The faces with a numbering of their own, in the order of the volume's.
SurfaceMesh compact(const std::vector<std::array<double, 3>>& points,
                    const std::vector<std::array<std::int64_t, 3>>& faces) {
  SurfaceMesh surface;
  constexpr std::int32_t kUnused = -1;
  std::vector<std::int32_t> number(points.size(), kUnused);
  for (const auto& face : faces)
    for (const std::int64_t v : face) number[static_cast<std::size_t>(v)] = 0;
  for (std::size_t v = 0; v < points.size(); ++v) {
    if (number[v] == kUnused) continue;
    number[v] = static_cast<std::int32_t>(surface.points.size());
    surface.points.push_back(points[v]);
  }
  surface.triangles.reserve(faces.size());
  for (const auto& face : faces)
    surface.triangles.push_back({number[static_cast<std::size_t>(face[0])],
                                 number[static_cast<std::size_t>(face[1])],
                                 number[static_cast<std::size_t>(face[2])]});
  return surface;
}

TetMesh read_volume(const fs::path& path, const Description& description) {
  const Hdf5Input file(description.data());
  require_room_for_mesh(path, file.rows<std::array<double, 3>>(kGeometry),
                        file.rows<std::array<std::int64_t, 4>>(kTopology));
  TetMesh volume;
  volume.points = file.read<std::array<double, 3>>(kGeometry);
  volume.cells = file.read<std::array<std::int64_t, 4>>(kTopology);
  volume.region = file.read<std::int32_t>(kRegion);
  if (volume.region.size() != volume.cells.size()) file.fail("has not as many regions as cells");
  description.require(volume.points.size(), volume.cells.size(), read_origin(file));
  require_corners(file, kTopology, volume.cells, volume.points.size());
  return volume;
}

SurfaceMesh read_boundary(const fs::path& path, const Description& description) {
  const Hdf5Input file(description.data()), volume(description.volume_data());
  require_room_for_surface(path, volume.rows<std::array<double, 3>>(kGeometry),
                           file.rows<std::array<std::int64_t, 3>>(kFaces));
  const auto points = volume.read<std::array<double, 3>>(kGeometry);
  const auto faces = file.read<std::array<std::int64_t, 3>>(kFaces);
  const auto patches = file.read<std::int32_t>(kPatch);
  const auto buildings = file.read<std::int32_t>(kBuilding);
  if (patches.size() != faces.size() || buildings.size() != faces.size())
    file.fail("has not as many tags as boundary faces");
  if (faces.size() > std::numeric_limits<std::int32_t>::max() / 3)
    file.fail("has more boundary faces than can be read");
  description.require(points.size(), faces.size(), read_origin(file));
  require_corners(file, kFaces, faces, points.size());

  SurfaceMesh surface = compact(points, faces);
  set_patches(patches, description.patches(), surface,
              [&](const std::string& what) { file.fail(what); });
  surface.building = {buildings.begin(), buildings.end()};
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

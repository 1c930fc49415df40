#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
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

/// The description: XML, a few lines.
class Description {
 public:
  explicit Description(const fs::path& path)
      : path_(path), text_(PositionedFile(path).head(kLongest)) {
    const std::string after = fmt::format(":{}</DataItem>", kGeometry);
    constexpr std::string_view kBefore = "Format=\"HDF\">";
    const std::size_t end = text_.find(after);
    const std::size_t begin = end == std::string::npos ? end : text_.rfind(kBefore, end);
    if (begin == std::string::npos) fail(fmt::format("does not refer to {}", kGeometry));
    data_name_ = text_.substr(begin + kBefore.size(), end - begin - kBefore.size());
    if (fs::path(data_name_) != fs::path(data_name_).filename())
      fail("refers to data in another folder");
  }

  /// The HDF5 file that it refers to, which is beside it.
  fs::path data_path() const { return path_.parent_path() / data_name_; }

  /// Throws unless that is how data of these sizes are described.
  void require(const Sizes& sizes) const {
    const std::optional<Point3> stated = origin();
    if (!stated) fail("does not state its origin");
    const std::string expected = description(sizes, *stated, data_name_);
    if (text_ == expected) return;
    const auto [is, should_be] =
        std::mismatch(text_.begin(), text_.end(), expected.begin(), expected.end());
    const auto line = 1 + std::count(text_.begin(), is, '\n');
    fail(fmt::format("does not describe the data that {} has, from line {} on", data_name_, line));
  }

  std::optional<Point3> origin() const {
    constexpr std::string_view kBefore = "<Information Name=\"origin\" Value=\"";
    const std::size_t begin = text_.find(kBefore);
    if (begin == std::string::npos) return std::nullopt;
    const std::size_t value = begin + kBefore.size();
    return point_from_text(text_.substr(value, text_.find('"', value) - value));
  }

 private:
  static constexpr std::int64_t kLongest = 1 << 16;

  [[noreturn]] void fail(const std::string& what) const {
    fail_input(path_, what + "; only XDMF as tetropolis writes it can be read");
  }

  fs::path path_;
  std::string text_;
  std::string data_name_;
};

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

}  // namespace

XdmfMesh read_xdmf(const fs::path& path) {
  const Description description(path);
  const Hdf5Input file(description.data_path());
  XdmfMesh mesh;
  mesh.origin = description.origin();
  TetMesh& volume = mesh.volume;
  require_room_for_mesh(path, file.rows<std::array<double, 3>>(kGeometry),
                        file.rows<std::array<std::int64_t, 4>>(kTopology));
  volume.points = file.read<std::array<double, 3>>(kGeometry);
  volume.cells = file.read<std::array<std::int64_t, 4>>(kTopology);
  volume.region = file.read<std::int32_t>(kRegion);
  const auto faces = file.read<std::array<std::int64_t, 3>>(kFaces);
  const auto patches = file.read<std::int32_t>(kPatch);
  auto buildings = file.read<std::int32_t>(kBuilding);

  const std::size_t cells = volume.cells.size();
  if (volume.region.size() != cells) file.fail("has not as many regions as cells");
  if (patches.size() != faces.size() || buildings.size() != faces.size())
    file.fail("has not as many tags as boundary faces");
  if (faces.size() > std::numeric_limits<std::int32_t>::max() / 3)
    file.fail("has more boundary faces than can be read");
  description.require({static_cast<std::int64_t>(volume.points.size()),
                       static_cast<std::int64_t>(cells), static_cast<std::int64_t>(faces.size())});
  require_corners(file, kTopology, volume.cells, volume.points.size());
  require_corners(file, kFaces, faces, volume.points.size());

  mesh.boundary = compact(volume.points, faces);
  set_patches(patches, mesh.boundary, [&](const std::string& what) { file.fail(what); });
  mesh.boundary.building = std::move(buildings);
  return mesh;
}

}  // namespace tetropolis

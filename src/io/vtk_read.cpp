#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tetropolis/core/error.h"
#include "tetropolis/io/vtk.h"

namespace tetropolis {

namespace {

constexpr std::size_t kLongestHead = 1 << 20;

struct AppendedArray {
  std::string type;
  std::uint64_t offset = 0;
};

/// An open VTK XML file with raw appended data.
struct VtkFile {
  std::filesystem::path path;
  std::ifstream stream;
  std::map<std::string, AppendedArray> arrays;
  std::uint64_t points = 0;
  std::uint64_t cells = 0;
  std::uint64_t data_start = 0;  // byte after the underscore
  std::uint64_t size = 0;

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorKind::kInput, path.string() + ": " + what);
  }
};

/// Value of an attribute in a tag, or an empty string.
std::string attribute(std::string_view tag, const std::string& name) {
  const std::string key = " " + name + "=\"";
  const std::size_t begin = tag.find(key);
  if (begin == std::string_view::npos) return {};
  const std::size_t end = tag.find('"', begin + key.size());
  if (end == std::string_view::npos) return {};
  return std::string(tag.substr(begin + key.size(), end - begin - key.size()));
}

std::uint64_t to_number(const VtkFile& file, const std::string& text, const char* what) {
  if (text.empty() || text.find_first_not_of("0123456789") != std::string::npos || text.size() > 18)
    file.fail(std::string("not a number in the header: ") + what);
  return std::stoull(text);
}

/// Reads the XML head: counts, arrays and where the appended data starts.
VtkFile open_vtk(const std::filesystem::path& path, const std::string& type,
                 const std::string& cell_count_name) {
  VtkFile file;
  file.path = path;
  file.stream.open(path, std::ios::binary);
  if (!file.stream) file.fail("cannot be opened: " + std::string(std::strerror(errno)));
  std::string head(kLongestHead, '\0');
  file.stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.stream.gcount()));
  file.stream.clear();
  file.stream.seekg(0, std::ios::end);
  file.size = static_cast<std::uint64_t>(file.stream.tellg());

  if (head.find("<VTKFile") == std::string::npos ||
      head.find("type=\"" + type + "\"") == std::string::npos)
    file.fail("is not a VTK XML file of type " + type);
  const std::size_t appended = head.find("<AppendedData");
  if (appended == std::string::npos || head.find("encoding=\"raw\"", appended) == std::string::npos)
    file.fail("has no raw appended data; write it again with that data mode");
  if (head.find("header_type=\"UInt64\"") == std::string::npos ||
      head.find("compressor=") < appended)
    file.fail(
        "is compressed or has 32-bit headers; write it again uncompressed, with 64-bit headers");
  const std::size_t underscore = head.find('_', head.find('>', appended));
  if (underscore == std::string::npos) file.fail("has no appended data");
  file.data_start = underscore + 1;
  head.resize(appended);

  const std::size_t piece = head.find("<Piece");
  if (piece == std::string::npos) file.fail("has no <Piece>");
  const std::string piece_tag = head.substr(piece, head.find('>', piece) - piece);
  file.points = to_number(file, attribute(piece_tag, "NumberOfPoints"), "NumberOfPoints");
  file.cells = to_number(file, attribute(piece_tag, cell_count_name), cell_count_name.c_str());
  if (file.points > file.size / 12 + 1 || file.cells > file.size / 12 + 1)
    file.fail("announces more points or cells than its size can hold: the file is cut");
  for (std::size_t at = head.find("<DataArray", piece); at != std::string::npos;
       at = head.find("<DataArray", at + 1)) {
    const std::string tag = head.substr(at, head.find('>', at) - at);
    if (attribute(tag, "format") != "appended") continue;
    file.arrays[attribute(tag, "Name")] = {attribute(tag, "type"),
                                           to_number(file, attribute(tag, "offset"), "offset")};
  }
  return file;
}

template <typename Stored, typename Value>
void read_values(VtkFile& file, std::vector<Value>& values) {
  std::vector<Stored> buffer(std::min<std::size_t>(values.size(), 1 << 20));
  for (std::size_t done = 0; done < values.size(); done += buffer.size()) {
    const std::size_t count = std::min(buffer.size(), values.size() - done);
    file.stream.read(reinterpret_cast<char*>(buffer.data()),
                     static_cast<std::streamsize>(count * sizeof(Stored)));
    if (!file.stream) file.fail("ends inside an array: the file is cut");
    for (std::size_t i = 0; i < count; ++i) values[done + i] = static_cast<Value>(buffer[i]);
  }
}

/// The array `name` with exactly `count` numbers.
template <typename Value>
std::vector<Value> read_array(VtkFile& file, const std::string& name, std::uint64_t count) {
  const auto found = file.arrays.find(name);
  if (found == file.arrays.end()) file.fail("has no appended array " + name);
  const std::string& type = found->second.type;
  const std::uint64_t width = type == "Float64" || type == "Int64"                       ? 8
                              : type == "Float32" || type == "Int32" || type == "UInt32" ? 4
                              : type == "UInt8"                                          ? 1
                                                                                         : 0;
  if (width == 0) file.fail("array " + name + " has the unsupported type " + type);
  std::uint64_t bytes = 0;
  file.stream.clear();
  file.stream.seekg(static_cast<std::streamoff>(file.data_start + found->second.offset));
  file.stream.read(reinterpret_cast<char*>(&bytes), sizeof bytes);
  if (!file.stream) file.fail("ends before array " + name + ": the file is cut");
  if (bytes != count * width)
    file.fail("array " + name + " has " + std::to_string(bytes) + " bytes, " +
              std::to_string(count * width) + " expected");
  if (bytes > file.size) file.fail("ends inside array " + name + ": the file is cut");
  std::vector<Value> values(count);
  if (type == "Float64") read_values<double>(file, values);
  if (type == "Float32") read_values<float>(file, values);
  if (type == "Int64") read_values<std::int64_t>(file, values);
  if (type == "Int32") read_values<std::int32_t>(file, values);
  if (type == "UInt32") read_values<std::uint32_t>(file, values);
  if (type == "UInt8") read_values<std::uint8_t>(file, values);
  return values;
}

std::vector<std::array<double, 3>> read_points(VtkFile& file) {
  const std::vector<double> flat = read_array<double>(file, "Points", file.points * 3);
  std::vector<std::array<double, 3>> points(file.points);
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] = {flat[3 * i], flat[3 * i + 1], flat[3 * i + 2]};
  return points;
}

/// Connectivity of cells with `Corners` vertices each, checked against the number of points.
template <std::size_t Corners, typename Index>
std::vector<std::array<Index, Corners>> read_cells(VtkFile& file) {
  const auto flat = read_array<std::int64_t>(file, "connectivity", file.cells * Corners);
  const auto ends = read_array<std::int64_t>(file, "offsets", file.cells);
  std::vector<std::array<Index, Corners>> cells(file.cells);
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (ends[c] != static_cast<std::int64_t>(Corners * (c + 1)))
      file.fail("cell " + std::to_string(c) + " does not have " + std::to_string(Corners) +
                " vertices");
    for (std::size_t i = 0; i < Corners; ++i) {
      const std::int64_t v = flat[Corners * c + i];
      if (v < 0 || v >= static_cast<std::int64_t>(file.points))
        file.fail("cell " + std::to_string(c) + " has the vertex " + std::to_string(v) + " of " +
                  std::to_string(file.points));
      cells[c][i] = static_cast<Index>(v);
    }
  }
  return cells;
}

}  // namespace

TetMesh read_vtu(const std::filesystem::path& path) {
  VtkFile file = open_vtk(path, "UnstructuredGrid", "NumberOfCells");
  constexpr std::uint8_t kVtkTetra = 10;
  for (const std::uint8_t type : read_array<std::uint8_t>(file, "types", file.cells))
    if (type != kVtkTetra)
      file.fail("has a cell of VTK type " + std::to_string(type) +
                "; only tets (10) are supported");
  TetMesh mesh;
  mesh.points = read_points(file);
  mesh.cells = read_cells<4, std::int64_t>(file);
  if (file.arrays.contains("region"))
    mesh.region = read_array<std::int32_t>(file, "region", file.cells);
  return mesh;
}

SurfaceMesh read_vtp(const std::filesystem::path& path) {
  VtkFile file = open_vtk(path, "PolyData", "NumberOfPolys");
  if (file.points > static_cast<std::uint64_t>(std::numeric_limits<std::int32_t>::max()))
    file.fail("has more than 2^31 points");
  SurfaceMesh surface;
  surface.points = read_points(file);
  surface.triangles = read_cells<3, std::int32_t>(file);
  const auto patches = read_array<std::int32_t>(file, "patch", file.cells);
  for (std::size_t f = 0; f < patches.size(); ++f) {
    if (patches[f] < 1 || patches[f] > kPatchCount)
      file.fail("face " + std::to_string(f) + " has the patch " + std::to_string(patches[f]) +
                "; 1 to 8 expected");
    surface.patch.push_back(static_cast<Patch>(patches[f]));
  }
  surface.building = read_array<std::int32_t>(file, "building", file.cells);
  return surface;
}

}  // namespace tetropolis

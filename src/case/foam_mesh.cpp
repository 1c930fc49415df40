#include "foam_mesh.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <regex>
#include <sstream>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "tetropolis/core/error.h"

#include "geometry/vec3.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const fs::path& path, const std::string& what) {
  throw Error(
      ErrorKind::kInput,
      fmt::format("{}: {}; mesh the city again with `formats` = openfoam", path.string(), what));
}

/// A file of a mesh: its header, and lists one after the other.
class FoamFile {
 public:
  explicit FoamFile(fs::path path) : path_(std::move(path)) {
    std::error_code error;
    const std::uintmax_t size = fs::file_size(path_, error);
    std::ifstream file(path_, std::ios::binary);
    if (error || !file) fail(path_, "cannot be read");
    text_.resize(size);
    if (!file.read(text_.data(), static_cast<std::streamsize>(size))) fail(path_, "cannot be read");
    const std::size_t end = text_.find('}');
    if (text_.find("FoamFile") == std::string::npos || end == std::string::npos)
      fail(path_, "is no file of OpenFOAM");
    header_ = text_.substr(0, end);
    at_ = end + 1;
  }

  const std::string& header() const { return header_; }
  std::string_view rest() const { return std::string_view(text_).substr(at_); }

  /// The next list.
  template <typename Row>
  std::vector<Row> list() {
    if (header_.find("label=32;scalar=64") == std::string::npos)
      fail(path_, "is not binary with 32-bit labels, as it was written");
    at_ = text_.find_first_of("0123456789", at_);
    std::size_t rows = 0;
    if (at_ != std::string::npos) {
      const char* end = text_.data() + text_.size();
      const std::from_chars_result read = std::from_chars(text_.data() + at_, end, rows);
      const char* open = std::find_if(read.ptr, end, [](char c) { return c != '\n'; });
      at_ = read.ec == std::errc() && open < end && *open == '('
                ? static_cast<std::size_t>(open - text_.data()) + 1
                : std::string::npos;
    }
    if (at_ == std::string::npos || rows > (text_.size() - at_) / sizeof(Row))
      fail(path_, "is cut or changed");
    std::vector<Row> list(rows);
    if (rows > 0) std::memcpy(list.data(), text_.data() + at_, rows * sizeof(Row));
    at_ += rows * sizeof(Row);
    return list;
  }

 private:
  fs::path path_;
  std::string text_;
  std::string header_;
  std::size_t at_ = 0;
};

/// Of the note that write_openfoam leaves.
void read_note(const std::string& header, FoamMesh& mesh) {
  const auto numbers = [&](const char* name, auto&... values) {
    const std::size_t at = header.find(name);
    if (at == std::string::npos) return;
    std::istringstream words(header.substr(at + std::string_view(name).size()));
    (words >> ... >> values);
  };
  numbers("\"origin ", mesh.origin[0], mesh.origin[1], mesh.origin[2]);
  numbers(" town ", mesh.town.xmin, mesh.town.ymin, mesh.town.xmax, mesh.town.ymax);
}

std::vector<FoamPatch> read_patches(const fs::path& path) {
  const FoamFile file(path);
  const std::string text(file.rest());
  const std::regex entry(R"(([^\s{}()]+)\s*\{([^}]*)\})");
  const auto number = [&](const std::string& body, const char* key) {
    std::smatch found;
    if (!std::regex_search(body, found, std::regex(std::string(key) + R"(\s+(\d{1,10})\s*;)")))
      fail(path, fmt::format("a patch has no {}", key));
    return static_cast<std::size_t>(std::stoll(found[1]));
  };
  std::vector<FoamPatch> patches;
  for (std::sregex_iterator i(text.begin(), text.end(), entry), end; i != end; ++i) {
    const std::string body = (*i)[2];
    const std::size_t begin = number(body, "startFace");
    patches.push_back({(*i)[1], std::regex_search(body, std::regex(R"(type\s+wall\s*;)")), begin,
                       begin + number(body, "nFaces")});
  }
  return patches;
}

/// A number after a word, or nothing. Precondition: the word is none of a longer one.
std::optional<double> number_after(const std::string& text, const std::string& word) {
  const std::size_t at = text.find(word);
  if (at == std::string::npos) return std::nullopt;
  const char* from = text.c_str() + at + word.size();
  from += std::strspn(from, " \t\r\n");
  double value = 0;
  const auto read = std::from_chars(from, text.c_str() + text.size(), value);
  if (read.ec != std::errc()) return std::nullopt;
  return value;
}

/// Numbers of cells up to the first word that is none.
std::vector<std::int32_t> labels_in(const char* at, const char* end, std::size_t cell_count) {
  std::vector<std::int32_t> labels;
  for (;;) {
    at += std::strspn(at, " \t\r\n");
    std::int32_t label = -1;
    const auto read = std::from_chars(at, end, label);
    if (read.ec != std::errc() || label < 0 || static_cast<std::size_t>(label) >= cell_count)
      return labels;
    labels.push_back(label);
    at = read.ptr;
  }
}

std::vector<FoamCanopy> read_canopies(const fs::path& path, std::size_t cell_count) {
  std::error_code error;
  if (!fs::exists(path, error)) return {};
  const FoamFile file(path);
  // Ours are text; what another program has written has no leaves.
  if (file.header().find("binary") != std::string::npos) return {};
  const std::string text(file.rest());
  const auto is_space = [](char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; };
  std::vector<FoamCanopy> canopies;
  std::size_t open = 0, close = 0;
  for (; (open = text.find('{', close)) != std::string::npos; ++close) {
    close = text.find('}', open);
    if (close == std::string::npos) fail(path, "is cut or changed");
    std::size_t end = open;
    while (end > 0 && is_space(text[end - 1])) --end;
    std::size_t begin = end;
    while (begin > 0 && !is_space(text[begin - 1]) && text[begin - 1] != '(') --begin;
    const std::string body = text.substr(open, close - open);
    const auto density = number_after(body, "leafAreaDensity");
    const auto cells = number_after(body, "List<label>");
    if (!density || !cells) continue;
    FoamCanopy canopy{text.substr(begin, end - begin), *density, {}};
    if (const std::size_t list = body.find('(', body.find("List<label>")); list != body.npos)
      canopy.cells = labels_in(body.c_str() + list + 1, body.c_str() + body.size(), cell_count);
    if (!(*density > 0) || !std::isfinite(*density) ||
        static_cast<double>(canopy.cells.size()) != *cells)
      fail(path, fmt::format("the zone {} is changed", canopy.name));
    if (!canopy.cells.empty()) canopies.push_back(std::move(canopy));
  }
  return canopies;
}

void require_consistent(const fs::path& folder, const FoamMesh& mesh) {
  const auto all = [](const auto& numbers, std::size_t end) {
    return std::all_of(numbers.begin(), numbers.end(),
                       [&](std::int32_t n) { return n >= 0 && static_cast<std::size_t>(n) < end; });
  };
  const auto faces = [&] {
    return mesh.face_start.size() == mesh.owner.size() + 1 && mesh.face_start.front() == 0 &&
           std::adjacent_find(mesh.face_start.begin(), mesh.face_start.end(),
                              [](std::int32_t a, std::int32_t b) { return b < a + 3; }) ==
               mesh.face_start.end() &&
           static_cast<std::size_t>(mesh.face_start.back()) == mesh.face_points.size();
  };
  const auto is_finite = [](const auto& p) {
    return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
  };
  if (!std::all_of(mesh.points.begin(), mesh.points.end(), is_finite))
    fail(folder / "points", "has coordinates that are no numbers");
  if (mesh.owner.empty() || !faces() || !all(mesh.face_points, mesh.points.size()))
    fail(folder / "faces", "does not fit the other files");
  if (mesh.neighbour.size() >= mesh.owner.size() || !all(mesh.owner, mesh.cells()) ||
      !all(mesh.neighbour, mesh.cells()))
    fail(folder / "neighbour", "does not fit the other files");
  std::size_t next = mesh.neighbour.size();
  for (const FoamPatch& patch : mesh.patches) {
    if (patch.begin != next || patch.end > mesh.faces())
      fail(folder / "boundary", fmt::format("the patch {} does not fit the faces", patch.name));
    next = patch.end;
  }
  if (next != mesh.faces()) fail(folder / "boundary", "some faces have no patch");
}

/// The file `boundary` with its patch `ground` in two, the second from face `at`. The rest stays.
std::string with_open_land(std::string text, const FoamPatch& ground, std::size_t at) {
  std::smatch entry;
  std::regex_search(text, entry, std::regex(R"(\sground\s*\{[^}]*\})"));
  const auto part = [&, whole = entry.str()](const char* name, std::size_t begin, std::size_t end) {
    std::string one =
        std::regex_replace(whole, std::regex(R"(^\sground)"), std::string(" ") + name);
    one = std::regex_replace(one, std::regex(R"(nFaces(\s+)\d+)"),
                             fmt::format("nFaces$01{}", end - begin));
    return std::regex_replace(one, std::regex(R"(startFace(\s+)\d+)"),
                              fmt::format("startFace$01{}", begin));
  };
  text.replace(static_cast<std::size_t>(entry.position()), entry.str().size(),
               part("ground", ground.begin, at) + "\n   " + part(kOpenLand, at, ground.end));
  const std::size_t count = text.find_first_of("0123456789", text.find('}'));
  const std::size_t end = text.find_first_not_of("0123456789", count);
  return text.replace(count, end - count,
                      std::to_string(std::stoul(text.substr(count, end - count)) + 1));
}

void split_off_open_land(const fs::path& folder, FoamMesh& mesh) {
  constexpr double kHair = 1e-3;  // [m]; the writer has sorted other roundings of these centres
  const auto ground = std::find_if(mesh.patches.begin(), mesh.patches.end(),
                                   [](const FoamPatch& patch) { return patch.name == "ground"; });
  if (ground == mesh.patches.end()) return;
  if (mesh.town.empty()) {
    for (const FoamPatch& patch : mesh.patches)
      if (patch.of_building() && patch.begin < patch.end)
        fail(folder / "points", "does not say where the town is: of an older version");
    return;
  }
  const auto is_within = [&](const Bounds2& box, std::size_t f) {
    const Point3 centre = face_geometry(mesh, f).centre;
    return box.contains({centre[0], centre[1]});
  };
  std::size_t at = ground->begin;
  while (at < ground->end && is_within(mesh.town.grown(kHair), at)) ++at;
  for (std::size_t f = at; f < ground->end; ++f)
    if (is_within(mesh.town.grown(-kHair), f))
      fail(folder / "faces",
           "has the ground among the buildings not first: renumbered, or of an older version");
  if (at == ground->end) return;
  const fs::path path = folder / "boundary";
  std::ifstream file(path, std::ios::binary);
  mesh.new_boundary = with_open_land({std::istreambuf_iterator<char>(file), {}}, *ground, at);
  const FoamPatch rest{kOpenLand, true, at, ground->end};
  ground->end = at;
  mesh.patches.insert(ground + 1, rest);
}

}  // namespace

FaceGeometry face_geometry(const FoamMesh& mesh, std::size_t f) {
  const auto corners = mesh.face(f);
  const auto count = static_cast<double>(corners.size());
  Point3 mean{};
  for (const std::int32_t p : corners)
    for (std::size_t c = 0; c < 3; ++c) mean[c] += mesh.point(p)[c] / count;
  FaceGeometry face;
  double weight = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Point3& a = mesh.point(corners[i]);
    const Point3& b = mesh.point(corners[(i + 1) % corners.size()]);
    const Point3 twice = cross(minus(b, a), minus(mean, a));
    const double size = std::sqrt(dot(twice, twice)) / 2;
    weight += size;
    for (std::size_t c = 0; c < 3; ++c) {
      face.area[c] += twice[c] / 2;
      face.centre[c] += size * (a[c] + b[c] + mean[c]) / 3;
    }
  }
  for (std::size_t c = 0; c < 3; ++c)
    face.centre[c] = weight > 0 ? face.centre[c] / weight : mean[c];
  return face;
}

FoamMesh read_foam_mesh(const fs::path& folder) {
  FoamMesh mesh;
  std::error_code error;
  if (!fs::is_directory(folder, error)) fail(folder, "is not there");
  FoamFile points(folder / "points");
  mesh.points = points.list<Point3>();
  read_note(points.header(), mesh);
  FoamFile faces(folder / "faces");
  mesh.face_start = faces.list<std::int32_t>();
  mesh.face_points = faces.list<std::int32_t>();
  if (mesh.face_start.empty()) fail(folder / "faces", "has no faces");
  mesh.owner = FoamFile(folder / "owner").list<std::int32_t>();
  mesh.neighbour = FoamFile(folder / "neighbour").list<std::int32_t>();
  for (const auto* cells : {&mesh.owner, &mesh.neighbour})
    for (const std::int32_t cell : *cells)
      mesh.cell_count = std::max(mesh.cell_count, static_cast<std::size_t>(std::max(cell, 0)) + 1);
  mesh.patches = read_patches(folder / "boundary");
  mesh.canopies = read_canopies(folder / "cellZones", mesh.cell_count);
  require_consistent(folder, mesh);
  split_off_open_land(folder, mesh);
  return mesh;
}

}  // namespace tetropolis

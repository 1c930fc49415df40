#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <tuple>

#include <fmt/format.h>

#include "tetropolis/check/check_mesh.h"
#include "tetropolis/core/parallel.h"

#include "violations.h"

namespace tetropolis {

namespace {

using Vector3 = std::array<double, 3>;

Vector3 difference(const Vector3& a, const Vector3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
double inner(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector3 outer(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double length(const Vector3& a) { return std::sqrt(inner(a, a)); }

struct CellShape {
  double volume, min_angle, max_angle, aspect;
};

/// Dihedral angles edge by edge, from the two faces' directions away from the edge.
CellShape cell_shape(const std::array<Vector3, 4>& p) {
  CellShape shape{0, std::numbers::pi, 0, 0};
  double longest = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = i + 1; j < 4; ++j) {
      std::size_t others[2];
      std::size_t count = 0;
      for (std::size_t m = 0; m < 4; ++m)
        if (m != i && m != j) others[count++] = m;
      const Vector3 edge = difference(p[j], p[i]);
      longest = std::max(longest, length(edge));
      const Vector3 a = outer(edge, difference(p[others[0]], p[i]));
      const Vector3 b = outer(edge, difference(p[others[1]], p[i]));
      const double angle = std::atan2(length(outer(a, b)), inner(a, b));
      shape.min_angle = std::min(shape.min_angle, angle);
      shape.max_angle = std::max(shape.max_angle, angle);
    }
  }
  const Vector3 u = difference(p[1], p[0]), v = difference(p[2], p[0]), w = difference(p[3], p[0]);
  shape.volume = inner(outer(u, v), w) / 6;
  const double surface = (length(outer(u, v)) + length(outer(v, w)) + length(outer(w, u)) +
                          length(outer(difference(p[2], p[1]), difference(p[3], p[1])))) /
                         2;
  const double inradius = 3 * std::abs(shape.volume) / surface;
  shape.aspect = inradius > 0 ? longest / (std::sqrt(24.0) * inradius)
                              : std::numeric_limits<double>::infinity();
  return shape;
}

Distribution distribution(std::vector<float>& values) {
  if (values.empty()) return {};
  parallel_sort(values.begin(), values.end(), [](float a, float b) { return a < b; });
  const auto at = [&](double share) {
    const auto rank = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
    return static_cast<double>(values[rank]);
  };
  return {at(0), at(1e-4), at(1e-3), at(1e-2), at(0.5), at(0.99), at(1)};
}

std::string place_of(const TetMesh& mesh, std::size_t c) {
  Vector3 centre{0, 0, 0};
  for (const std::int64_t v : mesh.cells[c])
    for (std::size_t d = 0; d < 3; ++d)
      centre[d] += mesh.points[static_cast<std::size_t>(v)][d] / 4;
  return fmt::format("cell {} at ({:.3f}, {:.3f}, {:.3f})", c, centre[0], centre[1], centre[2]);
}

void measure_cells(const TetMesh& mesh, VolumeCheck& check, const Progress& progress) {
  constexpr double degrees = 180 / std::numbers::pi;
  std::vector<float> angles(mesh.cells.size()), greatest(mesh.cells.size()),
      aspects(mesh.cells.size());
  std::vector<double> volumes(mesh.cells.size());
  progress.update(0);
  parallel_chunks(mesh.cells.size(), 16384, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      std::array<Vector3, 4> p;
      for (std::size_t i = 0; i < 4; ++i)
        p[i] = mesh.points[static_cast<std::size_t>(mesh.cells[c][i])];
      const CellShape shape = cell_shape(p);
      volumes[c] = shape.volume;
      angles[c] = static_cast<float>(shape.min_angle * degrees);
      greatest[c] = static_cast<float>(shape.max_angle * degrees);
      aspects[c] = static_cast<float>(shape.aspect);
    }
  });
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    check.volume += volumes[c];
    check.max_dihedral_deg = std::max(check.max_dihedral_deg, static_cast<double>(greatest[c]));
    if (volumes[c] > 0) continue;
    ++check.inverted;
    note_violation(check.violations, "inverted cells", [&] { return place_of(mesh, c); });
  }
  check.min_dihedral_deg = distribution(angles);
  check.aspect_ratio = distribution(aspects);
}

/// Coincident vertices would hide cracks; vertices without cells do not belong in a mesh.
void check_vertices(const TetMesh& mesh, VolumeCheck& check) {
  std::vector<bool> used(mesh.points.size(), false);
  for (const auto& cell : mesh.cells)
    for (const std::int64_t v : cell) used[static_cast<std::size_t>(v)] = true;
  std::vector<std::size_t> order;  // of the finite ones: others cannot be sorted
  order.reserve(mesh.points.size());
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    const auto place = [&] { return fmt::format("vertex {}", v); };
    if (!used[v]) note_violation(check.violations, "vertices without cells", place);
    if (std::all_of(mesh.points[v].begin(), mesh.points[v].end(),
                    [](double x) { return std::isfinite(x); }))
      order.push_back(v);
    else
      note_violation(check.violations, "coordinates that are not finite", place);
  }
  parallel_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::tie(mesh.points[a], a) < std::tie(mesh.points[b], b);
  });
  for (std::size_t i = 1; i < order.size(); ++i)
    if (mesh.points[order[i]] == mesh.points[order[i - 1]])
      note_violation(check.violations, "coincident vertices",
                     [&] { return fmt::format("vertices {} and {}", order[i - 1], order[i]); });
}

struct FaceUse {
  std::int64_t mid, high;  // the face's other vertices, ascending
  std::size_t cell;
  bool even;  // whether (lowest, mid, high) is the face's outward orientation
};

/// Outward faces of a positive tet.
constexpr std::array<std::array<std::size_t, 3>, 4> kFaces = {
    {{{1, 2, 3}}, {{0, 3, 2}}, {{0, 1, 3}}, {{0, 2, 1}}}};

/// The faces whose lowest vertex is in [begin, end), filed under it in a compressed row layout.
struct FaceTable {
  std::vector<std::size_t> offsets;
  std::vector<FaceUse> uses;
};

/// Calls use(lowest vertex, the face) for the faces of all cells with a lowest vertex in [begin,
/// end).
template <typename Use>
void for_each_face(const TetMesh& mesh, std::int64_t begin, std::int64_t end, const Use& use) {
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (const auto& corners : kFaces) {
      std::array<std::int64_t, 3> v{mesh.cells[c][corners[0]], mesh.cells[c][corners[1]],
                                    mesh.cells[c][corners[2]]};
      std::rotate(v.begin(), std::min_element(v.begin(), v.end()), v.end());
      if (v[0] >= begin && v[0] < end)
        use(static_cast<std::size_t>(v[0] - begin),
            FaceUse{std::min(v[1], v[2]), std::max(v[1], v[2]), c, v[1] < v[2]});
    }
}

FaceTable file_faces(const TetMesh& mesh, std::int64_t begin, std::int64_t end) {
  FaceTable table;
  table.offsets.assign(static_cast<std::size_t>(end - begin) + 1, 0);
  for_each_face(mesh, begin, end,
                [&](std::size_t low, const FaceUse&) { ++table.offsets[low + 1]; });
  for (std::size_t i = 1; i < table.offsets.size(); ++i) table.offsets[i] += table.offsets[i - 1];
  table.uses.resize(table.offsets.back());
  std::vector<std::size_t> next(table.offsets.begin(), table.offsets.end() - 1);
  for_each_face(mesh, begin, end,
                [&](std::size_t low, const FaceUse& face) { table.uses[next[low]++] = face; });
  return table;
}

/// Matches the faces whose lowest vertex is in [begin, end).
void match_faces(const TetMesh& mesh, std::int64_t begin, std::int64_t end, VolumeCheck& check) {
  FaceTable table = file_faces(mesh, begin, end);
  const auto row = [&](std::size_t low) {
    return std::span(table.uses)
        .subspan(table.offsets[low], table.offsets[low + 1] - table.offsets[low]);
  };
  parallel_chunks(table.offsets.size() - 1, 4096, [&](std::size_t first, std::size_t last) {
    for (std::size_t low = first; low < last; ++low)
      std::sort(row(low).begin(), row(low).end(), [](const FaceUse& a, const FaceUse& b) {
        return std::tie(a.mid, a.high, a.cell) < std::tie(b.mid, b.high, b.cell);
      });
  });
  for (std::int64_t low = begin; low < end; ++low) {
    const auto faces = row(static_cast<std::size_t>(low - begin));
    for (std::size_t i = 0, j = 0; i < faces.size(); i = j) {
      while (j < faces.size() && faces[j].mid == faces[i].mid && faces[j].high == faces[i].high)
        ++j;
      if (j - i == 1)
        check.boundary.push_back(
            faces[i].even ? std::array<std::int64_t, 3>{low, faces[i].mid, faces[i].high}
                          : std::array<std::int64_t, 3>{low, faces[i].high, faces[i].mid});
      else if (j - i > 2)
        note_violation(check.violations, "faces of more than two cells",
                       [&] { return place_of(mesh, faces[i].cell); });
      else if (faces[i].even == faces[i + 1].even)
        note_violation(check.violations, "neighbouring cells that overlap",
                       [&] { return place_of(mesh, faces[i].cell); });
    }
  }
}

void check_boundary(VolumeCheck& check) {
  struct Half {
    std::int64_t low, high;
    bool forward;
  };
  std::vector<Half> halves;
  for (const auto& face : check.boundary)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::int64_t a = face[i], b = face[(i + 1) % 3];
      halves.push_back({std::min(a, b), std::max(a, b), a < b});
    }
  parallel_sort(halves.begin(), halves.end(), [](const Half& a, const Half& b) {
    return std::tie(a.low, a.high, a.forward) < std::tie(b.low, b.high, b.forward);
  });
  for (std::size_t i = 0, j = 0; i < halves.size(); i = j) {
    while (j < halves.size() && halves[j].low == halves[i].low && halves[j].high == halves[i].high)
      ++j;
    if (j - i == 2 && halves[i].forward != halves[i + 1].forward) continue;
    note_violation(
        check.violations, j - i < 2 ? "open boundary edges" : "non-manifold boundary edges", [&] {
          return fmt::format("edge between vertices {} and {}", halves[i].low, halves[i].high);
        });
  }
}

}  // namespace

VolumeCheck check_volume(const TetMesh& mesh, const Progress& progress) {
  VolumeCheck check;
  check.vertices = static_cast<std::int64_t>(mesh.points.size());
  check.cells = static_cast<std::int64_t>(mesh.cells.size());
  if (mesh.cells.empty()) note_violation(check.violations, "no cells", [] { return "the file"; });
  check_vertices(mesh, check);
  measure_cells(mesh, check, progress);
  // Faces are matched for a range of lowest vertices at a time, which bounds the memory.
  const std::int64_t passes = 1 + check.cells / 4000000;
  const std::int64_t span = check.vertices / passes + 1;
  for (std::int64_t begin = 0; begin < check.vertices; begin += span) {
    progress.update(0.5 + 0.5 * static_cast<double>(begin) / static_cast<double>(check.vertices));
    match_faces(mesh, begin, std::min(begin + span, check.vertices), check);
  }
  check.boundary_faces = static_cast<std::int64_t>(check.boundary.size());
  check_boundary(check);
  return check;
}

}  // namespace tetropolis

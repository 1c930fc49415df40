#include "upper_faces.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <tuple>

#include "core/infinity.h"
#include "core/parallel.h"

namespace tetropolis {

namespace {

using Cell = UpperMesh::Cell;
using Places = std::array<UpperPlace, 3>;

constexpr std::size_t kFansPerChunk = 4096;

/// The faces of a cell, their normals outwards: the third is its top. Of a cell of a fan that goes
/// up the first is its bottom, and the others are between it and those before and after it.
constexpr std::array<std::array<std::size_t, 3>, 4> kFaces{
    {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
constexpr std::size_t kBottom = 0, kBefore = 1, kTop = 2, kAfter = 3;

Places face_of(const Cell& cell, std::size_t face) {
  const auto& corner = kFaces[face];
  return {cell[corner[0]], cell[corner[1]], cell[corner[2]]};
}

Places turned(const Places& p, std::size_t by) { return {p[by], p[(by + 1) % 3], p[(by + 2) % 3]}; }

struct FanCell {
  std::size_t fan, cell;
};

/// Finds cells by their tops.
class CellTops {
 public:
  explicit CellTops(const ColumnMesh& mesh)
      : upper_(mesh.upper), columns_(mesh.vertex_count()), fan_to_(upper_.nodes()) {
    begin_.assign(columns_ + upper_.nodes() + 1, 0);
    const auto for_each_at_end = [&](const auto& visit) {
      for (std::size_t f = 0; f + 1 < upper_.fans.size(); ++f) {
        if (upper_.fans[f].up.valid()) continue;
        for (std::size_t c = upper_.fans[f].cell; c < upper_.fans[f + 1].cell; ++c) {
          const Places top = face_of(upper_.cell(f, c), kTop);
          visit(FanCell{f, c}, *std::max_element(top.begin(), top.end()));
        }
      }
    };
    for_each_at_end([&](const FanCell&, UpperPlace highest) { ++begin_[highest]; });
    std::inclusive_scan(begin_.begin(), begin_.end(), begin_.begin());
    at_ends_.resize(begin_.back());
    for_each_at_end(
        [&](const FanCell& cell, UpperPlace highest) { at_ends_[--begin_[highest]] = cell; });
    for (std::size_t f = 0; f + 1 < upper_.fans.size(); ++f)
      if (const UpperPlace up = upper_.fans[f].up; up.valid())
        fan_to_[up - columns_] = static_cast<std::uint32_t>(f);
  }

  /// Counter-clockwise from above; nothing if it is on the lid.
  std::optional<FanCell> find(const Places& top) const {
    for (std::size_t i = 0; i < 3; ++i)
      if (top[i] >= columns_)
        if (const auto found = find_below(turned(top, i))) return found;
    const UpperPlace highest = *std::max_element(top.begin(), top.end());
    for (std::size_t i = begin_[highest]; i < begin_[highest + 1]; ++i) {
      const Places other = face_of(upper_.cell(at_ends_[i].fan, at_ends_[i].cell), kTop);
      if (other == top || other == turned(top, 1) || other == turned(top, 2)) return at_ends_[i];
    }
    return std::nullopt;
  }

 private:
  /// Of the fan that goes up to the first corner.
  std::optional<FanCell> find_below(const Places& top) const {
    const std::size_t f = fan_to_[top[0] - columns_];
    const UpperFan &fan = upper_.fans[f], &next = upper_.fans[f + 1];
    const UpperPlace* const other = upper_.others.data() + fan.other;
    for (std::size_t k = 0; k < next.cell - fan.cell; ++k)
      if (other[k] == top[1] && other[k + 1] == top[2]) return FanCell{f, fan.cell + k};
    return std::nullopt;
  }

  const UpperMesh& upper_;
  std::size_t columns_;
  std::vector<std::uint32_t> fan_to_;  // per node
  // Per place and one more: where those begin whose fan ends and whose tops have no higher one.
  std::vector<std::uint32_t> begin_;
  std::vector<FanCell> at_ends_;
};

/// Calls visit(face) for the faces below and between the cells of fan f.
template <typename Visit>
void visit_faces_of(const UpperMesh& upper, const CellTops& tops, std::size_t f,
                    const Visit& visit) {
  const std::size_t first = upper.fans[f].cell, end = upper.fans[f + 1].cell;
  const bool goes_up = upper.fans[f].up.valid();
  const auto below = [&](std::size_t c, const Cell& cell, std::size_t face) {
    const Places bottom = face_of(cell, face);
    const auto found = tops.find({bottom[0], bottom[2], bottom[1]});
    if (!found) return;
    const Cell other = upper.cell(found->fan, found->cell);
    if (c < found->cell)
      visit(InnerFace{{c, found->cell}, {cell, other}, bottom});
    else
      visit(InnerFace{{found->cell, c}, {other, cell}, face_of(other, kTop)});
  };
  const auto between = [&](std::size_t c, std::size_t d, std::size_t face) {
    const Cell cell = upper.cell(f, c);
    visit(InnerFace{{c, d}, {cell, upper.cell(f, d)}, face_of(cell, face)});
  };
  if (goes_up) {
    for (std::size_t c = first; c < end; ++c) {
      below(c, upper.cell(f, c), kBottom);
      if (c + 1 < end) between(c, c + 1, kAfter);
    }
    if (upper.others[upper.fans[f].other] == upper.others[upper.fans[f + 1].other - 1])
      between(first, end - 1, kBefore);
    return;
  }
  for (std::size_t c = first; c < end; ++c) {
    const Cell cell = upper.cell(f, c);
    for (const std::size_t face : {kBottom, kBefore, kAfter}) {
      const Places own = face_of(cell, face);
      const auto is_beyond = [&](std::size_t d) {
        const Cell other = upper.cell(f, d);
        for (const std::size_t back : {kBottom, kBefore, kAfter})
          if (face_of(other, back) == Places{own[0], own[2], own[1]}) return true;
        return false;
      };
      std::size_t d = first;
      while (d < end && !is_beyond(d)) ++d;
      if (d == end)
        below(c, cell, face);
      else if (d > c)
        between(c, d, face);
    }
  }
}

}  // namespace

std::array<Point3, 4> uppermost_cell(const ColumnMesh& mesh, TriangleIndex t) {
  const auto& v = mesh.ground.triangles[t];
  const auto last_key = [&](std::size_t i) {
    return climbing_key(mesh.climbing().data(), mesh.top(v[i]) - 1);
  };
  std::size_t last = 0;
  for (std::size_t i = 1; i < 3; ++i)
    if (!climbs_first(last_key(i), v[i], last_key(last), v[last])) last = i;
  std::array<Point3, 4> p{};
  for (std::size_t i = 0; i < 3; ++i) p[i] = position(mesh, v[i], mesh.top(v[i]));
  p[3] = p[last];
  p[last][2] = mesh.z[mesh.top(v[last]) - 1];
  return p;
}

std::size_t inner_face_chunks(const ColumnMesh& mesh) {
  return (mesh.upper.fans.size() + kFansPerChunk - 1) / kFansPerChunk;
}

void visit_inner_faces(const ColumnMesh& mesh,
                       const std::function<void(std::size_t, const InnerFace&)>& visit) {
  const UpperMesh& upper = mesh.upper;
  if (upper.empty()) return;
  const CellTops tops(mesh);
  parallel_chunks(upper.fans.size() - 1, kFansPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f)
      visit_faces_of(upper, tops, f,
                     [&](const InnerFace& face) { visit(begin / kFansPerChunk, face); });
  });
}

void visit_outer_faces(const ColumnMesh& mesh,
                       const std::function<void(std::size_t, const UpperMesh::Cell&,
                                                const std::array<UpperPlace, 3>&, bool)>& visit) {
  const UpperMesh& upper = mesh.upper;
  const auto z = [&](UpperPlace p) { return elevation(mesh, upper_node(mesh, p)); };
  double top = -kInfinity;
  for (std::int32_t p = 0; p < std::ssize(upper.z) + std::ssize(mesh.ground.vertices); ++p)
    top = std::max(top, z(UpperPlace(p)));
  for (std::size_t f = 0; f + 1 < upper.fans.size(); ++f) {
    const UpperFan &fan = upper.fans[f], &next = upper.fans[f + 1];
    for (std::size_t c = fan.cell; c < next.cell; ++c) {
      const Cell cell = upper.cell(f, c);
      const Places places = face_of(cell, kTop);
      if (z(places[2]) == top && z(places[0]) == top && z(places[1]) == top)
        visit(c, cell, places, true);
    }
    if (!fan.up.valid() || upper.others[fan.other] == upper.others[next.other - 1]) continue;
    // Columns at the rim do not end.
    const Cell first = upper.cell(f, fan.cell), last = upper.cell(f, next.cell - 1);
    visit(fan.cell, first, face_of(first, kBefore), false);
    visit(next.cell - 1, last, face_of(last, kAfter), false);
  }
}

std::vector<UpperFace> upper_faces(const ColumnMesh& mesh) {
  std::vector<std::vector<UpperFace>> parts(inner_face_chunks(mesh));
  visit_inner_faces(mesh, [&](std::size_t chunk, const InnerFace& face) {
    const auto cell = [&](std::size_t i) { return static_cast<std::uint32_t>(face.cells[i]); };
    parts[chunk].push_back({cell(0), cell(1), face.places});
  });
  std::vector<UpperFace> faces;
  faces.reserve(2 * mesh.upper.cells());
  for (std::vector<UpperFace>& part : parts) {
    faces.insert(faces.end(), part.begin(), part.end());
    part = {};
  }
  parallel_sort(faces.begin(), faces.end(), [](const UpperFace& a, const UpperFace& b) {
    return std::tie(a.cell, a.neighbour) < std::tie(b.cell, b.neighbour);
  });
  return faces;
}

}  // namespace tetropolis

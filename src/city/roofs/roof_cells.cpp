#include "city/roofs/roof_cells.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "tetropolis/core/row_major.h"
#include "tetropolis/geometry/polygon.h"

#include "core/infinity.h"
#include "core/ragged_builder.h"
#include "geometry/predicates.h"
#include "geometry/vec2.h"

namespace tetropolis {

namespace {

/// The direction of the walls, modulo a right angle, weighted by their lengths.
double main_direction(const Polygon& footprint) {
  double c = 0, s = 0;
  for_each_edge(footprint, [&](Point2 a, Point2 b) {
    const double angle = 4 * std::atan2(b.y - a.y, b.x - a.x);
    c += distance(a, b) * std::cos(angle);
    s += distance(a, b) * std::sin(angle);
  });
  return std::atan2(s, c) / 4;
}

void add_ring(const Ring& ring, double step, PlanarGraph& graph) {
  const std::size_t first = graph.points.size();
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point2 a = ring[i], b = ring[(i + 1) % ring.size()];
    const double count = std::max(1.0, std::ceil(distance(a, b) / step));
    graph.points.push_back(a);
    for (double k = 1; k < count; ++k)
      graph.points.push_back({a.x + (b.x - a.x) * k / count, a.y + (b.y - a.y) * k / count});
  }
  const std::size_t last = graph.points.size();
  for (std::size_t i = first; i < last; ++i)
    graph.segments.push_back({VertexIndex(i), VertexIndex(i + 1 < last ? i + 1 : first)});
}

/// Rows of points in the footprint, each shifted by half a step against the next.
void add_interior(const Polygon& footprint, double step, PlanarGraph& graph) {
  const double angle = main_direction(footprint);
  const double ux = std::cos(angle), uy = std::sin(angle);
  Bounds2 box = Bounds2::nothing();
  for (const Point2 p : footprint.outer)
    box.extend(Point2{p.x * ux + p.y * uy, p.y * ux - p.x * uy});
  const auto rows = static_cast<int>(box.height() / step + 0.5);
  const auto columns = static_cast<int>(box.width() / step + 0.75);
  // Per row, only edges near to it count.
  struct Edge {
    Point2 a, b;
  };
  std::vector<std::vector<Edge>> near(static_cast<std::size_t>(rows) + 1);
  const auto turned = [&](Point2 p) { return Point2{p.x * ux + p.y * uy, p.y * ux - p.x * uy}; };
  for_each_edge(footprint, [&](Point2 a, Point2 b) {
    const Point2 p = turned(a), q = turned(b);
    const auto row = [&](double v) {
      return std::clamp(static_cast<int>((v - box.ymin) / step), 0, rows);
    };
    for (int j = row(std::min(p.y, q.y) - step); j <= row(std::max(p.y, q.y) + step); ++j)
      near[static_cast<std::size_t>(j)].push_back({p, q});
  });
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const Point2 p{box.xmin + (i + (j % 2 == 1 ? 0.75 : 0.25)) * step,
                     box.ymin + (j + 0.5) * step};
      bool inside = false, close = false;
      for (const Edge& e : near[static_cast<std::size_t>(j)]) {
        inside ^= crosses_ray(e.a, e.b, p);
        close = close || squared_distance_to_segment(p, e.a, e.b) < 0.2 * step * step;
      }
      if (inside && !close) graph.points.push_back({p.x * ux - p.y * uy, p.x * uy + p.y * ux});
    }
}

std::vector<std::array<CellNumber, 3>> neighbours_of(const Triangulation& mesh) {
  struct CellSide {
    VertexIndex high;
    CellNumber cell;
    std::size_t edge;
  };
  const auto for_each_side = [&](const auto& visit) {
    for (std::size_t c = 0; c < mesh.triangles.size(); ++c)
      for (std::size_t e = 0; e < 3; ++e) {
        const auto [low, high] =
            std::minmax(mesh.triangles[c][(e + 1) % 3], mesh.triangles[c][(e + 2) % 3]);
        visit(low, CellSide{high, static_cast<CellNumber>(c), e});
      }
  };
  // By the lower end, of which there are few.
  std::vector<std::size_t> end(mesh.points.size() + 1, 0);
  for_each_side([&](VertexIndex low, const CellSide&) { ++end[low + 1]; });
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::vector<std::size_t> begin = end;
  std::vector<CellSide> sides(end.back());
  std::vector<std::array<CellNumber, 3>> result(mesh.triangles.size(), {-1, -1, -1});
  for_each_side([&](VertexIndex low, const CellSide& side) {
    for (std::size_t i = begin[low]; i < end[low]; ++i) {
      if (sides[i].high != side.high) continue;
      result[index(side.cell)][side.edge] = sides[i].cell;
      result[index(sides[i].cell)][sides[i].edge] = side.cell;
      return;
    }
    sides[end[low]++] = side;
  });
  return result;
}

/// Which cells may be at a place.
class CellGrid {
 public:
  CellGrid(const RoofCells& cells, double size) : size_(size) {
    box_ = bounds(cells.mesh.points);
    columns_ = static_cast<std::size_t>(box_.width() / size) + 1;
    rows_ = static_cast<std::size_t>(box_.height() / size) + 1;
    lists_ = ragged_from_pairs<CellNumber>(columns_ * rows_, [&](const auto& use) {
      for (std::size_t c = 0; c < cells.size(); ++c) {
        const auto cell = static_cast<CellNumber>(c);
        Bounds2 box = Bounds2::nothing();
        for (std::size_t i = 0; i < 3; ++i) box.extend(cells.vertex(cell, i));
        for (std::size_t y = row(box.ymin); y <= row(box.ymax); ++y)
          for (std::size_t x = column(box.xmin); x <= column(box.xmax); ++x)
            use(row_major(x, y, columns_), cell);
      }
    });
  }
  /// -1: in none.
  CellNumber at(const RoofCells& cells, Point2 p) const {
    if (!box_.contains(p)) return -1;
    for (const CellNumber c : lists_[row_major(column(p.x), row(p.y), columns_)]) {
      const Point2 a = cells.vertex(c, 0), b = cells.vertex(c, 1), d = cells.vertex(c, 2);
      if (orient2d(a, b, p) >= 0 && orient2d(b, d, p) >= 0 && orient2d(d, a, p) >= 0) return c;
    }
    return -1;
  }

 private:
  std::size_t column(double x) const {
    return std::min(static_cast<std::size_t>((x - box_.xmin) / size_), columns_ - 1);
  }
  std::size_t row(double y) const {
    return std::min(static_cast<std::size_t>((y - box_.ymin) / size_), rows_ - 1);
  }
  double size_;
  Bounds2 box_;
  std::size_t columns_, rows_;
  RaggedArray<CellNumber> lists_;
};

/// Gives each connected piece of cells that are in no member to the member with which it has the
/// longest border: walls stay where they are.
void fill_gaps(RoofCells& cells) {
  std::vector<MemberNumber> filled = cells.member;
  for (std::size_t start = 0; start < cells.size(); ++start) {
    if (filled[start] >= 0) continue;
    constexpr MemberNumber kInNone = -1, kFound = -2;
    std::vector<CellNumber> gap{static_cast<CellNumber>(start)};
    std::map<MemberNumber, double> borders;
    filled[start] = kFound;
    for (std::size_t k = 0; k < gap.size(); ++k)
      for (std::size_t e = 0; e < 3; ++e) {
        const CellNumber n = cells.neighbours[index(gap[k])][e];
        if (n < 0) continue;
        if (cells.member[index(n)] >= 0) {
          borders[cells.member[index(n)]] += cells.edge_length(gap[k], e);
        } else if (filled[index(n)] == kInNone) {
          filled[index(n)] = kFound;
          gap.push_back(n);
        }
      }
    const auto longest =
        std::max_element(borders.begin(), borders.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    const MemberNumber owner = longest == borders.end() ? 0 : longest->first;
    for (const CellNumber c : gap) filled[index(c)] = owner;
  }
  cells.member = std::move(filled);
}

/// Cells whose centre is in a member are its; in several, of the highest that states its height:
/// what stands on a podium is in the podium's footprint, too. Others fill gaps.
void assign_members(const RoofInput& input, RoofCells& cells) {
  const bool is_alone = input.members.size() == 1;
  cells.member.assign(cells.size(), is_alone ? 0 : -1);
  if (is_alone) return;
  std::vector<std::size_t> downwards(input.members.size());
  std::iota(downwards.begin(), downwards.end(), std::size_t{0});
  // Points tell the roof wherever they are.
  const auto top = [&](std::size_t m) {
    return input.sources[m] == RoofSource::kMeasured ? kInfinity : input.heights[m];
  };
  std::stable_sort(downwards.begin(), downwards.end(),
                   [&](std::size_t a, std::size_t b) { return top(a) > top(b); });
  for (const std::size_t m : downwards) {
    const Bounds2 box = bounds(*input.members[m]);
    for (std::size_t c = 0; c < cells.size(); ++c) {
      if (cells.member[c] >= 0) continue;
      const Point2 p = cells.centre(static_cast<CellNumber>(c));
      if (box.contains(p) && contains(*input.members[m], p))
        cells.member[c] = static_cast<MemberNumber>(m);
    }
  }
  fill_gaps(cells);
}

void assign_points(const RoofInput& input, double size, RoofCells& cells) {
  const CellGrid grid(cells, size);
  std::vector<CellNumber> cell_of(input.points.values.size(), -1);
  for (std::size_t m = 0; m < input.members.size(); ++m)
    for (auto k = static_cast<std::size_t>(input.points.offsets[m]);
         k < static_cast<std::size_t>(input.points.offsets[m + 1]); ++k) {
      const Point3& p = input.points.values[k];
      const CellNumber c = grid.at(cells, {p[0], p[1]});
      if (c >= 0 && cells.member[index(c)] == static_cast<MemberNumber>(m)) cell_of[k] = c;
    }
  cells.points = ragged_from_pairs<std::uint32_t>(cells.size(), [&](const auto& use) {
    for (std::size_t k = 0; k < cell_of.size(); ++k)
      if (cell_of[k] >= 0) use(index(cell_of[k]), static_cast<std::uint32_t>(k));
  });
}

}  // namespace

std::vector<std::vector<CellNumber>> RoofCells::of_members(std::size_t members) const {
  std::vector<std::vector<CellNumber>> own(members);
  for (std::size_t c = 0; c < size(); ++c)
    own[index(member[c])].push_back(static_cast<CellNumber>(c));
  return own;
}

Point2 RoofCells::centre(CellNumber c) const {
  const Point2 a = vertex(c, 0), b = vertex(c, 1), d = vertex(c, 2);
  return {(a.x + b.x + d.x) / 3, (a.y + b.y + d.y) / 3};
}

double RoofCells::area(CellNumber c) const {
  const Point2 a = vertex(c, 0), b = vertex(c, 1), d = vertex(c, 2);
  return ((b.x - a.x) * (d.y - a.y) - (b.y - a.y) * (d.x - a.x)) / 2;
}

double RoofCells::edge_length(CellNumber c, std::size_t edge) const {
  return distance(vertex(c, edge + 1), vertex(c, edge + 2));
}

RoofCells make_roof_cells(const RoofInput& input, double size) {
  constexpr double kMostSquares = 60000;
  constexpr double kLargest = 1.5;  // metres
  const double step =
      std::clamp(std::sqrt(area(input.footprint) / kMostSquares), size, std::max(size, kLargest));
  PlanarGraph graph;
  add_ring(input.footprint.outer, step, graph);
  for (const Ring& hole : input.footprint.holes) {
    add_ring(hole, step, graph);
    graph.holes.push_back(interior_point(Polygon{hole, {}}));
  }
  if (step < kInfinity) add_interior(input.footprint, step, graph);
  RoofCells cells;
  cells.mesh = constrained_delaunay(graph);
  cells.neighbours = neighbours_of(cells.mesh);
  assign_members(input, cells);
  assign_points(input, std::sqrt(area(input.footprint) / static_cast<double>(cells.size())), cells);
  return cells;
}

}  // namespace tetropolis

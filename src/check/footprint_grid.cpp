#include "footprint_grid.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "tetropolis/geometry/polygon.h"

namespace tetropolis {

namespace {

GridIndex file_footprints(const CityModel& city) {
  std::vector<Bounds2> boxes;
  Bounds2 all = Bounds2::nothing();
  for (const Building& building : city.buildings) {
    boxes.push_back(bounds(building.footprint.outer));
    all.extend(boxes.back());
  }
  return index_on_grid(boxes.size(), all,
                       [&](const SquareGrid& grid, std::size_t b, const auto& use) {
                         if (!boxes[b].empty()) grid.for_each_in(boxes[b], use);
                       });
}

}  // namespace

std::size_t FootprintGrid::Bands::at(double y) const {
  const double share = north > south ? (y - south) / (north - south) : 0;
  return std::min(static_cast<std::size_t>(share * static_cast<double>(count)), count - 1);
}

FootprintGrid::FootprintGrid(const CityModel& city) : index_(file_footprints(city)) {
  for (const Building& building : city.buildings) {
    const std::size_t first = edges_.size();
    for_each_edge(building.footprint, [&](Point2 a, Point2 b) { edges_.push_back({a, b}); });
    owners_.resize(edges_.size(), static_cast<std::uint32_t>(bands_.size()));
    add_bands(first);
  }
  file_edges();
}

/// Bands for the edges from `first_edge` on: half as many, but fewer if edges would lie in many.
void FootprintGrid::add_bands(std::size_t first_edge) {
  constexpr std::size_t kMostUses = 8;  // of an edge, on average
  const std::span<const Edge> edges = std::span(edges_).subspan(first_edge);
  Bands bands;
  if (!edges.empty()) {
    bands = {edges[0].a.y, edges[0].a.y, std::max<std::size_t>(edges.size() / 2, 1), 0};
    for (const Edge& edge : edges) {
      bands.south = std::min(bands.south, edge.a.y);
      bands.north = std::max(bands.north, edge.a.y);
    }
    const auto uses = [&] {
      std::size_t sum = 0;
      for (const Edge& e : edges)
        sum += 1 + bands.at(std::max(e.a.y, e.b.y)) - bands.at(std::min(e.a.y, e.b.y));
      return sum;
    };
    while (bands.count > 1 && uses() > kMostUses * edges.size()) bands.count /= 2;
  }
  bands.first = bands_.empty() ? 0 : bands_.back().first + bands_.back().count;
  bands_.push_back(bands);
}

void FootprintGrid::file_edges() {
  const std::size_t rows = bands_.empty() ? 0 : bands_.back().first + bands_.back().count;
  edges_of_ = file_under_rows(edges_.size(), rows, [&](std::size_t e, const auto& use) {
    const Bands& bands = bands_[owners_[e]];
    const Edge& edge = edges_[e];
    const std::size_t last = bands.at(std::max(edge.a.y, edge.b.y));
    for (std::size_t b = bands.at(std::min(edge.a.y, edge.b.y)); b <= last; ++b)
      use(bands.first + b);
  });
}

bool FootprintGrid::is_inside(const Bands& bands, double x, double y) const {
  if (bands.count == 0 || !(y >= bands.south && y <= bands.north)) return false;
  bool odd = false;
  for (const std::uint32_t e : edges_of_[bands.first + bands.at(y)]) {
    const auto [a, b] = edges_[e];
    if ((a.y <= y) != (b.y <= y) && x < a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y)) odd = !odd;
  }
  return odd;
}

BuildingIndex FootprintGrid::at(double x, double y) const {
  for (const std::uint32_t b : near(x, y))
    if (is_inside(bands_[b], x, y)) return BuildingIndex(b);
  return kNoBuilding;
}

}  // namespace tetropolis

#include "footprint_index.h"

#include "core/infinity.h"
#include "core/ragged_builder.h"

namespace tetropolis {

namespace {

constexpr std::size_t kEdgesPerBand = 8;
constexpr double kSmallestCell = 4;  // Metres; smaller cells would only hold the same houses.
constexpr double kEntriesPerFootprint = 32;
constexpr double kFreeEntries = 1 << 22;  // Cells and entries allowed whatever the footprints are.

}  // namespace

FootprintIndex::FootprintIndex(std::span<const Polygon* const> footprints, double margin)
    : margin_(margin), box_(Bounds2::nothing()) {
  outlines_.reserve(footprints.size());
  for (const Polygon* footprint : footprints) add_outline(*footprint);
  if (!box_.empty()) build_cells();
}

std::size_t FootprintIndex::count_entries(const Outline& outline, std::span<const Edge> edges) {
  std::size_t entries = 0;
  for (const Edge& edge : edges) {
    const auto [low, high] = std::minmax(edge.a.y, edge.b.y);
    entries += static_cast<std::size_t>(band_of(outline, high) - band_of(outline, low) + 1);
  }
  return entries;
}

void FootprintIndex::add_outline(const Polygon& footprint) {
  std::vector<Edge> edges;
  for_each_edge(footprint, [&](Point2 a, Point2 b) { edges.push_back({a, b}); });
  Outline outline;
  outline.box = bounds(footprint).grown(reach());
  // The narrower the bands, the more of them an edge is in. With one band, each is in that.
  outline.bands = static_cast<std::int32_t>(std::max<std::size_t>(edges.size() / kEdgesPerBand, 1));
  while (count_entries(outline, edges) > kEntriesPerEdge * edges.size()) outline.bands /= 2;
  outline.first_band = bands_.size();
  std::vector<std::vector<Edge>> bands(static_cast<std::size_t>(outline.bands));
  for (const Edge& edge : edges) {
    const auto [low, high] = std::minmax(edge.a.y, edge.b.y);
    for (std::int32_t band = band_of(outline, low); band <= band_of(outline, high); ++band)
      bands[static_cast<std::size_t>(band)].push_back(edge);
  }
  for (const std::vector<Edge>& band : bands) bands_.push_back(band);
  if (!edges.empty()) box_.extend(outline.box);
  outlines_.push_back(outline);
}

/// Cells plus (an upper bound of) entries of a grid with this cell size.
double FootprintIndex::entries_with(double cell) const {
  double entries = (box_.width() / cell + 1) * (box_.height() / cell + 1);
  for (const Outline& outline : outlines_)
    if (!outline.box.empty())
      entries += (outline.box.width() / cell + 2) * (outline.box.height() / cell + 2);
  return entries;
}

void FootprintIndex::build_cells() {
  const double most = kFreeEntries + kEntriesPerFootprint * static_cast<double>(outlines_.size());
  double cell = kSmallestCell;
  while (entries_with(cell) > most) cell *= 2;
  per_metre_ = 1 / cell;
  columns_ = static_cast<std::int32_t>(box_.width() * per_metre_) + 1;
  rows_ = static_cast<std::int32_t>(box_.height() * per_metre_) + 1;
  cells_ = ragged_from_pairs<BuildingIndex>(
      static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), [&](const auto& use) {
        for (const BuildingIndex f : indices<BuildingIndex>(outlines_.size())) {
          const Bounds2& box = outlines_[f].box;
          if (box.empty()) continue;
          for (std::int32_t j = row(box.ymin); j <= row(box.ymax); ++j)
            for (std::int32_t i = column(box.xmin); i <= column(box.xmax); ++i)
              use(static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) +
                      static_cast<std::size_t>(i),
                  f);
        }
      });
  is_used_.resize(cells_.size());
  for (std::size_t c = 0; c < cells_.size(); ++c) is_used_[c] = !cells_[c].empty();
}

double FootprintIndex::squared_distance(BuildingIndex footprint, Point2 p) const {
  const Outline& outline = outlines_[footprint];
  double result = kInfinity;
  if (!outline.box.contains(p)) return result;
  for (const Edge& edge : near_bands(outline, p.y))
    result = std::min(result, squared_distance_to_segment(p, edge.a, edge.b));
  return result;
}

}  // namespace tetropolis

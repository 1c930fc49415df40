#include "grow_upper.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "core/sort_once.h"
#include "front.h"

namespace tetropolis {

namespace {

// Found by trial, as in front.cpp.

/// Where the best is below the floor, it is all done again with segments shorter by this factor at
/// that column and beside it, so often at most.
constexpr double kShorter = 0.85;
constexpr int kMostRounds = 6;

/// Steps in the order that numbers its nodes and cells.
class UpperMaker {
 public:
  explicit UpperMaker(const ColumnMesh& mesh);
  UpperMesh make(const std::vector<FrontSteps>& all);

 private:
  void add(const FrontStep& step, const std::int32_t* numbers);
  void cover(std::int32_t triangle, std::int64_t cell) {
    CellIndex& over = upper_.over_lid[static_cast<std::size_t>(triangle)];
    if (over == kNoCell) over = CellIndex(first_cell_ + cell);
  }
  NodeIndex node(std::int32_t vertex) const { return node_[static_cast<std::size_t>(vertex)]; }

  const ColumnMesh& mesh_;
  std::int64_t first_cell_;
  std::vector<NodeIndex> node_;  // per vertex, the front's
  UpperMesh upper_;
};

UpperMaker::UpperMaker(const ColumnMesh& mesh)
    : mesh_(mesh), first_cell_(cell_offsets(mesh).back().value()) {
  for (const VertexIndex v : mesh.ground.vertices.indices()) node_.push_back(mesh.top(v));
  upper_.over_lid.assign(mesh.triangle_count(), kNoCell);
}

void UpperMaker::add(const FrontStep& step, const std::int32_t* numbers) {
  const auto made = static_cast<std::int64_t>(upper_.cells.size());
  const auto around = static_cast<std::size_t>(step.around);
  NodeIndex& own = node_[step.vertex];
  if (step.is_end()) {
    const std::size_t cells = step.cells();
    for (std::size_t c = 0; c < cells; ++c, numbers += 3)
      upper_.cells.push_back({own, node(numbers[0]), node(numbers[1]), node(numbers[2])});
    for (std::size_t i = 0; i < around; ++i) cover(numbers[i], made + numbers[around + i]);
    return;
  }
  const NodeIndex next(mesh_.column_nodes() + static_cast<std::int64_t>(upper_.points.size()));
  const Point2 p = mesh_.ground.vertices[step.vertex];
  upper_.points.push_back({p.x, p.y, step.to});
  upper_.vertex.push_back(step.vertex);
  for (std::size_t i = 0; i < around; ++i) {
    upper_.cells.push_back({own, node(numbers[i]), node(numbers[i + 1]), next});
    cover(numbers[around + 1 + i], made + static_cast<std::int64_t>(i));
  }
  own = next;
}

UpperMesh UpperMaker::make(const std::vector<FrontSteps>& all) {
  struct Place {
    double order;
    VertexIndex vertex;
    std::int32_t part;
    std::size_t step;
  };
  std::vector<Place> places;
  std::size_t cells = 0, points = 0;
  for (std::size_t part = 0; part < all.size(); ++part)
    for (std::size_t i = 0; i < all[part].steps.size(); ++i) {
      const FrontStep& step = all[part].steps[i];
      places.push_back({step.order, step.vertex, static_cast<std::int32_t>(part), i});
      cells += step.cells();
      points += step.is_end() ? 0 : 1;
    }
  parallel_sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
    return std::tie(a.order, a.vertex, a.part, a.step) <
           std::tie(b.order, b.vertex, b.part, b.step);
  });
  upper_.cells.reserve(cells);
  upper_.points.reserve(points);
  upper_.vertex.reserve(points);
  for (const Place& place : places) {
    const FrontSteps& part = all[static_cast<std::size_t>(place.part)];
    const FrontStep& step = part.steps[place.step];
    add(step, part.numbers.data() + step.numbers);
  }
  return std::move(upper_);
}

}  // namespace

UpperMesh grow_upper(const ColumnMesh& mesh, double top, std::size_t strips) {
  if (strips == 0) strips = useful_strips(mesh);
  std::vector<double> shares(mesh.vertex_count(), 1.0);
  std::vector<FrontSteps> best;
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  for (int round = 0; round < kMostRounds && fewest > 0; ++round) {
    std::vector<FrontSteps> steps = climb_to_top(mesh, top, shares, strips);
    std::vector<VertexIndex> poor;
    for (const FrontSteps& part : steps)
      poor.insert(poor.end(), part.poor.begin(), part.poor.end());
    if (poor.size() < fewest) {
      fewest = poor.size();
      best = std::move(steps);
    }
    sort_once(poor);
    for (const VertexIndex v : poor) shares[v] *= kShorter;
  }
  return UpperMaker(mesh).make(best);
}

}  // namespace tetropolis

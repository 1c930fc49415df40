#include "page_columns.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <span>
#include <utility>

#include "tetropolis/ground/surfaces.h"

#include "core/parallel.h"
#include "core/sort_once.h"

namespace tetropolis {

namespace {

/// Returns the value less the last one, which becomes the value.
std::int32_t difference(std::int32_t value, std::int32_t& last) {
  return value - std::exchange(last, value);
}

void add_ground(const GroundMesh& ground, PageColumns& columns) {
  std::int32_t x = 0, y = 0, corner = 0, region = 0;
  for (const Point2 p : ground.vertices) {
    columns.x.push_back(difference(page_steps(p.x), x));
    columns.y.push_back(difference(page_steps(p.y), y));
  }
  for (const auto& triangle : ground.triangles) {
    columns.corners.push_back(difference(triangle[0].value(), corner));
    columns.corners.push_back(triangle[1] - triangle[0]);
    columns.corners.push_back(triangle[2] - triangle[0]);
  }
  for (const RegionIndex r : ground.region) columns.region.push_back(difference(r.value(), region));
  for (const Region& r : ground.regions) {
    const auto kind = std::find(kSurfaceKindNames.begin(), kSurfaceKindNames.end(),
                                r.is_building() ? "" : ground.patches.of(r.floor).name);
    columns.building.push_back(
        kind == kSurfaceKindNames.end()
            ? r.building.value()
            : -2 - static_cast<std::int32_t>(kind - kSurfaceKindNames.begin()));
  }
}

/// Per region of a building its elevation in steps, at any of its vertices.
std::vector<std::int32_t> roof_steps(const ColumnMesh& mesh) {
  std::vector<std::int32_t> roofs(mesh.ground.regions.size(), 0);
  for (const TriangleIndex t : mesh.ground.triangles.indices())
    if (mesh.inside_building(t))
      roofs[mesh.ground.region[t]] =
          page_steps(mesh.z[mesh.floor_over(t, mesh.ground.triangles[t][0])]);
  return roofs;
}

/// Writes the elevations of columns, and keeps what a reader will make of them.
class ElevationWriter {
 public:
  ElevationWriter(const ColumnMesh& mesh, bool floors_only, PageColumns& columns)
      : mesh_(mesh), floors_only_(floors_only), columns_(columns), roofs_(roof_steps(mesh)) {
    std::int32_t roof = 0;
    for (const RegionIndex r : mesh.ground.regions.indices())
      columns_.roof.push_back(mesh.ground.regions[r].is_building() ? difference(roofs_[r], roof)
                                                                   : 0);
    if (!floors_only) read_.resize(mesh.z.size());
  }

  void add(VertexIndex v) {
    const PrismLayers& layers = mesh_.layers;
    layers_ = layers.count > 0 && layers.position[v] >= 0 ? layers.count : 0;
    floors_.clear();
    for (std::size_t k = 0; k < mesh_.regions[v].size(); ++k) {
      const bool is_building = mesh_.ground.regions[mesh_.regions[v][k]].is_building();
      floors_.push_back(mesh_.floors_at(v)[k] + (is_building ? layers_ : 0));
    }
    anchors_ = floors_;
    const std::int32_t last =
        layers_ + static_cast<std::int32_t>(mesh_.first[v + 1] - mesh_.first[v]) - 1;
    if (!floors_only_) anchors_.push_back(last);
    if (!floors_only_ && !layers.whole) anchors_.push_back(layers_);
    sort_once(anchors_);
    const auto nodes = floors_only_ ? static_cast<std::int32_t>(anchors_.size()) : last + 1;
    columns_.count.push_back(difference(nodes, count_));
    if (floors_.size() > 1)
      for (const std::int32_t floor : floors_) columns_.floor.push_back(position_of(floor));
    values_.clear();
    for (const std::int32_t anchor : anchors_) values_.push_back(anchor_residual(v, anchor));
    for (std::size_t i = 0; i < anchors_.size(); ++i) {
      columns_.z.push_back(values_[i].second);
      keep(v, anchors_[i], values_[i].first);
      if (!floors_only_ && i + 1 < anchors_.size()) add_between(v, i);
    }
  }

  /// Per node the elevation that a reader has, in steps.
  const std::vector<double>& read() const { return read_; }

 private:
  std::int32_t position_of(std::int32_t floor) const {
    if (!floors_only_) return floor;
    return static_cast<std::int32_t>(std::lower_bound(anchors_.begin(), anchors_.end(), floor) -
                                     anchors_.begin());
  }

  std::int32_t elevation(VertexIndex v, std::int32_t position) const {
    if (position >= layers_) return page_steps(mesh_.z[mesh_.first[v] + (position - layers_)]);
    const auto place = static_cast<std::size_t>(mesh_.layers.position[v]);
    return page_steps(mesh_.layers.z[place * static_cast<std::size_t>(layers_) +
                                     static_cast<std::size_t>(position)]);
  }

  void keep(VertexIndex v, std::int32_t position, std::int32_t z) {
    if (!floors_only_ && position >= layers_) read_[mesh_.first[v] + (position - layers_)] = z;
  }

  /// Elevation and what is left of it.
  std::pair<std::int32_t, std::int32_t> anchor_residual(VertexIndex v, std::int32_t anchor) {
    const std::int32_t z = elevation(v, anchor);
    const std::span<const RegionIndex> regions = mesh_.regions[v];
    bool is_floor = false;
    for (std::size_t k = 0; k < floors_.size(); ++k) {
      if (floors_[k] != anchor) continue;
      const RegionIndex region = regions[k];
      if (mesh_.ground.regions[region].is_building()) return {z, z - roofs_[region]};
      is_floor = true;
    }
    if (is_floor) return {z, difference(z, ground_)};
    if (anchor == layers_ && !mesh_.layers.whole)
      return {z, difference(z - values_.front().first, thickness_)};
    return {z, difference(z, top_)};
  }

  /// The nodes between anchors number i and i + 1. A step more or less is not told: ends that are
  /// rounded shift what lies between them by as much.
  void add_between(VertexIndex v, std::size_t i) {
    const std::int64_t n = anchors_[i + 1] - anchors_[i];
    const std::int64_t low = values_[i].first, rise = values_[i + 1].first - low;
    const bool is_prisms = mesh_.layers.whole || anchors_[i] < layers_;
    std::vector<std::int64_t>* shape = is_prisms ? &shapes_[n] : nullptr;
    if (is_prisms && shape->empty())
      for (std::int64_t k = 0; k <= n; ++k) shape->push_back(k);
    const std::int64_t whole = is_prisms ? std::max<std::int64_t>(1, shape->back()) : n;
    for (std::int64_t k = 1; k < n; ++k) {
      const std::int64_t share = is_prisms ? (*shape)[static_cast<std::size_t>(k)] : k;
      const auto even = static_cast<std::int32_t>(low + (2 * rise * share + whole) / (2 * whole));
      const std::int32_t position = anchors_[i] + static_cast<std::int32_t>(k);
      const std::int32_t residual = elevation(v, position) - even;
      const std::int32_t told = std::abs(residual) <= 1 ? 0 : residual;
      columns_.z.push_back(told);
      keep(v, position, even + told);
      if (is_prisms) (*shape)[static_cast<std::size_t>(k)] = even + told - low;
    }
    if (is_prisms) shape->back() = rise;
  }

  const ColumnMesh& mesh_;
  bool floors_only_;
  PageColumns& columns_;
  std::vector<std::int32_t> roofs_;
  std::vector<double> read_;
  // Of the column at hand: layers, and positions counted from the lowest one.
  std::int32_t layers_ = 0;
  std::vector<std::int32_t> floors_, anchors_;                 // ascending, these
  std::vector<std::pair<std::int32_t, std::int32_t>> values_;  // of the anchors
  // By number of prisms between two anchors: heights above the lower one, those met last.
  std::map<std::int64_t, std::vector<std::int64_t>> shapes_;
  std::int32_t count_ = 0, ground_ = 0, thickness_ = 0, top_ = 0;
};

/// The front over triangle t as the elevations `z` of its nodes would make it climb.
Climb<3> climb_by(const ColumnMesh& mesh, const std::vector<double>& z, TriangleIndex t) {
  const auto& v = mesh.ground.triangles[t];
  return {{z.data(), z.data(), z.data()},
          v,
          {mesh.floor_over(t, v[0]), mesh.floor_over(t, v[1]), mesh.floor_over(t, v[2])},
          {mesh.top(v[0]), mesh.top(v[1]), mesh.top(v[2])}};
}

bool climb_alike(Climb<3> a, Climb<3> b) {
  for (std::size_t i; (i = a.next()) < 3; a.advance(i), b.advance(i))
    if (b.next() != i) return false;
  return true;
}

/// Triangles and their steps: a mesh is the same whichever elevations tell the order.
void add_odd(const ColumnMesh& mesh, const std::vector<double>& read, PageColumns& columns) {
  if (mesh.layers.whole) return;
  std::vector<std::uint8_t> is_odd(mesh.triangle_count());
  parallel_chunks(mesh.triangle_count(), 1024, [&](std::size_t begin, std::size_t end) {
    for (const TriangleIndex t : indices<TriangleIndex>(begin, end))
      is_odd[t] = climb_alike(climb_triangle(mesh, t), climb_by(mesh, read, t)) ? 0 : 1;
  });
  std::int32_t last = 0;
  for (const TriangleIndex t : mesh.ground.triangles.indices()) {
    if (is_odd[t] == 0) continue;
    columns.odd.push_back(difference(t.value(), last));
    Climb<3> front = climb_triangle(mesh, t);
    for (std::size_t i; (i = front.next()) < 3; front.advance(i))
      columns.steps.push_back(static_cast<std::uint8_t>(i));
  }
}

}  // namespace

PageColumns page_columns(const ColumnMesh& mesh, bool floors_only) {
  PageColumns columns;
  add_ground(mesh.ground, columns);
  ElevationWriter elevations(mesh, floors_only, columns);
  for (const VertexIndex v : mesh.ground.vertices.indices()) elevations.add(v);
  if (floors_only) return columns;
  add_odd(mesh, elevations.read(), columns);
  columns.upper = page_upper(mesh, elevations.read());
  return columns;
}

}  // namespace tetropolis

#include "tetropolis/pipeline/wind_domain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/case/wind.h"
#include "tetropolis/city/roof_summary.h"
#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/pipeline/meshable.h"

#include "city/clip.h"
#include "core/infinity.h"
#include "geometry/geos.h"
#include "terrain/extend.h"

namespace tetropolis {

namespace {

constexpr double kInflow = 5, kSides = 5, kOutflow = 15, kAbove = 5;  // of the tallest building
constexpr double kMostBlockage = 0.03;
constexpr int kFirstOwnPatch = 9;
constexpr int kLeastSides = 36;  ///< Of a cylinder.
constexpr std::size_t kMostSidePatches = 99;

/// Where the wind blows to.
Point2 direction_of(double wind_from_deg) {
  const auto to = direction({.from = wind_from_deg});
  return {to[0], to[1]};
}

/// Coordinates along a direction, and on the left of it.
Point2 into_frame(Point2 along, Point2 p) {
  return {p.x * along.x + p.y * along.y, p.y * along.x - p.x * along.y};
}

Point2 out_of_frame(Point2 along, Point2 p) {
  return {p.x * along.x - p.y * along.y, p.x * along.y + p.y * along.x};
}

double height_of(const Building& building) { return highest_roof(building) - building.h_ground; }

Bounds2 extent_in_frame(const Ring& ring, Point2 along) {
  Bounds2 box = Bounds2::nothing();
  for (const Point2 p : ring) box.extend(into_frame(along, p));
  return box;
}

Bounds2 extent_in_frame(const CityModel& city, Point2 along) {
  Bounds2 box = Bounds2::nothing();
  for (const Building& building : city.buildings)
    box.extend(extent_in_frame(building.footprint.outer, along));
  return box;
}

Patch own_patch(std::size_t number) {
  return static_cast<Patch>(kFirstOwnPatch + static_cast<int>(number));
}

/// Snapped corners; patches by side, from the side on the right of the wind counter-clockwise.
Domain turned_box(const Bounds2& box, Point2 along) {
  Ring ring;
  for (const Point2 p : rectangle(box).outer)
    ring.push_back(snap_coordinate(out_of_frame(along, p)));
  return {std::move(ring),
          {own_patch(3), own_patch(1), own_patch(2), own_patch(0)},
          {{own_patch(0), "inlet", PatchKind::kSide},
           {own_patch(1), "outlet", PatchKind::kSide},
           {own_patch(2), "side_left", PatchKind::kSide},
           {own_patch(3), "side_right", PatchKind::kSide}}};
}

Domain along_axis(const Bounds2& box, Point2 along) {
  Bounds2 domain = Bounds2::nothing();
  for (const Point2 p : rectangle(box).outer)
    domain.extend(snap_coordinate(out_of_frame(along, p)));
  return domain;
}

Domain cylinder(Point2 centre, double radius, int sectors) {
  const int sides = (kLeastSides + sectors - 1) / sectors;  // of each sector
  Ring ring;
  std::vector<Patch> patches;
  std::vector<PatchInfo> infos;
  for (int k = 0; k < sectors; ++k) {
    // By bearing, which goes clockwise; the ring does not.
    const int number = (sectors - k) % sectors;
    for (int side = 0; side < sides; ++side) {
      const double turn = (k - 0.5 + static_cast<double>(side) / sides) / sectors;
      const double angle = 2 * std::numbers::pi * (0.25 + turn);
      ring.push_back(snap_coordinate(
          Point2{centre.x + radius * std::cos(angle), centre.y + radius * std::sin(angle)}));
      patches.push_back(own_patch(static_cast<std::size_t>(number)));
    }
    infos.push_back({own_patch(static_cast<std::size_t>(k)),
                     fmt::format("sector_{:03.0f}", 360.0 * k / sectors), PatchKind::kSide});
  }
  return {std::move(ring), std::move(patches), std::move(infos)};
}

/// The patch of a box along an axis that the wind blows in through.
std::string inlet_of(const Domain& domain, Point2 along) {
  if (!domain.own_patches().empty()) return "inlet";
  if (along.x != 0) return along.x > 0 ? "xmin" : "xmax";
  return along.y > 0 ? "ymin" : "ymax";
}

/// The largest over the winds that blow at the middles of a cylinder's sectors.
double widest_frontal_area(const CityModel& city, int sectors) {
  double area = 0;
  for (int k = 0; k < sectors; ++k)
    area = std::max(area, frontal_area(city, direction_of(360.0 * k / sectors)));
  return area;
}

double share_outside(const Domain& domain, const Bounds2& data) {
  return 1 - total_area(parts_in_domain(domain.outline(), data)) / domain.area();
}

const Building& tallest_of(const CityModel& city) {
  return *std::max_element(
      city.buildings.begin(), city.buildings.end(),
      [](const Building& a, const Building& b) { return height_of(a) < height_of(b); });
}

/// The highest of the shadows at each step across the wind.
class Skyline {
 public:
  Skyline(double from, double to)
      : from_(from), heights_(static_cast<std::size_t>(std::ceil((to - from) / kStep)) + 1, 0) {}

  /// A line of a roof: places across the wind, and heights there.
  void add(double a, double height_a, double b, double height_b) {
    if (a > b) return add(b, height_b, a, height_a);
    const auto height_at = [&](double place) {
      if (!(b > a)) return std::max(height_a, height_b);
      return height_a + (std::clamp(place, a, b) - a) / (b - a) * (height_b - height_a);
    };
    const auto first = static_cast<std::size_t>((a - from_) / kStep);
    const auto last = static_cast<std::size_t>(std::ceil((b - from_) / kStep));
    for (std::size_t i = first; i < std::min(last, heights_.size()); ++i) {
      const double place = from_ + static_cast<double>(i) * kStep;
      heights_[i] = std::max({heights_[i], height_at(place), height_at(place + kStep)});
    }
  }

  double area() const { return kStep * std::accumulate(heights_.begin(), heights_.end(), 0.0); }

 private:
  static constexpr double kStep = 0.5;
  double from_;
  std::vector<double> heights_;
};

/// What the guidelines measure by.
struct Surroundings {
  double height = 0;   ///< H.
  double frontal = 0;  ///< Frontal area.
  Bounds2 core;        ///< Of the buildings, or of the data without any, in the frame of the wind.
  Point2 along;        ///< Where it blows to.
};

void fit_box(const Surroundings& around, CityModel& city, WindDomainFacts& facts) {
  const Bounds2& core = around.core;
  facts.length = facts.guideline_length;
  facts.width =
      std::max(facts.guideline_width, around.frontal / (kMostBlockage * facts.guideline_height));
  const double middle = 0.5 * (core.ymin + core.ymax);
  const Bounds2 box{core.xmin - kInflow * around.height, middle - 0.5 * facts.width,
                    core.xmax + kOutflow * around.height, middle + 0.5 * facts.width};
  const bool is_along_axis = around.along.x == 0 || around.along.y == 0;
  city.domain = is_along_axis ? along_axis(box, around.along) : turned_box(box, around.along);
  facts.inlet = inlet_of(city.domain, around.along);
}

void fit_cylinder(const Surroundings& around, int sectors, CityModel& city,
                  WindDomainFacts& facts) {
  const Bounds2& core = around.core;
  facts.guideline_radius = 0.5 * std::hypot(core.width(), core.height()) + kOutflow * around.height;
  facts.radius = std::max(facts.guideline_radius,
                          0.5 * around.frontal / (kMostBlockage * facts.guideline_height));
  facts.length = facts.width = 2 * facts.radius;
  city.domain = cylinder({0.5 * (core.xmin + core.xmax), 0.5 * (core.ymin + core.ymax)},
                         facts.radius, sectors);
}

void take_given(const GivenDomain& given, double min_distance, CityModel& city,
                std::vector<Warning>& warnings) {
  city.domain = in_local_frame(given.sides, city.origin);
  const std::size_t before = city.dropped.size();
  const std::size_t left_out = drop_unmeshable(city, min_distance);
  if (left_out == 0) return;
  warnings.push_back(
      {"outside_domain", static_cast<std::int64_t>(left_out),
       fmt::format(
           "{} features are left out, the first, {}: {}; the polygon of the domain leaves no "
           "room for them",
           left_out, city.dropped[before].source_id, city.dropped[before].reason)});
}

}  // namespace

Domain polygon_domain(const Polygon& polygon) {
  Ring ring;
  for (const Point2 p : polygon.outer)
    if (const Point2 q = snap_coordinate(p); ring.empty() || q != ring.back()) ring.push_back(q);
  if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
  if (!polygon.holes.empty() || ring.size() < 3 || !geos::is_valid(std::array{Polygon{ring, {}}}))
    throw Error(ErrorKind::kInput,
                "domain: the polygon crosses itself or has holes; give a simple one");
  if (signed_area(ring) < 0) std::reverse(ring.begin(), ring.end());
  std::vector<Patch> patches;
  std::vector<PatchInfo> infos;
  const bool is_one = ring.size() > kMostSidePatches;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    patches.push_back(own_patch(is_one ? 0 : i));
    if (!is_one) infos.push_back({patches.back(), fmt::format("side_{}", i + 1), PatchKind::kSide});
  }
  if (is_one) infos.push_back({own_patch(0), "side", PatchKind::kSide});
  return {std::move(ring), std::move(patches), std::move(infos)};
}

Domain in_local_frame(const Domain& domain, Point2 origin) {
  Ring ring;
  std::vector<Patch> patches;
  for (const Domain::Side& side : domain.sides()) {
    ring.push_back(snap_coordinate(Point2{side.from.x - origin.x, side.from.y - origin.y}));
    patches.push_back(side.patch);
  }
  if (domain.is_box()) return bounds(ring);
  return {std::move(ring), std::move(patches), domain.own_patches()};
}

double frontal_area(const CityModel& city, Point2 along) {
  const Bounds2 box = extent_in_frame(city, along);
  if (box.empty()) return 0;
  Skyline skyline(box.ymin, box.ymax);
  for (const Building& building : city.buildings) {
    const auto add = [&](const Polygon& outline, const auto& roof) {
      for_each_edge(outline, [&](Point2 a, Point2 b) {
        skyline.add(into_frame(along, a).y, roof(a) - building.h_ground, into_frame(along, b).y,
                    roof(b) - building.h_ground);
      });
    };
    // Along the wind a plane is highest at an end, so edges tell all.
    for (const RoofPart& part : building.parts) add(part.outline, part.roof);
    if (building.parts.empty()) add(building.footprint, [&](Point2) { return building.h_roof; });
  }
  return skyline.area();
}

double guideline_top(const CityModel& city) {
  double highest = -kInfinity;
  for (const Building& building : city.buildings)
    highest = std::max(highest, highest_roof(building));
  return snap_height(highest + kAbove * height_of(tallest_of(city)));
}

namespace {

/// How far nodes of the terrain within the domain have moved, at most.
double most_levelled(const Raster& terrain, const Raster& faded, const Domain& domain) {
  double most = 0;
  for (std::int32_t j = 0; j < terrain.ny; ++j)
    for (std::int32_t i = 0; i < terrain.nx; ++i) {
      const Point2 p{terrain.x0 + i * terrain.step, terrain.y0 + j * terrain.step};
      if (domain.contains(p)) most = std::max(most, std::abs(terrain.at(i, j) - sample(faded, p)));
    }
  return most;
}

}  // namespace

WindDomainFacts fit_wind_domain(const WindDomainOptions& options, double min_distance,
                                CityModel& city, Raster& terrain, std::vector<Warning>& warnings,
                                const Raster* wider) {
  WindDomainFacts facts;
  if (options.shape == DomainShape::kData) return facts;
  const Bounds2 data = city.domain.bounds();
  facts.data = data.moved(city.origin);
  if (options.shape == DomainShape::kGiven)
    take_given(options.given, min_distance, city, warnings);
  else if (city.buildings.empty())
    throw Error(ErrorKind::kInput,
                "domain: without buildings their height does not tell how wide it is; give a "
                "polygon, or `bounds` and domain = \"data\"");

  const bool has_top = std::isfinite(options.given.top);
  double height = 0;  // of the cross-section that buildings block
  Surroundings around;
  around.along =
      options.shape == DomainShape::kCylinder ? Point2{1, 0} : direction_of(options.wind_from_deg);
  around.core = extent_in_frame(rectangle(data).outer, around.along);
  if (!city.buildings.empty()) {
    const Building& tallest = tallest_of(city);
    around.height = height_of(tallest);
    around.frontal = options.shape == DomainShape::kCylinder
                         ? widest_frontal_area(city, options.sectors)
                         : frontal_area(city, around.along);
    around.core = extent_in_frame(city, around.along);
    facts.building_height = around.height;
    facts.tallest = tallest.id;
    facts.guideline_length = around.core.width() + (kInflow + kOutflow) * around.height;
    facts.guideline_width = around.core.height() + 2 * kSides * around.height;
    facts.guideline_height = (1 + kAbove) * around.height;
    facts.guideline_blockage = around.frontal / (facts.guideline_width * facts.guideline_height);
    city.domain_top = guideline_top(city);
    height = facts.guideline_height;
    if (has_top) height += options.given.top - city.domain_top;
  }
  if (has_top) city.domain_top = options.given.top;
  if (options.shape == DomainShape::kBox) {
    fit_box(around, city, facts);
  } else if (options.shape == DomainShape::kCylinder) {
    fit_cylinder(around, options.sectors, city, facts);
  } else {
    const Bounds2 extent = extent_in_frame(city.domain.outline().outer, around.along);
    facts.length = extent.width();
    facts.width = extent.height();
  }
  if (around.height > 0) facts.blockage = around.frontal / (facts.width * height);
  if (facts.blockage > kMostBlockage * (1 + 1e-9))
    warnings.push_back({"domain_blockage", 1,
                        fmt::format("buildings block {:.1f} % of the domain's cross-section (at "
                                    "most 3 % by COST 732); a box or a cylinder is widened for "
                                    "that",
                                    100 * facts.blockage)});
  facts.area_outside_data = share_outside(city.domain, data);
  facts.rim_height = rim_height(terrain);
  constexpr double kLeastFade = 10;  // steps of the terrain
  const double width = std::max(kInflow * around.height, kLeastFade * terrain.step);
  Raster faded = extend_terrain(terrain, city.domain.bounds(),
                                {around.along, around.core, width, facts.rim_height}, wider);
  round_to_single(faded);
  const double levelled = most_levelled(terrain, faded, city.domain);
  constexpr double kTold = 2;  // metres
  if (levelled > kTold)
    warnings.push_back(
        {"terrain_levelled", 1,
         fmt::format("over {:.0f} m around the buildings the terrain fades to level, and is off by "
                     "up to {:.0f} m for that; `domain` = data keeps it as it is",
                     width, levelled)});
  terrain = std::move(faded);
  return facts;
}

}  // namespace tetropolis

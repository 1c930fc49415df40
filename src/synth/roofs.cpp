#include "roofs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

#include "tetropolis/geometry/polygon.h"

#include "city/part_tiling.h"
#include "city/share_corners.h"
#include "convex.h"
#include "core/infinity.h"

namespace tetropolis {

namespace {

using namespace convex;

constexpr double kLowestRoof = 2.6;  // Above the ground, metres.
constexpr double kSame = 0.005;      // Metres: cuts of one place are rounded to millimetres.
constexpr double kLeastEdge = 1;     // Of a part, metres.
constexpr double kLeastArea = 4;     // Of a part, square metres.
constexpr double kNarrowest = 5;     // Of a piece with more than one plane, metres.

/// A convex piece of a footprint, along its longest edge.
class Piece {
 public:
  explicit Piece(Ring outline) : ring(std::move(outline)) {
    double longest = 0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Point2 edge = ring[(i + 1) % ring.size()] - ring[i];
      if (!(length(edge) > longest)) continue;
      longest = length(edge);
      along = unit(edge);
    }
    across = left_of(along);
    west = south = kInfinity;
    east = north = -kInfinity;
    for (const Point2 p : ring) {
      west = std::min(west, dot(along, p));
      east = std::max(east, dot(along, p));
      south = std::min(south, dot(across, p));
      north = std::max(north, dot(across, p));
    }
  }

  Point2 at(double u, double v) const { return u * along + v * across; }
  double width() const { return east - west; }
  double depth() const { return north - south; }

  Ring ring;
  Point2 along, across;                             ///< Unit vectors.
  double west = 0, east = 0, south = 0, north = 0;  ///< Extent along these.
};

/// The plane that is `elevation` high along the line through `through` and rises by `slope` per
/// metre in the direction of the unit vector `uphill`.
RoofPlane plane_from(Point2 through, Point2 uphill, double elevation, double slope) {
  return snap_plane({through, elevation, slope * uphill.x, slope * uphill.y});
}

/// Convex pieces of a ring, cut from each reflex corner along one of its edges to the opposite
/// side, whichever is nearer. Empty where that does not end.
std::vector<Ring> convex_pieces(const Ring& ring) {
  constexpr double kStraight = 1e-3;  // Sine of a corner that counts as straight.
  constexpr std::size_t kMostPieces = 8;
  std::vector<Ring> open{ring}, done;
  while (!open.empty()) {
    if (open.size() + done.size() > kMostPieces) return {};
    const Ring now = std::move(open.back());
    open.pop_back();
    const std::size_t n = now.size();
    std::size_t reflex = n;
    for (std::size_t i = 0; i < n && reflex == n; ++i)
      if (cross(unit(now[i] - now[(i + n - 1) % n]), unit(now[(i + 1) % n] - now[i])) < -kStraight)
        reflex = i;
    if (reflex == n) {
      done.push_back(now);
      continue;
    }
    const Point2 corner = now[reflex];
    double nearest = kInfinity;
    std::size_t edge = n;
    Point2 hit;
    for (const Point2 way :
         {unit(corner - now[(reflex + n - 1) % n]), unit(corner - now[(reflex + 1) % n])})
      for (std::size_t i = 0; i < n; ++i) {
        if (i == reflex || (i + 1) % n == reflex) continue;
        const Point2 a = now[i], b = now[(i + 1) % n];
        const double side_a = cross(way, a - corner), side_b = cross(way, b - corner);
        if ((side_a > 0) == (side_b > 0)) continue;
        const Point2 p = a + (side_a / (side_a - side_b)) * (b - a);
        const double away = dot(way, p - corner);
        if (!(away > 0 && away < nearest)) continue;
        nearest = away;
        edge = i;
        hit = p;
      }
    if (edge == n) return {};
    hit = on_mm(hit);
    const auto walk = [&](std::size_t first, std::size_t last) {
      Ring piece;
      for (std::size_t i = first;; i = (i + 1) % n) {
        piece.push_back(now[i]);
        if (i == last) break;
      }
      if (!(piece.back() == hit) && !(piece.front() == hit)) piece.push_back(hit);
      return piece;
    };
    for (Ring& piece : std::vector{walk(reflex, edge), walk((edge + 1) % n, reflex)}) {
      if (piece.size() < 3) return {};
      open.push_back(std::move(piece));
    }
  }
  return done;
}

/// Roofs over one piece. What has parts too small to be seen is left for a level roof.
class PieceRoof {
 public:
  PieceRoof(const Piece& piece, double level, double lowest, SeededRandom& random)
      : piece_(piece), level_(level), lowest_(lowest), random_(random) {}

  std::vector<RoofPart> build(SyntheticKind kind) {
    const double what = random_.unit();
    const bool is_wide = std::min(piece_.width(), piece_.depth()) >= kNarrowest;
    if (kind == SyntheticKind::kShed || !is_wide) {
      if (what < 0.5) shed();
    } else if (kind == SyntheticKind::kTower) {
      if (what < 0.7) tower();
    } else if (what < 0.3) {
      gable();
    } else if (what < 0.5) {
      hip();
    } else if (what < 0.6) {
      shed();
    } else if (what < 0.75) {
      mansard();
    } else if (what < 0.85) {
      halves();
    } else if (what < 0.95) {
      tower();
    }
    if (parts_.empty() || std::any_of(parts_.begin(), parts_.end(), is_too_small)) {
      parts_.clear();
      add(piece_.ring, RoofPlane{{0, 0}, level_, 0, 0});
    }
    return std::move(parts_);
  }

 private:
  static bool is_too_small(const RoofPart& part) {
    const Ring& ring = part.outline.outer;
    if (ring.empty() || area(part.outline) < kLeastArea) return true;
    for (std::size_t i = 0; i < ring.size(); ++i)
      if (length(ring[(i + 1) % ring.size()] - ring[i]) < kLeastEdge) return true;
    return false;
  }

  /// Regions may be empty.
  void add(const Ring& region, const RoofPlane& plane) {
    // Cuts that meet in a point make it more than once, and not to the last bit.
    Ring ring;
    for (const Point2 p : region)
      if (ring.empty() || length(p - ring.back()) > kSame) ring.push_back(on_mm(p));
    while (ring.size() > 1 && length(ring.back() - ring.front()) <= kSame) ring.pop_back();
    if (ring.size() < 3) return;
    RoofPart& part = parts_.emplace_back();
    part.outline.outer = std::move(ring);
    part.roof = snap_plane(plane);
  }

  /// The eaves of a roof that rises by so much, half of it above the level.
  double eaves(double rise) const { return std::max(lowest_, level_ - rise / 2); }

  void shed() {
    const double slope = random_.uniform(0.08, 0.5);
    add(piece_.ring, plane_from(piece_.at(piece_.west, piece_.south), piece_.across,
                                eaves(slope * piece_.depth()), slope));
  }

  void gable() {
    const double slope = random_.uniform(0.35, 1.2), half = piece_.depth() / 2;
    const double eave = eaves(slope * half);
    const Point2 middle = piece_.at(piece_.west, piece_.south + half);
    const Point2 up = piece_.across, down = -1.0 * up;
    add(clip(piece_.ring, middle, down),
        plane_from(piece_.at(piece_.west, piece_.south), up, eave, slope));
    add(clip(piece_.ring, middle, up),
        plane_from(piece_.at(piece_.west, piece_.north), down, eave, slope));
    if (random_.chance(0.5)) dormer(eave, slope, half);
  }

  /// A box with a level roof on the southern side of a gable.
  void dormer(double eave, double slope, double half) {
    const double low = 1.2, high = half - 1.2, width = random_.uniform(1.8, 2.6);
    if (high - low < 1.6 || parts_.empty()) return;
    const double middle = (piece_.west + piece_.east) / 2;
    const double top = low + std::min(high - low, 2.2);
    island(middle - width / 2, middle + width / 2, piece_.south + low, piece_.south + top,
           RoofPlane{{0, 0}, round_to_mm(eave + slope * top + 0.35), 0, 0});
  }

  /// Cuts a rectangle out of the first part, if there is room, and gives it a roof.
  void island(double west, double east, double south, double north, const RoofPlane& plane) {
    Ring ring{on_mm(piece_.at(west, south)), on_mm(piece_.at(east, south)),
              on_mm(piece_.at(east, north)), on_mm(piece_.at(west, north))};
    const Ring& around = parts_.front().outline.outer;
    for (const Point2 p : ring)
      if (depth_inside(around, p) < kLeastEdge + 0.05) return;
    RoofPart part;
    part.outline.outer = ring;
    part.roof = snap_plane(plane);
    std::reverse(ring.begin() + 1, ring.end());
    parts_.front().outline.holes.push_back(std::move(ring));
    parts_.push_back(std::move(part));
  }

  /// The four sides of a roof that rises from all around, up to `rim` metres in from the extent.
  void sides(double eave, double slope, double rim) {
    struct PieceSide {
      Point2 from, inward;
    };
    const Point2 u = piece_.along, v = piece_.across;
    const std::array<PieceSide, 4> all{PieceSide{piece_.at(piece_.west, piece_.south), v},
                                       PieceSide{piece_.at(piece_.east, piece_.south), -1.0 * u},
                                       PieceSide{piece_.at(piece_.east, piece_.north), -1.0 * v},
                                       PieceSide{piece_.at(piece_.west, piece_.north), u}};
    for (std::size_t k = 0; k < 4; ++k) {
      const PieceSide& side = all[k];
      Ring region = clip(piece_.ring, side.from + rim * side.inward, -1.0 * side.inward);
      // Nearer to this side than to its neighbours and the one opposite.
      for (const std::size_t other : {(k + 1) % 4, (k + 3) % 4}) {
        if (region.empty()) break;
        const Point2 corner = other == (k + 1) % 4 ? all[other].from : side.from;
        region = clip(region, corner, unit(all[other].inward - side.inward));
      }
      add(region, plane_from(side.from, side.inward, eave, slope));
    }
  }

  void hip() {
    const double slope = random_.uniform(0.35, 1.0);
    const double half = std::min(piece_.depth(), piece_.width()) / 2;
    sides(eaves(slope * half), slope, half);
  }

  void mansard() {
    const double slope = random_.uniform(1.2, 2.2), rim = random_.uniform(1.3, 2);
    const double eave = eaves(slope * rim);
    sides(eave, slope, rim);
    Ring top = piece_.ring;
    for (const auto& [through, inward] :
         {std::pair{piece_.at(piece_.west, piece_.south + rim), piece_.across},
          std::pair{piece_.at(piece_.east - rim, piece_.south), -1.0 * piece_.along},
          std::pair{piece_.at(piece_.west, piece_.north - rim), -1.0 * piece_.across},
          std::pair{piece_.at(piece_.west + rim, piece_.south), piece_.along}})
      if (!top.empty()) top = clip(top, through, inward);
    add(top, snap_plane({{0, 0}, eave + slope * rim, 0, 0}));
  }

  /// Two sheds back to back, one higher.
  void halves() {
    const double slope = random_.uniform(0.2, 0.6), step = random_.uniform(0.8, 2.5);
    const double share = random_.uniform(0.4, 0.6);
    const double line = share * piece_.depth();
    const double eave = eaves(slope * line + step);
    const Point2 middle = piece_.at(piece_.west, piece_.south + line);
    const Point2 up = piece_.across, down = -1.0 * up;
    add(clip(piece_.ring, middle, down),
        plane_from(piece_.at(piece_.west, piece_.south), up, eave, slope));
    add(clip(piece_.ring, middle, up),
        plane_from(middle, down, eave + slope * line + step, random_.uniform(-0.3, 0.1)));
  }

  /// A level roof with a box on it.
  void tower() {
    add(piece_.ring, RoofPlane{{0, 0}, level_, 0, 0});
    const double side =
        std::min(random_.uniform(3, 6), std::min(piece_.width(), piece_.depth()) / 2);
    const double u = (piece_.west + piece_.east) / 2, v = (piece_.south + piece_.north) / 2;
    island(u - side / 2, u + side / 2, v - side / 2, v + side / 2,
           RoofPlane{{0, 0}, level_ + random_.uniform(1.5, 6), 0, 0});
  }

  const Piece& piece_;
  double level_, lowest_;
  SeededRandom& random_;
  std::vector<RoofPart> parts_;
};

double lowest_corner(const RoofPart& part) {
  double low = kInfinity;
  for (const Point2 p : part.outline.outer) low = std::min(low, part.roof(p));
  return low;
}

}  // namespace

std::vector<RoofPart> build_roof(const SyntheticBuilding& building, double ground,
                                 SeededRandom& random) {
  if (!building.footprint.holes.empty()) return {};
  const double level = ground + building.height, lowest = ground + kLowestRoof;
  std::vector<RoofPart> parts;
  bool is_main = true;
  for (const Ring& ring : convex_pieces(building.footprint.outer)) {
    const Piece piece(ring);
    // Wings are lower, some of them.
    const double own =
        is_main || random.chance(0.5) ? level : std::max(lowest, level - random.uniform(1, 3));
    is_main = false;
    for (RoofPart& part : PieceRoof(piece, own, lowest, random).build(building.kind))
      parts.push_back(std::move(part));
  }
  std::vector<Polygon> outlines;
  for (RoofPart& part : parts) outlines.push_back(std::move(part.outline));
  const std::optional<std::vector<Polygon>> shared = share_corners(outlines, kSame);
  if (!shared) return {};
  const std::optional<Polygon> footprint = common_outline(*shared);
  if (!footprint) return {};
  for (std::size_t k = 0; k < parts.size(); ++k) {
    parts[k].outline = (*shared)[k];
    parts[k].lod = Lod::k2_2;
    parts[k].rmse = std::numeric_limits<double>::quiet_NaN();
    if (!(lowest_corner(parts[k]) > ground + 1)) return {};
  }
  if (!tiling_fault(*footprint, parts).empty()) return {};
  if (parts.size() == 1 && parts[0].roof.is_flat()) return {};
  return parts;
}

}  // namespace tetropolis

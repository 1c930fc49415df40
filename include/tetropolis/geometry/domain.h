// What is meshed, as seen from above.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tetropolis/geometry/patch.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

enum class DomainPosition : std::uint8_t {
  kInside,    ///< The polygon's box lies within the domain.
  kCrossing,  ///< The box lies partly within it; the polygon itself may lie beside it.
  kOutside,   ///< The box does not meet it.
};

/// A box, or a simple polygon; callers ask for sides, outline and distances instead of assuming
/// one.
class Domain {
 public:
  /// A side runs so that the domain lies on its left.
  struct Side {
    Point2 from, to;
    Patch patch;
  };

  Domain() = default;
  Domain(const Bounds2& box) : box_(box) {}  // NOLINT: a box is a domain
  Domain(double xmin, double ymin, double xmax, double ymax) : box_{xmin, ymin, xmax, ymax} {}
  /// `ring`: simple, counter-clockwise. `patches`: of each side, the first from vertex 0 to 1.
  /// `own`: those of them that not every city has. Throws Error(kUsage): fewer than three sides, or
  /// not a patch for each.
  Domain(Ring ring, std::vector<Patch> patches, std::vector<PatchInfo> own);

  bool is_box() const { return ring_.empty(); }
  /// Patches of its sides that not every city has; none of a box.
  const std::vector<PatchInfo>& own_patches() const { return own_patches_; }

  /// Whether no point lies in it.
  bool empty() const { return box_.empty(); }
  /// Whether it has an area, and all its coordinates are finite.
  bool is_meshable() const;
  const Bounds2& bounds() const { return box_; }
  double area() const;

  /// Counter-clockwise: side i runs from vertex i of the outline to the next.
  std::vector<Side> sides() const;
  /// Precondition: not empty.
  Polygon outline() const;

  /// Whether p lies inside or on the boundary.
  bool contains(Point2 p) const { return is_box() ? box_.contains(p) : !(depth(p) < 0); }
  /// Whether p lies inside and not on the boundary; a coordinate that is NaN does not.
  bool encloses(Point2 p) const;
  /// Whether a polygon's position is kInside.
  bool covers(const Polygon& polygon) const;
  /// In a box decided by the box of the outer ring's vertices; a polygon covers what has all
  /// vertices and no crossing of its own sides inside. A coordinate that is NaN counts for nothing,
  /// one that is infinite as it is; a polygon without numbers for both x and y counts as inside.
  DomainPosition position_of(const Polygon& polygon) const;

  /// From the line through a side, positive on the domain's side of it. `side` as in sides().
  double distance_to_side(std::size_t side, Point2 p) const;
  /// From the boundary, for a point inside; negative outside.
  double distance_to_boundary(Point2 p) const;

  /// What is at least `margin` away from its boundary; may be empty. Precondition: a box.
  Domain inset(double margin) const { return box_.grown(-margin); }
  Domain moved(Point2 by) const;

  friend bool operator==(const Domain&, const Domain&) = default;

 private:
  double depth(Point2 p) const;

  Bounds2 box_;  ///< Of the ring, if there is one.
  Ring ring_;
  std::vector<Patch> side_patches_;
  std::vector<PatchInfo> own_patches_;
};

}  // namespace tetropolis

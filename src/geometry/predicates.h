// Orientation and in-circle tests whose sign is always right.
//
// A floating-point evaluation decides nearly every call; only when its result is smaller than a
// proven bound of its own rounding error is the determinant evaluated again without any error, as
// an expansion (an unevaluated sum of doubles). Method: J. R. Shewchuk, "Adaptive precision
// floating-point arithmetic and fast robust geometric predicates", Discrete & Computational
// Geometry 18, 1997; two-sum after Knuth, two-product after Dekker and Veltkamp.
//
// Range: every coordinate is zero or between 1e-100 and 1e100 in magnitude; for incircle the
// largest may also be at most 1e100 times the smallest that is not zero. Outside of it products
// may overflow or underflow, and the sign may be wrong. Sources that include this are to be
// compiled without contraction to fused multiply-adds (-ffp-contract=off, which the CMake target
// hands on) and with the default rounding mode.
#pragma once

#include <cmath>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

namespace predicates {

/// Half the distance from 1 to the next double: the relative error of one rounded operation.
inline constexpr double kUnitRoundoff = 0x1p-53;

/// A product of two rounded differences has a relative error of at most 3u + 3u^2 + u^3, and the
/// last subtraction cannot change the sign; the term in u^2 also pays for rounding the bound.
inline constexpr double kOrientBound = (3.0 + 16.0 * kUnitRoundoff) * kUnitRoundoff;

/// Along the longest path of incircle: four rounded differences in the operands, and six rounded
/// operations (two products, two sums, one product, one sum); again second order pays the bound.
inline constexpr double kIncircleBound = (10.0 + 96.0 * kUnitRoundoff) * kUnitRoundoff;

/// More than all products that underflow can add up to within the stated range.
inline constexpr double kUnderflowGuard = 1e-300;

/// The sign alone, without a filter.
int orient2d_exact(Point2 a, Point2 b, Point2 c);
int incircle_exact(Point2 a, Point2 b, Point2 c, Point2 d);

}  // namespace predicates

/// 1 if a, b, c turn left (counter-clockwise), -1 if they turn right, 0 if they are collinear.
inline int orient2d(Point2 a, Point2 b, Point2 c) {
  const double left = (a.x - c.x) * (b.y - c.y);
  const double right = (a.y - c.y) * (b.x - c.x);
  const double det = left - right;
  const double bound =
      predicates::kOrientBound * (std::abs(left) + std::abs(right)) + predicates::kUnderflowGuard;
  if (det > bound) return 1;
  if (det < -bound) return -1;
  // A rounded difference is zero only if the operands are equal: no need to go on for points on
  // one horizontal or vertical line.
  if (left == 0 && right == 0) return 0;
  return predicates::orient2d_exact(a, b, c);
}

/// Whether each of the segments a-b and c-d has its ends strictly on both sides of the other.
inline bool segments_cross(Point2 a, Point2 b, Point2 c, Point2 d) {
  return orient2d(a, b, c) * orient2d(a, b, d) < 0 && orient2d(c, d, a) * orient2d(c, d, b) < 0;
}

/// For a, b, c counter-clockwise: 1 if d is strictly inside their circle, -1 if outside, 0 if the
/// four are cocircular. The sign flips if a, b, c are clockwise.
inline int incircle(Point2 a, Point2 b, Point2 c, Point2 d) {
  const double adx = a.x - d.x, ady = a.y - d.y;
  const double bdx = b.x - d.x, bdy = b.y - d.y;
  const double cdx = c.x - d.x, cdy = c.y - d.y;
  const double bc = bdx * cdy, cb = cdx * bdy;
  const double ca = cdx * ady, ac = adx * cdy;
  const double ab = adx * bdy, ba = bdx * ady;
  const double a_lift = adx * adx + ady * ady;
  const double b_lift = bdx * bdx + bdy * bdy;
  const double c_lift = cdx * cdx + cdy * cdy;
  const double det = a_lift * (bc - cb) + b_lift * (ca - ac) + c_lift * (ab - ba);
  const double permanent = (std::abs(bc) + std::abs(cb)) * a_lift +
                           (std::abs(ca) + std::abs(ac)) * b_lift +
                           (std::abs(ab) + std::abs(ba)) * c_lift;
  const double bound = predicates::kIncircleBound * permanent + predicates::kUnderflowGuard;
  if (det > bound) return 1;
  if (det < -bound) return -1;
  return predicates::incircle_exact(a, b, c, d);
}

}  // namespace tetropolis

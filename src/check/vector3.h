// Vectors, for the checks only, which share as little as they can with what they check
// (tetropolis/check/violation.h).
#pragma once

#include <array>
#include <cmath>

namespace tetropolis {

using Vector3 = std::array<double, 3>;

inline Vector3 difference(const Vector3& a, const Vector3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline double dot(const Vector3& a, const Vector3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline bool is_finite(const Vector3& a) {
  return std::isfinite(a[0]) && std::isfinite(a[1]) && std::isfinite(a[2]);
}
/// a - s * b
inline Vector3 less(const Vector3& a, double s, const Vector3& b) {
  return {a[0] - s * b[0], a[1] - s * b[1], a[2] - s * b[2]};
}
/// The mean of three or four points.
template <typename... Points>
Vector3 centre_of(const Points&... p) {
  constexpr double share = 1.0 / sizeof...(p);
  return {(p[0] + ...) * share, (p[1] + ...) * share, (p[2] + ...) * share};
}
inline double length(const Vector3& a) { return std::sqrt(dot(a, a)); }

}  // namespace tetropolis

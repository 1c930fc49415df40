#include "section.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "tetropolis/core/error.h"

#include "core/infinity.h"
#include "core/units.h"
#include "draw.h"

namespace tetropolis {

namespace {

/// Walls nearer than that count once.
constexpr double kApart = 1.5;  // metres

/// Of buildings: heights and ground, by area of roofs.
struct Built {
  double mean_height = 10;
  double low = kInfinity, high = -kInfinity;  ///< Elevations of all of the surface.
};

Built measure(const SurfaceMesh& surface) {
  Built built;
  double roof = 0, roof_z = 0, ground = 0, ground_z = 0;
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    const PatchKind kind = surface.patch_of(f).kind;
    if (kind == PatchKind::kTop || kind == PatchKind::kSide) continue;
    std::array<Vec3, 3> p;
    for (std::size_t i = 0; i < 3; ++i) {
      p[i] = Vec3(surface.points[static_cast<std::size_t>(surface.triangles[f][i])]);
      built.low = std::min(built.low, p[i].z);
      built.high = std::max(built.high, p[i].z);
    }
    const double area = std::abs(cross(p[1] - p[0], p[2] - p[0]).z) / 2;
    const double z = (p[0].z + p[1].z + p[2].z) / 3;
    if (kind == PatchKind::kRoof) {
      roof += area;
      roof_z += area * z;
    }
    if (kind == PatchKind::kGround) {
      ground += area;
      ground_z += area * z;
    }
  }
  if (roof > 0 && ground > 0) built.mean_height = std::max(3.0, roof_z / roof - ground_z / ground);
  return built;
}

/// The stretch of so many metres that has most of the sorted positions, and how many.
struct Stretch {
  double middle = 0;
  std::size_t count = 0;
};

Stretch fullest(std::vector<double> at, double length) {
  std::sort(at.begin(), at.end());
  std::vector<double> apart;
  for (const double s : at)
    if (apart.empty() || s - apart.back() > kApart) apart.push_back(s);
  Stretch best;
  for (std::size_t i = 0, end = 0; i < apart.size(); ++i) {
    while (end < apart.size() && apart[end] - apart[i] <= length) ++end;
    if (end - i > best.count) best = {(apart[i] + apart[end - 1]) / 2, end - i};
  }
  return best;
}

/// The plane among 96 parallel ones whose stretch of `length` cuts most walls.
struct Candidate {
  CutPlane plane;
  Stretch stretch;
};

Candidate best_of_direction(const SurfaceMesh& surface, const CutPlane& direction, double length) {
  constexpr int kPlanes = 96;
  std::vector<std::size_t> walls;
  double low = kInfinity, high = -kInfinity;
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    if (surface.patch_of(f).kind != PatchKind::kWall) continue;
    walls.push_back(f);
    for (const std::int32_t v : surface.triangles[f]) {
      const double d = direction.distance(Vec3(surface.points[static_cast<std::size_t>(v)]));
      low = std::min(low, d);
      high = std::max(high, d);
    }
  }
  if (walls.empty()) return {direction, {}};
  const double step = (high - low) / (kPlanes + 1);
  std::array<std::vector<double>, kPlanes> positions;
  for (const std::size_t f : walls)
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 a(surface.points[static_cast<std::size_t>(surface.triangles[f][i])]);
      const Vec3 b(surface.points[static_cast<std::size_t>(surface.triangles[f][(i + 1) % 3])]);
      const double da = direction.distance(a), db = direction.distance(b);
      const auto index = [&](double d) { return (d - low) / step - 1; };
      const double from = std::ceil(index(std::min(da, db)));
      for (double k = std::max(0.0, from); k <= index(std::max(da, db)) && k < kPlanes; ++k) {
        if (da == db) continue;
        const double d = low + (k + 1) * step;
        positions[static_cast<std::size_t>(k)].push_back(
            direction.position(a + ((d - da) / (db - da)) * (b - a)));
      }
    }
  Candidate best{direction, {}};
  for (std::size_t k = 0; k < kPlanes; ++k) {
    const Stretch stretch = fullest(positions[k], length);
    if (stretch.count <= best.stretch.count) continue;
    best = {direction, stretch};
    best.plane.through =
        direction.through + (low + static_cast<double>(k + 1) * step) * direction.behind;
  }
  return best;
}

Vec3 middle_of(const SurfaceMesh& surface) {
  Bounds2 box = Bounds2::nothing();
  for (const Point3& p : surface.points) box.extend(Point2{p[0], p[1]});
  return {(box.xmin + box.xmax) / 2, (box.ymin + box.ymax) / 2, 0};
}

/// Of a run of the profile: a face that looks up, or the ground below a building.
struct Slab {
  Point2 left, right;  ///< Upper side.
  Point2 left_foot, right_foot;
  bool is_building = false;
  bool operator<(const Slab& other) const { return left.x < other.left.x; }
};

double elevation_at(std::span<const Slab> ground, double x, bool from_left) {
  // The end nearest to x of the ground on that side.
  double best = kInfinity, z = std::nan("");
  for (const Slab& slab : ground) {
    const Point2 end = from_left ? slab.right : slab.left;
    const double distance = from_left ? x - end.x : end.x - x;
    if (distance < -1e-6 || distance >= best) continue;
    best = distance;
    z = end.y;
  }
  return z;
}

/// What is solid in the plane, down to `floor`: ground, and buildings on the line between the
/// ground on both sides of them.
std::vector<Slab> solid(const std::vector<CutFace>& faces, double floor) {
  std::vector<Slab> ground, roofs;
  for (const CutFace& face : faces) {
    if (face.kind == PatchKind::kWall) continue;
    auto [a, b] = face.ends;
    if (a.x > b.x) std::swap(a, b);
    (face.kind == PatchKind::kGround ? ground : roofs)
        .push_back({a, b, {a.x, floor}, {b.x, floor}, face.kind != PatchKind::kGround});
  }
  std::sort(ground.begin(), ground.end());
  std::sort(roofs.begin(), roofs.end());
  std::vector<Slab> all = ground;
  for (std::size_t begin = 0; begin < roofs.size();) {
    constexpr double kGap = 1e-3;  // metres
    std::size_t end = begin + 1;
    double reach = roofs[begin].right.x;
    while (end < roofs.size() && roofs[end].left.x <= reach + kGap)
      reach = std::max(reach, roofs[end++].right.x);
    const double from = roofs[begin].left.x;
    double a = elevation_at(ground, from, true), b = elevation_at(ground, reach, false);
    if (std::isnan(a)) a = std::isnan(b) ? floor : b;
    if (std::isnan(b)) b = a;
    const auto base = [&](double x) {
      return reach > from ? a + (b - a) * (x - from) / (reach - from) : a;
    };
    all.push_back({{from, a}, {reach, b}, {from, floor}, {reach, floor}, false});
    for (std::size_t i = begin; i < end; ++i) {
      roofs[i].left_foot.y = base(roofs[i].left.x);
      roofs[i].right_foot.y = base(roofs[i].right.x);
      all.push_back(roofs[i]);
    }
    begin = end;
  }
  return all;
}

/// Of a prism between its upright sides, degrees.
double least_upright_dihedral(const TetMesh& mesh, std::size_t wedge) {
  double least = 180;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto p = [&](std::size_t k) {
      const Vec3 at(mesh.points[static_cast<std::size_t>(mesh.wedges[wedge][(i + k) % 3])]);
      return Vec3{at.x, at.y, 0};
    };
    const Vec3 a = normalised(p(1) - p(0)), b = normalised(p(2) - p(0));
    least = std::min(least, std::acos(std::clamp(dot(a, b), -1.0, 1.0)));
  }
  return to_degrees(least);
}

/// Degrees; 0 of flat cells.
double least_dihedral(const TetMesh& mesh, std::int64_t cell) {
  const auto number = static_cast<std::size_t>(cell);
  if (number >= mesh.cells.size()) return least_upright_dihedral(mesh, number - mesh.cells.size());
  const auto& c = mesh.cells[number];
  std::array<Vec3, 4> normals;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto p = [&](std::size_t k) {
      return Vec3(mesh.points[static_cast<std::size_t>(c[(i + k) % 4])]);
    };
    // Outwards: away from corner i.
    const Vec3 n = normalised(cross(p(2) - p(1), p(3) - p(1)));
    normals[i] = dot(n, p(0) - p(1)) > 0 ? -1.0 * n : n;
  }
  double least = 180;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j)
      least = std::min(least, std::acos(std::clamp(-dot(normals[i], normals[j]), -1.0, 1.0)));
  return to_degrees(least);
}

Rgb cell_colour(const TetMesh& mesh, std::int64_t cell, PictureColour colour) {
  if (colour == PictureColour::kQuality) {
    constexpr double kGood = 60;  // degrees
    return ramp(least_dihedral(mesh, cell) / kGood);
  }
  const bool over_building =
      !mesh.region.empty() && mesh.region[static_cast<std::size_t>(cell)] >= 0;
  return over_building ? linear(0xF3EBDD) : linear(0xD6E5F0);
}

Scene cells_scene(const TetMesh& mesh, const CutPlane& plane, PictureColour colour) {
  Scene scene;
  for (const CutCell& cell : cut_cells(mesh, plane)) {
    std::array<std::int32_t, 4> p{};
    const auto size = static_cast<std::size_t>(cell.size);
    for (std::size_t i = 0; i < size; ++i) p[i] = scene.add(plane.at(cell.corners[i]));
    const Rgb of = cell_colour(mesh, cell.cell, colour);
    if (size == 3) {
      scene.add({p[0], p[1], p[2]}, of, kAllEdges);
    } else {  // without the diagonal
      scene.add({p[0], p[1], p[2]}, of, 0b011);
      scene.add({p[0], p[2], p[3]}, of, 0b110);
    }
  }
  return scene;
}

Scene solid_scene(const std::vector<Slab>& slabs, const CutPlane& plane) {
  const Palette palette;
  Scene scene;
  for (const Slab& slab : slabs) {
    const std::int32_t a = scene.add(plane.at(slab.left)), b = scene.add(plane.at(slab.right));
    const std::int32_t c = scene.add(plane.at(slab.right_foot));
    const std::int32_t d = scene.add(plane.at(slab.left_foot));
    const Rgb colour = slab.is_building ? palette.roof : palette.earth;
    scene.add({a, b, c}, colour);
    scene.add({a, c, d}, colour);
  }
  return scene;
}

/// `upper` over `lower`, as much of it as `opacity`.
void lay_over(Canvas& lower, const Canvas& upper, float opacity) {
  for (std::size_t i = 0; i < lower.colour.size(); ++i) {
    const float cover = upper.cover[i] * opacity;
    lower.colour[i] = opacity * upper.colour[i] + (1 - cover) * lower.colour[i];
    lower.cover[i] = cover + (1 - cover) * lower.cover[i];
  }
}

}  // namespace

SectionWindow choose_section(const SurfaceMesh& surface, const std::optional<CutLine>& cut,
                             double aspect) {
  const Built built = measure(surface);
  constexpr double kHeights = 3.2;
  const double high = kHeights * built.mean_height, wide = high * aspect;
  const Vec3 middle = middle_of(surface);
  Candidate chosen{plane_along(90, middle), {}};
  if (cut && cut->position) {
    const bool runs_east = cut->azimuth == 90;
    const Vec3 through =
        runs_east ? Vec3{middle.x, *cut->position, 0} : Vec3{*cut->position, middle.y, 0};
    chosen.plane = plane_along(cut->azimuth, through);
    std::vector<double> walls;
    for (const CutFace& face : cut_faces(surface, chosen.plane))
      if (face.kind == PatchKind::kWall) walls.push_back(face.ends[0].x);
    chosen.stretch = fullest(walls, wide);
  } else if (cut) {
    chosen = best_of_direction(surface, plane_along(cut->azimuth, middle), wide);
  } else {
    chosen = best_of_direction(surface, plane_along(90, middle), wide);
    const Candidate other = best_of_direction(surface, plane_along(0, middle), wide);
    if (other.stretch.count > chosen.stretch.count) chosen = other;
  }
  SectionWindow window{chosen.plane, chosen.stretch.middle - wide / 2,
                       chosen.stretch.middle + wide / 2, 0, 0};
  const std::vector<CutFace> faces = cut_faces(surface, chosen.plane);
  if (faces.empty())
    throw Error(ErrorKind::kUsage,
                "cut: the plane misses the mesh; leave its place out, or give one "
                "in the coordinates of the mesh");
  double ground = kInfinity, top = -kInfinity;
  for (const CutFace& face : faces)
    for (const Point2 end : face.ends) {
      if (end.x < window.left || end.x > window.right) continue;
      ground = std::min(ground, end.y);
      top = std::max(top, end.y);
    }
  if (ground > top) ground = built.low, top = built.high;
  constexpr double kBelow = 0.08;
  window.bottom = ground - kBelow * high;
  window.top = std::max(window.bottom + high, top + 0.25 * high);
  // Towers need more room.
  const double more = ((window.top - window.bottom) * aspect - wide) / 2;
  window.left -= more;
  window.right += more;
  return window;
}

Canvas paint_section(const RenderInput& input, const SectionWindow& window, PictureColour colour,
                     int width, int height) {
  const CutPlane& plane = window.plane;
  // From a little above, with heights stretched, so that the plane is to scale (an oblique
  // projection).
  constexpr double kRise = 0.16;  ///< Of what is behind, metres per metre.
  Camera camera;
  camera.right = plane.along;
  camera.forward = normalised(plane.behind - kRise * Vec3{0, 0, 1});
  camera.up = Vec3{0, 0, 1} + kRise * plane.behind;
  const Vec3 middle =
      plane.at({(window.left + window.right) / 2, (window.bottom + window.top) / 2});
  camera.middle_x = width / 2.0;
  camera.middle_y = height / 2.0;
  camera.scale = width / (window.right - window.left);

  // Near zero, where single precision has its digits.
  const auto painted = [&](Scene scene, const PaintOptions& options) {
    move(scene, -1.0 * middle);
    return paint(scene, camera, width, height, options);
  };
  const Scene city = city_scene(input.surface, colour, false);
  PaintOptions lit;
  const double forward = to_degrees(std::atan2(plane.behind.x, plane.behind.y));
  lit.sun_azimuth = forward + 180 + 50;
  lit.haze = 0.5 / (window.top - window.bottom);
  lit.air = linear(0xEDF3F7);
  Canvas canvas = painted(clipped(city, plane.behind, dot(plane.through, plane.behind)), lit);
  PaintOptions flat;
  flat.is_lit = false;
  flat.edge_strength = 1;
  if (input.volume) {
    const float air = colour == PictureColour::kQuality ? 0.9F : 0.66F;
    lay_over(canvas, painted(cells_scene(*input.volume, plane, colour), flat), air);
  }
  const std::vector<CutFace> faces = cut_faces(input.surface, plane);
  const double below = window.bottom - (window.top - window.bottom);
  lay_over(canvas, painted(solid_scene(solid(faces, below), plane), flat), 1);
  const double thick = std::max(1.5, height / 420.0);
  for (const CutFace& face : faces) {
    const auto at = [&](Point2 p) {
      const ScreenPoint s = camera.project(plane.at(p) - middle);
      return Point2{s.x, s.y};
    };
    draw_line(canvas, at(face.ends[0]), at(face.ends[1]), thick, linear(0x4A3A32));
  }
  return canvas;
}

}  // namespace tetropolis

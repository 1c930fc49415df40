// The state of a refinement: pieces of segments, kinds of vertices, size bounds and queues.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <vector>

#include "tetropolis/core/progress.h"
#include "tetropolis/ground/refine.h"

#include "construct.h"
#include "core/infinity.h"
#include "tri_mesh.h"

namespace tetropolis {

/// A stretch of an input segment between two hard vertices (input points and crossings).
struct Piece {
  std::int32_t v[2];
  std::int32_t input;
  bool acute[2];  ///< It bounds a corner sharper than 60 degrees at that end.
};

/// What a vertex is: a hard one, one on a piece (the index of which is >= 0), or free.
inline constexpr std::int32_t kFreeVertex = -1;
inline constexpr std::int32_t kHardVertex = -2;

/// The largest power of two that is not larger than `value` > 0.
inline double power_of_two_below(double value) { return std::ldexp(1.0, std::ilogb(value)); }

/// The longest edge allowed at a place.
class SizeBound {
 public:
  SizeBound(const PlanarGraph& graph, const RefineOptions& options);

  /// But for edges at segments with a bound of their own.
  bool constant() const { return !by_region_ && !options_->size_field; }
  double base() const { return base_; }
  double in_region(std::int32_t region) const;
  /// Whether a segment has a bound of its own.
  bool by_segment() const { return by_segment_ != nullptr; }
  /// For edges at its points. `input`: index of the segment, negative on the hull.
  double at_segment(std::int32_t input) const {
    return input < 0 || !by_segment() ? kInfinity : (*by_segment_)[static_cast<std::size_t>(input)];
  }
  /// Squared bound for the edge between p and q in `region`.
  double squared(std::int32_t region, Point2 p, Point2 q) const {
    return constant() ? base_squared_ : local_squared(region, p, q);
  }

 private:
  double local_squared(std::int32_t region, Point2 p, Point2 q) const;

  const RefineOptions* options_;
  const std::vector<double>* by_segment_ = nullptr;
  double base_ = kInfinity;
  double base_squared_ = kInfinity;
  bool by_region_ = false;
  std::vector<std::pair<std::int32_t, double>> regions_;  // sorted by marker
};

class Refiner {
 public:
  Refiner(const PlanarGraph& graph, const RefineOptions& options, Construction& construction);

  /// Even cuts of the pieces, and the lattice. Before the outside is carved.
  void seed(const Progress& progress);
  /// After it is carved along the curve.
  void run(const Progress& progress);
  /// Moves free vertices where that widens the smallest angle around them and breaks no guarantee.
  void optimize(const Progress& progress);
  /// The same where that makes steep triangles less steep. Precondition: there are elevations.
  void flatten(const Progress& progress);

  std::int64_t small_input_angles() const { return small_input_angles_; }
  std::int64_t count_below_min_angle() const;
  std::vector<std::int32_t> piece_inputs() const;

 private:
  struct BadTriangle {
    std::int32_t t;
    std::int32_t v[3];
  };
  struct LongSubsegment {
    std::int32_t s;
    std::int32_t v[2];
  };
  // Squared edge lengths by opposite vertex and by size, and twice the area. Which edge is which is
  // asked of bad triangles only: for all of them it would be a branch mispredicted half of the
  // time.
  struct Shape {
    std::array<double, 3> squared;
    double twice_area;
    double least, middle, most;

    int shortest() const { return squared[0] == least ? 0 : squared[1] == least ? 1 : 2; }
    int longest() const { return squared[2] == most ? 2 : squared[1] == most ? 1 : 0; }
  };
  // Worst first: buckets of skinny triangles by shortest edge, doubling its square from one to the
  // next, then triangles that are only too large by falling circumradius.
  static constexpr int kSkinnyBuckets = 44;
  static constexpr int kBuckets = 64;

  void find_pieces();
  void find_corners();
  void cut_pieces();
  void cut_piece(std::int32_t s, double size);
  /// Where a subsegment is to be cut.
  struct Cuts {
    std::int32_t segment;
    std::vector<double> places;  ///< Ascending, of its piece, from 0 to 1.
  };
  void cut(Cuts cuts);
  void cut_the_rest();
  std::vector<Point2> lattice_nodes() const;
  void insert_lattice(const Progress& progress);

  Shape shape(const TriMesh::Triangle& x) const;
  /// The longest edge that a vertex allows for the segments it lies on.
  double bound_at(std::int32_t v) const {
    const std::int32_t k = kind(v);
    if (k == kFreeVertex) return kInfinity;
    return k == kHardVertex ? hard_bounds_[static_cast<std::size_t>(v)]
                            : size_.at_segment(piece(k).input);
  }
  /// Squared bound for the edge between two vertices in `region`.
  double squared_bound(std::int32_t region, std::int32_t u, std::int32_t v) const {
    const double bound = size_.squared(region, mesh_.point(u), mesh_.point(v));
    if (!size_.by_segment()) return bound;
    const double at = std::min(bound_at(u), bound_at(v));
    return std::min(bound, at * at);
  }
  bool skinny(const Shape& s) const {
    return s.twice_area * s.twice_area < sine_squared_ * s.most * s.middle;
  }
  int oversized_edge(const TriMesh::Triangle& x, const Shape& s) const;
  bool excused(const TriMesh::Triangle& x, const Shape& s) const;
  double squared_sine_across(std::int32_t x, std::int32_t y) const;

  int skinny_bucket(const Shape& s) const;
  int oversized_bucket(const TriMesh::Triangle& x, const Shape& s, int edge) const;
  void consider(std::int32_t t);
  void consider_touched();
  bool pop(BadTriangle& bad);
  void improve(const BadTriangle& bad);
  Point2 split_position(const TriMesh::Triangle& x, const Shape& s, bool is_skinny) const;
  std::int32_t walk(std::int32_t t, Point2 target, std::int32_t& blocking) const;
  bool in_lens(Point2 p, Point2 a, Point2 b) const {
    const double ax = a.x - p.x, ay = a.y - p.y, bx = b.x - p.x, by = b.y - p.y;
    const double dot = ax * bx + ay * by;
    return dot < 0 && dot * dot > lens_cosine_squared_ * (ax * ax + ay * ay) * (bx * bx + by * by);
  }
  bool encroached(std::int32_t s) const;
  bool split(std::int32_t s);
  Point2 cut_position(const TriMesh::Subsegment& s) const;
  bool piece_end_is_acute(const Piece& piece, std::int32_t vertex) const {
    return (piece.v[0] == vertex && piece.acute[0]) || (piece.v[1] == vertex && piece.acute[1]);
  }
  /// Whether the terrain is seen there, not the roof of a building.
  bool is_open(const TriMesh::Triangle& x) const {
    if (x.v[0] == TriMesh::kDead) return false;
    const auto region = static_cast<std::size_t>(x.region);  // a negative one is beyond the list
    return region >= options_.off_terrain.size() || options_.off_terrain[region] == 0;
  }
  double flatness(const TriMesh::Triangle& x) const;
  bool flatten_around(std::int32_t v, std::int32_t he, double content);
  bool move_vertex(std::int32_t v, std::int32_t he, double content);
  bool edges_fit(const std::int32_t* rim, std::size_t count, Point2 p) const;
  std::int32_t add_vertex(Point2 p, std::int32_t kind);
  std::int32_t& kind(std::int32_t v) { return kinds_[static_cast<std::size_t>(v)]; }
  std::int32_t kind(std::int32_t v) const { return kinds_[static_cast<std::size_t>(v)]; }
  double& elevation(std::int32_t v) { return elevations_[static_cast<std::size_t>(v)]; }
  double elevation(std::int32_t v) const { return elevations_[static_cast<std::size_t>(v)]; }
  Piece& piece(std::int32_t p) { return pieces_[static_cast<std::size_t>(p)]; }
  const Piece& piece(std::int32_t p) const { return pieces_[static_cast<std::size_t>(p)]; }

  const RefineOptions& options_;
  TriMesh& mesh_;
  SizeBound size_;
  std::vector<Piece> pieces_;
  std::vector<Cuts> rest_;  ///< What could not be cut with the outside there.
  std::vector<std::int32_t> kinds_;
  std::vector<double> hard_bounds_;  ///< Per hard vertex, if segments have bounds: the least.
  std::vector<double> elevations_;   ///< Per vertex, while flattening.
  std::array<std::deque<BadTriangle>, kBuckets> buckets_;
  std::uint64_t filled_ = 0;  // bit b: bucket b is not empty
  std::int64_t queued_ = 0;
  std::vector<LongSubsegment> encroached_;
  std::vector<std::int32_t> hit_;
  int largest_edge_exponent_ = 0;  // of the square of the longest edge to be expected
  double sine_squared_ = 0;
  double cosine_ = 0;
  double off_centre_height_ = 0;  // over a shortest edge of length 1
  double lens_cosine_squared_ = 0;
  std::int64_t max_vertices_ = 0;
  std::int64_t small_input_angles_ = 0;
};

}  // namespace tetropolis

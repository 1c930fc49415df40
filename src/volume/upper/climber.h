// What single columns of the front do.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "tetropolis/core/buffer.h"

#include "core/infinity.h"
#include "front.h"
#include "star_rows.h"

namespace tetropolis {

using Piece = std::int32_t;  // a triangle of the front
constexpr Piece kNoPiece = -1;

struct FrontTriangle {
  std::int32_t nth;     // of those that its step made; of the lid's, by their places
  VertexIndex made_by;  // With `order`, as in FrontColumn, which step that was;
  double order;         // -infinity: it is on the lid.
  Point3 centre;        // of the cell below
  bool is_lid;          // which no cell is on yet

  bool is_older(const FrontTriangle& other) const {
    return std::tie(order, made_by, nth) < std::tie(other.order, other.made_by, other.nth);
  }
};

struct FrontColumn {
  Point3 at{};                // the front's node
  double lid = 0, edge = 0;   // elevation of the lid, longest edge on it
  double order = -kInfinity;  // Steps are taken by this, by vertex, and as they come.
  double spacing = 0;         // In the front as it is,
  double longest = -1;        // as is the longest edge; negative: to be found anew.
  std::int32_t cells = 0;     // that it has made
  std::int16_t risen = 0;     // so often
  bool stays = false;         // at the rim
};

/// When a column is to go: before those around it that are due later, or as late and of a higher
/// vertex.
struct Turn {
  double due = kInfinity;  // its key when that was found; infinity: done
  std::int32_t tile = 0;
  std::int32_t held = 0;  // The phase in which it, or one due before it, is left for later.
};

/// A column around another, and the triangle to the left of the edge to it.
struct Neighbour {
  VertexIndex vertex;
  Piece piece;
};

/// The front.
struct Front {
  double top = 0;
  std::vector<FrontColumn> columns;  // per vertex
  std::vector<Turn> turns;           // per vertex
  Buffer<FrontTriangle> triangles;   // by triangle of the ground mesh
  /// Per vertex, counter-clockwise, at the rim from there to there; none where it has ended, or
  /// does not climb now.
  std::vector<std::vector<Neighbour>> around;
};

class Worst;

/// Has columns of one tile climb.
class Climber {
 public:
  /// `shares`: per vertex, of the spacing that segments are to have. `risen`: as in StepsWithin,
  /// where that is asked for.
  Climber(Front& front, std::span<const double> shares, FrontSteps& done,
          std::vector<std::int16_t>* risen = nullptr)
      : front_(front), shares_(shares), done_(done), risen_(risen) {}

  /// When the column is due for the first time.
  void set_due(VertexIndex v);
  /// Has the column climb to the top, and others of its tile as far as it waits for them; in the
  /// phase, from 1 on.
  void climb(VertexIndex first, std::int32_t phase);
  /// Has columns climb to the top, among others that do again what the record tells of them.
  /// Returns whether that was possible: otherwise the others would have done something else.
  bool climb(std::span<const VertexIndex> columns, std::span<const VertexIndex> others,
             const FrontRecord& record);

 private:
  /// A triangle of the front where a column has ended.
  struct CapCorners {
    std::array<VertexIndex, 3> vertices;
    Piece piece;
  };
  /// A triangle around a vertex, from which it is to the left of the edge from `vertex` to `next`.
  struct Spoke {
    VertexIndex vertex, next;
    Piece piece;
  };
  FrontColumn& column(VertexIndex v) { return front_.columns[v]; }
  const FrontColumn& column(VertexIndex v) const { return front_.columns[v]; }
  FrontTriangle& triangle(Piece piece) {
    const auto i = static_cast<std::size_t>(piece), first = front_.triangles.size();
    return i < first ? front_.triangles[i] : added_[i - first];
  }
  const Point3& at(VertexIndex v) const { return column(v).at; }

  template <typename Visit>
  void for_each_around(const Visit& visit) const {
    for (const Spoke& spoke : star_) visit(spoke.vertex);
    if (star_.back().next != star_.front().vertex) visit(star_.back().next);
  }
  void find_star(VertexIndex v);
  void measure_star(VertexIndex v);
  double key(VertexIndex v) const;
  bool may_end(VertexIndex v) const;
  /// That it may have now.
  double longest_edge(VertexIndex v) const;
  bool wants_to_end(VertexIndex v) const;
  std::pair<double, double> best_rise(VertexIndex v);
  Worst worst_of_rise(VertexIndex v, double to);
  void add_step(VertexIndex v, double to) {
    done_.steps.push_back({to, v, static_cast<std::int32_t>(star_.size())});
    done_.orders.push_back(column(v).order);
  }
  void add_other(VertexIndex v) {
    done_.others.push_back(v);
    if (risen_ != nullptr) risen_->push_back(column(v).risen);
  }
  /// By the nth cell of the step of v.
  void cover(const Spoke& spoke, VertexIndex v, std::int32_t nth) {
    if (!std::exchange(triangle(spoke.piece).is_lid, false)) return;
    done_.covered.push_back({TriangleIndex(spoke.piece), v, column(v).cells + nth});
  }
  void add_poor(VertexIndex v) {
    done_.poor.push_back(v);
    for_each_around([&](VertexIndex u) { done_.poor.push_back(u); });
  }
  void rise(VertexIndex v, double to);
  bool end(VertexIndex v, double least_share, double least_angle);
  void close(VertexIndex u, VertexIndex v, std::span<const CapCorners> caps);
  void go(VertexIndex v);
  void repeat(VertexIndex v, const FrontRecord::Step& step);

  Front& front_;
  std::span<const double> shares_;
  FrontSteps& done_;
  std::vector<std::int16_t>* risen_;
  bool is_sound_ = true;
  std::vector<FrontTriangle> added_;  // under caps of others, numbered after those of the front
  std::vector<Spoke> star_;           // of the vertex that is looked at,
  StarRows rows_;                     // and its points
  std::vector<VertexIndex> waiting_;  // each for the one after it
};

}  // namespace tetropolis

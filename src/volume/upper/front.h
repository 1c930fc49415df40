// The front that climbs from the lid to the top, as several threads have it climb.
//
// What a column does depends on those around it only, and on which of them have moved before. So a
// column may go as soon as all around it are to go later, whatever is going on elsewhere, and all
// is as if one thread had taken them in order. The ground is divided into tiles, one thread to
// each, which are as small as fits a cache: columns beside another tile stay, and so do those that
// wait for them; tiles across the seams are next, those across their seams, and the first again.
// What is left after some rounds, if anything, is done in one piece.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// What a column does: it rises, or ends and leaves its hole to cells under new triangles. Its
/// cells have the column's node in common and are told by the columns of their others, at the nodes
/// where these are by then.
struct FrontStep {
  double to;  ///< Elevation; not a number if it ends.
  VertexIndex vertex;
  std::int32_t around;  ///< How many triangles of the front there are.

  bool is_end() const { return std::isnan(to); }
  /// How many cells it makes.
  std::int32_t cells() const { return is_end() ? around - 2 : around; }
  /// In FrontSteps::others.
  std::int32_t others() const { return is_end() ? 3 * cells() : around + 1; }
};

/// A cell on the stack over a triangle.
struct CoveredTriangle {
  TriangleIndex triangle;
  VertexIndex vertex;  ///< Its column has made the cell,
  std::int32_t nth;    ///< after so many others.
};

/// How often the column of an entry of FrontSteps::others has risen by then.
struct Risen {
  std::uint32_t other;
  std::int16_t times;
};

/// Those of a tile, as they are taken.
struct FrontSteps {
  std::vector<FrontStep> steps;
  /// Per step, what columns that are next to each other go by, and then by vertex.
  std::vector<double> orders;
  /// Step by step. Of one that rises: the around + 1 columns around it, counter-clockwise, of which
  /// the last is the first again unless it is at the rim. Of one that ends, three for each cell.
  std::vector<VertexIndex> others;
  /// Entries of `others`, ascending, whose columns have risen by then otherwise than steps before
  /// tell.
  std::vector<Risen> risen;
  std::vector<CoveredTriangle> covered;
  /// Vertices at which cells came below the floor, and those beside them.
  std::vector<VertexIndex> poor;

  /// Gives back the memory that is not used.
  void shrink() {
    steps.shrink_to_fit();
    orders.shrink_to_fit();
    others.shrink_to_fit();
  }
};

/// By phase and tile; tiles of a phase have no column in common, in steps or others.
using FrontPhases = std::vector<std::vector<FrontSteps>>;

/// Steps of some columns, by column.
class FrontRecord {
 public:
  struct Step {
    const FrontStep* step;
    const VertexIndex* first_other;
    double order;
    std::span<const VertexIndex> others() const {
      return {first_other, static_cast<std::size_t>(step->others())};
    }
  };
  /// `is_kept`: per vertex, 1 for those columns. The phases are to outlive this.
  FrontRecord(const FrontPhases& phases, std::span<const std::uint8_t> is_kept);
  /// In their order.
  std::span<const Step> steps_of(VertexIndex v) const {
    return std::span(steps_).subspan(first_[v], first_[v + 1] - first_[v]);
  }

 private:
  std::vector<std::uint32_t> first_;  // per vertex and one more
  std::vector<Step> steps_;
};

/// Calls visit(step, its others) in the order of the phases.
template <typename Visit>
void for_each_step(const FrontSteps& steps, const Visit& visit) {
  const VertexIndex* others = steps.others.data();
  for (const FrontStep& step : steps.steps) {
    visit(step, std::span(others, static_cast<std::size_t>(step.others())));
    others += step.others();
  }
}

/// Of some columns among others.
struct StepsWithin {
  FrontSteps done;
  /// Per entry of done.others: how often its column has risen by then.
  std::vector<std::int16_t> risen;
};

struct Front;

/// `shares`: per vertex, of the spacing that segments are to have. See grow_upper().
class FrontClimb {
 public:
  /// `tiles`: along the longer side of the ground, >= 1; each column's steps are the same for any
  /// number. The mesh is to outlive this. `cancelled`: as of Progress, polled by tile or call.
  FrontClimb(const ColumnMesh& mesh, double top, std::size_t tiles,
             std::function<bool()> cancelled = {});
  FrontClimb(const FrontClimb&) = delete;
  FrontClimb& operator=(const FrontClimb&) = delete;
  ~FrontClimb();
  /// All columns, from the lid to the top.
  FrontPhases to_top(std::span<const double> shares);
  /// Some columns, among others that do again what is on record: all that any of them has ever been
  /// next to, ascending. The steps of the former; nothing if the others cannot do the same next to
  /// these.
  std::optional<StepsWithin> within(std::span<const VertexIndex> columns,
                                    std::span<const VertexIndex> others, const FrontRecord& record,
                                    std::span<const double> shares);

 private:
  void start(std::span<const VertexIndex> columns, std::span<const double> shares);
  /// Throws Cancelled. From any thread.
  void poll();

  const ColumnMesh& mesh_;
  std::size_t tiles_;
  std::unique_ptr<Front> front_;
  std::function<bool()> cancelled_;
  std::mutex polling_;
  std::int32_t phase_ = 0;
};

/// How many are worth while.
std::size_t useful_tiles(const ColumnMesh& mesh);

}  // namespace tetropolis

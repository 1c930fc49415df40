// The patches of the boundary: their numbers, names and kinds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tetropolis {

/// What a boundary face belongs to. The numbers are those written to files; a mesh may have more.
enum class Patch : std::int32_t {
  kGround = 1,
  kRoof = 2,
  kWall = 3,
  kTop = 4,
  kXMin = 5,
  kXMax = 6,
  kYMin = 7,
  kYMax = 8,
};

/// What the faces of a patch are.
enum class PatchKind : std::uint8_t {
  kGround,  ///< On the terrain.
  kRoof,    ///< Of a building, level or sloped.
  kWall,    ///< Of a building, vertical.
  kTop,     ///< Of the domain.
  kSide,    ///< Of the domain, vertical.
  kOther,   ///< Not known: of a file that has numbers without names.
};

struct PatchInfo {
  Patch patch = Patch::kGround;
  std::string name;
  PatchKind kind = PatchKind::kOther;

  bool of_building() const { return kind == PatchKind::kRoof || kind == PatchKind::kWall; }
  /// Whether air meets something there: OpenFOAM's type `wall` instead of `patch`.
  bool is_solid() const { return of_building() || kind == PatchKind::kGround; }
  friend bool operator==(const PatchInfo&, const PatchInfo&) = default;
};

/// The patches that the faces of a mesh may have, ascending by number.
class PatchTable {
 public:
  /// Those of every city: "ground", "roof", "wall", "top", "xmin", "xmax", "ymin", "ymax".
  PatchTable();
  /// Precondition: none has its number.
  void add(PatchInfo info);

  /// Where a patch stands; size() if it does not.
  std::size_t position(Patch patch) const;
  bool contains(Patch patch) const { return position(patch) < patches_.size(); }
  /// Precondition: the patch is there.
  const PatchInfo& of(Patch patch) const { return patches_[position(patch)]; }
  std::vector<Patch> solid() const;

  const PatchInfo& operator[](std::size_t i) const { return patches_[i]; }
  std::size_t size() const { return patches_.size(); }
  auto begin() const { return patches_.begin(); }
  auto end() const { return patches_.end(); }
  friend bool operator==(const PatchTable&, const PatchTable&) = default;

 private:
  /// Where the first patch stands whose number is not below; size() without one.
  std::size_t lower_bound(Patch patch) const;

  std::vector<PatchInfo> patches_;
};

}  // namespace tetropolis

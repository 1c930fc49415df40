#include "tetropolis/geometry/patch.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace tetropolis {

PatchTable::PatchTable()
    : patches_{{Patch::kGround, "ground", PatchKind::kGround},
               {Patch::kRoof, "roof", PatchKind::kRoof},
               {Patch::kWall, "wall", PatchKind::kWall},
               {Patch::kTop, "top", PatchKind::kTop},
               {Patch::kXMin, "xmin", PatchKind::kSide},
               {Patch::kXMax, "xmax", PatchKind::kSide},
               {Patch::kYMin, "ymin", PatchKind::kSide},
               {Patch::kYMax, "ymax", PatchKind::kSide}} {}

void PatchTable::add(PatchInfo info) {
  assert(!contains(info.patch));
  const auto after = std::find_if(patches_.begin(), patches_.end(),
                                  [&](const PatchInfo& other) { return other.patch > info.patch; });
  patches_.insert(after, std::move(info));
}

std::size_t PatchTable::position(Patch patch) const {
  // Numbers from 1 without a gap are the rule.
  const auto guess = static_cast<std::size_t>(patch) - 1;
  if (guess < patches_.size() && patches_[guess].patch == patch) return guess;
  const auto found = std::find_if(patches_.begin(), patches_.end(),
                                  [&](const PatchInfo& info) { return info.patch == patch; });
  return static_cast<std::size_t>(found - patches_.begin());
}

std::vector<Patch> PatchTable::solid() const {
  std::vector<Patch> solid;
  for (const PatchInfo& info : patches_)
    if (info.is_solid()) solid.push_back(info.patch);
  return solid;
}

}  // namespace tetropolis

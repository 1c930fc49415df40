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
  const auto after = patches_.begin() + static_cast<std::ptrdiff_t>(lower_bound(info.patch));
  patches_.insert(after, std::move(info));
}

std::size_t PatchTable::position(Patch patch) const {
  // Numbers from 1 without a gap are the rule.
  const auto guess = static_cast<std::size_t>(patch) - 1;
  if (guess < patches_.size() && patches_[guess].patch == patch) return guess;
  const std::size_t found = lower_bound(patch);
  return found < patches_.size() && patches_[found].patch == patch ? found : patches_.size();
}

std::size_t PatchTable::lower_bound(Patch patch) const {
  const auto found =
      std::lower_bound(patches_.begin(), patches_.end(), patch,
                       [](const PatchInfo& info, Patch number) { return info.patch < number; });
  return static_cast<std::size_t>(found - patches_.begin());
}

std::vector<Patch> PatchTable::solid() const {
  std::vector<Patch> solid;
  for (const PatchInfo& info : patches_)
    if (info.is_solid()) solid.push_back(info.patch);
  return solid;
}

}  // namespace tetropolis

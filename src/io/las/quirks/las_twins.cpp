#include "las_twins.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/las/las_decode.h"

namespace tetropolis {

namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kLeastTwin = 100;  // points of which two equal boxes are no coincidence

/// Points compared in one place; enough that they hardly all have one class.
constexpr std::int64_t kSampled = 1000;

/// Some points of a file, in CRS coordinates.
struct Sample {
  std::vector<std::array<double, 3>> points;
  std::vector<std::uint8_t> classes;
};

/// Adds the points from `first` on to `sample`. Precondition: that of decode_points.
void take_sample(const fs::path& path, const LasLayout& layout, std::int64_t first,
                 Sample& sample) {
  const LasInfo& info = layout.info;
  const std::int64_t count = std::min(kSampled, info.point_count - first);
  decode_points(path, layout, first, count, [&](const LasBlock& block) {
    for (std::size_t i = 0; i < block.size(); ++i) {
      const Point2 p = position(info, block.x[i], block.y[i]);
      sample.points.push_back({p.x, p.y, block.z[i] * info.scale[2] + info.offset[2]});
      sample.classes.push_back(block.classification[i]);
    }
  });
}

/// Multiples of it are points from which on both files can be decoded; the point count if there is
/// none but the first.
std::int64_t common_step(const LasLayout& a, const LasLayout& b) {
  const auto step = [](const LasLayout& layout) {
    if (!layout.info.compressed || layout.variable_chunks) return std::int64_t{1};
    return layout.chunk_size > 0 ? layout.chunk_size : layout.info.point_count;
  };
  const std::int64_t larger = std::max(step(a), step(b));
  return larger % std::min(step(a), step(b)) == 0 ? larger : a.info.point_count;
}

/// Whether points differ by no more than what rounding makes of them.
bool are_alike(const Sample& a, const LasInfo& in_a, const Sample& b, const LasInfo& in_b) {
  for (std::size_t i = 0; i < a.points.size(); ++i)
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (std::abs(a.points[i][axis] - b.points[i][axis]) > in_a.scale[axis] + in_b.scale[axis])
        return false;
  return true;
}

/// How much the classes tell: how many there are, 0 and 1 left out, and of how many points.
std::pair<std::ptrdiff_t, std::ptrdiff_t> count_classes(const Sample& sample) {
  std::vector<std::uint8_t> classes = sample.classes;
  std::erase_if(classes, [](std::uint8_t code) { return code <= kUnclassified; });
  const std::set<std::uint8_t> different(classes.begin(), classes.end());
  return {std::ssize(different), std::ssize(classes)};
}

enum class Likeness {
  kDifferent,
  kCopies,
  kOtherClasses,  // which tell no more in the second file
  kMoreClasses,
};

/// Compares two files of the same count of points, which is not 0.
Likeness compare_files(const fs::path& a, const LasLayout& in_a, const fs::path& b,
                       const LasLayout& in_b) {
  const std::int64_t step = common_step(in_a, in_b);
  std::set<std::int64_t> places;
  for (const std::int64_t quarter : {0, 1, 2, 3, 4})
    places.insert(std::max<std::int64_t>(in_a.info.point_count - kSampled, 0) / 4 * quarter / step *
                  step);
  Sample of_a, of_b;
  for (const std::int64_t first : places) {
    take_sample(a, in_a, first, of_a);
    take_sample(b, in_b, first, of_b);
    if (!are_alike(of_a, in_a.info, of_b, in_b.info)) return Likeness::kDifferent;
  }
  if (of_a.classes == of_b.classes) return Likeness::kCopies;
  return count_classes(of_b) > count_classes(of_a) ? Likeness::kMoreClasses
                                                   : Likeness::kOtherClasses;
}

}  // namespace

void find_twins(std::span<const fs::path> paths, std::vector<LasPlan>& plans) {
  using Key = std::tuple<std::int64_t, std::array<double, 3>, std::array<double, 3>>;
  std::map<Key, std::size_t> kept;
  for (std::size_t f = 0; f < plans.size(); ++f) {
    const LasInfo& info = plans[f].layout.info;
    if (info.point_count < kLeastTwin || !is_sound(info)) continue;
    const auto [entry, is_new] = kept.try_emplace({info.point_count, info.min, info.max}, f);
    if (is_new) continue;
    const std::size_t earlier = entry->second;
    const Likeness likeness =
        compare_files(paths[earlier], plans[earlier].layout, paths[f], plans[f].layout);
    if (likeness == Likeness::kDifferent) continue;
    const bool drops_earlier = likeness == Likeness::kMoreClasses;
    const std::size_t dropped = drops_earlier ? earlier : f;
    entry->second = drops_earlier ? f : earlier;
    plans[dropped].is_twin = true;
    plans[dropped].warnings = {
        {"las_twin", info.point_count,
         fmt::format("{}: has the same points as {}{}; it is not read", paths[dropped].string(),
                     paths[entry->second].string(),
                     likeness == Likeness::kCopies ? "" : ", with classes that tell no more")}};
  }
}

}  // namespace tetropolis

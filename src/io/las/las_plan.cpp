#include "las_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "core/parallel.h"
#include "io/file/input_file.h"
#include "io/las/quirks/las_twins.h"
#include "las_decode.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

constexpr std::int64_t kLeastTwin = 100;  // points of which two equal boxes are no coincidence

bool is_sound(const LasInfo& info) {
  const auto finite = [](double v) { return std::isfinite(v); };
  return std::all_of(info.min.begin(), info.min.end(), finite) &&
         std::all_of(info.max.begin(), info.max.end(), finite) && info.min[0] <= info.max[0] &&
         info.min[1] <= info.max[1];
}

/// Whether a handful of points from all over the file lie in the box.
bool box_holds_samples(const fs::path& path, const LasLayout& layout) {
  const LasInfo& info = layout.info;
  const Bounds2 box = header_box(info);
  bool inside = true;
  const auto probe = [&](std::int64_t first, std::int64_t count) {
    decode_points(path, layout, first, std::min(count, info.point_count - first),
                  [&](const LasBlock& block) {
                    for (std::size_t i = 0; i < block.size(); ++i)
                      inside = inside && box.contains(position(info, block.x[i], block.y[i]));
                  });
  };
  probe(0, 4);
  // LAZ can be entered at the start of a chunk only, unless LASzip finds it.
  const std::int64_t step = info.compressed && !layout.variable_chunks ? layout.chunk_size : 1;
  if (step > 0)
    for (const std::int64_t share : {1, 2, 3, 4})
      probe((info.point_count - 1) / step * share / 4 * step, 4);
  return inside;
}

/// Whether chunks are sound, and the points that the header counts end where the last one does.
void check_chunks(const fs::path& path, LasPlan& plan) {
  const std::int64_t found = check_layers(path, plan.layout);
  if (found < 0) return;
  const std::int64_t points = plan.layout.info.point_count;
  const std::int64_t counted = (points - 1) % plan.layout.chunk_size + 1;
  if (found < counted)
    fail_input(path, fmt::format("the header counts {} points, but only {} are there; get it again",
                                 points, points - counted + found));
  if (found > counted)
    plan.warnings.push_back(
        {"las_count_small", found - counted,
         fmt::format("{}: the header counts {} points, but {} more follow; these are not read",
                     path.string(), points, found - counted)});
}

LasPlan plan_file(const fs::path& path, const ReadPointsOptions& options, LasSystems& systems) {
  LasPlan plan;
  plan.layout = read_las_layout(path, systems, options.crs.empty());
  plan.warnings = plan.layout.info.warnings;
  check_las_length(path, plan.layout);
  check_chunks(path, plan);
  const LasInfo& info = plan.layout.info;
  const bool sound = is_sound(info);
  plan.check_box = sound;
  if (!options.crop || info.point_count == 0) return plan;
  if (sound && header_box(info).intersects(*options.crop)) return plan;
  if (sound && box_holds_samples(path, plan.layout)) {
    plan.skip = true;
    return plan;
  }
  plan.check_box = false;
  plan.warnings.push_back({"las_box_untrusted", 1,
                           path.string() + ": points lie outside the box that its header states; "
                                           "the whole file is read"});
  return plan;
}

}  // namespace

Bounds2 header_box(const LasInfo& info) {
  const double margin_x = 2 * std::abs(info.scale[0]);
  const double margin_y = 2 * std::abs(info.scale[1]);
  return {info.min[0] - margin_x, info.min[1] - margin_y, info.max[0] + margin_x,
          info.max[1] + margin_y};
}

std::vector<LasPlan> plan_files(std::span<const fs::path> paths, const ReadPointsOptions& options) {
  std::vector<LasPlan> plans(paths.size());
  LasSystems systems;
  parallel_in_order(paths.size(),
                    [&](std::size_t f) { plans[f] = plan_file(paths[f], options, systems); });
  return plans;
}

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
         fmt::format(
             "{}: has the number of points, the box and the first points of {}{}; taken "
             "for a copy of it and not read",
             paths[dropped].string(), paths[entry->second].string(),
             likeness == Likeness::kCopies ? "" : ", but other classes, which tell no more")}};
  }
}

}  // namespace tetropolis

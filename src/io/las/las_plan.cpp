#include "las_plan.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "core/parallel.h"
#include "las_decode.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

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

LasPlan plan_file(const fs::path& path, const ReadPointsOptions& options, LasSystems& systems) {
  LasPlan plan;
  plan.layout = read_las_layout(path, systems, options.crs.empty());
  plan.warnings = plan.layout.info.warnings;
  check_las_length(path, plan.layout);
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
                           path.string() + ": points lie outside the header's box; the whole "
                                           "file is read"});
  return plan;
}

}  // namespace

bool is_sound(const LasInfo& info) {
  const auto finite = [](double v) { return std::isfinite(v); };
  return std::all_of(info.min.begin(), info.min.end(), finite) &&
         std::all_of(info.max.begin(), info.max.end(), finite) && info.min[0] <= info.max[0] &&
         info.min[1] <= info.max[1];
}

Bounds2 header_box(const LasInfo& info) {
  const double margin_x = 2 * info.scale[0];
  const double margin_y = 2 * info.scale[1];
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

}  // namespace tetropolis

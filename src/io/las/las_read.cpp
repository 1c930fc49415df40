#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/io/crs/crs.h"

#include "core/parallel.h"
#include "core/shared_progress.h"
#include "io/file/input_file.h"
#include "io/las/quirks/las_twins.h"
#include "las_decode.h"
#include "las_filter.h"
#include "las_plan.h"
#include "point_collector.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

constexpr std::int64_t kPointsPerTask = 250'000;
/// Where chunks differ in size, a task begins by passing over the points of a chunk before its own.
constexpr std::int64_t kPointsPerVariableTask = 1'000'000;

/// What is told of points.
struct PointTally {
  Bounds2 extent = Bounds2::nothing();
  std::array<std::int64_t, 256> by_class{};

  void add(const Bounds2& box, std::span<const std::uint8_t> codes) {
    extent.extend(box);
    for (const std::uint8_t code : codes) ++by_class[code];
  }
  void add(const PointTally& more) {
    extent.extend(more.extent);
    for (std::size_t code = 0; code < by_class.size(); ++code)
      by_class[code] += more.by_class[code];
  }
  std::size_t count() const {
    return static_cast<std::size_t>(
        std::accumulate(by_class.begin(), by_class.end(), std::int64_t{0}));
  }
  std::map<int, std::int64_t> classes() const {
    std::map<int, std::int64_t> counts;
    for (std::size_t code = 0; code < by_class.size(); ++code)
      if (by_class[code] > 0) counts[static_cast<int>(code)] = by_class[code];
    return counts;
  }
};

/// From the numbers of a file's records to coordinates in the local frame.
class Frame {
 public:
  Frame(const LasInfo& info, Point2 origin)
      : x_{info.scale[0], info.offset[0] - origin.x},
        y_{info.scale[1], info.offset[1] - origin.y},
        z_{info.scale[2], info.offset[2]} {}

  void add(const LasBlock& block, PointCloud& points) const {
    x_.add(block.x, block.x_range, points.x);
    y_.add(block.y, block.y_range, points.y);
    z_.add(block.z, block.z_range, points.z);
    points.classification.insert(points.classification.end(), block.classification.begin(),
                                 block.classification.end());
  }

  /// Of the points as add() stores them; as they are if there is no room for them. Precondition:
  /// there are some.
  Bounds2 box(const LasBlock& block) const {
    Bounds2 box = Bounds2::nothing();
    box.extend(Point2{x_.stored(block.x_range.first), y_.stored(block.y_range.first)});
    box.extend(Point2{x_.stored(block.x_range.last), y_.stored(block.y_range.last)});
    return box;
  }

 private:
  class Axis {
   public:
    Axis(double scale, double offset)
        : scale_(scale * PointCoordinate::kPerMetre),
          offset_(offset * PointCoordinate::kPerMetre) {}

    void add(std::span<const std::int32_t> numbers, const NumberRange& range,
             Buffer<PointCoordinate>& values) const {
      const std::size_t size = values.size();
      values.resize(size + numbers.size());
      PointCoordinate* next = values.data() + size;
      if (fits(range.first) && fits(range.last))
        for (const std::int32_t number : numbers)
          *next++ = PointCoordinate::of_tenth_millimetres(at(number));
      else
        for (const std::int32_t number : numbers) *next++ = stored(number);
    }

    double stored(std::int32_t number) const {
      const double tenths = at(number);
      return fits(number) ? static_cast<double>(PointCoordinate::of_tenth_millimetres(tenths))
                          : tenths / PointCoordinate::kPerMetre;
    }

   private:
    double at(std::int32_t number) const { return number * scale_ + offset_; }
    bool fits(std::int32_t number) const {
      return std::abs(at(number)) <= PointCoordinate::kMost * PointCoordinate::kPerMetre;
    }

    double scale_;
    double offset_;
  };

  Axis x_;
  Axis y_;
  Axis z_;
};

struct Task {
  std::size_t file = 0;
  std::int64_t first = 0;
  std::int64_t count = 0;
};

std::vector<Task> make_tasks(const std::vector<LasPlan>& plans) {
  std::vector<Task> tasks;
  for (std::size_t f = 0; f < plans.size(); ++f) {
    if (plans[f].skip || plans[f].is_twin) continue;
    const LasLayout& layout = plans[f].layout;
    const std::int64_t total = layout.info.point_count;
    std::int64_t step = kPointsPerTask;
    if (layout.variable_chunks) {
      step = kPointsPerVariableTask;
    } else if (layout.info.compressed) {
      const std::int64_t chunk = layout.chunk_size;
      step = chunk == 0 ? total : (std::max<std::int64_t>(kPointsPerTask / chunk, 1)) * chunk;
    }
    for (std::int64_t first = 0; first < total; first += step)
      tasks.push_back({f, first, std::min(step, total - first)});
  }
  return tasks;
}

/// Adds a warning for each file. Returns that of the first of whose points most are outside,
/// whether or not its box was trusted before.
std::string warn_of_points_outside(std::span<const fs::path> paths,
                                   const std::vector<LasPlan>& plans,
                                   const std::vector<Task>& tasks,
                                   const std::vector<std::int64_t>& outside,
                                   std::vector<Warning>& warnings) {
  std::vector<std::int64_t> counts(plans.size(), 0);
  for (std::size_t t = 0; t < tasks.size(); ++t) counts[tasks[t].file] += outside[t];
  std::string misread;
  for (std::size_t f = 0; f < plans.size(); ++f) {
    if (counts[f] == 0) continue;
    const std::int64_t points = plans[f].layout.info.point_count;
    const std::string message = fmt::format(
        "{}: {} of {} points lie outside the header's box; the header is wrong or the file damaged",
        paths[f].string(), counts[f], points);
    if (plans[f].check_box) warnings.push_back({"las_points_outside_box", counts[f], message});
    if (misread.empty() && counts[f] > points / 2) misread = message;
  }
  return misread;
}

/// Decodes the points of all tasks; visit(task, block) gets those of one task in their order,
/// different tasks at the same time, and end(task) comes after them. Adds warnings of points
/// outside of their header's box, and returns PointsInput::misread.
template <typename Visit, typename End>
std::string decode_tasks(std::span<const fs::path> paths, const std::vector<LasPlan>& plans,
                         const std::vector<Task>& tasks, const Progress& progress,
                         std::vector<Warning>& warnings, const Visit& visit, const End& end) {
  std::int64_t total = 0;
  for (const Task& task : tasks) total += task.count;
  SharedProgress shared(progress, total);
  std::vector<std::int64_t> outside(tasks.size(), 0);
  parallel_in_order(tasks.size(), [&](std::size_t t) {
    const Task& task = tasks[t];
    const LasLayout& layout = plans[task.file].layout;
    const BoxCheck box(layout.info);
    std::int64_t strays = 0;
    decode_points(paths[task.file], layout, task.first, task.count, [&](const LasBlock& block) {
      visit(t, block);
      strays += box.count_outside(block);
      shared.add(static_cast<std::int64_t>(block.size()));
    });
    end(t);
    outside[t] = strays;
  });
  return warn_of_points_outside(paths, plans, tasks, outside, warnings);
}

/// About how many points of the files will be kept; too many or too few does no harm.
std::size_t expected_points(const std::vector<LasPlan>& plans, const std::vector<Task>& tasks,
                            const std::optional<Bounds2>& crop) {
  double expected = 0;
  for (const Task& task : tasks) {
    const LasLayout& layout = plans[task.file].layout;
    const Bounds2 box = header_box(layout.info);
    double share = 1;
    if (crop && plans[task.file].check_box) {
      const double width = std::min(box.xmax, crop->xmax) - std::max(box.xmin, crop->xmin);
      const double height = std::min(box.ymax, crop->ymax) - std::max(box.ymin, crop->ymin);
      const double part = 1.5 * width * height / (box.width() * box.height());
      if (std::isfinite(part)) share = std::clamp(part, 0.0, 1.0);
    }
    // A count may lie: few points take up less than a byte.
    const double believable = std::min(static_cast<double>(task.count),
                                       static_cast<double>(layout.file_size - layout.first_point));
    expected += share * believable;
  }
  return static_cast<std::size_t>(expected);
}

/// Where local numbers stay small: at the crop, or else at the first point, as headers may lie.
Point2 origin_of(const ReadPointsOptions& options, std::span<const fs::path> paths,
                 const std::vector<LasPlan>& plans) {
  if (options.origin) return *options.origin;
  if (options.crop) return {std::floor(options.crop->xmin), std::floor(options.crop->ymin)};
  Point2 origin{0, 0};
  for (std::size_t f = 0; f < plans.size(); ++f) {
    const LasInfo& info = plans[f].layout.info;
    if (info.point_count == 0) continue;
    decode_points(paths[f], plans[f].layout, 0, 1, [&](const LasBlock& block) {
      const Point2 first = position(info, block.x[0], block.y[0]);
      origin = {std::floor(first.x), std::floor(first.y)};
    });
    break;
  }
  return origin;
}

/// Throws if there was no room for points of this extent in the local frame.
void require_room(const Bounds2& extent, Point2 origin, const fs::path& path,
                  const std::string& misread) {
  const double farthest = std::max({-extent.xmin, -extent.ymin, extent.xmax, extent.ymax});
  if (farthest > PointCoordinate::kMost)
    fail_input(path,
               fmt::format("points lie {:.0f} km from ({:.0f}, {:.0f}), but only {:.0f} km can be "
                           "stored; set smaller bounds{}{}",
                           farthest / 1000, origin.x, origin.y, PointCoordinate::kMost / 1000,
                           misread.empty() ? "" : "; ", misread));
}

/// As asked for, or as the files state it. Error, kInput with two files: they differ. Adds a
/// warning where files state vertical systems of different names: nothing converts heights, and
/// names may differ for one system.
std::string crs_of(const ReadPointsOptions& options, std::span<const fs::path> paths,
                   const std::vector<LasPlan>& plans, std::vector<Warning>& warnings) {
  if (!options.crs.empty()) return normalise_crs(options.crs);
  const auto info_of = [&](std::size_t f) -> const LasInfo& { return plans[f].layout.info; };
  std::optional<std::size_t> stated, vertical, other;  // the first files with these
  std::int64_t others = 0;
  for (std::size_t f = 0; f < plans.size(); ++f) {
    const LasInfo& info = info_of(f);
    if (!info.crs.empty() && !stated) stated = f;
    if (!info.crs.empty() && !same_horizontal_crs(info_of(*stated).crs, info.crs))
      fail_input(
          paths[*stated],
          fmt::format("is in {}, but {} in {}; convert one, or name the CRS of all with "
                      "points_crs",
                      crs_name(info_of(*stated).crs), paths[f].string(), crs_name(info.crs)));
    if (plans[f].skip || plans[f].is_twin || info.vertical_crs.empty()) continue;
    if (!vertical) vertical = f;
    if (info.vertical_crs == info_of(*vertical).vertical_crs) continue;
    if (!other) other = f;
    ++others;
  }
  if (other)
    warnings.push_back(
        {"las_heights_mixed", others,
         fmt::format("{}: has heights in {}, but {} in {}; heights are not converted, convert the "
                     "files if these differ",
                     paths[*vertical].string(), info_of(*vertical).vertical_crs,
                     paths[*other].string(), info_of(*other).vertical_crs)});
  return stated ? info_of(*stated).crs : "";
}

/// What is told of all points and of those of each file, from those `kept` and those there are
/// (`all`) of each task.
void tell_files(std::span<const fs::path> paths, const std::vector<Task>& tasks,
                const std::vector<PointTally>& kept, const std::vector<PointTally>& all,
                PointsInput& result) {
  PointTally tally;
  result.files.resize(paths.size());
  for (std::size_t f = 0; f < paths.size(); ++f) result.files[f].path = paths[f].string();
  std::size_t end = 0;
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    FilePoints& file = result.files[tasks[t].file];
    if (file.kept.begin == file.kept.end) file.kept = {end, end};
    end += kept[t].count();
    file.kept.end = end;
    for (const auto& [code, count] : all[t].classes()) file.by_class[code] += count;
    require_room(kept[t].extent, result.origin, paths[tasks[t].file], result.misread);
    tally.add(kept[t]);
  }
  result.extent = tally.extent;
  result.points_by_class = tally.classes();
}

}  // namespace

std::vector<std::uint8_t> noise_classes() {
  std::vector<std::uint8_t> classes;
  for (const PointClass code : {kLowNoise, kHighNoise}) classes.push_back(code);
  return classes;
}

PointsInput read_points(std::span<const fs::path> paths, const ReadPointsOptions& options,
                        const Progress& progress) {
  std::vector<LasPlan> plans = plan_files(paths, options);
  find_twins(paths, plans);
  PointsInput result;
  if (!paths.empty()) result.source = paths.front().string();
  if (paths.size() > 1) result.source += fmt::format(", and {} more", paths.size() - 1);
  result.crs = crs_of(options, paths, plans, result.warnings);
  const std::vector<Task> tasks = make_tasks(plans);
  for (const Task& task : tasks) result.points_read += task.count;
  for (const LasPlan& plan : plans) {
    result.files_skipped += plan.skip ? 1 : 0;
    result.warnings.insert(result.warnings.end(), plan.warnings.begin(), plan.warnings.end());
  }
  std::vector<LasFilter> filters;
  for (const LasPlan& plan : plans) filters.emplace_back(options, plan.layout.info);
  result.origin = origin_of(options, paths, plans);
  std::vector<Frame> frames;
  for (const LasPlan& plan : plans) frames.emplace_back(plan.layout.info, result.origin);
  PointCollector collector(tasks.size(), expected_points(plans, tasks, options.crop));
  std::vector<PointCloud> kept(tasks.size());
  std::vector<PointTally> tallies(tasks.size());
  std::vector<PointTally> all_tallies(tasks.size());
  const auto keep = [&](std::size_t t, const LasBlock& all) {
    const std::size_t file = tasks[t].file;
    PointCloud& points = kept[t];
    all_tallies[t].add(Bounds2::nothing(), all.classification);
    if (points.x.capacity() == 0)
      // Reserved memory takes up none before it is written; a count may lie.
      points = collector.empty_points(
          static_cast<std::size_t>(std::min(tasks[t].count, 2 * kPointsPerTask)));
    LasBlockBuffer some;
    const LasBlock block = filters[file].keep(all, some);
    if (block.size() == 0) return;
    tallies[t].add(frames[file].box(block), block.classification);
    frames[file].add(block, points);
    // A file that is not chunked is one task, however many points it has.
    if (points.size() >= 2 * kPointsPerTask) collector.take_some(t, points);
  };
  const auto collect = [&](std::size_t t) { collector.take(t, std::move(kept[t])); };
  result.misread = decode_tasks(paths, plans, tasks, progress, result.warnings, keep, collect);
  result.points = collector.take_points();
  result.points_kept = static_cast<std::int64_t>(result.points.size());
  tell_files(paths, tasks, tallies, all_tallies, result);
  return result;
}

PointsSummary summarise_points(const fs::path& path, const Progress& progress) {
  const std::span<const fs::path> paths(&path, 1);
  const std::vector<LasPlan> plans = plan_files(paths, {});
  const std::vector<Task> tasks = make_tasks(plans);
  PointsSummary result;
  result.warnings = plans[0].warnings;
  std::vector<PointTally> tallies(tasks.size());
  const LasInfo& info = plans[0].layout.info;
  const auto add = [&](std::size_t t, const LasBlock& block) {
    Bounds2 box = Bounds2::nothing();
    box.extend(position(info, block.x_range.first, block.y_range.first));
    box.extend(position(info, block.x_range.last, block.y_range.last));
    tallies[t].add(box, block.classification);
  };
  decode_tasks(paths, plans, tasks, progress, result.warnings, add, [](std::size_t) {});
  PointTally tally;
  for (const PointTally& part : tallies) tally.add(part);
  result.points_by_class = tally.classes();
  for (const auto& [code, count] : result.points_by_class) result.points += count;
  result.extent = tally.extent;
  return result;
}

}  // namespace tetropolis

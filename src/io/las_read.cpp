#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/core/parallel.h"
#include "tetropolis/io/crs.h"

#include "input_file.h"
#include "las_agreement.h"
#include "las_decode.h"
#include "las_twins.h"
#include "point_collector.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

constexpr std::int64_t kPointsPerTask = 250'000;
/// Where chunks differ in size, a task begins by passing over the points of a chunk before its own.
constexpr std::int64_t kPointsPerVariableTask = 1'000'000;
constexpr std::int64_t kLeastTwin = 100;  // points of which two equal boxes are no coincidence
/// Bytes behind the last point counted that are points, where an empty chunk may follow.
constexpr std::int64_t kLeastLeftOver = 64;

constexpr NumberRange kAllNumbers{std::numeric_limits<std::int32_t>::min(),
                                  std::numeric_limits<std::int32_t>::max()};

/// The numbers whose coordinates, number * scale + offset as it is rounded, lie in [low, high].
/// These do not decrease with the number (or, with a negative scale, increase), so that the ends
/// are found by bisection.
NumberRange numbers_within(double scale, double offset, double low, double high) {
  const auto least_where = [](const auto& holds) {
    std::int64_t below = kAllNumbers.first - std::int64_t{1};
    std::int64_t above = kAllNumbers.last + std::int64_t{1};
    while (above - below > 1) {
      const std::int64_t middle = below + (above - below) / 2;
      (holds(static_cast<double>(middle)) ? above : below) = middle;
    }
    return above;
  };
  const auto between = [](std::int64_t first, std::int64_t behind) {
    return first < behind ? NumberRange{static_cast<std::int32_t>(first),
                                        static_cast<std::int32_t>(behind - 1)}
                          : NumberRange{};
  };
  if (scale > 0)
    return between(least_where([&](double number) { return number * scale + offset >= low; }),
                   least_where([&](double number) { return number * scale + offset > high; }));
  return between(least_where([&](double number) { return number * scale + offset <= high; }),
                 least_where([&](double number) { return number * scale + offset < low; }));
}

/// Which records of a file become points.
class Filter {
 public:
  Filter(const ReadPointsOptions& options, const LasInfo& info)
      : keep_withheld_(options.keep_withheld), skipped_(class_table(options.skipped_classes)) {
    if (!options.crop) return;
    const Bounds2& crop = *options.crop;
    x_ = numbers_within(info.scale[0], info.offset[0], crop.xmin, crop.xmax);
    y_ = numbers_within(info.scale[1], info.offset[1], crop.ymin, crop.ymax);
  }

  /// The records to keep, in order: the block as it is, or some of it in `kept`.
  LasBlock keep(const LasBlock& block, LasBlockBuffer& kept) const {
    if (keeps_all(block)) return block;
    std::size_t n = 0;
    for (std::size_t i = 0; i < block.size(); ++i) {
      if (skips(block, i) || !x_.contains(block.x[i]) || !y_.contains(block.y[i])) continue;
      kept.x[n] = block.x[i];
      kept.y[n] = block.y[i];
      kept.z[n] = block.z[i];
      kept.classification[n] = block.classification[i];
      kept.withheld[n++] = block.withheld[i];
    }
    return kept.first(n);
  }

 private:
  bool skips(const LasBlock& block, std::size_t i) const {
    return skipped_[block.classification[i]] || (block.withheld[i] != 0 && !keep_withheld_);
  }
  bool keeps_all(const LasBlock& block) const {
    if (!x_.covers(block.x_range) || !y_.covers(block.y_range)) return false;
    unsigned skipped = 0;  // no branch in the loop
    for (const std::uint8_t code : block.classification) skipped |= skipped_[code] ? 1U : 0U;
    if (!keep_withheld_)
      for (const std::uint8_t withheld : block.withheld) skipped |= withheld;
    return skipped == 0;
  }

  NumberRange x_ = kAllNumbers;
  NumberRange y_ = kAllNumbers;
  bool keep_withheld_;
  ClassTable skipped_;
};

/// Counts the points outside of a header's box. In a file whose bytes have rotted, wrong numbers
/// are all that can be seen: LAS and LAZ have no checksums.
class BoxCheck {
 public:
  explicit BoxCheck(const LasInfo& info) {
    inside_.fill(kAllNumbers);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (std::isnan(info.min[axis] + info.max[axis])) continue;  // it says nothing
      const auto [low, high] = std::minmax(info.min[axis], info.max[axis]);
      // Two steps for what rounding may have cut off.
      const double margin = 2 * std::abs(info.scale[axis]);
      inside_[axis] =
          numbers_within(info.scale[axis], info.offset[axis], low - margin, high + margin);
    }
  }
  std::int64_t count_outside(const LasBlock& block) const {
    if (inside_[0].covers(block.x_range) && inside_[1].covers(block.y_range) &&
        inside_[2].covers(block.z_range))
      return 0;
    std::int64_t outside = 0;
    for (std::size_t i = 0; i < block.size(); ++i)
      if (!inside_[0].contains(block.x[i]) || !inside_[1].contains(block.y[i]) ||
          !inside_[2].contains(block.z[i]))
        ++outside;
    return outside;
  }

 private:
  std::array<NumberRange, 3> inside_;
};

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
        for (const std::int32_t number : numbers) *next++ = PointCoordinate::of_tenths(at(number));
      else
        for (const std::int32_t number : numbers) *next++ = stored(number);
    }

    double stored(std::int32_t number) const {
      const double tenths = at(number);
      return fits(number) ? static_cast<double>(PointCoordinate::of_tenths(tenths))
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

// --- is it safe to pass a file over? ---

/// The header's box, grown by what rounding may have cut off.
Bounds2 header_box(const LasInfo& info) {
  const double margin_x = 2 * std::abs(info.scale[0]);
  const double margin_y = 2 * std::abs(info.scale[1]);
  return {info.min[0] - margin_x, info.min[1] - margin_y, info.max[0] + margin_x,
          info.max[1] + margin_y};
}

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

struct FilePlan {
  LasLayout layout;
  bool skip = false;       ///< Its box misses the crop.
  bool is_twin = false;    ///< The same points as in a file before.
  bool check_box = false;  ///< Points outside of its box are to be counted.
  std::vector<Warning> warnings;
};

/// Whether chunks are sound, and the points that the header counts end where the last one does.
void check_chunks(const fs::path& path, FilePlan& plan) {
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

FilePlan plan_file(const fs::path& path, const ReadPointsOptions& options, LasSystems& systems) {
  FilePlan plan;
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

/// Marks files that state the same count and box as another and have the same points: a cloud that
/// lies there twice, as .las and as .laz, or before and after its points were classified.
void find_twins(std::span<const fs::path> paths, std::vector<FilePlan>& plans) {
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

// --- reading ---

struct Task {
  std::size_t file = 0;
  std::int64_t first = 0;
  std::int64_t count = 0;
};

std::vector<Task> make_tasks(const std::vector<FilePlan>& plans) {
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
                                   const std::vector<FilePlan>& plans,
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
        "{}: {} of {} points lie outside the box that its header states; the header is wrong or "
        "the file damaged",
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
std::string decode_tasks(std::span<const fs::path> paths, const std::vector<FilePlan>& plans,
                         const std::vector<Task>& tasks, const Progress& progress,
                         std::vector<Warning>& warnings, const Visit& visit, const End& end) {
  std::int64_t total = 0;
  for (const Task& task : tasks) total += task.count;
  SharedProgress shared(progress, total);
  std::vector<std::int64_t> outside(tasks.size(), 0), left_over(tasks.size(), 0);
  parallel_in_order(tasks.size(), [&](std::size_t t) {
    const Task& task = tasks[t];
    const LasLayout& layout = plans[task.file].layout;
    const BoxCheck box(layout.info);
    std::int64_t strays = 0;
    left_over[t] =
        decode_points(paths[task.file], layout, task.first, task.count, [&](const LasBlock& block) {
          visit(t, block);
          strays += box.count_outside(block);
          shared.add(static_cast<std::int64_t>(block.size()));
        });
    end(t);
    outside[t] = strays;
  });
  std::string misread = warn_of_points_outside(paths, plans, tasks, outside, warnings);
  for (std::size_t t = 0; t < tasks.size(); ++t)
    if (left_over[t] >= (plans[tasks[t].file].layout.chunk_size > 0 ? 1 : kLeastLeftOver))
      warnings.push_back({"las_count_small", 1,
                          fmt::format("{}: the header counts {} points, but {} bytes of compressed "
                                      "points are left behind them; these are not read",
                                      paths[tasks[t].file].string(),
                                      plans[tasks[t].file].layout.info.point_count, left_over[t])});
  return misread;
}

/// About how many points of the files will be kept; too many or too few does no harm.
std::size_t expected_points(const std::vector<FilePlan>& plans, const std::vector<Task>& tasks,
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
                 const std::vector<FilePlan>& plans) {
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
    fail_input(path, fmt::format("points lie {:.0f} km from ({:.0f}, {:.0f}), and no more than "
                                 "{:.0f} km can be stored; give smaller bounds{}{}",
                                 farthest / 1000, origin.x, origin.y, PointCoordinate::kMost / 1000,
                                 misread.empty() ? "" : "; ", misread));
}

}  // namespace

std::vector<std::uint8_t> noise_classes() {
  std::vector<std::uint8_t> classes;
  for (const PointClass code : {kLowNoise, kHighNoise}) classes.push_back(code);
  return classes;
}

PointsInput read_points(std::span<const fs::path> paths, const ReadPointsOptions& options,
                        const Progress& progress) {
  std::vector<FilePlan> plans(paths.size());
  LasSystems systems;
  parallel_in_order(paths.size(),
                    [&](std::size_t f) { plans[f] = plan_file(paths[f], options, systems); });
  find_twins(paths, plans);
  PointsInput result;
  std::vector<LasSystemOfFile> systems_stated;
  std::vector<LasSystemOfFile> systems_read;
  for (std::size_t f = 0; f < plans.size(); ++f) {
    systems_stated.push_back({&paths[f], &plans[f].layout.info});
    if (!plans[f].skip && !plans[f].is_twin) systems_read.push_back(systems_stated.back());
  }
  if (options.crs.empty()) {
    result.crs = common_crs(systems_stated);
    if (std::optional<Warning> mixed = mixed_heights(systems_read))
      result.warnings.push_back(std::move(*mixed));
  } else {
    result.crs = normalise_crs(options.crs);
  }
  const std::vector<Task> tasks = make_tasks(plans);
  for (const Task& task : tasks) result.points_read += task.count;
  for (const FilePlan& plan : plans) {
    result.files_skipped += plan.skip ? 1 : 0;
    result.warnings.insert(result.warnings.end(), plan.warnings.begin(), plan.warnings.end());
  }
  std::vector<Filter> filters;
  for (const FilePlan& plan : plans) filters.emplace_back(options, plan.layout.info);
  result.origin = origin_of(options, paths, plans);
  std::vector<Frame> frames;
  for (const FilePlan& plan : plans) frames.emplace_back(plan.layout.info, result.origin);
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
    // A file without a table of chunks is one task, however many points it has.
    if (points.size() >= 2 * kPointsPerTask) collector.take_some(t, points);
  };
  const auto collect = [&](std::size_t t) { collector.take(t, std::move(kept[t])); };
  result.misread = decode_tasks(paths, plans, tasks, progress, result.warnings, keep, collect);
  result.points = collector.take_points();
  result.points_kept = static_cast<std::int64_t>(result.points.size());
  PointTally tally;
  result.files.resize(paths.size());
  std::size_t end = 0;
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    FilePoints& file = result.files[tasks[t].file];
    if (file.kept.begin == file.kept.end) file.kept = {end, end};
    end += tallies[t].count();
    file.kept.end = end;
    for (const auto& [code, count] : all_tallies[t].classes()) file.by_class[code] += count;
    require_room(tallies[t].extent, result.origin, paths[tasks[t].file], result.misread);
    tally.add(tallies[t]);
  }
  result.extent = tally.extent;
  result.points_by_class = tally.classes();
  return result;
}

PointsSummary summarise_points(const fs::path& path, const Progress& progress) {
  const std::span<const fs::path> paths(&path, 1);
  LasSystems systems;
  const std::vector<FilePlan> plans{plan_file(path, {}, systems)};
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

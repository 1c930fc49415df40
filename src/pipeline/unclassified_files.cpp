#include "unclassified_files.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "tetropolis/geometry/point_cloud.h"
#include "tetropolis/terrain/ground_filter.h"

namespace tetropolis {

namespace {

constexpr double kSide = 20;  // metres
constexpr double kMostWithGround = 0.5;
constexpr std::size_t kPointBatch = std::size_t{1} << 20;

/// The share of a file's points up to which those of buildings are strays.
constexpr double kStrayBuildings = 1e-4;

/// Marks on the squares that the points lie in.
class SquareMarks {
 public:
  enum Mark : std::uint8_t { kHasGround = 1, kSeen = 2 };

  explicit SquareMarks(const Bounds2& extent)
      : corner_{extent.xmin, extent.ymin},
        columns_(1 + static_cast<std::size_t>(extent.width() / kSide)),
        rows_(1 + static_cast<std::size_t>(extent.height() / kSide)),
        marks_(columns_ * rows_, 0) {}

  std::uint8_t& at(const PointCloud& cloud, std::size_t p) {
    return marks_[slot(cloud.y[p] - corner_.y, rows_) * columns_ +
                  slot(cloud.x[p] - corner_.x, columns_)];
  }

  /// Marks also what is up to `reach` squares west, east, south and north of a mark.
  void grow(std::size_t reach) {
    for (std::size_t row = 0; row < rows_; ++row) grow_line(row * columns_, 1, columns_, reach);
    for (std::size_t column = 0; column < columns_; ++column)
      grow_line(column, columns_, rows_, reach);
  }

 private:
  static std::size_t slot(double offset, std::size_t count) {
    return std::min(static_cast<std::size_t>(std::max(offset, 0.0) / kSide), count - 1);
  }

  void grow_line(std::size_t first, std::size_t step, std::size_t count, std::size_t reach) {
    std::vector<std::uint8_t> line(count);
    for (std::size_t k = 0; k < count; ++k) line[k] = marks_[first + k * step];
    std::size_t end = 0;  // what is before it is done
    for (std::size_t k = 0; k < count; ++k) {
      if (line[k] == 0) continue;
      for (std::size_t j = std::max(end, k - std::min(k, reach));
           j < std::min(count, k + reach + 1); ++j)
        marks_[first + j * step] = kSeen;
      end = std::min(count, k + reach + 1);
    }
  }

  Point2 corner_;
  std::size_t columns_;
  std::size_t rows_;
  std::vector<std::uint8_t> marks_;
};

/// visit(p) for all points of a range, heeding `progress`.
template <typename Visit>
void for_each_point(const PointRange& range, const Progress& progress, double fraction,
                    const Visit& visit) {
  for (std::size_t begin = range.begin; begin < range.end; begin += kPointBatch) {
    progress.update(fraction);
    const std::size_t end = std::min(range.end, begin + kPointBatch);
    for (std::size_t p = begin; p < end; ++p) visit(p);
  }
}

/// The share of the squares with points of the file that have ground.
double share_with_ground(const FilePoints& file, const PointCloud& cloud, SquareMarks& squares,
                         const Progress& progress) {
  std::int64_t seen = 0, with_ground = 0;
  for_each_point(file.kept, progress, 0.5, [&](std::size_t p) {
    std::uint8_t& mark = squares.at(cloud, p);
    seen += (mark & SquareMarks::kSeen) == 0 ? 1 : 0;
    with_ground += mark == SquareMarks::kHasGround ? 1 : 0;
    mark |= SquareMarks::kSeen;
  });
  for_each_point(file.kept, progress, 0.5, [&](std::size_t p) {
    squares.at(cloud, p) &= static_cast<std::uint8_t>(~SquareMarks::kSeen);
  });
  return static_cast<double>(with_ground) / static_cast<double>(seen);
}

/// Whether there are points that are roofs where no class says what is one.
bool has_roofs_by_exclusion(const std::map<int, std::int64_t>& by_class) {
  return std::any_of(by_class.begin(), by_class.end(), [](const auto& of_class) {
    return may_be_roof(static_cast<std::uint8_t>(of_class.first));
  });
}

}  // namespace

bool has_class(const std::map<int, std::int64_t>& by_class, int code, double stray) {
  std::int64_t all = 0;
  for (const auto& [other, count] : by_class) all += count;
  const auto found = by_class.find(code);
  return found != by_class.end() &&
         static_cast<double>(found->second) >= stray * static_cast<double>(all);
}

bool has_unclassified(const std::map<int, std::int64_t>& by_class) {
  const std::vector<std::uint8_t> codes = GroundFilterOptions{}.classes;
  return std::any_of(codes.begin(), codes.end(),
                     [&](std::uint8_t code) { return by_class.contains(code); });
}

std::vector<FilePoints> find_files_without_ground(const CityInput& input,
                                                  const Progress& progress) {
  std::vector<FilePoints> found;
  bool some_have = false;
  for (const FilePoints& file : input.points.files) {
    const bool ground = has_class(file.by_class, kGround, kStrayGround);
    some_have = some_have || ground;
    if (!ground && file.kept.begin != file.kept.end && has_unclassified(file.by_class))
      found.push_back(file);
  }
  if (found.empty() || !some_have) return {};
  const PointCloud& cloud = input.points.points;
  SquareMarks squares(input.points.extent);
  for_each_point({0, cloud.size()}, progress, 0, [&](std::size_t p) {
    if (is_ground(cloud.classification[p])) squares.at(cloud, p) = SquareMarks::kHasGround;
  });
  std::erase_if(found, [&](const FilePoints& file) {
    return share_with_ground(file, cloud, squares, progress) > kMostWithGround;
  });
  return found;
}

std::vector<PointRange> find_ranges_without_buildings(const CityInput& input,
                                                      std::span<const FilePoints> without_ground) {
  std::vector<PointRange> ranges;
  for (const FilePoints& file : input.points.files) {
    const PointRange& kept = file.kept;
    if (kept.begin == kept.end || has_class(file.by_class, kBuildingClass, kStrayBuildings))
      continue;
    const bool chosen =
        std::any_of(without_ground.begin(), without_ground.end(),
                    [&](const FilePoints& other) { return other.path == file.path; });
    if (chosen ||
        (has_class(file.by_class, kGround, kStrayGround) && has_roofs_by_exclusion(file.by_class)))
      ranges.push_back(kept);
  }
  return ranges;
}

std::vector<std::size_t> find_points_near(const CityInput& input, std::span<const FilePoints> files,
                                          double reach, const Progress& progress) {
  const PointCloud& cloud = input.points.points;
  SquareMarks squares(input.points.extent);
  for (const FilePoints& file : files)
    for_each_point(file.kept, progress, 0,
                   [&](std::size_t p) { squares.at(cloud, p) = SquareMarks::kSeen; });
  squares.grow(static_cast<std::size_t>(std::ceil(reach / kSide)));
  std::vector<std::size_t> near;
  for_each_point({0, cloud.size()}, progress, 0.5, [&](std::size_t p) {
    if (squares.at(cloud, p) != 0) near.push_back(p);
  });
  return near;
}

}  // namespace tetropolis

// Bytes as a LAS or LAZ file: header, variable length records, points.
#include <cmath>
#include <cstdint>
#include <vector>

#include "tetropolis/core/threads.h"
#include "tetropolis/io/las/las.h"

#include "fuzz_input.h"

namespace {

using namespace tetropolis;
using namespace tetropolis::fuzz;

/// What the header says must not contradict itself.
void claim_info(const LasInfo& info) {
  claim(info.version_major == 1 && info.version_minor >= 0 && info.version_minor <= 5, "version");
  claim(info.point_format >= 0 && info.point_format <= 10, "point format");
  claim(info.record_length >= 20, "record length");
  claim(info.point_count >= 0, "point count");
  for (std::size_t axis = 0; axis < 3; ++axis)
    claim(std::isfinite(info.scale[axis]) && info.scale[axis] != 0 &&
              std::isfinite(info.offset[axis]),
          "scale and offset");
}

void claim_points(const PointsInput& input, const LasInfo& info) {
  const PointCloud& points = input.points;
  claim(input.points_read == info.point_count, "every point is read");
  claim(input.points_kept == static_cast<std::int64_t>(points.x.size()), "points are counted");
  claim(points.y.size() == points.x.size() && points.z.size() == points.x.size() &&
            points.classification.size() == points.x.size(),
        "arrays have one length");
  std::int64_t by_class = 0;
  for (const auto& [code, count] : input.points_by_class) {
    claim(code >= 0 && code < 256 && count > 0, "classes");
    by_class += count;
  }
  claim(by_class == input.points_kept, "every point has a class");
  for (std::size_t i = 0; i < points.x.size(); ++i)
    claim(input.extent.contains({points.x[i], points.y[i]}), "points lie within the extent");
}

/// What was read survives a file of our own, but for rounding.
void claim_round_trip(const PointCloud& points) {
  if (points.x.empty()) return;
  for (std::size_t i = 0; i < points.x.size(); ++i)
    if (std::abs(points.x[i]) > 1e5 || std::abs(points.y[i]) > 1e5 || std::abs(points.z[i]) > 1e5)
      return;
  WritePointsOptions options;
  options.point_format = 6;
  const std::vector<std::filesystem::path> copy{scratch_folder() / "copy.laz"};
  write_points(copy[0], points, {}, options);
  ReadPointsOptions all;
  all.skipped_classes.clear();
  all.origin = Point2{0, 0};
  const PointCloud again = read_points(copy, all).points;
  claim(again.classification == points.classification, "classes come back");
  for (std::size_t i = 0; i < points.x.size(); ++i)
    claim(std::abs(again.x[i] - points.x[i]) < 0.00051 &&
              std::abs(again.y[i] - points.y[i]) < 0.00051 &&
              std::abs(again.z[i] - points.z[i]) < 0.00051,
          "coordinates come back");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const ThreadLimit one_thread(1);
  const std::vector<std::filesystem::path> paths{write_scratch("input.laz", data, size)};
  try {
    const LasInfo info = inspect_las(paths[0]);
    claim_info(info);
    // Unpacking is LASzip's. On broken chunks it recurses until the stack ends (GPSTIME11_v2),
    // reserves what they claim (POINT14_v3) and forgets memory (POINT14_v4): found here, to be
    // mended there.
    if (info.compressed) return 0;
    ReadPointsOptions all;
    all.skipped_classes.clear();
    all.keep_withheld = true;
    const PointsInput input = read_points(paths, all);
    claim_points(input, info);
    claim_round_trip(input.points);
    if (input.points.x.empty()) return 0;
    // A crop keeps what lies in it, whether or not the file could be passed over. On its rim
    // points may have been rounded across.
    ReadPointsOptions cropped = all;
    const auto box = [&](double m) {
      return Bounds2{input.origin.x - m, input.origin.y - m, input.origin.x + 500 + m,
                     input.origin.y + 500 + m};
    };
    cropped.crop = box(0);
    cropped.origin = input.origin;
    std::int64_t least = 0, most = 0;
    for (std::size_t i = 0; i < input.points.x.size(); ++i) {
      const Point2 p{input.points.x[i] + input.origin.x, input.points.y[i] + input.origin.y};
      least += box(-0.001).contains(p) ? 1 : 0;
      most += box(0.001).contains(p) ? 1 : 0;
    }
    const PointsInput part = read_points(paths, cropped);
    claim((least <= part.points_kept && part.points_kept <= most) || part.files_skipped == 1,
          "a crop keeps what lies in it");
  } catch (const Error& error) {
    claim_error(error, ErrorKind::kInput, paths[0].string());
  }
  return 0;
}

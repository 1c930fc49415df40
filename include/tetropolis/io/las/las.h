// Point clouds in LAS and LAZ files (paper step 1.1). LAS 1.0 to 1.5, point formats 0 to 10, LAZ by
// any LASzip so far; COPC files are read as the LAZ files they are.
//
// Source of the layout: ASPRS, LAS Specification 1.4 R15, 2019.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tetropolis/core/progress.h"
#include "tetropolis/core/warning.h"
#include "tetropolis/geometry/point_cloud.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// What the header of one file says; not compared with the points.
struct LasInfo {
  int version_major = 0;
  int version_minor = 0;
  int point_format = 0;          ///< 0 to 10, without the compression bits.
  int record_length = 0;         ///< Bytes per uncompressed record, extra bytes included.
  bool compressed = false;       ///< LAZ.
  bool copc = false;             ///< Cloud optimised: has the COPC info record.
  std::int64_t point_count = 0;  ///< Both counts 0 in an uncompressed file that has data: what
                                 ///< fits, with the warning "las_count_missing".
  std::array<double, 3> min{};   ///< x, y, z of the header's box, in CRS coordinates.
  std::array<double, 3> max{};
  std::array<double, 3> scale{};
  std::array<double, 3> offset{};
  std::string crs;  ///< Canonical (crs.h); "" if none is stated or understood.
  double vertical_unit =
      1;  ///< Metres per unit of height, as the file's CRS says; 1 if it does not.
  std::string vertical_crs;  ///< Name of the vertical system; "" if none is stated or understood.
  std::vector<Warning> warnings;  ///< "las_vlrs_broken" (extended ones, too), "las_crs_unknown",
                                  ///< "las_count_missing", "las_count_small" (more room than the
                                  ///< count says).
};

/// Reads the header and the variable length records, not the points.
/// Errors, kInput with the path and byte: missing, unreadable, empty, no LAS file, cut within the
/// header, invalid sizes or offsets, scale not above 0 or beyond 1000, coordinates offset by more
/// than 1e9 or elevations by more than 1e6, unknown version or point format, record shorter than
/// its format, LAZ without a table of chunks, or without a supported LASzip record.
LasInfo inspect_las(const std::filesystem::path& path);

/// The same of several files, in parallel; the first broken file in order is reported.
std::vector<LasInfo> inspect_las(std::span<const std::filesystem::path> paths);

/// The files that `arguments` name: files as they are (whatever their extension), folders as the
/// *.las and *.laz directly inside (any case), and shell patterns (*, ?, [...]).
/// Sorted by absolute path; a file named twice, by whatever spelling or link, occurs once. The
/// order of the arguments does not matter. Folders in folders are not read; `warnings`, if given,
/// gets "points_in_subfolders" where they hold such files. Errors, kInput with the argument: no
/// such file, pattern without a match, folder without any.
std::vector<std::filesystem::path> expand_point_paths(std::span<const std::string> arguments,
                                                      std::vector<Warning>* warnings = nullptr);

/// 7 and 18: low and high noise.
std::vector<std::uint8_t> noise_classes();

struct ReadPointsOptions {
  std::optional<Bounds2> crop = {};   ///< Keep points inside or on it; CRS coordinates. None: all.
  std::optional<Point2> origin = {};  ///< Subtracted from x and y. None: near the points.
  std::vector<std::uint8_t> skipped_classes = noise_classes();
  bool keep_withheld = false;  ///< Keep points with the withheld bit.
  std::string crs = {};        ///< What the files are in, whatever they say; empty: what they say.
};

/// The points of one file.
struct FilePoints {
  std::string path;                      ///< As it was given.
  PointRange kept;                       ///< Where they are in the cloud.
  std::map<int, std::int64_t> by_class;  ///< Counts of all of them, kept or not.
};

struct PointsInput {
  std::string source = "points";  ///< What messages call all of them: "a.laz, and 3 more".
  PointCloud points;              ///< Order: files as given, points as stored.
  std::vector<FilePoints> files;  ///< Of each file; of those not read, none.
  std::int64_t points_read = 0;   ///< Points looked at (files passed over do not count).
  std::int64_t points_kept = 0;   ///< points.size().
  std::map<int, std::int64_t> points_by_class;  ///< Of the points kept.
  Point2 origin;                                ///< Of the local frame.
  Bounds2 extent = Bounds2::nothing();          ///< Of the points kept, local frame; empty if none.
  std::int64_t files_skipped = 0;  ///< Passed over because their header's box misses `crop`.
  std::string crs;                 ///< Of the coordinates; "" if unknown.
  std::vector<Warning> warnings;   ///< Those of LasInfo, and "las_box_untrusted", "las_twin",
                                   ///< "las_points_outside_box", "las_heights_mixed" (vertical
                                   ///< systems of other names than the first file's, unless
                                   ///< options.crs is set).
  /// What there is to say of the first file of whose points most lie outside of the box that its
  /// header states, for errors that it leads to; "" if there is none.
  std::string misread;
};

/// Reads the points of several files. x, y: CRS coordinate (record * scale + offset) minus origin;
/// z as it is, in the file's unit; all to 0.0001 of it (PointCoordinate). Class: 5 bits
/// in formats 0 to 5, 8 bits from format 6 on. Overlap points (class 12, or the overlap bit) are
/// points like others.
///
/// A file whose header box misses `crop` is not decoded, provided that the box is sound and holds
/// the first points and some more of the file; otherwise the file is decoded.
/// Of files with the same count and box, and with the same points in a few places, one is read: the
/// first of those that have the most classes there ("las_twin" of the others). Points outside the
/// box of their header are kept but counted ("las_points_outside_box"): damage inside a file shows
/// only there.
/// Parallel over blocks of a quarter of a million points (of a million in LAZ with chunks of
/// different sizes, such as COPC; a LAZ file without chunks is one block); the result
/// does not depend on the number of threads. Memory follows the points kept, never the counts that
/// headers claim.
///
/// Errors: those of inspect_las; kInput with the path and point number for a file that ends early
/// or cannot be decoded; kInput naming two files that state different reference systems, unless
/// options.crs is given; kInput with the path if points kept lie farther from the origin than a
/// PointCoordinate reaches; kUsage if options.crs is bad. The first broken file in order is
/// reported.
PointsInput read_points(std::span<const std::filesystem::path> paths,
                        const ReadPointsOptions& options = {}, const Progress& progress = {});

/// What is in one file, without keeping its points.
struct PointsSummary {
  std::int64_t points = 0;
  std::map<int, std::int64_t> points_by_class;
  Bounds2 extent = Bounds2::nothing();  ///< Of the points, in the coordinates of the file.
  std::vector<Warning> warnings;        ///< As of read_points.
};

/// Decodes all points of a file, withheld ones too. Parallel, the same for any number of threads;
/// needs no memory for points. Errors: those of read_points for a file.
PointsSummary summarise_points(const std::filesystem::path& path, const Progress& progress = {});

struct WritePointsOptions {
  int point_format = 1;  ///< 1 (LAS 1.2) or 6 (LAS 1.4).
  double scale = 0.001;  ///< Of x, y and z; metres per unit of the stored integers, > 0.
  std::string crs;       ///< Stored if it is an EPSG code (GeoTIFF keys; WKT too in LAS 1.4).
  std::span<const std::uint8_t> flags{};  ///< Per point, of PointFlag; empty: none is set.
};

/// Writes points as single returns, rounded to `scale`. LAZ if the extension is .laz, else LAS.
/// cloud: local frame; `origin` is added to x and y.
/// Guarantees: the header's box and counts are those of the stored points; the same input gives the
/// same bytes; the file appears complete or not at all.
/// Errors: kInput if it cannot be written; kUsage for another point format, a scale too fine for
/// the extent, classes above 31 in format 1, a bad crs, arrays of other sizes than the points'.
void write_points(const std::filesystem::path& path, const PointCloud& cloud, Point2 origin,
                  const WritePointsOptions& options = {});

}  // namespace tetropolis

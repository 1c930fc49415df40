// Elevations of terrain and surface models, from raster tiles of any format, grid and reference
// system.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "tetropolis/core/warning.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/terrain/raster.h"

namespace tetropolis {

/// What the header of a raster says. Its pixels may be oblong and its rows may run north.
struct RasterHeader {
  std::string crs;    ///< Canonical (crs.h); "" if none is stated.
  Bounds2 box;        ///< Of the pixels, not of their centres; CRS coordinates.
  double step_x = 1;  ///< Between centres, units of the system, > 0.
  double step_y = 1;
  std::int32_t nx = 0;
  std::int32_t ny = 0;
  double height_unit = 1;  ///< Metres per unit of the values; negative where they count downwards.
  bool states_height_unit = false;  ///< Whether the file says so, and it is no assumption.
};

/// Errors: those of read_elevations about single files.
RasterHeader inspect_raster(const std::filesystem::path& path);

/// Whether the name ends as those of rasters do, in any case: .tif, .tiff, .vrt, .asc, .img, .hgt,
/// .dem, .xyz, .bil, .flt, .dt2, .jp2, .grd, .nc.
bool is_raster_name(const std::filesystem::path& path);

/// The files that `arguments` name: files as they are, folders as the rasters directly inside
/// (is_raster_name), and shell patterns. Sorted by absolute path, each once. Errors, kInput with
/// the argument: no such file, pattern without a match, folder without any.
std::vector<std::filesystem::path> expand_raster_paths(std::span<const std::string> arguments);

/// How values between pixel centres are found.
enum class Resampling { kBilinear, kNearest };

struct ReadElevationsOptions {
  std::string source_crs = {};  ///< What the files are in, whatever they say; empty: what they say.
  std::string target_crs = {};  ///< Empty: that of the finest file.
  Bounds2 box = Bounds2::nothing();  ///< What is wanted, in target_crs; empty: all there is.
  Point2 origin = {};                ///< Subtracted from x and y.
  Resampling resampling = Resampling::kBilinear;
};

struct Elevations {
  Raster raster;                  ///< Local frame, metres; NaN where no file has a value.
  std::string crs;                ///< Of the coordinates; "" if unknown.
  std::int64_t missing = 0;       ///< Nodes in the box without a value.
  std::vector<Warning> warnings;  ///< "raster_no_elevation", "raster_units".
};

/// Reads what tiles hold within a box. Tiles of one grid and system are laid side by side, so that
/// no seam shows. One grid in the target system with square pixels stays as it is: node = pixel
/// centre. Anything else is sampled on a grid of the finest tile's step in metres; where tiles
/// overlap, the finest that has a value gives it, of equal ones the first. Bilinear values next to
/// missing pixels are the mean of those that are there.
///
/// Scale and offset of the band are applied, and values are converted to metres by the unit of the
/// band or else of the vertical system ("raster_units" where that is no metre). Values that are no
/// elevation on Earth (undeclared -9999, 1e38) are taken for missing ("raster_no_elevation").
/// Files are opened read-only and none is written.
///
/// Guarantee: the order of the files does not matter. Errors, kInput with the path: missing, not a
/// raster, cut, several bands, no georeference, a unit of heights nobody knows, two systems of
/// which one is unknown, nothing in the box, more than 2^31 nodes or than fit into memory. kUsage
/// for a bad system.
Elevations read_elevations(std::span<const std::filesystem::path> paths,
                           const ReadElevationsOptions& options = {});

/// Gives nodes without a value that of the nearest that has one, distance counted in steps of the
/// 8-neighbourhood, ties going to the node that comes first row by row from the south-west. Returns
/// how many there were; nothing changes if that is all.
std::int64_t fill_with_nearest(Raster& raster);

}  // namespace tetropolis

// Height grids as GeoTIFF (paper step 1.3, written as dtm.tif) and as any raster GDAL reads.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tetropolis/core/warning.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/terrain/raster.h"

namespace tetropolis {

/// The value that stands for "no height" in files written here.
inline constexpr double kRasterNodata = -9999;

/// Writes a GeoTIFF, Float32 if single precision has all values (round_to_single()), else Float64:
/// north up (the first row of the file is the northernmost), one square pixel centred on each node,
/// DEFLATE if all values are one, nodata kRasterNodata, and the reference system if known.
///
/// raster, domain: local frame, that is CRS coordinates minus `origin`. The domain, if given, goes
/// into the metadata item TETROPOLIS_DOMAIN = "xmin,ymin,xmax,ymax" in CRS coordinates.
/// Values that are not finite are written as nodata.
/// Precondition: nx, ny >= 1, step > 0, values.size() == nx * ny. `crs` as normalise_crs takes it.
/// Guarantees: the same input gives the same bytes; appears complete or not at all. The
/// file is made in memory first. Errors: kInput if it cannot be written, kUsage if `crs` is bad.
void write_raster(const std::filesystem::path& path, const Raster& raster, Point2 origin,
                  const std::string& crs, const std::optional<Bounds2>& domain = std::nullopt);

/// A raster file in the local frame of a run.
struct RasterInput {
  Raster raster;                  ///< Local frame; every value is finite.
  std::string crs;                ///< Canonical (crs.h); "" if the file states none.
  double height_unit = 1;         ///< Metres per unit of the values, as far as the file says.
  std::optional<Bounds2> domain;  ///< TETROPOLIS_DOMAIN in the local frame, snapped; if there.
  std::int64_t filled = 0;        ///< Nodes that had no value and took their nearest node's.
  std::vector<Warning> warnings;  ///< "raster_filled".
};

/// Reads a single-band raster of square, north-up pixels in any GDAL format; node = pixel centre.
/// A scale and offset of the band are applied. Nodes without a value (nodata, NaN) take the value
/// of the nearest node that has one, distance counted in steps of the 8-neighbourhood, ties going
/// to the node that comes first row by row from the south-west. What a side-car (.aux.xml) says of
/// nodata, units, scale and reference system holds too; none is written.
///
/// Guarantee: read_raster(write_raster(r, origin), origin) gives the same bits for values, step, x0
/// and y0, provided that x0 and y0 are multiples of kCoordinateStep and the origin is whole metres.
/// Errors, kInput with the path: missing, not a raster, cut, several bands, no georeference,
/// rotated or oblong pixels, a local reference system not in metres, a unit of heights nobody
/// knows, no value at all, more than 2^31 pixels or than fit into memory.
RasterInput read_raster(const std::filesystem::path& path, Point2 origin);

}  // namespace tetropolis

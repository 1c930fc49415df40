// Opening raster files and reading windows of them. Private to src/io.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "tetropolis/io/raster/elevation.h"

#include "io/crs/gdal_support.h"

namespace tetropolis {

/// A band, north up, opened for reading.
struct RasterFile {
  gdal::Dataset source;
  gdal::Dataset upright;  ///< The same turned north up, where the file is not; else null.
  RasterHeader header;
  GDALDatasetH dataset() const { return upright != nullptr ? upright.get() : source.get(); }
};

gdal::Dataset open_raster(const std::filesystem::path& path, const gdal::QuietErrors& errors);

/// Errors: those of inspect_raster.
RasterFile open_elevations(const std::filesystem::path& path, const gdal::QuietErrors& errors);

/// A rectangle of pixels, counted from the north-western one.
struct PixelWindow {
  int column = 0;
  int row = 0;
  int columns = 0;
  int rows = 0;
};

/// Values of a window, from the south-west, row by row; NaN where there is none. Scale and offset
/// of the band are applied, units are those of the file.
std::vector<double> read_window(const std::filesystem::path& path, GDALDatasetH dataset,
                                const PixelWindow& window, const gdal::QuietErrors& errors);

/// Metres per unit of the values: as the band says, else the vertical reference system; negative
/// where that counts downwards. Nothing if neither says.
std::optional<double> height_unit_of(const std::filesystem::path& path, GDALDatasetH dataset);

}  // namespace tetropolis

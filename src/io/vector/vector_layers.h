// Which layer of a vector file has the footprints. Private to src/io.
#pragma once

#include <filesystem>
#include <string>

#include "io/crs/gdal_support.h"

namespace tetropolis {

/// The layer of a data set to read footprints from, while both live.
class FootprintLayer {
 public:
  /// `wanted`: its name, or empty for the only one with polygons. A lone layer of points or lines
  /// is taken all the same: its features go into the account. Throws Error(kInput) that lists the
  /// layers if there is none, or several.
  FootprintLayer(const std::filesystem::path& path, GDALDatasetH dataset,
                 const std::string& wanted);

  OGRLayerH get() const { return layer_; }
  OGRGeometryH geometry_of(OGRFeatureH feature) const {
    return OGR_F_GetGeomFieldRef(feature, field_);
  }
  /// Null if the layer states none.
  OGRSpatialReferenceH reference_system() const;

 private:
  OGRLayerH layer_;
  int field_ = 0;  // of its geometries
};

}  // namespace tetropolis

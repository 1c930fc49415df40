// What features say of themselves beside outline and height: that they are no building above
// ground, or a part of another. Private to src/io.
#pragma once

#include <string>
#include <vector>

#include "tetropolis/io/vector/vector.h"

#include "io/crs/gdal_support.h"

namespace tetropolis {

struct FeatureMarks {
  std::string below_ground;    ///< Why it is no building above ground; "" if it may be one.
  bool is_part = false;        ///< Of a building that has an outline of its own, mostly.
  bool is_open_below = false;  ///< A roof on posts, or a building that begins above the ground.
};

/// Reads the attributes of OpenStreetMap (location, layer, building:part, levels, min_height) and
/// Overture (is_underground, building_id), as columns or among other_tags.
class MarkReader {
 public:
  explicit MarkReader(OGRLayerH layer);
  FeatureMarks read(OGRFeatureH feature) const;

 private:
  std::string text(OGRFeatureH feature, int column, const char* tag) const;

  int location_, layer_, underground_, part_, building_, building_id_, levels_, below_, tags_;
  int min_height_, min_level_;
};

/// Where parts lie in a building's outline, they stand for it: an outline that they cover is
/// dropped (DropCause::kOutlined), of others what no part covers is left. Parts without a height
/// take that of the outline. `parts[i]`: whether input.features[i] is a part.
void put_parts_for_outlines(const std::vector<bool>& parts, FootprintsInput& input);

}  // namespace tetropolis

// The file of a city model as one document, whatever its format. Private to src/io.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/file/json_place.h"

namespace tetropolis {

/// A document and the keys of its CityObjects in the order of the file.
struct ModelDocument {
  Json root;
  std::vector<std::string> keys;
  std::vector<std::string> without_height;  ///< Outlines that state none: raised by 6 m.
  bool is_east_first = false;  ///< Though the name of its system means the northing first.
  double height_unit = 1;  ///< Metres per unit of the heights in the file; they are metres here.
};

/// Of CityJSON, CityJSON text sequences and CityGML (read_citygml). Errors, kInput with the path:
/// not JSON, two objects of one key, features without the line before them.
ModelDocument read_document(const std::filesystem::path& path);

}  // namespace tetropolis

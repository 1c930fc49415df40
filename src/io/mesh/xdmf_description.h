// The XML of XDMF files, for writer and reader. Private to src/io.
#pragma once

#include <cstdint>
#include <string>

#include "tetropolis/geometry/types.h"

namespace tetropolis::xdmf {

/// Of the mesh and its boundary.
struct Sizes {
  std::int64_t nodes, cells, faces;
};

/// What refers other programs to the datasets (xdmf_layout.h) in the HDF5 file of that name beside
/// it.
std::string description(const Sizes& sizes, const Point3& origin, const std::string& file);

}  // namespace tetropolis::xdmf

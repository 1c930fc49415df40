// The XML of XDMF files, for writer and reader. Private to src/io.
#pragma once

#include <cstdint>
#include <string>

#include "tetropolis/geometry/types.h"

#include "mesh_input.h"
#include "xdmf_layout.h"

namespace tetropolis::xdmf {

/// What refers other programs to the volume's datasets (xdmf_layout.h) in the HDF5 file `file`
/// beside it, among them the zones if there are any.
std::string volume_description(std::int64_t nodes, const Elements& cells, bool zones,
                               const Point3& origin, const std::string& file);

/// The same of the boundary, whose points are those of `volume_file`.
std::string boundary_description(std::int64_t nodes, const Elements& faces,
                                 const PatchNames& patches, const Point3& origin,
                                 const std::string& volume_file, const std::string& file);

/// The patches of a boundary_description().
PatchNames names_in(const std::string& description);

}  // namespace tetropolis::xdmf

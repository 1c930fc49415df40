// The commands without their files: cities and meshes in memory, each with the report that its
// command would write.
#pragma once

#include <optional>
#include <string>

#include "tetropolis/core/steps.h"
#include "tetropolis/io/las/point_arrays.h"
#include "tetropolis/io/vector/footprint_table.h"
#include "tetropolis/pipeline/build_city.h"
#include "tetropolis/pipeline/mesh_city.h"
#include "tetropolis/run/config.h"
#include "tetropolis/run/report.h"

namespace tetropolis {

/// Input that is not in files. What is given here stands for the setting of the same name, which
/// messages and report then call by its `source`.
struct InputInMemory {
  std::optional<FootprintTable> footprints = {};
  std::optional<PointArrays> points = {};
};

struct CityInMemory {
  BuiltCity built;
  Report report;
};

struct MeshInMemory {
  CityModel city;  ///< As it was meshed.
  CityMesh mesh;
  Report report;
};

// All throw as the commands do: Error, with kUsage for settings out of their range, and Cancelled.
// `config.out` and what else is about files is ignored.

/// Steps 1.1 to 2.3: what `tetropolis city` makes.
CityInMemory make_city(Config config, InputInMemory input = {}, const StepHooks& hooks = {});

/// The city of `config.city` on the terrain of `config.dtm`, as `tetropolis mesh` reads it;
/// `built.raw` is empty.
CityInMemory load_city(const Config& config, const StepHooks& hooks = {});

/// Steps 3.1 to 3.5: what `tetropolis mesh` makes. Heights may have been edited. Throws
/// Error(kInput) naming the building whose roof is not above its ground or is no elevation, or the
/// terrain if one of its nodes is none.
MeshInMemory make_mesh(const Config& config, const BuiltCity& city, const StepHooks& hooks = {});

/// The page (io/page/page.h) of a city, and of a mesh that was made of it.
std::string make_page(const CityInMemory& city);
std::string make_page(const CityInMemory& city, const MeshInMemory& mesh);

}  // namespace tetropolis

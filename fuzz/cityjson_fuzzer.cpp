// Bytes as a CityJSON file.
#include <cmath>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/cityjson/cityjson.h"

#include "fuzz_input.h"

namespace {

using namespace tetropolis;
using namespace tetropolis::fuzz;

bool is_finite(Point2 p) { return std::isfinite(p.x) && std::isfinite(p.y); }

void claim_ring(const Ring& ring) {
  claim(ring.size() >= 3, "rings have three vertices");
  for (const Point2 p : ring) {
    claim(is_finite(p), "vertices are numbers");
    claim(snap_coordinate(p) == p, "vertices are on the grid");
  }
}

void claim_model(const CityModel& model) {
  claim(is_finite(model.origin), "the origin is a number");
  std::set<std::string> ids;
  for (const Building& building : model.buildings) {
    claim(ids.insert(building.id).second, "ids are unique");
    claim(!building.id.empty() && !building.source_ids.empty(), "buildings have ids");
    claim(building.h_ground < building.h_roof, "roofs are above the ground");
    claim(std::isfinite(building.h_ground) && std::isfinite(building.h_roof), "heights");
    claim(building.n_ground_points >= 0 && building.n_roof_points >= 0, "counts of points");
    for_each_ring(building.footprint, claim_ring);
  }
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The part that a file of ours must bring back bit for bit.
void claim_same(const CityModel& a, const CityModel& b) {
  claim(a.buildings.size() == b.buildings.size(), "buildings come back");
  claim(a.origin == b.origin, "the origin comes back");
  claim(a.dropped.size() == b.dropped.size(), "what was dropped comes back");
  for (std::size_t i = 0; i < a.buildings.size(); ++i) {
    const Building &x = a.buildings[i], &y = b.buildings[i];
    claim(x.footprint == y.footprint, "footprints come back");
    claim(x.h_ground == y.h_ground && x.h_roof == y.h_roof, "heights come back");
    claim(x.id == y.id && x.source_ids == y.source_ids, "ids come back");
    claim(x.flags == y.flags && x.n_ground_points == y.n_ground_points &&
              x.n_roof_points == y.n_roof_points,
          "flags and counts come back");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::filesystem::path path = write_scratch("input.city.json", data, size);
  CityModel model;
  try {
    model = read_city(path);
  } catch (const Error& error) {
    claim_error(error, ErrorKind::kInput, path.string());
    return 0;
  }
  claim_model(model);
  const std::filesystem::path once = scratch_folder() / "once.city.json";
  const std::filesystem::path twice = scratch_folder() / "twice.city.json";
  write_city(once, model);
  const CityModel again = read_city(once);
  claim_same(model, again);
  write_city(twice, again);
  claim(bytes_of(once) == bytes_of(twice), "writing what was read gives the same bytes");
  return 0;
}

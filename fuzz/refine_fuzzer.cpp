// Footprints from bytes through cleaning, simplification and the ground mesh: whatever the city,
// every guarantee of the mesh holds.
#include <vector>

#include "tetropolis/city/clean.h"
#include "tetropolis/city/simplify/simplify.h"
#include "tetropolis/core/threads.h"
#include "tetropolis/ground/mesh_ground.h"

#include "fuzz_input.h"
#include "ground/validate.h"

namespace {

using namespace tetropolis;
using namespace tetropolis::fuzz;

constexpr int kMostPolygons = 5;
constexpr int kMostVertices = 8;

std::vector<Polygon> footprints_from(ByteReader& bytes) {
  std::vector<Polygon> cleaned;
  for (int k = 0; k < kMostPolygons && !bytes.empty(); ++k) {
    Polygon raw;
    const double x0 = bytes.take<std::uint8_t>() * 0.3, y0 = bytes.take<std::uint8_t>() * 0.3;
    const int size = bytes.between(3, kMostVertices);
    for (int i = 0; i < size; ++i) {
      const double x = x0 + 0.1 * bytes.take<std::int8_t>();
      raw.outer.push_back({x, y0 + 0.1 * bytes.take<std::int8_t>()});
    }
    CleanedFootprint result = clean_footprint(raw);
    if (result.usable()) cleaned.push_back(std::move(result.polygon));
  }
  return cleaned;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const ThreadLimit one_thread(1);
  static constexpr double kSizes[] = {10, 20, 7.3, 40};
  static constexpr double kAngles[] = {25, 20, 30, 0};
  const Bounds2 domain{0, 0, 76.5, 76.5};
  ByteReader bytes(data, size);
  GroundMeshOptions options;
  options.mesh_size = kSizes[bytes.between(0, 3)];
  options.min_angle_deg = kAngles[bytes.between(0, 3)];
  const Simplification city = simplify_footprints(footprints_from(bytes), domain, {});
  const GroundMesh mesh = mesh_ground(city.footprints, domain, options);
  const Violations violations = validate(mesh, city.footprints, domain, options);
  claim(violations.empty(), violations.empty() ? "" : violations[0]);
  return 0;
}

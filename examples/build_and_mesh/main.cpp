// build_and_mesh FOOTPRINTS POINTS OUT.vtu: reads both, builds and meshes the city in memory.
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include <tetropolis/core/error.h>
#include <tetropolis/io/mesh/vtk.h>
#include <tetropolis/pipeline/build_city.h>
#include <tetropolis/pipeline/mesh_city.h>

using namespace tetropolis;

int main(int argc, char** argv) {
  if (argc != 4) return std::puts("usage: build_and_mesh FOOTPRINTS POINTS OUT.vtu"), 2;
  try {
    const std::vector<std::string> names{argv[2]};
    const auto files = expand_point_paths(names);
    FootprintsInput footprints =
        read_footprints(argv[1], {.target_crs = inspect_las(files.front()).crs});
    PointsInput points = read_points(files, {.crop = footprints.bounds.grown(40)});

    const BuiltCity built = build_city(std::move(points), std::move(footprints));
    const CityMesh mesh = mesh_city(built.city, built.terrain, {.mesh_size = 10});

    write_vtu(argv[3], mesh.volume, mesh.placement);
    std::printf("%lld buildings, %lld tets, least dihedral angle %.1f degrees\n",
                static_cast<long long>(built.facts.buildings),
                static_cast<long long>(mesh.volume_facts.cells), mesh.volume_facts.dihedral_min);
    for (const Warning& warning : mesh.warnings) std::printf("%s\n", warning.message.c_str());
  } catch (const Error& error) {
    return std::fprintf(stderr, "%s\n", error.what()), static_cast<int>(error.kind());
  }
}

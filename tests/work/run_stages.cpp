// Runs every stage once, on one thread, for a tool that counts instructions by function.
//
//   run_stages BUILDINGS FOLDER
#include <cstdio>
#include <cstdlib>

#include "tetropolis/core/threads.h"

#include "stages.h"

int main(int argc, char** argv) {
  using namespace tetropolis;
  using namespace tetropolis::testing;
  if (argc != 3) {
    std::fprintf(stderr, "usage: run_stages BUILDINGS FOLDER\n");
    return 2;
  }
  const ThreadLimit limit(1);
  const WorkCity city = work_city(std::atoll(argv[1]));
  work_simplify(city);
  work_crowd(city);
  const GroundMesh ground = work_ground(city);
  const ColumnMesh mesh = work_columns(city, ground);
  work_uniform(city, ground);
  const std::int64_t faces = work_quality(mesh);
  const SurfaceMesh boundary = work_boundary(mesh);
  work_write(mesh, boundary, argv[2]);
  std::printf("%zu triangles, %lld cells, %lld faces\n", ground.triangles.size(),
              static_cast<long long>(cell_offsets(mesh).back().value()),
              static_cast<long long>(faces));
  return 0;
}

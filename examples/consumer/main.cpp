// The ground mesh of one square building in a domain of 100 m x 80 m.
#include <cstdio>

#include <tetropolis/ground/mesh_ground.h>

int main() {
  const tetropolis::Polygon building{{{40, 30}, {60, 30}, {60, 50}, {40, 50}}, {}};
  const auto mesh = tetropolis::mesh_ground({&building, 1}, {0, 0, 100, 80}, {.mesh_size = 10});
  std::printf("%zu triangles\n", mesh.triangles.size());
  return mesh.triangles.empty() ? 1 : 0;
}

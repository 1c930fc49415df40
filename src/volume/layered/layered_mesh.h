// Layers over the ground mesh: the structure the Laplace problems of steps 3.3 and 3.5 are solved
// on.
//
//   layer K  v1---v3      Triangle t with sorted vertices 1 < 2 < 3 and layer k make a prism with
//            | \ /|       bottom nodes u_i = (v_i, k) and top nodes w_i = (v_i, k + 1), split into
//            |  v2|       T1 = (u1, u2, u3, w3)   vertical edge at vertex 3
//   layer k  u1-|-u3      T2 = (u1, w2, u2, w3)   vertical edge at vertex 2
//              \|/        T3 = (u1, w1, w2, w3)   vertical edge at vertex 1
//               u2        (Naserentin & Logg, step 3.2).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tetropolis/ground/ground_mesh.h"
#include "tetropolis/volume/column/column_mesh.h"
#include "tetropolis/volume/column/edge_graph.h"

namespace tetropolis {

inline constexpr std::int32_t kNoRoof = -1;

/// Layers are 0 (ground) to `layers` (top). A prism of triangle t exists in the layers
/// first_layer[t] .. layers - 1: from the ground outside buildings, from the roof inside.
struct LayeredMesh {
  GroundMesh ground;
  EdgeGraph edges;
  std::int32_t layers = 0;                ///< K > 0.
  std::vector<double> ladder;             ///< K + 1 heights of layers that are not even, as they
                                          ///< were made; empty if they are.
  std::vector<double> z;                  ///< z[v * (K + 1) + k], elevation in metres.
  std::vector<std::int32_t> first_layer;  ///< Per triangle, 0 .. K - 1.
  std::vector<std::int32_t> first_node;   ///< Per vertex: the lowest layer with a cell there, the
                                          ///< least first_layer of the triangles around it.
  std::vector<std::int32_t> roof_layer;   ///< Per vertex: the roof's layer if it belongs to a
                                          ///< building (inside or on its wall), else kNoRoof.

  std::size_t vertex_count() const { return ground.vertices.size(); }
  std::size_t triangle_count() const { return ground.triangles.size(); }
  std::size_t stride() const { return static_cast<std::size_t>(layers) + 1; }
  double* column(VertexIndex v) { return z.data() + v * stride(); }
  const double* column(VertexIndex v) const { return z.data() + v * stride(); }
};

/// Untrimmed columns (all first layers 0, no roofs) whose layers divide the height from `bottom` to
/// `top` evenly. Throws Error(kGuarantee) unless layers > 0 and bottom < top.
LayeredMesh make_layers(GroundMesh ground, std::int32_t layers, double bottom, double top);

/// The same with layers at the elevations of `ladder`, which increase.
LayeredMesh make_layers(GroundMesh ground, std::vector<double> ladder);

/// Share of the height from layer `low` to `high` that is below layer k, as layers were made.
inline double share_below(const LayeredMesh& mesh, std::int32_t low, std::int32_t k,
                          std::int32_t high) {
  if (mesh.ladder.empty()) return static_cast<double>(k - low) / (high - low);
  const auto z = [&](std::int32_t i) { return mesh.ladder[static_cast<std::size_t>(i)]; };
  return (z(k) - z(low)) / (z(high) - z(low));
}

/// The nodes of a layered mesh that belong to cells, where they are. Precondition: it is trimmed
/// (trim) and its columns increase (make_monotone). Takes its ground mesh; leaves it empty.
ColumnMesh columns_of_layers(LayeredMesh&& layered);

}  // namespace tetropolis

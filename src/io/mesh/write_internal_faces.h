// All faces between two cells, streamed, for formats that are made of faces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tetropolis/core/progress.h"
#include "tetropolis/volume/column/column_mesh.h"

#include "io/file/atomic_file.h"
#include "io/file/chunked_output.h"
#include "volume/column/internal_faces.h"
#include "volume/column/prism_faces.h"
#include "volume/column/upper_faces.h"

namespace tetropolis {

/// Cells of columns by triangle, and the faces between those of the upper part and those between
/// prisms.
struct CellFaces {
  explicit CellFaces(const ColumnMesh& mesh)
      : cells(cell_offsets(mesh)), between_prisms(prism_faces(mesh, cells.back())) {
    if (!mesh.upper.empty()) in_upper = upper_faces(mesh);
  }
  std::vector<CellIndex> cells;  ///< cell_offsets().
  std::vector<UpperFace> in_upper;
  std::vector<CellFace> between_prisms;
};

inline std::size_t corners_of(const InternalFace& face) { return face.nodes.size(); }
inline std::size_t corners_of(const CellFace& face) { return face.corners; }

/// Appends what append(face, buffer) does for the faces between two cells in upper-triangular
/// order, about `bytes` in all. A face is an InternalFace or a CellFace.
template <typename Append>
void write_internal_faces(AtomicFile& file, const ColumnMesh& mesh, const CellFaces& faces,
                          std::uint64_t bytes, const Append& append, const Progress& progress) {
  write_chunked(
      file, mesh.triangle_count(), grain_for(mesh.triangle_count(), bytes),
      [&](std::size_t begin, std::size_t end, std::string& buffer) {
        InternalFaces in_columns(mesh, faces.cells);
        for (const TriangleIndex t : indices<TriangleIndex>(begin, end))
          for (const InternalFace& face : in_columns.owned_over(t)) append(face, buffer);
      },
      progress);
  const CellIndex first = faces.cells[mesh.triangle_count()];
  write_chunked(file, faces.in_upper.size(), kRowsPerChunk,
                [&](std::size_t begin, std::size_t end, std::string& buffer) {
                  for (std::size_t f = begin; f < end; ++f) {
                    const UpperFace& face = faces.in_upper[f];
                    append(InternalFace{first + face.cell, first + face.neighbour,
                                        upper_nodes(mesh, face.places)},
                           buffer);
                  }
                });
  write_chunked(file, faces.between_prisms.size(), kRowsPerChunk,
                [&](std::size_t begin, std::size_t end, std::string& buffer) {
                  for (std::size_t f = begin; f < end; ++f) append(faces.between_prisms[f], buffer);
                });
}

}  // namespace tetropolis

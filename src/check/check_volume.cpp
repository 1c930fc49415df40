#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <tuple>

#include <fmt/format.h>

#include "tetropolis/check/check_mesh.h"
#include "tetropolis/core/parallel.h"

#include "hash.h"
#include "rows.h"
#include "violations.h"
#include "volume_parts.h"

namespace tetropolis {

namespace {

constexpr std::size_t kGrain = 16384;

bool is_finite(const std::array<double, 3>& p) {
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

std::vector<std::uint8_t> used_vertices(const TetMesh& mesh) {
  std::vector<std::uint8_t> used(mesh.points.size(), 0);
  parallel_chunks(mesh.cells.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c)
      for (const std::int64_t v : mesh.cells[c])
        std::atomic_ref(used[static_cast<std::size_t>(v)]).store(1, std::memory_order_relaxed);
  });
  return used;
}

/// Pairs of vertices at the same place, the second of each ascending.
std::vector<std::pair<std::int64_t, std::int64_t>> coincident_vertices(const TetMesh& mesh) {
  const std::size_t rows = std::bit_ceil(mesh.points.size());
  const Rows filed = file_under_rows(mesh.points.size(), rows, [&](std::size_t v, const auto& use) {
    if (is_finite(mesh.points[v])) use(hash_of(mesh.points[v]) & (rows - 1));
  });
  using Pairs = std::vector<std::pair<std::int64_t, std::int64_t>>;
  Pairs pairs = parallel_reduce_ordered(
      rows, kGrain, Pairs{},
      [&](std::size_t begin, std::size_t end) {
        Pairs part;
        std::vector<std::int64_t> row;
        for (std::size_t r = begin; r < end; ++r) {
          if (filed[r].size() < 2) continue;
          row.assign(filed[r].begin(), filed[r].end());
          const auto at = [&](std::int64_t v) { return mesh.points[static_cast<std::size_t>(v)]; };
          std::sort(row.begin(), row.end(), [&](std::int64_t a, std::int64_t b) {
            return std::pair(at(a), a) < std::pair(at(b), b);
          });
          for (std::size_t i = 1; i < row.size(); ++i)
            if (at(row[i]) == at(row[i - 1])) part.emplace_back(row[i - 1], row[i]);
        }
        return part;
      },
      [](Pairs a, const Pairs& b) {
        a.insert(a.end(), b.begin(), b.end());
        return a;
      });
  std::sort(pairs.begin(), pairs.end(),
            [](const auto& a, const auto& b) { return a.second < b.second; });
  return pairs;
}

}  // namespace

void check_vertices(const TetMesh& mesh, VolumeCheck& check) {
  const std::vector<std::uint8_t> used = used_vertices(mesh);
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    const auto place = [&] { return fmt::format("vertex {}", v); };
    if (used[v] == 0) note_violation(check.violations, "vertices without cells", place);
    if (!is_finite(mesh.points[v]))
      note_violation(check.violations, "coordinates that are not finite", place);
  }
  for (const auto& [a, b] : coincident_vertices(mesh))
    note_violation(check.violations, "coincident vertices",
                   [&, a = a, b = b] { return fmt::format("vertices {} and {}", a, b); });
}

void check_boundary(VolumeCheck& check) {
  struct Half {
    std::int64_t high;
    bool forward;
  };
  // Half edge 3 f + i goes from corner i of face f to the next one.
  const auto ends_of = [&](std::size_t half) {
    const auto& face = check.boundary[half / 3];
    return std::pair(face[half % 3], face[(half + 1) % 3]);
  };
  const Rows rows =
      file_under_rows(3 * check.boundary.size(), static_cast<std::size_t>(check.vertices),
                      [&](std::size_t half, const auto& use) {
                        const auto [a, b] = ends_of(half);
                        use(static_cast<std::size_t>(std::min(a, b)));
                      });
  std::vector<Half> halves;
  for (std::size_t low = 0; low < rows.size(); ++low) {
    if (rows[low].empty()) continue;
    halves.clear();
    for (const std::int64_t half : rows[low]) {
      const auto [a, b] = ends_of(static_cast<std::size_t>(half));
      halves.push_back({std::max(a, b), a < b});
    }
    std::sort(halves.begin(), halves.end(), [](const Half& a, const Half& b) {
      return std::tie(a.high, a.forward) < std::tie(b.high, b.forward);
    });
    for (std::size_t i = 0, j = 0; i < halves.size(); i = j) {
      while (j < halves.size() && halves[j].high == halves[i].high) ++j;
      if (j - i == 2 && halves[i].forward != halves[i + 1].forward) continue;
      note_violation(
          check.violations, j - i < 2 ? "open boundary edges" : "non-manifold boundary edges",
          [&] { return fmt::format("edge between vertices {} and {}", low, halves[i].high); });
    }
  }
}

VolumeCheck check_volume(const TetMesh& mesh, const Progress& progress) {
  VolumeCheck check;
  check.vertices = static_cast<std::int64_t>(mesh.points.size());
  check.cells = static_cast<std::int64_t>(mesh.cells.size());
  if (mesh.cells.empty()) note_violation(check.violations, "no cells", [] { return "the file"; });
  progress.update(0);
  check_vertices(mesh, check);
  progress.update(0.1);
  measure_cells(mesh, check);
  progress.update(0.3);
  match_faces(mesh, check, progress);
  check_boundary(check);
  return check;
}

}  // namespace tetropolis

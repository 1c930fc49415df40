#include "mesh_input.h"

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/core/system_memory.h"

namespace tetropolis {

namespace {

// TetMesh, and what check_volume takes beside it.
constexpr double kPerPoint = 28;
constexpr double kPerCell = 56;

}  // namespace

void require_room_for_mesh(const std::filesystem::path& path, std::uint64_t points,
                           std::uint64_t cells) {
  const double bytes =
      kPerPoint * static_cast<double>(points) + kPerCell * static_cast<double>(cells);
  const double room = usable_memory();
  if (bytes <= room) return;
  throw Error(ErrorKind::kInput,
              fmt::format("{}: to read and check its {} cells takes about {:.1f} GB, and {:.1f} GB "
                          "are there; use a machine with more memory",
                          path.string(), cells, bytes / 1e9, room / 1e9));
}

}  // namespace tetropolis

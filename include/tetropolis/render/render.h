// Pictures of results, without a display.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "tetropolis/io/picture/png.h"
#include "tetropolis/volume/column/boundary.h"
#include "tetropolis/volume/tet_mesh.h"

namespace tetropolis {

/// How one looks at a city.
enum class View {
  kCity,     ///< From the air, in perspective.
  kPlan,     ///< From above, north up, to scale.
  kSection,  ///< At a vertical plane through the volume mesh, and at what is behind it.
};

/// What colours say.
enum class PictureColour {
  kClass,     ///< Ground, roofs, walls; in a section, air over ground and air over buildings.
  kHeight,    ///< Heights of roofs above the lowest points of their buildings.
  kBuilding,  ///< Which building.
  kQuality,   ///< Least dihedral angles of the cells of a section.
};

/// Their words, in the order of the enumerations.
inline constexpr std::array<std::string_view, 3> kViewNames{"city", "plan", "section"};
inline constexpr std::array<std::string_view, 4> kPictureColourNames{"class", "height", "building",
                                                                     "quality"};

/// Where a section is.
struct CutLine {
  double azimuth = 90;             ///< Compass direction of its line, degrees; the picture's right.
  std::optional<double> position;  ///< Of a line along an axis: its y (azimuth 90) or x (azimuth
                                   ///< 0), in the coordinates of the mesh.
};

/// "x" or "y" (the plane's normal), "x=120.5", or degrees. Throws Error(kUsage) for anything else.
CutLine cut_named(const std::string& text);

struct RenderOptions {
  View view = View::kCity;
  int width = 1600;  ///< Pixels, 16 to 8192; `height` too; 2^24 in all.
  int height = 1000;
  double azimuth = 30;    ///< Of `city`: the compass direction one looks in, degrees.
  double elevation = 35;  ///< Of `city`: how far downwards, degrees, 5 to 90.
  PictureColour colour = PictureColour::kClass;
  bool edges = false;               ///< Draws the edges of triangles; sections always have them.
  std::optional<CutLine> cut = {};  ///< Of `section`; none: where most walls are cut.
};

/// What a picture shows. Coordinates in metres, both in one frame.
struct RenderInput {
  SurfaceMesh surface;            ///< Ground, roofs, walls; other patches are not drawn.
  std::optional<TetMesh> volume;  ///< The air; for sections.
};

/// Reads a result folder (surface.vtp or boundary.vtp or boundary.xdmf, for sections volume.vtu or
/// volume.xdmf; without meshes city.city.json on dtm.tif), or one file: .vtp, .vtu, .xdmf, .stl,
/// .json. Surfaces of a volume alone are found in it. Throws Error(kInput) naming the file and what
/// is wrong with it.
RenderInput read_render_input(const std::filesystem::path& path, View view);

/// The picture of `input`. Shows all of the city; a section the part of its line with most walls.
/// The same bytes for any number of threads. Throws Error(kUsage) for options out of their range
/// and Error(kInput) if there is nothing to see.
Picture render_picture(const RenderInput& input, const RenderOptions& options);

}  // namespace tetropolis

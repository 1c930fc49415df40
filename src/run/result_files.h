// The files that runs leave in their folders: one list for those who write, replace and check them.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/is_among.h"

namespace tetropolis {

struct ResultFile {
  std::string_view name;    ///< Below the folder.
  std::string_view format;  ///< The one of the setting `formats` that asks for it; empty: always;
                            ///< "html": unless the setting `no_html` is on.
};

namespace results {

inline constexpr const char* kReport = "report.json";
inline constexpr const char* kRawCity = "city_raw.city.json";
inline constexpr const char* kCity = "city.city.json";
inline constexpr const char* kTerrain = "dtm.tif";
inline constexpr const char* kLayers = "buildings.gpkg";
inline constexpr const char* kPage = "index.html";
inline constexpr const char* kCellZones = "constant/polyMesh/cellZones";  ///< With zones.
inline constexpr const char* kManifest = "manifest.json";
inline constexpr const char* kTruth = "truth.city.json";

/// Of runs that make a city model.
inline constexpr std::array kOfCity = {kRawCity, kCity, kTerrain, kLayers};

/// Of runs that make meshes.
inline constexpr std::array<ResultFile, 24> kOfMesh = {{
    {"volume.vtu", "vtu"},
    {"volume.xdmf", "xdmf"},
    {"volume.h5", "xdmf"},
    {"boundary.xdmf", "xdmf"},
    {"boundary.h5", "xdmf"},
    {"volume.msh", "msh"},
    {"volume_msh2.msh", "msh2"},
    {"volume.vtkhdf", "vtkhdf"},
    {"volume.cgns", "cgns"},
    {"volume_fluent.msh", "fluent"},
    {"volume.su2", "su2"},
    {"constant/polyMesh/points", "openfoam"},
    {"constant/polyMesh/faces", "openfoam"},
    {"constant/polyMesh/owner", "openfoam"},
    {"constant/polyMesh/neighbour", "openfoam"},
    {"constant/polyMesh/boundary", "openfoam"},
    {kCellZones, "openfoam"},
    {kPage, "html"},
    {"boundary.vtp", ""},
    {"surface.vtp", ""},
    {"surface.stl", ""},
    {"surface.obj", "obj"},
    {"surface.ply", "ply"},
    {"surface.glb", "glb"},
}};

/// What `check` does not read, as it tells users: a folder stands for its files.
inline constexpr std::array kUnread = {
    "volume.msh", "volume_msh2.msh",   "volume.vtkhdf", "volume.cgns", "volume_fluent.msh",
    "volume.su2", "constant/polyMesh", "surface.obj",   "surface.ply", "surface.glb"};

/// Of `synth`. Points in tiles are points_1.laz and so on.
inline constexpr std::array kOfSynth = {"footprints.shp", "footprints.shx", "footprints.dbf",
                                        "footprints.prj", "footprints.cpg", "footprints.geojson",
                                        "points.laz",     kManifest,        kTruth};

inline bool is_of_synth(std::string_view name) {
  return is_among(name, kOfSynth) || (name.starts_with("points_") && name.ends_with(".laz"));
}

/// Every name a command other than `synth` may give to a result; the report, which vouches for the
/// others, first.
inline std::vector<std::string> all_names() {
  std::vector<std::string> names{std::string(kReport)};
  names.insert(names.end(), kOfCity.begin(), kOfCity.end());
  for (const ResultFile& file : kOfMesh) names.emplace_back(file.name);
  return names;
}

/// What a run writes: its report, a city model, meshes in these formats.
inline std::vector<std::string> of_run(bool city, bool mesh,
                                       const std::vector<std::string>& formats) {
  std::vector<std::string> names{std::string(kReport)};
  if (city) names.insert(names.end(), kOfCity.begin(), kOfCity.end());
  for (const ResultFile& file : kOfMesh)
    if ((mesh || file.name == kPage) && (file.format.empty() || is_among(file.format, formats)))
      names.emplace_back(file.name);
  return names;
}

/// The files of one format.
inline std::vector<std::string> of_format(std::string_view format) {
  std::vector<std::string> names;
  for (const ResultFile& file : kOfMesh)
    if (file.format == format) names.emplace_back(file.name);
  return names;
}

}  // namespace results

}  // namespace tetropolis

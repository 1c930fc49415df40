// Steps 1.1 and 1.2, and with them the frame and the domain of a run.
#pragma once

#include <string>
#include <vector>

#include "tetropolis/geometry/point_cloud.h"
#include "tetropolis/io/las/las.h"
#include "tetropolis/io/vector/vector.h"

#include "pipeline/stages.h"

namespace tetropolis {

/// A file of the cloud.
struct PointFile {
  std::string path;
  FilePoints points;
};

struct InputData {
  PointCloud points;  ///< Local frame, inside the domain only.
  Bounds2 extent;     ///< Of the points.
  std::vector<PointFile> files;
  /// Points of files in which those of buildings have no class of their own (find_ground).
  std::vector<PointRange> no_buildings;
  FootprintsInput footprints;  ///< Local frame.
  Point2 origin;
  Bounds2 domain;   ///< Local frame.
  std::string crs;  ///< Of points and footprints; empty if nobody says.
};

/// The points as they were given, for messages about all of them: "tiles, and 3 more".
std::string points_given(const Config& config);

/// Reads both, brings the footprints into the points' reference system and finds the domain: the
/// bounds given, or the box of the footprints within that of the points, grown by the margin as far
/// as there are points, or without either the box of the points. Without bounds, points far from
/// all others become noise (find_stray_points; "stray_points"). Fills report.input, report.domain
/// and warnings. Throws Error(kInput): unusable files, degrees, units other than metres, no
/// overlap. Throws Error(kUsage) before it reads points if by the headers they, or the mesh that is
/// to follow, will not fit into memory; where headers tell of fewer points than fill their box, or
/// only the points tell where the domain is, after it has read them. `misread` becomes
/// PointsInput::misread, also before an error that comes later.
InputData read_input(const Config& config, Next next, StepClock& clock, Report& report,
                     std::string& misread);

}  // namespace tetropolis

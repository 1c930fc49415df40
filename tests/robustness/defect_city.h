// A small city for the tests of bad input: five buildings and a "patient" among them, scanned on a
// grid of one metre, run through the whole pipeline from files, and what must hold of any result.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/geometry/point_cloud.h"
#include "tetropolis/run/config.h"
#include "tetropolis/run/report.h"

#include "support/shapes.h"

namespace tetropolis::testing {

/// A building of the undamaged city, local coordinates.
struct House {
  std::string id;
  Polygon footprint;
  double height = 0;  ///< Of the roof above the ground at the footprint's first vertex, metres.
};

/// What is scanned and what is drawn in it.
struct DefectCity {
  Bounds2 domain{0, 0, 160, 120};
  Point2 origin{319000, 6398000};  ///< Added to everything written.
  std::vector<House> houses;
  std::function<double(double, double)> ground;  ///< Elevation.
  /// Class of the ground points at a place; 0: there are none.
  std::function<int(double, double)> ground_class = [](double, double) { return 2; };
  std::vector<Point3> strays;  ///< Further ground points.
};

/// One feature of the footprint file: WKT in local coordinates, of any quality.
struct Feature {
  std::string id;
  std::string wkt;
};

inline std::vector<std::string> ids_of(const std::vector<Feature>& features) {
  std::vector<std::string> ids;
  for (const Feature& feature : features) ids.push_back(feature.id);
  return ids;
}

/// "west" 20 x 20 m, "east" an L, "north" around a courtyard, "tower", "shed", and "patient", 24 x
/// 16 m at (60, 50), 10 m and more from all others; gentle slope at 20 m.
DefectCity defect_city();

/// Rings as they are, without the first vertex repeated at the end: "POLYGON((0 0,1 0,1 1))".
std::string open_wkt(const Polygon& polygon);
/// The same, closed.
std::string wkt(const Polygon& polygon);

/// The features of the city as they should be.
std::vector<Feature> sound_features(const DefectCity& city);
/// The same with `patient` instead of the feature of that name.
std::vector<Feature> with_patient(const DefectCity& city, const std::string& patient);

/// Points on a grid of one metre: class 6 on roofs, the class of the ground elsewhere.
PointCloud scan(const DefectCity& city);

/// `wkt` moved by `by`: every pair of numbers is taken for x and y, further ones of a point stay.
std::string moved_wkt(const std::string& wkt, Point2 by);

/// A table with a column of WKT, as GDAL reads it (.csv), in the coordinates of `origin`.
void write_features(const std::filesystem::path& path, const std::vector<Feature>& features,
                    Point2 origin);

/// What became of a run.
struct Outcome {
  std::string error;  ///< Message, or empty.
  int exit_code = 0;  ///< That of the command line.
  Report report;
  CityModel raw;   ///< After step 1.
  CityModel city;  ///< After step 2.

  /// The building made of this feature, or null.
  const Building* building_of(const std::string& source_id) const;
  /// Why this feature is in no building, or empty.
  std::string reason_of(const std::string& source_id) const;
  bool has_warning(const std::string& code) const;
};

/// Settings of a small mesh of `city` from the files in `folder`, with explicit bounds.
Config small_config(const DefectCity& city, const std::filesystem::path& folder);

/// Writes folder/points.las (unless there) and folder/footprints.csv.
void write_input(const DefectCity& city, const std::vector<Feature>& features,
                 const std::filesystem::path& folder);

/// Runs `build`. A result is checked as `expect_sound` says; an error is checked to be one line and
/// to leave nothing behind.
Outcome build(const Config& config, const std::vector<std::string>& ids);

/// Every guarantee, from the written files with the validators, and: each of `ids` is in exactly
/// one building or dropped with a reason.
void expect_sound(const Config& config, const Outcome& outcome,
                  const std::vector<std::string>& ids);

/// The greatest distance of a vertex of one outline to the other outline, both ways; infinity if
/// the numbers of holes differ.
double outline_distance(const Polygon& a, const Polygon& b);

}  // namespace tetropolis::testing

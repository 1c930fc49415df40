// Footprints as they come: one defect at a time in a small city, through the whole pipeline. Each
// row says what must become of it; that the other buildings stay exactly as they are without the
// defect, and that every guarantee holds, is asked of all.
#include <cmath>
#include <limits>
#include <numbers>
#include <ostream>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tetropolis/geometry/polygon.h"

#include "defect_city.h"
#include "support/test_data.h"

namespace tetropolis::testing {
namespace {

constexpr double kAny = std::numeric_limits<double>::infinity();
constexpr double kStep = 2 * kCoordinateStep;

const Polygon kPatient = box(60, 50, 84, 66);
const Polygon kNorth = defect_city().houses[2].footprint;

struct Row {
  std::string name;
  std::string patient;             ///< WKT.
  std::vector<Feature> more = {};  ///< Further features.

  Polygon outline = kPatient;             ///< The patient's building has this outline,
  double within = kStep;                  ///< so far off at most (kAny: not asked),
  double area = 0;                        ///< this area (0: that of `outline`; NaN: not asked),
  double area_within = 0.5;               ///< so much off at most, square metres,
  std::set<std::string> flags = {};       ///< these flags,
  std::vector<std::string> members = {};  ///< and these members beside the patient.
  std::string dropped = "";               ///< Or it is dropped for a reason that says this.
  std::map<std::string, std::string> drops = {};  ///< Others dropped, and why.
  std::string warning = "";                       ///< Code of a warning of the report.
};

void PrintTo(const Row& row, std::ostream* out) { *out << row.name; }

std::string circle(Point2 centre, double radius, int n) {
  Polygon polygon;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    polygon.outer.push_back(
        {centre.x + radius * std::cos(angle), centre.y + radius * std::sin(angle)});
  }
  return wkt(polygon);
}

/// The patient with teeth of `depth` and `width` along its northern wall.
std::string saw(double depth, double width) {
  Polygon polygon{{{60, 50}, {84, 50}, {84, 66}}, {}};
  for (double x = 84 - width; x > 60; x -= 2 * width) {
    polygon.outer.push_back({x, 66 - depth});
    polygon.outer.push_back({x - width, 66});
  }
  return wkt(polygon);
}

std::string with_hole(const Ring& hole) { return wkt({kPatient.outer, {hole}}); }

/// Squares of 4 m that touch at their corners, as further features; the first is the patient.
std::vector<Feature> checkerboard() {
  std::vector<Feature> squares;
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 4; ++j)
      if ((i + j) % 2 == 0 && i + j > 0)
        squares.push_back(
            {fmt::format("c{}{}", i, j), wkt(box(60 + 4 * i, 50 + 4 * j, 64 + 4 * i, 54 + 4 * j))});
  return squares;
}

std::vector<Feature> shifted_copies(int n, double step) {
  std::vector<Feature> copies;
  for (int i = 1; i <= n; ++i)
    copies.push_back({fmt::format("copy{}", i),
                      wkt(box(60 + step * i, 50 - step * i, 84 + step * i, 66 - step * i))});
  return copies;
}

std::vector<std::string> ids_of(const std::vector<Feature>& features) {
  std::vector<std::string> ids;
  for (const Feature& feature : features) ids.push_back(feature.id);
  return ids;
}

std::vector<Row> rings() {
  Polygon clockwise = kPatient;
  std::reverse(clockwise.outer.begin(), clockwise.outer.end());
  return {
      {"Sound", wkt(kPatient)},
      {"Unclosed", open_wkt(kPatient)},
      {"Clockwise", wkt(clockwise)},
      {"ClockwiseAndUnclosed", open_wkt(clockwise)},
      {"ClosedThrice", "POLYGON((60 50,84 50,84 66,60 66,60 50,60 50,60 50))"},
      {"DuplicateVertices", "POLYGON((60 50,60 50,84 50,84 50,84 50,84 66,60 66,60 66,60 50))"},
      {"NearDuplicateVertices",
       "POLYGON((60 50,60.0004 50,84 50,84.0002 50.0003,84 66,60 66,59.9999 65.9999,60 50))",
       {},
       kPatient,
       0.001},
      {"VerticesOnWalls", "POLYGON((60 50,70 50,71 50,84 50,84 58,84 66,72 66,60 66,60 50))"},
      {"TheSameRingTwiceInOne",
       "POLYGON((60 50,84 50,84 66,60 66,60 50,84 50,84 66,60 66,60 50))",
       {},
       kPatient,
       kStep,
       0,
       0.5,
       {"repaired"}},
      {"SpikeOfZeroWidthOutwards", "POLYGON((60 50,84 50,84 58,91 58,84 58,84 66,60 66,60 50))"},
      {"SpikeOfZeroWidthInwards", "POLYGON((60 50,84 50,84 58,70 58,84 58,84 66,60 66,60 50))"},
      {"SpikeAtTheSeam", "POLYGON((55 50,60 50,84 50,84 66,60 66,60 50,55 50))"},
      {"SpikeOfACentimetre",
       "POLYGON((60 50,84 50,84 58,91 58,84 58.01,84 66,60 66,60 50))",
       {},
       kPatient,
       0.02,
       0,
       0.5,
       {"repaired"}},
      {"CutOfACentimetre",
       "POLYGON((60 50,84 50,84 58,70 58,84 58.01,84 66,60 66,60 50))",
       {},
       kPatient,
       0.02,
       0,
       0.5,
       {"repaired"}},
      {"SawOfTwoCentimetres", saw(0.02, 0.3), {}, kPatient, 0.1, 0, 2, {"repaired"}},
      {"SawOfHalfAMetre", saw(0.5, 0.5), {}, kPatient, 0.75, 384, 16, {"repaired"}},
      {"NeedleOfHalfADegree",
       "POLYGON((60 50,84 50,84 57.9,107 58,84 58.1,84 66,60 66,60 50))",
       {},
       kPatient,
       1,
       0,
       2,
       {"repaired"}},
      {"NothingButANeedleOfHalfADegree",
       "POLYGON((60 58,100 58,100 58.35,60 58))",
       {},
       kPatient,
       0,
       0,
       0,
       {},
       {},
       "narrow"},
      {"BowTieOfTwoTriangles",
       "POLYGON((60 50,84 66,84 50,60 66,60 50))",
       {},
       kPatient,
       kAny,
       192,
       4,
       {"repaired"}},
      {"BowTieOfTwoNeighbouringVertices",
       "POLYGON((60 50,84 50,84 66,61 66,61.3 66.2,60 66,60 50))",
       {},
       kPatient,
       0.5,
       0,
       1,
       {"repaired"}},
      {"LoopAtACorner",
       "POLYGON((60 50,84 50,84 66,86 66,86 68,83.9 65.9,60 66,60 50))",
       {},
       kPatient,
       kAny,
       386,
       3,
       {"repaired"}},
      {"KeyholeInsteadOfAHole",
       "POLYGON((60 50,84 50,84 66,60 66,60 58,68 58,68 62,76 62,76 54,68 54,68 58,60 58,60 50))",
       {},
       {kPatient.outer, {{{68, 54}, {68, 62}, {76, 62}, {76, 54}}}},
       kStep,
       0,
       0.5,
       {"repaired"}},
      {"CircleOf4000Vertices", circle({72, 58}, 8, 4000), {}, kPatient, kAny, 201, 6, {"repaired"}},
  };
}

std::vector<Row> holes() {
  const Polygon court{kPatient.outer, {{{68, 54}, {68, 62}, {76, 62}, {76, 54}}}};
  return {
      {"HoleCounterClockwise", with_hole({{68, 54}, {76, 54}, {76, 62}, {68, 62}}), {}, court},
      {"HoleOutside",
       with_hole({{90, 54}, {90, 62}, {96, 62}, {96, 54}}),
       {},
       kPatient,
       kStep,
       0,
       0.5,
       {"repaired"}},
      {"HoleFarOutside",
       with_hole({{-5000, 54}, {-5000, 62}, {-4990, 62}, {-4990, 54}}),
       {},
       kPatient,
       kStep,
       0,
       0.5,
       {"repaired"}},
      {"HoleOutsideTouching",
       with_hole({{84, 54}, {84, 62}, {92, 62}, {92, 54}}),
       {},
       kPatient,
       kStep,
       0,
       0.5,
       {"repaired"}},
      {"HoleEqualToTheShell", with_hole(kPatient.outer), {}, kPatient, kStep, 0, 0.5, {"repaired"}},
      {"HoleAroundTheShell",
       with_hole(box(58, 48, 86, 68).outer),
       {},
       kPatient,
       kStep,
       0,
       0.5,
       {"repaired"}},
      {"HoleTwice",
       wkt({kPatient.outer, {court.holes[0], court.holes[0]}}),
       {},
       court,
       kStep,
       0,
       0.5,
       {"repaired"}},
      {"HoleInAHole",
       wkt({kPatient.outer, {court.holes[0], box(70, 56, 74, 60).outer}}),
       {},
       court,
       kStep,
       0,
       0.5,
       {"repaired"}},
      {"OverlappingHoles",
       wkt({kPatient.outer, {box(66, 54, 72, 62).outer, box(70, 54, 78, 62).outer}}),
       {},
       {kPatient.outer, {box(66, 54, 78, 62).outer}},
       kStep,
       0,
       0.5,
       {"repaired"}},
      {"HoleAcrossTheShell",
       with_hole(box(78, 54, 90, 62).outer),
       {},
       {{{60, 50}, {84, 50}, {84, 54}, {78, 54}, {78, 62}, {84, 62}, {84, 66}, {60, 66}}, {}},
       kStep,
       0,
       0.5,
       {"repaired"}},
      {"HoleSharingAnEdge",
       with_hole(box(76, 54, 84, 62).outer),
       {},
       {{{60, 50}, {84, 50}, {84, 54}, {76, 54}, {76, 62}, {84, 62}, {84, 66}, {60, 66}}, {}},
       kStep,
       0,
       0.5,
       {"repaired"}},
      {"HoleTouchingAtAVertex",
       with_hole({{84, 58}, {76, 54}, {70, 58}, {76, 62}}),
       {},
       kPatient,
       kAny,
       384 - 56,
       3,
       {"repaired"}},
      {"HoleOfTwoVertices", "POLYGON((60 50,84 50,84 66,60 66,60 50),(70 55,72 57,70 55))"},
      {"HoleOfZeroArea", "POLYGON((60 50,84 50,84 66,60 66,60 50),(70 55,72 57,71 56,70 55))"},
      {"WallOfFiveCentimetres",
       with_hole(box(61, 51, 83, 65.95).outer),
       {},
       kPatient,
       kAny,
       384 - 22 * 14.95,
       26,
       {"repaired"}},
      {"BuildingInACourtyard",
       wkt(court),
       {{"inner", wkt(box(70, 56, 74, 60))}},
       court,
       kStep,
       0,
       0.5,
       {}},
      {"BuildingThatFillsTheCourtyard",
       wkt(court),
       {{"inner", wkt(box(68, 54, 76, 62))}},
       kPatient,
       kStep,
       0,
       0.5,
       {"merged"},
       {"inner"}},
      {"BuildingThatFillsTheCourtyardButForACentimetre",
       wkt(court),
       {{"inner", wkt(box(68.01, 54.01, 75.99, 61.99))}},
       kPatient,
       kStep,
       0,
       0.5,
       {"merged"},
       {"inner"}},
      {"CourtyardsWithinCourtyards",
       wkt({box(56, 46, 88, 72).outer, {box(59, 49, 85, 69).outer}}),
       {{"second", wkt({box(62, 52, 82, 66).outer, {box(65, 55, 79, 63).outer}})},
        {"third", wkt(box(68, 57, 76, 61))}},
       {box(56, 46, 88, 72).outer, {box(59, 49, 85, 69).outer}},
       kStep,
       0,
       0.5,
       {"no_roof_points"}},  // the scan is of a building without courtyard
  };
}

std::vector<Row> neighbours() {
  const DefectCity city = defect_city();
  std::vector<Feature> twice;
  for (const House& house : city.houses) twice.push_back({house.id + "2", wkt(house.footprint)});
  const Polygon both = box(60, 50, 94, 66);
  std::vector<Row> rows{
      {"WallOffByAMicrometre",
       wkt(kPatient),
       {{"next", "POLYGON((84.000001 50,94 50,94 66,84.000001 66,84.000001 50))"}},
       both,
       kStep,
       0,
       0.5,
       {"merged"},
       {"next"}},
      {"WallOverlappingByAMicrometre",
       wkt(kPatient),
       {{"next", "POLYGON((83.999999 50,94 50,94 66,83.999999 66,83.999999 50))"}},
       both,
       kStep,
       0,
       0.5,
       {"merged"},
       {"next"}},
      {"TJunctionOffByAMicrometre",
       wkt(kPatient),
       {{"next", "POLYGON((84.000001 54,94 54,94 58,84 58,84.000001 54))"},
        {"nextnext", "POLYGON((84 58.000001,94 58,94 62,83.999999 62,84 58.000001))"}},
       {{{60, 50}, {84, 50}, {84, 54}, {94, 54}, {94, 62}, {84, 62}, {84, 66}, {60, 66}}, {}},
       kStep,
       0,
       0.5,
       {"merged"},
       {"next", "nextnext"}},
      {"CrackOfACentimetre",
       wkt(kPatient),
       {{"next", wkt(box(84.01, 50, 94, 66))}},
       both,
       kStep,
       0,
       0.5,
       {"merged"},
       {"next"}},
      {"CrackThatNarrowsToNothing",
       wkt(kPatient),
       {{"next", "POLYGON((84.02 50,94 50,94 66,84 66,84.02 50))"}},
       both,
       0.02,
       0,
       0.5,
       {"merged"},
       {"next"}},
      {"GapOfHalfAMetre",
       wkt(kPatient),
       {{"next", wkt(box(84.5, 50, 94, 66))}},
       both,
       kStep,
       0,
       0.5,
       {"merged"},
       {"next"}},
      {"CornersThatTouch",
       wkt(kPatient),
       {{"next", wkt(box(84, 66, 94, 72))}},
       kPatient,
       kAny,
       384 + 60,
       3,
       {"merged"},
       {"next"}},
      {"ShedOfTwoCentimetresAtTheWall",
       wkt(kPatient),
       {{"speck", wkt(box(84, 57, 84.02, 57.02))}},
       kPatient,
       0.03,
       0,
       0.5,
       {"merged"},
       {"speck"}},
      {"ShedOfTwoCentimetres",
       wkt(kPatient),
       {{"speck", wkt(box(95, 57, 95.02, 57.02))}},
       kPatient,
       kStep,
       0,
       0.5,
       {},
       {},
       "",
       {{"speck", "small"}}},
      {"FreeWallOfFiveCentimetres",
       wkt(kPatient),
       {{"fence", wkt(box(90, 45, 90.05, 72))}},
       kPatient,
       kStep,
       0,
       0.5,
       {},
       {},
       "",
       {{"fence", "small"}}},
      {"WallOfFiveCentimetresBetweenBuildings",
       wkt(kPatient),
       {{"wall", wkt(box(84, 57.5, 94, 57.55))}, {"next", wkt(box(94, 50, 104, 66))}},
       kPatient,
       kAny,
       384 + 160 + 11,
       2,
       {"merged"},
       {"next", "wall"}},
      {"LargerThanTheDomain",
       wkt(kPatient),
       {{"all", wkt(box(-100, -100, 300, 300))}},
       kPatient,
       kStep,
       0,
       0.5,
       {},
       {},
       "",
       {{"all", "crosses the domain boundary"}}},
      {"EveryBuildingTwice",
       wkt(kPatient),
       twice,
       kPatient,
       kStep,
       0,
       0.5,
       {"merged"},
       {"patient2"}},
      {"MassiveOverlaps",
       wkt(kPatient),
       shifted_copies(30, 0.1),
       kPatient,
       kAny,
       384 + 40 * 3,
       6,
       {"merged"},
       ids_of(shifted_copies(30, 0.1))},
      {"BuildingOnTheRoofOfAnother",
       wkt(kPatient),
       {{"penthouse", wkt(box(66, 54, 70, 60))}},
       kPatient,
       kStep,
       0,
       0.5,
       {"merged"},
       {"penthouse"}},
      {"Checkerboard",
       wkt(box(60, 50, 64, 54)),
       checkerboard(),
       kPatient,
       kAny,
       160,
       25,
       {"merged"},
       ids_of(checkerboard())},
  };
  return rows;
}

std::vector<Row> geometries() {
  const auto drops = [](const char* name, const char* text, const char* reason) {
    Row row{name, text};
    row.dropped = reason;
    return row;
  };
  Row collection{"CollectionWithPointsAndLines",
                 "GEOMETRYCOLLECTION(POINT(72 58),POLYGON((60 50,84 50,84 66,60 66,60 50)),"
                 "LINESTRING(60 50,84 66))"};
  collection.warning = "mixed_geometry";
  Row curve{"CurvePolygon",
            "CURVEPOLYGON(COMPOUNDCURVE((60 50,84 50),CIRCULARSTRING(84 50,92 58,84 66),(84 66,60 "
            "66,60 50)))"};
  curve.within = kAny;
  curve.area = 384 + 32 * std::numbers::pi;
  curve.area_within = 1.5;
  curve.flags = {"repaired"};
  Row tin = drops("TriangulatedSurface",
                  "TIN Z(((60 50 0,84 50 0,84 66 0,60 50 0)),((60 50 0,84 66 0,60 66 0,60 50 0)))",
                  "a surface in space");
  return {
      drops("NullShape", "", "no geometry"),
      drops("EmptyPolygon", "POLYGON EMPTY", "an empty geometry"),
      drops("EmptyCollection", "GEOMETRYCOLLECTION EMPTY", "empty"),
      drops("Point", "POINT(72 58)", "a point, not a polygon"),
      drops("Line", "LINESTRING(60 50,84 50,84 66,60 66,60 50)", "a line, not a polygon"),
      tin,
      drops("TwoVertices", "POLYGON((60 50,84 66,60 50))", "fewer than three vertices"),
      drops("OneVertexManyTimes", "POLYGON((60 50,60 50,60 50,60 50))", "three vertices"),
      drops("AllOnALine", "POLYGON((60 50,70 50,84 50,60 50))", "zero area"),
      drops("ThereAndBack", "POLYGON((60 50,84 50,84 66,84 50,60 50))", "zero area"),
      drops("Coordinate1e300", "POLYGON((60 50,84 50,1e300 66,60 66,60 50))", "beyond 1e9 m"),
      drops("Coordinate1e12", "POLYGON((60 50,84 50,84 -1e12,60 66,60 50))", "beyond 1e9 m"),
      {"PolygonZM", "POLYGON ZM((60 50 3 1,84 50 4 2,84 66 5 3,60 66 -1e99 4,60 50 3 1))"},
      {"PolygonZ", "POLYGON Z((60 50 3,84 50 1e300,84 66 -1,60 66 0,60 50 3))"},
      {"MultiSurface", "MULTISURFACE(CURVEPOLYGON((60 50,84 50,84 66,60 66,60 50)))"},
      {"CollectionInCollection",
       "GEOMETRYCOLLECTION(GEOMETRYCOLLECTION(MULTIPOLYGON(((60 50,84 50,84 66,60 66,60 50)))))"},
      collection,
      curve,
  };
}

const DefectCity& the_city() {
  static const DefectCity city = defect_city();
  return city;
}

/// One folder with the points and the undamaged city's result per process.
const TemporaryFolder& workshop() {
  static const TemporaryFolder folder;
  return folder;
}

const Outcome& undamaged() {
  static const Outcome outcome = [] {
    write_input(the_city(), sound_features(the_city()), workshop().path());
    Config config = small_config(the_city(), workshop().path());
    config.out = (workshop() / "undamaged").string();
    return build(config, ids_of(sound_features(the_city())));
  }();
  return outcome;
}

void expect_same_building(const Building* found, const Building* expected) {
  ASSERT_NE(found, nullptr);
  ASSERT_NE(expected, nullptr);
  EXPECT_EQ(found->footprint.outer, expected->footprint.outer);
  EXPECT_EQ(found->footprint.holes, expected->footprint.holes);
  EXPECT_EQ(found->source_ids, expected->source_ids);
  EXPECT_EQ(found->h_ground, expected->h_ground);
  EXPECT_EQ(found->h_roof, expected->h_roof);
  EXPECT_EQ(found->flags, expected->flags);
}

void expect_patient(const Row& row, const Outcome& outcome) {
  const Building* patient = outcome.building_of("patient");
  ASSERT_NE(patient, nullptr) << outcome.reason_of("patient");
  std::set<std::string> members{"patient"};
  members.insert(row.members.begin(), row.members.end());
  EXPECT_EQ(std::set<std::string>(patient->source_ids.begin(), patient->source_ids.end()), members);
  const auto flags = flag_names(patient->flags);
  std::set<std::string> found(flags.begin(), flags.end());
  // Whether joining buildings changes more than the place where they meet is a matter of taste.
  if (found.contains("merged")) found.insert("repaired");
  std::set<std::string> wanted = row.flags;
  if (wanted.contains("merged")) wanted.insert("repaired");
  EXPECT_EQ(found, wanted);
  if (row.within < kAny) {
    EXPECT_LE(outline_distance(patient->footprint, row.outline), row.within);
  }
  EXPECT_NEAR(area(patient->footprint), row.area == 0 ? area(row.outline) : row.area,
              row.area_within);
  const Building* sound = undamaged().building_of("patient");
  EXPECT_NEAR(patient->h_ground, sound->h_ground, 0.3);
  if (row.members.empty() && !row.flags.contains("no_roof_points")) {
    EXPECT_NEAR(patient->h_roof, sound->h_roof, 0.3);
  }
}

class FootprintDefect : public ::testing::TestWithParam<Row> {};

TEST_P(FootprintDefect, EndsAsTheTableSays) {
  const Row& row = GetParam();
  const Outcome& sound = undamaged();
  std::vector<Feature> features = with_patient(the_city(), row.patient);
  features.insert(features.end(), row.more.begin(), row.more.end());
  const std::filesystem::path folder = workshop() / row.name;
  std::filesystem::create_directory(folder);
  write_features(folder / "footprints.csv", features, the_city().origin);
  Config config = small_config(the_city(), folder);
  config.points = {(workshop() / "points.las").string()};
  const Outcome outcome = build(config, ids_of(features));
  ASSERT_EQ(outcome.error, "");
  if (!row.dropped.empty()) {
    EXPECT_EQ(outcome.building_of("patient"), nullptr);
    EXPECT_NE(outcome.reason_of("patient").find(row.dropped), std::string::npos)
        << outcome.reason_of("patient");
  } else {
    expect_patient(row, outcome);
  }
  std::set<std::string> dropped;
  for (const Dropped& entry : outcome.city.dropped) dropped.insert(entry.source_id);
  std::set<std::string> expected;
  if (!row.dropped.empty()) expected.insert("patient");
  for (const auto& [id, reason] : row.drops) {
    expected.insert(id);
    EXPECT_NE(outcome.reason_of(id).find(reason), std::string::npos) << outcome.reason_of(id);
  }
  EXPECT_EQ(dropped, expected);
  if (!row.warning.empty()) {
    EXPECT_TRUE(outcome.has_warning(row.warning));
  }
  for (const House& house : the_city().houses) {
    if (house.id == "patient" || row.name == "EveryBuildingTwice") continue;
    SCOPED_TRACE(house.id);
    expect_same_building(outcome.building_of(house.id), sound.building_of(house.id));
  }
}

std::string name_of(const ::testing::TestParamInfo<Row>& info) { return info.param.name; }

/// For defects that are not the patient's: all of the city's features, and more.
Outcome build_in(const std::string& name, const std::vector<Feature>& features,
                 const std::vector<std::string>& ids) {
  undamaged();
  const std::filesystem::path folder = workshop() / name;
  std::filesystem::create_directory(folder);
  write_features(folder / "footprints.csv", features, the_city().origin);
  Config config = small_config(the_city(), folder);
  config.points = {(workshop() / "points.las").string()};
  return build(config, ids);
}

TEST(FootprintDefects, ABuildingAsLargeAsTheDomainTakesInAllAndIsCutBack) {
  std::vector<Feature> features = sound_features(the_city());
  features.push_back({"all", wkt(box(0, 0, 160, 120))});
  const Outcome outcome = build_in("giant", features, ids_of(features));
  ASSERT_EQ(outcome.error, "");
  ASSERT_EQ(outcome.city.buildings.size(), 1U);
  const Building& building = outcome.city.buildings[0];
  EXPECT_EQ(building.flags & (kMerged | kClipped), kMerged | kClipped);
  EXPECT_EQ(building.source_ids.size(), 7U);
  EXPECT_NEAR(area(building.footprint), 158 * 118, 1);
  EXPECT_TRUE(outcome.has_warning("building_covers_domain"));
  EXPECT_FALSE(undamaged().has_warning("building_covers_domain"));
}

TEST(FootprintDefects, PartsOfAMultipolygonAreAccountedForOneByOne) {
  const Outcome outcome = build_in(
      "parts",
      with_patient(the_city(),
                   "MULTIPOLYGON(((60 50,70 50,70 66,60 66,60 50)),((73 50,84 50,84 66,73 66,73 "
                   "50)),((90 50,91 51,90 50)),((500 500,520 500,520 520,500 500)))"),
      {"west", "east", "north", "tower", "shed", "patient", "patient#2", "patient#3", "patient#4"});
  ASSERT_EQ(outcome.error, "");
  EXPECT_NEAR(area(outcome.building_of("patient")->footprint), 160, 0.01);
  EXPECT_NEAR(area(outcome.building_of("patient#2")->footprint), 176, 0.01);
  EXPECT_EQ(outcome.reason_of("patient#3"), "a polygon of fewer than three vertices");
  EXPECT_EQ(outcome.reason_of("patient#4"), "outside the domain");
}

TEST(FootprintDefects, NothingUsableIsAnError) {
  const Outcome lines = build_in("lines", {{"a", "LINESTRING(60 50,84 50,84 66,60 50)"}}, {"a"});
  EXPECT_EQ(lines.exit_code, 3);
  EXPECT_NE(lines.error.find("feature a: a line, not a polygon"), std::string::npos) << lines.error;
  const Outcome flat = build_in("flat", {{"a", "POLYGON((60 50,70 50,84 50,60 50))"}}, {"a"});
  EXPECT_EQ(flat.exit_code, 3);
  EXPECT_NE(flat.error.find("no usable footprint"), std::string::npos) << flat.error;
  const Outcome specks = build_in("specks", {{"a", wkt(box(60, 50, 60.02, 50.02))}}, {"a"});
  EXPECT_EQ(specks.exit_code, 3);
  EXPECT_NE(specks.error.find("--terrain-only"), std::string::npos) << specks.error;
}

INSTANTIATE_TEST_SUITE_P(Rings, FootprintDefect, ::testing::ValuesIn(rings()), name_of);
INSTANTIATE_TEST_SUITE_P(Holes, FootprintDefect, ::testing::ValuesIn(holes()), name_of);
INSTANTIATE_TEST_SUITE_P(Neighbours, FootprintDefect, ::testing::ValuesIn(neighbours()), name_of);
INSTANTIATE_TEST_SUITE_P(Geometries, FootprintDefect, ::testing::ValuesIn(geometries()), name_of);

}  // namespace
}  // namespace tetropolis::testing

// Footprints as they come: one defect at a time in a small city, through the whole pipeline. Each
// row says what must become of it; that the other buildings stay exactly as they are without the
// defect, and that every guarantee holds, is asked of all.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
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

const Polygon kPatient = rectangle(60, 50, 84, 66);

/// One defect and what becomes of it: without further words, the patient as if nothing were wrong.
struct Row {
  std::string name;
  std::string patient;  ///< WKT.
  std::vector<Feature> more = {};

  Polygon outline = kPatient;  ///< Of the patient's building,
  double within = kStep;       ///< so far off at most,
  double area = 0;             ///< of this area (0: that of `outline`),
  double area_within = 0.5;    ///< so much off at most, square metres.
  std::set<std::string> flags = {};
  std::vector<std::string> members = {};  ///< Beside the patient.
  std::string dropped = "";  ///< Or the patient is dropped for a reason that says this.
  std::map<std::string, std::string> drops = {};  ///< Others dropped, and why.
  std::string warning = "";                       ///< Code of a warning of the report.

  /// Flagged as repaired; the outline is so far off at most.
  Row& repaired(double off = kStep) {
    flags.insert("repaired");
    within = off;
    return *this;
  }
  /// Off by so much at most, which is no repair.
  Row& tidied(double off) {
    within = off;
    return *this;
  }
  Row& is(const Polygon& polygon, double off = kStep) {
    outline = polygon;
    within = off;
    return *this;
  }
  /// Any outline of this area, or that of `outline`.
  Row& covers(double square_metres, double off) {
    within = square_metres == 0 ? within : kAny;
    area = square_metres;
    area_within = off;
    return *this;
  }
  Row& flag(const std::string& name_of_flag) {
    flags.insert(name_of_flag);
    return *this;
  }
  /// There are these features too, and they stay by themselves.
  Row& beside(const std::vector<Feature>& features) {
    more = features;
    return *this;
  }
  /// There are these features too, and all become one building.
  Row& with(const std::vector<Feature>& features) {
    more = features;
    for (const Feature& feature : features) members.push_back(feature.id);
    return flag("merged");
  }
  Row& without(const std::string& id, const std::string& reason) {
    drops[id] = reason;
    return *this;
  }
  Row& warns(const std::string& code) {
    warning = code;
    return *this;
  }
};

Row row(const std::string& name, const std::string& patient) { return {name, patient}; }

Row drop(const std::string& name, const std::string& patient, const std::string& reason) {
  Row result{name, patient};
  result.dropped = reason;
  return result;
}

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
        squares.push_back({fmt::format("c{}{}", i, j),
                           wkt(rectangle(60 + 4 * i, 50 + 4 * j, 64 + 4 * i, 54 + 4 * j))});
  return squares;
}

std::vector<Feature> shifted_copies(int n, double step) {
  std::vector<Feature> copies;
  for (int i = 1; i <= n; ++i)
    copies.push_back({fmt::format("copy{}", i),
                      wkt(rectangle(60 + step * i, 50 - step * i, 84 + step * i, 66 - step * i))});
  return copies;
}

std::vector<Row> rings() {
  Polygon clockwise = kPatient;
  std::reverse(clockwise.outer.begin(), clockwise.outer.end());
  const Polygon court{kPatient.outer, {{{68, 54}, {68, 62}, {76, 62}, {76, 54}}}};
  return {
      row("Sound", wkt(kPatient)),
      row("Unclosed", open_wkt(kPatient)),
      row("Clockwise", wkt(clockwise)),
      row("ClockwiseAndUnclosed", open_wkt(clockwise)),
      row("ClosedThrice", "POLYGON((60 50,84 50,84 66,60 66,60 50,60 50,60 50))"),
      row("DuplicateVertices", "POLYGON((60 50,60 50,84 50,84 50,84 50,84 66,60 66,60 66,60 50))"),
      row("NearDuplicateVertices",
          "POLYGON((60 50,60.0004 50,84 50,84.0002 50.0003,84 66,60 66,59.9999 65.9999,60 50))")
          .is(kPatient, 0.001),
      row("VerticesOnWalls", "POLYGON((60 50,70 50,71 50,84 50,84 58,84 66,72 66,60 66,60 50))"),
      row("TheSameRingTwiceInOne",
          "POLYGON((60 50,84 50,84 66,60 66,60 50,84 50,84 66,60 66,60 50))")
          .repaired(),
      row("SpikeOfZeroWidthOutwards", "POLYGON((60 50,84 50,84 58,91 58,84 58,84 66,60 66,60 50))"),
      row("SpikeOfZeroWidthInwards", "POLYGON((60 50,84 50,84 58,70 58,84 58,84 66,60 66,60 50))"),
      row("SpikeAtTheSeam", "POLYGON((55 50,60 50,84 50,84 66,60 66,60 50,55 50))"),
      row("SpikeOfACentimetre", "POLYGON((60 50,84 50,84 58,91 58,84 58.01,84 66,60 66,60 50))")
          .repaired(0.02),
      row("CutOfACentimetre", "POLYGON((60 50,84 50,84 58,70 58,84 58.01,84 66,60 66,60 50))")
          .tidied(0.02),
      row("SawOfTwoCentimetres", saw(0.02, 0.3)).repaired(0.1).covers(0, 2),
      row("SawOfHalfAMetre", saw(0.5, 0.5)).repaired(0.75).covers(0, 16),
      row("NeedleOfHalfADegree", "POLYGON((60 50,84 50,84 57.9,107 58,84 58.1,84 66,60 66,60 50))")
          .repaired(2.1)  // the root of the needle stays as a stub a metre wide
          .covers(0, 4),
      drop("NothingButANeedleOfHalfADegree", "POLYGON((60 58,100 58,100 58.35,60 58))", "narrow"),
      row("BowTieOfTwoTriangles", "POLYGON((60 50,84 66,84 50,60 66,60 50))")
          .repaired()
          .covers(192, 4),
      row("BowTieOfTwoNeighbouringVertices",
          "POLYGON((60 50,84 50,84 66,61 66,61.3 66.2,60 66,60 50))")
          .repaired(0.5)
          .covers(0, 1),
      row("LoopAtACorner", "POLYGON((60 50,84 50,84 66,86 66,86 68,83.9 65.9,60 66,60 50))")
          .repaired()
          .covers(386, 3),
      row("KeyholeInsteadOfAHole",
          "POLYGON((60 50,84 50,84 66,60 66,60 58,68 58,68 62,76 62,76 54,68 54,68 58,60 58,60 "
          "50))")
          .repaired()
          .is(court),
      row("SecondPartOnALine",
          "POLYGON((60 50,84 50,84 58,90 58,90 54,94 54,94 62,90 62,90 58,84 58,84 66,60 66,60 "
          "50))")
          .repaired()
          .warns("parts_lost"),
      row("CircleOf4000Vertices", circle({72, 58}, 8, 4000)).repaired().covers(201, 6),
  };
}

std::vector<Row> holes() {
  const Polygon court{kPatient.outer, {{{68, 54}, {68, 62}, {76, 62}, {76, 54}}}};
  const auto notched = [](double x) {
    return Polygon{{{60, 50}, {84, 50}, {84, 54}, {x, 54}, {x, 62}, {84, 62}, {84, 66}, {60, 66}},
                   {}};
  };
  return {
      row("HoleCounterClockwise", with_hole({{68, 54}, {76, 54}, {76, 62}, {68, 62}})).is(court),
      row("HoleOutside", with_hole(rectangle(90, 54, 96, 62).outer)).repaired(),
      row("HoleFarOutside", with_hole(rectangle(-5000, 54, -4990, 62).outer)).repaired(),
      row("HoleOutsideTouching", with_hole(rectangle(84, 54, 92, 62).outer)).repaired(),
      row("HoleEqualToTheShell", with_hole(kPatient.outer)).repaired(),
      row("HoleAroundTheShell", with_hole(rectangle(58, 48, 86, 68).outer)).repaired(),
      row("HoleTwice", wkt({kPatient.outer, {court.holes[0], court.holes[0]}}))
          .repaired()
          .is(court),
      row("HoleInAHole", wkt({kPatient.outer, {court.holes[0], rectangle(70, 56, 74, 60).outer}}))
          .repaired()
          .is(court),
      row("OverlappingHoles",
          wkt({kPatient.outer, {rectangle(66, 54, 72, 62).outer, rectangle(70, 54, 78, 62).outer}}))
          .repaired()
          .is({kPatient.outer, {rectangle(66, 54, 78, 62).outer}}),
      row("HoleAcrossTheShell", with_hole(rectangle(78, 54, 90, 62).outer))
          .repaired()
          .is(notched(78)),
      row("HoleSharingAnEdge", with_hole(rectangle(76, 54, 84, 62).outer))
          .repaired()
          .is(notched(76)),
      row("HoleTouchingAtAVertex", with_hole({{84, 58}, {76, 54}, {70, 58}, {76, 62}}))
          .repaired()
          .covers(384 - 56, 3),
      row("HoleOfTwoVertices", "POLYGON((60 50,84 50,84 66,60 66,60 50),(70 55,72 57,70 55))"),
      row("HoleOfZeroArea", "POLYGON((60 50,84 50,84 66,60 66,60 50),(70 55,72 57,71 56,70 55))"),
      // Three walls of one metre and one of 5 cm, which cannot stay.
      row("WallOfFiveCentimetres", with_hole(rectangle(61, 51, 83, 65.95).outer))
          .repaired()
          .covers(384 - 22 * 14.95, 26),
      row("BuildingInACourtyard", wkt(court))
          .beside({{"inner", wkt(rectangle(70, 56, 74, 60))}})
          .is(court),
      row("BuildingThatFillsTheCourtyard", wkt(court))
          .with({{"inner", wkt(rectangle(68, 54, 76, 62))}}),
      row("BuildingThatFillsTheCourtyardButForACentimetre", wkt(court))
          .with({{"inner", wkt(rectangle(68.01, 54.01, 75.99, 61.99))}}),
      // Without roof points: the scan knows no courtyard there.
      row("CourtyardsWithinCourtyards",
          wkt({rectangle(56, 46, 88, 72).outer, {rectangle(59, 49, 85, 69).outer}}))
          .beside({{"second",
                    wkt({rectangle(62, 52, 82, 66).outer, {rectangle(65, 55, 79, 63).outer}})},
                   {"third", wkt(rectangle(68, 57, 76, 61))}})
          .is({rectangle(56, 46, 88, 72).outer, {rectangle(59, 49, 85, 69).outer}})
          .flag("no_roof_points"),
  };
}

std::vector<Row> neighbours() {
  const auto patient = [](const char* name) { return row(name, wkt(kPatient)); };
  const DefectCity city = defect_city();
  std::vector<Feature> twice;
  for (const House& house : city.houses)
    if (house.id != "patient") twice.push_back({house.id + "2", wkt(house.footprint)});
  const Polygon both = rectangle(60, 50, 94, 66);
  Row every = patient("EveryBuildingTwice").with({{"patient2", wkt(kPatient)}});
  every.more.insert(every.more.end(), twice.begin(), twice.end());
  return {
      every,
      patient("WallOffByAMicrometre")
          .with({{"next", "POLYGON((84.000001 50,94 50,94 66,84.000001 66,84.000001 50))"}})
          .is(both),
      patient("WallOverlappingByAMicrometre")
          .with({{"next", "POLYGON((83.999999 50,94 50,94 66,83.999999 66,83.999999 50))"}})
          .is(both),
      patient("TJunctionOffByAMicrometre")
          .with({{"next", "POLYGON((84.000001 54,94 54,94 58,84 58,84.000001 54))"},
                 {"nextnext", "POLYGON((84 58.000001,94 58,94 62,83.999999 62,84 58.000001))"}})
          .is({{{60, 50}, {84, 50}, {84, 54}, {94, 54}, {94, 62}, {84, 62}, {84, 66}, {60, 66}},
               {}}),
      patient("CrackOfACentimetre").with({{"next", wkt(rectangle(84.01, 50, 94, 66))}}).is(both),
      patient("CrackThatNarrowsToNothing")
          .with({{"next", "POLYGON((84.02 50,94 50,94 66,84 66,84.02 50))"}})
          .is(both, 0.02),
      patient("GapOfHalfAMetre").with({{"next", wkt(rectangle(84.5, 50, 94, 66))}}).is(both),
      patient("CornersThatTouch")
          .with({{"next", wkt(rectangle(84, 66, 94, 72))}})
          .covers(384 + 60, 3),
      patient("ShedOfTwoCentimetresAtTheWall")
          .with({{"speck", wkt(rectangle(84, 57, 84.02, 57.02))}})
          .is(kPatient, 0.03),
      patient("ShedOfTwoCentimetres")
          .beside({{"speck", wkt(rectangle(95, 57, 95.02, 57.02))}})
          .without("speck", "small"),
      patient("FreeWallOfFiveCentimetres")
          .beside({{"fence", wkt(rectangle(90, 45, 90.05, 72))}})
          .without("fence", "small"),
      patient("WallOfFiveCentimetresBetweenBuildings")
          .with({{"wall", wkt(rectangle(84, 57.5, 94, 57.55))},
                 {"next", wkt(rectangle(94, 50, 104, 66))}})
          .covers(384 + 160 + 11, 4),  // the wall has become 1.1 m wide
      patient("LargerThanTheDomain")
          .beside({{"all", wkt(rectangle(-100, -100, 300, 300))}})
          .without("all", "crosses the domain boundary"),
      patient("MassiveOverlaps").with(shifted_copies(30, 0.1)).covers(384 + 40 * 3, 6),
      patient("BuildingOnTheRoofOfAnother").with({{"penthouse", wkt(rectangle(66, 54, 70, 60))}}),
      row("Checkerboard", wkt(rectangle(60, 50, 64, 54))).with(checkerboard()).covers(160, 25),
  };
}

std::vector<Row> geometries() {
  return {
      drop("NullShape", "", "no geometry"),
      drop("EmptyPolygon", "POLYGON EMPTY", "an empty geometry"),
      drop("EmptyCollection", "GEOMETRYCOLLECTION EMPTY", "empty"),
      drop("Point", "POINT(72 58)", "a point, not a polygon"),
      drop("Line", "LINESTRING(60 50,84 50,84 66,60 66)", "a line, not a polygon"),
      row("TriangulatedSurface",
          "TIN Z(((60 50 0,84 50 0,84 66 0,60 50 0)),((60 50 0,84 66 0,60 66 0,60 50 0)))"),
      row("Body",
          "MULTIPOLYGON Z(((60 50 0,60 66 0,84 66 0,84 50 0,60 50 0)),"
          "((59.5 49.5 9,84.5 49.5 9,84.5 66.5 9,59.5 66.5 9,59.5 49.5 9)),"
          "((60 50 0,84 50 0,84 50 9,60 50 9,60 50 0)),((84 50 0,84 66 0,84 66 9,84 50 9,"
          "84 50 0)),((84 66 0,60 66 0,60 66 9,84 66 9,84 66 0)),((60 66 0,60 50 0,60 50 9,"
          "60 66 9,60 66 0)))"),
      row("BodyWithoutGround",
          "POLYHEDRALSURFACE Z(((60 50 9,72 50 9,72 66 9,60 66 9,60 50 9)),"
          "((72 50 6,84 50 6,84 66 6,72 66 6,72 50 6)))"),
      drop("WallsOnly", "POLYHEDRALSURFACE Z(((60 50 0,84 50 0,84 50 9,60 50 9,60 50 0)))",
           "no face that could be a footprint"),
      drop("TwoVertices", "POLYGON((60 50,84 66,60 50))", "fewer than three vertices"),
      drop("OneVertexManyTimes", "POLYGON((60 50,60 50,60 50,60 50))", "three vertices"),
      drop("AllOnALine", "POLYGON((60 50,70 50,84 50,60 50))", "zero area"),
      drop("ThereAndBack", "POLYGON((60 50,84 50,84 66,84 50,60 50))", "zero area"),
      drop("Coordinate1e300", "POLYGON((60 50,84 50,1e300 66,60 66,60 50))", "beyond 1e9 m"),
      drop("Coordinates1e308", "POLYGON((1e308 -1e308,-1e308 1e308,60 5e307,1e308 -1e308))",
           "beyond 1e9 m"),
      drop("Coordinate1e12", "POLYGON((60 50,84 50,84 -1e12,60 66,60 50))", "beyond 1e9 m"),
      row("PolygonZM", "POLYGON ZM((60 50 3 1,84 50 4 2,84 66 5 3,60 66 -1e99 4,60 50 3 1))"),
      row("PolygonZ", "POLYGON Z((60 50 3,84 50 1e300,84 66 -1,60 66 0,60 50 3))"),
      row("MultiSurface", "MULTISURFACE(CURVEPOLYGON((60 50,84 50,84 66,60 66,60 50)))"),
      row("CollectionInCollection",
          "GEOMETRYCOLLECTION(GEOMETRYCOLLECTION(MULTIPOLYGON(((60 50,84 50,84 66,60 66,60 "
          "50)))))"),
      row("CollectionWithPointsAndLines",
          "GEOMETRYCOLLECTION(POINT(72 58),POLYGON((60 50,84 50,84 66,60 66,60 50)),"
          "LINESTRING(60 50,84 66))")
          .warns("mixed_geometry"),
      row("CurvePolygon",
          "CURVEPOLYGON(COMPOUNDCURVE((60 50,84 50),CIRCULARSTRING(84 50,92 58,84 66),(84 66,60 "
          "66,60 50)))")
          .repaired()
          .covers(384 + 32 * std::numbers::pi, 1.5),
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

class DefectiveFootprint : public ::testing::TestWithParam<Row> {};

TEST_P(DefectiveFootprint, EndsAsTheTableSays) {
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
    if (house.id == "patient") continue;
    SCOPED_TRACE(house.id);
    if (row.name == "EveryBuildingTwice") {
      const Building* both = outcome.building_of(house.id);
      EXPECT_EQ(both, outcome.building_of(house.id + "2"));
      EXPECT_LE(outline_distance(both->footprint, house.footprint), kStep);
      EXPECT_EQ(both->h_roof, sound.building_of(house.id)->h_roof);
      continue;
    }
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
  features.push_back({"all", wkt(rectangle(0, 0, 160, 120))});
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

TEST(FootprintDefects, AFootprintThatLosesMostOfItsAreaIsNamed) {
  // Thirteen rays of 9 m around a body with a radius of 2.5 m.
  std::string ring;
  for (int k = 0; k < 26; ++k) {
    const double r = k % 2 == 0 ? 11.5 : 2.5, angle = k * std::numbers::pi / 13;
    ring += fmt::format("{} {},", 72 + r * std::cos(angle), 58 + r * std::sin(angle));
  }
  const std::vector<Feature> features =
      with_patient(the_city(), fmt::format("POLYGON(({}83.5 58))", ring));
  const Outcome outcome = build_in("comb", features, ids_of(features));
  ASSERT_EQ(outcome.error, "");
  const Building* patient = outcome.building_of("patient");
  ASSERT_NE(patient, nullptr);
  EXPECT_LT(area(patient->footprint), 0.5 * 13 * 11.5 * 2.5 * std::sin(std::numbers::pi / 13));
  const auto warning =
      std::find_if(outcome.report.warnings.begin(), outcome.report.warnings.end(),
                   [](const Warning& entry) { return entry.code == "footprint_mostly_lost"; });
  ASSERT_NE(warning, outcome.report.warnings.end());
  EXPECT_EQ(warning->count, 1);
  EXPECT_NE(warning->message.find("feature patient,"), std::string::npos) << warning->message;
  EXPECT_FALSE(undamaged().has_warning("footprint_mostly_lost"));
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
  const Outcome lines = build_in("lines", {{"a", "LINESTRING(60 50,84 50,84 66)"}}, {"a"});
  EXPECT_EQ(lines.exit_code, 3);
  EXPECT_NE(lines.error.find("feature a: a line, not a polygon"), std::string::npos) << lines.error;
  const Outcome flat = build_in("flat", {{"a", "POLYGON((60 50,70 50,84 50,60 50))"}}, {"a"});
  EXPECT_EQ(flat.exit_code, 3);
  EXPECT_NE(flat.error.find("no usable footprint"), std::string::npos) << flat.error;
  const Outcome specks = build_in("specks", {{"a", wkt(rectangle(60, 50, 60.02, 50.02))}}, {"a"});
  EXPECT_EQ(specks.exit_code, 3);
  EXPECT_NE(specks.error.find("terrain_only"), std::string::npos) << specks.error;
}

INSTANTIATE_TEST_SUITE_P(Rings, DefectiveFootprint, ::testing::ValuesIn(rings()), name_of);
INSTANTIATE_TEST_SUITE_P(Holes, DefectiveFootprint, ::testing::ValuesIn(holes()), name_of);
INSTANTIATE_TEST_SUITE_P(Neighbours, DefectiveFootprint, ::testing::ValuesIn(neighbours()),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Geometries, DefectiveFootprint, ::testing::ValuesIn(geometries()),
                         name_of);

}  // namespace
}  // namespace tetropolis::testing

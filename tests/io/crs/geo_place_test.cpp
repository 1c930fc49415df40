#include "tetropolis/io/crs/geo_place.h"

#include <cmath>

#include <gtest/gtest.h>

namespace tetropolis {
namespace {

/// Of churches, by other maps.
TEST(GeoPlace, IsWhereTheOtherMapsHaveIt) {
  struct Known {
    const char* crs;
    Point2 at;
    double longitude, latitude;
    const char* area;
  };
  for (const Known& known :
       {Known{"EPSG:28992", {155000, 463000}, 5.38764, 52.15616, "Netherlands"},  // Amersfoort
        Known{"EPSG:3006", {319180, 6399500}, 11.965, 57.705, "Sweden"},
        Known{"EPSG:27700", {530000, 180400}, -0.1284, 51.507, "United Kingdom (UK)"},
        Known{"EPSG:25832", {500000, 5540000}, 9, 50.01, "Europe"},
        Known{"EPSG:32632", {500000, 5540000}, 9, 50.01, ""},
        Known{"EPSG:2056", {2600000, 1200000}, 7.4386, 46.9511, "Liechtenstein; Switzerland"},
        Known{"EPSG:5514", {-743100, -1043500}, 14.4213, 50.0800, "Czechia; Slovakia"},
        Known{"EPSG:3857", {0, 0}, 0, 0, ""}}) {
    SCOPED_TRACE(known.crs);
    const auto place = place_of(known.crs, known.at);
    ASSERT_TRUE(place);
    EXPECT_NEAR(place->longitude, known.longitude, 0.01);
    EXPECT_NEAR(place->latitude, known.latitude, 0.01);
    EXPECT_EQ(place->area, known.area);
    EXPECT_TRUE(place->is_in_area);
  }
}

TEST(GeoPlace, SystemsAreMadeForAnArea) {
  EXPECT_FALSE(place_of("EPSG:28992", Point2{600000, 5000})->is_in_area);  // in Germany
  EXPECT_FALSE(place_of("EPSG:3006", Point2{85000, 447000})->is_in_area);
}

TEST(GeoPlace, IsNoneWithoutASystemOrBeyondIt) {
  EXPECT_FALSE(place_of("", Point2{1, 2}));
  EXPECT_FALSE(place_of("EPSG:32632", Point2{1e30, 1e30}));
}

TEST(GeoPlace, IsTheMiddleOfABox) {
  const auto middle = place_of("EPSG:28992", Point2{85000, 447000});
  const auto place = place_of("EPSG:28992", Bounds2{84900, 446800, 85100, 447200});
  ASSERT_TRUE(middle && place);
  EXPECT_EQ(place->longitude, middle->longitude);
  EXPECT_EQ(place->latitude, middle->latitude);
}

TEST(GeoPlace, TextsHaveNoSigns) {
  EXPECT_EQ(place_text({4.35712, 52.01163, "Netherlands", true}),
            "52.0116 N, 4.3571 E (Netherlands)");
  EXPECT_EQ(place_text({-70.66, -33.45, "", true}), "33.4500 S, 70.6600 W");
}

}  // namespace
}  // namespace tetropolis

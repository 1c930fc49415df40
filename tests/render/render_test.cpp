#include "tetropolis/render/render.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"
#include "tetropolis/core/threads.h"

#include "render/section.h"
#include "render/volume_surface.h"
#include "support/errors.h"
#include "support/test_data.h"
#include "terraced_city.h"

namespace tetropolis {
namespace {

RenderInput input() {
  std::mt19937 random(7);
  TetMesh mesh = testing::terraced_city(random).mesh;
  RenderInput input{surface_of(mesh), {}};
  input.volume = std::move(mesh);
  return input;
}

RenderOptions small(View view) {
  RenderOptions options;
  options.view = view;
  options.width = 240;
  options.height = 160;
  return options;
}

std::array<int, 3> pixel(const Picture& picture, double x, double y) {
  const auto at = [&](double share, int size) { return static_cast<int>(share * size); };
  const std::size_t first =
      3 * static_cast<std::size_t>(at(y, picture.height) * picture.width + at(x, picture.width));
  return {picture.rgb[first], picture.rgb[first + 1], picture.rgb[first + 2]};
}

/// Red as roofs are.
bool is_roof(const std::array<int, 3>& c) { return c[0] > c[1] + 30 && c[0] > c[2] + 30; }

TEST(Render, WallsOfVolumesAreOfTheBuildingsWhoseRoofsTheyTouch) {
  const RenderInput city = input();
  std::int64_t walls = 0;
  for (std::size_t f = 0; f < city.surface.triangles.size(); ++f) {
    if (city.surface.patch[f] != Patch::kWall) continue;
    ++walls;
    EXPECT_EQ(city.surface.building[f], BuildingIndex(0));
  }
  EXPECT_GT(walls, 0);
  // The heights of buildings need them.
  RenderOptions options = small(View::kCity);
  options.colour = PictureColour::kHeight;
  EXPECT_NE(render_picture(city, options).rgb, render_picture(city, small(View::kCity)).rgb);
}

TEST(Render, IsTheSameWithAnyThreads) {
  const RenderInput city = input();
  for (const View view : {View::kCity, View::kPlan, View::kSection}) {
    RenderOptions options = small(view);
    options.edges = true;
    const auto with = [&](int threads) {
      const ThreadLimit limit(threads);
      return render_picture(city, options);
    };
    const Picture one = with(1);
    EXPECT_EQ(one.rgb.size(), 240U * 160 * 3);
    EXPECT_EQ(one.rgb, with(2).rgb);
    EXPECT_EQ(one.rgb, with(5).rgb);
  }
}

TEST(Render, ItsPlaceInTheReferenceSystemIsNotSeen) {
  const RenderInput city = input();
  RenderInput far = city;
  for (auto* points : {&far.surface.points, &far.volume->points})
    for (Point3& p : *points) p = {p[0] + 85000, p[1] + 446000, p[2]};
  for (const View view : {View::kCity, View::kPlan, View::kSection}) {
    const Picture here = render_picture(city, small(view)),
                  there = render_picture(far, small(view));
    int different = 0;
    for (std::size_t i = 0; i < here.rgb.size(); ++i)
      different += std::abs(here.rgb[i] - there.rgb[i]) > 8 ? 1 : 0;
    EXPECT_LT(different, static_cast<int>(here.rgb.size() / 500));
  }
}

/// A square of ground of 40 m, and a flat roof in one of its corners.
RenderInput corner_roof(double x, double y) {
  SurfaceMesh surface;
  const auto square = [&](double x0, double y0, double side, double z, Patch patch) {
    const auto first = static_cast<std::int32_t>(surface.points.size());
    for (const auto& [dx, dy] : {std::pair{0.0, 0.0}, {side, 0.0}, {side, side}, {0.0, side}})
      surface.points.push_back({x0 + dx, y0 + dy, z});
    for (const std::array<std::int32_t, 3> t : {std::array<std::int32_t, 3>{0, 1, 2}, {0, 2, 3}}) {
      surface.triangles.push_back({first + t[0], first + t[1], first + t[2]});
      surface.patch.push_back(patch);
      surface.building.push_back(patch == Patch::kGround ? kNoBuilding : BuildingIndex(0));
    }
  };
  square(0, 0, 40, 0, Patch::kGround);
  square(x, y, 12, 0.5, Patch::kRoof);
  return {std::move(surface), {}};
}

TEST(Render, PlansHaveNorthAtTheTop) {
  const RenderInput north_east = corner_roof(26, 26);
  RenderOptions options = small(View::kPlan);
  options.height = 240;
  const Picture picture = render_picture(north_east, options);
  EXPECT_TRUE(is_roof(pixel(picture, 0.8, 0.2)));
  EXPECT_FALSE(is_roof(pixel(picture, 0.2, 0.2)));
  EXPECT_FALSE(is_roof(pixel(picture, 0.2, 0.75)));
  EXPECT_FALSE(is_roof(pixel(picture, 0.8, 0.75)));
}

TEST(Render, CitiesAreSeenInTheDirectionThatIsAskedFor) {
  const RenderInput north_east = corner_roof(26, 26);
  RenderOptions options = small(View::kCity);
  options.elevation = 80;
  const auto roof_is_right_and_up = [&](double azimuth) {
    options.azimuth = azimuth;
    const Picture picture = render_picture(north_east, options);
    double x = 0, y = 0, n = 0;
    for (int j = 0; j < 160; ++j)
      for (int i = 0; i < 240; ++i)
        if (is_roof(pixel(picture, (i + 0.5) / 240, (j + 0.5) / 160))) {
          x += i - 120;
          y += j - 80;
          ++n;
        }
    EXPECT_GT(n, 50);
    return std::pair(x > 0, y < 0);
  };
  EXPECT_EQ(roof_is_right_and_up(0), std::pair(true, true));    // looking north
  EXPECT_EQ(roof_is_right_and_up(90), std::pair(false, true));  // looking east, north is left
  EXPECT_EQ(roof_is_right_and_up(180), std::pair(false, false));
  EXPECT_EQ(roof_is_right_and_up(270), std::pair(true, false));
}

TEST(Render, SectionsShowBuildingsWhereTheLineCutsThem) {
  const RenderInput city = input();
  std::mt19937 random(7);
  const testing::TerracedCity fields = testing::terraced_city(random);
  RenderOptions options = small(View::kSection);
  options.width = 1200;
  options.height = 600;
  options.cut = cut_named("y=4.5");
  const Picture picture = render_picture(city, options);
  int painted = 0;
  for (std::size_t i = 0; i < picture.rgb.size(); i += 3)
    painted += picture.rgb[i] == 0xC2 && picture.rgb[i + 1] == 0x7A && picture.rgb[i + 2] == 0x63;
  const SectionWindow window = choose_section(city.surface, options.cut, 2);
  double built = 0;
  for (int i = 0; i < testing::TerracedCity::kWidth; ++i) {
    const double left = std::max(window.left + window.plane.through.x, double(i));
    const double right = std::min(window.right + window.plane.through.x, i + 1.0);
    built += std::max(0.0, right - left) * fields.height[static_cast<std::size_t>(i)][4];
  }
  ASSERT_GT(built, 2);
  const double scale = 1200 / (window.right - window.left);
  // The outline takes some of it.
  EXPECT_LT(painted, built * scale * scale);
  EXPECT_GT(painted, 0.93 * built * scale * scale);
}

std::string usage_error(const std::function<void()>& action) {
  return testing::error_of(action, ErrorKind::kUsage);
}

TEST(Render, OptionsOutOfTheirRangeAreNamed) {
  const RenderInput city = input();
  const auto message = [&](const std::function<void(RenderOptions&)>& change) {
    RenderOptions options = small(View::kCity);
    change(options);
    return usage_error([&] { render_picture(city, options); });
  };
  EXPECT_NE(message([](auto& o) { o.width = 15; }).find("width: 15"), std::string::npos);
  EXPECT_NE(message([](auto& o) { o.height = 10000; }).find("height: 10000"), std::string::npos);
  EXPECT_NE(message([](auto& o) { o.elevation = 0; }).find("elevation: 0"), std::string::npos);
  EXPECT_NE(message([](auto& o) { o.colour = PictureColour::kQuality; }).find("colour"),
            std::string::npos);
  EXPECT_NE(message([](auto& o) { o.cut = CutLine{}; }).find("cut"), std::string::npos);
  for (const char* text : {"", "z", "x=", "x=a", "y=1e999", "12 degrees"})
    EXPECT_NE(usage_error([&] { cut_named(text); }).find("cut: "), std::string::npos) << text;
}

TEST(Render, CutsAreNamedByTheirNormalOrTheirLine) {
  EXPECT_EQ(cut_named("x").azimuth, 0);
  EXPECT_EQ(cut_named("y").azimuth, 90);
  EXPECT_FALSE(cut_named("y").position);
  EXPECT_EQ(cut_named("x=-2.5").position, std::optional(-2.5));
  EXPECT_EQ(cut_named("33.5").azimuth, 33.5);
}

}  // namespace
}  // namespace tetropolis

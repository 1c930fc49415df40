// What a page holds. That it makes the same cells of it is tested where it does: viewer/test.
#include "tetropolis/io/page/page.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <zlib.h>

#include "tetropolis/core/threads.h"
#include "tetropolis/geometry/polygon.h"

#include "io/mesh/mesh_bytes.h"
#include "support/prism_city.h"

namespace tetropolis {
namespace {

using Json = nlohmann::json;

std::string from_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    const std::size_t digit = digits.find(c);
    if (digit == std::string::npos) throw std::runtime_error("no base64");
    bits = bits << 6U | static_cast<std::uint32_t>(digit);
    if ((count += 6) < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 255U);
  }
  return bytes;
}

/// The blocks of a page.
struct Page {
  Json blocks;

  explicit Page(const std::string& html) {
    const std::string begin = "<script id=\"run\" type=\"application/json\">";
    const std::size_t from = html.find(begin) + begin.size();
    blocks = Json::parse(html.substr(from, html.find("</script>", from) - from));
  }
  std::string bytes(const char* name) const {
    const std::string packed = from_base64(blocks.at(name).get<std::string>());
    std::string bytes(1 << 24, '\0');
    uLongf size = bytes.size();
    if (uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size,
                   reinterpret_cast<const Bytef*>(packed.data()), packed.size()) != Z_OK)
      throw std::runtime_error("no zlib");
    bytes.resize(size);
    return bytes;
  }
  std::vector<std::int32_t> numbers(const char* name) const {
    const std::string all = bytes(name);
    std::vector<std::int32_t> values(all.size() / 4);
    for (std::size_t i = 0; i < values.size(); ++i) {
      std::uint32_t zigzag = 0;
      for (std::size_t b = 0; b < 4; ++b)
        zigzag |= static_cast<std::uint32_t>(static_cast<unsigned char>(all[b * values.size() + i]))
                  << 8 * b;
      values[i] = static_cast<std::int32_t>(zigzag >> 1U ^ (0U - (zigzag & 1U)));
    }
    return values;
  }
  Json facts() const { return Json::parse(bytes("facts")); }
};

CityModel model_of(const testing::SmallCity& small) {
  CityModel model;
  model.domain = small.domain;
  model.origin = {85000, 446000};
  model.crs = "EPSG:28992";
  for (std::size_t b = 0; b < small.footprints.size(); ++b) {
    Building building;
    building.id = "b" + std::to_string(b);
    building.source_ids = {"</script> \"" + std::to_string(b) + "\" <!--"};
    building.footprint = small.footprints[b];
    building.h_roof = small.roofs[b];
    building.flags = kMerged | kRepaired;
    model.buildings.push_back(building);
  }
  return model;
}

struct Case {
  testing::SmallCity small = testing::small_city(testing::hills);
  ColumnMesh mesh = testing::meshed(small).mesh;
  CityModel city = model_of(small);
};

TEST(Page, TellsTheHighestRoofAndTheOutlineOfTheDomain) {
  Case c;
  Building& building = c.city.buildings[BuildingIndex(0)];
  RoofPart part;
  part.outline = building.footprint;
  const Bounds2 box = bounds(building.footprint);
  part.roof = {{box.xmin, box.ymin}, building.h_roof - 1, 3 / box.width(), 0};
  building.parts = {part};
  const Json facts = Page(page_html({.city = c.city})).facts();
  EXPECT_NEAR(facts["buildings"][0]["top"], building.h_roof + 2, 0.01);
  EXPECT_NEAR(facts["buildings"][0]["roof"], building.h_roof, 0.01);
  EXPECT_EQ(facts["buildings"][1]["top"], facts["buildings"][1]["roof"]);
  const Ring corners = c.city.domain.outline().outer;
  ASSERT_EQ(facts["outline"].size(), 2 * corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    EXPECT_NEAR(facts["outline"][2 * i], corners[i].x, 0.01);
    EXPECT_NEAR(facts["outline"][2 * i + 1], corners[i].y, 0.01);
  }
}

TEST(Page, HoldsTheMeshAndTheCity) {
  const Case c;
  const PageMesh shown = page_mesh(c.mesh);
  const PageFootprint dropped{"x1", testing::rectangle(1, 1, 2, 2), kNoBuilding, "too small"};
  const Page page(page_html({.city = c.city,
                             .mesh = &shown,
                             .footprints = {&dropped, 1},
                             .dropped = {{"too small", 1}},
                             .report = R"({"version": "1"})",
                             .repeat = "tetropolis build"}));
  const Json facts = page.facts();
  EXPECT_EQ(facts["cells"], cell_offsets(c.mesh).back().value());
  EXPECT_EQ(facts["mesh"], true);
  EXPECT_EQ(facts["volume"], true);
  EXPECT_EQ(facts["report"]["version"], "1");
  EXPECT_EQ(facts["repeat"], "tetropolis build");
  EXPECT_EQ(facts["dropped"]["too small"], 1);
  EXPECT_EQ(facts["footprints"][0]["reason"], "too small");
  EXPECT_EQ(facts["buildings"][3]["sources"], Json::array({"</script> \"3\" <!--"}));
  EXPECT_EQ(facts["buildings"][3]["flags"], Json::array({"merged", "repaired"}));
  EXPECT_EQ(facts["domain"], Json::array({0, 0, 120, 90}));

  EXPECT_EQ(page.numbers("z").size(), c.mesh.z.size());
  EXPECT_EQ(page.numbers("corners").size(), 3 * c.mesh.triangle_count());
  const std::vector<std::int32_t> xs = page.numbers("x"), after = page.numbers("afterX");
  std::int32_t x = 0;
  ASSERT_EQ(xs.size(), c.mesh.vertex_count());
  for (std::size_t v = 0; v < xs.size(); ++v)
    ASSERT_NEAR((x += xs[v]) * 0.001, c.mesh.ground.vertices[v].x, 0.0005001);
  EXPECT_EQ(after[0], 20000);
  EXPECT_EQ(after[1], 18000);
  EXPECT_EQ(page.numbers("beforeX"), (std::vector<std::int32_t>{1000, 1000, 0, -1000}));
}

TEST(Page, HoldsPrisms) {
  const testing::SmallCity small = testing::small_city(testing::hills);
  const CityModel city = model_of(small);
  const LayerHeights heights{4, 0.5, 1.2};
  for (const bool whole : {false, true}) {
    const ColumnMesh mesh = whole ? testing::city_of_prisms(small, 8, heights).mesh
                                  : testing::prism_city(small, 8, heights).mesh;
    const PageMesh shown = page_mesh(mesh);
    const Page page(page_html({.city = city, .mesh = &shown}));
    EXPECT_EQ(page.facts()["cells"], cell_offsets(mesh).back().value() + mesh.layers.cells());
    EXPECT_EQ(page.facts()["layers"], 4);
    EXPECT_EQ(page.facts()["whole"], whole);
    const std::size_t above = mesh.upper.nodes();
    EXPECT_EQ(page.numbers("z").size() + above, static_cast<std::size_t>(mesh.node_count()));
    EXPECT_EQ(page.numbers("upperRise").size(), above);
    EXPECT_TRUE(!whole || page.numbers("odd").empty());
    // Of the first column, whose nodes are told as what they are off even ones by.
    const std::vector<std::int32_t> z = page.numbers("z");
    const VertexIndex corner(0);
    ASSERT_GE(mesh.layers.position[corner], 0);
    ASSERT_EQ(mesh.floors_at(corner).size(), 1U);
    const std::int64_t told = 4 + (whole ? mesh.top(corner) - mesh.first[corner] : 0);
    const std::int32_t end = z[static_cast<std::size_t>(told)], rise = whole ? end - z[0] : end;
    for (std::int64_t k = 0; k < 4; ++k) {
      const auto at = static_cast<std::size_t>(k);
      const double even = z[0] + static_cast<double>(rise * k) / static_cast<double>(told);
      const auto place = static_cast<std::size_t>(mesh.layers.position[corner]) * 4 + at;
      EXPECT_NEAR(0.001 * (even + (k > 0 ? z[at] : 0)), mesh.layers.z[place], 0.0026);
    }
  }
}

TEST(Page, LeavesOutTheVolumeBeyondItsBudget) {
  const Case c;
  const std::int64_t cells = cell_offsets(c.mesh).back().value();
  const PageMesh within = page_mesh(c.mesh, cells), beyond = page_mesh(c.mesh, cells - 1);
  EXPECT_EQ(Page(page_html({.city = c.city, .mesh = &within})).facts()["volume"], true);
  const Page page(page_html({.city = c.city, .mesh = &beyond}));
  EXPECT_EQ(page.facts()["volume"], false);
  EXPECT_EQ(page.facts()["cells"], cells);
  // A node for each different floor of each vertex is left.
  std::size_t floors = 0;
  for (const VertexIndex v : c.mesh.ground.vertices.indices()) {
    const auto at = c.mesh.floors_at(v);
    std::vector<std::int32_t> different(at.begin(), at.end());
    std::sort(different.begin(), different.end());
    floors += static_cast<std::size_t>(std::unique(different.begin(), different.end()) -
                                       different.begin());
  }
  EXPECT_EQ(page.numbers("z").size(), floors);
  EXPECT_TRUE(page.numbers("odd").empty());
}

TEST(Page, ShowsACityWithoutMesh) {
  const Case c;
  const Page page(page_html({.city = c.city}));
  EXPECT_EQ(page.facts()["mesh"], false);
  EXPECT_EQ(page.facts()["buildings"].size(), 5U);
  EXPECT_FALSE(page.facts()["buildings"][0].contains("parts"));
  EXPECT_FALSE(page.facts().contains("report"));
  EXPECT_FALSE(page.blocks.contains("z"));
}

TEST(Page, TellsOfRoofsInParts) {
  Case c;
  RoofPart part;
  part.outline = c.city.buildings[1].footprint;
  part.lod = Lod::k1_3;
  part.rmse = std::nan("");
  c.city.buildings[1].parts = {part, part};
  part.lod = Lod::k2_2;
  part.n_points = 5;
  part.rmse = 0.31249;
  c.city.buildings[2].parts = {part};
  const Json buildings = Page(page_html({.city = c.city})).facts()["buildings"];
  EXPECT_EQ(buildings[1]["parts"], 2);
  EXPECT_EQ(buildings[1]["lod"], "1.3");
  EXPECT_FALSE(buildings[1].contains("rmse"));
  EXPECT_EQ(buildings[2]["parts"], 1);
  EXPECT_EQ(buildings[2]["lod"], "2.2");
  EXPECT_EQ(buildings[2]["rmse"], 0.312);
}

TEST(Page, IsTheSameForAnyNumberOfThreads) {
  const Case c;
  std::string first;
  for (const int threads : {1, 4}) {
    const ThreadLimit limit(threads);
    const PageMesh shown = page_mesh(c.mesh);
    const std::string html = page_html({.city = c.city, .mesh = &shown});
    if (first.empty()) first = html;
    EXPECT_EQ(html, first);
  }
}

/// Whatever stands in the city, the page's own elements are those of the template.
TEST(Page, IsOneDocument) {
  const Case c;
  const PageMesh shown = page_mesh(c.mesh);
  const std::string html = page_html({.city = c.city, .mesh = &shown, .repeat = "</script>"});
  EXPECT_TRUE(html.starts_with("<!doctype html>"));
  EXPECT_TRUE(html.ends_with("</html>\n"));
  EXPECT_EQ(html.find("@@"), std::string::npos);
  const auto count = [&](const std::string& what) {
    std::size_t n = 0;
    for (std::size_t i = html.find(what); i != std::string::npos; i = html.find(what, i + 1)) ++n;
    return n;
  };
  EXPECT_EQ(count("</script>"), 2U);
  EXPECT_EQ(count(" src="), 0U);
  EXPECT_GT(count("MIT License"), 0U);
}

}  // namespace
}  // namespace tetropolis

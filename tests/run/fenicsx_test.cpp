// FEniCSx on our meshes, where it is installed: `apt-get install python3-dolfinx-real`.
#include <cstdlib>
#include <fstream>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "block_city.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

/// A Python that has DOLFINx; Debian's package belongs to Debian's Python.
std::string python_with_dolfinx() {
  for (const std::string python : {"python3", "/usr/bin/python3"})
    if (std::system((python + " -c 'import dolfinx' >/dev/null 2>&1").c_str()) == 0) return python;
  return "";
}

TEST(Fenicsx, SolvesAProblemWithAKnownSolution) {
  const std::string python = python_with_dolfinx();
  if (python.empty()) GTEST_SKIP() << "DOLFINx (package python3-dolfinx-real) is not installed";
  const testing::TemporaryFolder folder;
  const Report report = testing::build_blocks(folder, "xdmf");
  const std::string output = folder / "output.json", errors = folder / "errors";
  const std::string run = "cd " + folder.path().string() + " && " + python +
                          " " TETROPOLIS_SOURCE
                          "/tests/run/fenicsx_solve.py "
                          "result/volume.xdmf result/boundary.xdmf >" +
                          output + " 2>" + errors;
  ASSERT_EQ(std::system(run.c_str()), 0) << std::ifstream(errors).rdbuf();
  const auto found = nlohmann::json::parse(std::ifstream(output));

  EXPECT_EQ(found["cells"], report.volume_mesh->cells);
  EXPECT_EQ(found["vertices"], report.volume_mesh->vertices);
  const auto near = [](double value, double expected) {
    EXPECT_NEAR(value, expected, 1e-9 * expected);
  };
  near(found["volume"], report.volume_mesh->volume);
  const auto areas = found["patch_areas"].get<std::vector<double>>();
  ASSERT_EQ(areas.size(), 8U);
  for (const double area : areas) EXPECT_GT(area, 0);
  // The tags cover the boundary, and the top is the domain.
  near(std::accumulate(areas.begin(), areas.end(), 0.0), found["boundary_area"]);
  near(areas[3], report.domain.width() * report.domain.height());
  EXPECT_GT(found["free_vertices"], 1000);
  EXPECT_LT(found["largest_error"], 1e-6);
}

}  // namespace
}  // namespace tetropolis

// Inputs shared by the tests of the ground mesh.
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "tetropolis/geometry/types.h"
#include "tetropolis/ground/triangulation.h"

#include "ground/validate.h"
#include "support/test_data.h"

namespace tetropolis::testing {

class Random {
 public:
  explicit Random(unsigned offset = 0) : engine_(test_seed() * 7919U + offset) {}
  double real(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_()) * 0x1p-32;
  }
  int integer(int low, int high) {
    return low + static_cast<int>(engine_() % static_cast<unsigned>(high - low + 1));
  }
  Point2 point(double size) { return {real(0, size), real(0, size)}; }
  Point2 grid_point(int size) {
    return {static_cast<double>(integer(0, size)), static_cast<double>(integer(0, size))};
  }

 private:
  std::mt19937 engine_;
};

inline std::string lines(const Violations& violations) {
  std::string text;
  for (const std::string& v : violations) text += v + "\n";
  return text;
}

/// Appends a closed ring of segments.
inline void add_ring(PlanarGraph& graph, const std::vector<Point2>& ring) {
  const VertexIndex first(graph.points.size());
  const std::size_t n = ring.size();
  graph.points.insert(graph.points.end(), ring.begin(), ring.end());
  for (std::size_t i = 0; i < n; ++i) graph.segments.push_back({first + i, first + (i + 1) % n});
}

inline std::vector<Point2> rectangle_ring(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

/// Turned rectangles whose circumscribed circles keep `clearance`, in [0, size]^2.
inline std::vector<Polygon> random_rectangles(int count, double size, double clearance,
                                              Random& random) {
  struct Disc {
    Point2 c;
    double r;
  };
  std::vector<Disc> discs;
  std::vector<Polygon> result;
  for (int tries = 0; tries < 50 * count && static_cast<int>(result.size()) < count; ++tries) {
    const double w = random.real(6, 24), h = random.real(6, 24), turn = random.real(0, 6.3);
    const double r = 0.5 * std::hypot(w, h);
    const Point2 c{random.real(r + clearance, size - r - clearance),
                   random.real(r + clearance, size - r - clearance)};
    if (std::any_of(discs.begin(), discs.end(), [&](const Disc& d) {
          return std::hypot(c.x - d.c.x, c.y - d.c.y) < r + d.r + clearance;
        }))
      continue;
    discs.push_back({c, r});
    Polygon p;
    for (const Point2 k : {Point2{-1, -1}, Point2{1, -1}, Point2{1, 1}, Point2{-1, 1}}) {
      const double u = 0.5 * w * k.x, v = 0.5 * h * k.y;
      p.outer.push_back({c.x + u * std::cos(turn) - v * std::sin(turn),
                         c.y + u * std::sin(turn) + v * std::cos(turn)});
    }
    result.push_back(p);
  }
  return result;
}

/// Reads "vertices N", coordinates, "segments N", pairs, "holes N", coordinates.
inline PlanarGraph read_pslg(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::stringstream text;
  for (std::string line; std::getline(file, line);)
    if (line.empty() || line[0] != '#') text << line << '\n';
  PlanarGraph graph;
  std::string word;
  std::size_t n = 0;
  while (text >> word >> n) {
    for (std::size_t i = 0; i < n; ++i) {
      Point2 p;
      std::array<int, 2> s;
      if (word == "segments") {
        text >> s[0] >> s[1];
        graph.segments.push_back({VertexIndex(s[0]), VertexIndex(s[1])});
      } else {
        text >> p.x >> p.y;
        (word == "holes" ? graph.holes : graph.points).push_back(p);
      }
    }
  }
  if (graph.points.empty()) throw std::runtime_error("cannot read " + path.string());
  return graph;
}

}  // namespace tetropolis::testing

#include "geometry/predicates.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "support/test_data.h"

namespace tetropolis {
namespace {

__extension__ using Wide = unsigned __int128;

// An integer modulo 2^384, in two's complement: enough for any determinant below, and as unlike the
// expansions under test as can be.
class Big {
 public:
  Big() = default;
  explicit Big(std::int64_t value) {
    limb_.fill(value < 0 ? ~std::uint64_t{0} : 0);
    limb_[0] = static_cast<std::uint64_t>(value);
  }
  friend Big operator+(const Big& a, const Big& b) {
    Big sum;
    Wide carry = 0;
    for (std::size_t i = 0; i < a.limb_.size(); ++i) {
      carry += Wide{a.limb_[i]} + b.limb_[i];
      sum.limb_[i] = static_cast<std::uint64_t>(carry);
      carry >>= 64;
    }
    return sum;
  }
  friend Big operator-(const Big& a, const Big& b) {
    Big complement;
    for (std::size_t i = 0; i < b.limb_.size(); ++i) complement.limb_[i] = ~b.limb_[i];
    return a + complement + Big(1);
  }
  friend Big operator*(const Big& a, const Big& b) {
    Big product;
    for (std::size_t i = 0; i < a.limb_.size(); ++i) {
      Wide carry = 0;
      for (std::size_t j = 0; i + j < a.limb_.size(); ++j) {
        carry += Wide{a.limb_[i]} * b.limb_[j] + product.limb_[i + j];
        product.limb_[i + j] = static_cast<std::uint64_t>(carry);
        carry >>= 64;
      }
    }
    return product;
  }
  int sign() const {
    if ((limb_.back() >> 63) != 0) return -1;
    for (const std::uint64_t limb : limb_)
      if (limb != 0) return 1;
    return 0;
  }

 private:
  std::array<std::uint64_t, 6> limb_{};
};

// Integer coordinates; the doubles under test are these times a power of two.
struct Cell {
  std::int64_t x;
  std::int64_t y;
};

int exact_orient(Cell a, Cell b, Cell c) {
  return (Big(a.x - c.x) * Big(b.y - c.y) - Big(a.y - c.y) * Big(b.x - c.x)).sign();
}

int exact_incircle(Cell a, Cell b, Cell c, Cell d) {
  const auto lift = [](Big x, Big y) { return x * x + y * y; };
  const Big ax(a.x - d.x), ay(a.y - d.y), bx(b.x - d.x), by(b.y - d.y), cx(c.x - d.x),
      cy(c.y - d.y);
  return (lift(ax, ay) * (bx * cy - by * cx) + lift(bx, by) * (cx * ay - cy * ax) +
          lift(cx, cy) * (ax * by - ay * bx))
      .sign();
}

Point2 scaled(Cell c, int exponent) {
  return {std::ldexp(static_cast<double>(c.x), exponent),
          std::ldexp(static_cast<double>(c.y), exponent)};
}

class Random {
 public:
  std::int64_t between(std::int64_t low, std::int64_t high) {
    return std::uniform_int_distribution<std::int64_t>(low, high)(engine_);
  }
  Cell cell(std::int64_t low, std::int64_t high) {
    return {between(low, high), between(low, high)};
  }

 private:
  std::mt19937_64 engine_{testing::test_seed()};
};

void expect_exact(Cell a, Cell b, Cell c, Cell d, int exponent) {
  const Point2 p = scaled(a, exponent), q = scaled(b, exponent), r = scaled(c, exponent),
               s = scaled(d, exponent);
  ASSERT_EQ(orient2d(p, q, r), exact_orient(a, b, c)) << "seed " << testing::test_seed();
  ASSERT_EQ(predicates::orient2d_exact(p, q, r), exact_orient(a, b, c));
  ASSERT_EQ(incircle(p, q, r, s), exact_incircle(a, b, c, d)) << "seed " << testing::test_seed();
  ASSERT_EQ(predicates::incircle_exact(p, q, r, s), exact_incircle(a, b, c, d));
}

TEST(Predicates, AgreeWithIntegersOnGridsOfEverySize) {
  Random random;
  for (const std::int64_t size : {2, 5, 100, 1 << 20, 1 << 30}) {
    for (int i = 0; i < 4000; ++i) {
      const auto cell = [&] { return random.cell(-size, size); };
      expect_exact(cell(), cell(), cell(), cell(), -7);
    }
  }
}

TEST(Predicates, DecidePointsThatAreCollinearButForTheLastBit) {
  Random random;
  for (int i = 0; i < 20000; ++i) {
    const Cell a = random.cell(-(1 << 20), 1 << 20);
    const Cell step = random.cell(-(1 << 12), 1 << 12);
    const std::int64_t k = random.between(1, 1 << 10), l = random.between(1, 1 << 10);
    const Cell b{a.x + k * step.x, a.y + k * step.y};
    const Cell c{a.x - l * step.x + random.between(-1, 1),
                 a.y - l * step.y + random.between(-1, 1)};
    expect_exact(a, b, c, {c.x + random.between(-1, 1), c.y + random.between(-1, 1)}, 0);
  }
}

// c with cross(b, c) = gcd(b.x, b.y), by Euclid's algorithm: the smallest determinant there is
// between vectors of that length, far below the rounding error of its two products.
Cell smallest_turn(Cell b) {
  std::int64_t r0 = b.x, r1 = b.y, s0 = 1, s1 = 0, t0 = 0, t1 = 1;
  while (r1 != 0) {
    const std::int64_t q = r0 / r1;
    std::int64_t next = r0 - q * r1;
    r0 = r1, r1 = next;
    next = s0 - q * s1;
    s0 = s1, s1 = next;
    next = t0 - q * t1;
    t0 = t1, t1 = next;
  }
  return {-t0, s0};  // b.x * s0 + b.y * t0 = r0
}

TEST(Predicates, DecideTurnsFarBelowTheRoundingError) {
  Random random;
  for (int i = 0; i < 20000; ++i) {
    const Cell b = random.cell(1LL << 38, 1LL << 45);
    const Cell c = smallest_turn(b);
    const Cell shift = random.cell(-(1LL << 45), 1LL << 45);
    const auto shifted = [&](Cell p) { return Cell{p.x + shift.x, p.y + shift.y}; };
    const Cell origin{0, 0}, minus{-c.x, -c.y};
    ASSERT_NE(exact_orient(origin, b, c), 0);
    expect_exact(shifted(origin), shifted(b), shifted(c), shifted(minus), -30);
    expect_exact(shifted(b), shifted(minus), shifted(origin), shifted(c), -30);
  }
}

// Differences that do not fit a double, the case that needs the bound of the filter: one point near
// the origin with all its bits, the others far away on a line through the origin.
TEST(Predicates, DecideWhereDifferencesAreRounded) {
  Random random;
  for (int i = 0; i < 20000; ++i) {
    const Cell u = random.cell(1, 1 << 26);
    const auto far = [&] {
      const std::int64_t k = random.between(1, 1 << 24) * (1 << 8);
      return Cell{k * u.x, k * u.y};
    };
    expect_exact(random.cell(-3, 3), far(), far(), random.cell(-3, 3), -30);
  }
}

// Points on one circle: (3, 4, 5) and other Pythagorean directions about a centre, then nudged.
TEST(Predicates, DecidePointsThatAreCocircularButForTheLastBit) {
  const std::vector<Cell> directions = {
      {65, 0}, {63, 16},  {60, 25},  {56, 33},  {52, 39}, {39, 52},   {33, 56}, {25, 60}, {16, 63},
      {0, 65}, {-16, 63}, {-39, 52}, {-60, 25}, {-65, 0}, {-33, -56}, {0, -65}, {52, -39}};
  Random random;
  for (int i = 0; i < 20000; ++i) {
    const Cell centre = random.cell(-(1LL << 44), 1LL << 44);
    const std::int64_t radius = random.between(1, 1 << 20);
    const auto point = [&] {
      const Cell u = directions[static_cast<std::size_t>(
          random.between(0, static_cast<std::int64_t>(directions.size()) - 1))];
      return Cell{centre.x + radius * u.x, centre.y + radius * u.y};
    };
    Cell d = point();
    if (i % 2 == 0) d.x += random.between(-1, 1);
    expect_exact(point(), point(), point(), d, -20);
  }
}

// Projected coordinates of a city in metres, with features of centimetres down to the last bit: the
// doubles there are multiples of 2^-30.
TEST(Predicates, DecideAtCoordinatesOfMillionsOfMetres) {
  Random random;
  const Cell origin{std::int64_t{675000} << 30, std::int64_t{6400000} << 30};
  for (const std::int64_t size : {std::int64_t{1}, std::int64_t{3}, std::int64_t{1000},
                                  std::int64_t{10'000'000}, std::int64_t{1} << 40}) {
    for (int i = 0; i < 4000; ++i) {
      const auto cell = [&] {
        const Cell c = random.cell(-size, size);
        return Cell{origin.x + c.x, origin.y + c.y};
      };
      const Cell a = cell(), b = cell();
      Cell c = cell();
      if (i % 2 == 0)
        c = {(a.x + b.x) / 2 + random.between(-1, 1), (a.y + b.y) / 2 + random.between(-1, 1)};
      expect_exact(a, b, c, cell(), -30);
    }
  }
}

TEST(Predicates, KeepTheirSignFarFromOne) {
  for (const int exponent : {-332, -200, -100, 0, 100, 200, 330}) {
    const auto at = [&](double x, double y) {
      return Point2{std::ldexp(x, exponent), std::ldexp(y, exponent)};
    };
    EXPECT_EQ(orient2d(at(1, 1), at(2, 2), at(3, 3)), 0);
    EXPECT_EQ(orient2d(at(1, 1), at(2, 2), at(3, std::nextafter(3.0, 4.0))), 1);
    EXPECT_EQ(orient2d(at(1, 1), at(2, 2), at(3, 2.5)), -1);
    EXPECT_EQ(incircle(at(1, 0), at(0, 1), at(-1, 0), at(0, -1)), 0);
    EXPECT_EQ(incircle(at(1, 0), at(0, 1), at(-1, 0), at(0, -0.75)), 1);
    EXPECT_EQ(incircle(at(1, 0), at(0, 1), at(-1, 0), at(0, -1.25)), -1);
    EXPECT_EQ(incircle(at(1, 0), at(0, 1), at(-1, 0), at(0, std::nextafter(-1.0, 0.0))), 1);
  }
}

TEST(Predicates, ChangeSignWithOrientation) {
  Random random;
  for (int i = 0; i < 2000; ++i) {
    const auto point = [&] { return scaled(random.cell(-50, 50), -3); };
    const Point2 a = point(), b = point(), c = point(), d = point();
    EXPECT_EQ(orient2d(a, b, c), orient2d(b, c, a));
    EXPECT_EQ(orient2d(a, b, c), -orient2d(b, a, c));
    EXPECT_EQ(incircle(a, b, c, d), incircle(b, c, a, d));
    EXPECT_EQ(incircle(a, b, c, d), -incircle(b, a, c, d));
    EXPECT_EQ(incircle(a, b, c, a), 0);
  }
}

}  // namespace
}  // namespace tetropolis

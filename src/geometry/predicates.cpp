#include "predicates.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tetropolis::predicates {

namespace {

// A sum of at most N doubles, smallest magnitude first, that do not overlap and are not adjacent
// in binary, zeros left out. Empty means zero; the last component has the sign of the sum.
template <int N>
struct Expansion {
  int size = 0;
  std::array<double, N> c;

  void push(double value) {
    if (value != 0) c[static_cast<std::size_t>(size++)] = value;
  }
  double operator[](int i) const { return c[static_cast<std::size_t>(i)]; }
  int sign() const { return size == 0 ? 0 : (c[static_cast<std::size_t>(size - 1)] > 0 ? 1 : -1); }
};

struct Pair {
  double high;
  double low;  // high + low is exact
};

Pair two_sum(double a, double b) {
  const double sum = a + b;
  const double b_part = sum - a;
  const double a_part = sum - b_part;
  return {sum, (a - a_part) + (b - b_part)};
}

// Precondition: |a| >= |b| or a == 0.
Pair quick_two_sum(double a, double b) {
  const double sum = a + b;
  return {sum, b - (sum - a)};
}

Pair split(double a) {
  constexpr double kSplitter = 0x1p27 + 1;
  const double t = kSplitter * a;
  const double high = t - (t - a);
  return {high, a - high};
}

Pair two_product(double a, double b) {
  const double product = a * b;
  const Pair x = split(a);
  const Pair y = split(b);
  const double error = ((product - x.high * y.high) - x.low * y.high) - x.high * y.low;
  return {product, x.low * y.low - error};
}

Expansion<2> difference(double a, double b) {
  Expansion<2> result;
  const Pair d = two_sum(a, -b);
  result.push(d.low);
  result.push(d.high);
  return result;
}

// Shewchuk's fast expansion sum: merge by magnitude, then carry the rounded sum upwards.
template <int R, int N, int M>
void add_to(Expansion<R>& result, const Expansion<N>& e, const Expansion<M>& f) {
  result.size = 0;
  int i = 0;
  int j = 0;
  const auto next = [&] {
    if (j >= f.size || (i < e.size && std::abs(e[i]) < std::abs(f[j]))) return e[i++];
    return f[j++];
  };
  const int total = e.size + f.size;
  if (total == 0) return;
  double carry = next();
  if (total > 1) {
    const Pair first = quick_two_sum(next(), carry);
    result.push(first.low);
    carry = first.high;
    for (int k = 2; k < total; ++k) {
      const Pair s = two_sum(carry, next());
      result.push(s.low);
      carry = s.high;
    }
  }
  result.push(carry);
}

template <int N, int M>
Expansion<N + M> operator+(const Expansion<N>& e, const Expansion<M>& f) {
  Expansion<N + M> result;
  add_to(result, e, f);
  return result;
}

template <int N>
Expansion<N> operator-(Expansion<N> e) {
  for (int i = 0; i < e.size; ++i) e.c[static_cast<std::size_t>(i)] = -e[i];
  return e;
}

template <int N>
Expansion<2 * N> scale(const Expansion<N>& e, double factor) {
  Expansion<2 * N> result;
  if (e.size == 0 || factor == 0) return result;
  Pair carry = two_product(e[0], factor);
  result.push(carry.low);
  for (int i = 1; i < e.size; ++i) {
    const Pair p = two_product(e[i], factor);
    const Pair s = two_sum(carry.high, p.low);
    result.push(s.low);
    carry = quick_two_sum(p.high, s.high);
    result.push(carry.low);
  }
  result.push(carry.high);
  return result;
}

template <int N, int M>
Expansion<2 * N * M> operator*(const Expansion<N>& e, const Expansion<M>& f) {
  Expansion<2 * N * M> result;
  Expansion<2 * N * M> sum;
  for (int j = 0; j < f.size; ++j) {
    add_to(sum, result, scale(e, f[j]));
    result = sum;
  }
  return result;
}

struct Difference2 {
  Expansion<2> x;
  Expansion<2> y;
};

Difference2 difference(Point2 p, Point2 q) { return {difference(p.x, q.x), difference(p.y, q.y)}; }

Expansion<16> cross(const Difference2& u, const Difference2& v) { return u.x * v.y + -(v.x * u.y); }

Expansion<16> squared_length(const Difference2& u) { return u.x * u.x + u.y * u.y; }

// Powers of two change no digit; they bring far-out coordinates to where neither the products of
// four nor their error terms leave the exponent range.
void scale_into_range(std::array<Point2*, 4> points) {
  double largest = 0;
  double smallest = INFINITY;
  for (const Point2* p : points) {
    for (const double value : {std::abs(p->x), std::abs(p->y)}) {
      largest = std::max(largest, value);
      if (value > 0) smallest = std::min(smallest, value);
    }
  }
  if (largest < 0x1p200 && smallest > 0x1p-140) return;
  int exponent = 0;
  std::frexp(largest, &exponent);
  for (Point2* p : points)
    *p = {std::ldexp(p->x, 200 - exponent), std::ldexp(p->y, 200 - exponent)};
}

}  // namespace

int orient2d_exact(Point2 a, Point2 b, Point2 c) {
  return cross(difference(a, c), difference(b, c)).sign();
}

int incircle_exact(Point2 a, Point2 b, Point2 c, Point2 d) {
  scale_into_range({&a, &b, &c, &d});
  const Difference2 ad = difference(a, d);
  const Difference2 bd = difference(b, d);
  const Difference2 cd = difference(c, d);
  const auto a_term = squared_length(ad) * cross(bd, cd);
  const auto b_term = squared_length(bd) * cross(cd, ad);
  const auto c_term = squared_length(cd) * cross(ad, bd);
  return ((a_term + b_term) + c_term).sign();
}

}  // namespace tetropolis::predicates

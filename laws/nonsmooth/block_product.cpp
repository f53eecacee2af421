#include "laws/nonsmooth/block_product.h"

namespace epafi {

namespace {

// of an alias (`using`) Clang 14 forgets `aligned`, and loads where 32 bytes do not fit
typedef double Four __attribute__((vector_size(32), aligned(8), may_alias));  // NOLINT(modernize-use-using)
typedef double Two __attribute__((vector_size(16), aligned(8), may_alias));   // NOLINT(modernize-use-using)

/// c -= a b^T for 3 x 3 blocks, a column as four lanes: the last holds what follows and is thrown away, so that `a`
/// must be readable for one number more.
[[gnu::always_inline]] inline void subtract_3(double* __restrict c, const double* __restrict a,
                                              const double* __restrict b, std::size_t depth) {
  Four column[3] = {{c[0], c[1], c[2]}, {c[3], c[4], c[5]}, {c[6], c[7], c[8]}};
  for (std::size_t k = 0; k < depth; ++k) {
    const Four a4 = *reinterpret_cast<const Four*>(a + 3 * k);
#pragma GCC unroll 3
    for (std::size_t j = 0; j < 3; ++j) column[j] -= a4 * b[3 * k + j];
  }
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) c[3 * j + i] = column[j][i];
}

/// The same for 6 x 6, a column as four and two lanes: twelve sums in registers.
[[gnu::always_inline]] inline void subtract_6(double* __restrict c, const double* __restrict a,
                                              const double* __restrict b, std::size_t depth) {
  Four high[6];
  Two low[6];
  for (int j = 0; j < 6; ++j) {
    high[j] = *reinterpret_cast<const Four*>(c + 6 * j);
    low[j] = *reinterpret_cast<const Two*>(c + 6 * j + 4);
  }
  for (std::size_t k = 0; k < depth; ++k) {
    const Four a4 = *reinterpret_cast<const Four*>(a + 6 * k);
    const Two a2 = *reinterpret_cast<const Two*>(a + 6 * k + 4);
#pragma GCC unroll 6
    for (std::size_t j = 0; j < 6; ++j) {
      high[j] -= a4 * b[6 * k + j];
      low[j] -= a2 * b[6 * k + j];
    }
  }
  for (int j = 0; j < 6; ++j) {
    *reinterpret_cast<Four*>(c + 6 * j) = high[j];
    *reinterpret_cast<Two*>(c + 6 * j + 4) = low[j];
  }
}

/// Two block rows at once, three columns at a time: full lanes, nine sums in registers. On 500 spheres
/// 0.41 s for 0.74 s one row at a time.
[[gnu::always_inline]] inline void subtract_two_6(double* __restrict c, double* __restrict d,
                                                  const double* __restrict a, const double* __restrict e,
                                                  const double* __restrict b, std::size_t depth) {
  // inlined always: a call between instruction sets would hand over lanes in other registers
  const auto four = [](const double* p) __attribute__((always_inline)) { return *reinterpret_cast<const Four*>(p); };
  const auto halves = [](const double* p, const double* q) __attribute__((always_inline)) {
    const Two x = *reinterpret_cast<const Two*>(p), y = *reinterpret_cast<const Two*>(q);
    return __builtin_shufflevector(x, y, 0, 1, 2, 3);
  };
  for (std::size_t half = 0; half < 2; ++half, c += 18, d += 18, b += 3) {
    Four first[3], second[3], rest[3];
    for (int j = 0; j < 3; ++j) {
      first[j] = four(c + 6 * j);
      second[j] = four(d + 6 * j);
      rest[j] = halves(c + 6 * j + 4, d + 6 * j + 4);
    }
    for (std::size_t k = 0; k < depth; ++k) {
      const Four a4 = four(a + 6 * k), e4 = four(e + 6 * k), ae = halves(a + 6 * k + 4, e + 6 * k + 4);
#pragma GCC unroll 3
      for (std::size_t j = 0; j < 3; ++j) {
        const double f = b[6 * k + j];
        first[j] -= a4 * f;
        second[j] -= e4 * f;
        rest[j] -= ae * f;
      }
    }
    for (int j = 0; j < 3; ++j) {
      *reinterpret_cast<Four*>(c + 6 * j) = first[j];
      *reinterpret_cast<Four*>(d + 6 * j) = second[j];
      *reinterpret_cast<Two*>(c + 6 * j + 4) = __builtin_shufflevector(rest[j], rest[j], 0, 1);
      *reinterpret_cast<Two*>(d + 6 * j + 4) = __builtin_shufflevector(rest[j], rest[j], 2, 3);
    }
  }
}

}  // namespace

[[gnu::target_clones("avx2", "default")]] void subtract_panels_6(const PanelProduct& p) {
  const auto work = [&](std::size_t k) { return p.work + 36 * static_cast<std::size_t>(p.place[k]); };
  const auto row = [&](std::size_t k) { return p.a + 36 * k * p.stride; };
  std::size_t k = p.first;
  for (; k + 1 < p.last; k += 2) subtract_two_6(work(k), work(k + 1), row(k), row(k + 1), p.b, 6 * p.depth);
  if (k < p.last) subtract_6(work(k), row(k), p.b, 6 * p.depth);
}

[[gnu::target_clones("avx2", "default")]] void subtract_panels_3(const PanelProduct& p) {
  for (std::size_t k = p.first; k < p.last; ++k)
    subtract_3(p.work + 9 * static_cast<std::size_t>(p.place[k]), p.a + 9 * k * p.stride, p.b, 3 * p.depth);
}

}  // namespace epafi

#include "laws/wheel_rail/half_space/fft.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/threads/parallel.h"
#include "engine/units/error.h"

namespace epafi {
namespace {

/// One pass: lines of length n at stride s in (xr, xi) to (yr, yi); w holds exp(-2 pi i k step / size).
struct Pass {
  std::size_t n, s, step;
  const double *cosine, *sine;
  const double *xr, *xi;
  double *yr, *yi;
};

void radix2(const Pass& a) {
  const std::size_t m = a.n / 2;
  for (std::size_t p = 0; p < m; ++p) {
    const double c = a.cosine[p * a.step], d = a.sine[p * a.step];
    const double *r0 = a.xr + a.s * p, *i0 = a.xi + a.s * p, *r1 = r0 + a.s * m, *i1 = i0 + a.s * m;
    double *s0 = a.yr + a.s * 2 * p, *j0 = a.yi + a.s * 2 * p, *s1 = s0 + a.s, *j1 = j0 + a.s;
#pragma omp simd
    for (std::size_t q = 0; q < a.s; ++q) {
      const double dr = r0[q] - r1[q], di = i0[q] - i1[q];
      s0[q] = r0[q] + r1[q];
      j0[q] = i0[q] + i1[q];
      s1[q] = dr * c - di * d;
      j1[q] = dr * d + di * c;
    }
  }
}

void radix3(const Pass& a) {
  const std::size_t m = a.n / 3;
  const double h = 0.86602540378443864676;  // sin 60 deg
  for (std::size_t p = 0; p < m; ++p) {
    const double c1 = a.cosine[p * a.step], d1 = a.sine[p * a.step], c2 = a.cosine[2 * p * a.step],
                 d2 = a.sine[2 * p * a.step];
    const double *r0 = a.xr + a.s * p, *i0 = a.xi + a.s * p, *r1 = r0 + a.s * m, *i1 = i0 + a.s * m, *r2 = r1 + a.s * m,
                 *i2 = i1 + a.s * m;
    double *s0 = a.yr + a.s * 3 * p, *j0 = a.yi + a.s * 3 * p, *s1 = s0 + a.s, *j1 = j0 + a.s, *s2 = s1 + a.s,
           *j2 = j1 + a.s;
#pragma omp simd
    for (std::size_t q = 0; q < a.s; ++q) {
      const double sr = r1[q] + r2[q], si = i1[q] + i2[q], er = h * (i1[q] - i2[q]), ei = -h * (r1[q] - r2[q]);
      const double mr = r0[q] - 0.5 * sr, mi = i0[q] - 0.5 * si;
      s0[q] = r0[q] + sr;
      j0[q] = i0[q] + si;
      s1[q] = (mr + er) * c1 - (mi + ei) * d1;
      j1[q] = (mr + er) * d1 + (mi + ei) * c1;
      s2[q] = (mr - er) * c2 - (mi - ei) * d2;
      j2[q] = (mr - er) * d2 + (mi - ei) * c2;
    }
  }
}

void radix4(const Pass& a) {
  const std::size_t m = a.n / 4;
  for (std::size_t p = 0; p < m; ++p) {
    const std::size_t k = p * a.step;
    const double c1 = a.cosine[k], d1 = a.sine[k], c2 = a.cosine[2 * k], d2 = a.sine[2 * k], c3 = a.cosine[3 * k],
                 d3 = a.sine[3 * k];
    const double *r0 = a.xr + a.s * p, *i0 = a.xi + a.s * p, *r1 = r0 + a.s * m, *i1 = i0 + a.s * m;
    const double *r2 = r1 + a.s * m, *i2 = i1 + a.s * m, *r3 = r2 + a.s * m, *i3 = i2 + a.s * m;
    double *s0 = a.yr + a.s * 4 * p, *j0 = a.yi + a.s * 4 * p, *s1 = s0 + a.s, *j1 = j0 + a.s;
    double *s2 = s1 + a.s, *j2 = j1 + a.s, *s3 = s2 + a.s, *j3 = j2 + a.s;
#pragma omp simd
    for (std::size_t q = 0; q < a.s; ++q) {
      const double apr = r0[q] + r2[q], api = i0[q] + i2[q], amr = r0[q] - r2[q], ami = i0[q] - i2[q];
      const double bpr = r1[q] + r3[q], bpi = i1[q] + i3[q], bmr = r1[q] - r3[q], bmi = i1[q] - i3[q];
      s0[q] = apr + bpr;
      j0[q] = api + bpi;
      const double ur = amr + bmi, ui = ami - bmr, vr = apr - bpr, vi = api - bpi, wr = amr - bmi, wi = ami + bmr;
      s1[q] = ur * c1 - ui * d1;
      j1[q] = ur * d1 + ui * c1;
      s2[q] = vr * c2 - vi * d2;
      j2[q] = vr * d2 + vi * c2;
      s3[q] = wr * c3 - wi * d3;
      j3[q] = wr * d3 + wi * c3;
    }
  }
}

/// Calls f for blocks of lanes, in threads where the work pays for them: a fork costs as much as 2000 points.
template <class F>
void for_blocks(std::size_t lines, std::size_t n, const F& f) {
  if (lines * n >= 65536)
    return parallel_blocks(lines, Fft::lanes, [&](std::size_t b, std::size_t e, std::size_t) { f(b, e); });
  for (std::size_t begin = 0; begin < lines; begin += Fft::lanes) f(begin, std::min(lines, begin + Fft::lanes));
}

}  // namespace

std::size_t fft_size(std::size_t n) {
  std::size_t best = 0;
  for (std::size_t odd : {1u, 3u, 9u}) {
    std::size_t size = odd;
    while (size < n) size *= 2;
    if (best == 0 || size < best) best = size;
  }
  return best;
}

Fft::Fft(std::size_t n) : n_(n), cosine_(n), sine_(n) {
  EPAFI_REQUIRE(n > 0 && fft_size(n) == n, "a length of 2^k, 3 2^k or 9 2^k");
  for (std::size_t k = 0; k < n; ++k) {
    const double angle = -6.28318530717958647693 * static_cast<double>(k) / static_cast<double>(n);
    cosine_[k] = std::cos(angle);
    sine_[k] = std::sin(angle);
  }
}

std::size_t Fft::transform(double* work, bool inverse) const {
  const std::size_t plane = n_ * lanes;
  double *xr = work, *xi = work + plane, *yr = work + 2 * plane, *yi = work + 3 * plane;
  if (inverse) {
    std::swap(xr, xi);
    std::swap(yr, yi);
  }
  for (std::size_t n = n_, s = lanes; n > 1;) {
    const Pass pass{n, s, n_ / n, cosine_.data(), sine_.data(), xr, xi, yr, yi};
    const std::size_t radix = n % 4 == 0 ? 4 : n % 2 == 0 ? 2 : 3;
    radix == 4 ? radix4(pass) : radix == 2 ? radix2(pass) : radix3(pass);
    n /= radix;
    s *= radix;
    std::swap(xr, yr);
    std::swap(xi, yi);
  }
  return std::min(xr, xi) == work ? 0 : 2 * plane;
}

void fft_rows(const Fft& fft, ComplexPlanes& f, std::size_t rows, bool inverse) {
  const std::size_t n = fft.size(), L = Fft::lanes, plane = n * L;
  for_blocks(rows, n, [&](std::size_t begin, std::size_t end) {
    thread_local std::vector<double> work;
    if (work.size() < fft.scratch_size()) work.resize(fft.scratch_size());
    if (end - begin < L) std::fill(work.begin(), work.begin() + static_cast<std::ptrdiff_t>(2 * plane), 0.0);
    for (std::size_t l = 0; l < end - begin; ++l) {
      const double *re = &f.re[(begin + l) * f.nx], *im = &f.im[(begin + l) * f.nx];
      for (std::size_t k = 0; k < n; ++k) {
        work[k * L + l] = re[k];
        work[plane + k * L + l] = im[k];
      }
    }
    const double* out = work.data() + fft.transform(work.data(), inverse);
    for (std::size_t l = 0; l < end - begin; ++l) {
      double *re = &f.re[(begin + l) * f.nx], *im = &f.im[(begin + l) * f.nx];
      for (std::size_t k = 0; k < n; ++k) {
        re[k] = out[k * L + l];
        im[k] = out[plane + k * L + l];
      }
    }
  });
}

void fft_columns(const Fft& fft, ComplexPlanes& f, std::size_t columns, bool inverse) {
  const std::size_t n = fft.size(), L = Fft::lanes, plane = n * L;
  for_blocks(columns, n, [&](std::size_t begin, std::size_t end) {
    thread_local std::vector<double> work;
    if (work.size() < fft.scratch_size()) work.resize(fft.scratch_size());
    const std::size_t width = end - begin;
    if (width < L) std::fill(work.begin(), work.begin() + static_cast<std::ptrdiff_t>(2 * plane), 0.0);
    for (std::size_t k = 0; k < n; ++k) {
      for (std::size_t l = 0; l < width; ++l) {
        work[k * L + l] = f.re[k * f.nx + begin + l];
        work[plane + k * L + l] = f.im[k * f.nx + begin + l];
      }
    }
    const double* out = work.data() + fft.transform(work.data(), inverse);
    for (std::size_t k = 0; k < n; ++k) {
      for (std::size_t l = 0; l < width; ++l) {
        f.re[k * f.nx + begin + l] = out[k * L + l];
        f.im[k * f.nx + begin + l] = out[plane + k * L + l];
      }
    }
  });
}

}  // namespace epafi

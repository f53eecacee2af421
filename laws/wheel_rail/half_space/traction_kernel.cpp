#include "laws/wheel_rail/half_space/traction_kernel.h"

#include <algorithm>

#include "engine/threads/parallel.h"

namespace epafi {

TractionKernel::TractionKernel(const PatchGrid& grid, const ElasticPair& pair, KernelKind kind)
    : grid_(grid), along_x_(fft_size(2 * grid.nx + 1)), along_y_(fft_size(2 * grid.ny)) {
  const std::size_t px = along_x_.size(), py = along_y_.size();
  const auto nx = static_cast<std::ptrdiff_t>(grid.nx), ny = static_cast<std::ptrdiff_t>(grid.ny);
  std::vector<Influence> at((grid.nx + 1) * grid.ny);  // for offsets 0 .. nx, 0 .. ny - 1; others by symmetry
  parallel_for(
      grid.ny,
      [&](std::size_t j) {
        for (std::size_t i = 0; i <= grid.nx; ++i) {
          at[j * (grid.nx + 1) + i] = influence(static_cast<double>(i) * grid.dx, static_cast<double>(j) * grid.dy,
                                                0.5 * grid.dx, 0.5 * grid.dy, pair);
        }
      },
      16);
  const auto value = [&](std::ptrdiff_t i, std::ptrdiff_t j) {
    Influence k = at[static_cast<std::size_t>(std::abs(j) * (nx + 1) + std::abs(i))];
    if ((i < 0) != (j < 0)) k.xy = -k.xy;
    return k;
  };
  for (auto* planes : {&xx_, &xy_, &yy_, &field_}) planes->resize(px, py);
  const double scale = 1.0 / static_cast<double>(px * py);
  for (std::ptrdiff_t j = -ny + 1; j < ny; ++j) {
    for (std::ptrdiff_t i = -nx + 1; i < nx; ++i) {
      Influence k = value(i, j);
      if (kind != KernelKind::here) {
        const Influence next = value(i + 1, j);
        k = kind == KernelKind::ahead ? next : Influence{0.0, k.xx - next.xx, k.xy - next.xy, k.yy - next.yy};
      }
      if (i == 0 && j == 0) self_ = std::max(std::abs(k.xx), std::abs(k.yy));
      const auto row = static_cast<std::size_t>(j < 0 ? j + static_cast<std::ptrdiff_t>(py) : j);
      const auto column = static_cast<std::size_t>(i < 0 ? i + static_cast<std::ptrdiff_t>(px) : i);
      xx_.re[row * px + column] = scale * k.xx;
      xy_.re[row * px + column] = scale * k.xy;
      yy_.re[row * px + column] = scale * k.yy;
    }
  }
  for (auto* planes : {&xx_, &xy_, &yy_}) {
    fft_columns(along_y_, *planes, px, false);
    fft_rows(along_x_, *planes, py, false);
  }
}

void TractionKernel::apply(const TangentialField& traction, TangentialField& displacement) {
  const std::size_t nx = grid_.nx, ny = grid_.ny, px = along_x_.size(), py = along_y_.size();
  for (std::size_t j = 0; j < py; ++j) {
    double *re = &field_.re[j * px], *im = &field_.im[j * px];
    const std::size_t filled = j < ny ? nx : 0;
    std::copy_n(traction.x.data() + (j < ny ? j * nx : 0), filled, re);
    std::copy_n(traction.y.data() + (j < ny ? j * nx : 0), filled, im);
    std::fill(re + filled, re + px, 0.0);
    std::fill(im + filled, im + px, 0.0);
  }
  fft_rows(along_x_, field_, ny, false);
  fft_columns(along_y_, field_, px, false);
  // Q = X + i Y with real x and y: X(k) = (Q(k) + conj Q(-k)) / 2, i Y(k) = (Q(k) - conj Q(-k)) / 2; pairs k, -k
  // together
  for (std::size_t j = 0; j < py; ++j) {
    const std::size_t mj = (py - j) % py;
    if (mj < j) continue;
    for (std::size_t i = 0; i < px; ++i) {
      const std::size_t mi = (px - i) % px, k = j * px + i, m = mj * px + mi;
      if (mj == j && mi < i) continue;
      const double ar = field_.re[k], ai = field_.im[k], br = field_.re[m], bi = field_.im[m];
      const double xr = 0.5 * (ar + br), xi = 0.5 * (ai - bi), yr = 0.5 * (ai + bi), yi = 0.5 * (br - ar);
      const double ur = xx_.re[k] * xr - xx_.im[k] * xi + xy_.re[k] * yr - xy_.im[k] * yi;
      const double ui = xx_.re[k] * xi + xx_.im[k] * xr + xy_.re[k] * yi + xy_.im[k] * yr;
      const double vr = xy_.re[k] * xr - xy_.im[k] * xi + yy_.re[k] * yr - yy_.im[k] * yi;
      const double vi = xy_.re[k] * xi + xy_.im[k] * xr + yy_.re[k] * yi + yy_.im[k] * yr;
      field_.re[m] = ur + vi;  // at -k: conj U + i conj V
      field_.im[m] = vr - ui;
      field_.re[k] = ur - vi;  // U + i V
      field_.im[k] = ui + vr;
    }
  }
  fft_columns(along_y_, field_, px, true);
  fft_rows(along_x_, field_, ny, true);
  for (std::size_t j = 0; j < ny; ++j) {
    std::copy_n(&field_.re[j * px], nx, displacement.x.data() + j * nx);
    std::copy_n(&field_.im[j * px], nx, displacement.y.data() + j * nx);
  }
}

}  // namespace epafi

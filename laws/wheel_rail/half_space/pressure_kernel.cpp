#include "laws/wheel_rail/half_space/pressure_kernel.h"

#include <algorithm>

#include "engine/threads/parallel.h"

namespace epafi {

PressureKernel::PressureKernel(const PatchGrid& grid, const ElasticPair& pair)
    : grid_(grid),
      along_x_(fft_size(2 * grid.nx)),
      along_y_(fft_size(std::max<std::size_t>(2, 2 * grid.ny))),
      half_((grid.nx + 1) / 2) {
  const std::size_t px = along_x_.size(), py = along_y_.size();
  packed_.resize(half_, py);
  rows_.resize(px, py / 2 + 1);
  ComplexPlanes kernel;
  kernel.resize(px, py);
  parallel_for(
      grid.ny,
      [&](std::size_t j) {
        for (std::size_t i = 0; i < grid.nx; ++i) {
          const double k = influence(static_cast<double>(i) * grid.dx, static_cast<double>(j) * grid.dy, 0.5 * grid.dx,
                                     0.5 * grid.dy, pair)
                               .zz;
          const std::size_t mi = (px - i) % px, mj = (py - j) % py;
          kernel.re[j * px + i] = kernel.re[j * px + mi] = kernel.re[mj * px + i] = kernel.re[mj * px + mi] = k;
        }
      },
      16);
  self_ = kernel.re[0];
  fft_columns(along_y_, kernel, px, false);
  fft_rows(along_x_, kernel, py / 2 + 1, false);
  const double scale = 1.0 / static_cast<double>(px * py);
  spectrum_.assign(kernel.re.begin(), kernel.re.begin() + static_cast<std::ptrdiff_t>(px * (py / 2 + 1)));
  for (double& s : spectrum_) s *= scale;
}

void PressureKernel::apply(std::span<const double> pressure, std::span<double> displacement) {
  const std::size_t nx = grid_.nx, ny = grid_.ny, px = along_x_.size(), py = along_y_.size(), h = half_;
  for (std::size_t j = 0; j < ny; ++j) {
    for (std::size_t i = 0; i < h; ++i) {
      packed_.re[j * h + i] = pressure[j * nx + i];
      packed_.im[j * h + i] = i + h < nx ? pressure[j * nx + i + h] : 0.0;
    }
  }
  std::fill(packed_.re.begin() + static_cast<std::ptrdiff_t>(ny * h), packed_.re.end(), 0.0);
  std::fill(packed_.im.begin() + static_cast<std::ptrdiff_t>(ny * h), packed_.im.end(), 0.0);
  fft_columns(along_y_, packed_, h, false);
  // two real columns from one complex: A = (Z(k) + conj Z(-k)) / 2, B = (Z(k) - conj Z(-k)) / 2i
  for (std::size_t k = 0; k <= py / 2; ++k) {
    const std::size_t m = (py - k) % py;
    double *re = &rows_.re[k * px], *im = &rows_.im[k * px];
    const double *zr = &packed_.re[k * h], *zi = &packed_.im[k * h], *yr = &packed_.re[m * h], *yi = &packed_.im[m * h];
    for (std::size_t i = 0; i < h; ++i) {
      re[i] = 0.5 * (zr[i] + yr[i]);
      im[i] = 0.5 * (zi[i] - yi[i]);
      re[i + h] = 0.5 * (zi[i] + yi[i]);
      im[i + h] = 0.5 * (yr[i] - zr[i]);
    }
    std::fill(re + 2 * h, re + px, 0.0);
    std::fill(im + 2 * h, im + px, 0.0);
  }
  fft_rows(along_x_, rows_, py / 2 + 1, false);
  for (std::size_t k = 0; k < spectrum_.size(); ++k) {
    rows_.re[k] *= spectrum_[k];
    rows_.im[k] *= spectrum_[k];
  }
  fft_rows(along_x_, rows_, py / 2 + 1, true);
  for (std::size_t k = 0; k <= py / 2; ++k) {
    const std::size_t m = (py - k) % py;
    const double *re = &rows_.re[k * px], *im = &rows_.im[k * px];
    for (std::size_t i = 0; i < h; ++i) {
      const double ar = re[i], ai = im[i], br = re[i + h], bi = im[i + h];
      packed_.re[m * h + i] = ar + bi;
      packed_.im[m * h + i] = br - ai;
      packed_.re[k * h + i] = ar - bi;
      packed_.im[k * h + i] = ai + br;
    }
  }
  fft_columns(along_y_, packed_, h, true);
  for (std::size_t j = 0; j < ny; ++j) {
    for (std::size_t i = 0; i < h; ++i) {
      displacement[j * nx + i] = packed_.re[j * h + i];
      if (i + h < nx) displacement[j * nx + i + h] = packed_.im[j * h + i];
    }
  }
}

}  // namespace epafi

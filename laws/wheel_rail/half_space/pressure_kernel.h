/// @file pressure_kernel.h  Normal displacement of a grid of pressures on two half-spaces: one convolution by FFT, O(n
/// log n).
#pragma once
#include <span>
#include <vector>

#include "laws/wheel_rail/half_space/fft.h"
#include "laws/wheel_rail/half_space/influence.h"

namespace epafi {

/// nx by ny cells of dx by dy [m], row by row in y.
struct PatchGrid {
  std::size_t nx = 0, ny = 0;
  double dx = 0.0, dy = 0.0;
  std::size_t size() const { return nx * ny; }
  double cell() const { return dx * dy; }
  double x(std::size_t ix) const { return (static_cast<double>(ix) + 0.5 - 0.5 * static_cast<double>(nx)) * dx; }
  double y(std::size_t iy) const { return (static_cast<double>(iy) + 0.5 - 0.5 * static_cast<double>(ny)) * dy; }
};

class PressureKernel {
 public:
  PressureKernel(const PatchGrid& grid, const ElasticPair& pair);
  /// displacement[i] = sum_j K_ij pressure[j] [m]; the grid is padded, so nothing wraps around.
  void apply(std::span<const double> pressure, std::span<double> displacement);
  double self() const { return self_; }  ///< K_ii [m/Pa]

 private:
  PatchGrid grid_;
  Fft along_x_, along_y_;
  std::size_t half_;  ///< columns ix and ix + half_ ride in one complex column
  double self_ = 0.0;
  std::vector<double> spectrum_;  ///< real, because the kernel is even; rows 0 .. Py/2
  ComplexPlanes packed_, rows_;
};

}  // namespace epafi

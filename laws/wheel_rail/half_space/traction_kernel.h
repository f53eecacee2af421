/// @file traction_kernel.h  Tangential displacement of a grid of tractions on two half-spaces, and its change while the
/// patch rolls on by one cell: convolutions by FFT, both components in one complex transform.
#pragma once
#include <span>
#include <vector>

#include "laws/wheel_rail/half_space/pressure_kernel.h"

namespace epafi {

/// Tractions or displacements, x and y by cell.
struct TangentialField {
  std::vector<double> x, y;
  explicit TangentialField(std::size_t n = 0) : x(n, 0.0), y(n, 0.0) {}
  std::size_t size() const { return x.size(); }
};

/// Which displacement a kernel gives: at the cell (shift), one cell ahead (what the material had before), or the
/// difference of the two (steady rolling).
enum class KernelKind { here, ahead, difference };

class TractionKernel {
 public:
  TractionKernel(const PatchGrid& grid, const ElasticPair& pair, KernelKind kind);
  void apply(const TangentialField& traction, TangentialField& displacement);
  double self() const { return self_; }  ///< the larger of the diagonal entries of a cell upon itself [m/Pa]

 private:
  PatchGrid grid_;
  Fft along_x_, along_y_;
  double self_ = 0.0;
  ComplexPlanes xx_, xy_, yy_, field_;
};

}  // namespace epafi

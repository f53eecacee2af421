/// @file fft.h  Fast Fourier transforms of many lines at once: Stockham's self-sorting form, radix 4, then what is left
/// of 2 and 3. Eight lines stand side by side, so that every butterfly is a plain vector loop without shuffles and
/// stays in cache.
#pragma once
#include <cstddef>
#include <vector>

namespace epafi {

/// Smallest 2^k, 3 2^k or 9 2^k that is >= n.
std::size_t fft_size(std::size_t n);

class Fft {
 public:
  static constexpr std::size_t lanes = 8;
  explicit Fft(std::size_t n);  ///< n = 2^k, 3 2^k or 9 2^k
  std::size_t size() const { return n_; }
  std::size_t scratch_size() const { return 4 * n_ * lanes; }

  /// Forward transform of `lanes` lines in work[0, n lanes) (real) and work[n lanes, 2 n lanes) (imaginary), element k
  /// of line l at k * lanes + l; the rest of the scratch is used up. Returns where the result stands: 0 or 2 n lanes.
  std::size_t transform(double* work, bool inverse) const;

 private:
  std::size_t n_;
  std::vector<double> cosine_, sine_;  ///< exp(-2 pi i k / n)
};

/// A complex field of ny rows by nx columns as two planes, transformed in place along x or along y in blocks of lines.
/// Unscaled; the inverse is the forward transform with the planes exchanged.
struct ComplexPlanes {
  std::size_t nx = 0, ny = 0;
  std::vector<double> re, im;
  void resize(std::size_t columns, std::size_t rows) {
    nx = columns;
    ny = rows;
    re.assign(nx * ny, 0.0);
    im.assign(nx * ny, 0.0);
  }
};
void fft_rows(const Fft& fft, ComplexPlanes& planes, std::size_t rows,
              bool inverse);  ///< the first `rows` rows, along x
void fft_columns(const Fft& fft, ComplexPlanes& planes, std::size_t columns,
                 bool inverse);  ///< the first columns, along y

}  // namespace epafi

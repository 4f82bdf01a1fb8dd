/// @file
/// 3 x 3 matrices whose entries are doubles or packs of eight doubles. With them a law is written
/// once and evaluated at one point or at eight points at a time.
///
/// All functions are forced inline, because packs are passed differently depending on the vector
/// instructions that a caller is compiled for.
#pragma once

#include <cmath>
#include <cstdint>

/// Must precede every function that a kernel of element_kernels.cpp calls.
#define PALPABLE_ALWAYS_INLINE [[gnu::always_inline]] inline

namespace palpable {

inline constexpr int kPackSize = 8;
/// Eight doubles that are computed side by side: one AVX-512 register, two of AVX2, four of SSE2.
/// Code compiled for AVX-512 assumes that packs are aligned to their size; code compiled for other
/// instructions does not align them. So types that both use declare alignas(kPackAlignment).
using Pack = double __attribute__((vector_size(kPackSize * sizeof(double))));
using PackBits = std::int64_t __attribute__((vector_size(kPackSize * sizeof(std::int64_t))));
using PackWords = std::uint64_t __attribute__((vector_size(kPackSize * sizeof(std::uint64_t))));
inline constexpr int kPackAlignment = sizeof(Pack);

/// m[i + 3 J] is entry (i, J): column by column, as Eigen stores them.
template <class T>
struct Tensor {
  T m[9];
  PALPABLE_ALWAYS_INLINE T& operator()(int i, int J) { return m[i + 3 * J]; }
  PALPABLE_ALWAYS_INLINE const T& operator()(int i, int J) const { return m[i + 3 * J]; }
};

template <class T>
PALPABLE_ALWAYS_INLINE Tensor<T> operator+(const Tensor<T>& A, const Tensor<T>& B) {
  Tensor<T> sum;
  for (int k = 0; k < 9; ++k) sum.m[k] = A.m[k] + B.m[k];
  return sum;
}
template <class T>
PALPABLE_ALWAYS_INLINE Tensor<T> operator-(const Tensor<T>& A, const Tensor<T>& B) {
  Tensor<T> difference;
  for (int k = 0; k < 9; ++k) difference.m[k] = A.m[k] - B.m[k];
  return difference;
}
/// @param s  of the tensor's number type, or a double
template <class S, class T>
PALPABLE_ALWAYS_INLINE Tensor<T> operator*(const S& s, const Tensor<T>& A) {
  Tensor<T> scaled;
  for (int k = 0; k < 9; ++k) scaled.m[k] = s * A.m[k];
  return scaled;
}

/// A B
template <class T>
PALPABLE_ALWAYS_INLINE Tensor<T> product(const Tensor<T>& A, const Tensor<T>& B) {
  Tensor<T> C;
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) C(i, j) = A(i, 0) * B(0, j) + A(i, 1) * B(1, j) + A(i, 2) * B(2, j);
  }
  return C;
}
/// A^T B
template <class T>
PALPABLE_ALWAYS_INLINE Tensor<T> transposed_product(const Tensor<T>& A, const Tensor<T>& B) {
  Tensor<T> C;
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) C(i, j) = A(0, i) * B(0, j) + A(1, i) * B(1, j) + A(2, i) * B(2, j);
  }
  return C;
}
/// A : B, the sum of the products of their entries
template <class T>
PALPABLE_ALWAYS_INLINE T inner(const Tensor<T>& A, const Tensor<T>& B) {
  T sum = A.m[0] * B.m[0];
  for (int k = 1; k < 9; ++k) sum += A.m[k] * B.m[k];
  return sum;
}
template <class T>
PALPABLE_ALWAYS_INLINE T trace(const Tensor<T>& A) {
  return A.m[0] + A.m[4] + A.m[8];
}
/// d det A / dA, which is det(A) A^-T where that exists.
template <class T>
PALPABLE_ALWAYS_INLINE Tensor<T> cofactors(const Tensor<T>& A) {
  Tensor<T> C;
  C(0, 0) = A(1, 1) * A(2, 2) - A(1, 2) * A(2, 1);
  C(0, 1) = A(1, 2) * A(2, 0) - A(1, 0) * A(2, 2);
  C(0, 2) = A(1, 0) * A(2, 1) - A(1, 1) * A(2, 0);
  C(1, 0) = A(0, 2) * A(2, 1) - A(0, 1) * A(2, 2);
  C(1, 1) = A(0, 0) * A(2, 2) - A(0, 2) * A(2, 0);
  C(1, 2) = A(0, 1) * A(2, 0) - A(0, 0) * A(2, 1);
  C(2, 0) = A(0, 1) * A(1, 2) - A(0, 2) * A(1, 1);
  C(2, 1) = A(0, 2) * A(1, 0) - A(0, 0) * A(1, 2);
  C(2, 2) = A(0, 0) * A(1, 1) - A(0, 1) * A(1, 0);
  return C;
}

/// ln x for x > 0.
PALPABLE_ALWAYS_INLINE double logarithm(double x) { return std::log(x); }

/// The same, lane by lane, for normal numbers; within 2 units of the last place.
///
/// x = 2^e m with m in [1/sqrt 2, sqrt 2), and ln m = 2 artanh((m - 1) / (m + 1)) by its power
/// series, whose remainder after the 21st power is below 1e-17 of the first term for these m.
PALPABLE_ALWAYS_INLINE Pack logarithm(const Pack& x) {
  // Adding (bits of 1) - (bits of 1 / sqrt 2) carries into the exponent if the mantissa is at least
  // sqrt 2. The sum is unsigned, because it may wrap around in lanes of inverted elements, whose
  // results are not used.
  const PackWords bits = (PackWords)x;
  const PackBits e = ((PackBits)(bits + (0x3ff0000000000000 - 0x3fe6a09e667f3bcd)) >> 52) - 0x3ff;
  const Pack m = (Pack)(bits - ((PackWords)e << 52));
  const Pack s = (m - 1.0) / (m + 1.0);
  const Pack q = s * s;
  Pack series = q * (1.0 / 21) + 1.0 / 19;
  for (int power = 17; power >= 3; power -= 2) series = series * q + 1.0 / power;
  return __builtin_convertvector(e, Pack) * 0.6931471805599453094 + 2.0 * (s + s * q * series);
}

/// x^(-1/3) for x > 0.
PALPABLE_ALWAYS_INLINE double inverse_cube_root(double x) { return 1.0 / std::cbrt(x); }

/// The same, lane by lane, for normal numbers; within a few units of the last place.
///
/// Newton's method on r^-3 = x. The start value divides the exponent by -3 and interpolates
/// linearly in between; its error is at most 4 %, and four quadratic steps reduce that to rounding.
PALPABLE_ALWAYS_INLINE Pack inverse_cube_root(const Pack& x) {
  const Pack start_bits = 6.1426e18 - __builtin_convertvector((PackBits)x, Pack) * (1.0 / 3.0);
  Pack r = (Pack) __builtin_convertvector(start_bits, PackBits);
  for (int step = 0; step < 4; ++step) r = r * (4.0 - x * r * r * r) * (1.0 / 3.0);
  return r;
}

}  // namespace palpable

/// @file
/// Truncated power series as a number type. A law's formulas, evaluated with them for a deformation
/// that is a polynomial of one parameter, give the law's derivatives of any order along that path.
/// This works for every law that is written as law.h requires, and no formulas for the derivatives
/// are needed.
///
///     x(a) = x_0 + a x_1 + ... + a^n x_n + O(a^(n+1))
///
/// The coefficients are doubles, packs of eight doubles, or jets themselves: Jet<Jet<double, 1>, 1>
/// holds mixed second derivatives.
#pragma once

#include "palpable/common/material/tensor.h"

namespace palpable {

template <class T, int n>
struct Jet {
  T c[n + 1];  ///< c[k] belongs to a^k
};

template <class T, int n>
PALPABLE_ALWAYS_INLINE Jet<T, n> operator+(const Jet<T, n>& x, const Jet<T, n>& y) {
  Jet<T, n> sum;
  for (int k = 0; k <= n; ++k) sum.c[k] = x.c[k] + y.c[k];
  return sum;
}
template <class T, int n>
PALPABLE_ALWAYS_INLINE Jet<T, n> operator-(const Jet<T, n>& x, const Jet<T, n>& y) {
  Jet<T, n> difference;
  for (int k = 0; k <= n; ++k) difference.c[k] = x.c[k] - y.c[k];
  return difference;
}
/// (x y)_k = sum_j x_j y_(k-j)
template <class T, int n>
PALPABLE_ALWAYS_INLINE Jet<T, n> operator*(const Jet<T, n>& x, const Jet<T, n>& y) {
  Jet<T, n> product;
  for (int k = 0; k <= n; ++k) {
    product.c[k] = x.c[0] * y.c[k];
    for (int j = 1; j <= k; ++j) product.c[k] = product.c[k] + x.c[j] * y.c[k - j];
  }
  return product;
}
/// From (x / y) y = x, order by order. @pre y_0 is not 0
template <class T, int n>
PALPABLE_ALWAYS_INLINE Jet<T, n> operator/(const Jet<T, n>& x, const Jet<T, n>& y) {
  Jet<T, n> quotient;
  const T inverse = 1.0 / y.c[0];
  for (int k = 0; k <= n; ++k) {
    T rest = x.c[k];
    for (int j = 1; j <= k; ++j) rest = rest - y.c[j] * quotient.c[k - j];
    quotient.c[k] = rest * inverse;
  }
  return quotient;
}

template <class T, int n>
PALPABLE_ALWAYS_INLINE Jet<T, n> operator+(Jet<T, n> x, double y) {
  x.c[0] = x.c[0] + y;
  return x;
}
template <class T, int n>
PALPABLE_ALWAYS_INLINE Jet<T, n> operator-(Jet<T, n> x, double y) {
  x.c[0] = x.c[0] - y;
  return x;
}
template <class T, int n>
PALPABLE_ALWAYS_INLINE Jet<T, n> operator*(double x, Jet<T, n> y) {
  for (int k = 0; k <= n; ++k) y.c[k] = x * y.c[k];
  return y;
}
template <class T, int n>
PALPABLE_ALWAYS_INLINE Jet<T, n> operator*(const Jet<T, n>& x, double y) {
  return y * x;
}
template <class T, int n>
PALPABLE_ALWAYS_INLINE Jet<T, n> operator/(double x, const Jet<T, n>& y) {
  Jet<T, n> constant{};
  constant.c[0] = constant.c[0] + x;
  return constant / y;
}
template <class T, int n>
PALPABLE_ALWAYS_INLINE Jet<T, n> operator-(const Jet<T, n>& x) {
  return -1.0 * x;
}
template <class T, int n>
PALPABLE_ALWAYS_INLINE Jet<T, n>& operator+=(Jet<T, n>& x, const Jet<T, n>& y) {
  return x = x + y;
}
template <class T, int n>
PALPABLE_ALWAYS_INLINE Jet<T, n>& operator+=(Jet<T, n>& x, double y) {
  return x = x + y;
}
template <class T, int n>
PALPABLE_ALWAYS_INLINE Jet<T, n>& operator-=(Jet<T, n>& x, double y) {
  return x = x - y;
}

/// ln x: with y = ln x, x y' = x' gives  k x_0 y_k = k x_k - sum_(0<j<k) j y_j x_(k-j).
/// @pre x_0 > 0
template <class T, int n>
PALPABLE_ALWAYS_INLINE Jet<T, n> logarithm(const Jet<T, n>& x) {
  Jet<T, n> y;
  y.c[0] = logarithm(x.c[0]);
  const T inverse = 1.0 / x.c[0];
  for (int k = 1; k <= n; ++k) {
    T rest = x.c[k];
    for (int j = 1; j < k; ++j) rest = rest - (static_cast<double>(j) / k) * (y.c[j] * x.c[k - j]);
    y.c[k] = rest * inverse;
  }
  return y;
}

/// x^p for p = -1/3: x y' = p x' y gives  k x_0 y_k = sum_(j=1..k) (p j - (k - j)) x_j y_(k-j).
/// @pre x_0 > 0
template <class T, int n>
PALPABLE_ALWAYS_INLINE Jet<T, n> inverse_cube_root(const Jet<T, n>& x) {
  Jet<T, n> y;
  y.c[0] = inverse_cube_root(x.c[0]);
  const T inverse = 1.0 / x.c[0];
  for (int k = 1; k <= n; ++k) {
    T sum{};
    for (int j = 1; j <= k; ++j) {
      sum = sum + ((-1.0 / 3.0 * j - (k - j)) / k) * (x.c[j] * y.c[k - j]);
    }
    y.c[k] = sum * inverse;
  }
  return y;
}

}  // namespace palpable

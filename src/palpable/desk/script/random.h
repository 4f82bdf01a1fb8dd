/// @file
/// Random numbers that depend only on a seed and a name and are equal on every machine. (The
/// distributions of <random> differ between standard libraries.)
#pragma once

#include "palpable/common/base/checksum.h"

#include <cstdint>
#include <string_view>

namespace palpable {

/// SplitMix64 (Steele, Lea, Flood 2014), a full-period generator for which every seed is suitable.
///
/// The numbers depend on the order of the draws, and C++ does not specify the order in which the
/// arguments of a function and the operands of most operators are evaluated. So an argument list or
/// an expression may contain at most one draw; other draws need statements of their own before it:
///
///     Vector3d(random.unit(), random.unit(), 0.0)        wrong: another film with another compiler
///     const double x = random.unit();                    right
///     const double y = random.unit();
///     Vector3d(x, y, 0.0)
///
/// (Members of a braced list are evaluated in order.)
class Random {
 public:
  /// Streams with different names are independent.
  Random(std::uint64_t seed, std::string_view name) : state_(seed * 0x9e3779b97f4a7c15ULL) {
    state_ = fnv1a(name, state_);
    next();
  }

  std::uint64_t next() {
    state_ += 0x9e3779b97f4a7c15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }

  /// [0, 1)
  double unit() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
  double between(double low, double high) { return low + (high - low) * unit(); }
  /// -1 or 1
  double sign() { return (next() >> 63) != 0 ? 1.0 : -1.0; }

 private:
  std::uint64_t state_;
};

}  // namespace palpable

/// @file
/// What this machine can do at most, measured: to say how far a program is from what is possible.
#pragma once

#include <cstddef>
#include <string>

namespace palpable {

/// Of one core, in CPU time, so that neighbours on other cores disturb little.
struct MachineRates {
  double bytes_per_s = 0;  ///< copied: read and written, by memcpy between two arrays
  double flops_per_s = 0;  ///< single precision, fused multiply-add counting two, in registers
  std::string vectors;     ///< the widest that the processor has: "AVX-512", "AVX2", "SSE2"
};

/// Takes about half a second.
/// @param copied_bytes  size of each of the two arrays, > 0; below that of a cache, it is the
///                      cache's bandwidth that is measured
[[nodiscard]] MachineRates measure_machine(std::size_t copied_bytes);

}  // namespace palpable

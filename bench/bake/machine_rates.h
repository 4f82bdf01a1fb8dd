/// @file
/// Measured peak rates of this machine, for lower bounds of a program's time.
#pragma once

#include <cstddef>
#include <string>

namespace palpable {

/// Rates of one core in CPU time, which depends little on load of other cores.
struct MachineRates {
  double bytes_per_s = 0;  ///< of memcpy between two arrays: bytes read + bytes written
  double flops_per_s = 0;  ///< single precision in registers; a multiply-add counts two
  std::string vectors;  ///< the widest instruction set of the processor: "AVX-512", "AVX2", "SSE2"
};

/// Takes about half a second.
/// @param copied_bytes  size of each of the two arrays, > 0; if smaller than a cache, the cache's
///                      bandwidth is measured
[[nodiscard]] MachineRates measure_machine(std::size_t copied_bytes);

}  // namespace palpable

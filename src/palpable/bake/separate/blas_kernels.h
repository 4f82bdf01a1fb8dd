/// @file
/// Chooses OpenBLAS's kernels for a processor. On a processor that is newer than the library,
/// OpenBLAS falls back to its kernels of 2004, which run at a quarter of the speed (seen with
/// Debian 12's 0.3.21 on Xeons from 2023).
#pragma once

#include <string>

namespace palpable {

struct VectorUnits {
  bool avx2_and_fma = false;
  bool avx512 = false;  ///< F, DQ, BW and VL
};

/// The value to set OPENBLAS_CORETYPE to, or null if OpenBLAS's own choice is right or no better
/// one is known.
/// @param chosen  name of the kernels that OpenBLAS chose by itself
[[nodiscard]] const char* better_blas_kernels(const char* chosen, const VectorUnits& units);

/// The same for this processor and the linked OpenBLAS. OpenBLAS reads the variable before main(),
/// so the program has to set it and start itself again.
[[nodiscard]] const char* better_blas_kernels();

/// The linked BLAS.
struct BlasFacts {
  std::string name;     ///< "OpenBLAS 0.3.21"
  std::string kernels;  ///< the processor for which its kernels were written: "Haswell"
  /// It may be called by several threads at a time. Debian's serial build has no locks: when two
  /// threads call it, a product is wrong now and then.
  bool thread_safe = true;
};
[[nodiscard]] BlasFacts blas_facts();

}  // namespace palpable

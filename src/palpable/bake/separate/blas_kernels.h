/// @file
/// Which of OpenBLAS's kernels a processor should have. On one that is younger than it is, OpenBLAS
/// takes those of 2004, a quarter of the speed (Debian 12's 0.3.21 on Xeons from 2023).
#pragma once

namespace palpable {

struct VectorUnits {
  bool avx2_and_fma = false;
  bool avx512 = false;  ///< F, DQ, BW and VL
};

/// The kernels to ask for with OPENBLAS_CORETYPE, or null where OpenBLAS's own choice is right or
/// nothing better is known.
/// @param chosen  by OpenBLAS
[[nodiscard]] const char* better_blas_kernels(const char* chosen, const VectorUnits& units);

/// The same for this processor and the OpenBLAS that is linked. It reads the variable before
/// main(), so a program has to be started again with it.
[[nodiscard]] const char* better_blas_kernels();

}  // namespace palpable

/// @file
/// Selects OpenBLAS's kernels before the program does anything else.
#pragma once

namespace palpable::app {

/// Restarts this program with the same arguments if OpenBLAS has selected kernels for an older
/// processor (separate/dense_algebra.h). A choice of the user (OPENBLAS_CORETYPE) is kept. Returns
/// if nothing has to be changed, or if the restart fails; the program then is only slow.
/// @param argv  of main()
void use_kernels_of_this_processor(char** argv);

}  // namespace palpable::app

/// @file
/// The kernels that OpenBLAS runs, chosen before the program does anything else.
#pragma once

namespace palpable::app {

/// Starts this program again, with the same arguments, where OpenBLAS took kernels that are older
/// than the processor (separate/blas_kernels.h). A choice that the user has made
/// (OPENBLAS_CORETYPE) stays. Returns where there is nothing to change, or where the program cannot
/// be started: then it is only slow.
/// @param argv  as main() got it
void use_kernels_of_this_processor(char** argv);

}  // namespace palpable::app

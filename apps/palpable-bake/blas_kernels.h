/// @file
/// OpenBLAS on processors that are younger than it is.
#pragma once

namespace palpable::app {

/// Starts this program again with the kernels that the processor can run, where OpenBLAS does not
/// know it and took those of 2004 (a quarter of the speed; Debian 12's 0.3.21 on Xeons from 2023).
/// It reads its choice from the environment before main(), so there is no other way; a choice that
/// is there already, OPENBLAS_CORETYPE, stays. Returns when there is nothing to do.
void use_kernels_of_this_processor(char** argv);

}  // namespace palpable::app

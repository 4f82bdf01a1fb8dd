/// @file
/// Damage to Palpable's HDF5 files that their checksum does not reveal.
#pragma once

#include "tests/fuzz/mutations.h"

#include <string>

namespace palpable::fuzz {

/// Changes one to eight numbers of datasets and attributes through HDF5 and recomputes the
/// checksum, as an attacker who knows the format could. (Damage to HDF5's own structure behind a
/// valid checksum is not tested: HDF5 1.10 does not survive it, and it does not occur by accident.)
[[nodiscard]] std::string with_spoilt_values(const std::string& bytes, Random& random);

}  // namespace palpable::fuzz

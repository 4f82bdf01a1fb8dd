/// @file
/// Damage to our own HDF5 files that their checksum does not show.
#pragma once

#include "tests/fuzz/mutations.h"

#include <string>

namespace palpable::fuzz {

/// One to eight numbers of datasets and attributes made others, through HDF5, and the checksum made
/// anew: what somebody might write who knows the format. (Damage to HDF5's own structure behind a
/// checksum is not tried: HDF5 1.10 does not survive it, and nobody does that by accident.)
[[nodiscard]] std::string with_spoilt_values(const std::string& bytes, Random& random);

}  // namespace palpable::fuzz

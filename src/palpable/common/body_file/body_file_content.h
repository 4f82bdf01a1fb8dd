/// @file
/// The two halves of body_file.h: a body into an HDF5 file that is open, and out of one. The layout
/// is docs/body_file.md's.
#pragma once

#include "palpable/common/body_file/body_file.h"
#include "palpable/common/body_file/hdf5_tools.h"

namespace palpable::body_file {

/// What `between` says of an axis.
inline constexpr const char* kNothing = "nothing";
inline constexpr const char* kSpline = "cubic spline, not-a-knot";

/// @throws hdf5::Trouble when a table of the body has not the size that another one says
void write_content(hid_t file, const ReducedBody& body, ModeStorage storage);

/// @throws hdf5::Trouble when anything is missing, of another size, or no number
[[nodiscard]] ReducedBody read_content(hid_t file);

}  // namespace palpable::body_file

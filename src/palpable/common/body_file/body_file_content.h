/// @file
/// Writes a body into an open HDF5 file, and reads it from one: the two parts of body_file.h.
/// Layout: docs/body_file.md.
#pragma once

#include "palpable/common/body_file/body_file.h"
#include "palpable/common/body_file/hdf5_tools.h"

namespace palpable::body_file {

/// The values of the attribute `between` of an axis.
inline constexpr const char* kNothing = "nothing";
inline constexpr const char* kSpline = "cubic spline, not-a-knot";

/// @throws hdf5::Trouble if the sizes of the body's tables do not agree
void write_content(hid_t file, const ReducedBody& body, ModeStorage storage);

/// @throws hdf5::Trouble if anything is missing, of a wrong size, or not a number
[[nodiscard]] ReducedBody read_content(hid_t file);

/// The group /provenance of a body file or of a snapshot store: the provenance as JSON, and `count`
/// = 0, the number of lines of the older layout, which programs that know only that one read.
void write_provenance(hid_t file, const Provenance& provenance);

/// Reads that group, in the older layout, too. @throws hdf5::Trouble if it is missing or damaged
[[nodiscard]] Provenance read_provenance(hid_t file);

}  // namespace palpable::body_file

/// @file
/// The parts of body_file.h: writes a body into an open HDF5 file and reads it from one, and
/// further groups, which hold data of a body beyond ReducedBody. The file's checksum covers them,
/// and a reader that does not know a group skips it. Layout: docs/body_file.md.
#pragma once

#include "palpable/common/body_file/body_file.h"
#include "palpable/common/body_file/hdf5_tools.h"

#include <filesystem>
#include <functional>

namespace palpable {

/// Writes groups into the file, beside those of docs/body_file.md. May throw hdf5::Trouble.
using WriteGroups = std::function<void(hid_t file)>;

/// Reads groups of a file whose checksum and body are valid. Throws hdf5::Trouble for an invalid
/// group; then reading the file fails.
using ReadGroups = std::function<void(hid_t file, const ReducedBody& body)>;

/// write_body_file() with further groups. @throws Error as that, and for what `further` throws
ReductionError write_body_file(const std::filesystem::path& path, const ReducedBody& body,
                               ModeStorage storage, const WriteGroups& further);

/// read_body_file() that also calls `further`, so that the file is read and checked only once.
[[nodiscard]] Result<ReducedBody> read_body_file(const std::filesystem::path& path,
                                                 const ReadGroups& further);

}  // namespace palpable

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

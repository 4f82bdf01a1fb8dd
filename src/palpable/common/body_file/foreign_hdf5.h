/// @file
/// Reads HDF5 files of other programs. HDF5 1.10 does not survive every damaged file (it reads
/// invalid memory, or never ends), and unlike our files these have no checksum that could be
/// compared before. So they are read in a child process, which may crash.
#pragma once

#include "palpable/common/body_file/hdf5_tools.h"

#include <filesystem>
#include <string>
#include <vector>

namespace palpable::hdf5 {

/// Thrown by read_foreign() if the file can be read but has no such dataset.
struct MissingDataset : Trouble {};

/// The numbers of a dataset, the last index fastest.
struct ForeignNumbers {
  std::vector<std::size_t> size;  ///< along each of 0 to 8 dimensions; their product is the count
  std::vector<double> values;
};

/// Reads integers and floating-point numbers of any size, contiguous or in chunks, compressed or
/// not. The child process costs a millisecond beside the reading; it is stopped after a minute of
/// processor time.
/// @throws MissingDataset, or Trouble, which does not name the file: not an HDF5 file, not numbers,
///         damaged
[[nodiscard]] ForeignNumbers read_foreign(const std::filesystem::path& path,
                                          const std::string& dataset);

}  // namespace palpable::hdf5

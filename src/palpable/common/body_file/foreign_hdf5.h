/// @file
/// HDF5 files of other programs. HDF5 1.10 does not survive every damaged file (it reads memory
/// that is not its own, or never ends), and unlike ours theirs have no checksum that could be
/// compared before. So they are read in a process of their own, which may die.
#pragma once

#include "palpable/common/body_file/hdf5_tools.h"

#include <filesystem>
#include <string>
#include <vector>

namespace palpable::hdf5 {

/// What read_foreign() throws when the file can be read, and has no such dataset.
struct MissingDataset : Trouble {};

/// The numbers of a dataset, the last index fastest.
struct ForeignNumbers {
  std::vector<std::size_t> size;  ///< along each of 0 to 8 dimensions; their product is the count
  std::vector<double> values;
};

/// Integers and floating-point numbers of any size, in one piece or in chunks, packed or not.
/// Costs a millisecond for the process beside the reading; a minute of computing at most.
/// @throws MissingDataset, or Trouble which does not name the file: no HDF5 file, no such dataset,
/// not numbers,
///         damaged
[[nodiscard]] ForeignNumbers read_foreign(const std::filesystem::path& path,
                                          const std::string& dataset);

}  // namespace palpable::hdf5

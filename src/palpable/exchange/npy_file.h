/// @file
/// NumPy's own files (.npy): one array each.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

namespace palpable {

/// An array in C order: the last index runs fastest.
struct NpyArray {
  std::vector<std::size_t> shape;
  std::vector<double> values;
};

/// Writes single precision, double precision or 32-bit integers.
/// @throws Error if the file cannot be written
/// @throws ContractViolation if shape and number of values differ
template <class T>
void write_npy(const std::filesystem::path& path, const std::vector<std::size_t>& shape,
               std::span<const T> values);

/// Reads little-endian floats of 4 or 8 bytes and integers of 4 or 8 bytes, C or Fortran order.
/// @throws Error for anything else, and for a file that is missing, cut or damaged
[[nodiscard]] NpyArray read_npy(const std::filesystem::path& path);

}  // namespace palpable

/// @file
/// Reads and writes NumPy's files (.npy), which hold one array each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// Header of a .npy file.
struct NpyHeader {
  std::vector<std::size_t> shape;
  std::string type;               ///< as in the file, e.g. "<f8"
  bool column_by_column = false;  ///< Fortran's order: the first index runs fastest
  std::size_t begin = 0;          ///< byte at which the numbers begin

  /// Number of values, the product of the shape; SIZE_MAX if it is 2^31 or more.
  [[nodiscard]] std::size_t count() const;
  /// Bytes of one number; 0 for a type that cannot be read.
  [[nodiscard]] std::size_t number_size() const;
};

/// An array in C order: the last index runs fastest.
struct NpyArray {
  std::vector<std::size_t> shape;
  std::vector<double> values;
};

/// Parses the header of a file's bytes.
/// @param name  of the file, for messages
/// @throws Error when the bytes do not begin with a header
[[nodiscard]] NpyHeader npy_header(const std::string& bytes, const std::string& name);

/// Why a file is not read, judged by its first bytes (FileBound::why_not): no header, or a shape
/// that needs more bytes than the file has. Empty: nothing is wrong.
[[nodiscard]] std::string why_no_npy(std::string_view first, std::uintmax_t size);

/// The numbers behind the header: little-endian floats or integers of 4 or 8 bytes.
/// @throws Error for numbers of another type, and if there are fewer than the shape requires
[[nodiscard]] NpyArray npy_array(const NpyHeader& header, const std::string& bytes,
                                 const std::string& name);

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

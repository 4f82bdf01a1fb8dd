/// @file
/// Tools for reading and writing HDF5 files: identifiers that close themselves, tables, texts, and
/// whole files as bytes with a checksum (docs/body_file.md, docs/snapshots.md).
///
/// HDF5 is not thread-safe: where several threads may use it, callers hold the lock turn().
#pragma once

#include <Eigen/Core>
#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <hdf5.h>
#include <mutex>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace palpable::hdf5 {

/// Largest count of anything that a file may hold: a guard against absurd sizes in a damaged
/// file, far above anything real.
inline constexpr hsize_t kLargestCount = 200'000'000;

/// Thrown by all functions here. Callers turn it into an Error or a Problem that names the file.
struct Trouble {
  std::string what;
};

/// An HDF5 identifier that closes itself.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t), const std::string& what) : id_(id), close_(close) {
    if (id < 0) throw Trouble{what};
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() { close_(id_); }
  operator hid_t() const { return id_; }  // NOLINT: to be used like the identifier

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// Suppresses HDF5's printing of its error stack to stderr during this object's lifetime.
class Quiet {
 public:
  Quiet() {
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;
  ~Quiet() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

[[nodiscard]] inline hid_t native(float) { return H5T_NATIVE_FLOAT; }
[[nodiscard]] inline hid_t native(double) { return H5T_NATIVE_DOUBLE; }
[[nodiscard]] hid_t native(Eigen::half);  ///< IEEE 754 binary16
[[nodiscard]] inline hid_t native(int) { return H5T_NATIVE_INT; }
[[nodiscard]] inline hid_t native(std::int16_t) { return H5T_NATIVE_INT16; }
[[nodiscard]] inline hid_t native(std::uint8_t) { return H5T_NATIVE_UINT8; }

void check(herr_t status, const std::string& what);
void require(bool condition, const std::string& what);

/// Eigen stores matrices by columns, HDF5 by rows: a (r x c) matrix is written as a dataset of c
/// rows and r columns, so that each row of the dataset is one vertex, triangle or mode.
void write_bytes(hid_t file, const char* name, hid_t type, const void* data, hsize_t rows,
                 hsize_t columns);
template <class T>
void write_table(hid_t file, const char* name, const T* data, hsize_t rows, hsize_t columns) {
  write_bytes(file, name, native(T{}), data, rows, columns);
}
/// Writes a contiguous dataset of any number of dimensions, of which parts can be read alone.
void write_block(hid_t file, const char* name, const float* data, const std::vector<hsize_t>& size);

void write_text(hid_t object, const char* name, const std::string& text);
void write_number(hid_t object, const char* name, double value);
[[nodiscard]] Handle make_group(hid_t file, const char* name);

template <class T>
struct Table {
  std::vector<T> data;  ///< rows * columns, row by row
  hsize_t rows = 0;
  hsize_t columns = 0;
};

template <class T>
Table<T> read_table(hid_t file, const char* name) {
  const Handle set(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose,
                   fmt::format("dataset '{}' is missing", name));
  const Handle type(H5Dget_type(set), H5Tclose, fmt::format("dataset '{}' has no type", name));
  constexpr bool is_integer = std::is_integral_v<T>;
  if (H5Tget_class(type) != (is_integer ? H5T_INTEGER : H5T_FLOAT)) {
    throw Trouble{fmt::format("dataset '{}' does not hold {}", name,
                              is_integer ? "integers" : "floating-point numbers")};
  }
  const Handle space(H5Dget_space(set), H5Sclose, fmt::format("dataset '{}' has no size", name));
  if (H5Sget_simple_extent_ndims(space) != 2) {
    throw Trouble{fmt::format("dataset '{}' is not a table", name)};
  }
  hsize_t size[2];
  H5Sget_simple_extent_dims(space, size, nullptr);
  if (size[0] > kLargestCount || size[1] > kLargestCount ||
      (size[1] > 0 && size[0] > kLargestCount / size[1])) {
    throw Trouble{fmt::format("dataset '{}' claims {} x {} values", name, size[0], size[1])};
  }
  // A damaged header may claim more than the file holds: allocate only what is stored.
  if (H5Dget_storage_size(set) < size[0] * size[1] * H5Tget_size(type)) {
    throw Trouble{fmt::format("dataset '{}' is cut short", name)};
  }
  Table<T> table{std::vector<T>(size[0] * size[1]), size[0], size[1]};
  if (!table.data.empty() &&
      H5Dread(set, native(T{}), H5S_ALL, H5S_ALL, H5P_DEFAULT, table.data.data()) < 0) {
    throw Trouble{fmt::format("dataset '{}' is damaged", name)};
  }
  return table;
}

template <class T>
Table<T> read_table(hid_t file, const char* name, hsize_t rows, hsize_t columns) {
  Table<T> table = read_table<T>(file, name);
  if (table.rows != rows || table.columns != columns) {
    throw Trouble{fmt::format("dataset '{}' is {} x {} where {} x {} is needed", name, table.rows,
                              table.columns, rows, columns)};
  }
  return table;
}

[[nodiscard]] std::string read_text(hid_t object, const char* name);
[[nodiscard]] double read_number(hid_t object, const char* name);
[[nodiscard]] bool has(hid_t object, const char* attribute);
[[nodiscard]] bool has_link(hid_t group, const char* name);  ///< a dataset or group of that name
[[nodiscard]] Handle open_group(hid_t file, const char* name);

/// The bytes of a whole file: a user block, and behind it the HDF5 file that `fill` writes in
/// memory. (User blocks are a feature of HDF5; its tools skip them.) The user block is a short
/// text, "KIND, layout N", with the size and a checksum of the rest. Readers compare it before HDF5
/// gets the bytes, because HDF5 1.10 does not survive every damaged file (the fuzz test found reads
/// of freed memory). The file is written in memory, because HDF5 cannot close its file after the
/// disk is full.
[[nodiscard]] std::string image_of(std::string_view kind, int layout,
                                   const std::function<void(hid_t)>& fill);

/// Writes an HDF5 file of any size piece by piece, under the name part_of(path), and then renames
/// it: a reader sees the old file or the complete new one. The part is removed after any failure,
/// unless the process is killed.
/// @param before_rename  called before the rename; if it throws, the new file is removed
/// @throws Trouble if it cannot be written, e.g. on a full disk; also what the functions throw
void write_file(const std::filesystem::path& path, const std::function<void(hid_t)>& fill,
                const std::function<void()>& before_rename);

/// The lock that protects HDF5: Debian's build of it is not thread-safe. To be held during all use
/// of HDF5 where other threads may use it, too.
[[nodiscard]] std::mutex& turn();

/// A kind of file that image_of() makes.
struct ImageKind {
  std::string_view kind;
  int layout = 0;
  std::string_view what;    ///< e.g. "a body file of Palpable", for messages
  std::string_view remedy;  ///< e.g. "bake the body again", likewise
};

/// An HDF5 file in memory, opened from the bytes of image_of() after their checksum is verified.
class Image {
 public:
  Image(const std::string& bytes, const ImageKind& kind);
  [[nodiscard]] hid_t file() const { return file_; }

 private:
  Handle file_;
};

/// The bytes of a file that image_of() made. Its kind, layout and size are read from its user block
/// before the rest; Image checks the checksum.
/// @throws Trouble if it is of another kind, truncated, above kLargestImage or cannot be read
[[nodiscard]] std::string image_bytes(const std::filesystem::path& path, const ImageKind& kind);

/// The bytes of a file for a copy or comparison. @throws Trouble as image_bytes()
[[nodiscard]] std::string all_bytes(const std::filesystem::path& path);

/// Writes a file under another name, syncs it and renames it: a reader sees the old file or the
/// complete new one. The other name is `output` + `suffix`, or part_of(output) without a suffix;
/// that file is removed after any failure, unless the process is killed. If `output` is a symbolic
/// link, its target is replaced.
void write_durably(const std::filesystem::path& output, std::string_view bytes,
                   const std::string& suffix = {});

}  // namespace palpable::hdf5

#include "palpable/common/body_file/hdf5_tools.h"

#include "palpable/common/base/checksum.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/whole_file.h"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <span>
#include <unistd.h>
#include <utility>

namespace palpable::hdf5 {
namespace {

constexpr std::size_t kUserBlock = 512;

// The user block that must precede `content`.
std::string user_block(std::string_view kind, int layout, std::string_view content) {
  std::string block = fmt::format("{}, layout {}\nbytes {}\nfnv1a {:016x}\n", kind, layout,
                                  content.size(), fnv1a(content));
  block.resize(kUserBlock, '\0');
  return block;
}

// Largest file that is read into memory, bytes: a site's snapshots on a million nodes at 26 levels,
// with stress, have 2 GB. Larger models are split into sites anyway.
constexpr std::uintmax_t kLargestImage = 4'000'000'000;

// Why a file with these first bytes and this size is not read; empty: nothing is wrong so far.
std::string why_no_image(std::string_view first, std::uintmax_t size, const ImageKind& kind) {
  const std::string magic = fmt::format("{}, layout ", kind.kind);
  if (!first.starts_with(magic)) return fmt::format("not {}", kind.what);
  const std::string_view rest = first.substr(magic.size());
  const std::string_view version = rest.substr(0, rest.find('\n'));
  if (version != std::to_string(kind.layout)) {
    return fmt::format("layout version '{}' where this program reads {}; {}", version.substr(0, 20),
                       kind.layout, kind.remedy);
  }
  // The block's beginning, up to the checksum, follows from the file's size.
  const std::uintmax_t content = size - std::min<std::uintmax_t>(size, kUserBlock);
  if (content == 0 ||
      !first.starts_with(fmt::format("{}{}\nbytes {}\n", magic, version, content))) {
    return fmt::format(
        "truncated or damaged (it has {} bytes behind its header, which announces others); copy it "
        "again or {}",
        content, kind.remedy);
  }
  return {};
}

void check_user_block(std::string_view bytes, const ImageKind& kind) {
  if (std::string why = why_no_image(bytes, bytes.size(), kind); !why.empty()) {
    throw Trouble{std::move(why)};
  }
  if (bytes.substr(0, kUserBlock) != user_block(kind.kind, kind.layout, bytes.substr(kUserBlock))) {
    throw Trouble{fmt::format("truncated or damaged (its checksum differs); copy it again or {}",
                              kind.remedy)};
  }
}

// A file that could not be closed because the disk was full stays open within HDF5. Its exit
// handler would try again at the program's end and read freed memory, so the handler is not
// installed. We close all files that we open.
const bool kNoHandlerAtExit = H5dont_atexit() >= 0;

// The system's message for the last failed call, if it is about space on the disk; otherwise empty.
std::string room_on_disk() {
  const int problem = errno;
  const bool is_room = problem == ENOSPC || problem == EFBIG || problem == EDQUOT || problem == EIO;
  return is_room ? fmt::format(": {}", std::strerror(problem)) : std::string();
}

Handle in_memory() { return Handle(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "no memory"); }

Handle open_image(const std::string& bytes, const ImageKind& kind) {
  check_user_block(bytes, kind);
  const Handle access = in_memory();
  check(H5Pset_fapl_core(access, std::size_t{1} << 20, false), "no memory");
  check(H5Pset_file_image(access, const_cast<char*>(bytes.data()) + kUserBlock,
                          bytes.size() - kUserBlock),
        "no memory");
  return Handle(H5Fopen("image", H5F_ACC_RDONLY, access), H5Fclose, "HDF5 cannot open it");
}

// Flushes a file, or the folder that names it, to the disk.
void sync_to_disk(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return;  // it cannot be opened, so it cannot be flushed
  ::fsync(descriptor);
  ::close(descriptor);
}

// Renames a complete file and syncs its folder, so that the new name survives a power failure. The
// file is removed if renaming fails.
void put_into_place(const std::filesystem::path& aside, const std::filesystem::path& path) {
  if (::rename(aside.c_str(), path.c_str()) != 0) {
    const int problem = errno;
    ::unlink(aside.c_str());
    throw Trouble{std::strerror(problem)};
  }
  sync_to_disk(path.parent_path().empty() ? "." : path.parent_path());
}

}  // namespace

hid_t native(Eigen::half) {
  static const hid_t type = [] {
    const hid_t half = H5Tcopy(H5T_NATIVE_FLOAT);  // closed with HDF5, when the program ends
    H5Tset_fields(half, 15, 10, 5, 0, 10);
    H5Tset_size(half, 2);
    H5Tset_ebias(half, 15);
    return half;
  }();
  return type;
}

void check(herr_t status, const std::string& what) {
  if (status < 0) throw Trouble{what};
}

void require(bool condition, const std::string& what) {
  if (!condition) throw Trouble{what};
}

void write_bytes(hid_t file, const char* name, hid_t type, const void* data, hsize_t rows,
                 hsize_t columns) {
  const hsize_t size[2] = {rows, columns};
  const Handle space(H5Screate_simple(2, size, nullptr), H5Sclose, "no memory");
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "no memory");
  // Without times, so that the same content gives the same bytes.
  check(H5Pset_obj_track_times(creation, false), name);
  // Contiguous, without HDF5's own checksums: the whole file has one.
  const Handle set(H5Dcreate2(file, name, type, space, H5P_DEFAULT, creation, H5P_DEFAULT),
                   H5Dclose, fmt::format("dataset '{}' cannot be made", name));
  if (rows * columns > 0) {
    check(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data),
          fmt::format("dataset '{}' cannot be written", name));
  }
}

void write_block(hid_t file, const char* name, const float* data,
                 const std::vector<hsize_t>& size) {
  const Handle space(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr),
                     H5Sclose, "no memory");
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "no memory");
  check(H5Pset_obj_track_times(creation, false), name);
  const Handle set(
      H5Dcreate2(file, name, H5T_NATIVE_FLOAT, space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose,
      fmt::format("dataset '{}' cannot be made", name));
  check(H5Dwrite(set, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, data),
        fmt::format("dataset '{}' cannot be written", name));
}

void write_text(hid_t object, const char* name, const std::string& text) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, "no memory");
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "no memory");
  check(H5Tset_size(type, std::max<std::size_t>(text.size(), 1)), name);
  check(H5Tset_strpad(type, H5T_STR_NULLPAD), name);
  check(H5Tset_cset(type, H5T_CSET_UTF8), name);
  const Handle attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                         fmt::format("attribute '{}' cannot be made", name));
  const std::string padded = text.empty() ? std::string(1, '\0') : text;
  check(H5Awrite(attribute, type, padded.data()), name);
}

void write_number(hid_t object, const char* name, double value) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, "no memory");
  const Handle attribute(
      H5Acreate2(object, name, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
      fmt::format("attribute '{}' cannot be made", name));
  check(H5Awrite(attribute, H5T_NATIVE_DOUBLE, &value), name);
}

Handle make_group(hid_t file, const char* name) {
  const Handle creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, "no memory");
  check(H5Pset_obj_track_times(creation, false), name);
  return Handle(H5Gcreate2(file, name, H5P_DEFAULT, creation, H5P_DEFAULT), H5Gclose,
                fmt::format("group '{}' cannot be made", name));
}

std::string read_text(hid_t object, const char* name) {
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose,
                         fmt::format("attribute '{}' is missing", name));
  const Handle type(H5Aget_type(attribute), H5Tclose,
                    fmt::format("attribute '{}' is damaged", name));
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0) {
    throw Trouble{fmt::format("attribute '{}' is not a text", name)};
  }
  const Handle space(H5Aget_space(attribute), H5Sclose, name);
  if (H5Sget_simple_extent_npoints(space) != 1) {
    throw Trouble{fmt::format("attribute '{}' is not one text", name)};
  }
  std::string text(H5Tget_size(type), '\0');
  if (H5Aread(attribute, type, text.data()) < 0) {
    throw Trouble{fmt::format("attribute '{}' is damaged", name)};
  }
  text.resize(std::min(text.find('\0'), text.size()));
  return text;
}

double read_number(hid_t object, const char* name) {
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose,
                         fmt::format("attribute '{}' is missing", name));
  const Handle type(H5Aget_type(attribute), H5Tclose, name);
  const Handle space(H5Aget_space(attribute), H5Sclose, name);
  double value = 0;
  if (H5Tget_class(type) != H5T_FLOAT || H5Sget_simple_extent_npoints(space) != 1 ||
      H5Aread(attribute, H5T_NATIVE_DOUBLE, &value) < 0) {
    throw Trouble{fmt::format("attribute '{}' is not a number", name)};
  }
  return value;
}

bool has(hid_t object, const char* attribute) { return H5Aexists(object, attribute) > 0; }

bool has_link(hid_t group, const char* name) { return H5Lexists(group, name, H5P_DEFAULT) > 0; }

Handle open_group(hid_t file, const char* name) {
  return Handle(H5Gopen2(file, name, H5P_DEFAULT), H5Gclose,
                fmt::format("group '{}' is missing", name));
}

std::string image_of(std::string_view kind, int layout, const std::function<void(hid_t)>& fill) {
  const Handle access = in_memory();
  check(H5Pset_fapl_core(access, std::size_t{1} << 20, false), "no memory");
  const Handle file(H5Fcreate("image that is written", H5F_ACC_TRUNC, H5P_DEFAULT, access),
                    H5Fclose, "no memory");
  fill(file);
  check(H5Fflush(file, H5F_SCOPE_GLOBAL), "no memory");
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  if (size <= 0) throw Trouble{"no memory"};
  std::string bytes(kUserBlock + static_cast<std::size_t>(size), '\0');
  if (H5Fget_file_image(file, bytes.data() + kUserBlock, static_cast<std::size_t>(size)) != size) {
    throw Trouble{"no memory"};
  }
  const std::string block = user_block(kind, layout, std::string_view(bytes).substr(kUserBlock));
  std::copy(block.begin(), block.end(), bytes.begin());
  return bytes;
}

void write_file(const std::filesystem::path& path, const std::function<void(hid_t)>& fill,
                const std::function<void()>& before_rename) {
  const std::filesystem::path aside = part_of(path);
  errno = 0;
  const hid_t file = H5Fcreate(aside.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  if (file < 0) {
    const std::string room = room_on_disk();
    ::unlink(aside.c_str());
    throw Trouble{"cannot be written" + (room.empty() ? std::string("; does the folder exist and "
                                                                    "may you write there?")
                                                      : room)};
  }
  errno = 0;
  try {
    fill(file);
    check(H5Fflush(file, H5F_SCOPE_GLOBAL), "cannot be written");
  } catch (const Trouble& trouble) {
    const std::string why = trouble.what + room_on_disk();
    H5Fclose(file);
    ::unlink(aside.c_str());
    throw Trouble{why};
  } catch (...) {
    H5Fclose(file);
    ::unlink(aside.c_str());
    throw;
  }
  const bool closed = H5Fclose(file) >= 0;
  const std::string why = "cannot be written" + room_on_disk();
  try {
    require(closed, why);
    sync_to_disk(aside);
    before_rename();
    put_into_place(aside, path);
  } catch (...) {
    ::unlink(aside.c_str());
    throw;
  }
}

Image::Image(const std::string& bytes, const ImageKind& kind) : file_(open_image(bytes, kind)) {}

std::string image_bytes(const std::filesystem::path& path, const ImageKind& kind) {
  const auto why_not = [&](std::string_view first, std::uintmax_t size) {
    return why_no_image(first, size, kind);
  };
  Result<std::string> bytes = read_whole_file(path, {.most = kLargestImage, .why_not = why_not});
  if (!bytes) throw Trouble{bytes.problem().message};
  return std::move(bytes).value();
}

std::string all_bytes(const std::filesystem::path& path) {
  Result<std::string> bytes = read_whole_file(path, {.most = kLargestImage});
  if (!bytes) throw Trouble{bytes.problem().message};
  return std::move(bytes).value();
}

void write_durably(const std::filesystem::path& output, std::string_view bytes,
                   const std::string& suffix) {
  const std::filesystem::path path = behind_links(output);
  std::filesystem::path aside = suffix.empty() ? part_of(path) : path;
  aside += suffix;
  const int file = ::open(aside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) {
    throw Trouble{
        fmt::format("cannot be created ({}); does the folder exist and may you write there?",
                    std::strerror(errno))};
  }
  const auto give_up = [&](int problem) {
    ::close(file);
    ::unlink(aside.c_str());
    throw Trouble{fmt::format("cannot be written: {}", std::strerror(problem))};
  };
  if (!write_all(file, std::as_bytes(std::span(bytes)))) give_up(errno);
  // EINVAL, ENOTSUP: the file system cannot sync, which is no error here.
  if (::fsync(file) != 0 && errno != EINVAL && errno != ENOTSUP) give_up(errno);
  ::close(file);
  put_into_place(aside, path);
}

std::mutex& turn() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace palpable::hdf5

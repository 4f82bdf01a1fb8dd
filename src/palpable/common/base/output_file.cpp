#include "palpable/common/base/output_file.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/text_numbers.h"

#include <fmt/core.h>
#include <fmt/format.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <limits>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr mode_t kAllMayReadAndWrite = 0666;  // minus the user's umask

// Links that are followed before they are taken for a circle, as in Linux.
constexpr int kMostLinks = 40;

[[noreturn]] void refuse_unwritable(const fs::path& file, int reason) {
  throw Error(fmt::format("{}: cannot be written: {}", file.string(), std::strerror(reason)));
}

std::string suffix_of_this_machine() {
  char host[256] = {};
  ::gethostname(host, sizeof host - 1);
  return fmt::format(".part-{}-", host);
}

void append_all(GrowingFile& file, std::initializer_list<std::string_view> pieces) {
  for (const std::string_view piece : pieces) file.append(piece);
  file.close();
}

// Renames `aside` to `file`, and gives it the permissions of the former file if there is one.
// @return 0, or errno
int put_into_place(const fs::path& aside, const fs::path& file) {
  struct stat before {};
  if (::stat(file.c_str(), &before) == 0) {
    constexpr mode_t kPermissions = 07777;
    // This may be forbidden; then the new file has other permissions, but its content is kept.
    static_cast<void>(::chmod(aside.c_str(), before.st_mode & kPermissions) == 0);
  }
  return ::rename(aside.c_str(), file.c_str()) == 0 ? 0 : errno;
}

// @throws Error if the folder of `at` does not exist. @param output  as given, for the message
void expect_folder_above(const fs::path& output, const fs::path& at) {
  std::error_code error;
  // Fails where the working folder itself is gone.
  const fs::path folder = fs::absolute(at, error).parent_path();
  if (error) throw Error(fmt::format("{}: its folder does not exist", output.string()));
  if (!fs::is_directory(folder, error)) {
    throw Error(fmt::format("{}: the folder {} does not exist", output.string(), folder.string()));
  }
}

}  // namespace

bool write_all(int descriptor, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count == 0) errno = ENOSPC;
    if (count <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return true;
}

GrowingFile::GrowingFile(const fs::path& path, fs::path called) : called_(std::move(called)) {
  descriptor_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, kAllMayReadAndWrite);
  if (descriptor_ < 0) refuse_unwritable(called_, errno);
}

GrowingFile::GrowingFile(const fs::path& path, Opening opening) : called_(path), opening_(opening) {
  const int further = opening == Opening::kEmptied ? O_TRUNC
                      : opening == Opening::kNew   ? O_EXCL
                                                   : 0;
  descriptor_ = ::open(behind_links(path).c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | further,
                       kAllMayReadAndWrite);
  if (descriptor_ < 0 && errno == EEXIST) {
    throw Error(fmt::format("{}: is there already", path.string()));
  }
  if (descriptor_ < 0) refuse_unwritable(called_, errno);
  if (opening == Opening::kEmptied) return;
  // File systems without locks (some of NFS) do not keep two runs apart.
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  ::close(std::exchange(descriptor_, -1));
  throw Error(fmt::format("{}: another run is writing it; wait for its end, or name another file",
                          path.string()));
}

GrowingFile::~GrowingFile() {
  if (descriptor_ < 0) return;
  if (opening_ == Opening::kNew && !has_piece_) ::unlink(behind_links(called_).c_str());
  ::close(descriptor_);
}

void GrowingFile::append(std::string_view piece) {
  PALPABLE_EXPECT(descriptor_ >= 0, "nothing is appended to a file that was closed");
  if (!std::exchange(has_piece_, true) && opening_ == Opening::kAlone) {
    struct stat status {};
    const bool is_file = ::fstat(descriptor_, &status) == 0 && S_ISREG(status.st_mode);
    // A pipe has nothing to cut off.
    if (is_file && ::ftruncate(descriptor_, 0) != 0) refuse_unwritable(called_, errno);
  }
  if (write_all(descriptor_, std::as_bytes(std::span(piece)))) {
    size_ += std::ssize(piece);
    return;
  }
  const int reason = errno;
  // This fails for a device or a pipe, which has nothing that could be cut off.
  const bool cut =
      ::ftruncate(descriptor_, size_) == 0 && ::lseek(descriptor_, size_, SEEK_SET) == size_;
  static_cast<void>(cut);
  refuse_unwritable(called_, reason);
}

void GrowingFile::close() {
  if (descriptor_ < 0) return;
  // Some file systems (NFS, quotas) report a lack of space only now.
  if (::close(std::exchange(descriptor_, -1)) != 0 && errno != EINTR)
    refuse_unwritable(called_, errno);
}

std::string own_part_suffix() { return suffix_of_this_machine() + std::to_string(::getpid()); }

bool is_part_of_running_process(std::string_view name) {
  const std::string suffix = suffix_of_this_machine();
  const std::size_t at = name.find(suffix);
  if (at == std::string_view::npos) return false;
  const auto process = to_whole_number(name.substr(at + suffix.size())).value_or(0);
  if (process <= 0 || process > std::numeric_limits<pid_t>::max()) return false;
  return ::kill(static_cast<pid_t>(process), 0) == 0 || errno == EPERM;
}

void expect_writable(const fs::path& file) {
  const fs::path at = behind_links(file);
  std::error_code error;
  if (fs::is_symlink(at, error)) refuse_unwritable(file, ELOOP);  // in a circle
  if (fs::exists(at, error)) {
    if (fs::is_directory(at, error)) refuse_unwritable(file, EISDIR);
    if (::access(at.c_str(), W_OK) != 0) refuse_unwritable(file, errno);
  }
  const fs::path aside = part_of(at);
  const bool was_there = fs::exists(aside, error);
  const int descriptor = ::open(aside.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, kAllMayReadAndWrite);
  if (descriptor < 0) refuse_unwritable(file, errno);
  ::close(descriptor);
  if (!was_there) ::unlink(aside.c_str());
}

fs::path part_of(const fs::path& file) {
  fs::path part = file;
  return part += fmt::format(".part-{}", ::getpid());
}

bool lies_in(const fs::path& path, const fs::path& folder) {
  std::error_code error;
  const fs::path inner = fs::weakly_canonical(fs::absolute(path, error), error);
  const fs::path outer = fs::weakly_canonical(fs::absolute(folder, error), error);
  if (inner.empty() || outer.empty()) return false;  // the working folder is gone
  const fs::path relative = inner.lexically_relative(outer);
  return !relative.empty() && *relative.begin() != "..";
}

fs::path behind_links(const fs::path& file) {
  fs::path at = file;
  std::error_code error;
  for (int links = 0; links < kMostLinks && fs::is_symlink(at, error); ++links) {
    const fs::path next = fs::read_symlink(at, error);
    if (error) break;
    at = next.is_absolute() ? next : at.parent_path() / next;
  }
  return at;
}

void guard_output_file(const fs::path& output, const std::vector<fs::path>& inputs) {
  if (output.empty()) throw Error("the name of the output is empty");
  std::error_code error;
  // Of `output`, not of behind_links(output): the pipe behind /dev/stdout has no name.
  const fs::file_status status = fs::status(output, error);
  const fs::path file = behind_links(output);
  if (!fs::exists(status)) expect_folder_above(output, file);
  if (fs::is_directory(status) || !file.has_filename()) {
    throw Error(fmt::format("{}: is a folder, and the output is a file; name the file in it",
                            output.string()));
  }
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw Error(
        fmt::format("{}: is no ordinary file and is not replaced; name a file", output.string()));
  }
  for (const fs::path& input : inputs) {
    if (input.empty()) continue;
    // A new file in an input folder destroys nothing.
    if (fs::exists(status) && (fs::equivalent(input, file, error) || lies_in(file, input))) {
      throw Error(fmt::format("{}: is read as input ({}) and would be destroyed; name another file",
                              output.string(), input.string()));
    }
  }
  expect_writable(output);
}

void guard_output_folder(const fs::path& output, const std::vector<fs::path>& inputs) {
  if (output.empty()) throw Error("the name of the output is empty");
  // "out/" means "out", which lies in the folder above.
  const fs::path folder = behind_links(output.has_filename() ? output : output.parent_path());
  expect_folder_above(output, folder);
  std::error_code error;
  const fs::file_status status = fs::status(folder, error);
  if (fs::exists(status) && !fs::is_directory(status)) {
    throw Error(
        fmt::format("{}: is a file, and the output is a folder; name another", output.string()));
  }
  for (const fs::path& input : inputs) {
    if (input.empty()) continue;
    if (lies_in(input, folder) || (fs::exists(status) && lies_in(folder, input))) {
      throw Error(
          fmt::format("{}: what is read as input ({}) could be destroyed; name a folder "
                      "that has nothing to do with it",
                      output.string(), input.string()));
    }
  }
}

void refuse_among_inputs(const fs::path& folder, const std::vector<fs::path>& inputs) {
  for (const fs::path& input : inputs) {
    if (input.empty()) continue;
    const bool by_name = input.filename().string().find_first_of("*?") != std::string::npos;
    const fs::path read = by_name ? fs::absolute(input).parent_path() : input;
    if (!lies_in(folder, read)) continue;
    if (lies_in(read, folder)) {
      throw Error(
          fmt::format("{}: is read by this run; write into another folder", folder.string()));
    }
    if (by_name) continue;
    throw Error(fmt::format("{}: lies in {}, which is read by this run; write into another folder",
                            folder.string(), input.string()));
  }
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
}

void write_whole_file(const fs::path& file, std::initializer_list<std::string_view> pieces) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    if (fs::is_directory(status)) refuse_unwritable(file, EISDIR);
    GrowingFile device(file);
    append_all(device, pieces);
    return;
  }
  const fs::path at = behind_links(file);
  if (fs::is_symlink(at, error)) refuse_unwritable(file, ELOOP);  // in a circle
  if (fs::exists(status) && ::access(at.c_str(), W_OK) != 0) refuse_unwritable(file, errno);
  const fs::path aside = part_of(at);
  int reason = 0;
  try {
    GrowingFile growing(aside, file);
    append_all(growing, pieces);
    reason = put_into_place(aside, at);
  } catch (const Error&) {
    ::unlink(aside.c_str());
    throw;
  }
  if (reason == 0) return;
  ::unlink(aside.c_str());
  refuse_unwritable(file, reason);
}

}  // namespace palpable

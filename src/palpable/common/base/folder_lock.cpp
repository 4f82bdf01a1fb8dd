#include "palpable/common/base/folder_lock.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"

#include <fmt/core.h>

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace palpable {
namespace {

namespace fs = std::filesystem;

// `folder` and the folders above it, as far as they are missing, innermost first.
std::vector<fs::path> missing_folders(const fs::path& folder) {
  std::vector<fs::path> missing;
  std::error_code ignored;
  fs::path at = fs::absolute(folder, ignored).lexically_normal();
  if (!at.has_filename()) at = at.parent_path();  // "out/"
  for (; at.has_relative_path() && !fs::exists(at, ignored); at = at.parent_path()) {
    missing.push_back(at);
  }
  return missing;
}

// Whether the opened file or folder still exists under its name: its previous holder may have
// removed it.
bool is_still(int descriptor, const fs::path& path) {
  struct stat opened {};
  struct stat named {};
  return ::fstat(descriptor, &opened) == 0 && ::stat(path.c_str(), &named) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

}  // namespace

FolderLock::FolderLock(const fs::path& folder, Holding holding) {
  const int operation = (holding == Holding::kAlone ? LOCK_EX : LOCK_SH) | LOCK_NB;
  while (true) {
    const std::vector<fs::path> missing = missing_folders(folder);
    make_folder(folder);
    descriptor_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor_ < 0 && errno != ENOENT) {
      throw Error(fmt::format("{}: cannot be opened: {}", folder.string(), std::strerror(errno)));
    }
    if (descriptor_ < 0) continue;
    if (::flock(descriptor_, operation) != 0 && errno == EWOULDBLOCK) {
      ::close(descriptor_);
      throw Error(
          fmt::format("{}: another run is writing into it; wait for its end, or write "
                      "into another folder",
                      folder.string()));
    }
    if (is_still(descriptor_, folder)) {
      made_ = missing;
      return;
    }
    ::close(descriptor_);
  }
}

FolderLock::~FolderLock() {
  std::error_code ignored;
  for (const fs::path& folder : made_) fs::remove(folder, ignored);  // only where it is empty
  ::close(descriptor_);
}

fs::path lock_beside(const fs::path& file) {
  fs::path beside = behind_links(file);
  return beside += ".lock";
}

OutputLock::OutputLock(const fs::path& file) : beside_(lock_beside(file)) {
  constexpr mode_t kAllMayReadAndWrite = 0666;
  while (true) {
    descriptor_ = ::open(beside_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, kAllMayReadAndWrite);
    if (descriptor_ < 0) return;  // whether the file can be written is checked elsewhere
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      ::close(descriptor_);
      throw Error(fmt::format(
          "{}: another run is making it; wait for its end, or name another file", file.string()));
    }
    if (is_still(descriptor_, beside_)) return;
    ::close(descriptor_);
  }
}

OutputLock::~OutputLock() {
  if (descriptor_ < 0) return;
  std::error_code ignored;
  if (fs::file_size(beside_, ignored) == 0) fs::remove(beside_, ignored);
  ::close(descriptor_);
}

}  // namespace palpable

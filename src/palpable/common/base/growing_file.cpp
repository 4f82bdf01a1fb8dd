#include "palpable/common/base/growing_file.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"

#include <fmt/core.h>

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>
#include <utility>

namespace palpable {
namespace {

[[noreturn]] void report_unwritable(const std::filesystem::path& path, int reason) {
  throw Error(fmt::format("{}: cannot be written: {}", path.string(), std::strerror(reason)));
}

// @return 0, or errno
int write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(written));
    } else if (written < 0 && errno != EINTR) {
      return errno;
    }
  }
  return 0;
}

}  // namespace

GrowingFile::GrowingFile(const std::filesystem::path& path, std::filesystem::path called)
    : called_(std::move(called)) {
  constexpr mode_t kAllMayReadAndWrite = 0666;  // minus the user's umask
  descriptor_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, kAllMayReadAndWrite);
  if (descriptor_ < 0) report_unwritable(called_, errno);
}

GrowingFile::~GrowingFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void GrowingFile::append(std::string_view piece) {
  PALPABLE_EXPECT(descriptor_ >= 0, "nothing is appended to a file that was closed");
  const int reason = write_all(descriptor_, piece);
  if (reason == 0) {
    size_ += std::ssize(piece);
    return;
  }
  // This fails for a device or a pipe, which has nothing that could be cut off.
  const bool cut =
      ::ftruncate(descriptor_, size_) == 0 && ::lseek(descriptor_, size_, SEEK_SET) == size_;
  static_cast<void>(cut);
  report_unwritable(called_, reason);
}

void GrowingFile::close() {
  if (descriptor_ < 0) return;
  // Some file systems (NFS, quotas) report a lack of space only now.
  if (::close(std::exchange(descriptor_, -1)) != 0 && errno != EINTR)
    report_unwritable(called_, errno);
}

}  // namespace palpable

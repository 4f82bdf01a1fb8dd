#include "palpable/common/base/growing_file.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/write_all.h"

#include <fmt/core.h>

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <span>
#include <unistd.h>
#include <utility>

namespace palpable {
namespace {

[[noreturn]] void report_unwritable(const std::filesystem::path& path, int reason) {
  throw Error(fmt::format("{}: cannot be written: {}", path.string(), std::strerror(reason)));
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
  if (write_all(descriptor_, std::as_bytes(std::span(piece)))) {
    size_ += std::ssize(piece);
    return;
  }
  const int reason = errno;
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

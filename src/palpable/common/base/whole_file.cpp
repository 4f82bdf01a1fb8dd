#include "palpable/common/base/whole_file.h"

#include "palpable/common/base/plain_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <new>
#include <optional>
#include <stdexcept>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace palpable {
namespace {

// The machine's memory, used or free. If a program allocates more, the system may kill it without
// an error message.
std::uintmax_t bytes_of_memory() {
  return static_cast<std::uintmax_t>(::sysconf(_SC_PHYS_PAGES)) *
         static_cast<std::uintmax_t>(::sysconf(_SC_PAGESIZE));
}

// "5 MB", "1.5 MB", "0.02 MB"
std::string megabytes(std::uintmax_t bytes) {
  constexpr double kMegabyte = 1e6;
  return bytes >= 10 * static_cast<std::uintmax_t>(kMegabyte)
             ? fmt::format("{}", bytes / static_cast<std::uintmax_t>(kMegabyte))
             : fmt::format("{:.3g}", static_cast<double>(bytes) / kMegabyte);
}

// A file that is open for reading, and its size.
class OpenedFile {
 public:
  // @param path  of a regular file
  explicit OpenedFile(const std::filesystem::path& path)
      : descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
    struct stat status {};
    if (descriptor_ < 0 || ::fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) return;
    size_ = static_cast<std::uintmax_t>(status.st_size);
  }
  OpenedFile(const OpenedFile&) = delete;
  OpenedFile& operator=(const OpenedFile&) = delete;
  ~OpenedFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  [[nodiscard]] std::optional<std::uintmax_t> size() const { return size_; }

  // Appends the next bytes. @return false if they cannot be read or held
  [[nodiscard]] bool append(std::string& bytes, std::size_t count) const {
    const std::size_t before = bytes.size();
    bytes.resize(before + count);
    return read_all(descriptor_, std::as_writable_bytes(std::span(bytes).subspan(before)));
  }

 private:
  int descriptor_;
  std::optional<std::uintmax_t> size_;
};

}  // namespace

std::string why_no_file(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (std::filesystem::is_regular_file(status)) return {};
  if (!std::filesystem::exists(status)) return "no such file";
  if (std::filesystem::is_directory(status)) return "is a folder, not a file";
  return "is no regular file: a pipe or a device is not read";
}

Result<std::string> read_whole_file(const std::filesystem::path& path, const FileBound& bound) {
  if (std::string why = why_no_file(path); !why.empty()) return Problem{std::move(why)};
  const OpenedFile file(path);
  if (!file.size()) return Problem{"cannot be read"};
  const std::uintmax_t size = *file.size();
  const auto begin = static_cast<std::size_t>(std::min<std::uintmax_t>(size, kJudgedBytes));
  std::string bytes;
  if (!file.append(bytes, begin)) return Problem{"cannot be read"};
  if (bound.why_not) {
    if (std::string why = bound.why_not(bytes, size); !why.empty()) return Problem{std::move(why)};
  }
  if (size > bound.most) {
    return Problem{fmt::format("{} MB, where {} are read at most; {}", megabytes(size),
                               megabytes(bound.most), bound.remedy)};
  }
  const Problem too_large{fmt::format("{} MB are more than there is memory for", megabytes(size))};
  if (size > bytes_of_memory()) return too_large;
  try {
    bytes.reserve(static_cast<std::size_t>(size));
    if (!file.append(bytes, static_cast<std::size_t>(size) - begin)) {
      return Problem{"cannot be read"};
    }
  } catch (const std::bad_alloc&) { return too_large; } catch (const std::length_error&) {
    return too_large;
  }
  return bytes;
}

Result<std::string> read_text_file(const std::filesystem::path& path, const FileBound& bound) {
  FileBound of_text = bound;
  of_text.why_not = [&](std::string_view first, std::uintmax_t size) -> std::string {
    if (bound.why_not && !is_utf16(first)) {
      if (std::string why = bound.why_not(without_mark(first), size); !why.empty()) return why;
    }
    return why_no_text(first, size > first.size() ? TextPart::kFirst : TextPart::kAll);
  };
  Result<std::string> bytes = read_whole_file(path, of_text);
  if (!bytes) return bytes;
  return plain_text(std::move(bytes).value());
}

bool read_all(int descriptor, std::span<std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::read(descriptor, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return true;
}

}  // namespace palpable

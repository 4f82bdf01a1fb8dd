#include "palpable/common/base/whole_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <fstream>
#include <new>
#include <stdexcept>
#include <system_error>
#include <unistd.h>

namespace palpable {
namespace {

// The machine's memory, used or free. If a program allocates more, the system may kill it without
// an error message.
std::uintmax_t bytes_of_memory() {
  return static_cast<std::uintmax_t>(::sysconf(_SC_PHYS_PAGES)) *
         static_cast<std::uintmax_t>(::sysconf(_SC_PAGESIZE));
}

}  // namespace

Result<std::string> read_whole_file(const std::filesystem::path& path, std::uintmax_t most) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return Problem{"no such file"};
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  std::ifstream in(path, std::ios::binary);
  if (error || !in) return Problem{"cannot be read"};
  if (size > most) {
    return Problem{
        fmt::format("{} MB, where {} are read at most", size / 1'000'000, most / 1'000'000)};
  }
  const Problem too_large{fmt::format("{} MB are more than there is memory for", size / 1'000'000)};
  if (size > bytes_of_memory()) return too_large;
  std::string bytes;
  try {
    bytes.resize(size);
  } catch (const std::bad_alloc&) { return too_large; } catch (const std::length_error&) {
    return too_large;
  }
  in.read(bytes.data(), static_cast<std::streamsize>(size));
  if (!in) return Problem{"cannot be read"};
  return bytes;
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

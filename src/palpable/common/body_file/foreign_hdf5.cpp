#include "palpable/common/body_file/foreign_hdf5.h"

#include "palpable/common/base/file_format.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/whole_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <exception>
#include <fcntl.h>
#include <fstream>
#include <span>
#include <string_view>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpable::hdf5 {
namespace {

constexpr hsize_t kMostNumbers = 400'000'000;
constexpr int kMostDimensions = 8;
constexpr hsize_t kBestPacking = 1100;  // upper bound of compression ratios; zlib's best is 1032
constexpr std::size_t kLongestText = 10'000;
constexpr rlim_t kMostSeconds = 60;

// The header of the message through the pipe; the numbers follow, or the text of the error.
struct Header {
  bool ok = false, missing = false;
  int dimensions = 0;
  std::array<hsize_t, kMostDimensions> size{};
  std::size_t count = 0;  // of numbers, or of letters
};

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { close(); }
  void close() {
    if (number_ >= 0) ::close(number_);
    number_ = -1;
  }
  [[nodiscard]] int number() const { return number_; }

 private:
  int number_;
};

// @param file_size  bytes of the whole file
std::vector<double> numbers_of(hid_t set, const std::string& dataset, std::uintmax_t file_size,
                               Header& header) {
  const Handle type(H5Dget_type(set), H5Tclose, fmt::format("dataset '{}' has no type", dataset));
  const H5T_class_t kind = H5Tget_class(type);
  require(kind == H5T_INTEGER || kind == H5T_FLOAT,
          fmt::format("dataset '{}' does not hold numbers", dataset));
  const Handle space(H5Dget_space(set), H5Sclose, fmt::format("dataset '{}' has no size", dataset));
  header.dimensions = H5Sget_simple_extent_ndims(space);
  require(header.dimensions >= 0 && header.dimensions <= kMostDimensions,
          fmt::format("dataset '{}' has more than {} dimensions", dataset, kMostDimensions));
  check(H5Sget_simple_extent_dims(space, header.size.data(), nullptr), "damaged");
  hsize_t count = 1;
  for (int d = 0; d < header.dimensions; ++d) {
    require(header.size[d] <= kMostNumbers && count * header.size[d] <= kMostNumbers,
            fmt::format("dataset '{}' claims more than {} numbers", dataset, kMostNumbers));
    count *= header.size[d];
  }
  // A damaged header may claim more than the file holds: memory is allocated only for stored data.
  const hsize_t claimed = count * H5Tget_size(type);
  const hsize_t stored = H5Dget_storage_size(set);
  require(stored <= file_size && claimed <= kBestPacking * stored,
          fmt::format("dataset '{}' is cut short", dataset));
  std::vector<double> values(count);
  if (count > 0) {
    check(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
          fmt::format("dataset '{}' is damaged", dataset));
  }
  return values;
}

template <class T>
T number_at(std::string_view bytes, std::size_t at) {
  T value{};
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

// Why HDF5 does not open a file, by its superblock, which says how long the file is. It begins at
// byte 0, or at 512 times a power of two.
std::string why_not_opened(const std::filesystem::path& path) {
  constexpr std::size_t kLookedAt = 1 << 16, kLongestBlock = 64;
  std::error_code code;
  const std::uintmax_t size = std::filesystem::file_size(path, code);
  std::ifstream file(path, std::ios::binary);
  std::string bytes(kLookedAt + kLongestBlock, '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  for (std::size_t at = 0; at < bytes.size(); at = at == 0 ? 512 : 2 * at) {
    const std::string_view block = std::string_view(bytes).substr(at);
    if (!block.starts_with(kHdf5Mark)) continue;
    // Version; the width of addresses; where the address of the file's end is.
    const int version = block.size() > 8 ? block[8] : 0;
    const std::size_t width = version < 2 ? 13 : 9;
    const std::size_t end = version == 0 ? 40 : version == 1 ? 44 : 28;
    if (block.size() < end + sizeof(std::uint64_t)) return "is cut short within its header";
    const std::uint64_t length = number_at<std::uint64_t>(block, end);
    if (block[width] == 8 && at + length > size) {
      return fmt::format("is cut short: it has {} of {} bytes; copy it again", size, at + length);
    }
    return "is a damaged HDF5 file";
  }
  return "not an HDF5 file";
}

// Reads the dataset in the child process and sends it; never returns.
[[noreturn]] void read_and_send(const std::filesystem::path& path, const std::string& dataset,
                                int pipe) {
  // Messages that HDF5 or the C library print in a crash are suppressed.
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere >= 0) ::dup2(nowhere, STDERR_FILENO);
  const rlimit seconds{kMostSeconds, kMostSeconds}, none{0, 0};
  ::setrlimit(RLIMIT_CPU, &seconds);
  ::setrlimit(RLIMIT_CORE, &none);
  for (const int fault : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGXCPU}) {
    ::signal(fault, SIG_DFL);  // inherited handlers must not report a crash that is expected here
  }
  const Quiet quiet;
  Header header;
  std::vector<double> values;
  std::string wrong;
  try {
    const hid_t opened = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    const Handle file(opened, H5Fclose, opened < 0 ? why_not_opened(path) : std::string());
    header.missing = true;
    const Handle set(H5Dopen2(file, dataset.c_str(), H5P_DEFAULT), H5Dclose,
                     fmt::format("dataset '{}' is missing", dataset));
    header.missing = false;
    values = numbers_of(set, dataset, std::filesystem::file_size(path), header);
  } catch (const Trouble& trouble) { wrong = trouble.what; } catch (const std::exception&) {
    wrong = fmt::format("dataset '{}' needs more memory than there is", dataset);
  }
  header.ok = wrong.empty();
  header.count = header.ok ? values.size() : wrong.size();
  const bool sent = write_all(pipe, std::as_bytes(std::span(&header, 1))) &&
                    write_all(pipe, header.ok ? std::as_bytes(std::span(values))
                                              : std::as_bytes(std::span(wrong)));
  ::_exit(sent ? 0 : 1);
}

// Kills a child process, whether or not it has finished, and waits for its end.
class Child {
 public:
  explicit Child(pid_t process) : process_(process) {}
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    ::kill(process_, SIGKILL);
    while (::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {}
  }

 private:
  pid_t process_;
};

}  // namespace

ForeignNumbers read_foreign(const std::filesystem::path& path, const std::string& dataset) {
  if (const std::string why = why_no_file(path); !why.empty()) throw Trouble{why};
  if (::access(path.c_str(), R_OK) != 0) throw Trouble{"cannot be opened"};
  int ends[2];
  if (::pipe(ends) != 0) throw Trouble{std::strerror(errno)};
  const Descriptor from(ends[0]);
  Descriptor into(ends[1]);
  const pid_t process = ::fork();
  if (process < 0) throw Trouble{fmt::format("no process to read it: {}", std::strerror(errno))};
  if (process == 0) read_and_send(path, dataset, into.number());
  const Child child(process);
  into.close();
  const std::string died = fmt::format("damaged: HDF5 does not survive reading '{}'", dataset);
  Header header;
  require(read_all(from.number(), std::as_writable_bytes(std::span(&header, 1))), died);
  // A process that has read a damaged file may send anything, so its header is checked.
  if (!header.ok) {
    require(header.count <= kLongestText, died);
    std::string wrong(header.count, '\0');
    require(read_all(from.number(), std::as_writable_bytes(std::span(wrong))), died);
    if (header.missing) throw MissingDataset{wrong};
    throw Trouble{wrong};
  }
  require(header.dimensions >= 0 && header.dimensions <= kMostDimensions &&
              header.count <= kMostNumbers,
          died);
  ForeignNumbers numbers{{header.size.begin(), header.size.begin() + header.dimensions},
                         std::vector<double>(header.count)};
  require(read_all(from.number(), std::as_writable_bytes(std::span(numbers.values))), died);
  return numbers;
}

}  // namespace palpable::hdf5

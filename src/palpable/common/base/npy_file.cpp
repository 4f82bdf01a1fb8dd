#include "palpable/common/base/npy_file.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/file_format.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/whole_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <new>
#include <string>
#include <string_view>
#include <type_traits>

namespace palpable {
namespace {

std::size_t count_of(const std::vector<std::size_t>& shape) {
  std::size_t count = 1;
  for (const std::size_t n : shape) {
    if (n > 0 && count > std::numeric_limits<std::int32_t>::max() / n) return SIZE_MAX;
    count *= n;
  }
  return count;
}

// The text after 'key': in the header, up to the next comma that is not inside brackets.
std::string entry(const std::string& header, const std::string& key) {
  const std::size_t at = header.find("'" + key + "':");
  if (at == std::string::npos) return "";
  const std::size_t begin = header.find_first_not_of(' ', at + key.size() + 3);
  if (begin == std::string::npos) return "";
  const std::size_t end =
      header[begin] == '(' ? header.find(')', begin) + 1 : header.find_first_of(",}", begin);
  return header.substr(begin, end - begin);
}

Error refusal(const std::string& name, const std::string& what) {
  return Error(fmt::format("{}: {}", name, what));
}

// What is wrong with a header. Thrown within this file.
struct NpyDefect {
  std::string what;
};

// Largest file that is read, bytes: half a million vertices at 160 modes of single precision, six
// components each.
constexpr std::uintmax_t kLargestNpy = 2'000'000'000;

// "(2, 3)" as numbers.
std::vector<std::size_t> shape_of(const std::string& text) {
  std::vector<std::size_t> shape;
  for (std::size_t i = 1; i < text.size();) {
    const std::size_t digits = text.find_first_of("0123456789", i);
    if (digits == std::string::npos) break;
    const std::size_t end = text.find_first_not_of("0123456789", digits);
    if (end - digits > 9) throw NpyDefect{"claims an absurd size"};
    shape.push_back(std::stoul(text.substr(digits, end - digits)));
    i = end;
  }
  return shape;
}

// From Fortran's order to C's.
void turn(NpyArray& array) {
  const std::vector<double> turned = array.values;
  std::vector<std::size_t> index(array.shape.size(), 0);
  for (const double value : turned) {
    std::size_t at = 0;
    for (std::size_t d = 0; d < index.size(); ++d) at = at * array.shape[d] + index[d];
    array.values[at] = value;
    for (std::size_t d = 0; d < index.size() && ++index[d] == array.shape[d]; ++d) index[d] = 0;
  }
}

template <class T>
void convert(const char* bytes, std::vector<double>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    T value;
    std::memcpy(&value, bytes + i * sizeof(T), sizeof(T));
    values[i] = static_cast<double>(value);
  }
}

NpyHeader header_of(std::string_view bytes) {
  if (bytes.size() < 12 || !bytes.starts_with(kNpyMark)) {
    throw NpyDefect{"not a file of NumPy (.npy)"};
  }
  const auto byte = [&](std::size_t i) {
    return static_cast<std::size_t>(static_cast<unsigned char>(bytes[i]));
  };
  const bool first_version = byte(6) == 1;
  const std::size_t begin = first_version ? 10 : 12;
  const std::size_t length = first_version
                                 ? byte(8) + 256 * byte(9)
                                 : byte(8) + 256 * (byte(9) + 256 * (byte(10) + 256 * byte(11)));
  if (begin + length > bytes.size()) throw NpyDefect{"cut short"};
  const std::string text(bytes.substr(begin, length));
  const std::string type = entry(text, "descr"), shape = entry(text, "shape");
  if (type.size() < 5 || shape.empty() || shape[0] != '(') {
    throw NpyDefect{"its header is damaged"};
  }
  NpyHeader header;
  header.shape = shape_of(shape);
  header.type = type.substr(1, 3);
  header.column_by_column = entry(text, "fortran_order") != "False";
  header.begin = begin + length;
  return header;
}

}  // namespace

template <class T>
void write_npy(const std::filesystem::path& path, const std::vector<std::size_t>& shape,
               std::span<const T> values) {
  PALPABLE_EXPECT(count_of(shape) == values.size(), "as many values as the shape says");
  std::string sizes;
  for (const std::size_t n : shape) sizes += fmt::format("{},", n);
  const char* type = std::is_same_v<T, float> ? "<f4" : std::is_same_v<T, double> ? "<f8" : "<i4";
  std::string header =
      fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", type, sizes);
  // Magic, version 1.0 and the header's length are 10 bytes; values begin at a multiple of 64.
  header.append((64 - (10 + header.size() + 1) % 64) % 64, ' ');
  header += '\n';
  const char first[] = {'\x01', '\0', static_cast<char>(header.size() % 256),
                        static_cast<char>(header.size() / 256)};
  write_whole_file(path, {kNpyMark,
                          std::string_view(first, sizeof first),
                          header,
                          {reinterpret_cast<const char*>(values.data()), values.size_bytes()}});
}

template void write_npy(const std::filesystem::path&, const std::vector<std::size_t>&,
                        std::span<const float>);
template void write_npy(const std::filesystem::path&, const std::vector<std::size_t>&,
                        std::span<const double>);
template void write_npy(const std::filesystem::path&, const std::vector<std::size_t>&,
                        std::span<const int>);

std::size_t NpyHeader::count() const { return count_of(shape); }

std::size_t NpyHeader::number_size() const {
  if (type == "<f4" || type == "<i4") return 4;
  if (type == "<f8" || type == "<i8") return 8;
  return 0;
}

NpyHeader npy_header(const std::string& bytes, const std::string& name) {
  try {
    return header_of(bytes);
  } catch (const NpyDefect& defect) { throw refusal(name, defect.what); }
}

std::string why_no_npy(std::string_view first, std::uintmax_t size) {
  try {
    const NpyHeader header = header_of(first);
    const std::size_t number = std::max<std::size_t>(header.number_size(), 1);
    const std::uintmax_t room = (size - header.begin) / number;
    if (header.count() <= room) return {};
    return fmt::format("is cut short: its shape ({}) needs more numbers than the {} that it has",
                       fmt::join(header.shape, ", "), room);
  } catch (const NpyDefect& defect) { return defect.what; }
}

NpyArray npy_array(const NpyHeader& header, const std::string& bytes, const std::string& name) {
  const std::size_t size = header.number_size();
  if (size == 0) {
    throw refusal(name,
                  fmt::format("holds '{}', not floats or integers of 4 or 8 bytes", header.type));
  }
  const std::size_t count = header.count();
  if (count == SIZE_MAX || bytes.size() - header.begin < count * size) {
    throw refusal(name, "cut short");
  }
  NpyArray array{header.shape, std::vector<double>(count)};
  const char* data = bytes.data() + header.begin;
  if (header.type == "<f4") convert<float>(data, array.values);
  if (header.type == "<f8") convert<double>(data, array.values);
  if (header.type == "<i4") convert<std::int32_t>(data, array.values);
  if (header.type == "<i8") convert<std::int64_t>(data, array.values);
  if (header.column_by_column) turn(array);
  return array;
}

NpyArray read_npy(const std::filesystem::path& path) {
  const Result<std::string> bytes =
      read_whole_file(path, {.most = kLargestNpy, .why_not = why_no_npy});
  if (!bytes) throw refusal(path.string(), bytes.problem().message);
  try {
    return npy_array(npy_header(bytes.value(), path.string()), bytes.value(), path.string());
  } catch (const std::bad_alloc&) {
    throw refusal(path.string(), "needs more memory than there is");
  }
}

}  // namespace palpable

#include "tests/fuzz/mutations.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

namespace palpable::fuzz {
namespace {

constexpr std::size_t kLargest = 4u << 20;  // bytes; larger files take longer and reveal no more

std::size_t below(Random& random, std::size_t end) { return end == 0 ? 0 : random() % end; }

// A random position and length within `size` bytes; short lengths are more probable.
std::pair<std::size_t, std::size_t> range_in(Random& random, std::size_t size) {
  const std::size_t at = below(random, size + 1);
  const std::size_t longest = std::min<std::size_t>(size - at, 1u << below(random, 12));
  return {at, below(random, longest + 1)};
}

constexpr std::array<std::string_view, 26> kNumbers{"0",
                                                    "-1",
                                                    "1",
                                                    "-0.0",
                                                    "nan",
                                                    "-nan",
                                                    "inf",
                                                    "-inf",
                                                    "1e308",
                                                    "-1e308",
                                                    "1e-320",
                                                    "1e999",
                                                    "255",
                                                    "256",
                                                    "65536",
                                                    "2147483647",
                                                    "-2147483648",
                                                    "2147483648",
                                                    "4294967295",
                                                    "99999999999",
                                                    "9223372036854775807",
                                                    "-9223372036854775808",
                                                    "18446744073709551615",
                                                    "0.5",
                                                    "+7",
                                                    "0x10"};

// Begin and end of the first decimal number after a random position; an empty range
// if there is none.
std::pair<std::size_t, std::size_t> number_in(Random& random, std::string_view text) {
  const std::string_view digits = "0123456789";
  const std::size_t from = below(random, text.size());
  std::size_t begin = text.find_first_of(digits, from);
  if (begin == std::string_view::npos) begin = text.find_first_of(digits);
  if (begin == std::string_view::npos) return {0, 0};
  while (begin > 0 &&
         std::string_view("0123456789.+-").find(text[begin - 1]) != std::string_view::npos) {
    --begin;
  }
  const std::size_t end = text.find_first_not_of("0123456789.+-eE", begin);
  return {begin, std::min(end, text.size())};
}

std::vector<std::pair<std::size_t, std::size_t>> lines_of(std::string_view text) {
  std::vector<std::pair<std::size_t, std::size_t>> lines;  // begin, length including the line end
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size() - 1) + 1;
    lines.emplace_back(at, end - at);
    at = end;
  }
  return lines;
}

void change_bytes(std::string& bytes, Random& random) {
  if (bytes.empty()) return;
  char& byte = bytes[below(random, bytes.size())];
  switch (below(random, 3)) {
    case 0:
      byte = static_cast<char>(byte ^ (1 << below(random, 8)));
      break;
    case 1:
      byte = static_cast<char>(random());
      break;
    default:
      byte = std::string_view("\0\xff\n\r\t \"'[]{}<>&:=,.-#/\\9", 23)[below(random, 23)];
  }
}

void move_parts(std::string& bytes, std::span<const std::string> relatives, Random& random) {
  const auto [at, length] = range_in(random, bytes.size());
  switch (below(random, 5)) {
    case 0:
      bytes.erase(at, length);
      break;
    case 1:
      bytes.resize(at);
      break;
    case 2:
      bytes.insert(below(random, bytes.size() + 1), bytes.substr(at, length));
      break;
    case 3: {
      std::string many;
      const std::size_t times = 1 + below(random, 2000);
      const std::string part = bytes.substr(at, std::max<std::size_t>(length, 1));
      for (std::size_t k = 0; k < times && many.size() < kLargest; ++k) many += part;
      bytes.insert(at, many);
      break;
    }
    default: {
      const std::string& other = relatives[below(random, relatives.size())];
      const std::size_t from = below(random, other.size() + 1);
      if (below(random, 2) == 0) {
        bytes = bytes.substr(0, at) + other.substr(from);
      } else {
        const auto [start, size] = range_in(random, other.size());
        bytes.replace(at, length, other, start, size);
      }
    }
  }
}

void change_lines(std::string& bytes, std::span<const std::string> relatives, Random& random) {
  const auto lines = lines_of(bytes);
  if (lines.empty()) return;
  const auto [at, length] = lines[below(random, lines.size())];
  const auto [to, other_length] = lines[below(random, lines.size())];
  const std::string line = bytes.substr(at, length), other = bytes.substr(to, other_length);
  switch (below(random, 5)) {
    case 0:
      bytes.erase(at, length);
      break;
    case 1:
      bytes.insert(to, line);
      break;
    case 2:
      bytes.replace(to, other_length, line);
      break;
    case 3: {
      std::string many;
      for (std::size_t k = below(random, 3000); k > 0 && many.size() < kLargest; --k) many += line;
      bytes.insert(at, many);
      break;
    }
    default: {
      const std::string& relative = relatives[below(random, relatives.size())];
      const auto theirs = lines_of(relative);
      if (theirs.empty()) return;
      const auto [begin, size] = theirs[below(random, theirs.size())];
      bytes.replace(at, length, relative, begin, size);
    }
  }
}

void change_number(std::string& bytes, Random& random) {
  const auto [begin, end] = number_in(random, bytes);
  if (begin == end) return;
  bytes.replace(begin, end - begin, kNumbers[below(random, kNumbers.size())]);
}

void change_binary_number(std::string& bytes, Random& random) {
  const std::size_t size = std::size_t{1} << below(random, 4);
  if (bytes.size() < size) return;
  const std::size_t at = below(random, bytes.size() - size + 1);
  spoil_number(std::span(bytes).subspan(at, size), size, below(random, 2) == 0, random);
  if (below(random, 4) == 0) {
    std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                 bytes.begin() + static_cast<std::ptrdiff_t>(at + size));
  }
}

void put_in(std::string& bytes, Random& random) {
  constexpr std::array<std::string_view, 13> kParts{"[",
                                                    "{",
                                                    "{\"a\":",
                                                    "a.",
                                                    "- ",
                                                    "a: ",
                                                    "<a>",
                                                    "\"",
                                                    "(",
                                                    "a",
                                                    " ",
                                                    "\xff",
                                                    std::string_view("\0", 1)};
  const std::string_view part = kParts[below(random, kParts.size())];
  std::string many;
  for (std::size_t k = 1 + below(random, 1u << below(random, 17)); k > 0; --k) many += part;
  bytes.insert(below(random, bytes.size() + 1), many);
}

template <class T>
void put_number(std::span<char> bytes, T value) {
  std::memcpy(bytes.data(), &value, std::min(sizeof value, bytes.size()));
}

}  // namespace

void spoil_number(std::span<char> bytes, std::size_t size, bool floating, Random& random) {
  static_assert(std::endian::native == std::endian::little);
  const std::size_t count = bytes.size() / size;
  if (count == 0) return;
  const std::span<char> number = bytes.subspan(below(random, count) * size, size);
  if (floating && size >= 4) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    constexpr std::array kValues{
        0.0, -1.0,  1e30,      -1e30,      1e-40,
        0.5, 1e300, kInfinity, -kInfinity, std::numeric_limits<double>::quiet_NaN()};
    const double value = kValues[below(random, kValues.size())];
    if (size == 8) put_number(number, value);
    if (size == 4) put_number(number, static_cast<float>(value));
    return;
  }
  constexpr std::array<std::int64_t, 12> kValues{0,
                                                 1,
                                                 -1,
                                                 127,
                                                 -128,
                                                 0x7fff,
                                                 0xffff,
                                                 0x7fffffff,
                                                 -0x80000000LL,
                                                 0xffffffffLL,
                                                 std::numeric_limits<std::int64_t>::max(),
                                                 std::numeric_limits<std::int64_t>::min()};
  put_number(number, kValues[below(random, kValues.size())]);
}

std::string mutated(std::string bytes, std::span<const std::string> relatives, Random& random) {
  const bool text = bytes.find('\0') == std::string::npos;
  std::size_t changes = 1 + below(random, 4);
  if (below(random, 16) == 0) changes = 16;
  for (std::size_t k = 0; k < changes && bytes.size() < kLargest; ++k) {
    switch (below(random, text ? 12 : 8)) {
      case 0:
      case 1:
      case 2:
        change_bytes(bytes, random);
        break;
      case 3:
      case 4:
        move_parts(bytes, relatives, random);
        break;
      case 5:
        change_binary_number(bytes, random);
        break;
      case 6:
        put_in(bytes, random);
        break;
      case 7:
        text ? change_lines(bytes, relatives, random) : change_binary_number(bytes, random);
        break;
      case 8:
        change_lines(bytes, relatives, random);
        break;
      default:
        change_number(bytes, random);
    }
  }
  return bytes;
}

}  // namespace palpable::fuzz

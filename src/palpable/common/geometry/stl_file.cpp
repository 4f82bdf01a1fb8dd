#include "palpable/common/base/plain_text.h"
#include "palpable/common/geometry/surface_files.h"

#include <algorithm>
#include <cctype>
#include <cstdint>

namespace palpable::surface_files {

namespace {

constexpr std::size_t kStlHeader = 84;  // bytes: a remark of 80, and the number of triangles
constexpr std::size_t kTriangleBytes = 50;

std::string why_no_binary_stl(std::string_view first, std::size_t size) {
  if (is_utf16(first)) return why_no_text(first, TextPart::kFirst);
  if (first.size() < kStlHeader) {
    return fmt::format("has {} bytes, where the header of an STL has {}: it is cut short", size,
                       kStlHeader);
  }
  std::uint32_t count;
  std::memcpy(&count, first.data() + kStlHeader - sizeof count, sizeof count);
  const std::size_t room = (size - kStlHeader) / kTriangleBytes;
  if (count > room) {
    return fmt::format("byte 84: {} triangles are announced, there is room for {}", count, room);
  }
  return count == 0 ? "byte 84: no triangles are announced" : "";
}

// A file that holds more than it announces may have been padded, or its count may be wrong: which
// triangles are meant cannot be known.
void refuse_padding(std::size_t count, std::size_t size) {
  const std::size_t end = kStlHeader + kTriangleBytes * count;
  if (size == end) return;
  throw Bad{
      "byte 84",
      fmt::format("{} triangles are announced, which end at byte {}, but {} more bytes follow "
                  "(there is room for {}): the file was padded, or its count is wrong; export "
                  "it again",
                  count, end, size - end, (size - kStlHeader) / kTriangleBytes)};
}

Soup parse_binary_stl(std::string_view data) {
  if (std::string why = why_no_binary_stl(data, data.size()); !why.empty()) {
    throw Bad{"", std::move(why)};
  }
  Bytes bytes(data);
  bytes.skip(kStlHeader - sizeof(std::uint32_t));
  const auto count = bytes.get<std::uint32_t>();
  refuse_padding(count, data.size());
  Soup soup;
  soup.vertices.reserve(std::size_t{3} * count);
  soup.triangles.reserve(count);
  for (std::uint32_t t = 0; t < count; ++t) {
    bytes.skip(12);  // the normal follows from the corners
    const int first = static_cast<int>(soup.vertices.size());
    for (int k = 0; k < 3; ++k) {
      const float x = bytes.get<float>(), y = bytes.get<float>(), z = bytes.get<float>();
      soup.vertices.push_back(finite_point(bytes, static_cast<double>(x), static_cast<double>(y),
                                           static_cast<double>(z)));
    }
    bytes.skip(2);
    soup.triangles.emplace_back(first, first + 1, first + 2);
  }
  return soup;
}

// Whether a word is the keyword, in any case: some programs write SOLID, FACET, VERTEX.
bool is_stl_word(std::string_view word, std::string_view keyword) {
  return std::equal(word.begin(), word.end(), keyword.begin(), keyword.end(), [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == b;
  });
}

// Whether there are bytes that no text has.
bool has_binary_bytes(std::string_view bytes) {
  return std::any_of(bytes.begin(), bytes.end(), [](char c) {
    const auto code = static_cast<unsigned char>(c);
    return (code < 0x20 && std::strchr("\t\n\v\f\r", c) == nullptr) || code == 0;
  });
}

// Whether a line begins with the word "facet".
bool has_facet_line(std::string_view text) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    if (is_stl_word(Words(text.substr(0, end)).next(), "facet")) return true;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return false;
}

// Whether the file is text. The header of some binary files begins with "solid" too, so the size
// decides where it can, and then bytes that no text has: a binary file has some among its first
// triangles.
bool is_text_stl(std::string_view first, std::size_t size) {
  if (first.size() >= kStlHeader) {
    std::uint32_t count;
    std::memcpy(&count, first.data() + kStlHeader - sizeof count, sizeof count);
    if (size == kStlHeader + kTriangleBytes * count) return false;
  }
  Words words(without_mark(first.substr(0, kStlHeader)));
  if (!is_stl_word(words.next().substr(0, 5), "solid")) return false;
  constexpr std::size_t kLooked = 1024;  // bytes; the first facet of a text lies within them
  const std::string_view begin = first.substr(0, kLooked);
  return !has_binary_bytes(begin) || has_facet_line(begin);
}

Soup parse_text_stl(std::string_view text) {
  Lines lines(text);
  std::string_view line;
  Soup soup;
  std::vector<int> polygon;
  bool inside = false;  // of a loop
  while (lines.next(line)) {
    Words words(line);
    const std::string_view what = words.next();
    if (is_stl_word(what, "outer")) {
      polygon.clear();
      inside = true;
    } else if (is_stl_word(what, "vertex")) {
      polygon.push_back(static_cast<int>(soup.vertices.size()));
      soup.vertices.push_back(point(lines, words));
    } else if (is_stl_word(what, "endloop")) {
      if (polygon.size() < 3) lines.bad("a facet needs three vertices");
      soup.add_fan(polygon);
      inside = false;
    }
  }
  if (inside) lines.bad("the file ends within a facet: it was cut short");
  if (soup.triangles.empty()) {
    throw Bad{"",
              fmt::format("begins like an STL but has no facets in its {} bytes: it is cut short, "
                          "or an empty export",
                          text.size())};
  }
  return soup;
}

}  // namespace

std::string why_no_stl(std::string_view first, std::size_t size) {
  if (first.empty()) return "is empty";
  if (!is_text_stl(first, size)) return why_no_binary_stl(first, size);
  return why_no_text(first, first.size() < size ? TextPart::kFirst : TextPart::kAll);
}

Soup parse_stl(std::string_view data) {
  if (!is_text_stl(data, data.size())) return parse_binary_stl(data);
  std::string kept;
  return parse_text_stl(plain(data, kept));
}

}  // namespace palpable::surface_files

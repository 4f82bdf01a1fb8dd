#include "palpable/common/geometry/surface_files.h"

#include <cstdint>

namespace palpable::surface_files {

namespace {

Soup parse_binary_stl(std::string_view data) {
  Bytes bytes(data);
  bytes.skip(80);
  const auto count = bytes.get<std::uint32_t>();
  constexpr std::size_t kTriangleBytes = 50;
  if (bytes.left() / kTriangleBytes < count) {
    bytes.bad(fmt::format("{} triangles are announced, there is room for {}", count,
                          bytes.left() / kTriangleBytes));
  }
  Soup soup;
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

Soup parse_text_stl(std::string_view text) {
  Lines lines(text);
  std::string_view line;
  Soup soup;
  std::vector<int> polygon;
  while (lines.next(line)) {
    Words words(line);
    const std::string_view what = words.next();
    if (what == "outer") {
      polygon.clear();
    } else if (what == "vertex") {
      polygon.push_back(static_cast<int>(soup.vertices.size()));
      soup.vertices.push_back(point(lines, words));
    } else if (what == "endloop") {
      if (polygon.size() < 3) lines.bad("a facet needs three vertices");
      soup.add_fan(polygon);
    }
  }
  return soup;
}

}  // namespace

Soup parse_stl(std::string_view data) {
  // Some binary files begin with "solid" too, so the size decides where it can.
  if (data.size() >= 84) {
    std::uint32_t count;
    std::memcpy(&count, data.data() + 80, sizeof count);
    if (data.size() == 84 + std::size_t{50} * count) return parse_binary_stl(data);
  }
  return data.substr(0, 5) == "solid" ? parse_text_stl(data) : parse_binary_stl(data);
}

}  // namespace palpable::surface_files

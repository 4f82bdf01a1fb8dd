#include "palpable/common/base/text_numbers.h"
#include "palpable/common/geometry/surface_files.h"

namespace palpable::surface_files {

Soup parse_off(std::string_view text) {
  Lines lines(text);
  std::string_view line;
  if (!lines.next_content(line, '#')) lines.bad("the file is empty");
  Words header(line);
  if (header.next() != "OFF") lines.bad("an OFF file begins with the word OFF");
  std::string_view first = header.next();
  Words words = header;
  if (first.empty()) {
    if (!lines.next_content(line, '#')) lines.bad("the counts are missing");
    words = Words(line);
    first = words.next();
  }
  const std::size_t vertex_count = count_of(lines, first, "vertices");
  const std::size_t face_count = count_of(lines, words.next(), "faces");

  Soup soup;
  soup.vertices.reserve(vertex_count);
  for (std::size_t i = 0; i < vertex_count; ++i) {
    if (!lines.next_content(line, '#')) lines.bad("the file ends before its last vertex");
    Words w(line);
    soup.vertices.push_back(point(lines, w));
  }
  std::vector<int> polygon;
  for (std::size_t i = 0; i < face_count; ++i) {
    if (!lines.next_content(line, '#')) lines.bad("the file ends before its last face");
    Words w(line);
    const auto corners = to_whole_number(w.next());
    if (!corners || *corners < 3 || static_cast<std::size_t>(*corners) > line.size()) {
      lines.bad("a face needs at least three corners");
    }
    polygon.clear();
    for (int k = 0; k < *corners; ++k) polygon.push_back(index_in(lines, w.next(), vertex_count));
    soup.add_fan(polygon);
  }
  return soup;
}

Soup parse_obj(std::string_view text) {
  Lines lines(text);
  std::string_view line;
  Soup soup;
  std::vector<int> polygon;
  while (lines.next_content(line, '#')) {
    Words words(line);
    const std::string_view what = words.next();
    if (what == "v") {
      soup.vertices.push_back(point(lines, words));
    } else if (what == "f") {
      polygon.clear();
      for (std::string_view w = words.next(); !w.empty(); w = words.next()) {
        const std::string_view number = w.substr(0, w.find('/'));  // v/vt/vn: only v is wanted
        const auto value = to_whole_number(number);
        const auto count = static_cast<long long>(soup.vertices.size());
        // Counted from 1, or backwards from the last vertex if negative.
        const long long index = value ? (*value > 0 ? *value - 1 : count + *value) : -1;
        if (!value || index < 0 || index >= count) {
          lines.bad(
              fmt::format("'{}' is not one of the {} vertices so far", w.substr(0, 40), count));
        }
        polygon.push_back(static_cast<int>(index));
      }
      if (polygon.size() < 3) lines.bad("a face needs at least three corners");
      soup.add_fan(polygon);
    }
  }
  return soup;
}

}  // namespace palpable::surface_files

#include "palpable/common/base/text_numbers.h"
#include "palpable/common/geometry/surface_files.h"

namespace palpable::surface_files {

namespace {

// What stands in the first word behind "OFF": nothing, or the number of vertices (as in ModelNet).
// Letters before it announce texture coordinates (ST), colours (C) and normals (N) behind those of
// each vertex, which are skipped.
std::string_view after_off(Lines& lines, std::string_view word) {
  for (const std::string_view announced : {"ST", "C", "N"}) {
    if (word.starts_with(announced)) word.remove_prefix(announced.size());
  }
  if (!word.starts_with("OFF")) {
    lines.bad("an OFF file of three dimensions begins with the word OFF, COFF, NOFF or CNOFF");
  }
  return word.substr(3);
}

}  // namespace

Soup parse_off(std::string_view bytes) {
  std::string kept;
  Lines lines(plain(bytes, kept));
  std::string_view line;
  if (!lines.next_content(line, '#')) lines.bad("the file is empty");
  Words words(line);
  std::string_view first = after_off(lines, words.next());
  if (first.empty()) first = words.next();
  if (first.empty()) {
    if (!lines.next_content(line, '#')) lines.bad("the counts are missing");
    words = Words(line);
    first = words.next();
  }
  constexpr std::size_t kShortestVertex = 6, kShortestFace = 8;  // bytes: "0 0 0", "3 0 1 2"
  const std::size_t vertex_count = count_of(lines, first, "vertices", kShortestVertex);
  const std::size_t face_count = count_of(lines, words.next(), "faces", kShortestFace);

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

namespace {

// A line that ends with a backslash, and those that continue it, as one. @param kept  holds it
std::string_view with_continuations(Lines& lines, std::string_view line, std::string& kept) {
  const auto continues = [](std::string_view text) {
    const std::size_t last = text.find_last_not_of(" \t\r\v\f");
    return last != std::string_view::npos && text[last] == '\\' ? last : std::string_view::npos;
  };
  std::size_t cut = continues(line);
  if (cut == std::string_view::npos) return line;
  kept.clear();
  while (cut != std::string_view::npos) {
    kept.append(line.substr(0, cut)) += ' ';
    if (!lines.next(line)) return kept;
    line = line.substr(0, line.find('#'));
    cut = continues(line);
  }
  return kept.append(line);
}

}  // namespace

Soup parse_obj(std::string_view bytes) {
  std::string kept;
  Lines lines(plain(bytes, kept));
  std::string_view line;
  std::string joined;
  Soup soup;
  std::vector<int> polygon;
  while (lines.next_content(line, '#')) {
    line = with_continuations(lines, line, joined);
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

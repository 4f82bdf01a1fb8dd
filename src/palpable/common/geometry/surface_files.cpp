#include "palpable/common/geometry/surface_files.h"

#include "palpable/common/base/text_numbers.h"

#include <cmath>

namespace palpable::surface_files {

double coordinate(Lines& lines, std::string_view word) {
  const auto value = to_number(word);
  if (!value) { lines.bad(fmt::format("'{}' is not a coordinate", word.substr(0, 40))); }
  return *value;
}

Eigen::Vector3d point(Lines& lines, Words& words) {
  const double x = coordinate(lines, words.next());
  const double y = coordinate(lines, words.next());
  return {x, y, coordinate(lines, words.next())};
}

std::size_t count_of(Lines& lines, std::string_view word, const char* what) {
  const auto value = to_whole_number(word);
  // A line holds at least two bytes, so a file cannot hold more things than bytes left.
  if (!value || *value < 0 || static_cast<std::size_t>(*value) > lines.rest().size()) {
    lines.bad(fmt::format("'{}' is not a possible number of {}", word.substr(0, 40), what));
  }
  return static_cast<std::size_t>(*value);
}

int index_in(Lines& lines, std::string_view word, std::size_t count) {
  const auto value = to_whole_number(word);
  if (!value || *value < 0 || static_cast<std::size_t>(*value) >= count) {
    lines.bad(fmt::format("'{}' is not one of the {} vertices", word.substr(0, 40), count));
  }
  return static_cast<int>(*value);
}

Eigen::Vector3d finite_point(Bytes& bytes, double x, double y, double z) {
  const Eigen::Vector3d p(x, y, z);
  if (!p.allFinite()) bytes.bad("a coordinate is not a number");
  return p;
}

}  // namespace palpable::surface_files

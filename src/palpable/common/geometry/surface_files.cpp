#include "palpable/common/geometry/surface_files.h"

#include "palpable/common/base/plain_text.h"
#include "palpable/common/base/text_numbers.h"

#include <utility>

namespace palpable::surface_files {

std::string_view plain(std::string_view bytes, std::string& kept) {
  const bool is_plain =
      without_mark(bytes).size() == bytes.size() &&
      bytes.find_first_of(std::string_view("\r\0\xff\xfe", 4)) == std::string_view::npos;
  if (is_plain) return bytes;
  Result<std::string> text = plain_text(std::string(bytes));
  if (!text) throw Bad{"", text.problem().message};
  return kept = std::move(text).value();
}

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

std::size_t count_of(Lines& lines, std::string_view word, const char* what, std::size_t shortest) {
  const auto value = to_whole_number(word);
  if (!value || *value < 0) {
    lines.bad(fmt::format("'{}' is not a possible number of {}", word.substr(0, 40), what));
  }
  // The last line may lack its end.
  const std::size_t room = (lines.rest().size() + 1) / shortest;
  if (static_cast<std::size_t>(*value) > room) {
    lines.bad(fmt::format("{} {} are announced, there is room for {}", *value, what, room));
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

#include "palpable/bake/mesh/field_text.h"

#include "palpable/common/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <map>
#include <system_error>

namespace palpable::field_text {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

static_assert(std::endian::native == std::endian::little, "files say which end comes first");

template <class T>
std::vector<double> converted(std::string_view bytes, bool swap) {
  std::vector<double> values(bytes.size() / sizeof(T));
  for (std::size_t i = 0; i < values.size(); ++i) {
    char raw[sizeof(T)];
    std::memcpy(raw, bytes.data() + i * sizeof(T), sizeof(T));
    if (swap) std::reverse(raw, raw + sizeof(T));
    T value;
    std::memcpy(&value, raw, sizeof(T));
    values[i] = static_cast<double>(value);
  }
  return values;
}

}  // namespace

void bad(const std::string& name, const std::string& what) {
  throw Error(fmt::format("{}: {}", name, what));
}

std::optional<NumberType> number_type(std::string_view name) {
  static const std::map<std::string_view, NumberType> types{
      {"Float64", {8, converted<double>}},       {"Float32", {4, converted<float>}},
      {"Int64", {8, converted<std::int64_t>}},   {"Int32", {4, converted<std::int32_t>}},
      {"UInt64", {8, converted<std::uint64_t>}}, {"UInt32", {4, converted<std::uint32_t>}},
      {"Int16", {2, converted<std::int16_t>}},   {"UInt16", {2, converted<std::uint16_t>}},
      {"Int8", {1, converted<std::int8_t>}},     {"UInt8", {1, converted<std::uint8_t>}}};
  const auto at = types.find(name);
  return at == types.end() ? std::nullopt : std::optional(at->second);
}

MatrixXd as_columns(const std::vector<double>& values, Index components) {
  return Eigen::Map<const MatrixXd>(values.data(), components,
                                    static_cast<Index>(values.size()) / components);
}

std::vector<Line> lines_of(const std::string& bytes) {
  std::vector<Line> lines;
  std::size_t at = 0, number = 0;
  while (at < bytes.size()) {
    const std::size_t end = std::min(bytes.find('\n', at), bytes.size());
    std::string_view text = std::string_view(bytes).substr(at, end - at);
    if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
    lines.push_back({++number, text});
    at = end + 1;
  }
  return lines;
}

std::vector<std::string_view> words_of(std::string_view text, const char* separators) {
  std::vector<std::string_view> words;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t begin = text.find_first_not_of(separators, at);
    if (begin == std::string_view::npos) break;
    const std::size_t end = std::min(text.find_first_of(separators, begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    at = end;
  }
  return words;
}

std::string_view first_word(std::string_view text) {
  const std::vector<std::string_view> words = words_of(text, " \t");
  return words.empty() ? std::string_view() : words.front();
}

}  // namespace palpable::field_text

/// @file
/// What the readers of field files share: numbers as bytes and as words, lines of a text, and how
/// they say that a file is bad.
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpable::field_text {

/// Far above any mesh, and far below what would not fit into memory.
inline constexpr std::int64_t kMostNumbers = 500'000'000;

/// @throws Error "name: what"
[[noreturn]] void bad(const std::string& name, const std::string& what);

/// How a file holds its numbers.
struct NumberType {
  std::size_t size = 0;  ///< bytes
  /// All of the bytes; `swap`: each number's end comes first that is not this machine's.
  std::vector<double> (*convert)(std::string_view bytes, bool swap) = nullptr;
};

/// By the names of VTK's XML files: "Float64", "UInt8", ...
[[nodiscard]] std::optional<NumberType> number_type(std::string_view name);

/// (components x count) from values that follow each other.
[[nodiscard]] Eigen::MatrixXd as_columns(const std::vector<double>& values,
                                         Eigen::Index components);

struct Line {
  std::size_t number;     ///< from 1
  std::string_view text;  ///< without its end
};
[[nodiscard]] std::vector<Line> lines_of(const std::string& bytes);

[[nodiscard]] std::vector<std::string_view> words_of(std::string_view text, const char* separators);

/// The first word, apart by blanks; empty if there is none.
[[nodiscard]] std::string_view first_word(std::string_view text);

}  // namespace palpable::field_text

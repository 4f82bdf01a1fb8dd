/// @file
/// Helpers of the readers of field files: numbers as bytes and as words, lines of a text, and
/// errors about a bad file.
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpable::field_text {

/// Largest count of numbers that a file may claim: far above any mesh, and small enough to fit into
/// memory.
inline constexpr std::int64_t kMostNumbers = 500'000'000;

/// @throws Error "name: what"
[[noreturn]] void bad(const std::string& name, const std::string& what);

/// The binary type of the numbers in a file.
struct NumberType {
  std::size_t size = 0;  ///< bytes
  /// Converts all of the bytes; `swap`: their byte order is not this machine's.
  std::vector<double> (*convert)(std::string_view bytes, bool swap) = nullptr;
};

/// The type with this name in VTK's XML files: "Float64", "UInt8", ...
[[nodiscard]] std::optional<NumberType> number_type(std::string_view name);

/// (components x count) The consecutive values of `count` entries as columns.
[[nodiscard]] Eigen::MatrixXd as_columns(const std::vector<double>& values,
                                         Eigen::Index components);

struct Line {
  std::size_t number;     ///< from 1
  std::string_view text;  ///< without its end
};
[[nodiscard]] std::vector<Line> lines_of(const std::string& bytes);

[[nodiscard]] std::vector<std::string_view> words_of(std::string_view text, const char* separators);

/// The first word of a text with blanks between words; empty if there is none.
[[nodiscard]] std::string_view first_word(std::string_view text);

}  // namespace palpable::field_text

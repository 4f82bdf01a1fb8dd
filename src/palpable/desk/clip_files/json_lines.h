/// @file
/// Files with one JSON object per line (*.jsonl), as far as the formats of this module need them.
/// The JSON library is large, so only three .cpp files of this module include it and no header
/// does.
#pragma once

#include "palpable/common/geometry/rigid.h"

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

/// Typed access to the values of a JSON object. If a value is missing or of another type, members
/// throw an Error that names the key but not the file: for_each_object() adds file and line.
class JsonObject {
 public:
  explicit JsonObject(const nlohmann::json& object) : object_(object) {}

  [[nodiscard]] bool has(const char* key) const;
  /// The number of the frame: a whole number from 0 to 10 million (a larger one is a mistake).
  [[nodiscard]] int frame() const;
  /// The same, for a file whose frame numbers must increase.
  /// @param last  number of the previous frame, -1 for the first
  /// @throws Error unless the number is larger than `last`
  [[nodiscard]] int frame_after(int last) const;
  [[nodiscard]] bool flag(const char* key) const;
  [[nodiscard]] bool flag_or(const char* key, bool fallback) const;
  [[nodiscard]] std::string text(const char* key) const;
  [[nodiscard]] int whole(const char* key) const;
  /// `fallback` without the key; a number that is not whole is truncated.
  [[nodiscard]] int whole_or(const char* key, int fallback) const;
  [[nodiscard]] double number(const char* key) const;
  /// For values that are not checked: nothing if the key is missing or its value is no number.
  [[nodiscard]] std::optional<double> number_if_any(const char* key) const;
  /// The first `count` numbers of a list. @throws Error when the list is shorter
  [[nodiscard]] std::vector<double> numbers(const char* key, std::size_t count) const;
  /// The same for values that are not checked: nothing if the list is missing, too short, or holds
  /// something else.
  [[nodiscard]] std::optional<std::vector<double>> numbers_if_any(const char* key,
                                                                  std::size_t count) const;
  /// The first `count` numbers of each list in a list of lists.
  [[nodiscard]] std::vector<std::vector<double>> rows(const char* key, std::size_t count) const;
  /// Calls `read_entry` for each object of a list. @throws Error when the value is no list or an
  /// entry no object
  void for_each_in(const char* key, const std::function<void(const JsonObject&)>& read_entry) const;
  /// A rigid transform from 16 numbers, row by row. R R^T may differ from 1 by 1e-3, as it does
  /// when few digits were written; the result is an exact rotation.
  [[nodiscard]] Rigid3 rigid(const char* key) const;

 private:
  const nlohmann::json& object_;
};

/// The first three numbers as a vector. @pre v.size() >= 3
[[nodiscard]] inline Eigen::Vector3d vector_of(const std::vector<double>& v) {
  return {v[0], v[1], v[2]};
}

/// Calls `read_object` for the object in each line of a file.
/// @throws Error that names file and line
void for_each_object(const std::filesystem::path& path,
                     const std::function<void(const JsonObject&)>& read_object);

/// Whether a line belongs to another body: whether its key "body" names one other than `body`. A
/// line without the key belongs to every body.
[[nodiscard]] bool is_of_another(const JsonObject& line, const std::string& body);

/// The number of a frame, from 0 to 10 million. @throws Error that does not name the file
[[nodiscard]] int frame_number(const nlohmann::json& value);

/// A message of the JSON library without the exception's name in brackets in front, which means
/// nothing to users.
[[nodiscard]] std::string without_brackets(const std::string& message);

/// A text in quotes that both JSON and TOML can read; bytes that are not UTF-8 become U+FFFD.
[[nodiscard]] std::string quoted_text(const std::string& text);

/// The 16 numbers of a transform, row by row, as JSON without blanks: [1,0,0,...].
/// @param digits  significant digits of each number
[[nodiscard]] std::string rows_text(const Rigid3& transform, int digits);

}  // namespace palpable

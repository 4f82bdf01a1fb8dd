/// @file
/// Files of one JSON object per line (*.jsonl), as far as the formats of this module need them. The
/// JSON library is large: it is included by three .cpp files of this module and by no header.
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

/// What a JSON object says under its keys. Where an answer is missing or of another kind, members
/// throw an Error that names the key and not the file: for_each_object() adds file and line.
class JsonObject {
 public:
  explicit JsonObject(const nlohmann::json& object) : object_(object) {}

  [[nodiscard]] bool has(const char* key) const;
  /// The number of a frame: whole, 0 to 10 million (a larger one is a slip).
  [[nodiscard]] int frame() const;
  /// The same, of a file whose frames must rise. @param last  -1 at first
  [[nodiscard]] int frame_after(int last) const;
  [[nodiscard]] bool flag(const char* key) const;
  [[nodiscard]] bool flag_or(const char* key, bool fallback) const;
  [[nodiscard]] std::string text(const char* key) const;
  [[nodiscard]] int whole(const char* key) const;
  /// As it was written, cut to whole.
  [[nodiscard]] int whole_or(const char* key, int fallback) const;
  [[nodiscard]] double number(const char* key) const;
  /// Of keys that are not checked: nothing where there is no number.
  [[nodiscard]] std::optional<double> number_if_any(const char* key) const;
  /// The first `count` numbers of a list. @throws Error when it has fewer
  [[nodiscard]] std::vector<double> numbers(const char* key, std::size_t count) const;
  /// The same of keys that are not checked.
  [[nodiscard]] std::optional<std::vector<double>> numbers_if_any(const char* key,
                                                                  std::size_t count) const;
  /// A list of lists; of each the first `count` numbers.
  [[nodiscard]] std::vector<std::vector<double>> rows(const char* key, std::size_t count) const;
  /// Hands over the objects of a list, one by one. @throws Error when it is none, or holds
  /// something else
  void for_each_in(const char* key, const std::function<void(const JsonObject&)>& read_entry) const;
  /// A transform as 16 numbers, row by row. The rotation may be off by 1e-3, as one that was
  /// written with few digits is; it is made one.
  [[nodiscard]] Rigid3 rigid(const char* key) const;

 private:
  const nlohmann::json& object_;
};

/// The first three numbers, which must be there.
[[nodiscard]] inline Eigen::Vector3d vector_of(const std::vector<double>& v) {
  return {v[0], v[1], v[2]};
}

/// Hands over the objects of a file, line by line.
/// @throws Error that names file and line
void for_each_object(const std::filesystem::path& path,
                     const std::function<void(const JsonObject&)>& read_object);

/// Whether a line names another body than `body`, under the key "body". One that names none is of
/// whoever asks.
[[nodiscard]] bool is_of_another(const JsonObject& line, const std::string& body);

/// The whole number of a frame. @throws Error without the file's name
[[nodiscard]] int frame_number(const nlohmann::json& value);

/// What the library's messages say, without the name in brackets in front, which is for
/// programmers.
[[nodiscard]] std::string without_brackets(const std::string& message);

/// A text in quotes, as JSON and TOML have it; what is no UTF-8 becomes U+FFFD.
[[nodiscard]] std::string quoted_text(const std::string& text);

/// The 16 numbers of a transform, row by row, as JSON without blanks: [1,0,0,...].
/// @param digits  significant ones of each number
[[nodiscard]] std::string rows_text(const Rigid3& transform, int digits);

}  // namespace palpable

/// @file
/// Files with one JSON object per line (*.jsonl), as far as the formats of this module need them.
/// The JSON library is large, so no header includes it, and json_lines.cpp alone reads with it.
///
/// The fields of a record are listed once, in the order of the file, for writer and reader:
///
///     void fields(JsonFields& line, RigLine& rig) {
///       line.number("row_offset_px", rig.row_offset_px, 4);
///       line.flag_if_set("step", rig.step);
///     }
#pragma once

#include "palpable/common/geometry/rigid.h"

#include <nlohmann/json_fwd.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

/// The fields of a JSON object, which is either read or written. Each member that takes a key and a
/// value writes the value, or sets it to what was read.
///
/// Reading: if a value is missing or of another type, members throw an Error that names the key but
/// not the file: for_each_object() adds file and line. Optional values and texts stay as they are
/// if the key is missing.
///
/// Writing: without blanks, {"frame":7,"site":3}; optional values that are nothing, and texts that
/// are empty, are left out. `digits` are those behind the point.
class JsonFields {
 public:
  /// Writes an object.
  JsonFields() = default;
  /// Reads an object, which must outlive this.
  explicit JsonFields(const nlohmann::json& object) : read_(&object) {}

  [[nodiscard]] bool reads() const { return read_ != nullptr; }
  /// What was written so far.
  [[nodiscard]] std::string object() const { return "{" + written_ + "}"; }

  /// Only when reading.
  [[nodiscard]] bool has(const char* key) const;
  [[nodiscard]] bool is_null(const char* key) const;
  /// Calls `read` for the object with this key; does nothing without one. Only when reading.
  void object_if_there(const char* key, const std::function<void(JsonFields&)>& read) const;
  /// A list of numbers of frames. Only when reading.
  [[nodiscard]] std::vector<int> frames(const char* key) const;

  /// The number of the frame: a whole number from 0 to 10 million (a larger one is a mistake).
  void frame(int& value);
  void flag(const char* key, bool& value);
  /// Left out if false; false if the key is missing.
  void flag_if_set(const char* key, bool& value);
  void text(const char* key, std::string& value);
  /// Unchanged if the key is missing; a number that is not whole is truncated.
  void whole(const char* key, int& value);
  /// Left out if negative; unchanged if the key is missing. @throws Error if it is not whole
  void index(const char* key, int& value);

  /// A whole number of 64 bits; left out if it is nothing, unchanged if it is of another type.
  void id(const char* key, std::optional<std::int64_t>& value);

  /// What is done if an optional value that is read is not of its type.
  enum class Invalid { kRefused, kIgnored };

  void number(const char* key, double& value, int digits);
  void number(const char* key, std::optional<double>& value, int digits,
              Invalid invalid = Invalid::kRefused);
  /// Written as null if it is nothing; otherwise as with Invalid::kIgnored.
  void number_or_null(const char* key, std::optional<double>& value, int digits);
  /// @throws Error unless a number that is read lies in [0, largest]
  void number_up_to(double largest, const char* key, std::optional<double>& value, int digits);
  /// A list of three numbers; of a longer one the first three are read.
  void vector(const char* key, Eigen::Vector3d& value, int digits);
  void vector(const char* key, std::optional<Eigen::Vector3d>& value, int digits,
              Invalid invalid = Invalid::kRefused);
  /// 16 numbers, row by row (rigid_of_rows()).
  void rigid(const char* key, Rigid3& value);
  /// A list of lists of eight numbers; of longer ones the first eight are read.
  void rows_of_eight(const char* key, std::vector<std::vector<double>>& rows, int digits);
  /// A list of objects. What is read is appended to `items`.
  template <class Item>
  void list(const char* key, std::vector<Item>& items,
            const std::function<void(JsonFields&, Item&)>& fields_of) {
    if (reads()) {
      return for_each_in(key, [&](JsonFields& one) { fields_of(one, items.emplace_back()); });
    }
    std::vector<std::string> texts;
    for (Item& item : items) {
      JsonFields one;
      fields_of(one, item);
      texts.push_back(one.object());
    }
    add_list(key, texts);
  }

 private:
  void for_each_in(const char* key, const std::function<void(JsonFields&)>& read_entry) const;
  void add(const char* key, const std::string& json);
  void add_list(const char* key, const std::vector<std::string>& entries);

  const nlohmann::json* read_ = nullptr;
  std::string written_;
};

/// Calls `read_object` for the object in each line of a file.
/// @throws Error that names file and line
void for_each_object(const std::filesystem::path& path,
                     const std::function<void(JsonFields&)>& read_object);

/// The same for a file that is one JSON object. @throws Error that names the file
void read_object_file(const std::filesystem::path& path,
                      const std::function<void(JsonFields&)>& read_object);

/// A text in quotes that both JSON and TOML can read; bytes that are not UTF-8 become U+FFFD.
[[nodiscard]] std::string quoted_text(const std::string& text);

/// The 16 numbers of a transform, row by row.
[[nodiscard]] std::array<double, 16> row_major(const Rigid3& transform);

/// What 16 numbers, row by row, are as a rigid transform.
struct RigidRows {
  Rigid3 pose;         ///< with an exact rotation
  double skew;         ///< largest entry of R R^T - 1
  double determinant;  ///< of R
  /// Whether `skew` is at most 1e-3, as it is when few digits were written, R is no mirror, the
  /// last row is 0 0 0 1 within 1e-9, and all numbers are finite.
  bool is_rigid;
};

/// @param numbers  at least 16
[[nodiscard]] RigidRows rigid_of_rows(const std::vector<double>& numbers);

}  // namespace palpable

/// @file
/// Reads one table of a TOML file with checks; every error message names file, line and key.
#pragma once

#include "palpable/common/base/quantity.h"

#include <Eigen/Core>
#include <toml++/toml.h>

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// @param file  for messages
/// @throws Error naming file and line if the text is not TOML
[[nodiscard]] toml::table parse_toml(std::string_view text, const std::string& file);

/// The range in which a number must lie.
struct Range {
  double low, high;
  bool open_low = false, open_high = false;  ///< the end itself is not allowed

  [[nodiscard]] bool contains(double x) const {
    return (open_low ? x > low : x >= low) && (open_high ? x < high : x <= high);
  }
  [[nodiscard]] std::string text() const;
};

/// Gives access to the values of a table and records which keys were read, so that unknown keys can
/// be refused at the end. All members that take a key throw Error, naming file, line and key, if
/// the value is missing (unless there is a default), of the wrong kind, without its unit or out of
/// range.
class TomlSection {
 public:
  /// @param file   for messages; must outlive the section
  /// @param name   as written in the file, e.g. "[shape]"; empty for the file itself
  /// @param table  must outlive the section
  TomlSection(const std::string& file, std::string name, const toml::table& table);

  [[nodiscard]] std::string text(const char* key);
  [[nodiscard]] std::string choice(const char* key, const std::vector<std::string>& choices,
                                   const std::string& otherwise);
  [[nodiscard]] double number(const char* key, Range range);
  [[nodiscard]] double number(const char* key, Range range, double otherwise);
  [[nodiscard]] int integer(const char* key, int low, int high);
  [[nodiscard]] int integer(const char* key, int low, int high, int otherwise);
  /// true or false.
  [[nodiscard]] bool flag(const char* key, bool otherwise);
  /// A text with a unit, such as "150 mm", as a number in SI.
  [[nodiscard]] double quantity(const char* key, Quantity what, Range range);
  /// Three texts with units, as numbers in SI.
  [[nodiscard]] Eigen::Vector3d quantities(const char* key, Quantity what);
  /// Three numbers, not all zero, as a unit vector.
  [[nodiscard]] Eigen::Vector3d direction(const char* key);
  /// One point or a list of points: three lengths each, m.
  [[nodiscard]] std::vector<Eigen::Vector3d> points(const char* key);
  /// One text or a list of texts, none empty.
  [[nodiscard]] std::vector<std::string> texts(const char* key);

  /// A list of at least one number without unit; or of texts with a unit, as numbers in SI.
  [[nodiscard]] std::vector<double> numbers(const char* key, Range range);
  [[nodiscard]] std::vector<double> quantity_list(const char* key, Quantity what, Range range);

  [[nodiscard]] bool has(const char* key);
  [[nodiscard]] bool is_text(const char* key) const;
  [[nodiscard]] bool is_array(const char* key) const;
  /// Those of `keys` that the table has.
  [[nodiscard]] std::vector<std::string> present(const std::vector<const char*>& keys);

  /// A table within this one; an empty table if it is missing.
  [[nodiscard]] TomlSection section(const char* key);
  /// A list of tables within this one, [[key]]; one table counts as a list of one.
  [[nodiscard]] std::vector<TomlSection> sections(const char* key);

  /// To be called after all keys have been read. @throws Error for a key that was not read, with
  /// the nearest known key
  void refuse_unknown() const;

  /// The beginning of messages: "cube.toml:12: [support]" or, with a key, "cube.toml:13: 'set' in
  /// [support]".
  [[nodiscard]] std::string place() const;
  [[nodiscard]] std::string place(const char* key) const;

  /// @throws Error with the message place(key) + " " + what
  [[noreturn]] void bad(const char* key, const std::string& what) const;

 private:
  [[noreturn]] void bad(const toml::node& node, const char* key, const std::string& what) const;
  [[nodiscard]] std::string in_section() const;
  const toml::node& need(const char* key);
  double in_range(const toml::node& node, const char* key, double value, Range range) const;
  [[nodiscard]] double parse(const toml::node& node, const char* key, Quantity what) const;
  [[nodiscard]] Eigen::Vector3d parse_three(const toml::node& node, const char* key,
                                            Quantity what) const;

  const std::string* file_;
  std::string name_;
  const toml::table* table_;
  std::vector<std::string> read_keys_;
};

}  // namespace palpable

/// @file
/// One table of a TOML file, read with checks: every complaint names file, line and key.
#pragma once

#include <Eigen/Core>
#include <toml++/toml.h>

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// @param file  for messages
/// @throws Error naming file and line where the text is no TOML
[[nodiscard]] toml::table parse_toml(std::string_view text, const std::string& file);

/// Where a number may lie.
struct Range {
  double low, high;
  bool open_low = false, open_high = false;  ///< the end itself is not allowed

  [[nodiscard]] bool contains(double x) const {
    return (open_low ? x > low : x >= low) && (open_high ? x < high : x <= high);
  }
  [[nodiscard]] std::string text() const;
};

/// What a text with a unit may measure.
enum class Quantity { kLength, kPressure, kPerPressure, kForce, kDensity, kAcceleration };

/// Hands out the values of a table and at the end knows what nobody asked for. All members that
/// take a key throw Error, naming file, line and key, where the value is missing (unless there is a
/// default), of the wrong kind, without its unit or out of range.
class TomlSection {
 public:
  /// @param file   for messages; must outlive the section
  /// @param name   as it stands in the file, e.g. "[shape]"; empty for the file itself
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
  /// In SI, e.g. "150 mm".
  [[nodiscard]] double quantity(const char* key, Quantity what, Range range);
  /// Three texts with units, in SI.
  [[nodiscard]] Eigen::Vector3d quantities(const char* key, Quantity what);
  /// Three numbers, not all zero, as a unit vector.
  [[nodiscard]] Eigen::Vector3d direction(const char* key);
  /// One point or a list of points: three lengths each, m.
  [[nodiscard]] std::vector<Eigen::Vector3d> points(const char* key);
  /// One text or a list of texts, none empty.
  [[nodiscard]] std::vector<std::string> texts(const char* key);

  /// A list of numbers without unit, or of texts with one, in SI; at least one.
  [[nodiscard]] std::vector<double> numbers(const char* key, Range range);
  [[nodiscard]] std::vector<double> quantity_list(const char* key, Quantity what, Range range);

  [[nodiscard]] bool has(const char* key);
  [[nodiscard]] bool is_text(const char* key) const;
  [[nodiscard]] bool is_array(const char* key) const;
  /// Those of `keys` that are there.
  [[nodiscard]] std::vector<std::string> present(const std::vector<const char*>& keys);

  /// A table within this one; an empty one when it is missing.
  [[nodiscard]] TomlSection section(const char* key);
  /// A list of tables within this one, [[key]]; one table counts as a list of one.
  [[nodiscard]] std::vector<TomlSection> sections(const char* key);

  /// To be called when all keys have been asked for. @throws Error with the nearest known key
  void refuse_unknown() const;

  /// "cube.toml:12: [support]" or, with a key, "cube.toml:13: 'set' in [support]": how messages
  /// begin.
  [[nodiscard]] std::string place() const;
  [[nodiscard]] std::string place(const char* key) const;

  /// @throws Error: place(key), and `what` is wrong with it
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
  std::vector<std::string> asked_;
};

}  // namespace palpable

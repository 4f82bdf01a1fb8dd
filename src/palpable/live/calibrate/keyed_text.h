/// @file
/// Calibration files of other programs as a list of keys: the YAML of OpenCV, ROS and Kalibr (with
/// or without a first line %YAML), OpenCV's XML, and JSON.
///
/// OpenCV's own reader accepts none of these but its own YAML, and refuses a file without its first
/// line. This one reads what calibration programs write, not all of YAML: no anchors, no texts of
/// several lines.
#pragma once

#include "palpable/common/base/error.h"

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// Texts by the path of their key: "cam0.intrinsics", "camera_matrix.data".
class KeyedText {
 public:
  /// Which notation it is follows from the first character: { is JSON, < is XML. The problem, one
  /// line without a file's name, says why the text must not be parsed (bounded_text.h), or that it
  /// is no JSON. Any other text gives the keys that it has, perhaps none.
  [[nodiscard]] static Result<KeyedText> parse(std::string_view text);

  [[nodiscard]] bool has(std::string_view path) const;
  /// Whether it has all of these.
  [[nodiscard]] bool has_all(const std::vector<std::string_view>& paths) const;
  /// The first of some names for the same that it has; empty if it has none.
  [[nodiscard]] std::string first_of(const std::vector<std::string_view>& names) const;
  /// The value without quotes; empty if there is none.
  [[nodiscard]] std::string word(std::string_view path) const;
  /// All numbers of a value or of its `data`, nested lists in order. Nothing if there is no such
  /// key or if it holds anything that is no finite number.
  [[nodiscard]] std::optional<std::vector<double>> numbers(std::string_view path) const;
  [[nodiscard]] std::optional<double> number(std::string_view path) const;
  [[nodiscard]] const std::map<std::string, std::string, std::less<>>& entries() const {
    return entries_;
  }

 private:
  friend struct KeyedTextBuilder;
  std::map<std::string, std::string, std::less<>> entries_;
};

/// Replaces decimal commas, as in "[ 5,34e+02, 0, -0,28 ]", by points. Commas count as decimal
/// ones if no number of the text has a point and no word has two commas; "[1,2,3]" and "[640,480]"
/// are lists. Any other text is returned unchanged.
[[nodiscard]] std::string with_decimal_points(std::string text);

}  // namespace palpable

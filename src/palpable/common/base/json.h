/// @file
/// JSON values for the output of programs. They are written by nlohmann's library, which only
/// json.cpp includes: its header takes two seconds to compile and more to instantiate. The keys of
/// an object keep the order in which they were added.
#pragma once

#include "palpable/common/base/error.h"

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace palpable {

/// null, a boolean, a number, a text, an array or an object. A number that is not finite is written
/// as null, a byte that is not valid UTF-8 as U+FFFD.
class Json {
 public:
  using Array = std::vector<Json>;
  using Object = std::vector<std::pair<std::string, Json>>;

  Json() = default;
  Json(std::nullptr_t) {}
  template <std::same_as<bool> T>
  Json(T value) : value_(value) {}
  template <std::signed_integral T>
  Json(T value) : value_(static_cast<std::int64_t>(value)) {}
  template <std::unsigned_integral T>
  requires(!std::same_as<T, bool>) Json(T value) : value_(static_cast<std::uint64_t>(value)) {}
  template <std::floating_point T>
  Json(T value) : value_(static_cast<double>(value)) {}
  Json(const char* text) : value_(std::string(text)) {}
  Json(std::string_view text) : value_(std::string(text)) {}
  Json(std::string text) : value_(std::move(text)) {}
  /// The value, or null.
  template <class T>
  Json(const std::optional<T>& value) {
    if (value) *this = Json(*value);
  }
  template <class T>
  Json(const std::vector<T>& values) : value_(Array(values.begin(), values.end())) {}
  template <class T, std::size_t N>
  Json(const std::array<T, N>& values) : value_(Array(values.begin(), values.end())) {}
  template <class T>
  Json(const std::map<std::string, T>& values) : value_(Object(values.begin(), values.end())) {}
  /// An object if every element is a pair that begins with a text, {{"a", 1}, {"b", 2}}; otherwise
  /// an array.
  Json(std::initializer_list<Json> elements);

  /// An array, even of elements that braces alone would make an object.
  [[nodiscard]] static Json array(std::initializer_list<Json> elements = {});
  /// An object without keys.
  [[nodiscard]] static Json object();
  /// Reads a text such as dump() writes; numbers are restored to the bit. The problem, without a
  /// file's name, says that the text is not JSON, or too long or nested too deep (bounded_text.h).
  [[nodiscard]] static Result<Json> parse(std::string_view text);

  /// The value of `key` in an object; a missing key is added with null, and null becomes an object.
  Json& operator[](std::string_view key);
  /// @throws Error if this is not an object that holds `key`
  const Json& operator[](std::string_view key) const;
  /// @throws Error if this is not an array of more than `index` values
  const Json& operator[](int index) const;
  [[nodiscard]] bool contains(std::string_view key) const;
  /// Sets all keys of another object.
  void update(const Json& object);
  /// Appends to an array (null becomes one).
  void push_back(Json value);

  [[nodiscard]] bool is_null() const { return std::holds_alternative<std::nullptr_t>(value_); }
  [[nodiscard]] bool is_integer() const;
  /// The value as double, int, std::string or bool. @throws Error if it is of another kind
  template <class T>
  [[nodiscard]] T get() const;
  [[nodiscard]] bool is_array() const { return std::holds_alternative<Array>(value_); }
  [[nodiscard]] bool is_object() const { return std::holds_alternative<Object>(value_); }
  /// The value of `key`; null if this is not an object that holds it. Valid until a key is added.
  [[nodiscard]] const Json* find(std::string_view key) const;
  /// The value if it is a number, a whole number in 64 bits, a text; else nothing (null). For
  /// readers that must not throw.
  [[nodiscard]] std::optional<double> if_number() const;
  [[nodiscard]] std::optional<std::int64_t> if_whole() const;
  [[nodiscard]] const std::string* if_text() const { return std::get_if<std::string>(&value_); }
  /// The values of an array; empty if this is not an array.
  [[nodiscard]] Array::const_iterator begin() const { return values().begin(); }
  [[nodiscard]] Array::const_iterator end() const { return values().end(); }
  [[nodiscard]] std::size_t size() const { return values().size(); }
  /// The keys and values of an object; empty if this is not an object.
  [[nodiscard]] const Object& items() const;

  /// @param indent  spaces for each depth, a line for each value; negative: all in one line
  [[nodiscard]] std::string dump(int indent = -1) const;

 private:
  [[nodiscard]] const Array& values() const;

  std::variant<std::nullptr_t, bool, std::int64_t, std::uint64_t, double, std::string, Array,
               Object>
      value_ = nullptr;

  friend struct JsonWriter;
};

}  // namespace palpable

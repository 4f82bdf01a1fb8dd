#include "palpable/common/base/json.h"

#include "palpable/common/base/bounded_text.h"
#include "palpable/common/base/error.h"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <type_traits>

namespace palpable {

// Converts values to those of nlohmann's library, which writes them.
struct JsonWriter {
  static nlohmann::ordered_json of(const Json& json) {
    return std::visit([](const auto& value) { return of_value(value); }, json.value_);
  }

 private:
  static nlohmann::ordered_json of_value(const auto& value) { return value; }

  static nlohmann::ordered_json of_value(const Json::Array& values) {
    nlohmann::ordered_json result = nlohmann::ordered_json::array();
    for (const Json& value : values) result.push_back(of(value));
    return result;
  }

  static nlohmann::ordered_json of_value(const Json::Object& members) {
    nlohmann::ordered_json result = nlohmann::ordered_json::object();
    for (const auto& [key, value] : members) result[key] = of(value);
    return result;
  }
};

namespace {

// Recursive; the text was checked to be nested at most kDeepestNesting deep.
Json value_of(const nlohmann::ordered_json& parsed) {
  switch (parsed.type()) {
    case nlohmann::ordered_json::value_t::boolean:
      return parsed.get<bool>();
    case nlohmann::ordered_json::value_t::number_integer:
      return parsed.get<std::int64_t>();
    case nlohmann::ordered_json::value_t::number_unsigned:
      return parsed.get<std::uint64_t>();
    case nlohmann::ordered_json::value_t::number_float:
      return parsed.get<double>();
    case nlohmann::ordered_json::value_t::string:
      return parsed.get<std::string>();
    case nlohmann::ordered_json::value_t::array: {
      Json list = Json::array();
      for (const auto& value : parsed) list.push_back(value_of(value));
      return list;
    }
    case nlohmann::ordered_json::value_t::object: {
      Json object = Json::object();
      for (const auto& [key, value] : parsed.items()) object[key] = value_of(value);
      return object;
    }
    default:
      return nullptr;
  }
}

}  // namespace

Result<Json> Json::parse(std::string_view text) {
  if (const auto why = why_not_parsed(text, Notation::kJson)) {
    return Problem{fmt::format("line {}: {}", why->line, why->what)};
  }
  const auto parsed = nlohmann::ordered_json::parse(text, nullptr, false);
  if (parsed.is_discarded()) return Problem{"is no JSON"};
  return value_of(parsed);
}

Json::Json(std::initializer_list<Json> elements) {
  const bool all_pairs = std::all_of(elements.begin(), elements.end(), [](const Json& element) {
    const Array& pair = element.values();
    return pair.size() == 2 && std::holds_alternative<std::string>(pair[0].value_);
  });
  if (!all_pairs) {
    value_ = Array(elements);
    return;
  }
  value_ = Object();
  for (const Json& element : elements) {
    const Array& pair = element.values();
    const auto& key = std::get<std::string>(pair[0].value_);
    if (!contains(key)) (*this)[key] = pair[1];  // the first of equal keys is kept
  }
}

Json Json::array(std::initializer_list<Json> elements) {
  Json result;
  result.value_ = Array(elements);
  return result;
}

Json Json::object() {
  Json result;
  result.value_ = Object();
  return result;
}

const Json* Json::find(std::string_view key) const {
  for (const auto& [name, value] : items()) {
    if (name == key) return &value;
  }
  return nullptr;
}

Json& Json::operator[](std::string_view key) {
  if (is_null()) value_ = Object();
  auto* members = std::get_if<Object>(&value_);
  if (members == nullptr)
    throw Error(fmt::format("the JSON value with '{}' is not an object", key));
  for (auto& [name, value] : *members) {
    if (name == key) return value;
  }
  return members->emplace_back(std::string(key), Json()).second;
}

const Json& Json::operator[](std::string_view key) const {
  const Json* found = find(key);
  if (found == nullptr) throw Error(fmt::format("the JSON value has no '{}'", key));
  return *found;
}

const Json& Json::operator[](int index) const {
  if (index < 0 || static_cast<std::size_t>(index) >= size()) {
    throw Error(fmt::format("the JSON array has {} values, and no [{}]", size(), index));
  }
  return values()[index];
}

bool Json::contains(std::string_view key) const { return find(key) != nullptr; }

void Json::update(const Json& object) {
  for (const auto& [key, value] : object.items()) (*this)[key] = value;
}

void Json::push_back(Json value) {
  if (is_null()) value_ = Array();
  auto* values = std::get_if<Array>(&value_);
  if (values == nullptr) throw Error("a value is appended to a JSON value that is not an array");
  values->push_back(std::move(value));
}

bool Json::is_integer() const {
  return std::holds_alternative<std::int64_t>(value_) ||
         std::holds_alternative<std::uint64_t>(value_);
}

std::optional<double> Json::if_number() const {
  if (const auto* number = std::get_if<double>(&value_)) return *number;
  if (const auto* number = std::get_if<std::int64_t>(&value_)) {
    return static_cast<double>(*number);
  }
  if (const auto* number = std::get_if<std::uint64_t>(&value_)) {
    return static_cast<double>(*number);
  }
  return std::nullopt;
}

std::optional<std::int64_t> Json::if_whole() const {
  if (const auto* number = std::get_if<std::int64_t>(&value_)) return *number;
  const auto* number = std::get_if<std::uint64_t>(&value_);
  if (number != nullptr && std::in_range<std::int64_t>(*number)) {
    return static_cast<std::int64_t>(*number);
  }
  return std::nullopt;
}

template <class T>
T Json::get() const {
  return std::visit(
      [](const auto& value) -> T {
        using Held = std::decay_t<decltype(value)>;
        constexpr bool kNumber = std::is_arithmetic_v<Held> && !std::same_as<Held, bool>;
        if constexpr (std::same_as<T, Held>) {
          return value;
        } else if constexpr (kNumber && std::is_arithmetic_v<T> && !std::same_as<T, bool>) {
          return static_cast<T>(value);
        } else {
          throw Error("a JSON value is of another kind than the requested one");
        }
      },
      value_);
}

template bool Json::get() const;
template int Json::get() const;
template double Json::get() const;
template std::string Json::get() const;

const Json::Array& Json::values() const {
  static const Array kNone;
  const auto* values = std::get_if<Array>(&value_);
  return values != nullptr ? *values : kNone;
}

const Json::Object& Json::items() const {
  static const Object kNone;
  const auto* members = std::get_if<Object>(&value_);
  return members != nullptr ? *members : kNone;
}

std::string Json::dump(int indent) const {
  // JSON is UTF-8, but names of files need not be: invalid bytes are replaced.
  return JsonWriter::of(*this).dump(indent, ' ', false,
                                    nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace palpable

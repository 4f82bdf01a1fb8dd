#include "palpable/common/toml/toml_section.h"

#include "palpable/common/base/bounded_text.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/nearest_word.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace palpable {
toml::table parse_toml(std::string_view text, const std::string& file) {
  if (const auto unparsable = why_not_parsed(text, Notation::kToml)) {
    throw Error(fmt::format("{}:{}: {}", file, unparsable->line, unparsable->what));
  }
  try {
    return toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    throw Error(fmt::format("{}:{}: {}", file, error.source().begin.line, error.description()));
  }
}

std::string Range::text() const {
  const std::string lowest = fmt::format("{} {}", open_low ? "above" : "at least", low);
  if (high == std::numeric_limits<double>::infinity()) return lowest;
  return fmt::format("{} and {} {}", lowest, open_high ? "below" : "at most", high);
}

TomlSection::TomlSection(const std::string& file, std::string name, const toml::table& table)
    : file_(&file), name_(std::move(name)), table_(&table) {}

std::string TomlSection::text(const char* key) {
  const toml::node& node = need(key);
  const auto value = node.value_exact<std::string>();
  if (!value || value->empty()) bad(node, key, "must be a text in quotes");
  return *value;
}

std::string TomlSection::choice(const char* key, const std::vector<std::string>& choices,
                                const std::string& otherwise) {
  if (!has(key)) return otherwise;
  const std::string value = text(key);
  if (std::find(choices.begin(), choices.end(), value) == choices.end()) {
    const std::string guess = nearest_word(value, choices);
    bad(key, fmt::format("is '{}', must be one of '{}'{}", value, fmt::join(choices, "', '"),
                         guess.empty() ? "" : fmt::format("; did you mean '{}'?", guess)));
  }
  return value;
}

double TomlSection::number(const char* key, Range range) {
  const toml::node& node = need(key);
  if (!node.is_number()) bad(node, key, "must be a number without unit");
  return in_range(node, key, node.value<double>().value_or(std::nan("")), range);
}
double TomlSection::number(const char* key, Range range, double otherwise) {
  return has(key) ? number(key, range) : otherwise;
}

int TomlSection::integer(const char* key, int low, int high) {
  const toml::node& node = need(key);
  const auto value = node.value_exact<std::int64_t>();
  if (!value) bad(node, key, "must be a whole number");
  in_range(node, key, static_cast<double>(*value),
           {static_cast<double>(low), static_cast<double>(high)});
  return static_cast<int>(*value);
}
int TomlSection::integer(const char* key, int low, int high, int otherwise) {
  return has(key) ? integer(key, low, high) : otherwise;
}

bool TomlSection::flag(const char* key, bool otherwise) {
  if (!has(key)) return otherwise;
  const toml::node& node = need(key);
  const auto value = node.value_exact<bool>();
  if (!value) bad(node, key, "must be true or false");
  return *value;
}

double TomlSection::quantity(const char* key, Quantity what, Range range) {
  const toml::node& node = need(key);
  return in_range(node, key, parse(node, key, what), range);
}

Eigen::Vector3d TomlSection::quantities(const char* key, Quantity what) {
  return parse_three(need(key), key, what);
}

Eigen::Vector3d TomlSection::direction(const char* key) {
  const toml::node& node = need(key);
  const toml::array* list = node.as_array();
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  bool three = list != nullptr && list->size() == 3;
  for (std::size_t k = 0; three && k < 3; ++k) {
    const toml::node& entry = *list->get(k);
    three = entry.is_number();
    if (three) v[static_cast<Eigen::Index>(k)] = entry.value<double>().value_or(0.0);
  }
  if (!three) bad(node, key, "must be three numbers, such as [0, 0, -1]");
  const double length = v.norm();
  if (!(length > 0.0) || !std::isfinite(length))
    bad(node, key, "has no direction: its length is zero or not finite");
  return v / length;
}

std::vector<Eigen::Vector3d> TomlSection::points(const char* key) {
  const toml::node& node = need(key);
  const toml::array* list = node.as_array();
  if (list == nullptr || list->empty()) {
    bad(node, key, "must be a list of points, such as [[\"0 mm\", \"5 mm\", \"80 mm\"]]");
  }
  if (!list->get(0)->is_array()) return {parse_three(node, key, Quantity::kLength)};
  std::vector<Eigen::Vector3d> all;
  for (const toml::node& entry : *list) {
    all.push_back(parse_three(entry, key, Quantity::kLength));
  }
  return all;
}

std::vector<std::string> TomlSection::texts(const char* key) {
  const toml::node& node = need(key);
  const toml::array* list = node.as_array();
  if (list == nullptr) return {text(key)};
  std::vector<std::string> all;
  for (const toml::node& entry : *list) {
    const auto value = entry.value_exact<std::string>();
    if (!value || value->empty()) bad(entry, key, "must be a list of texts in quotes");
    all.push_back(*value);
  }
  if (all.empty()) bad(node, key, "is an empty list");
  return all;
}

std::vector<double> TomlSection::numbers(const char* key, Range range) {
  const toml::node& node = need(key);
  const toml::array* list = node.as_array();
  if (list == nullptr || list->empty()) bad(node, key, "must be a list, such as [0.5, 1, 2]");
  std::vector<double> all;
  for (const toml::node& entry : *list) {
    if (!entry.is_number()) bad(entry, key, "must be a list of numbers without unit");
    all.push_back(in_range(entry, key, entry.value<double>().value_or(std::nan("")), range));
  }
  return all;
}

std::vector<double> TomlSection::quantity_list(const char* key, Quantity what, Range range) {
  const toml::node& node = need(key);
  const toml::array* list = node.as_array();
  if (list == nullptr || list->empty()) bad(node, key, "must be a list of texts with a unit");
  std::vector<double> all;
  for (const toml::node& entry : *list) {
    all.push_back(in_range(entry, key, parse(entry, key, what), range));
  }
  return all;
}

bool TomlSection::has(const char* key) {
  if (std::find(read_keys_.begin(), read_keys_.end(), key) == read_keys_.end())
    read_keys_.emplace_back(key);
  return table_->contains(key);
}

bool TomlSection::is_text(const char* key) const {
  const toml::node* node = table_->get(key);
  return node != nullptr && node->is_string();
}

bool TomlSection::is_array(const char* key) const {
  const toml::node* node = table_->get(key);
  return node != nullptr && node->is_array();
}

std::vector<std::string> TomlSection::present(const std::vector<const char*>& keys) {
  std::vector<std::string> found;
  for (const char* key : keys) {
    if (has(key)) found.emplace_back(key);
  }
  return found;
}

TomlSection TomlSection::section(const char* key) {
  static const toml::table kEmpty;
  const std::string name = fmt::format("[{}]", key);
  if (!has(key)) return {*file_, name, kEmpty};
  const toml::node& node = *table_->get(key);
  if (!node.is_table()) bad(node, key, fmt::format("must be a section {}", name));
  return {*file_, name, *node.as_table()};
}

std::vector<TomlSection> TomlSection::sections(const char* key) {
  std::vector<TomlSection> all;
  if (!has(key)) return all;
  // "[material]" within the file, "[[material.group]]" within that.
  const std::string path =
      name_.empty() ? key : fmt::format("{}.{}", name_.substr(1, name_.size() - 2), key);
  const toml::node& node = *table_->get(key);
  if (const toml::table* table = node.as_table()) {
    all.push_back({*file_, fmt::format("[{}]", path), *table});
    return all;
  }
  const toml::array* list = node.as_array();
  if (list == nullptr) bad(node, key, fmt::format("must be sections [[{}]]", path));
  for (const toml::node& entry : *list) {
    if (!entry.is_table()) bad(entry, key, fmt::format("must be sections [[{}]]", path));
    all.push_back({*file_, fmt::format("[[{}]]", path), *entry.as_table()});
  }
  return all;
}

void TomlSection::refuse_unknown() const {
  for (const auto& [key, node] : *table_) {
    const std::string word(key.str());
    if (std::find(read_keys_.begin(), read_keys_.end(), word) != read_keys_.end()) continue;
    const std::string guess = nearest_word(word, read_keys_);
    throw Error(fmt::format(
        "{}:{}: unknown key '{}'{}; {}", *file_, key.source().begin.line, word, in_section(),
        guess.empty() ? fmt::format("known are '{}'", fmt::join(read_keys_, "', '"))
                      : fmt::format("did you mean '{}'?", guess)));
  }
}

std::string TomlSection::place() const {
  const auto line = table_->source().begin.line;
  if (line == 0) return fmt::format("{}: {}", *file_, name_);
  return fmt::format("{}:{}: {}", *file_, line, name_);
}

std::string TomlSection::place(const char* key) const {
  const toml::node* node = table_->get(key);
  if (node == nullptr) return fmt::format("{}: '{}'{}", *file_, key, in_section());
  return fmt::format("{}:{}: '{}'{}", *file_, node->source().begin.line, key, in_section());
}

void TomlSection::bad(const char* key, const std::string& what) const {
  throw Error(fmt::format("{} {}", place(key), what));
}

void TomlSection::bad(const toml::node& node, const char* key, const std::string& what) const {
  throw Error(
      fmt::format("{}:{}: '{}'{} {}", *file_, node.source().begin.line, key, in_section(), what));
}

std::string TomlSection::in_section() const {
  return name_.empty() ? "" : fmt::format(" in {}", name_);
}

const toml::node& TomlSection::need(const char* key) {
  if (has(key)) return *table_->get(key);
  // A missing key is usually there under a misspelt name.
  for (const auto& [word, node] : *table_) {
    if (nearest_word(word.str(), {key}).empty()) continue;
    if (std::find(read_keys_.begin(), read_keys_.end(), word.str()) != read_keys_.end()) continue;
    throw Error(fmt::format("{}:{}: unknown key '{}'{}; did you mean '{}'?", *file_,
                            word.source().begin.line, word.str(), in_section(), key));
  }
  throw Error(fmt::format("{}: '{}'{} is missing", *file_, key, in_section()));
}

double TomlSection::in_range(const toml::node& node, const char* key, double value,
                             Range range) const {
  if (!range.contains(value)) {
    bad(node, key, fmt::format("is {}, must be {}", value, range.text()));
  }
  return value;
}

double TomlSection::parse(const toml::node& node, const char* key, Quantity what) const {
  const auto text = node.value_exact<std::string>();
  if (!text) {
    bad(node, key, fmt::format("must be a text with a unit, such as \"{}\"", example_of(what)));
  }
  const std::optional<double> value = to_quantity(*text, what);
  if (!value) {
    bad(node, key, fmt::format("is \"{}\", {}", text->substr(0, 40), why_no_quantity(*text, what)));
  }
  return *value;
}

Eigen::Vector3d TomlSection::parse_three(const toml::node& node, const char* key,
                                         Quantity what) const {
  const toml::array* list = node.as_array();
  const char* example = example_of(what);
  if (list == nullptr || list->size() != 3) {
    bad(node, key,
        fmt::format("must be three texts with units, such as [\"{}\", \"{}\", \"{}\"]", example,
                    example, example));
  }
  Eigen::Vector3d v;
  for (std::size_t k = 0; k < 3; ++k) {
    v[static_cast<Eigen::Index>(k)] = parse(*list->get(k), key, what);
    if (!std::isfinite(v[static_cast<Eigen::Index>(k)])) bad(node, key, "is not finite");
  }
  return v;
}

}  // namespace palpable

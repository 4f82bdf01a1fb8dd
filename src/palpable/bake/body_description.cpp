#include "palpable/bake/body_description.h"

#include "palpable/base/error.h"
#include "palpable/base/nearest_word.h"
#include "palpable/solid/material.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <utility>
#include <vector>

namespace palpable {
namespace {

struct Unit {
  std::string_view name;
  double size;  // in SI
};
constexpr std::array kLengths{Unit{"m", 1.0}, Unit{"cm", 1e-2}, Unit{"mm", 1e-3}};
constexpr std::array kPressures{Unit{"Pa", 1.0}, Unit{"kPa", 1e3}, Unit{"MPa", 1e6},
                                Unit{"GPa", 1e9}};

struct Range {
  double low, high;
  bool open_low = false, open_high = false;  // the end itself is not allowed

  [[nodiscard]] bool contains(double x) const {
    return (open_low ? x > low : x >= low) && (open_high ? x < high : x <= high);
  }
  [[nodiscard]] std::string text() const {
    return fmt::format("{} {} and {} {}", open_low ? "above" : "at least", low,
                       open_high ? "below" : "at most", high);
  }
};

// One table of the file: hands out its values and at the end knows what nobody asked for.
class Section {
 public:
  Section(const std::string& file, std::string name, const toml::table& table)
      : file_(file), name_(std::move(name)), table_(table) {}

  std::string text(const char* key) {
    const toml::node& node = need(key);
    const auto value = node.value_exact<std::string>();
    if (!value || value->empty()) bad(node, key, "must be a text in quotes");
    return *value;
  }

  std::string choice(const char* key, const std::vector<std::string>& choices,
                     const std::string& otherwise) {
    if (!has(key)) return otherwise;
    const std::string value = text(key);
    if (std::find(choices.begin(), choices.end(), value) == choices.end()) {
      const std::string guess = nearest_word(value, choices);
      bad(*table_.get(key), key,
          fmt::format("is '{}', must be one of '{}'{}", value, fmt::join(choices, "', '"),
                      guess.empty() ? "" : fmt::format("; did you mean '{}'?", guess)));
    }
    return value;
  }

  double number(const char* key, Range range) {
    const toml::node& node = need(key);
    if (!node.is_number()) bad(node, key, "must be a number without unit");
    const double value = node.value<double>().value_or(std::nan(""));
    return in_range(node, key, value, range);
  }
  double number(const char* key, Range range, double otherwise) {
    return has(key) ? number(key, range) : otherwise;
  }

  int integer(const char* key, int low, int high) {
    const toml::node& node = need(key);
    const auto value = node.value_exact<std::int64_t>();
    if (!value) bad(node, key, "must be a whole number");
    in_range(node, key, static_cast<double>(*value),
             {static_cast<double>(low), static_cast<double>(high)});
    return static_cast<int>(*value);
  }
  int integer(const char* key, int low, int high, int otherwise) {
    return has(key) ? integer(key, low, high) : otherwise;
  }

  double length(const char* key, Range range) { return quantity(key, kLengths, range, "150 mm"); }
  double pressure(const char* key, Range range) {
    return quantity(key, kPressures, range, "60 kPa");
  }

  bool has(const char* key) {
    if (std::find(asked_.begin(), asked_.end(), key) == asked_.end()) asked_.emplace_back(key);
    return table_.contains(key);
  }

  // A table within this one; an empty one when it is missing.
  Section section(const char* key) {
    static const toml::table kEmpty;
    if (!has(key)) return {file_, key, kEmpty};
    const toml::node& node = *table_.get(key);
    if (!node.is_table()) bad(node, key, fmt::format("must be a section [{}]", key));
    return {file_, key, *node.as_table()};
  }

  // To be called when all keys have been asked for.
  void refuse_unknown() const {
    for (const auto& [key, node] : table_) {
      const std::string word(key.str());
      if (std::find(asked_.begin(), asked_.end(), word) != asked_.end()) continue;
      const std::string guess = nearest_word(word, asked_);
      throw Error(fmt::format(
          "{}:{}: unknown key '{}'{}; {}", file_, key.source().begin.line, word, in_section(),
          guess.empty() ? fmt::format("known are '{}'", fmt::join(asked_, "', '"))
                        : fmt::format("did you mean '{}'?", guess)));
    }
  }

 private:
  [[nodiscard]] std::string in_section() const {
    return name_.empty() ? "" : fmt::format(" in [{}]", name_);
  }

  [[noreturn]] void bad(const toml::node& node, const char* key, const std::string& what) const {
    throw Error(
        fmt::format("{}:{}: '{}'{} {}", file_, node.source().begin.line, key, in_section(), what));
  }

  const toml::node& need(const char* key) {
    if (has(key)) return *table_.get(key);
    // A key that is missing is usually there, misspelt.
    for (const auto& [word, node] : table_) {
      if (nearest_word(word.str(), {key}).empty()) continue;
      throw Error(fmt::format("{}:{}: unknown key '{}'{}; did you mean '{}'?", file_,
                              word.source().begin.line, word.str(), in_section(), key));
    }
    throw Error(fmt::format("{}: '{}'{} is missing", file_, key, in_section()));
  }

  double in_range(const toml::node& node, const char* key, double value, Range range) const {
    if (!range.contains(value)) {
      bad(node, key, fmt::format("is {}, must be {}", value, range.text()));
    }
    return value;
  }

  template <std::size_t n>
  double quantity(const char* key, const std::array<Unit, n>& units, Range range,
                  const char* example) {
    const toml::node& node = need(key);
    const std::string wanted = fmt::format("must be a text with a unit, such as \"{}\"", example);
    const auto value = node.value_exact<std::string>();
    if (!value) bad(node, key, wanted);
    double number = 0;
    const char* end = value->data() + value->size();
    const auto [rest, code] = std::from_chars(value->data(), end, number);
    std::string_view unit(rest, static_cast<std::size_t>(end - rest));
    unit.remove_prefix(std::min(unit.find_first_not_of(' '), unit.size()));
    const auto at = std::find_if(units.begin(), units.end(),
                                 [unit](const Unit& known) { return known.name == unit; });
    if (code != std::errc() || at == units.end()) {
      bad(node, key, fmt::format("is \"{}\", {}", value->substr(0, 40), wanted));
    }
    return in_range(node, key, number * at->size, range);
  }

  const std::string& file_;
  std::string name_;  // of the section; empty for the file itself
  const toml::table& table_;
  std::vector<std::string> asked_;
};

UpAxis up_axis(const std::string& text) {
  return text == "x" ? UpAxis::kX : text == "y" ? UpAxis::kY : UpAxis::kZ;
}

void read_shape(Section section, const std::string& file, BodyDescription& body) {
  const bool surface = section.has("surface");
  const bool mesh = section.has("mesh");
  if (surface == mesh) {
    throw Error(
        fmt::format("{}: [shape] needs either 'surface' (a file of triangles) or 'mesh' "
                    "(a .msh file of tetrahedra){}",
                    file, surface ? ", not both" : ""));
  }
  std::filesystem::path path = section.text(surface ? "surface" : "mesh");
  if (path.is_relative()) path = body.source.parent_path() / path;
  body.shape.file = path.lexically_normal();
  if (mesh && !body.shape.is_volume()) {
    throw Error(fmt::format("{}: 'mesh' in [shape] names '{}', which does not end in .msh", file,
                            path.filename().string()));
  }
  body.shape.up = up_axis(section.choice("up", {"x", "y", "z"}, "z"));
  const Range lengths{0.0, 100.0, true};
  if (section.has("height")) body.shape.height = section.length("height", lengths);
  if (section.has("edge")) body.shape.edge = section.length("edge", lengths);
  if (mesh && body.shape.edge) {
    throw Error(
        fmt::format("{}: 'edge' in [shape] remeshes a surface; a 'mesh' is taken as it is", file));
  }
  section.refuse_unknown();
}

}  // namespace

bool BodyDescription::Shape::is_volume() const { return file.extension() == ".msh"; }

BodyDescription parse_body_description(std::string_view text, const std::filesystem::path& path) {
  const std::string file = path.string();
  toml::table table;
  try {
    table = toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    throw Error(fmt::format("{}:{}: {}", file, error.source().begin.line, error.description()));
  }
  BodyDescription body;
  body.source = path;
  Section root(file, "", table);
  body.name = root.text("name");
  read_shape(root.section("shape"), file, body);

  Section material = root.section("material");
  body.material.law = material.choice("law", law_names(), body.material.law);
  body.material.young = material.pressure("young", {0.0, 1e13, true});
  body.material.poisson = material.number("poisson", {0.0, 0.5, false, true});
  material.refuse_unknown();

  Section support = root.section("support");
  body.support.below = support.number("below", {0.0, 1.0, true, true}, body.support.below);
  support.refuse_unknown();

  Section sites = root.section("sites");
  body.sites.count = sites.integer("count", 1, 100000);
  body.sites.above = sites.number("above", {0.0, 1.0, false, true}, body.sites.above);
  body.sites.patch = sites.integer("patch", 0, 20, body.sites.patch);
  sites.refuse_unknown();

  Section press = root.section("press");
  body.press.depth = press.number("depth", {0.0, 1.0, true}, body.press.depth);
  body.press.levels = press.integer("levels", 2, 1000, body.press.levels);
  press.refuse_unknown();

  Section reduction = root.section("reduction");
  body.reduction.tolerance =
      reduction.number("tolerance", {1e-6, 1.0, false, true}, body.reduction.tolerance);
  body.reduction.max_modes = reduction.integer("max_modes", 1, 100000, body.reduction.max_modes);
  reduction.refuse_unknown();
  root.refuse_unknown();
  return body;
}

BodyDescription read_body_description(const std::filesystem::path& path) {
  std::error_code code;
  if (!std::filesystem::is_regular_file(path, code)) {
    throw Error(fmt::format("{}: no such file", path.string()));
  }
  std::ifstream file(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (!file) throw Error(fmt::format("{}: cannot be read", path.string()));
  return parse_body_description(text, path);
}

}  // namespace palpable

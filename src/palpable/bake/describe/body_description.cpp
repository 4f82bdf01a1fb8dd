#include "palpable/bake/describe/body_description.h"

#include "palpable/bake/mesh/volume_mesh.h"
#include "palpable/bake/separate/sparse_pgd.h"
#include "palpable/common/base/bounded_text.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/quantity.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/base/whole_file.h"
#include "palpable/common/material/material.h"
#include "palpable/common/toml/toml_section.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <system_error>
#include <utility>

namespace palpable {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Accepted ranges. Lengths are in m, up to kLargestBody (body_size.h); moduli in Pa, up to above
// that of diamond.
constexpr Range kLength{0.0, 100.0, true};
constexpr Range kModulus{0.0, 1e13, true};
constexpr Range kFraction{0.0, 1.0, true, true};

// The unit of lengths in the shape's file, m; messages name the usual ones.
double unit_of_file(TomlSection& section) {
  if (section.is_text("unit")) {
    if (const auto size = length_unit(section.text("unit"))) return *size;
  }
  return length_unit(section.choice("unit", length_unit_names(), "m")).value();
}

UpAxis up_axis(const std::string& text) {
  return text == "x" ? UpAxis::kX : text == "y" ? UpAxis::kY : UpAxis::kZ;
}

// Who made the shape, for pages that show it. Its address becomes a link.
void read_credit(TomlSection& section, BodyDescription::Shape& shape) {
  if (section.has("credit")) shape.credit = section.text("credit");
  for (const auto& [key, text] :
       {std::pair{"credit_url", &shape.credit_url}, std::pair{"terms", &shape.terms}}) {
    if (!section.has(key)) continue;
    *text = section.text(key);
    if (shape.credit.empty()) section.bad(key, "belongs to a 'credit', and there is none");
  }
  const std::string& url = shape.credit_url;
  if (!url.empty() && !url.starts_with("https://") && !url.starts_with("http://")) {
    section.bad("credit_url", "is the address of a page: it begins with https:// or http://");
  }
}

void read_shape(TomlSection section, const std::string& file, BodyDescription& body) {
  BodyDescription::Shape& shape = body.shape;
  const bool surface = section.has("surface");
  const bool mesh = section.has("mesh");
  if (surface == mesh) {
    throw Error(
        fmt::format("{}: [shape] needs either 'surface' (a file of triangles) or 'mesh' "
                    "(a .msh, .inp, .vtu or .vtk file of tetrahedra){}",
                    file, surface ? ", not both" : ""));
  }
  std::filesystem::path path = section.text(surface ? "surface" : "mesh");
  if (path.is_relative()) path = body.source.parent_path() / path;
  shape.file = path.lexically_normal();
  if (mesh && !shape.is_volume()) {
    section.bad("mesh", fmt::format("names '{}', which does not end in .msh, .inp, .vtu or .vtk",
                                    path.filename().string()));
  }
  shape.up = up_axis(section.choice("up", {"x", "y", "z"}, "z"));
  if (section.has("height")) shape.height = section.quantity("height", Quantity::kLength, kLength);
  shape.unit = unit_of_file(section);
  if (shape.height && section.has("unit")) {
    section.bad("unit",
                "says what lengths in the file are, and 'height' scales them anew: leave "
                "one of the two out");
  }
  if (section.has("edge")) shape.edge = section.quantity("edge", Quantity::kLength, kLength);
  if (mesh && shape.edge) { section.bad("edge", "remeshes a surface; a 'mesh' is taken as it is"); }
  for (const auto& [key, length] :
       {std::pair{"inner_edge", &shape.inner_edge}, std::pair{"wrap", &shape.wrap}}) {
    if (!section.has(key)) continue;
    *length = section.quantity(key, Quantity::kLength, kLength);
    if (mesh) section.bad(key, "is for a surface; a 'mesh' is taken as it is");
  }
  if (shape.wrap && !shape.edge) {
    section.bad("wrap",
                "leaves triangles of all sizes: give an 'edge', to which they are remeshed");
  }
  read_credit(section, shape);
  shape.place = section.place();
  shape.order_place = section.place("order");
  if (section.has("order")) shape.order = section.integer("order", 1, 2);
  section.refuse_unknown();
}

constexpr Range kAbove0{0.0, kInfinity, true, true};

// A figure in the wrong unit is often beyond that of any material. @param young  Pa
void refuse_stiffer_than_diamond(TomlSection& section, double young) {
  if (young <= kModulus.high) return;
  section.bad("young", fmt::format("is {} Pa, and nothing is stiffer than diamond, {:.1e} Pa: "
                                   "look at its unit (Pa, kPa, MPa, GPa)",
                                   number_text(young), kStiffest));
}

// Young's modulus, Pa.
double read_young(TomlSection& section) {
  const double young = section.quantity("young", Quantity::kPressure, kAbove0);
  refuse_stiffer_than_diamond(section, young);
  return young;
}

// kg/m^3.
double read_density(TomlSection& section) {
  constexpr double kLargestDensity = 1e5;
  const double density = section.quantity("density", Quantity::kDensity, kAbove0);
  if (density > kLargestDensity) {
    section.bad("density", fmt::format("is {} kg/m^3, and nothing is denser than osmium, 22600 "
                                       "kg/m^3: look at its unit (1 g/cm^3 is 1000 kg/m^3)",
                                       number_text(density)));
  }
  return density;
}

// Reads a law and its constants: 'young' and 'poisson', or those of its formula.
BodyDescription::MaterialLaw read_law(TomlSection& section, const std::string& default_law) {
  BodyDescription::MaterialLaw material;
  material.place = section.place();
  material.law = section.choice("law", law_names(), default_law);
  const std::span<const LawConstant> own = law_constants(material.law);
  std::vector<const char*> names;
  for (const LawConstant& constant : own) names.push_back(constant.name);
  const std::vector<std::string> given = section.present(names);
  if (given.empty()) {
    material.young = read_young(section);
    material.poisson = section.number("poisson", {0.0, 0.5, false, true});
    return material;
  }
  for (const char* elastic : {"young", "poisson"}) {
    if (section.has(elastic)) {
      section.bad(elastic, fmt::format("does not go with '{}': give either 'young' and 'poisson' "
                                       "or all of '{}'",
                                       given.front(), fmt::join(names, "', '")));
    }
  }
  for (const LawConstant& constant : own) {
    const Range range{0.0, constant.per_pressure ? kInfinity : kModulus.high, !constant.may_be_zero,
                      constant.per_pressure};
    material.constants.push_back(section.quantity(
        constant.name, constant.per_pressure ? Quantity::kPerPressure : Quantity::kPressure,
        range));
  }
  try {
    (void)material_from_constants(material.law, material.constants);
  } catch (const Error& error) {
    section.bad(given.front().c_str(),
                fmt::format("is part of constants that cannot be: {}", error.what()));
  }
  return material;
}

// What a place in the body selects. The keys by which it may be given depend on that.
enum class Parts { kNodes, kFaces, kElements };

Where::Plane read_plane(TomlSection section, Parts parts) {
  Where::Plane plane;
  plane.point = section.quantities("point", Quantity::kLength);
  plane.normal = section.direction("normal");
  if (parts != Parts::kElements && section.has("distance")) {
    plane.distance = section.quantity("distance", Quantity::kLength, {0.0, kLength.high});
  }
  section.refuse_unknown();
  return plane;
}

Where::Box read_box(TomlSection section) {
  const Where::Box box{section.quantities("low", Quantity::kLength),
                       section.quantities("high", Quantity::kLength)};
  if ((box.low.array() > box.high.array()).any()) {
    section.bad("low", "lies above 'high' in one direction: no point is between them");
  }
  section.refuse_unknown();
  return box;
}

// Reads a place; nothing where none of its keys is there.
std::optional<Where> read_where(TomlSection& section, Parts parts) {
  std::vector<const char*> keys{"below", "above", "plane", "box"};
  if (parts == Parts::kNodes) keys.push_back("nearest");
  keys.push_back("set");
  const std::vector<std::string> given = section.present(keys);
  if (given.empty()) return std::nullopt;
  if (given.size() > 1) {
    section.bad(given[1].c_str(),
                fmt::format("does not go with '{}': a place is given by one of '{}'; use several "
                            "sections for several places",
                            given[0], fmt::join(keys, "', '")));
  }
  const char* key = *std::find(keys.begin(), keys.end(), given[0]);
  Where where;
  where.place = section.place(key);
  if (given[0] == "below") where.what = Where::Below{section.number(key, kFraction)};
  if (given[0] == "above") where.what = Where::Above{section.number(key, kFraction)};
  if (given[0] == "plane") where.what = read_plane(section.section(key), parts);
  if (given[0] == "box") where.what = read_box(section.section(key));
  if (given[0] == "nearest") where.what = Where::Nearest{section.points(key)};
  if (given[0] == "set") where.what = Where::Named{section.text(key)};
  return where;
}

void refuse_nowhere(const TomlSection& section, const char* what) {
  throw Error(fmt::format("{} does not say {}: give 'below', 'above', 'plane', 'box' or 'set'",
                          section.place(), what));
}

void read_material(TomlSection section, BodyDescription& body) {
  for (TomlSection& group : section.sections("group")) {
    const std::string law = section.choice("law", law_names(), body.material.law);
    BodyDescription::MaterialPart part{read_law(group, law), {}};
    const std::optional<Where> where = read_where(group, Parts::kElements);
    if (!where) refuse_nowhere(group, "which elements it is about");
    part.where = *where;
    if (group.has("name")) part.name = group.text("name");
    for (const BodyDescription::MaterialPart& other : body.groups) {
      if (part.name.empty() || part.name != other.name) continue;
      group.bad("name", fmt::format("is '{}', as of another group", part.name));
    }
    group.refuse_unknown();
    body.groups.push_back(std::move(part));
  }
  body.material = read_law(section, body.material.law);
  if (section.has("density")) body.inertia = {.density = read_density(section)};
  if (section.has("loss_factor")) {
    const double loss_factor = section.number("loss_factor", {0.0, 1.0, false, true});
    // Without [material] density the one of [gravity], which is read later, may serve.
    if (!body.inertia) body.inertia = BodyDescription::Inertia{.density = 0};
    body.inertia->loss_factor = loss_factor;
  }
  section.refuse_unknown();
}

// The index of the group whose material a parameter varies; -1: [material].
int read_parameter_group(TomlSection& section, const BodyDescription& body) {
  const std::string of = section.text("of");
  if (of == "body") return -1;
  std::string names = "'body'";
  for (std::size_t g = 0; g < body.groups.size(); ++g) {
    if (body.groups[g].name == of) return static_cast<int>(g);
    if (!body.groups[g].name.empty()) names += fmt::format(", '{}'", body.groups[g].name);
  }
  section.bad("of",
              fmt::format("is '{}', must be the 'name' of a [[material.group]], or 'body' for "
                          "[material]; here: {}",
                          of, names));
}

void read_parameters(TomlSection& root, BodyDescription& body) {
  using Parameter = BodyDescription::Parameter;
  for (TomlSection& section : root.sections("parameter")) {
    Parameter parameter;
    parameter.place = section.place();
    parameter.name = section.text("name");
    for (const Parameter& other : body.parameters) {
      if (other.name == parameter.name) {
        section.bad("name", fmt::format("is '{}', as of another parameter", other.name));
      }
    }
    if (parameter.name == "site" || parameter.name == "level") {
      section.bad("name", fmt::format("is '{}', which every body has", parameter.name));
    }
    parameter.group = read_parameter_group(section, body);
    const BodyDescription::MaterialLaw& law =
        parameter.group < 0 ? body.material : body.groups[parameter.group].material;
    const std::vector<std::string> given = section.present({"stiffness", "young", "poisson"});
    if (given.size() != 1) {
      throw Error(
          fmt::format("{} needs one of 'stiffness' (factors), 'young' and 'poisson', each a "
                      "list of values",
                      section.place()));
    }
    const char* key = given[0] == "stiffness" ? "stiffness"
                      : given[0] == "young"   ? "young"
                                              : "poisson";
    if (given[0] == "stiffness") {
      parameter.values = section.numbers(key, {0.0, 1e6, true});
    } else if (!law.constants.empty()) {
      section.bad(key,
                  "varies a material that is given by its law's own constants: vary its "
                  "'stiffness'");
    } else if (given[0] == "young") {
      parameter.what = Parameter::What::kYoung;
      parameter.values = section.quantity_list(key, Quantity::kPressure, kAbove0);
      for (const double young : parameter.values) refuse_stiffer_than_diamond(section, young);
    } else {
      parameter.what = Parameter::What::kPoisson;
      parameter.values = section.numbers(key, {0.0, 0.5, false, true});
    }
    for (std::size_t k = 1; k < parameter.values.size(); ++k) {
      if (parameter.values[k - 1] < parameter.values[k]) continue;
      section.bad(key, "must be a list of values that grow");
    }
    section.refuse_unknown();
    body.parameters.push_back(std::move(parameter));
  }
}

BodyDescription::Support read_support(TomlSection& section) {
  BodyDescription::Support support;
  support.where.place = section.place();
  if (const auto where = read_where(section, Parts::kNodes)) support.where = *where;
  if (section.has("hold")) {
    const std::string hold = section.text("hold");
    support.held = {false, false, false};
    for (const char direction : hold) {
      if (direction < 'x' || direction > 'z' || support.held[direction - 'x']) {
        section.bad("hold", fmt::format("is '{}', must be made of x, y and z, each once at most, "
                                        "such as \"xyz\" or \"z\"",
                                        hold));
      }
      support.held[direction - 'x'] = true;
    }
  }
  if (section.has("displacement")) {
    support.displacement = section.quantities("displacement", Quantity::kLength);
    for (int i = 0; i < 3; ++i) {
      if (support.held[i] || support.displacement[i] == 0.0) continue;
      section.bad("displacement", fmt::format("moves nodes in {}, where 'hold' leaves them free: "
                                              "name that direction in 'hold'",
                                              "xyz"[i]));
    }
  }
  section.refuse_unknown();
  return support;
}

void read_supports(TomlSection& root, BodyDescription& body) {
  std::vector<TomlSection> sections = root.sections("support");
  body.supports_place = fmt::format("{}: [support]", body.source.string());
  body.supports[0].where.place = body.supports_place;
  if (sections.empty()) return;
  body.supports.clear();
  for (TomlSection& section : sections) body.supports.push_back(read_support(section));
  body.supports_place =
      sections.size() == 1 ? body.supports[0].where.place : sections.front().place();
}

// The density of the body in [gravity], which may be stated in [material], too.
double gravity_density(TomlSection& section, BodyDescription& body) {
  const bool is_known = body.inertia && body.inertia->density > 0;
  if (!section.has("density") && is_known) return body.inertia->density;
  const double density = read_density(section);
  // "1.07 g/cm^3" and "1070 kg/m^3" differ by rounding.
  if (is_known && std::abs(body.inertia->density - density) > 1e-9 * density) {
    section.bad(
        "density",
        fmt::format("is {} kg/m^3, and 'density' in [material] is {} kg/m^3: a body has one; "
                    "leave out the one in [gravity]",
                    number_text(density), number_text(body.inertia->density)));
  }
  if (!body.inertia) body.inertia = BodyDescription::Inertia{.density = 0};
  if (!is_known) body.inertia->density = density;
  return density;
}

void read_loads(TomlSection& root, BodyDescription& body) {
  if (root.has("gravity")) {
    TomlSection section = root.section("gravity");
    BodyDescription::Gravity gravity{gravity_density(section, body)};
    gravity.place = section.place();
    if (section.has("acceleration")) {
      gravity.acceleration = section.quantities("acceleration", Quantity::kAcceleration);
    }
    section.refuse_unknown();
    body.gravity = gravity;
  }
  if (body.inertia && body.inertia->density == 0) {
    throw Error(fmt::format(
        "{} has a 'loss_factor', which damps a vibration, and no 'density': add density = \"1000 "
        "kg/m^3\" or the like",
        body.material.place));
  }
  for (TomlSection& section : root.sections("pressure")) {
    BodyDescription::Pressure load{
        section.quantity("pressure", Quantity::kPressure, {-kModulus.high, kModulus.high}), {}};
    const std::optional<Where> where = read_where(section, Parts::kFaces);
    if (!where) refuse_nowhere(section, "on which faces it acts");
    load.where = *where;
    section.refuse_unknown();
    body.pressures.push_back(std::move(load));
  }
}

void read_sites(TomlSection section, BodyDescription& body) {
  BodyDescription::Sites& sites = body.sites;
  const std::vector<std::string> given = section.present({"points", "sets"});
  if (given.empty()) {
    sites.count = section.integer("count", 1, 100000);
    sites.above = section.number("above", {0.0, 1.0, false, true}, sites.above);
    sites.salient = section.choice("choose", {"spread", "salient"}, "spread") == "salient";
  } else {
    if (given.size() > 1) section.bad("sets", "does not go with 'points': give one of the two");
    for (const char* key : {"count", "above", "choose"}) {
      if (section.has(key)) {
        section.bad(key, fmt::format("chooses sites, which '{}' lists: leave one of the two out",
                                     given[0]));
      }
    }
    if (given[0] == "points") {
      sites.at.push_back({Where::Nearest{section.points("points")}, section.place("points")});
    } else {
      for (std::string& name : section.texts("sets")) {
        sites.at.push_back({Where::Named{std::move(name)}, section.place("sets")});
      }
    }
  }
  sites.patch = section.integer("patch", 0, 20, sites.patch);
  sites.linear = section.flag("linear", false);
  if (sites.linear && !body.parameters.empty()) {
    section.bad("linear", "does not go with [[parameter]]: responses are stored for one body");
  }
  if (section.has("direction") && section.is_array("direction")) {
    sites.direction = section.direction("direction");
  } else if (section.choice("direction", {"centre", "normal"}, "centre") == "normal") {
    sites.direction = BodyDescription::Sites::AlongNormal{};
  }
  section.refuse_unknown();
}

void read_press(TomlSection section, BodyDescription& body) {
  BodyDescription::Press& press = body.press;
  if (section.has("force")) {
    if (section.has("depth")) {
      section.bad("force", "does not go with 'depth': the load is given by one of the two");
    }
    press.force = section.quantity("force", Quantity::kForce, {0.0, 1e9, true});
  } else if (section.has("depth") && section.is_text("depth")) {
    press.length = section.quantity("depth", Quantity::kLength, kLength);
  } else {
    press.depth = section.number("depth", {0.0, 1.0, true}, press.depth);
  }
  press.levels = section.integer("levels", 2, 1000, press.levels);
  if (section.has("range") && section.is_text("range")) {
    press.range_length = section.quantity("range", Quantity::kLength, kLength);
  } else {
    press.range = section.number("range", {0.0, 100.0, true}, press.range);
  }
  section.refuse_unknown();
}

// The sizes of tables: how many clusters, and how many modes of what.
void read_table_sizes(TomlSection& section, BodyDescription::Touch& touch) {
  using Tables = BodyDescription::Touch::Tables;
  struct Size {
    const char* key;
    std::optional<int>* value;
    int least, most, step;
    bool of_full;  // only tables = "full" have it
  };
  for (const Size& size : {Size{"cross_modes", &touch.cross_modes, 16, 192, 16, true},
                           Size{"clusters", &touch.clusters, 8, 160, 1, false},
                           Size{"cluster_modes", &touch.cluster_modes, 16, 64, 16, false},
                           Size{"region_modes", &touch.region_modes, 16, 80, 16, true},
                           Size{"leading_modes", &touch.leading_modes, 1, 24, 1, true}}) {
    if (!section.has(size.key)) continue;
    if (size.of_full && touch.tables != Tables::kFull) {
      section.bad(size.key, "is for tables = \"full\"");
    }
    if (touch.tables == Tables::kNone) section.bad(size.key, "is of tables, and there are none");
    *size.value = section.integer(size.key, size.least, size.most);
    if (**size.value % size.step != 0) section.bad(size.key, "should be a multiple of 16");
  }
  if (touch.leading_modes.value_or(0) > touch.region_modes.value_or(80)) {
    section.bad("leading_modes", "should be at most 'region_modes'");
  }
}

void read_touch(TomlSection section, BodyDescription& body) {
  using Tables = BodyDescription::Touch::Tables;
  BodyDescription::Touch& touch = body.touch;
  touch.by_default = !section.has("tables");
  const std::string tables = section.choice("tables", {"none", "linear", "full"},
                                            body.parameters.empty() ? "full" : "none");
  touch.tables = tables == "full"     ? Tables::kFull
                 : tables == "linear" ? Tables::kLinear
                                      : Tables::kNone;
  if (touch.tables != Tables::kNone && !body.parameters.empty()) {
    section.bad("tables", "does not go with [[parameter]]: they are made for one body");
  }
  if (section.has("regions")) {
    if (touch.tables != Tables::kFull) { section.bad("regions", "is for tables = \"full\""); }
    touch.regions = section.integer("regions", 1, 2000);
  }
  read_table_sizes(section, touch);
  if (section.has("edge")) {
    if (touch.tables == Tables::kNone) {
      section.bad("edge", "is of the mesh that tables are made on, and there are none");
    }
    touch.edge = section.quantity("edge", Quantity::kLength, kLength);
  }
  if (section.has("held_out")) {
    if (touch.tables == Tables::kNone) {
      section.bad("held_out", "tells how good tables are, and there are none");
    }
    touch.held_out = section.integer("held_out", 0, 1000);
  }
  touch.friction = section.number("friction", {0.0, 10.0}, touch.friction);
  if (section.has("modes")) {
    if (touch.tables == Tables::kNone) section.bad("modes", "is of tables, and there are none");
    touch.modes = section.integer("modes", 0, 200);
  }
  section.refuse_unknown();
}

void read_intrusive(TomlSection section, BodyDescription& body) {
  BodyDescription::Intrusive wanted;
  wanted.place = section.place();
  for (std::string& name : section.texts("positions")) {
    wanted.positions.push_back({Where::Named{std::move(name)}, section.place("positions")});
  }
  wanted.force = section.quantity("force", Quantity::kForce, {0.0, 1e9, true});
  if (section.has("reactions")) {
    for (std::string& name : section.texts("reactions")) {
      wanted.reactions.push_back({Where::Named{std::move(name)}, section.place("reactions")});
    }
  }
  wanted.levels = section.integer("levels", 3, 20, wanted.levels);
  wanted.modes = section.integer("modes", 1, 500, wanted.modes);
  wanted.stress_modes = section.integer("stress_modes", 1, 1000, wanted.stress_modes);
  wanted.clearance = section.number("clearance", {0.0, 100.0}, wanted.clearance);
  section.refuse_unknown();
  body.intrusive = std::move(wanted);
}

}  // namespace

bool BodyDescription::Shape::is_volume() const { return is_volume_file(file); }

BodyDescription parse_body_description(std::string_view text, const std::filesystem::path& path) {
  const std::string file = path.string();
  const toml::table table = parse_toml(text, file);
  BodyDescription body;
  body.source = path;
  TomlSection root(file, "", table);
  body.name = root.text("name");
  read_shape(root.section("shape"), file, body);
  read_material(root.section("material"), body);
  read_parameters(root, body);
  read_supports(root, body);
  read_loads(root, body);
  read_sites(root.section("sites"), body);
  read_press(root.section("press"), body);

  TomlSection reduction = root.section("reduction");
  ReductionSettings& wanted = body.reduction;
  if (reduction.has("method") && reduction.text("method") == kSparsePgdName) {
    reduction.bad("method",
                  fmt::format("is '{}', which learns from a part of the snapshots that are "
                              "there: palpable reduce --method {} makes that body",
                              kSparsePgdName, kSparsePgdName));
  }
  wanted.method = *method_named(
      reduction.choice("method", method_names(), std::string(method_name(wanted.method))));
  wanted.tolerance =
      reduction.number("tolerance", {1e-6, 1.0, false, true}, default_tolerance(wanted.method));
  const bool by_site = wanted.method == ReductionMethod::kPerSite;
  wanted.weight_snapshots =
      reduction.choice("norm", {"own", "pooled"}, by_site ? "own" : "pooled") == "own";
  body.reduction.max_modes = reduction.integer("max_modes", 1, 100000, body.reduction.max_modes);
  reduction.refuse_unknown();
  read_touch(root.section("touch"), body);
  if (root.has("intrusive")) read_intrusive(root.section("intrusive"), body);
  root.refuse_unknown();
  return body;
}

BodyDescription read_body_description(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    throw Error(
        fmt::format("{}: is a folder, and this wants a body's description, BODY.toml "
                    "(docs/body.md); of a folder of snapshots palpable reduce makes a body",
                    path.string()));
  }
  if (path.extension() == ".palpable") {
    throw Error(
        fmt::format("{}: is a baked body, and this wants the description it was made of, BODY.toml "
                    "(docs/body.md)",
                    path.string()));
  }
  const Result<std::string> text = read_text_file(path, {.most = longest_text(Notation::kToml)});
  if (!text) throw Error(fmt::format("{}: {}", path.string(), text.problem().message));
  return parse_body_description(text.value(), path);
}

}  // namespace palpable

#include "palpable/bake/law_constants.h"

#include "palpable/base/contract.h"

#include <array>
#include <variant>

namespace palpable {
namespace {

// In the order of Material's alternatives, which is that of law_names().
struct Row {
  std::vector<LawConstant> constants;
  Material (*make)(const std::vector<double>& v);
};
const std::array<Row, 4>& rows() {
  static const std::array<Row, 4> table{{
      {{{.name = "C1"}, {.name = "D1", .may_be_zero = true}},
       [](const std::vector<double>& v) -> Material { return NeoHookean{.C1 = v[0], .D1 = v[1]}; }},
      {{{.name = "lambda", .may_be_zero = true}, {.name = "mu"}},
       [](const std::vector<double>& v) -> Material {
         return SaintVenantKirchhoff{.lambda = v[0], .mu = v[1]};
       }},
      {{{.name = "C10"}, {.name = "D1", .per_pressure = true}},
       [](const std::vector<double>& v) -> Material {
         return NeoHookeanAbaqus{.C10 = v[0], .D1 = v[1]};
       }},
      {{{.name = "C1", .may_be_zero = true},
        {.name = "C2", .may_be_zero = true},
        {.name = "D1", .may_be_zero = true}},
       [](const std::vector<double>& v) -> Material {
         return MooneyRivlin{.C1 = v[0], .C2 = v[1], .D1 = v[2]};
       }},
  }};
  static_assert(std::variant_size_v<Material> == 4, "a new law needs its row here");
  return table;
}

const Row& row_of(std::string_view law) {
  const std::vector<std::string>& names = law_names();
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (names[k] == law) return rows()[k];
  }
  PALPABLE_EXPECT(false, "one of law_names()");
  return rows()[0];
}

}  // namespace

const std::vector<LawConstant>& law_constants(std::string_view law) {
  return row_of(law).constants;
}

Material material_from_constants(std::string_view law, const std::vector<double>& values) {
  const Row& row = row_of(law);
  PALPABLE_EXPECT(values.size() == row.constants.size(), "one value for each constant");
  const Material material = row.make(values);
  check_material(material);
  return material;
}

std::vector<double> constants_of(const Material& material) {
  if (const auto* m = std::get_if<NeoHookean>(&material)) return {m->C1, m->D1};
  if (const auto* m = std::get_if<SaintVenantKirchhoff>(&material)) return {m->lambda, m->mu};
  if (const auto* m = std::get_if<NeoHookeanAbaqus>(&material)) return {m->C10, m->D1};
  const auto& m = std::get<MooneyRivlin>(material);
  return {m.C1, m.C2, m.D1};
}

YoungPoisson young_poisson(const Material& material) {
  const auto [lambda, mu] = lame_constants(material);
  return {mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu), 0.5 * lambda / (lambda + mu)};
}

}  // namespace palpable

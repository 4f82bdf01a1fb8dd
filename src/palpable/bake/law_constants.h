/// @file
/// The laws' own constants, by the names that their formulas have (solid/material.h).
#pragma once

#include "palpable/solid/material.h"

#include <string_view>
#include <vector>

namespace palpable {

/// One constant of a law.
struct LawConstant {
  const char* name;
  bool per_pressure = false;  ///< 1/Pa instead of Pa
  bool may_be_zero = false;
};

/// Those of `law`, in the order in which material_from_constants() takes them.
/// @pre law is one of law_names()
[[nodiscard]] const std::vector<LawConstant>& law_constants(std::string_view law);

/// @param values  SI, one for each of law_constants(law)
/// @throws Error as check_material()
[[nodiscard]] Material material_from_constants(std::string_view law,
                                               const std::vector<double>& values);

/// The constants of a material, as law_constants() orders them.
[[nodiscard]] std::vector<double> constants_of(const Material& material);

/// Young's modulus (Pa) and Poisson's ratio at small strains.
struct YoungPoisson {
  double young, poisson;
};
[[nodiscard]] YoungPoisson young_poisson(const Material& material);

}  // namespace palpable

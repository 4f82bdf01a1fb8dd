/// @file
/// A body with its tables of touch, as the live half uses it.
#pragma once

#include "palpable/common/reduced/reduced_body.h"
#include "palpable/common/response/modal_tables.h"
#include "palpable/common/response/touch_tables.h"

#include <optional>
#include <utility>

namespace palpable {

/// A body that can be touched anywhere, by tables of its compliance or by its energy in modes;
/// without either it can be touched at its sites, one at a time.
struct TouchableBody {
  /// A body without tables converts to a TouchableBody.
  TouchableBody(ReducedBody the_body, std::optional<TouchTables> tables = {},
                std::optional<ModalTables> modes = {})
      : body(std::move(the_body)), touch(std::move(tables)), modal(std::move(modes)) {}

  ReducedBody body;
  std::optional<TouchTables> touch;
  std::optional<ModalTables> modal;  ///< used if `touch` is empty
};

/// Sets Coulomb's coefficient of friction of the skin (TouchTables::friction), as far as the body
/// has tables. @pre is_friction(mu)
void set_friction(TouchableBody& body, double mu);
/// Its coefficient; 0 of a body without tables.
[[nodiscard]] double friction_of(const TouchableBody& body);

/// The body with every length multiplied by `factor`, as scaled(ReducedBody) does: the same
/// material takes similar shapes under similar loads, so that stiffness grows by the factor, and
/// the energy by its third power.
/// @throws ContractViolation unless 0 < factor < infinity
[[nodiscard]] TouchableBody scaled(const TouchableBody& body, double factor);

}  // namespace palpable

/// @file
/// A body with its tables of touch, as the live half plays it.
#pragma once

#include "palpable/common/reduced/reduced_body.h"
#include "palpable/common/response/modal_tables.h"
#include "palpable/common/response/touch_tables.h"

#include <optional>
#include <utility>

namespace palpable {

/// A body that can be touched anywhere, by tables of its compliance or by its energy in modes; or,
/// without either, at its sites, one touch at a time.
struct TouchableBody {
  /// A body without tables is one, too.
  TouchableBody(ReducedBody the_body, std::optional<TouchTables> tables = {},
                std::optional<ModalTables> modes = {})
      : body(std::move(the_body)), touch(std::move(tables)), modal(std::move(modes)) {}

  ReducedBody body;
  std::optional<TouchTables> touch;
  std::optional<ModalTables> modal;  ///< used where there are no other tables
};

/// Every length times `factor`, as scaled_body.h does it: the same material answers similar loads
/// with similar shapes, so that stiffness grows by the factor, and the energy by its third power.
/// @throws ContractViolation unless 0 < factor < infinity
[[nodiscard]] TouchableBody scaled(const TouchableBody& body, double factor);

}  // namespace palpable

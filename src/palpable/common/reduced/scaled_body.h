/// @file
/// Scales a body to another size.
#pragma once

#include "palpable/common/reduced/reduced_body.h"

namespace palpable {

/// Multiplies every length by `factor`: skin, displacement and press depth. Without body forces the
/// same material deforms to a similar shape with the same stress if the loads are multiplied by
/// factor^2, so forces (and energies, by factor^3) are the only other quantities that change. Adds
/// a line to the provenance.
/// @throws ContractViolation unless 0 < factor < infinity
[[nodiscard]] ReducedBody scaled(const ReducedBody& body, double factor);

}  // namespace palpable

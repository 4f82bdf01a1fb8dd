/// @file
/// The same body in another size.
#pragma once

#include "palpable/common/reduced/reduced_body.h"

namespace palpable {

/// Every length times `factor`: skin, displacement and press depth. Without body forces the same
/// material under loads times factor^2 deforms to the similar shape with the same stress, so force
/// is the only other quantity that changes. Adds a line to the provenance.
/// @throws ContractViolation unless 0 < factor < infinity
[[nodiscard]] ReducedBody scaled(const ReducedBody& body, double factor);

}  // namespace palpable

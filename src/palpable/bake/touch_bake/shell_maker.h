/// @file
/// Makes the shell of a body, from which the stress on its skin is computed
/// (response/shell_table.h).
#pragma once

#include "palpable/bake/touch_bake/skin_response.h"
#include "palpable/common/geometry/tet_mesh.h"
#include "palpable/common/response/shell_table.h"

namespace palpable {

/// The elements are in the order of the mesh; the stress recovery at the skin is that of the full
/// solver.
[[nodiscard]] ShellTable make_shell(const SkinResponse& skin);

}  // namespace palpable

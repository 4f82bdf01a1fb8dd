/// @file
/// Makes the shell of a body: the layer of solid elements at its skin, with which the live half
/// computes the stress there (response/shell_table.h). It has nothing to do with thin-shell
/// elements.
#pragma once

#include "palpable/bake/touch_bake/skin_response.h"
#include "palpable/common/geometry/tet_mesh.h"
#include "palpable/common/response/shell_table.h"

namespace palpable {

/// The elements are in the order of the mesh; the stress recovery at the skin is that of the full
/// solver.
[[nodiscard]] ShellTable make_shell(const SkinResponse& skin);

}  // namespace palpable

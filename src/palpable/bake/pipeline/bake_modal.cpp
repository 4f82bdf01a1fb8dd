#include "palpable/bake/pipeline/bake_modal.h"

#include "palpable/bake/touch_bake/shell_maker.h"
#include "palpable/bake/touch_bake/skin_response.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/geometry/tet_mesh.h"
#include "palpable/common/material/material.h"

namespace palpable {

ModalTables modal_tables(const IntrusiveBake& made) {
  PALPABLE_EXPECT(made.body.several.has_value(), "a body that was baked for several loads");
  const SolidModel& model = made.series.model();
  const SkinResponse skin(model, boundary_of(model.mesh));
  ModalTables tables;
  tables.shell = make_shell(skin);
  const Eigen::Index inner = 3 * (Eigen::Index{skin.shell_count()} - skin.vertex_count());
  tables.inner_modes = skin.in_shell(made.energy_modes).bottomRows(inner).cast<float>();
  const YoungPoisson law = young_poisson(model.material);
  tables.half_space = (1 - law.poisson * law.poisson) / law.young;
  return tables;
}

}  // namespace palpable

#include "palpable/bake/pipeline/state_file.h"

#include "palpable/bake/mesh/field_files.h"
#include "palpable/bake/solid/stress.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

namespace palpable {
namespace {

TEST_CASE("a state's file holds its displacement, its stress and what acts", "[pipeline][files]") {
  SolidModel model;
  model.mesh = box_tets({0, 0, 0}, {1, 2, 1}, 2, 3, 2);
  model.material = material_from_young("neo-hookean", 1000, 0.3);
  Eigen::Matrix3d F;
  F << 1.2, 0.1, 0.0,  //
      -0.2, 0.9, 0.3,  //
      0.0, 0.1, 1.1;
  const Eigen::Matrix3Xd u = (F - Eigen::Matrix3d::Identity()) * model.mesh.nodes;
  const Eigen::Matrix3Xd forces = 0.25 * model.mesh.nodes;
  const test::ScratchFolder folder("state_file");
  const std::filesystem::path path = folder.path() / "state.vtu";
  const double largest = write_state_file(path, model, u, {"contact_force", forces});

  const NodalFile file = read_nodal_file(path);
  const StressField stress = nodal_cauchy_stress(model, u);
  REQUIRE(file.fields.size() == 5);
  CHECK(file.fields[0].name == "displacement");
  CHECK(file.fields[0].values == u);
  CHECK(file.fields[1].name == "cauchy_stress");
  CHECK(file.fields[1].values == stress);
  CHECK(file.fields[2].name == "von_mises");
  CHECK(file.fields[2].values == von_mises(stress).transpose());
  CHECK(file.fields[3].name == "principal_stresses");
  CHECK(file.fields[3].values == principal_stresses(stress));
  CHECK(file.fields[4].name == "contact_force");
  CHECK(file.fields[4].values == forces);
  CHECK(largest == von_mises(stress).maxCoeff());
  CHECK(largest > 100);  // Pa: the body is strained by a fifth
}

}  // namespace
}  // namespace palpable

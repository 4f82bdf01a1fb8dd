#include "bench/bake/element_study.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

namespace palpable {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using test::tolerance;

SolidModel block(int cells) {
  SolidModel model;
  model.mesh = box_tets({0, 0, 0}, {0.1, 0.08, 0.12}, cells, cells, cells);
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (model.mesh.nodes(2, n) == 0.0) model.fixed_nodes.push_back(n);
  }
  return model;
}

Matrix3Xd sampled(const TetMesh& mesh, int degree) {
  Matrix3Xd u = mesh.nodes;
  if (degree < 2) return 2.0 * u;
  for (auto X : u.colwise()) {
    X = Vector3d(X[0] * X[1] - X[2], X[2] * X[2] + X[0], X[1] * X[1] - X[0] * X[2]);
  }
  return u;
}

TEST_CASE("meshes of a family carry their own polynomials to the reference unchanged",
          "[bake][elements]") {
  const ElementFamily family = nested_family(block(2));
  REQUIRE(family.members.size() == 4);
  for (const ElementMember& member : family.members) {
    INFO(member.name);
    const int degree = member.model.mesh.is_quadratic() ? 2 : 1;
    const Matrix3Xd there = sampled(member.model.mesh, degree) * member.to_reference.transpose();
    CHECK((there - sampled(family.reference.mesh, degree)).cwiseAbs().maxCoeff() <=
          tolerance(1e-15, "sums of ten numbers of 0.1"));
  }
  // Each mesh is held at exactly the nodes on the reference's support.
  const auto held_area = [](const SolidModel& model) {
    for (const int n : model.fixed_nodes) {
      if (model.mesh.nodes(2, n) != 0.0) return std::size_t{0};
    }
    return model.fixed_nodes.size();
  };
  CHECK(held_area(family.members[0].model) == 3 * 3);
  CHECK(held_area(family.members[1].model) == 5 * 5);
  CHECK(held_area(family.members[2].model) == 5 * 5);
  CHECK(held_area(family.members[3].model) == 9 * 9);
  CHECK(held_area(family.reference) == 9 * 9);
  CHECK(family.members[1].model.mesh.node_count() == family.members[2].model.mesh.node_count());
}

TEST_CASE("a study compares every mesh under every press, and the reference with itself is exact",
          "[bake][elements]") {
  ElementFamily family = nested_family(block(2));
  family.members[3] = {.name = "reference again",
                       .model = family.reference,
                       .to_reference = family.members[3].to_reference};
  const ElementStudySettings settings{
      .sites = 2, .lowest = 0.08, .patch = 1, .pressed = 1, .press = 0.012, .poisson = {0.3, 0.45}};
  double last = 0, total = 0;
  const ElementStudy study = study_elements(
      family, settings, [&](const ProgressReport& r) { last = r.done, total = r.total; });
  CHECK(last > 0.0);
  CHECK(last <= total);
  REQUIRE(study.members.size() == 5);
  CHECK(study.members[1].path_cpu_s.size() == 1);
  // Two linear responses for each Poisson's ratio and two finite presses for the first.
  REQUIRE(study.presses.size() == 2 + 2 + 2);
  double before = 0;
  for (const ElementPress& press : study.presses) {
    INFO("site " << press.site << ", share " << press.share << ", nu " << press.poisson);
    REQUIRE(press.errors.size() == 4);
    CHECK(press.why_stopped.empty());
    if (press.share > 0) {
      CHECK(press.poisson == 0.3);
      CHECK(press.press ==
            Approx(press.share * settings.press).epsilon(tolerance(0.1, "the 10-node mesh's")));
      CHECK(press.load > before);
      before = press.load;
    }
    for (const std::size_t m : {0u, 1u, 2u}) {
      CHECK(press.errors[m].press < 0.0);  // fewer shape functions: too stiff
      CHECK(press.errors[m].displacement > 0.0);
    }
    // Fewer shape functions give larger errors.
    CHECK(press.errors[0].press < press.errors[2].press);
    CHECK(press.errors[0].press < press.errors[1].press);
    CHECK(std::abs(press.errors[3].press) <= tolerance(1e-7, "both solved to 1e-8"));
    CHECK(press.errors[3].displacement <= tolerance(1e-6, "both solved to 1e-8"));
    CHECK(press.errors[1].element_von_mises < press.errors[2].element_von_mises);
  }
}

}  // namespace
}  // namespace palpable

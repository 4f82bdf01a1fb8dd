#include "palpable/common/response/linear_field.h"

#include "tests/support/allocations.h"
#include "tests/support/elastic_sheet.h"
#include "tests/support/test.h"

#include <Eigen/Core>

#include <algorithm>
#include <vector>

namespace palpable {
namespace {

using Eigen::Matrix3Xf;
using Eigen::Vector3f;
using test::ElasticSheet;
using test::tolerance;

std::vector<VertexForce> some_loads(const ElasticSheet& sheet) {
  // Three loads in one cluster, some far from it, and one that is 0.
  return {{0, {0.1f, 0.0f, -1.0f}},
          {1, {0.0f, 0.2f, -0.5f}},
          {sheet.middle(), {-0.3f, 0.1f, -2.0f}},
          {ElasticSheet::kSide, {0.0f, 0.0f, 0.4f}},
          {7, Vector3f::Zero()},
          {sheet.skin.vertex_count() - 1, {0.2f, 0.2f, 0.2f}}};
}

TEST_CASE("several loads move the skin as the sum of what each does, near and far", "[response]") {
  for (const double near_radius : {1.0, 0.020}) {
    INFO(near_radius);
    const ElasticSheet sheet(near_radius);
    const Compliance compliance(sheet.tables.compliance);
    LinearField field(compliance);
    const std::vector<VertexForce> loads = some_loads(sheet);
    Eigen::VectorXd exact = Eigen::VectorXd::Zero(3 * compliance.vertices());
    for (const VertexForce& load : loads)
      exact += sheet.G.middleCols(3 * load.vertex, 3) * load.force.cast<double>();
    Matrix3Xf u(3, compliance.vertices());
    field.fill(loads, u);
    CHECK((u.reshaped().cast<double>() - exact).cwiseAbs().maxCoeff() <
          tolerance(2e-4, "numbers of 16 bits") * exact.cwiseAbs().maxCoeff());
  }
}

TEST_CASE("a linear response does not depend on the order of loads, nor on earlier queries",
          "[response]") {
  const ElasticSheet sheet(0.020);
  const Compliance compliance(sheet.tables.compliance);
  LinearField field(compliance);
  std::vector<VertexForce> loads = some_loads(sheet);
  Matrix3Xf first(3, compliance.vertices()), second = first, part(3, 20);
  field.fill(loads, first);
  field.fill(std::vector<VertexForce>{{30, Vector3f::Ones()}}, second);
  std::reverse(loads.begin(), loads.end());
  CHECK(test::allocations_during([&] { field.fill(loads, second); }) == 0);
  CHECK(first == second);
  // The first nodes alone.
  field.fill(loads, part);
  CHECK(part == first.leftCols(20));
  field.fill({}, second);
  CHECK(second.isZero(0));
}

}  // namespace
}  // namespace palpable

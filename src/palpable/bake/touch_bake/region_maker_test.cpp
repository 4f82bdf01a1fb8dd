#include "palpable/bake/touch_bake/region_maker.h"

#include "palpable/bake/touch_bake/compliance_maker.h"
#include "palpable/common/response/nonlinear_response.h"
#include "tests/support/standing_rubber.h"
#include "tests/support/test.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {
namespace {

using Eigen::Matrix3Xf;
using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::VectorXd;
using test::tolerance;

// 30 x 30 x 90 mm, and a region at one side of its upper half.
struct Column {
  SolidModel model = test::standing_rubber(box_tets({0, 0, 0}, {0.03, 0.03, 0.09}, 4, 4, 12));
  SkinResponse skin{model, boundary_of(model.mesh)};
  ComplianceTable table = make_compliance(skin, {.spacing = 0.012, .near_radius = 0.024});
  Compliance compliance{table};
  ModalFormMaker forms{model, skin.body().rest()};
  int vertex = 0;

  Column() {
    (skin.skin().vertices.colwise() - Vector3d(0.03, 0.015, 0.075))
        .colwise()
        .squaredNorm()
        .minCoeff(&vertex);
  }

  // With a large core all clusters are the region's own.
  [[nodiscard]] RegionTable region(double core) const {
    return make_region(skin, forms, compliance, vertex,
                       {.modes = 32, .leading = 8, .loads = 60, .core = core});
  }

  // (3W) m, the displacement that this region adds to the linear response.
  [[nodiscard]] VectorXd beyond_linear(const RegionTable& region,
                                       std::span<const VertexForce> loads) const {
    const std::vector<RegionTable> regions{region};
    const RegionMap map(skin.skin().vertices.cast<float>(), regions, 0.018);
    const CrossTable none;
    NonlinearResponse response(compliance, regions, map, none);
    std::vector<int> vertices;
    for (const VertexForce& load : loads) vertices.push_back(load.vertex);
    response.choose_patches(vertices, std::vector<float>(vertices.size(), 1.0f), {});
    response.evaluate(loads);
    response.find_far_targets();
    Matrix3Xf u = Matrix3Xf::Zero(3, skin.shell_count());
    compliance.add_beyond(response.far_targets(), u);
    response.add_near(u);
    return u.reshaped().cast<double>();
  }
};

TEST_CASE("outside its own clusters a region's field continues in its far shapes", "[touch_bake]") {
  const Column column;
  const RegionTable region = column.region(0.014), all = column.region(1.0);
  const int W = column.skin.shell_count(), V = column.skin.vertex_count();
  REQUIRE(static_cast<int>(region.vertices.size()) < W - 100);
  REQUIRE(static_cast<int>(all.vertices.size()) == W);
  CHECK(all.cubic.values == region.cubic.values);  // the same modes

  std::vector<VertexForce> loads;
  for (int v = 0; v < V; ++v) {
    if (column.skin.distance(v, column.vertex) > 0.009) continue;
    loads.push_back({v, Vector3f(-0.06f, 0.015f, 0.0f)});
  }
  const VectorXd exact = column.beyond_linear(all, loads);
  const VectorXd found = column.beyond_linear(region, loads);
  CHECK((found - exact).norm() <
        tolerance(0.05, "16 shapes, 32 targets, on a coarse mesh") * exact.norm());
}

}  // namespace
}  // namespace palpable

#include "palpable/common/response/skin_normals.h"

#include "palpable/common/geometry/surface_mesh.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <Eigen/Core>

#include <random>

namespace palpable {
namespace {

TEST_CASE("normals of a skin are vertex_normals(), on every processor", "[response]") {
  const SurfaceMesh mesh = sphere_surface({0.1, 0, 0}, 0.03, 3);
  Eigen::Matrix3Xf x(3, mesh.vertices.cols() + 1);  // one more, without a triangle
  x.leftCols(mesh.vertices.cols()) = mesh.vertices.cast<float>();
  auto random = test::random_case(1);
  std::uniform_real_distribution<float> shift(-1e-3f, 1e-3f);
  x = x.unaryExpr([&](float value) { return value + shift(random); }).eval();
  x.rightCols(1).setZero();
  const auto V = static_cast<int>(x.cols());
  Eigen::Matrix3Xf wanted(3, V), found(3, V), plainly(3, V);
  vertex_normals(x, mesh.triangles, wanted);
  SkinNormals normals(mesh.triangles, V), plain(mesh.triangles, V, SimdLevel::kPlain);
  CHECK(test::allocations_during([&] { normals.find(x, found); }) == 0);
  CHECK((found - wanted).cwiseAbs().maxCoeff() <=
        static_cast<float>(test::tolerance(1e-6, "rounding")));
  CHECK(found.rightCols(1).isZero(0));
  plain.find(x, plainly);
  CHECK(found == plainly);
}

}  // namespace
}  // namespace palpable

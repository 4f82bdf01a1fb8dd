#include "palpable/common/response/nonlinear_response.h"

#include "tests/support/allocations.h"
#include "tests/support/elastic_sheet.h"
#include "tests/support/test.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <random>
#include <vector>

namespace palpable {
namespace {

using Eigen::Matrix3Xf;
using Eigen::MatrixXd;
using Eigen::Vector3f;
using Eigen::VectorXd;
using test::ElasticSheet;
using test::tolerance;

constexpr int kModes = 16, kShapes = 32;

MatrixXd some_numbers(Eigen::Index rows, Eigen::Index columns, double size, unsigned seed) {
  auto random = test::random_case(seed);
  std::normal_distribution<double> entry(0.0, size);
  return MatrixXd::NullaryExpr(rows, columns, [&] { return entry(random); });
}

SymmetricForm some_form(int variables, int degree, unsigned seed) {
  const auto count = static_cast<Eigen::Index>(distinct_coefficients(variables, degree));
  const VectorXd values = some_numbers(count, 1, 0.1, seed);
  return rounded(variables, degree, {values.data(), static_cast<std::size_t>(count)});
}

// A_x(c, c).
VectorXd contracted(const FormRows& cubic, const VectorXd& c) {
  const Eigen::VectorXf coordinates = c.cast<float>();
  std::vector<float> P(cubic.width(), 0.0f), result(kModes);
  add_pairs({coordinates.data(), kModes}, 1.0f, P);
  cubic.contract(P, result);
  return Eigen::Map<Eigen::VectorXf>(result.data(), kModes).cast<double>();
}

// Two regions at opposite corners of a sheet, whose clusters are far from each other.
struct Regions {
  ElasticSheet sheet{0.020};
  Compliance compliance{sheet.tables.compliance};
  std::vector<RegionTable> regions;
  CrossTable cross;
  Matrix3Xf vertices = sheet.skin.vertices.cast<float>();

  Regions() {
    for (const int middle : {14, 154}) {
      RegionTable region;
      region.vertex = middle;
      const int own = compliance.cluster_of(middle);
      for (int v = 0; v < compliance.vertices(); ++v) {
        if (!compliance.are_far(own, compliance.cluster_of(v))) region.vertices.push_back(v);
      }
      const auto seed = static_cast<unsigned>(middle);
      region.modes = rounded(RowsOfFloats(
          some_numbers(3 * std::ssize(region.vertices), kModes, 0.1, seed).cast<float>()));
      Eigen::Index far = 0;  // clusters
      for (int c = 0; c < compliance.clusters(); ++c) far += compliance.are_far(own, c) ? 1 : 0;
      region.far_shapes = rounded(RowsOfFloats(
          some_numbers(far * static_cast<Eigen::Index>(compliance.rank()), kShapes, 0.1, seed + 1)
              .cast<float>()));
      region.far_shares =
          rounded(RowsOfFloats(some_numbers(kShapes, kModes, 0.3, seed + 4).cast<float>()));
      region.cubic = some_form(kModes, 3, seed + 2);
      region.quartic = some_form(4, 4, seed + 3);
      regions.push_back(region);
    }
    cross.modes = rounded(
        RowsOfFloats(some_numbers(3 * compliance.vertices(), kModes, 0.1, 77).cast<float>()));
    cross.cubic = some_form(kModes, 3, 78);
  }
};

// Modal coordinates U^T f of a force at a vertex of a region.
VectorXd coordinates_of(const RegionTable& region, int vertex, const Vector3f& force) {
  const auto at = std::find(region.vertices.begin(), region.vertices.end(), vertex);
  const auto row = 3 * (at - region.vertices.begin());
  return as_numbers(region.modes).middleRows(row, 3).transpose() * force.cast<double>();
}

TEST_CASE(
    "the response to a patch of load is by its region's modes near it, and by far shapes far away",
    "[response]") {
  const Regions body;
  const RegionMap map(body.vertices, body.regions, 0.010);
  const CrossTable none;
  NonlinearResponse response(body.compliance, body.regions, map, none);
  const std::array vertices{14, 154};
  response.choose_patches(vertices, std::array{1.0f, 2.0f}, {});
  REQUIRE(response.patch_count() == 2);
  CHECK(response.regions()[0] == 1);  // the heavier one first
  CHECK(response.patch_of(154) == 0);
  CHECK(response.patch_of(14) == 1);
  const std::array loads{VertexForce{14, Vector3f(0.3f, 0, 1)},
                         VertexForce{154, Vector3f(0, 1, 2)}};
  response.evaluate(loads);

  Matrix3Xf near = Matrix3Xf::Zero(3, body.compliance.vertices()), all = near;
  body.compliance.add_beyond(response.far_targets(), all);
  response.add_near(near);
  all += near;
  for (int v = 0; v < body.compliance.vertices(); ++v) {
    CHECK((response.displacement_at(v) - all.col(v)).norm() <= 1e-5f * all.norm());
  }
  // At a vertex that is near one region and far from the other: modes of one, far shapes of the
  // other.
  for (int patch = 0; patch < 2; ++patch) {
    const RegionTable& region = response.region_of(patch);
    const VectorXd q =
        Eigen::Map<const Eigen::VectorXf>(response.q(patch).data(), kModes).cast<double>();
    const int own = body.compliance.cluster_of(region.vertex);
    const VectorXd targets = as_numbers(region.far_shapes) * (as_numbers(region.far_shares) * q);
    for (const int v : {patch == 0 ? 14 : 154}) {  // far from this region
      const auto rank = static_cast<Eigen::Index>(body.compliance.rank());
      Eigen::Index row = 0;
      for (int c = 0; c < body.compliance.cluster_of(v); ++c) {
        row += body.compliance.are_far(own, c) ? rank : 0;
      }
      const Eigen::VectorXf at_v = targets.segment(row, rank).cast<float>();
      const std::span<const float> target(at_v.data(), body.compliance.rank());
      const Vector3f far = body.compliance.beyond_at(v, target);
      const RegionTable& other = response.region_of(1 - patch);
      const VectorXd q_other =
          Eigen::Map<const Eigen::VectorXf>(response.q(1 - patch).data(), kModes).cast<double>();
      const auto at = std::find(other.vertices.begin(), other.vertices.end(), v);
      const Eigen::Vector3d near_part =
          as_numbers(other.modes).middleRows(3 * (at - other.vertices.begin()), 3) * q_other;
      CHECK((response.displacement_at(v).cast<double>() - near_part - far.cast<double>()).norm() <
            tolerance(1e-4, "floats of numbers of order 1"));
    }
  }
}

TEST_CASE("a patch's coordinates and slope are those of its modes", "[response]") {
  const Regions body;
  const RegionMap map(body.vertices, body.regions, 0.010);
  NonlinearResponse response(body.compliance, body.regions, map, body.cross);
  response.choose_patches(std::array{14}, std::array{1.0f}, {});
  REQUIRE(response.patch_count() == 1);
  const auto u_at = [&](const Vector3f& force) {
    response.evaluate(std::array{VertexForce{14, force}});
    return response.displacement_at(15).cast<double>().eval();
  };
  const Vector3f force(0.2f, -0.4f, 0.9f), step(0.02f, 0.01f, -0.03f);
  const Eigen::Vector3d slope = (u_at(force + step) - u_at(force - step)) / 2;
  u_at(force);
  std::vector<float> row(kModes), turned(kModes);
  response.add_mode_row(0, 14, step, row);
  CHECK((Eigen::Map<Eigen::VectorXf>(row.data(), kModes).cast<double>() -
         coordinates_of(body.regions[0], 14, step))
            .norm() < 1e-6);
  response.times(0, row, turned);
  Eigen::Vector3d by_tangent;
  for (int c = 0; c < 3; ++c) {
    std::vector<float> there(kModes, 0.0f);
    response.add_mode_row(0, 15, Vector3f::Unit(c), there);
    by_tangent[c] = Eigen::Map<Eigen::VectorXf>(there.data(), kModes)
                        .dot(Eigen::Map<Eigen::VectorXf>(turned.data(), kModes));
  }
  CHECK((by_tangent - slope).norm() <= tolerance(0.01, "the step's square, floats") * slope.norm());
}

TEST_CASE("two patches interact by the product in the cross terms, and a single one has none",
          "[response]") {
  const Regions body;
  const RegionMap map(body.vertices, body.regions, 0.010);
  const CrossTable none;
  NonlinearResponse with(body.compliance, body.regions, map, body.cross);
  NonlinearResponse without(body.compliance, body.regions, map, none);
  const std::array both{VertexForce{14, Vector3f(1, 0, 2)}, VertexForce{154, Vector3f(0, 2, 1)}};
  for (NonlinearResponse* response : {&with, &without}) {
    response->choose_patches(std::array{14, 154}, std::array{1.0f, 1.0f}, {});
    response->evaluate(both);
  }
  // - A_x(c_0, c_1): the mixed part of - 1/2 A_x(c, c).
  const MatrixXd X = as_numbers(body.cross.modes);
  const VectorXd c0 = X.middleRows(3 * 14, 3).transpose() * both[0].force.cast<double>();
  const VectorXd c1 = X.middleRows(3 * 154, 3).transpose() * both[1].force.cast<double>();
  const FormRows cubic(body.cross.cubic);
  const VectorXd q = -0.25 * (contracted(cubic, c0 + c1) - contracted(cubic, c0 - c1));
  for (const int v : {3, 80, 160}) {
    const Eigen::Vector3d expected = X.middleRows(3 * v, 3) * q;
    const Eigen::Vector3d found =
        (with.displacement_at(v) - without.displacement_at(v)).cast<double>();
    CHECK((found - expected).norm() <= tolerance(2e-3, "floats, 16 bits") * (X * q).norm());
  }
  for (NonlinearResponse* response : {&with, &without}) {
    response->choose_patches(std::array{14}, std::array{1.0f}, {});
    response->evaluate(std::array{both[0]});
  }
  CHECK(with.displacement_at(80) == without.displacement_at(80));
  CHECK(test::allocations_during([&] {
          with.choose_patches(std::array{14, 154}, std::array{1.0f, 1.0f}, {});
          with.evaluate(both);
        }) == 0);
}

TEST_CASE("of cross terms with many modes the leading ones are taken", "[response]") {
  const Regions body;
  const RegionMap map(body.vertices, body.regions, 0.010);
  constexpr int kMany = NonlinearResponse::kCrossModes + 32;
  CrossTable many, few;
  const MatrixXd X = some_numbers(3 * body.compliance.vertices(), kMany, 0.1, 77);
  many.modes = rounded(RowsOfFloats(X.cast<float>()));
  many.cubic = some_form(kMany, 3, 78);
  few = leading(many, NonlinearResponse::kCrossModes);
  CHECK(few.cubic.variables == NonlinearResponse::kCrossModes);
  CHECK((as_numbers(few.modes) - as_numbers(many.modes).leftCols(few.cubic.variables)).isZero(0));
  CHECK(leading(few, kMany).modes.values == few.modes.values);
  NonlinearResponse one(body.compliance, body.regions, map, many);
  NonlinearResponse other(body.compliance, body.regions, map, few);
  const std::array both{VertexForce{14, Vector3f(1, 0, 2)}, VertexForce{154, Vector3f(0, 2, 1)}};
  for (NonlinearResponse* response : {&one, &other}) {
    response->choose_patches(std::array{14, 154}, std::array{1.0f, 1.0f}, {});
    response->evaluate(both);
  }
  CHECK(one.displacement_at(80) == other.displacement_at(80));
}

TEST_CASE("the interaction of two loads is bounded, and right where they cancel far away",
          "[response]") {
  Regions body;
  // The cross modes are equal at the two vertices, as those of a body that is squeezed there nearly
  // are.
  MatrixXd X = as_numbers(body.cross.modes);
  X.middleRows(3 * 154, 3) = X.middleRows(3 * 14, 3);
  body.cross.modes = rounded(RowsOfFloats(X.cast<float>()));
  X = as_numbers(body.cross.modes);
  const RegionMap map(body.vertices, body.regions, 0.010);
  const CrossTable none;
  NonlinearResponse with(body.compliance, body.regions, map, body.cross);
  NonlinearResponse without(body.compliance, body.regions, map, none);
  const FormRows cubic(body.cross.cubic);
  const auto cross_at = [&](int vertex, float size) -> Eigen::Vector3d {
    const Vector3f force = size * Vector3f(1, 0, 2);
    for (NonlinearResponse* response : {&with, &without}) {
      response->choose_patches(std::array{14, 154}, std::array{1.0f, 1.0f}, {});
      response->evaluate(std::array{VertexForce{14, force}, VertexForce{154, -force}});
    }
    return (with.displacement_at(vertex) - without.displacement_at(vertex)).cast<double>();
  };
  const VectorXd c = X.middleRows(3 * 14, 3).transpose() * Eigen::Vector3d(1, 0, 2);
  // The interaction is + 1/2 (A_x(c, c) + A_x(-c, -c)); its bound is a ratio to both loads' norm.
  const VectorXd q = contracted(cubic, c);
  const double own = std::sqrt(2.0) * c.norm();
  const double small = 0.25 * own / q.norm(), large = 8 * small;
  for (const int v : {3, 80, 160}) {
    const Eigen::Vector3d at = X.middleRows(3 * v, 3) * q, whole = small * small * at;
    CHECK((cross_at(v, static_cast<float>(small)) - whole).norm() <=
          tolerance(2e-3, "floats, 16 bits") * small * small * (X * q).norm());
    // The bound is half of the norm of both loads' coordinates.
    const Eigen::Vector3d most = 0.5 * large * own / q.norm() * at;
    CHECK((cross_at(v, static_cast<float>(large)) - most).norm() <=
          tolerance(2e-3, "floats, 16 bits") * 0.5 * large * own / q.norm() * (X * q).norm());
  }
}

}  // namespace
}  // namespace palpable

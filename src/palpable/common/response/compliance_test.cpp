#include "palpable/common/response/compliance.h"

#include "tests/support/allocations.h"
#include "tests/support/elastic_sheet.h"
#include "tests/support/test.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector3f;
using test::ElasticSheet;
using test::tolerance;

// G f on the whole skin.
Eigen::Matrix3Xf response(const Compliance& compliance, int vertex, const Vector3f& force) {
  const std::size_t k = compliance.rank();
  const int C = compliance.clusters(), from = compliance.cluster_of(vertex);
  std::vector<float> source(k, 0.0f), targets(k * static_cast<std::size_t>(C), 0.0f);
  compliance.add_source(vertex, force, source);
  for (int to = 0; to < C; ++to) {
    if (!compliance.are_far(from, to)) continue;
    compliance.add_target(from, source, to, {targets.data() + k * static_cast<std::size_t>(to), k});
  }
  Eigen::Matrix3Xf u = Eigen::Matrix3Xf::Zero(3, compliance.vertices());
  compliance.everywhere(targets, u);
  compliance.add_near(vertex, force, u);
  return u;
}

// Largest difference to G f, over the largest of G f.
double error_of(const ElasticSheet& sheet, const Compliance& compliance, int vertex) {
  const Vector3f force(0.5f, -1.0f, 2.0f);
  const Eigen::VectorXd exact = sheet.G.middleCols(3 * vertex, 3) * force.cast<double>();
  const Eigen::Matrix3Xf u = response(compliance, vertex, force);
  return (u.reshaped().cast<double>() - exact).cwiseAbs().maxCoeff() / exact.cwiseAbs().maxCoeff();
}

TEST_CASE("a table gives back its compliance, near and far", "[response]") {
  // Near clusters alone, and far ones too, with all columns of their bases.
  for (const double near_radius : {1.0, 0.020}) {
    const ElasticSheet sheet(near_radius);
    const Compliance compliance(sheet.tables.compliance);
    CHECK(sheet.tables.compliance.far_first.empty() == (near_radius > 0.1));
    for (const int vertex : {0, 50, sheet.middle()}) {
      INFO(near_radius << " " << vertex);
      CHECK(error_of(sheet, compliance, vertex) < tolerance(2e-4, "numbers of 16 bits"));
    }
  }
}

TEST_CASE("with fewer columns of the bases the response is less exact far away, and near as before",
          "[response]") {
  const ElasticSheet sheet(0.020, 16);
  const Compliance compliance(sheet.tables.compliance);
  const Eigen::Matrix3Xf u = response(compliance, 0, Vector3f(0, 0, 1));
  double near = 0, far = 0;
  for (int v = 0; v < compliance.vertices(); ++v) {
    const double off = std::abs(static_cast<double>(u(2, v)) - sheet.G(3 * v + 2, 2));
    double& worst =
        compliance.are_far(compliance.cluster_of(0), compliance.cluster_of(v)) ? far : near;
    worst = std::max(worst, off / ElasticSheet::kSoftness);
  }
  CHECK(near < tolerance(2e-4, "numbers of 16 bits"));
  CHECK(far > 1e-3);
  CHECK(far < 0.1);
}

TEST_CASE("a block of a cache is the compliance of a pair, both ways alike", "[response]") {
  const ElasticSheet sheet(0.020);
  const Compliance compliance(sheet.tables.compliance);
  ComplianceCache cache(compliance, 4);
  cache.bring(std::array{7, 160, 3});
  REQUIRE(compliance.are_far(compliance.cluster_of(7), compliance.cluster_of(160)));
  for (const int a : {7, 160, 3}) {
    for (const int b : {7, 160, 3}) {
      const Matrix3f block = cache.block(cache.slot_of(a), cache.slot_of(b));
      const double exact = sheet.G(3 * a, 3 * b);
      CHECK((block.cast<double>() - exact * Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <
            tolerance(2e-4, "numbers of 16 bits") * ElasticSheet::kSoftness);
      CHECK(block == cache.block(cache.slot_of(b), cache.slot_of(a)).transpose());
    }
  }
}

TEST_CASE("the blocks of a cache do not depend on earlier queries", "[response]") {
  const ElasticSheet sheet(0.020);
  const Compliance compliance(sheet.tables.compliance);
  ComplianceCache fresh(compliance, 4), used(compliance, 4);
  fresh.bring(std::array{20, 21, 34});
  used.bring(std::array{100, 5, 21});
  used.bring(std::array{34, 6, 5, 7});
  used.bring(std::array{34, 20, 21});
  for (const int a : {20, 21, 34}) {
    for (const int b : {20, 21, 34}) {
      CHECK(fresh.block(fresh.slot_of(a), fresh.slot_of(b)) ==
            used.block(used.slot_of(a), used.slot_of(b)));
    }
  }
}

TEST_CASE("a compliance is evaluated without allocating", "[response]") {
  const ElasticSheet sheet(0.020);
  const Compliance compliance(sheet.tables.compliance);
  ComplianceCache cache(compliance, 8);
  const std::size_t k = compliance.rank();
  std::vector<float> source(k, 0.0f), targets(k * static_cast<std::size_t>(compliance.clusters()));
  Eigen::Matrix3Xf u = Eigen::Matrix3Xf::Zero(3, compliance.vertices());
  const std::array vertices{1, 2, 3, 160};
  CHECK(test::allocations_during([&] {
          compliance.add_source(4, Vector3f::Ones(), source);
          compliance.add_target(0, source, compliance.clusters() - 1, {targets.data(), k});
          compliance.add_target(compliance.clusters() - 1, source, 0, {targets.data(), k});
          compliance.everywhere(targets, u);
          compliance.add_near(4, Vector3f::Ones(), u);
          cache.bring(vertices);
        }) == 0);
}

TEST_CASE("a compliance table that does not fit together is named", "[response]") {
  const ElasticSheet sheet(0.020);
  CHECK(trouble_of(sheet.tables.compliance).empty());
  const auto broken = [&](auto change) {
    ComplianceTable table = sheet.tables.compliance;
    change(table);
    return trouble_of(table);
  };
  CHECK(broken([](auto& t) { t.vertices = 0; }) == "its size");
  CHECK(broken([](auto& t) { t.basis.width = 17; }) == "its size");
  CHECK(broken([](auto& t) { t.cluster_of[3] = t.clusters; }) == "its clusters");
  CHECK(broken([](auto& t) { std::swap(t.far_first[0], t.far_second[0]); }) == "its clusters");
  CHECK(broken([](auto& t) { t.far_second[1] = t.far_second[0]; }) == "its clusters");
  CHECK(broken([](auto& t) { t.basis.scale.pop_back(); }) == "the size of its far field");
  CHECK(broken([](auto& t) { t.couplings.values.pop_back(); }) == "the size of its far field");
  CHECK(broken([](auto& t) { t.first[1] = -1; }) == "its lists of neighbours");
  CHECK(broken([](auto& t) { t.neighbours[1] = t.neighbours[0]; }) == "its lists of neighbours");
  CHECK(broken([](auto& t) { t.neighbours.back() = t.vertices; }) == "its lists of neighbours");
  // The first list would end beyond the table, while the last one ends with it.
  CHECK(broken([](auto& t) {
          t.neighbours.resize(169);
          t.first[1] = 170;
          t.first.back() = 169;
        }) == "its lists of neighbours");
  CHECK(broken([](auto& t) { t.near.pop_back(); }) == "the size of its near field");
}

using Eigen::Matrix3Xf;

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

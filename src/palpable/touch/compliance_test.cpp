#include "palpable/touch/compliance.h"

#include "palpable/touch/compliance_cache.h"
#include "tests/support/allocations.h"
#include "tests/support/elastic_sheet.h"
#include "tests/support/test.h"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace palpable {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector3f;
using test::ElasticSheet;
using test::tolerance;

// Phi C^T f + N f on the whole skin.
Eigen::Matrix3Xf answer(const Compliance& compliance, int vertex, const Vector3f& force) {
  std::vector<float> code(static_cast<std::size_t>(compliance.rank()), 0.0f);
  Eigen::Matrix3Xf u = Eigen::Matrix3Xf::Zero(3, compliance.vertices());
  compliance.add_code(vertex, force, code);
  compliance.modes_everywhere(code, u);
  compliance.add_near(vertex, force, u);
  return u;
}

TEST_CASE("a table with all neighbours gives back its compliance", "[touch]") {
  const ElasticSheet sheet;
  const Compliance compliance(sheet.tables.compliance);
  const Vector3f force(0.5f, -1.0f, 2.0f);
  for (const int vertex : {0, 50, sheet.middle()}) {
    const Eigen::VectorXd exact = sheet.G.middleCols(3 * vertex, 3) * force.cast<double>();
    const Eigen::Matrix3Xf u = answer(compliance, vertex, force);
    CHECK((u.reshaped().cast<double>() - exact).cwiseAbs().maxCoeff() <
          tolerance(3e-4, "numbers of 16 bits, 32 modes") * exact.cwiseAbs().maxCoeff());
  }
}

TEST_CASE("beyond the neighbours the modes answer alone", "[touch]") {
  const ElasticSheet sheet(0.006);
  const Compliance compliance(sheet.tables.compliance);
  const Eigen::Matrix3Xf u = answer(compliance, sheet.middle(), Vector3f(0, 0, 1));
  const auto exact = [&](int v) { return sheet.G(3 * v + 2, 3 * sheet.middle() + 2); };
  const int beside = sheet.middle() + 1, far = sheet.middle() + 4;
  CHECK(u(2, beside) == Approx(exact(beside)).epsilon(tolerance(3e-4, "numbers of 16 bits")));
  std::vector<float> code(static_cast<std::size_t>(compliance.rank()), 0.0f);
  compliance.add_code(sheet.middle(), Vector3f(0, 0, 1), code);
  CHECK(u(2, far) == compliance.modes_at(far, code).z());
  CHECK(u(2, far) != Approx(exact(far)).epsilon(1e-3));
}

TEST_CASE("a block of a cache is the compliance of a pair, both ways alike", "[touch]") {
  const ElasticSheet sheet;
  const Compliance compliance(sheet.tables.compliance);
  ComplianceCache cache(compliance, 4);
  cache.bring(std::array{7, 90, 3});
  for (const int a : {7, 90, 3}) {
    for (const int b : {7, 90, 3}) {
      const Matrix3f block = cache.block(cache.slot_of(a), cache.slot_of(b));
      const double exact = sheet.G(3 * a, 3 * b);
      CHECK((block.cast<double>() - exact * Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <
            tolerance(1e-3, "numbers of 16 bits, 32 modes") * ElasticSheet::kSoftness);
      CHECK(block == cache.block(cache.slot_of(b), cache.slot_of(a)).transpose());
    }
  }
}

TEST_CASE("what a cache was asked before does not show", "[touch]") {
  const ElasticSheet sheet;
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

TEST_CASE("a compliance answers without allocating", "[touch]") {
  const ElasticSheet sheet;
  const Compliance compliance(sheet.tables.compliance);
  ComplianceCache cache(compliance, 8);
  std::vector<float> code(static_cast<std::size_t>(compliance.rank()), 0.0f);
  Eigen::Matrix3Xf u = Eigen::Matrix3Xf::Zero(3, compliance.vertices());
  const std::array vertices{1, 2, 3, 40};
  CHECK(test::allocations_during([&] {
          compliance.add_code(4, Vector3f::Ones(), code);
          compliance.add_shape(4, Vector3f::Ones(), code);
          compliance.modes_everywhere(code, u);
          compliance.add_near(4, Vector3f::Ones(), u);
          cache.bring(vertices);
        }) == 0);
}

TEST_CASE("a compliance table that does not fit together is named", "[touch]") {
  const ElasticSheet sheet;
  CHECK(trouble_of(sheet.tables.compliance).empty());
  const auto broken = [&](auto change) {
    ComplianceTable table = sheet.tables.compliance;
    change(table);
    return trouble_of(table);
  };
  CHECK(broken([](auto& t) { t.vertices = 0; }) == "its size");
  CHECK(broken([](auto& t) { t.rank = 17; }) == "its size");
  CHECK(broken([](auto& t) { t.codes.pop_back(); }) == "the size of its modes");
  CHECK(broken([](auto& t) { t.first[1] = -1; }) == "its lists of neighbours");
  CHECK(broken([](auto& t) { t.neighbours[1] = t.neighbours[0]; }) == "its lists of neighbours");
  CHECK(broken([](auto& t) { t.neighbours.back() = t.vertices; }) == "its lists of neighbours");
  // The first list would end beyond the table, though the last one ends with it.
  CHECK(broken([](auto& t) {
          t.neighbours.resize(169);
          t.first[1] = 170;
          t.first.back() = 169;
        }) == "its lists of neighbours");
  CHECK(broken([](auto& t) { t.near.pop_back(); }) == "the size of its near field");
}

}  // namespace
}  // namespace palpable

#include "palpable/bake/separate/site_bases.h"

#include "palpable/common/base/error.h"
#include "tests/support/tensors.h"
#include "tests/support/test.h"

#include <limits>

namespace palpable {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::tolerance;

TEST_CASE("products of snapshots computed through the bases of sites are those of the snapshots",
          "[separate][reduction]") {
  SnapshotTensor snapshots = test::dents(90, 7, 8);
  snapshots.values.middleCols(3 * 8, 8).setZero();
  auto random = test::random_case(1);
  const VectorXd w = test::random_weights(90, random);
  const MatrixXd truth = snapshots.values.transpose() * w.asDiagonal() * snapshots.values;
  const MatrixXd combination = test::random_matrix(7 * 8, 3, random);
  for (const double lose : {1e-3, 1e-6}) {
    INFO("lose " << lose);
    const SiteBases bases = site_bases(rows_of(snapshots), w, lose);
    MatrixXd gram = bases.gram.triangularView<Eigen::Lower>();
    gram -= MatrixXd(truth.triangularView<Eigen::Lower>());
    CHECK(gram.norm() <= lose * truth.norm());
    for (int s = 0; s < 7; ++s) {
      CHECK(gram.block(s * 8, s * 8, 8, 8).norm() <= tolerance(1e-12, "rounding") * truth.norm());
    }
    CHECK(bases.columns.size() < 90u * 7u * 8u);
    const MatrixXd F = snapshots.values * combination;
    CHECK((bases.combine(combination, w) - F).norm() <= 3.0 * lose * F.norm());
  }
}

TEST_CASE("a snapshot that is not a number has no basis", "[separate][reduction]") {
  SnapshotTensor snapshots = test::dents(20, 3, 2);
  snapshots.values(3, 4) = std::numeric_limits<double>::infinity();
  CHECK_THROWS_AS(site_bases(rows_of(snapshots), VectorXd::Ones(20), 1e-4), Error);
}

}  // namespace
}  // namespace palpable

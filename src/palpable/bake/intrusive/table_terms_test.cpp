#include "palpable/bake/intrusive/table_terms.h"

#include "tests/support/test.h"

#include <cmath>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST_CASE("tables become products, and what is left out is what may be lost", "[intrusive]") {
  auto random = test::random_case(1);
  std::normal_distribution<double> normal;
  std::vector<MatrixXd> tables;
  for (int i = 0; i < 4; ++i) {
    tables.push_back(
        MatrixXd::NullaryExpr(7, 5, [&] { return std::pow(0.2, i) * normal(random); }));
  }
  const VectorXd of_site = VectorXd::LinSpaced(7, 0.5, 3.0),
                 of_level = VectorXd::LinSpaced(5, 4, 1);
  for (const double lose : {0.0, 0.05, 1.0, 1e9}) {
    INFO("may lose " << lose);
    const TableTerms terms = table_terms(tables, of_site, of_level, lose);
    REQUIRE(static_cast<Index>(terms.mode.size()) == terms.site.cols());
    double lost = 0;
    for (int i = 0; i < 4; ++i) {
      MatrixXd sum = MatrixXd::Zero(7, 5);
      for (std::size_t t = 0; t < terms.mode.size(); ++t) {
        if (terms.mode[t] != i) continue;
        sum += terms.site.col(static_cast<Index>(t)) *
               terms.level.col(static_cast<Index>(t)).transpose();
      }
      const MatrixXd gone = tables[i] - sum;
      lost += of_site.dot(gone.cwiseAbs2() * of_level);
    }
    CHECK(lost <= lose + test::tolerance(1e-20, "rounding of sums of order 10"));
    if (lose > 0.0 && lose < 1e9) CHECK(lost > 0.1 * lose);
    if (lose == 0.0) CHECK(terms.mode.size() == 20);
    if (lose == 1e9) CHECK(terms.site.isZero(0.0));
  }
}

}  // namespace
}  // namespace palpable

#include "palpable/bake/intrusive/table_terms.h"

#include "palpable/bake/separate/dense_algebra.h"
#include "palpable/common/base/contract.h"

#include <algorithm>
#include <utility>

namespace palpable {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

TableTerms table_terms(const std::vector<MatrixXd>& tables, const VectorXd& site_weight,
                       const VectorXd& level_weight, double lose) {
  PALPABLE_EXPECT(!tables.empty() && site_weight.minCoeff() > 0.0 && level_weight.minCoeff() > 0.0,
                  "tables and weights above 0");
  const VectorXd site_root = site_weight.cwiseSqrt(), level_root = level_weight.cwiseSqrt();
  std::vector<ThinSvd> svd;
  std::vector<std::pair<double, std::size_t>> values;  // singular value and mode, of all modes
  for (const MatrixXd& table : tables) {
    svd.push_back(thin_svd(site_root.asDiagonal() * table * level_root.asDiagonal()));
    for (const double s : svd.back().s) values.emplace_back(s, svd.size() - 1);
  }
  std::sort(values.begin(), values.end());
  std::vector<Index> kept(tables.size());
  for (std::size_t i = 0; i < tables.size(); ++i) kept[i] = svd[i].s.size();
  double lost = 0.0;
  for (const auto& [value, mode] : values) {
    lost += value * value;
    if (lost > lose) break;
    --kept[mode];
  }
  TableTerms terms;
  Index count = 0;
  for (const Index k : kept) count += k;
  count = std::max<Index>(count, 1);
  terms.site = MatrixXd::Zero(tables[0].rows(), count);
  terms.level = MatrixXd::Zero(tables[0].cols(), count);
  for (std::size_t i = 0; i < tables.size(); ++i) {
    for (Index k = 0; k < kept[i]; ++k) {
      const auto t = static_cast<Index>(terms.mode.size());
      terms.site.col(t) = svd[i].s[k] * svd[i].U.col(k).cwiseQuotient(site_root);
      terms.level.col(t) = svd[i].V.col(k).cwiseQuotient(level_root);
      terms.mode.push_back(static_cast<int>(i));
    }
  }
  if (terms.mode.empty()) terms.mode.push_back(0);  // all terms were left out: one term of zeros
  return terms;
}

}  // namespace palpable

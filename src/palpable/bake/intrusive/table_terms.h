/// @file
/// Splits functions of two parameters into sums of products of functions of one, as a body file
/// holds them.
///
///   m  modes     S  sites     J  levels     c  terms
#pragma once

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// sum over the terms t of mode i of  site(s, t) level(a, t)  ~=  tables[i](s, a)
struct TableTerms {
  std::vector<int> mode;  ///< (c) the mode of each term, not decreasing
  Eigen::MatrixXd site;   ///< (S x c)
  Eigen::MatrixXd level;  ///< (J x c)
};

/// Singular value decompositions of the tables, in the norm sum_s,a weight(s, a) table(s, a)^2 with
/// weight(s, a) = site_weight[s] level_weight[a]. The smallest singular values of all modes
/// together are left out, as long as the sum of their squares is at most `lose`.
/// @param tables  (m) of (S x J)
[[nodiscard]] TableTerms table_terms(const std::vector<Eigen::MatrixXd>& tables,
                                     const Eigen::VectorXd& site_weight,
                                     const Eigen::VectorXd& level_weight, double lose);

}  // namespace palpable

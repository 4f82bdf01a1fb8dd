/// @file
/// From functions of two parameters to sums of products of functions of one: what a body file
/// holds.
///
///   m  modes     S  sites     J  levels     c  terms
#pragma once

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// sum over the terms t of mode i of  site(s, t) level(a, t)  ~=  tables[i](s, a)
struct TableTerms {
  std::vector<int> mode;  ///< (c) whose term it is, not decreasing
  Eigen::MatrixXd site;   ///< (S x c)
  Eigen::MatrixXd level;  ///< (J x c)
};

/// Singular value decompositions of the tables, in the norm sum_s,a weight(s, a) table(s, a)^2 with
/// weight(s, a) = site_weight[s] level_weight[a]; of all modes together the smallest singular
/// values are left out, as long as their squares sum up to `lose` at most.
/// @param tables  (m) of (S x J)
[[nodiscard]] TableTerms table_terms(const std::vector<Eigen::MatrixXd>& tables,
                                     const Eigen::VectorXd& site_weight,
                                     const Eigen::VectorXd& level_weight, double lose);

}  // namespace palpable

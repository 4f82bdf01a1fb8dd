/// @file
/// The first modes of a body and their functions of the load position, for drawing (paper Figs. 11
/// and 13).
///
///   V  surface vertices     S  sites
#pragma once

#include "palpable/common/reduced/reduced_body.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// The separated field to which modes belong.
enum class ModeField { kDisplacement, kStress };

/// One mode F_i, and its factor at each site under the full load. A body file holds F_i once for
/// each product F_i G(s) G(a); these are combined into one mode here.
struct ModeShape {
  Eigen::VectorXf displacement;  ///< (3V) m, at the site where the factor is largest; stress: empty
  Eigen::VectorXf size;          ///< (V) length in m, or von Mises stress in Pa
  Eigen::VectorXd over_sites;    ///< (S) the factor at each site, relative to the largest: -1 .. 1
  double largest = 0;            ///< of `size`
};

/// @param count  at least 1; a body with fewer modes gives all of them
/// @returns a problem for a body with separate modes for each site, which are no functions of the
///          load position
[[nodiscard]] Result<std::vector<ModeShape>> first_modes(const ReducedBody& body, int count,
                                                         ModeField of = ModeField::kDisplacement);

/// Extends values at sites to the skin: (V) the value of the nearest site whose patch holds the
/// vertex; NaN where no patch does.
[[nodiscard]] Eigen::VectorXd on_skin(const ReducedBody& body, const Eigen::VectorXd& over_sites);

}  // namespace palpable

/// @file
/// The first modes of a body and the functions of the load position that go with them, to be drawn
/// (paper Figs. 11 and 13).
///
///   V  surface vertices     S  sites
#pragma once

#include "palpable/common/reduced/reduced_body.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// Whose modes.
enum class ModeField { kDisplacement, kStress };

/// One F_i and what it counts at each site under the full load. A body file holds F_i once for each
/// product F_i G(s) G(a); those are one mode here.
struct ModeShape {
  Eigen::VectorXf displacement;  ///< (3V) m, as large as the mode gets at any site; of stress none
  Eigen::VectorXf size;          ///< (V) m or, of stress, Pa: its length or von Mises stress
  Eigen::VectorXd over_sites;    ///< (S) -1 .. 1: the share of the largest at each
  double largest = 0;            ///< of one vertex, in the unit of `size`
};

/// @param count  at least 1; a body with fewer modes gives those
/// @returns a problem for a body whose modes belong to a site each, which have no function over
/// them
[[nodiscard]] Result<std::vector<ModeShape>> first_modes(const ReducedBody& body, int count,
                                                         ModeField of = ModeField::kDisplacement);

/// (V) the value of the nearest site whose patch holds the vertex; NaN where no patch does.
[[nodiscard]] Eigen::VectorXd on_skin(const ReducedBody& body, const Eigen::VectorXd& over_sites);

}  // namespace palpable

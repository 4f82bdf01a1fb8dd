/// @file
/// A load that travels over a face: from [intrusive] of a description to positions and forces.
///
///   N  nodes     S  positions
#pragma once

#include "palpable/bake/describe/body_description.h"
#include "palpable/bake/describe/body_problem.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <vector>

namespace palpable {

struct TravellingLoad {
  BodyProblem problem;                   ///< its sites are the positions, full load set
  Eigen::SparseMatrix<double> load;      ///< (3N x S) f(s) at the full load, N
  Eigen::VectorXd area;                  ///< (S) m^2 of the skin that belongs to each position
  std::vector<Site> reaction_sites;      ///< (R) where a reaction may act
  Eigen::SparseMatrix<double> reaction;  ///< (3N x R) N, as large as the full load, opposite to it
  double patch_radius = 0;               ///< m: from a position to the farthest vertex of its patch
  int left_out = 0;                      ///< positions too near to the supports
};

/// @throws Error as pose_body(); without [intrusive]; for a preload, since the series starts from
///         the undeformed body; where no position is left
[[nodiscard]] TravellingLoad travelling_load(const BodyDescription& description);

}  // namespace palpable

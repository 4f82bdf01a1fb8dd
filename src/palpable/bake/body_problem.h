/// @file
/// From a description to what the solver is given: mesh, model, sites and their loads.
#pragma once

#include "palpable/bake/body_description.h"
#include "palpable/bake/body_mesh.h"
#include "palpable/reduced/reduced_body.h"
#include "palpable/solid/solid_model.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace palpable {

struct BodyProblem {
  BodyMesh mesh;
  SolidModel model;
  std::vector<Site> sites;  ///< full loads not found yet
  double press = 0;         ///< m: how far a patch shall give way at full load
};

/// @throws Error for what cannot be read, meshed or held, or has too few places for its sites
[[nodiscard]] BodyProblem pose_body(const BodyDescription& description);

/// (V) 1 where the support holds the vertex of the skin.
[[nodiscard]] std::vector<std::uint8_t> fixed_vertices(const BodyMesh& mesh);

/// (3 x N) forces of 1 N in total on the site's patch, by its weights and along its direction.
[[nodiscard]] Eigen::Matrix3Xd unit_load(const Site& site, const Boundary& boundary,
                                         int node_count);

/// The same body with 10-node elements: edges between held corners are held.
/// @pre model has 4-node elements
[[nodiscard]] SolidModel with_edge_nodes(const SolidModel& model);

/// (3 x N) the same traction field as unit_load(), linear in each triangle of the skin,
/// consistently on a mesh that may have edge nodes; 1 N in total.
[[nodiscard]] Eigen::Matrix3Xd unit_traction(const Site& site, const Boundary& boundary,
                                             const TetMesh& mesh);

}  // namespace palpable

/// @file
/// From a description to what the solver is given: mesh, model, sites and their loads.
#pragma once

#include "palpable/bake/describe/body_description.h"
#include "palpable/bake/describe/body_mesh.h"
#include "palpable/bake/solid/solid_model.h"
#include "palpable/common/reduced/reduced_body.h"

#include <Eigen/Core>

#include <cstdint>
#include <string>
#include <vector>

namespace palpable {

struct BodyProblem {
  BodyMesh mesh;
  SolidModel model;
  std::vector<Site> sites;  ///< full loads not found yet
  /// Whose linear responses are asked for: every vertex of the skin that is not held, or the sites
  /// and then touches_between() them, clear of supports. None where there are parameters, or
  /// nothing between sites.
  std::vector<Site> linear_sites;
  double press = 0;  ///< m: how far a patch shall give way at full load; 0: see force
  double force = 0;  ///< N: the full load; 0: the one that gives the press
  /// (3 x N) N: what acts on the body before anybody presses it, weight and pressures. No columns:
  /// nothing does.
  Eigen::Matrix3Xd preload;
};

/// Everything that the description says, checked: a problem that is posed can be solved, up to
/// what the body does on the way.
/// @throws Error, one line that names file and key, for what cannot be read or meshed; places
///         without nodes, faces or elements, sets that the mesh does not have; groups of elements
///         that overlap; supports that contradict each other or leave the body free to drift or
///         turn; sites that the support holds, or fewer places for sites than are asked for
[[nodiscard]] BodyProblem pose_body(const BodyDescription& description);
/// The same on a mesh that is there. @param mesh  of the description
[[nodiscard]] BodyProblem pose_body(const BodyDescription& description, BodyMesh mesh);

/// Lines for people: nodes and elements, material, what is held, parts of other materials.
[[nodiscard]] std::string problem_text(const BodyDescription& description,
                                       const BodyProblem& problem);

/// A site for messages: its number, place and direction.
[[nodiscard]] std::string site_text(const BodyProblem& problem, int number);

/// Loads that point to the centre of mass cannot press a site beyond it: it would come out on the
/// other side, and the solver, which knows no contact of a body with itself, would let it.
/// @throws Error naming the site and the deepest press
void refuse_press_through(const BodyDescription& description, const BodyProblem& problem);

/// The material that a description states. @throws Error as material_from_young()
[[nodiscard]] Material material_of(const BodyDescription::MaterialLaw& law);

/// One line for people: law, constants with units, and what they mean at small strains.
[[nodiscard]] std::string material_line(const BodyDescription::MaterialLaw& law);

/// (V) 1 where the support holds the vertex of the skin in all directions.
[[nodiscard]] std::vector<std::uint8_t> fixed_vertices(const BodyMesh& mesh);

/// (3 x N) forces of 1 N in total on the site's patch, by its weights and along its direction.
[[nodiscard]] Eigen::Matrix3Xd unit_load(const Site& site, const Boundary& boundary,
                                         int node_count);

/// The same body with 10-node elements: edges between held corners are held.
/// @pre model has 4-node elements
[[nodiscard]] SolidModel with_edge_nodes(const SolidModel& model);

/// (3 x N) Pa at the nodes of the site's patch, linear in each triangle of the skin; 1 N in total.
/// @param boundary    boundary_of() the mesh from which the site is
/// @param node_count  N
[[nodiscard]] Eigen::Matrix3Xd patch_traction(const Site& site, const Boundary& boundary,
                                              int node_count);

/// (3 x N) the same traction field as unit_load(), linear in each triangle of the skin,
/// consistently on a mesh that may have edge nodes; 1 N in total.
/// @param boundary  boundary_of() the mesh from which the site is
[[nodiscard]] Eigen::Matrix3Xd unit_traction(const Site& site, const Boundary& boundary,
                                             const TetMesh& mesh);

}  // namespace palpable

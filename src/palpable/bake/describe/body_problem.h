/// @file
/// Makes the input of the solver from a description: mesh, model, sites and their loads.
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
  /// Sites whose linear responses are to be computed: every vertex of the skin that is not held, or
  /// the sites followed by touches_between() them, away from supports. Empty where the description
  /// has parameters, or nothing lies between the sites.
  std::vector<Site> linear_sites;
  double press = 0;  ///< m: displacement of a patch at full load; 0: see force
  double force = 0;  ///< N: the full load; 0: the one that gives the press
  /// m: how far a press may move a node. More than the model's largest_displacement where a press
  /// by depth needs it (BodyDescription::Press::range).
  double press_range = 0;
  /// (3 x N) N: the forces that act on the body before it is pressed: weight and pressures. No
  /// columns: none.
  Eigen::Matrix3Xd preload;
};

/// Makes and checks everything that the description specifies. The problem returned can be solved,
/// unless the body itself fails under its load, for instance by buckling.
/// @throws Error, one line that names file and key, for what cannot be read or meshed; places
///         without nodes, faces or elements, sets that the mesh does not have; groups of elements
///         that overlap; supports that contradict each other or leave the body free to drift or
///         turn; sites that the support holds, or fewer vertices for sites than requested
[[nodiscard]] BodyProblem pose_body(const BodyDescription& description);
/// The same on a given mesh. @param mesh  of the description
[[nodiscard]] BodyProblem pose_body(const BodyDescription& description, BodyMesh mesh);

/// Text for the user: nodes and elements, material, held nodes, parts of other materials.
[[nodiscard]] std::string problem_text(const BodyDescription& description,
                                       const BodyProblem& problem);

/// A site as text for messages: its number, position and direction.
[[nodiscard]] std::string site_text(const BodyProblem& problem, int number);

/// Refuses loads towards the centre of mass that would press a site past it. The solver has no
/// contact of a body with itself, so the skin could come out on the other side.
/// @throws Error naming the site and the deepest press
void refuse_press_through(const BodyDescription& description, const BodyProblem& problem);

/// Refuses presses by depth beyond the range of the model ('range' in [press]), before any is
/// solved. Loads are refused where they turn out to press that far (Stop::kBeyondRange).
/// @throws Error naming both lengths
void refuse_beyond_range(const BodyDescription& description, const BodyProblem& problem);

/// The largest displacement for which the model is meant, in words for messages: "a third of the
/// body's largest extent".
[[nodiscard]] std::string range_words(const BodyDescription& description);

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

}  // namespace palpable

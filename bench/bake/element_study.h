/// @file
/// How true 4-node and 10-node tetrahedra are on a body of one's own: presses of one body on nested
/// meshes, against a uniformly refined one under the same traction field.
///
///   N  nodes of a mesh     R  nodes of the reference
///
/// All meshes of a family fill the same polyhedron and are held at the same faces, and each one's
/// functions are among the reference's (or have the same nodes): errors are those of the elements,
/// not of the shape. The reference has an error of its own, so errors are good to about the share
/// by which they exceed it.
#pragma once

#include "palpable/bake/describe/body_problem.h"
#include "palpable/common/base/progress.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <string>
#include <vector>

namespace palpable {

/// One mesh of a family.
struct ElementMember {
  std::string name;  ///< for people: "10-node"
  SolidModel model;
  /// (R x N): a displacement of this mesh, row by row, at the nodes of the reference.
  Eigen::SparseMatrix<double> to_reference;
  /// The functions of this mesh are combinations of the reference's: a load is carried over by the
  /// transpose of to_reference, exactly. Otherwise it is integrated anew.
  bool nested = true;
};

struct ElementFamily {
  SolidModel reference;  ///< 10-node tetrahedra
  Boundary skin;  ///< of the 4-node mesh whose corners the reference has: it carries the traction
  /// Errors of stress are taken at the first so many nodes of the reference, which they share.
  std::vector<ElementMember> members;
  std::size_t loads_from = 0;  ///< the member that says which load gives which press
};

/// From a coarse mesh of 4-node tetrahedra: "4-node, coarse" (itself), "10-node" (with edge nodes),
/// "4-node" (split in eight: the same nodes as the 10-node one), "4-node, fine" (split again), and
/// as the reference the split mesh with edge nodes. The split mesh carries the traction.
[[nodiscard]] ElementFamily nested_family(const SolidModel& coarse);

/// A mesh of 4-node tetrahedra ("4-node") and, as the reference, the same with edge nodes.
[[nodiscard]] ElementFamily single_family(const SolidModel& mesh);

struct ElementStudySettings {
  int sites = 12;     ///< farthest points on the skin, each pressed by a small load
  double lowest = 0;  ///< m: no site below
  int patch = 2;      ///< graph distance on the skin that carries the traction
  int pressed = 6;    ///< the first so many are pressed by finite loads too
  double press = 0;   ///< m, the full press
  std::vector<double> shares{0.25, 0.5};        ///< of it, increasing
  std::vector<double> poisson{0.4, 0.3, 0.45};  ///< shares are pressed under the first only
  std::string law = "neo-hookean";
  double young = 60e3;  ///< Pa; scales loads and stresses and nothing else
};

/// Of one state; relative to the reference.
struct ElementErrors {
  double press = 0;         ///< signed: below 0 is too stiff
  double displacement = 0;  ///< L2 norm over the body
  /// Von Mises stress in the elements, L2 norm over the body; NaN where the mesh is not nested.
  double element_von_mises = 0;
  /// Von Mises stress recovered at the nodes, L2 norm over those that the meshes share. The
  /// reference's is not recovered in patches, which would favour meshes with the same patches, but
  /// the mean of what its elements have at a node.
  double nodal_von_mises = 0;
};

/// One press of one site.
struct ElementPress {
  int site = 0;
  double share =
      0;  ///< of the full press, as loads_from has it; 0: a small load, that of a hundredth
  double poisson = 0;
  double load = 0;                    ///< N
  double press = 0;                   ///< m, of the reference
  std::string why_stopped;            ///< the reference did not get there; no errors then
  std::vector<ElementErrors> errors;  ///< one per member; NaN where a member did not get there
};

struct ElementMemberReport {
  std::string name;
  int nodes = 0, tets = 0, nodes_per_tet = 0;
  double setup_cpu_s = 0;               ///< solver made, factor of the undeformed body included
  std::vector<double> path_cpu_s = {};  ///< per pressed site: from rest to the last share
};

struct ElementStudy {
  std::vector<Site> sites;                   ///< on family.skin
  std::vector<Eigen::Vector3d> places;       ///< m, of the sites
  std::vector<ElementMemberReport> members;  ///< the family's, then the reference
  std::vector<ElementPress> presses;
};

/// Solves everything, one mesh after the other: memory is that of the reference's factor (4 to 7 GB
/// for 128,000 nodes). CPU times are of this process, which should do nothing else.
/// @throws Error as EquilibriumSolver and choose_sites(), or when no load gives the first press
[[nodiscard]] ElementStudy study_elements(const ElementFamily& family,
                                          const ElementStudySettings& settings,
                                          const Progress& progress = {});

}  // namespace palpable

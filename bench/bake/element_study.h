/// @file
/// Accuracy of 4-node and 10-node tetrahedra for a given body: presses of the body on nested
/// meshes, compared with a uniformly refined mesh under the same traction field.
///
///   N  nodes of a mesh     R  nodes of the reference
///
/// All meshes of a family fill the same polyhedron and are held at the same faces, and the shape
/// functions of each are among those of the reference (or it has the same nodes). Therefore the
/// errors are those of the elements, not of the shape. The reference has an error of its own, which
/// limits the accuracy of the measured errors.
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
  std::string name;  ///< a readable name, e.g. "10-node"
  SolidModel model;
  /// (R x N): maps a displacement at the nodes of this mesh to the nodes of the reference.
  Eigen::SparseMatrix<double> to_reference;
  /// Whether the shape functions of this mesh are combinations of the reference's. Then the
  /// transpose of to_reference transfers a load exactly; otherwise the load is integrated
  /// again on this mesh.
  bool nested = true;
};

struct ElementFamily {
  SolidModel reference;  ///< 10-node tetrahedra
  Boundary skin;  ///< of the 4-node mesh with the reference's corners: it carries the traction
  /// Errors of stress are taken at the first nodes of the reference, which all meshes share.
  std::vector<ElementMember> members;
  std::size_t loads_from = 0;  ///< index of the member that determines the loads
};

/// Builds from a coarse mesh of 4-node tetrahedra: "4-node, coarse" (itself), "10-node" (with edge
/// nodes), "4-node" (split in eight: the same nodes as the 10-node mesh), "4-node, fine" (split
/// again). The reference is the split mesh with edge nodes. The split mesh carries the traction.
[[nodiscard]] ElementFamily nested_family(const SolidModel& coarse);

/// A mesh of 4-node tetrahedra ("4-node"); the reference is the same mesh with edge nodes.
[[nodiscard]] ElementFamily single_family(const SolidModel& mesh);

struct ElementStudySettings {
  int sites = 12;  ///< number of sites, farthest points of the skin, each pressed by a small load
  double lowest = 0;  ///< m, smallest height of a site
  int patch = 2;      ///< radius of a patch, graph distance on the skin that carries the traction
  int pressed = 6;    ///< number of sites that are also pressed by finite loads
  double press = 0;   ///< m, depth of the full press
  std::vector<double> shares{0.25, 0.5};        ///< ratios to `press`, increasing
  std::vector<double> poisson{0.4, 0.3, 0.45};  ///< the shares are applied with the first one only
  std::string law = "neo-hookean";
  double young = 60e3;  ///< Pa; only scales loads and stresses
};

/// Relative errors of one state: the norm of the difference from the reference mesh's solution,
/// divided by the norm of that solution.
struct ElementErrors {
  double press = 0;         ///< signed; negative: too stiff
  double displacement = 0;  ///< L2 norm over the body
  /// Von Mises stress in the elements, L2 norm over the body; NaN where the
  /// reference mesh is not a refinement of this one, so that elements cannot be compared.
  double element_von_mises = 0;
  /// Von Mises stress recovered at the nodes, L2 norm over the nodes that the meshes share. For the
  /// reference it is the mean over the elements at a node instead of a recovery in patches, which
  /// would favour meshes with the same patches.
  double nodal_von_mises = 0;
};

/// One press of one site.
struct ElementPress {
  int site = 0;
  double share = 0;  ///< of the full press of loads_from; 0: a small load, 1 % of the full press
  double poisson = 0;
  double load = 0;          ///< N
  double press = 0;         ///< m, of the reference
  std::string why_stopped;  ///< why the reference did not converge; then there are no errors
  std::vector<ElementErrors> errors;  ///< one per member; NaN where a member did not converge
};

struct ElementMemberReport {
  std::string name;
  int nodes = 0, tets = 0, nodes_per_tet = 0;
  double setup_cpu_s = 0;  ///< construction of the solver with the factor of the undeformed body
  std::vector<double> path_cpu_s = {};  ///< per pressed site: from rest to the last share
};

struct ElementStudy {
  std::vector<Site> sites;                   ///< on family.skin
  std::vector<Eigen::Vector3d> places;       ///< m, of the sites
  std::vector<ElementMemberReport> members;  ///< of the family, then of the reference
  std::vector<ElementPress> presses;
};

/// Solves all presses, one mesh after the other, so that the memory is that of the
/// reference's factor (4 to 7 GB for 128,000 nodes). CPU times are of the whole process,
/// which should do nothing else.
/// @throws Error as EquilibriumSolver and choose_sites(), or when no load gives the first press
[[nodiscard]] ElementStudy study_elements(const ElementFamily& family,
                                          const ElementStudySettings& settings,
                                          const Progress& progress = {});

}  // namespace palpable

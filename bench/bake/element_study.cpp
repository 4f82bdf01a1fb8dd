#include "bench/bake/element_study.h"

#include "palpable/bake/describe/body_problem.h"
#include "palpable/bake/describe/contact_sites.h"
#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/loads.h"
#include "palpable/bake/solid/selection.h"
#include "palpable/bake/solid/stress.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/cpu_time.h"
#include "palpable/common/base/error.h"
#include "palpable/common/geometry/shape_gradients.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace palpable {

using Eigen::Matrix3Xd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr ElementErrors kNoErrors{kNone, kNone, kNone, kNone};

Sparse identity(Eigen::Index n) {
  Sparse one(n, n);
  one.setIdentity();
  return one;
}

// Rows of a matrix, each set once: elements give equal rows for a node they share, and
// the first is kept.
class Rows {
 public:
  Rows(int rows, int columns) : matrix_(rows, columns), done_(rows, false) {}
  [[nodiscard]] bool take(int row) {
    if (done_[row]) return false;
    done_[row] = true;
    return true;
  }
  void add(int row, int column, double value) {
    if (value != 0.0) entries_.emplace_back(row, column, value);
  }
  Sparse finish() {
    matrix_.setFromTriplets(entries_.begin(), entries_.end());
    return matrix_;
  }

 private:
  Sparse matrix_;
  std::vector<bool> done_;
  std::vector<Eigen::Triplet<double>> entries_;
};

// Maps a field of 4-node tetrahedra to the nodes of the same mesh with edge nodes.
Sparse linear_at_edge_nodes(const TetMesh& mesh, const TetMesh& with_edges) {
  Rows rows(with_edges.node_count(), mesh.node_count());
  for (int n = 0; n < mesh.node_count(); ++n) {
    if (rows.take(n)) rows.add(n, n, 1.0);
  }
  for (int e = 0; e < mesh.tet_count(); ++e) {
    for (int k = 0; k < 6; ++k) {
      const int row = with_edges.edge_nodes(k, e);
      if (!rows.take(row)) continue;
      rows.add(row, mesh.tets(kTetEdges[k][0], e), 0.5);
      rows.add(row, mesh.tets(kTetEdges[k][1], e), 0.5);
    }
  }
  return rows.finish();
}

// Maps a field of 10-node tetrahedra to the nodes of with_edge_nodes(split_into_eight(coarse)),
// where it is the same field, because a quadratic polynomial is quadratic on each part.
Sparse quadratic_at_split_nodes(const TetMesh& coarse, const TetMesh& fine) {
  Rows rows(fine.node_count(), coarse.node_count());
  for (int n = 0; n < coarse.node_count(); ++n) {
    if (rows.take(n)) rows.add(n, n, 1.0);
  }
  for (int child = 0; child < fine.tet_count(); ++child) {
    const Eigen::Matrix<int, 10, 1> nodes = quadratic_nodes(coarse, child / 8);
    const auto barycentric = [&](int node) {
      const Eigen::Index a = std::find(nodes.begin(), nodes.end(), node) - nodes.begin();
      PALPABLE_EXPECT(a < 10, "the split mesh of the coarse one");
      if (a < 4) return Eigen::Vector4d(Eigen::Vector4d::Unit(a));
      const auto& edge = kTetEdges[a - 4];
      return Eigen::Vector4d(0.5 *
                             (Eigen::Vector4d::Unit(edge[0]) + Eigen::Vector4d::Unit(edge[1])));
    };
    for (int k = 0; k < 6; ++k) {
      const int row = fine.edge_nodes(k, child);
      if (!rows.take(row)) continue;
      const Eigen::Vector4d at = 0.5 * (barycentric(fine.tets(kTetEdges[k][0], child)) +
                                        barycentric(fine.tets(kTetEdges[k][1], child)));
      const QuadraticShape shape = quadratic_shape(at);
      for (int a = 0; a < 10; ++a) rows.add(row, nodes[a], shape.N[a]);
    }
  }
  return rows.finish();
}

SolidModel split(const SolidModel& model) {
  SolidModel fine = model;
  fine.mesh = split_into_eight(model.mesh);
  return fine;
}

// The quantities of a state that are compared.
struct State {
  Matrix3Xd u;         // at the reference's nodes
  VectorXd at_points;  // von Mises stress at the reference's integration points
  VectorXd at_nodes;   // von Mises stress at the mesh's own nodes
  double press = kNone;
};

double relative_l2(const VectorXd& weights, const auto& difference_squared,
                   const auto& reference_squared) {
  return std::sqrt(weights.dot(difference_squared) / weights.dot(reference_squared));
}

// Solves all presses, one mesh after the other.
class Study {
 public:
  Study(const ElementFamily& family, const ElementStudySettings& settings, const Progress& progress)
      : family_(family), settings_(settings), progress_(progress) {
    const SolidModel& reference = family.reference;
    std::vector<char> held(reference.mesh.node_count(), 0);
    for (const int n : reference.fixed_nodes) held[n] = 1;
    std::vector<std::uint8_t> fixed;
    for (const int n : family.skin.node_of_vertex) { fixed.push_back(held[n] != 0); }
    study_.sites = choose_sites(
        family.skin.surface, fixed,
        {.count = settings.sites, .lowest = settings.lowest, .patch_distance = settings.patch});
    const int corners = corner_count(reference.mesh);
    const Eigen::Matrix3Xi triangles = skin_triangles(reference.mesh);
    for (const Site& site : study_.sites) {
      study_.places.push_back(family.skin.surface.vertices.col(site.vertex));
      corner_traction_.push_back(patch_traction(site, family.skin, corners));
      unit_.push_back(traction_load(reference.mesh, triangles, corner_traction_.back()));
    }
    volumes_ = nodal_volumes(reference.mesh);
    point_volumes_ = tet_volumes(reference.mesh).transpose().replicate(4, 1).reshaped();
    total_ = 0;
    for (std::size_t p = 0; p < settings.poisson.size(); ++p) {
      for (std::size_t m = 0; m <= family.members.size(); ++m) total_ += weight(m) * jobs(m, p);
    }
  }

  ElementStudy run() {
    find_loads();
    for (std::size_t m = 0; m <= family_.members.size(); ++m) {
      const SolidModel& model = model_of(m);
      study_.members.push_back(
          {.name = m < family_.members.size() ? family_.members[m].name : std::string("reference"),
           .nodes = model.mesh.node_count(),
           .tets = model.mesh.tet_count(),
           .nodes_per_tet = model.mesh.is_quadratic() ? 10 : 4});
    }
    for (std::size_t p = 0; p < settings_.poisson.size(); ++p) {
      truth_.clear();
      const std::size_t first = study_.presses.size();
      // The reference is solved first, because the others are compared with it.
      solve(family_.members.size(), p);
      for (std::size_t m = 0; m < family_.members.size(); ++m) {
        if (jobs(m, p) == 0) continue;
        solve(m, p, first);
      }
    }
    return std::move(study_);
  }

 private:
  static int corner_count(const TetMesh& mesh) { return mesh.tets.maxCoeff() + 1; }

  [[nodiscard]] const SolidModel& model_of(std::size_t m) const {
    return m < family_.members.size() ? family_.members[m].model : family_.reference;
  }
  // A fine mesh with as many nodes as the reference is used for the finite presses only.
  [[nodiscard]] bool in_linear_response(std::size_t m) const {
    return m == family_.members.size() || family_.members[m].nested;
  }
  // Approximate cost: a factor costs nodes^2, a solve nodes^(4/3).
  [[nodiscard]] double weight(std::size_t m) const {
    return std::pow(model_of(m).mesh.node_count() / 1000.0, 1.33);
  }
  [[nodiscard]] double jobs(std::size_t m, std::size_t p) const {
    return (p == 0 ? 4.0 * settings_.pressed : 0.0) +
           (in_linear_response(m) ? settings_.sites + 10 : 0);
  }
  void show(const std::string& what) {
    report(progress_, {.task = "elements", .done = done_, .total = total_, .note = what});
  }

  [[nodiscard]] SolidModel with_material(const SolidModel& model, double poisson) const {
    SolidModel result = model;
    result.material = material_from_young(settings_.law, settings_.young, poisson);
    return result;
  }

  [[nodiscard]] Matrix3Xd load_of(std::size_t m, std::size_t site) const {
    if (m == family_.members.size()) return unit_[site];
    const ElementMember& member = family_.members[m];
    if (member.nested) return unit_[site] * member.to_reference;
    // The traction at all nodes of the reference, linear between its corners.
    const TetMesh& reference = family_.reference.mesh;
    const int corners = corner_count(reference);
    Matrix3Xd traction(3, reference.node_count());
    traction.leftCols(corners) = corner_traction_[site];
    for (int e = 0; e < reference.tet_count(); ++e) {
      for (int k = 0; k < 6; ++k) {
        traction.col(reference.edge_nodes(k, e)) =
            0.5 * (traction.col(reference.tets(kTetEdges[k][0], e)) +
                   traction.col(reference.tets(kTetEdges[k][1], e)));
      }
    }
    return traction_load(member.model.mesh, skin_triangles(member.model.mesh), traction);
  }

  void find_loads() {
    const std::size_t m = family_.loads_from;
    const EquilibriumSolver solver(with_material(model_of(m), settings_.poisson.front()));
    for (std::size_t s = 0; s < study_.sites.size(); ++s) {
      show("loads");
      const Matrix3Xd unit = load_of(m, s);
      // At this load the response is linear within about 1 %, and all meshes get the same load.
      // With 1e-4 of the press, rounding of the energy, which is proportional to the square of the
      // strain, stops Newton's method at an ear.
      const LoadSearch small = solver.find_load(unit, 1e-2 * settings_.press);
      if (!small.reached) throw Error("a site cannot be pressed: " + small.why_stopped);
      loads_.push_back({small.load});
      if (static_cast<int>(s) >= settings_.pressed) continue;
      for (const double share : settings_.shares) {
        const LoadSearch search = solver.find_load(unit, share * settings_.press);
        if (!search.reached) break;
        loads_.back().push_back(search.load);
      }
    }
  }

  // Solves all presses of one mesh with one Poisson's ratio. The reference's states become truth_;
  // others are compared with these, beginning with study_.presses[first].
  void solve(std::size_t m, std::size_t p, std::size_t first = 0) {
    const bool is_reference = m == family_.members.size();
    const double poisson = settings_.poisson[p];
    ElementMemberReport& report_of = study_.members[m];
    EquilibriumSettings settings;
    // The factor of a large mesh is worth more iterations than by default.
    if (model_of(m).mesh.node_count() > 50'000) settings.refresh_iterations = 100;
    show(fmt::format("{}, factor", report_of.name));
    const double begin = process_cpu_seconds();
    const EquilibriumSolver solver(with_material(model_of(m), poisson), settings);
    if (p == 0) report_of.setup_cpu_s = process_cpu_seconds() - begin;
    const StressRecovery recovery(solver.model().mesh);
    const SolidModel there = with_material(family_.reference, poisson);
    done_ += 10 * weight(m);

    std::size_t at = first;
    for (std::size_t s = 0; s < study_.sites.size(); ++s) {
      const Matrix3Xd unit = load_of(m, s);
      const bool finite = p == 0 && loads_[s].size() > 1;
      for (const bool linear : {true, false}) {
        if (!linear && !finite) continue;
        const std::size_t count = linear ? 1 : loads_[s].size() - 1;
        const std::span<const double> levels(loads_[s].data() + (linear ? 0 : 1), count);
        PathResult path;
        if (!linear || in_linear_response(m)) {
          show(fmt::format("{}, nu {}, site {}", report_of.name, poisson, s));
          const double start = process_cpu_seconds();
          path = solver.solve_path(unit, levels);
          if (!linear) report_of.path_cpu_s.push_back(process_cpu_seconds() - start);
          done_ += (linear ? 1 : 4) * weight(m);
        }
        for (std::size_t k = 0; k < count; ++k) {
          State state;
          if (k < path.steps.size()) {
            const Matrix3Xd& u = path.steps[k].displacement;
            state.press = unit.cwiseProduct(u).sum();
            state.u = is_reference ? u : Matrix3Xd(u * family_.members[m].to_reference.transpose());
            // Gradients are the same as on its own mesh if that is nested.
            if (in_linear_response(m)) {
              state.at_points = von_mises(point_cauchy_stress(there, state.u));
            }
            state.at_nodes = von_mises(nodal_cauchy_stress(solver.model(), u, recovery));
          }
          if (is_reference) {
            study_.presses.push_back(
                {.site = static_cast<int>(s),
                 .share = linear ? 0.0 : settings_.shares[k],
                 .poisson = poisson,
                 .load = levels[k],
                 .press = state.press,
                 .why_stopped = k < path.steps.size() ? "" : path.why_stopped,
                 .errors = std::vector<ElementErrors>(family_.members.size(), kNoErrors)});
            truth_.push_back(std::move(state));
          } else {
            study_.presses[at].errors[m] = errors(state, truth_[at - first]);
            ++at;
          }
        }
      }
    }
  }

  [[nodiscard]] ElementErrors errors(const State& state, const State& truth) const {
    if (state.u.cols() == 0 || truth.u.cols() == 0) { return kNoErrors; }
    // The nodes at which both have recovered stress: the first nodes are common to a family.
    const Eigen::Index shared =
        std::min<Eigen::Index>(state.at_nodes.size(), corner_count(family_.reference.mesh));
    const VectorXd mine = state.at_nodes.head(shared), right = truth.at_nodes.head(shared);
    return {.press = state.press / truth.press - 1.0,
            .displacement = relative_l2(volumes_, (state.u - truth.u).colwise().squaredNorm(),
                                        truth.u.colwise().squaredNorm()),
            .element_von_mises =
                state.at_points.size() == 0
                    ? kNone
                    : relative_l2(point_volumes_, (state.at_points - truth.at_points).cwiseAbs2(),
                                  truth.at_points.cwiseAbs2()),
            .nodal_von_mises =
                relative_l2(volumes_.head(shared), (mine - right).cwiseAbs2(), right.cwiseAbs2())};
  }

  const ElementFamily& family_;
  const ElementStudySettings& settings_;
  const Progress& progress_;
  ElementStudy study_;
  std::vector<Matrix3Xd> corner_traction_;  // per site, Pa at the reference's corners
  std::vector<Matrix3Xd> unit_;             // per site, N at the reference's nodes
  std::vector<std::vector<double>> loads_;  // per site: of the linear response, then of the shares
  std::vector<State> truth_;                // for one Poisson's ratio
  VectorXd volumes_;                        // m^3, at the reference's nodes
  VectorXd point_volumes_;                  // m^3, of the element, at the reference's points
  double done_ = 0, total_ = 1;
};

}  // namespace

ElementFamily nested_family(const SolidModel& coarse) {
  ElementFamily family;
  const SolidModel ten = with_edge_nodes(coarse);
  const SolidModel four = split(ten);
  family.reference = with_edge_nodes(four);
  const SolidModel fine = split(family.reference);
  family.skin = boundary_of(four.mesh);
  const Sparse from_ten = quadratic_at_split_nodes(ten.mesh, family.reference.mesh);
  // A field of the coarse mesh is also a field of the 10-node mesh.
  const Sparse from_coarse = from_ten * linear_at_edge_nodes(coarse.mesh, ten.mesh);
  const Sparse from_four = linear_at_edge_nodes(four.mesh, family.reference.mesh);
  family.members = {
      {.name = "4-node, coarse", .model = coarse, .to_reference = from_coarse},
      {.name = "10-node", .model = ten, .to_reference = from_ten},
      {.name = "4-node", .model = four, .to_reference = from_four},
      {.name = "4-node, fine",
       .model = fine,
       .to_reference = identity(fine.mesh.node_count()),
       .nested = false},
  };
  family.loads_from = 1;
  return family;
}

ElementFamily single_family(const SolidModel& mesh) {
  ElementFamily family;
  family.reference = with_edge_nodes(mesh);
  family.skin = boundary_of(mesh.mesh);
  family.members = {{.name = "4-node",
                     .model = mesh,
                     .to_reference = linear_at_edge_nodes(mesh.mesh, family.reference.mesh)}};
  return family;
}

ElementStudy study_elements(const ElementFamily& family, const ElementStudySettings& settings,
                            const Progress& progress) {
  PALPABLE_EXPECT(settings.press > 0.0, "there is a press");
  PALPABLE_EXPECT(!settings.poisson.empty() && settings.pressed <= settings.sites,
                  "some Poisson's ratio; pressed sites are among the sites");
  PALPABLE_EXPECT(family.loads_from < family.members.size(), "a member finds the loads");
  return Study(family, settings, progress).run();
}

}  // namespace palpable

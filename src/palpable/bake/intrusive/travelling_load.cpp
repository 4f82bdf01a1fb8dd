#include "palpable/bake/intrusive/travelling_load.h"

#include "palpable/common/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpable {

using Eigen::Index;

namespace {

// (3N x S) `force` newtons at each site.
Eigen::SparseMatrix<double> forces_of(const BodyProblem& problem, const std::vector<Site>& sites,
                                      double force) {
  const Boundary& boundary = problem.mesh.boundary;
  const int N = problem.mesh.mesh.node_count();
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t s = 0; s < sites.size(); ++s) {
    const Eigen::Matrix3Xd load = unit_load(sites[s], boundary, N);
    for (const int v : sites[s].patch) {
      const int n = boundary.node_of_vertex[v];
      for (int i = 0; i < 3; ++i) {
        if (load(i, n) != 0.0) {
          entries.emplace_back(3 * n + i, static_cast<int>(s), force * load(i, n));
        }
      }
    }
  }
  Eigen::SparseMatrix<double> forces(3 * Index{N}, static_cast<Index>(sites.size()));
  forces.setFromTriplets(entries.begin(), entries.end());
  return forces;
}

// Largest distance of a vertex of a site's patch from the site, m.
double largest_patch_radius(const std::vector<Site>& sites, const SurfaceMesh& skin) {
  double radius = 0;
  for (const Site& site : sites) {
    for (const int v : site.patch) {
      radius = std::max(radius, (skin.vertices.col(v) - skin.vertices.col(site.vertex)).norm());
    }
  }
  return radius;
}

// Leaves out the sites nearer than the clearance to what is held.
void keep_clear(const BodyDescription::Intrusive& wanted, TravellingLoad& travelling) {
  BodyProblem& problem = travelling.problem;
  const SurfaceMesh& skin = problem.mesh.boundary.surface;
  const double clearance = wanted.clearance * travelling.patch_radius;
  travelling.left_out = static_cast<int>(std::erase_if(problem.sites, [&](const Site& site) {
    return std::ranges::any_of(problem.mesh.fixed_nodes, [&](int n) {
      return (problem.mesh.mesh.nodes.col(n) - skin.vertices.col(site.vertex)).norm() <= clearance;
    });
  }));
  if (problem.sites.empty()) {
    throw Error(fmt::format(
        "{}: no position is left: all {} are nearer than {:.3g} m ({:.3g} patch radii) to what is "
        "held; lower 'clearance'",
        wanted.positions[0].place, travelling.left_out, clearance, wanted.clearance));
  }
}

}  // namespace

TravellingLoad travelling_load(const BodyDescription& description) {
  if (!description.intrusive) {
    throw Error(fmt::format(
        "{}: has no section [intrusive], which says where the load travels (docs/body.md)",
        description.source.string()));
  }
  const BodyDescription::Intrusive& wanted = *description.intrusive;
  if (!description.parameters.empty()) {
    throw Error(fmt::format("{}: does not go with [[parameter]]", wanted.place));
  }
  BodyDescription with_positions = description;
  with_positions.sites.at = wanted.positions;
  with_positions.sites.linear = false;
  with_positions.press.force = wanted.force;
  TravellingLoad travelling;
  travelling.problem = pose_body(with_positions);
  BodyProblem& problem = travelling.problem;
  if (problem.preload.cols() > 0) {
    throw Error(
        fmt::format("{}: does not go with weight or pressures: the series of the load "
                    "starts from the undeformed body",
                    wanted.place));
  }

  const SurfaceMesh& skin = problem.mesh.boundary.surface;
  travelling.patch_radius = largest_patch_radius(problem.sites, skin);
  keep_clear(wanted, travelling);
  const Eigen::VectorXd areas = vertex_areas(skin);
  travelling.area.resize(static_cast<Index>(problem.sites.size()));
  for (std::size_t s = 0; s < problem.sites.size(); ++s) {
    problem.sites[s].full_load = wanted.force;
    travelling.area[static_cast<Index>(s)] = areas[problem.sites[s].vertex];
  }
  travelling.load = forces_of(problem, problem.sites, wanted.force);
  if (!wanted.reactions.empty()) {
    with_positions.sites.at = wanted.reactions;
    travelling.reaction_sites = pose_body(with_positions).sites;
    for (Site& site : travelling.reaction_sites) {
      site.direction = -site.direction;
      site.full_load = wanted.force;
    }
    travelling.reaction = forces_of(problem, travelling.reaction_sites, wanted.force);
  }
  return travelling;
}

}  // namespace palpable

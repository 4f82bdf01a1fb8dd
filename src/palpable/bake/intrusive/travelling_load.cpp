#include "palpable/bake/intrusive/travelling_load.h"

#include "palpable/common/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
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
  for (const Site& site : problem.sites) {
    for (const int v : site.patch) {
      travelling.patch_radius = std::max(
          travelling.patch_radius, (skin.vertices.col(v) - skin.vertices.col(site.vertex)).norm());
    }
  }
  const double clearance = wanted.clearance * travelling.patch_radius;
  std::vector<Site> positions;
  for (Site& site : problem.sites) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const int n : problem.mesh.fixed_nodes) {
      nearest = std::min(nearest,
                         (problem.mesh.mesh.nodes.col(n) - skin.vertices.col(site.vertex)).norm());
    }
    if (nearest <= clearance) {
      ++travelling.left_out;
      continue;
    }
    site.full_load = wanted.force;
    positions.push_back(std::move(site));
  }
  if (positions.empty()) {
    throw Error(fmt::format(
        "{}: no position is left: all {} are nearer than {:.3g} m ({:.3g} patch radii) to what is "
        "held; lower 'clearance'",
        wanted.positions[0].place, travelling.left_out, clearance, wanted.clearance));
  }
  problem.sites = std::move(positions);

  const Eigen::VectorXd areas = vertex_areas(skin);
  travelling.area.resize(static_cast<Index>(problem.sites.size()));
  for (std::size_t s = 0; s < problem.sites.size(); ++s) {
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

#include "palpable/bake/bake_body.h"

#include "palpable/bake/body_problem.h"
#include "palpable/base/contract.h"
#include "palpable/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// (c N) the weight of each value so that the norm is an integral over the body: the node's volume,
// and for stress twice that where a component stands for two equal ones (xy and yx).
VectorXd value_weights(const TetMesh& mesh, const VectorXd& component_weights) {
  const VectorXd volumes = nodal_volumes(mesh);
  return (component_weights * volumes.transpose()).reshaped();
}

// The rows of the boundary's nodes, `components` per node.
MatrixXd boundary_rows(const MatrixXd& values, const Boundary& boundary, int components) {
  MatrixXd rows(static_cast<Index>(boundary.node_of_vertex.size()) * components, values.cols());
  Index row = 0;
  for (const int node : boundary.node_of_vertex) {
    rows.middleRows(row, components) = values.middleRows(Index{node} * components, components);
    row += components;
  }
  return rows;
}

// The body at rest is level 0 and no snapshot: there every level function is 0.
SeparatedField as_field(const SeparatedTensor& separated, const VectorXd& levels,
                        const Boundary& boundary, int components) {
  const Index S = separated.G[0].rows(), L = separated.G[1].rows(), m = separated.F.cols();
  ParameterAxis site{"site", VectorXd::LinSpaced(S, 0.0, static_cast<double>(S - 1)),
                     separated.G[0], Between::kNothing};
  ParameterAxis level{"level", levels, MatrixXd::Zero(L + 1, m), Between::kSmooth};
  level.functions.bottomRows(L) = separated.G[1];
  return {boundary_rows(separated.F, boundary, components).cast<float>(),
          {std::move(site), std::move(level)}};
}

double largest_evaluation_error(const SeparatedField& field, const MatrixXd& snapshots,
                                const Boundary& boundary, int components) {
  const MatrixXd truth = boundary_rows(snapshots, boundary, components);
  const ParameterAxis& site = field.axes()[0];
  const ParameterAxis& level = field.axes()[1];
  const Index L = level.samples.size() - 1;
  std::vector<float> values(static_cast<std::size_t>(field.value_count()));
  const Eigen::Map<const Eigen::VectorXf> evaluated(values.data(), field.value_count());
  double largest = 0;
  for (Index s = 0; s < site.samples.size(); ++s) {
    for (Index l = 0; l < L; ++l) {
      const double mu[2] = {site.samples[s], level.samples[l + 1]};
      field.evaluate(mu, values);
      largest = std::max(largest,
                         (evaluated.cast<double>() - truth.col(s * L + l)).cwiseAbs().maxCoeff());
    }
  }
  return largest / truth.cwiseAbs().maxCoeff();
}

struct ReducedField {
  SeparatedField field;
  ReductionReport report;
};

ReducedField reduce_field(const char* name, const SnapshotTensor& snapshots,
                          const VectorXd& component_weights, const Campaign& campaign,
                          const BodyMesh& mesh, const BodyDescription::Reduction& settings,
                          const Progress& progress) {
  const GreedySettings greedy{.tolerance = settings.tolerance, .max_modes = settings.max_modes};
  const Progress named = [&](const ProgressReport& r) {
    report(progress, {fmt::format("reducing {}", name), r.done, r.total, r.note});
  };
  const GreedyResult result =
      separate(snapshots, value_weights(mesh.mesh, component_weights), greedy, named);
  const int components = static_cast<int>(component_weights.size());
  ReducedField reduced{as_field(result.separated, campaign.levels, mesh.boundary, components), {}};
  reduced.report.errors = result.errors;
  reduced.report.reached = result.reached;
  reduced.report.pooled = result.error;
  reduced.report.worst = result.snapshot_errors.maxCoeff();
  reduced.report.evaluated_worst =
      largest_evaluation_error(reduced.field, snapshots.values, mesh.boundary, components);
  return reduced;
}

// Loads point to the centre of mass: a site pressed beyond it would come out on the other side, and
// the solver, which knows no contact of a body with itself, would let it.
void refuse_press_through(const BodyDescription& description, const SurfaceMesh& skin,
                          const std::vector<Site>& sites, double press, double height) {
  const Eigen::Vector3d centre = enclosed_centroid(skin);
  double nearest = std::numeric_limits<double>::infinity();
  for (const Site& site : sites) {
    nearest = std::min(nearest, (centre - skin.vertices.col(site.vertex)).norm());
  }
  if (press < nearest) return;
  throw Error(fmt::format(
      "{}: a press of {:.3g} m ({:.3g} of the height) would push a site past the centre of "
      "mass, {:.3g} "
      "m away: no load reaches that; ask for a depth below {:.2g}",
      description.source.string(), press, press / height, nearest, nearest / height));
}

std::string materials_line(const BodyDescription& description) {
  std::string line = material_line(description.material);
  for (const BodyDescription::MaterialPart& part : description.groups) {
    line += fmt::format("; a part of it {}", material_line(part.material));
  }
  return line;
}

std::string loads_line(const BodyDescription& description, const BodyMesh& mesh,
                       const Campaign& campaign) {
  const BodyDescription::Sites& sites = description.sites;
  const auto reached = std::count_if(campaign.outcomes.begin(), campaign.outcomes.end(),
                                     [](const SiteOutcome& o) { return o.reached_press; });
  const std::string where =
      sites.at.empty() ? fmt::format("farthest points above {:.3g} of the height", sites.above)
                       : std::string("at the places given");
  std::string direction = "to the centre of mass";
  if (std::holds_alternative<BodyDescription::Sites::AlongNormal>(sites.direction)) {
    direction = "along the inward normal of the patch";
  } else if (const auto* given = std::get_if<Eigen::Vector3d>(&sites.direction)) {
    direction =
        fmt::format("along ({:.3g}, {:.3g}, {:.3g})", (*given)[0], (*given)[1], (*given)[2]);
  }
  const BodyDescription::Press& press = description.press;
  const std::string range =
      press.force ? fmt::format("a force of {:.4g} N; {} sites bear it", *press.force, reached)
                  : fmt::format("a press of {:.4g} m; {} sites reach it",
                                press.length.value_or(press.depth * mesh.height), reached);
  return fmt::format("{} sites, {}, patches of graph distance {}, dead loads {}, {} levels to {}",
                     campaign.sites.size(), where, sites.patch, direction,
                     campaign.levels.size() - 1, range);
}

// Empty where nothing acts on the body but presses.
std::string preload_line(const BodyDescription& description, const Campaign& campaign) {
  if (campaign.rest.isZero(0.0)) return {};
  std::string line;
  if (const auto& gravity = description.gravity) {
    const Eigen::Vector3d& g = gravity->acceleration;
    line += fmt::format("weight at {:.4g} kg/m^3 and ({:.4g}, {:.4g}, {:.4g}) m/s^2, ",
                        gravity->density, g[0], g[1], g[2]);
  }
  for (const BodyDescription::Pressure& pressure : description.pressures) {
    line += fmt::format("a pressure of {:.4g} Pa, ", pressure.pressure);
  }
  return fmt::format(
      "{}and what supports move, first and in full: nodes move by up to {:.4g} m. The surface is "
      "that of the body so loaded; displacement and stress are what a press adds",
      line, campaign.rest.colwise().norm().maxCoeff());
}

std::string reduction_line(const char* what, int modes, const ReductionReport& report,
                           double tolerance) {
  return fmt::format(
      "{}: {} modes, relative L2 error over the volume {:.3g} pooled (asked {:.3g}{}), {:.3g} at "
      "the worst snapshot in its own norm",
      what, modes, report.pooled, tolerance, report.reached ? "" : ", not reached", report.worst);
}

void add_provenance(const BodyDescription& description, const BakeSettings& settings,
                    const BodyMesh& mesh, const Campaign& campaign, BakedBody& baked) {
  const auto add = [&](const char* key, std::string value) {
    baked.body.provenance.emplace_back(key, std::move(value));
  };
  const BakeReport& report = baked.report;
  add("description", description.source.filename().string());
  add("mesh source", mesh.origin);
  add("mesh", fmt::format("{} nodes, {} {}-node tetrahedra, boundary {} vertices, {} triangles; "
                          "dihedral angles {:.1f} to {:.1f} degrees, volume {:.4g} m^3",
                          report.nodes, report.tets, mesh.mesh.is_quadratic() ? 10 : 4,
                          report.vertices, report.triangles, mesh.quality.smallest_dihedral_degrees,
                          mesh.quality.largest_dihedral_degrees, mesh.quality.volume));
  add("material", baked.body.material);
  add("support", fmt::format("{} nodes are held in all directions, {} in some or moved",
                             mesh.fixed_nodes.size(), mesh.supports.size()));
  const std::string preload = preload_line(description, campaign);
  if (!preload.empty()) add("preload", preload);
  add("loads", loads_line(description, mesh, campaign));
  add("solver", fmt::format("total Lagrangian {}-node tetrahedra, Newton with conjugate gradients "
                            "preconditioned by a sparse Cholesky factor",
                            mesh.mesh.is_quadratic() ? 10 : 4));
  add("reduction",
      "non-intrusive PGD over site and level, all functions updated after each mode, space "
      "weighted "
      "by nodal volume");
  const double tolerance = description.reduction.tolerance;
  add("displacement", reduction_line("displacement", baked.body.displacement.mode_count(),
                                     report.displacement, tolerance));
  add("stress", reduction_line("nodal Cauchy stress", baked.body.stress.mode_count(), report.stress,
                               tolerance));
  if (!settings.version.empty()) add("program", settings.version);
  if (!settings.command_line.empty()) add("command line", settings.command_line);
}

}  // namespace

BakedBody reduce_campaign(const Campaign& campaign, const BodyMesh& mesh,
                          const BodyDescription::Reduction& settings, const Progress& progress) {
  ReducedField u = reduce_field("displacement", campaign.displacement, VectorXd::Ones(3), campaign,
                                mesh, settings, progress);
  ReducedField sigma =
      reduce_field("stress", campaign.stress, (VectorXd(6) << 1, 1, 1, 2, 2, 2).finished(),
                   campaign, mesh, settings, progress);
  // The body at rest lies there as its preload leaves it.
  SurfaceMesh surface = mesh.boundary.surface;
  surface.vertices += campaign.rest(Eigen::all, mesh.boundary.node_of_vertex);
  BakedBody baked{ReducedBody{.name = {},
                              .surface = std::move(surface),
                              .fixed = fixed_vertices(mesh),
                              .sites = campaign.sites,
                              .displacement = std::move(u.field),
                              .stress = std::move(sigma.field),
                              .press_depth = campaign.press_depth,
                              .largest_von_mises = campaign.largest_von_mises,
                              .error = {u.report.pooled, u.report.worst, sigma.report.pooled,
                                        sigma.report.worst},
                              .material = {},
                              .provenance = {}},
                  {}};
  baked.report.displacement = std::move(u.report);
  baked.report.stress = std::move(sigma.report);
  return baked;
}

BakedBody bake_body(const BodyDescription& description, const BakeSettings& settings,
                    const Progress& progress) {
  StageTimes wall;
  const auto timed = [&](const char* stage, auto&& work) {
    const StageTimer timer(wall, stage);
    return work();
  };
  report(progress, {"meshing", 0.0, 1.0, ""});
  BodyProblem problem = timed("mesh", [&] { return pose_body(description); });
  const BodyMesh& mesh = problem.mesh;
  report(progress,
         {"meshing", 1.0, 1.0,
          fmt::format("{} nodes, {} tetrahedra", mesh.mesh.node_count(), mesh.mesh.tet_count())});
  if (std::holds_alternative<BodyDescription::Sites::ToCentre>(description.sites.direction)) {
    refuse_press_through(description, mesh.boundary.surface, problem.sites, problem.press,
                         mesh.height);
  }
  const EquilibriumSolver solver =
      timed("factor", [&] { return EquilibriumSolver(std::move(problem.model)); });
  const Campaign campaign = timed("campaign", [&] {
    try {
      return run_campaign(solver, mesh.boundary, problem.sites,
                          {.press = problem.press,
                           .force = problem.force,
                           .levels = description.press.levels,
                           .preload = problem.preload,
                           .threads = settings.threads},
                          progress);
    } catch (const Error& error) {
      throw Error(fmt::format("{}: {}", description.source.string(), error.what()));
    }
  });
  BakedBody baked = timed(
      "reduce", [&] { return reduce_campaign(campaign, mesh, description.reduction, progress); });
  baked.body.name = description.name;
  baked.body.material = materials_line(description);
  BakeReport& made = baked.report;
  made.nodes = mesh.mesh.node_count();
  made.tets = mesh.mesh.tet_count();
  made.vertices = mesh.boundary.surface.vertex_count();
  made.triangles = mesh.boundary.surface.triangle_count();
  made.outcomes = campaign.outcomes;
  made.wall = wall;
  made.threads = campaign.times;
  add_provenance(description, settings, mesh, campaign, baked);
  return baked;
}

}  // namespace palpable

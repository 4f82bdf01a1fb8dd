#include "palpable/bake/campaign/fill_store.h"

#include "palpable/bake/campaign/press_solver.h"
#include "palpable/bake/describe/material_warnings.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <variant>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

std::string loads_line(const BodyDescription& description, const BodyMesh& mesh,
                       std::size_t site_count) {
  const BodyDescription::Sites& sites = description.sites;
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
      press.force
          ? fmt::format("a force of {:.4g} N", *press.force)
          : fmt::format("a press of {:.4g} m", press.length.value_or(press.depth * mesh.height));
  return fmt::format("{} sites, {}, patches of graph distance {}, dead loads {}, {} levels to {}",
                     site_count, where, sites.patch, direction, press.levels, range);
}

void vary(BodyDescription::MaterialLaw& law, const BodyDescription::Parameter& parameter,
          double value) {
  using What = BodyDescription::Parameter::What;
  if (parameter.what == What::kYoung) law.young = value;
  if (parameter.what == What::kPoisson) law.poisson = value;
  if (parameter.what != What::kStiffness) return;
  law.young *= value;
  for (std::size_t k = 0; k < law.constants.size(); ++k) {
    law.constants[k] *= law_constants(law.law)[k].per_pressure ? 1.0 / value : value;
  }
}

// Empty where nothing acts on the body but presses.
std::string preload_line(const BodyDescription& description) {
  std::string line;
  if (const auto& gravity = description.gravity) {
    const Eigen::Vector3d& g = gravity->acceleration;
    line += fmt::format("weight at {:.4g} kg/m^3 and ({:.4g}, {:.4g}, {:.4g}) m/s^2, ",
                        gravity->density, g[0], g[1], g[2]);
  }
  for (const BodyDescription::Pressure& pressure : description.pressures) {
    line += fmt::format("a pressure of {:.4g} Pa, ", pressure.pressure);
  }
  const bool moves =
      std::any_of(description.supports.begin(), description.supports.end(),
                  [](const BodyDescription::Support& s) { return !s.displacement.isZero(0.0); });
  if (line.empty() && !moves) return {};
  return line + "and what supports move, first and in full";
}

// (P) The materials of the body at each combination of the parameters' values.
std::vector<PointMaterials> points_of(const BodyDescription& description) {
  std::size_t P = 1;
  for (const BodyDescription::Parameter& parameter : description.parameters) {
    P *= parameter.values.size();
  }
  std::vector<PointMaterials> points;
  for (std::size_t p = 0; p < P; ++p) {
    BodyDescription here = description;
    std::size_t rest = p;
    for (std::size_t k = description.parameters.size(); k-- > 0;) {
      const BodyDescription::Parameter& parameter = description.parameters[k];
      BodyDescription::MaterialLaw& law =
          parameter.group < 0 ? here.material : here.groups[parameter.group].material;
      vary(law, parameter, parameter.values[rest % parameter.values.size()]);
      rest /= parameter.values.size();
    }
    try {
      PointMaterials point{material_of(here.material), {}};
      for (const auto& group : here.groups) point.groups.push_back(material_of(group.material));
      points.push_back(std::move(point));
    } catch (const Error& error) {
      throw Error(fmt::format("{}: {}", description.parameters[0].place, error.what()));
    }
  }
  return points;
}

// Replaces the levels of a campaign's plan by those half way between them.
void hold_out(const SnapshotStore& campaign, CampaignPlan& plan, StoreContent& content) {
  if (campaign.content().keys != content.keys) {
    throw Error(fmt::format("{}: is of another campaign than this description's",
                            campaign.folder().string()));
  }
  for (int u = 0; u < campaign.content().unit_count(); ++u) {
    const std::string why = campaign.why_not(u);
    if (!why.empty()) throw Error(fmt::format("{}: {}", campaign.unit_file(u).string(), why));
    plan.full_loads.push_back(campaign.unit(u).full_load);
  }
  const int L = content.level_count();
  for (int m = 0; m < L; ++m) {
    plan.run.at.push_back((m + 0.5) / L);
    content.levels[m + 1] = plan.run.at.back();
  }
  plan.linear.clear();
  content.keys = unit_keys(plan);
}

// The plan of all sites, levels and points of `problem`, which is moved from.
CampaignPlan plan_of(const BodyDescription& description, BodyProblem&& problem,
                     const FillSettings& settings) {
  return {.model = std::move(problem.model),
          .boundary = problem.mesh.boundary,
          .sites = std::move(problem.sites),
          .linear = std::move(problem.linear_sites),
          .run = {.press = problem.press,
                  .force = problem.force,
                  .levels = description.press.levels,
                  .range = problem.press_range},
          .preload = std::move(problem.preload),
          .points = points_of(description),
          .solver = settings.solver};
}

std::string solver_line(FeSolver solver, bool quadratic) {
  const int nodes = quadratic ? 10 : 4;
  if (solver == FeSolver::kCalculix) {
    return fmt::format("CalculiX (ccx), {}-node tetrahedra; loads found by the own solver", nodes);
  }
  return fmt::format(
      "total Lagrangian {}-node tetrahedra, Newton with conjugate gradients "
      "preconditioned by a sparse Cholesky factor",
      nodes);
}

BodyProblem mesh_and_pose(const BodyDescription& description, StageTimes& wall,
                          const Progress& progress) {
  report(progress, {"meshing", 0.0, 1.0, ""});
  BodyProblem problem = [&] {
    const StageTimer timer(wall, "mesh");
    return pose_body(description);
  }();
  const BodyMesh& mesh = problem.mesh;
  report(progress,
         {"meshing", 1.0, 1.0,
          fmt::format("{} nodes, {} tetrahedra", mesh.mesh.node_count(), mesh.mesh.tet_count())});
  refuse_press_through(description, problem);
  refuse_beyond_range(description, problem);
  return problem;
}

}  // namespace

std::string materials_line(const BodyDescription& description) {
  std::string line = material_line(description.material);
  for (const BodyDescription::MaterialPart& part : description.groups) {
    line += fmt::format("; a part of it {}", material_line(part.material));
  }
  return line;
}

std::vector<StoredParameter> stored_parameters(const BodyDescription& description) {
  std::vector<StoredParameter> parameters;
  for (const BodyDescription::Parameter& parameter : description.parameters) {
    parameters.push_back(
        {parameter.name, Eigen::Map<const VectorXd>(parameter.values.data(),
                                                    static_cast<Index>(parameter.values.size()))});
  }
  return parameters;
}

StoreContent content_of(const BodyDescription& description, const BodyProblem& problem) {
  const BodyMesh& mesh = problem.mesh;
  StoreContent content;
  content.name = description.name;
  content.material = materials_line(description);
  content.mesh = mesh.mesh;
  content.fixed = fixed_vertices(mesh);
  content.materials = {problem.model.material};
  for (const MaterialGroup& group : problem.model.groups) {
    content.materials.push_back(group.material);
  }
  content.material_of_element = material_groups(problem.model);
  for (int& material : content.material_of_element) ++material;  // -1: the body's own
  content.sites = problem.sites;
  content.parameters = stored_parameters(description);
  content.reduction = description.reduction;
  content.provenance = {
      .description = description.source.filename().string(),
      .mesh_source = mesh.origin,
      .credit = description.shape.credit,
      .credit_url = description.shape.credit_url,
      .terms = description.shape.terms,
      .mesh = fmt::format("{} nodes, {} {}-node tetrahedra, boundary {} vertices, {} triangles; "
                          "dihedral angles {:.1f} to {:.1f} degrees, volume {:.4g} m^3",
                          mesh.mesh.node_count(), mesh.mesh.tet_count(),
                          mesh.mesh.is_quadratic() ? 10 : 4, mesh.boundary.surface.vertex_count(),
                          mesh.boundary.surface.triangle_count(),
                          mesh.quality.smallest_dihedral_degrees,
                          mesh.quality.largest_dihedral_degrees, mesh.quality.volume),
      .material = content.material,
      .support = fmt::format("{} nodes are held in all directions, {} in some or moved",
                             mesh.fixed_nodes.size(), mesh.supports.size()),
      .preload = preload_line(description)};
  return content;
}

FilledStore fill_store(const BodyDescription& description, const FillSettings& settings, Crew& crew,
                       const Progress& progress) {
  PALPABLE_EXPECT(!settings.store.empty(), "snapshots have a place");
  StageTimes wall;
  BodyProblem problem = mesh_and_pose(description, wall, progress);
  StoreContent content = content_of(description, problem);
  content.levels = VectorXd::LinSpaced(description.press.levels + 1, 0.0, 1.0);
  content.provenance.loads = loads_line(description, problem.mesh, content.sites.size());
  content.provenance.solver = solver_line(settings.solver, problem.mesh.mesh.is_quadratic());
  CampaignPlan plan = plan_of(description, std::move(problem), settings);
  content.keys = unit_keys(plan);
  if (settings.held_out_of != nullptr) hold_out(*settings.held_out_of, plan, content);
  for (const Site& site : plan.linear) content.linear.push_back(site.vertex);
  if (!plan.linear.empty()) content.linear_key = linear_key(plan);
  std::optional<StageTimer> timer(std::in_place, wall, "campaign");
  std::optional<SetAside> set_aside;
  if (crew.leads()) set_aside = set_aside_other_campaign(settings.store, content);
  SnapshotStore store = crew.leads() ? SnapshotStore::create(settings.store, std::move(content))
                                     : SnapshotStore::attach(settings.store, std::move(content));
  std::unique_ptr<FolderLock> held;
  if (crew.leads()) {
    held = std::make_unique<FolderLock>(settings.store, Holding::kWithOthers);
    require_own_campaign(settings.store, store.content());
  }
  try {
    CampaignReport campaign = run_campaign(
        plan, store, crew,
        {.threads = settings.threads, .shard = settings.shard, .shards = settings.shards},
        progress);
    timer.reset();
    return {std::move(store),     std::move(plan), campaign, wall,
            std::move(set_aside), std::move(held)};
  } catch (const PreloadError& error) {
    throw Error(fmt::format("{}: {}; it is {}", description.source.string(), error.what(),
                            preload_words(description)));
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", description.source.string(), error.what()));
  }
}

}  // namespace palpable

#include "palpable/bake/describe/body_problem.h"

#include "palpable/bake/describe/contact_sites.h"
#include "palpable/bake/describe/places.h"
#include "palpable/bake/describe/touches_between.h"
#include "palpable/bake/solid/loads.h"
#include "palpable/bake/solid/selection.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/geometry/size_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>
#include <variant>

namespace palpable {

using Eigen::Matrix3Xd;

namespace {

// How far a node may follow a press by depth, ratio to the depth. The tip of a post that is pressed
// near its foot moves by up to 4.4 times the depth (bodies/post-small.toml).
constexpr double kFollows = 6.0;

// (V) The values at the vertices of the skin, from values at all nodes.
std::vector<std::uint8_t> at_skin(const std::vector<std::uint8_t>& nodes, const Boundary& skin) {
  std::vector<std::uint8_t> vertices;
  for (const int n : skin.node_of_vertex) vertices.push_back(nodes[n]);
  return vertices;
}

// (V) The area of each node, int N_a dA. On 10-node elements a corner has none, and the middle of
// an edge has a third of each face there.
Eigen::VectorXd nodal_areas(const BodyMesh& body) {
  const Matrix3Xd unit =
      traction_load(body.mesh, skin_triangles(body.mesh),
                    [](const Eigen::Vector3d&, const Eigen::Vector3d&) -> Eigen::Vector3d {
                      return Eigen::Vector3d::UnitX();
                    });
  const Eigen::VectorXd areas = unit.row(0).transpose()(body.boundary.node_of_vertex);
  // Corners are near 0 by rounding, and a little below on curved faces.
  return (areas.array() > 1e-9 * areas.maxCoeff()).select(areas, 0.0);
}

SiteSettings site_settings(const BodyDescription& description, const BodyMesh& body) {
  const BodyDescription::Sites& wanted = description.sites;
  SiteSettings settings{.choice = wanted.salient ? SiteChoice::kSalient : SiteChoice::kSpread,
                        .count = wanted.count,
                        .lowest = wanted.above * body.height,
                        .patch_distance = wanted.patch};
  if (std::holds_alternative<BodyDescription::Sites::AlongNormal>(wanted.direction)) {
    settings.direction = SiteDirection::kAlongNormal;
  } else if (const auto* given = std::get_if<Eigen::Vector3d>(&wanted.direction)) {
    settings.direction = SiteDirection::kGiven;
    settings.given = *given;
  }
  if (body.mesh.is_quadratic()) settings.areas = nodal_areas(body);
  return settings;
}

// (V) 1 where a support holds the vertex in any direction.
std::vector<std::uint8_t> supported_vertices(const BodyMesh& body) {
  std::vector<std::uint8_t> held = held_nodes(body);
  for (const Support& support : body.supports) held[support.node] = 1;
  return at_skin(held, body.boundary);
}

// See BodyProblem::linear_sites. The touches between sites measure the error of a touch that is not
// at a site.
std::vector<Site> linear_sites(const BodyDescription& description, const BodyMesh& body,
                               const std::vector<Site>& sites) {
  if (!description.parameters.empty()) return {};
  const SurfaceMesh& skin = body.boundary.surface;
  const std::vector<std::uint8_t> fixed =
      description.sites.linear ? fixed_vertices(body) : supported_vertices(body);
  std::vector<int> vertices;
  for (std::size_t v = 0; v < fixed.size(); ++v) {
    if (fixed[v] == 0) vertices.push_back(static_cast<int>(v));
  }
  const SiteSettings settings = site_settings(description, body);
  if (description.sites.linear) return sites_at(skin, fixed, vertices, settings);
  std::vector<int> places;
  for (const Site& site : sites) places.push_back(site.vertex);
  const std::vector<int> touches = touches_between(skin, places, vertices, kTouchesBetween);
  if (touches.empty()) return {};
  std::vector<Site> all = sites;
  for (Site& touch : sites_at(skin, fixed, touches, settings)) all.push_back(std::move(touch));
  return all;
}

std::vector<Site> place_sites(const BodyDescription& description, const BodyMesh& body) {
  const BodyDescription::Sites& wanted = description.sites;
  const SiteSettings settings = site_settings(description, body);
  const SurfaceMesh& skin = body.boundary.surface;
  if (wanted.at.empty()) {
    // A site whose patch reaches a support is not chosen: the support would take part of its load.
    try {
      return choose_sites(skin, supported_vertices(body), settings);
    } catch (const Error& error) {
      throw Error(fmt::format("{}: {}", description.source.string(), error.what()));
    }
  }

  std::vector<int> vertex_of_node(body.mesh.node_count(), -1);
  for (int v = 0; v < skin.vertex_count(); ++v) {
    vertex_of_node[body.boundary.node_of_vertex[v]] = v;
  }
  const std::vector<std::uint8_t> fixed = fixed_vertices(body);
  std::vector<Site> sites;
  for (const Where& where : wanted.at) {
    std::vector<int> vertices;
    if (const auto* nearest = std::get_if<Where::Nearest>(&where.what)) {
      try {
        refuse_far_points(body.mesh, nearest->points, PointsMayLie::kNearTheSkin);
      } catch (const Error& error) {
        throw Error(fmt::format("{}: {}", where.place, error.what()));
      }
      for (const Eigen::Vector3d& point : nearest->points) {
        Eigen::Index vertex = 0;
        (skin.vertices.colwise() - point).colwise().squaredNorm().minCoeff(&vertex);
        vertices.push_back(static_cast<int>(vertex));
      }
    } else {
      for (const int n : nodes_at({body.mesh, body.sets}, where)) {
        const int v = vertex_of_node[n];
        if (v >= 0) vertices.push_back(v);
      }
      if (vertices.empty()) {
        throw Error(fmt::format("{}: none of its nodes lies on the skin of the body", where.place));
      }
    }
    try {
      for (Site& site : sites_at(skin, fixed, vertices, settings)) sites.push_back(std::move(site));
    } catch (const Error& error) { throw Error(fmt::format("{}: {}", where.place, error.what())); }
  }
  for (std::size_t a = 0; a < sites.size(); ++a) {
    for (std::size_t b = a + 1; b < sites.size(); ++b) {
      if (sites[a].vertex != sites[b].vertex) continue;
      throw Error(
          fmt::format("{}: sites {} and {} are the same vertex of the skin; leave one out, "
                      "or mesh finer",
                      wanted.at.back().place, a, b));
    }
  }
  return sites;
}

void add_groups(const BodyDescription& description, const VolumeMesh& volume, SolidModel& model) {
  std::vector<int> group_of(volume.mesh.tet_count(), -1);
  for (std::size_t g = 0; g < description.groups.size(); ++g) {
    const BodyDescription::MaterialPart& part = description.groups[g];
    model.groups.push_back({material_of(part.material), tets_at(volume, part.where)});
    int shared = 0, other = -1;
    for (const int e : model.groups.back().elements) {
      int& group = group_of[e];
      if (group >= 0) {
        ++shared;
        other = group;
      }
      group = static_cast<int>(g);
    }
    if (shared == 0) continue;
    throw Error(fmt::format(
        "{}: {} elements of this group are in another one already ({}); an element is in one group "
        "at most: let the places not overlap",
        part.where.place, shared, description.groups[other].where.place));
  }
}

Matrix3Xd preload_of(const BodyDescription& description, const VolumeMesh& volume) {
  if (!description.gravity && description.pressures.empty()) return Matrix3Xd(3, 0);
  Matrix3Xd load = Matrix3Xd::Zero(3, volume.mesh.node_count());
  if (const auto& gravity = description.gravity) {
    load += gravity_load(volume.mesh, gravity->density, gravity->acceleration);
  }
  for (const BodyDescription::Pressure& pressure : description.pressures) {
    load += pressure_load(volume.mesh, faces_at(volume, pressure.where), pressure.pressure);
  }
  return load;
}

// Refuses what the solver would refuse, with messages that name files and keys.
void refuse_unsolvable(const BodyDescription& description, const SolidModel& model) {
  SolidModel held = model;
  held.supports.clear();
  held.fixed_displacement.resize(3, 0);
  held.fixed_nodes.resize(model.mesh.node_count());
  std::iota(held.fixed_nodes.begin(), held.fixed_nodes.end(), 0);
  try {
    check_model(held);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", description.shape.file.string(), error.what()));
  }
  try {
    check_model(model);
  } catch (const Error& error) {
    throw Error(
        fmt::format("{} does not hold the body: {}", description.supports_place, error.what()));
  }
  if (static_cast<Eigen::Index>(held_components(model).size()) == model.mesh.nodes.size()) {
    throw Error(fmt::format("{} holds every node of the body: nothing could move",
                            description.supports_place));
  }
}

}  // namespace

std::vector<std::uint8_t> fixed_vertices(const BodyMesh& mesh) {
  return at_skin(held_nodes(mesh), mesh.boundary);
}

Material material_of(const BodyDescription::MaterialLaw& law) {
  return law.constants.empty() ? material_from_young(law.law, law.young, law.poisson)
                               : material_from_constants(law.law, law.constants);
}

std::string material_line(const BodyDescription::MaterialLaw& law) {
  const auto [young, poisson] = young_poisson(material_of(law));
  std::string constants;
  for (std::size_t k = 0; k < law.constants.size(); ++k) {
    const LawConstant& constant = law_constants(law.law)[k];
    constants += fmt::format("{} = {} {}, ", constant.name, number_text(law.constants[k]),
                             constant.per_pressure ? "1/Pa" : "Pa");
  }
  return fmt::format("{}, {}Young's modulus {} Pa, Poisson's ratio {}", law.law, constants,
                     number_text(young), poisson_text(poisson));
}

std::string problem_text(const BodyDescription& description, const BodyProblem& problem) {
  const TetMesh& mesh = problem.model.mesh;
  std::string text = fmt::format("{}: {} nodes, {} tetrahedra of {} nodes; {}\n", description.name,
                                 mesh.node_count(), mesh.tet_count(), mesh.is_quadratic() ? 10 : 4,
                                 material_line(description.material));
  text += fmt::format("held: {} nodes in all directions", problem.model.fixed_nodes.size());
  if (const std::size_t some = problem.model.supports.size(); some > 0) {
    text += fmt::format(", {} in some or moved", some);
  }
  text += "\n";
  for (const BodyDescription::MaterialPart& part : description.groups) {
    text += fmt::format("a part of it: {}\n", material_line(part.material));
  }
  return text;
}

std::string site_text(const BodyProblem& problem, int number) {
  const Site& site = problem.sites[number];
  const Eigen::Vector3d X = problem.mesh.boundary.surface.vertices.col(site.vertex);
  return fmt::format(
      "site {} at ({:.4g}, {:.4g}, {:.4g}) m, pressed along ({:.3f}, {:.3f}, {:.3f})", number, X[0],
      X[1], X[2], site.direction[0], site.direction[1], site.direction[2]);
}

void refuse_press_through(const BodyDescription& description, const BodyProblem& problem) {
  if (!std::holds_alternative<BodyDescription::Sites::ToCentre>(description.sites.direction))
    return;
  const SurfaceMesh& skin = problem.mesh.boundary.surface;
  const Eigen::Vector3d centre = enclosed_centroid(skin);
  double nearest = std::numeric_limits<double>::infinity();
  int which = 0;
  for (std::size_t s = 0; s < problem.sites.size(); ++s) {
    const double distance = (centre - skin.vertices.col(problem.sites[s].vertex)).norm();
    if (distance >= nearest) continue;
    nearest = distance;
    which = static_cast<int>(s);
  }
  if (problem.press < nearest) return;
  const double height = problem.mesh.height;
  throw Error(fmt::format(
      "{}: a press of {:.3g} m ({:.3g} of the height, 'depth' in [press]) would push {}, past the "
      "centre of mass, {:.3g} m away: no load reaches that; ask for a depth below {:.2g}",
      description.source.string(), problem.press, problem.press / height, site_text(problem, which),
      nearest, nearest / height));
}

void refuse_beyond_range(const BodyDescription& description, const BodyProblem& problem) {
  const double range = problem.model.largest_displacement;
  if (problem.press <= range) return;
  throw Error(fmt::format(
      "{}: a press of {:.4g} mm ('depth' in [press]) moves the patch by more than {:.4g} mm, the "
      "range of the model ({}): press less, or give a larger 'range' in [press]",
      description.source.string(), 1e3 * problem.press, 1e3 * range, range_words(description)));
}

std::string range_words(const BodyDescription& description) {
  const BodyDescription::Press& press = description.press;
  if (press.range_length) return "'range' in [press]";
  if (press.has_usual_range()) { return "a third of the body's largest extent"; }
  return fmt::format("{} of the body's largest extent", number_text(press.range));
}

BodyProblem pose_body(const BodyDescription& description) {
  return pose_body(description, make_body_mesh(description));
}

BodyProblem pose_body(const BodyDescription& description, BodyMesh mesh) {
  BodyProblem problem;
  problem.mesh = std::move(mesh);
  const BodyMesh& body = problem.mesh;
  const VolumeMesh volume{body.mesh, body.sets};
  problem.model.mesh = body.mesh;
  problem.model.material = material_of(description.material);
  add_groups(description, volume, problem.model);
  problem.model.fixed_nodes = body.fixed_nodes;
  problem.model.supports = body.supports;
  const Eigen::Vector3d extent = extent_of(body.mesh.nodes);
  problem.model.largest_displacement =
      description.press.range_length.value_or(description.press.range * extent.maxCoeff());
  refuse_unsolvable(description, problem.model);
  problem.preload = preload_of(description, volume);
  problem.sites = place_sites(description, body);
  problem.linear_sites = linear_sites(description, body, problem.sites);
  problem.force = description.press.force.value_or(0.0);
  if (problem.force == 0.0) {
    problem.press = description.press.length.value_or(description.press.depth * body.height);
  }
  problem.press_range = problem.model.largest_displacement;
  if (description.press.has_usual_range()) {
    problem.press_range = std::max(problem.press_range, kFollows * problem.press);
  }
  return problem;
}

Matrix3Xd unit_load(const Site& site, const Boundary& boundary, int node_count) {
  std::vector<int> nodes;
  std::vector<double> weights;
  for (std::size_t k = 0; k < site.patch.size(); ++k) {
    nodes.push_back(boundary.node_of_vertex[site.patch[k]]);
    weights.push_back(static_cast<double>(site.weights[k]));
  }
  return patch_force(node_count, nodes, weights, site.direction);
}

SolidModel with_edge_nodes(const SolidModel& model) {
  PALPABLE_EXPECT(model.fixed_displacement.cols() == 0 && model.supports.empty(),
                  "a body that is held as descriptions have it");
  SolidModel fine = model;
  fine.mesh = with_edge_nodes(model.mesh);
  fine.fixed_nodes = with_edge_middles(fine.mesh, model.fixed_nodes);
  return fine;
}

Matrix3Xd patch_traction(const Site& site, const Boundary& boundary, int node_count) {
  const Eigen::VectorXd areas = vertex_areas(boundary.surface);
  Matrix3Xd traction = Matrix3Xd::Zero(3, node_count);
  double sum = 0.0;
  for (const float w : site.weights) sum += static_cast<double>(w);
  for (std::size_t k = 0; k < site.patch.size(); ++k) {
    const int v = site.patch[k];
    traction.col(boundary.node_of_vertex[v]) =
        static_cast<double>(site.weights[k]) / (sum * areas[v]) * site.direction.normalized();
  }
  return traction;
}

}  // namespace palpable

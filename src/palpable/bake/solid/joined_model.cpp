#include "palpable/bake/solid/joined_model.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace palpable {

using Eigen::Index;

namespace {

// Appends the columns of `next`, with `offset` added to each entry, to `all`.
template <class Matrix>
void append_numbers(const Matrix& next, int offset, Matrix& all) {
  const Index before = all.cols();
  all.conservativeResize(Eigen::NoChange, before + next.cols());
  all.rightCols(next.cols()) = next.array() + offset;
}

void append_held(const SolidModel& body, const Rigid3& pose, int offset, SolidModel& model) {
  const bool turns = pose.linear() != Eigen::Matrix3d::Identity();
  const auto before = static_cast<Index>(model.fixed_nodes.size());
  for (const int node : body.fixed_nodes) model.fixed_nodes.push_back(node + offset);
  const auto after = static_cast<Index>(model.fixed_nodes.size());
  if (body.fixed_displacement.cols() > 0 || model.fixed_displacement.cols() > 0) {
    const Index had = model.fixed_displacement.cols();
    model.fixed_displacement.conservativeResize(3, after);
    model.fixed_displacement.rightCols(after - had).setZero();
    if (body.fixed_displacement.cols() > 0) {
      model.fixed_displacement.rightCols(after - before) = pose.linear() * body.fixed_displacement;
    }
  }
  for (Support support : body.supports) {
    if (turns && !support.held.all()) {
      throw Error(fmt::format(
          "node {} of a body that is turned is held in some directions only, which would then not "
          "be x, y or z: hold it in all three, or mesh the body as it shall stand",
          support.node));
    }
    support.node += offset;
    support.displacement = pose.linear() * support.displacement;
    model.supports.push_back(support);
  }
}

void append_materials(const SolidModel& body, int offset, bool is_first, SolidModel& model) {
  std::vector<char> grouped(body.mesh.tet_count(), 0);
  for (const MaterialGroup& group : body.groups) {
    MaterialGroup moved = group;
    for (int& element : moved.elements) {
      grouped[element] = 1;
      element += offset;
    }
    model.groups.push_back(std::move(moved));
  }
  if (is_first) {
    model.material = body.material;
    return;
  }
  MaterialGroup rest{body.material, {}};
  for (int e = 0; e < body.mesh.tet_count(); ++e) {
    if (grouped[e] == 0) rest.elements.push_back(e + offset);
  }
  if (!rest.elements.empty()) model.groups.push_back(std::move(rest));
}

}  // namespace

JoinedModel joined(std::span<const SolidModel> bodies, std::span<const Rigid3> world_from_body) {
  PALPABLE_EXPECT(bodies.size() == world_from_body.size(), "a pose for each body");
  JoinedModel result{{}, {0}, {0}};
  SolidModel& model = result.model;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const SolidModel& body = bodies[b];
    if (body.mesh.is_quadratic() != bodies[0].mesh.is_quadratic()) {
      throw Error("some bodies have 4-node and some 10-node tetrahedra: mesh all of them alike");
    }
    const int nodes = result.first_node.back(), tets = result.first_tet.back();
    model.mesh.nodes.conservativeResize(3, nodes + body.mesh.node_count());
    model.mesh.nodes.rightCols(body.mesh.node_count()) = world_from_body[b] * body.mesh.nodes;
    append_numbers(body.mesh.tets, nodes, model.mesh.tets);
    append_numbers(body.mesh.edge_nodes, nodes, model.mesh.edge_nodes);
    append_held(body, world_from_body[b], nodes, model);
    append_materials(body, tets, b == 0, model);
    model.largest_displacement =
        b == 0 ? body.largest_displacement
               : std::max(model.largest_displacement, body.largest_displacement);
    result.first_node.push_back(nodes + body.mesh.node_count());
    result.first_tet.push_back(tets + body.mesh.tet_count());
  }
  return result;
}

}  // namespace palpable

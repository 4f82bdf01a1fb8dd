#include "palpable/bake/touch_bake/shell_maker.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace palpable {
namespace {

// (count) for each number of the mesh its index in the list `some`; -1 if it is not in the list.
std::vector<int> indices_in(const std::vector<int>& some, int count) {
  std::vector<int> place(static_cast<std::size_t>(count), -1);
  for (std::size_t k = 0; k < some.size(); ++k) place[some[k]] = static_cast<int>(k);
  return place;
}

}  // namespace

ShellTable make_shell(const SkinResponse& skin) {
  const SolidModel& model = skin.body().model();
  const TetMesh& mesh = model.mesh;
  ShellTable shell;
  shell.stress_free = mesh.nodes(Eigen::all, skin.shell_nodes());
  shell.preload = skin.body().rest()(Eigen::all, skin.shell_nodes());
  shell.element_nodes = mesh.is_quadratic() ? 10 : 4;
  shell.materials.push_back(model.material);
  for (const MaterialGroup& group : model.groups) shell.materials.push_back(group.material);
  const std::vector<int> groups = material_groups(model);
  const std::vector<int> place = indices_in(skin.shell_nodes(), mesh.node_count());
  for (const int e : skin.shell_elements()) {
    shell.material_of.push_back(groups[e] + 1);
    for (const int n : mesh.tets.col(e)) shell.elements.push_back(place[n]);
    if (!mesh.is_quadratic()) continue;
    for (const int n : mesh.edge_nodes.col(e)) shell.elements.push_back(place[n]);
  }
  const int Q = shell.points_of_element();
  const std::vector<int> number = indices_in(skin.shell_elements(), mesh.tet_count());
  shell.first.push_back(0);
  for (int v = 0; v < skin.vertex_count(); ++v) {
    for (const StressRecovery::Term& term : skin.recovery().terms_of(skin.node_of(v))) {
      shell.points.push_back(Q * number[term.point / Q] + term.point % Q);
      shell.weights.push_back(static_cast<float>(term.weight));
    }
    shell.first.push_back(static_cast<int>(shell.points.size()));
  }
  return shell;
}

}  // namespace palpable

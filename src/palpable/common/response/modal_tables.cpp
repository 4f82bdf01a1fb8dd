#include "palpable/common/response/modal_tables.h"

#include "palpable/common/response/touch_tables.h"

#include <cmath>

namespace palpable {

std::size_t bytes_of(const ModalTables& tables) {
  const ShellTable& shell = tables.shell;
  return static_cast<std::size_t>(tables.inner_modes.size()) * sizeof(float) +
         static_cast<std::size_t>(shell.stress_free.size() + shell.preload.size()) *
             sizeof(double) +
         (shell.elements.size() + shell.material_of.size() + shell.first.size() +
          shell.points.size() + shell.weights.size()) *
             sizeof(int);
}

std::string trouble_of(const ModalTables& tables, const ReducedBody& body) {
  if (!body.several) return "the body has no energy in modes";
  const int V = body.surface.vertex_count();
  if (const std::string_view trouble = trouble_of(tables.shell, V); !trouble.empty()) {
    return std::string(trouble);
  }
  const Eigen::Index inner = tables.shell.nodes() - V;
  if (tables.inner_modes.rows() != 3 * inner ||
      tables.inner_modes.cols() != body.several->mode_count()) {
    return "the modes of inner nodes are not those of the body";
  }
  if (!tables.inner_modes.allFinite()) return "a mode of inner nodes is not finite";
  if (!(tables.half_space > 0) || !std::isfinite(tables.half_space)) {
    return "the local compliance of the skin is not given";
  }
  if (!(tables.point_spacing > 1e-5) || !std::isfinite(tables.point_spacing)) {
    return "contact points have no spacing";
  }
  if (!is_friction(tables.friction)) return "the coefficient of friction is not from 0 to 10";
  const Eigen::Vector3d size =
      body.surface.vertices.rowwise().maxCoeff() - body.surface.vertices.rowwise().minCoeff();
  if (size.squaredNorm() > 3e5 * tables.point_spacing * tables.point_spacing) {
    return "there would be more than 300,000 contact points";
  }
  return {};
}

ModalTables scaled(const ModalTables& tables, double s) {
  ModalTables result = tables;
  result.shell.stress_free *= s;
  result.shell.preload *= s;
  result.inner_modes *= static_cast<float>(s);
  result.point_spacing *= s;
  return result;
}

}  // namespace palpable

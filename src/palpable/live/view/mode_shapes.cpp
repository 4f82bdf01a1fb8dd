#include "palpable/live/view/mode_shapes.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

namespace palpable {

using Eigen::Index;

Result<std::vector<ModeShape>> first_modes(const ReducedBody& body, int count, ModeField of) {
  const bool moves = of == ModeField::kDisplacement;
  const SeparatedField& field = moves ? body.displacement : body.stress;
  if (field.largest_block() < field.mode_count()) {
    return Problem{fmt::format(
        "'{}' has modes of its own for each site, which are no functions of where the load is; "
        "reduce its snapshots by pgd",
        body.name)};
  }
  const Eigen::MatrixXf& F = field.modes();
  const Eigen::MatrixXd& G = field.axes()[0].functions;
  const Eigen::MatrixXd& of_level = field.axes()[1].functions;
  std::vector<ModeShape> shapes;
  for (Index first = 0, end = 0; first < F.cols() && static_cast<int>(shapes.size()) < count;
       first = end) {
    ModeShape shape;
    shape.over_sites = Eigen::VectorXd::Zero(G.rows());
    for (end = first; end < F.cols() && F.col(end) == F.col(first); ++end) {
      shape.over_sites += of_level(of_level.rows() - 1, end) * G.col(end);
    }
    const double most = shape.over_sites.cwiseAbs().maxCoeff();
    if (most > 0) shape.over_sites /= most;
    Eigen::VectorXf mode = static_cast<float>(most) * F.col(first);
    const Index V = body.surface.vertices.cols();
    if (moves) {
      shape.size = mode.reshaped(3, V).colwise().norm().transpose();
      shape.displacement = std::move(mode);
    } else {
      shape.size.resize(V);
      von_mises({mode.data(), static_cast<std::size_t>(mode.size())},
                {shape.size.data(), static_cast<std::size_t>(V)});
    }
    shape.largest = static_cast<double>(shape.size.maxCoeff());
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

Eigen::VectorXd on_skin(const ReducedBody& body, const Eigen::VectorXd& over_sites) {
  const Index V = body.surface.vertices.cols();
  Eigen::VectorXd values = Eigen::VectorXd::Constant(V, std::nan(""));
  Eigen::VectorXd nearest = Eigen::VectorXd::Constant(V, std::numeric_limits<double>::infinity());
  for (std::size_t s = 0; s < body.sites.size(); ++s) {
    const Site& site = body.sites[s];
    for (const int v : site.patch) {
      const double distance =
          (body.surface.vertices.col(v) - body.surface.vertices.col(site.vertex)).norm();
      if (distance >= nearest[v]) continue;
      nearest[v] = distance;
      values[v] = over_sites[static_cast<Index>(s)];
    }
  }
  return values;
}

}  // namespace palpable

#include "palpable/bake/body_mesh.h"

#include "palpable/bake/msh_file.h"
#include "palpable/bake/remesh.h"
#include "palpable/base/contract.h"
#include "palpable/base/error.h"
#include "palpable/geometry/mesh_file.h"

#include <fmt/format.h>

#include <utility>

namespace palpable {

void place_in_body_frame(Eigen::Matrix3Xd& points, UpAxis up, std::optional<double> height) {
  PALPABLE_EXPECT(points.cols() > 0, "there are points to place");
  PALPABLE_EXPECT(!height || *height > 0.0, "a height is positive");
  // Cyclic permutations are rotations.
  const Eigen::Matrix3Xd given = points;
  const int up_row = up == UpAxis::kX ? 0 : up == UpAxis::kY ? 1 : 2;
  for (int k = 0; k < 3; ++k) points.row(k) = given.row((up_row + 1 + k) % 3);

  Eigen::Vector3d low = points.rowwise().minCoeff();
  const Eigen::Vector3d high = points.rowwise().maxCoeff();
  if (!(high[2] > low[2])) throw Error("the shape has no height along its up axis");
  const Eigen::Vector3d foot(0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), low[2]);
  points.colwise() -= foot;
  if (height) points *= *height / (high[2] - low[2]);
}

BodyMesh make_body_mesh(const BodyDescription& description) {
  const BodyDescription::Shape& shape = description.shape;
  const std::string name = shape.file.string();
  BodyMesh body;
  std::string made;
  if (shape.is_volume()) {
    body.mesh = value_or_throw(read_msh_file(shape.file));
    place_in_body_frame(body.mesh.nodes, shape.up, shape.height);
    made = "tetrahedra as in the file";
  } else {
    SurfaceMesh surface = value_or_throw(read_surface_file(shape.file));
    // Before placing, so that a defect is reported where the file has it.
    require_solid_surface(surface, name);
    place_in_body_frame(surface.vertices, shape.up, shape.height);
    made = "TetGen 1.5";
    if (shape.edge) {
      surface = remesh_surface(surface, *shape.edge, name);
      made = fmt::format("CGAL isotropic remeshing to {:.4g} m, TetGen 1.5", *shape.edge);
    }
    body.mesh = tetrahedralise(surface, name);
  }
  body.boundary = boundary_of(body.mesh);
  const auto z = body.mesh.nodes.row(2);
  body.height = z.maxCoeff() - z.minCoeff();
  const double held_below = z.minCoeff() + description.support.below * body.height;
  for (int n = 0; n < body.mesh.node_count(); ++n) {
    if (z[n] <= held_below) body.fixed_nodes.push_back(n);
  }
  // The solver would refuse this too, but does not know which key to change.
  if (body.fixed_nodes.size() < 3) {
    throw Error(
        fmt::format("{}: the support holds {} of {} nodes, so the body is free to turn; raise "
                    "'below' in [support] (now {} of the height)",
                    description.source.string(), body.fixed_nodes.size(), body.mesh.node_count(),
                    description.support.below));
  }
  body.quality = quality_of(body.mesh);
  body.origin = fmt::format("{}, {}", shape.file.filename().string(), made);
  return body;
}

}  // namespace palpable

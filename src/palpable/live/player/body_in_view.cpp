#include "palpable/live/player/body_in_view.h"

#include "palpable/common/geometry/size_text.h"

#include <fmt/format.h>

namespace palpable {

std::optional<std::string> larger_than_view(const SurfaceMesh& body, const Rigid3& camera_from_body,
                                            const PinholeCamera& camera) {
  const double depth = camera_from_body.translation().z();  // of the centre of its base
  if (!(depth > 0.0)) return std::nullopt;
  const Eigen::Vector3d size =
      body.vertices.rowwise().maxCoeff() - body.vertices.rowwise().minCoeff();
  const Eigen::Vector2d seen(depth * camera.width / camera.fx_px,
                             depth * camera.height / camera.fy_px);
  if (size.maxCoeff() <= seen.maxCoeff()) return std::nullopt;
  return fmt::format(
      "the body is {}, larger than what the camera sees where it stands ({} at {:.3g} m): was its "
      "unit forgotten when it was baked?",
      size_text(size), size_text(seen), depth);
}

}  // namespace palpable

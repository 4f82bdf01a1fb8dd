#include "bench/bake/touch_pictures.h"

#include "palpable/common/base/error.h"
#include "palpable/live/render/orbit_camera.h"
#include "palpable/live/render/picture_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace palpable {
namespace {

using Eigen::Matrix3Xf;
using Eigen::Vector3d;

constexpr int kSize = 640;           // px, of a view
constexpr double kViewAngle = 0.55;  // rad
constexpr double kBeside = 0.9;      // rad, to the obstacle's path: shows the dent in profile

OrbitCamera camera_of(const SurfaceMesh& skin, const Vector3d& way) {
  const Vector3d low = skin.vertices.rowwise().minCoeff(),
                 high = skin.vertices.rowwise().maxCoeff();
  OrbitCamera camera;
  camera.target = 0.5 * (low + high);
  camera.distance = 0.62 * (high - low).norm() / std::sin(0.5 * kViewAngle);
  const Vector3d out = -way;
  camera.azimuth = std::atan2(out.x(), -out.y()) + kBeside;
  camera.elevation = std::clamp(0.4 + 0.5 * std::asin(std::clamp(out.z(), -1.0, 1.0)), 0.1, 1.2);
  return camera;
}

}  // namespace

TouchPictures::TouchPictures(const SurfaceMesh& skin)
    : skin_(skin),
      studio_(value_or_throw(Studio::make())),
      renderer_(value_or_throw(SceneRenderer::make())) {}

ColorImage TouchPictures::draw(const Painted& painted, const Vector3d& towards) {
  const Matrix3Xf vertices = skin_.vertices.cast<float>() + painted.displacement;
  Matrix3Xf normals(3, vertices.cols());
  vertex_normals(vertices, skin_.triangles, normals);
  SceneView view;
  view.camera = camera_of_view(kSize, kSize, kViewAngle);
  BodyLook look;
  look.vertices = &vertices;
  look.normals = &normals;
  look.triangles = &skin_.triangles;
  look.scalar = std::span(painted.scalar.data(), static_cast<std::size_t>(painted.scalar.size()));
  look.scalar_max = painted.largest;
  look.camera_from_body = camera_of(skin_, towards).camera_from_body();
  ColorImage background, picture;
  studio_.draw(view.camera, look.camera_from_body, background);
  view.background = &background;
  view.bodies.assign(1, look);
  view.light.color.setConstant(1.12f);
  view.legend_title = painted.legend;
  view.legend_unit = painted.unit;
  view.legend_scale = painted.legend_scale;
  view.caption = {painted.caption};
  renderer_.draw(view, picture);
  return picture;
}

ColorImage TouchPictures::draw(const TouchScene& scene, const TouchDifference& difference) {
  const HeldOutTouch& touch = difference.touch;
  const Eigen::VectorXf apart =
      (difference.displacement - difference.true_displacement).colwise().norm();
  const float stress = std::max(1.0f, difference.true_von_mises.maxCoeff());
  const std::string thing =
      fmt::format("{}, {:.3g} mm deep", name_of(touch.thing), 1e3 * touch.depth);
  const Painted views[] = {
      {difference.displacement, difference.von_mises, stress, "von Mises stress", "kPa",
       "by the tables of touch: " + thing, 1e-3},
      {difference.true_displacement, difference.true_von_mises, stress, "von Mises stress", "kPa",
       "full finite elements: " + thing, 1e-3},
      {difference.true_displacement, apart, std::max(1e-6f, apart.maxCoeff()), "apart", "mm",
       fmt::format("displacement {:.1f} % off, force {:.1f} %, stress {:.1f} %",
                   100 * touch.displacement, 100 * touch.force, 100 * touch.von_mises),
       1e3}};
  std::vector<ColorImage> sheet;
  for (const Painted& painted : views) sheet.push_back(draw(painted, scene.way));
  return sheet_of(sheet, 3);
}

}  // namespace palpable

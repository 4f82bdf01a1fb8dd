#include "palpable/live/view/studio_scene.h"

#include "palpable/common/base/error.h"
#include "palpable/live/view/painted_stress.h"
#include "palpable/live/view/scene_picture.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace palpable {

OrbitCamera usual_camera(const ReducedBody& body, double aspect) {
  return usual_camera(body.surface.vertices, aspect);
}

OrbitCamera usual_camera(const Eigen::Matrix3Xd& x, double aspect) {
  const Eigen::Vector3d low = x.rowwise().minCoeff(), high = x.rowwise().maxCoeff();
  OrbitCamera camera;
  camera.target = 0.5 * (low + high);
  double radius = 0;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    radius = std::max(radius, (x.col(i) - camera.target).norm());
  }
  camera.distance = 1.12 * radius / std::sin(0.5 * kStudioView * std::min(aspect, 1.0));
  // Looks along the horizontal direction in which the body extends least.
  const Eigen::Matrix2Xd flat = x.topRows<2>().colwise() - camera.target.head<2>();
  const Eigen::Matrix2d spread = flat * flat.transpose();
  const double longest = 0.5 * std::atan2(2.0 * spread(0, 1), spread(0, 0) - spread(1, 1));
  camera.azimuth = std::remainder(longest + 0.45, 2.0 * std::acos(-1.0));
  camera.elevation = 0.32;
  return camera;
}

OrbitCamera camera_towards(const Site& site, OrbitCamera camera) {
  const Eigen::Vector2d outwards = -site.direction.head<2>();
  if (outwards.norm() > 0.3) camera.azimuth = std::atan2(outwards.x(), -outwards.y()) + 0.75;
  return camera;
}

StudioScene::StudioScene(const ReducedBody& body, PictureSize size)
    : body_(body),
      pressed_(body),
      studio_(value_or_throw(Studio::make())),
      renderer_(value_or_throw(SceneRenderer::make())),
      dot_radius_(static_cast<float>(0.014 * body.surface.vertices.row(2).maxCoeff())) {
  resize(size);
}

void StudioScene::resize(PictureSize size) {
  view_.camera = camera_of_view(size.width, size.height, kStudioView);
  studio_is_old_ = true;
}

const ColorImage& StudioScene::draw(const OrbitCamera& orbit) {
  BodyLook look = finger_ != nullptr ? finger_->look() : pressed_.look();
  dots_.clear();
  if (sites_shown) {
    pressed_.site_dots(dot_radius_, dots_);
    look.marks = pressed_.patch_marks();
  }
  if (is_pressed()) {
    if (finger_ != nullptr) {
      finger_->finger_dots(dot_radius_, dots_);
    } else {
      pressed_.load_dots(dot_radius_, dots_);
    }
  }
  look.dots = dots_;
  look.colors = colors;
  paint(look);
  return draw(look, orbit);
}

bool StudioScene::is_pressed() const {
  return (finger_ != nullptr ? finger_->level() : pressed_.level()) > 0;
}

// Sets the values of the chosen field, and its legend.
void StudioScene::paint(BodyLook& look) {
  view_.legend_title.clear();
  view_.legend_unit = "kPa";
  view_.legend_scale = 1e-3;
  switch (field) {
    case SceneShow::Field::kVonMises:
      if (finger_ == nullptr && !knows_stress(body_)) {
        look.scalar = {};  // a legend would show a scale of zeros
      } else if (legend_shown) {
        view_.legend_title = "von Mises stress";
      }
      break;
    case SceneShow::Field::kPressure:
    case SceneShow::Field::kComponent:
      painted_stress(field, component, finger_ != nullptr ? finger_->cauchy() : pressed_.cauchy(),
                     painted_);
      look.scalar = painted_;
      look.two_sided = true;
      if (legend_shown) name_painted_stress(field, component, view_.legend_title);
      if (finger_ != nullptr || knows_stress(body_)) break;
      look.scalar = {};
      if (legend_shown) view_.legend_title = kNoStressKnown;
      break;
    case SceneShow::Field::kContact:
      look.scalar = {};
      if (finger_ != nullptr) look.scalar = finger_->contact_pressure();
      look.scalar_max *= static_cast<float>(kContactOfStress);
      if (legend_shown) {
        view_.legend_title = finger_ != nullptr ? kContactPressure : kNoContactKnown;
      }
      break;
    case SceneShow::Field::kDisplacement:
      displacement_of(*look.vertices, body_.surface, painted_);
      look.scalar = painted_;
      look.scalar_max = displacement_scale(body_.surface);
      if (legend_shown) view_.legend_title = "displacement";
      view_.legend_unit = "mm";
      view_.legend_scale = 1e3;
      break;
    case SceneShow::Field::kNone:
      look.scalar = {};
      break;
  }
}

const ColorImage& StudioScene::draw_other(const BodyLook& look, const OtherLegend& legend,
                                          const OrbitCamera& orbit) {
  view_.legend_title = legend.title;
  view_.legend_unit = legend.unit;
  view_.legend_scale = legend.scale;
  return draw(look, orbit);
}

const ColorImage& StudioScene::draw(BodyLook look, const OrbitCamera& orbit) {
  const Rigid3 camera_from_body = orbit.camera_from_body();
  if (studio_is_old_ || !camera_from_body.isApprox(camera_from_body_, 0.0)) {
    studio_.draw(view_.camera, camera_from_body, background_);
    camera_from_body_ = camera_from_body;
    studio_is_old_ = false;
  }
  view_.background = &background_;
  look.camera_from_body = camera_from_body;
  view_.bodies.assign(1, look);
  view_.light.color.setConstant(1.12f);  // brighter than a room
  view_.caption = caption;
  renderer_.draw(view_, picture_, nullptr, &depth_);
  return picture_;
}

std::optional<Eigen::Vector3d> StudioScene::point_at(double x_px, double y_px) const {
  const int x = static_cast<int>(std::lround(x_px)), y = static_cast<int>(std::lround(y_px));
  if (x < 0 || x >= depth_.width() || y < 0 || y >= depth_.height()) return std::nullopt;
  const float z = depth_(x, y);
  if (std::isnan(z)) return std::nullopt;
  return camera_from_body_.inverse() * view_.camera.unproject(x_px, y_px, z);
}

std::string StudioScene::title() const {
  return fmt::format("{}   {} vertices, {} sites", body_.name, body_.surface.vertex_count(),
                     body_.sites.size());
}

std::string StudioScene::reading() const {
  if (finger_ != nullptr) {
    std::string text =
        fmt::format("finger pushed by {:.1f} mm   force {:.2f} N   largest stress {:.1f} kPa",
                    1e3 * finger_->push(), finger_->force(), 1e-3 * finger_->largest_von_mises());
    if (const auto& stated = finger_->stated_error()) { text += "   " + caption_of(*stated); }
    return text;
  }
  std::string text =
      fmt::format("site {}   level {:.2f}   force {:.2f} N   depth {:.1f} mm", pressed_.site(),
                  pressed_.level(), pressed_.force(), 1e3 * pressed_.press_depth());
  if (!knows_stress(body_)) return text;
  return text + fmt::format("   largest stress {:.1f} kPa", 1e-3 * pressed_.largest_von_mises());
}

}  // namespace palpable

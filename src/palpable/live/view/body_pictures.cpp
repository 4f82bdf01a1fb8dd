#include "palpable/live/view/body_pictures.h"

#include "palpable/common/geometry/size_text.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/live/render/picture_sheet.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

struct Shot {
  std::string name;
  OrbitCamera camera;
  bool sites = false;  // shown
  int site = 0;
  double level = 0;
};

std::vector<Shot> shots_of(const ReducedBody& body, int site, double level, double aspect) {
  const OrbitCamera usual = usual_camera(body, aspect);
  OrbitCamera other_side = usual;
  other_side.azimuth += std::acos(-1.0);
  std::vector<Shot> shots{{"1_at_rest", usual}, {"2_sites", usual, true}};
  const auto press = [&](int pressed, double how_hard) {
    shots.push_back(
        {fmt::format("{}_press_site_{}_level_{:.0f}", shots.size() + 1, pressed, 100 * how_hard),
         camera_towards(body.sites[pressed], usual), false, pressed, how_hard});
  };
  if (site >= 0) {
    for (const double share : {1.0 / 3.0, 2.0 / 3.0, 1.0}) press(site, share * level);
  } else {
    for (const int shown : sites_to_show(body, 3)) press(shown, level);
  }
  shots.push_back({fmt::format("{}_sites_from_behind", shots.size() + 1), other_side, true});
  return shots;
}

const ColorImage& draw_shot(StudioScene& scene, const Shot& shot) {
  scene.pressed().press(shot.site, shot.level);
  scene.sites_shown = shot.sites;
  scene.legend_shown = shot.level > 0;
  scene.caption = {shot.level > 0 ? scene.reading() : scene.title()};
  return scene.draw(shot.camera);
}

// A body whose displacement and colours are set per vertex.
struct PaintedBody {
  explicit PaintedBody(const ReducedBody& body)
      : at_rest(body.surface.vertices.cast<float>()),
        vertices(at_rest),
        normals(3, at_rest.cols()),
        scalar(at_rest.cols()),
        marks(scalar.size()) {
    look.vertices = &vertices;
    look.normals = &normals;
    look.triangles = &body.surface.triangles;
    look.scalar = scalar;
  }
  PaintedBody(const PaintedBody&) = delete;  // look points into it
  PaintedBody& operator=(const PaintedBody&) = delete;

  ColorImage draw(StudioScene& scene, const OtherLegend& legend, const OrbitCamera& camera) {
    vertex_normals(vertices, *look.triangles, normals);
    return scene.draw_other(look, legend, camera);
  }

  Eigen::Matrix3Xf at_rest, vertices, normals;  // (3 x V) m
  std::vector<float> scalar, marks;             // (V)
  BodyLook look;
};

// Draws each mode of displacement as the body's shape, and each mode of stress as colours of the
// body at rest.
void draw_shapes(const std::vector<ModeShape>& shapes, double body_size, const OrbitCamera& camera,
                 StudioScene& scene, PaintedBody& painted, std::vector<ColorImage>& cells) {
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const ModeShape& shape = shapes[i];
    const Eigen::Index V = painted.at_rest.cols();
    Eigen::Map<Eigen::VectorXf>(painted.scalar.data(), V) = shape.size;
    painted.look.scalar_max = static_cast<float>(std::max(shape.largest, 1e-9));
    painted.vertices = painted.at_rest;
    if (shape.displacement.size() == 0) {
      scene.caption = {fmt::format("mode {}: up to {:.3g} kPa", i + 1, 1e-3 * shape.largest)};
      cells.push_back(painted.draw(scene, {"von Mises", "kPa", 1e-3}, camera));
      continue;
    }
    // Enlarged to an eighth of the body's size.
    const double shown = shape.largest > 0 ? 0.125 * body_size / shape.largest : 0.0;
    painted.vertices += static_cast<float>(shown) * shape.displacement.reshaped(3, V);
    scene.caption = {fmt::format("mode {}: up to {:.3g} mm, drawn {:.2g} times as large", i + 1,
                                 1e3 * shape.largest, shown)};
    cells.push_back(painted.draw(scene, {"displacement", "mm", 1e3}, camera));
  }
}

// Draws each mode's function of the load position as colours of the sites' patches.
void draw_functions(const ReducedBody& body, const std::vector<ModeShape>& shapes,
                    const OrbitCamera& camera, StudioScene& scene, PaintedBody& painted,
                    std::vector<ColorImage>& cells) {
  painted.vertices = painted.at_rest;
  painted.look.marks = painted.marks;
  painted.look.mark_color = {150, 150, 150};
  painted.look.scalar_max = 1;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const Eigen::VectorXd values = on_skin(body, shapes[i].over_sites);
    for (Eigen::Index v = 0; v < values.size(); ++v) {
      const double value = values[v];
      painted.marks[v] = std::isnan(value) ? 1.0f : 0.0f;
      painted.scalar[v] = std::isnan(value) ? 0.0f : static_cast<float>(0.5 + 0.5 * value);
    }
    scene.caption = {
        fmt::format("function {} of the load's position, {:.2f} to {:.2f} of its "
                    "largest; dark -1, light 1, grey none",
                    i + 1, shapes[i].over_sites.minCoeff(), shapes[i].over_sites.maxCoeff())};
    cells.push_back(painted.draw(scene, {}, camera));
  }
}

}  // namespace

void draw_presses(const ReducedBody& body, int site, double level, const NamedPaint& paint,
                  ColorScale colors, PictureSize size,
                  const std::function<void(const std::string& name, const ColorImage&)>& show) {
  StudioScene scene(body, size);
  scene.field = paint.field;
  scene.component = paint.component;
  scene.colors = colors;
  const std::vector<Shot> shots = shots_of(body, site, level, size.aspect());
  for (const Shot& shot : shots) show(shot.name, draw_shot(scene, shot));
  scene.resize({size.width / 2, size.height / 2});
  std::vector<ColorImage> cells;
  for (const Shot& shot : shots) cells.push_back(draw_shot(scene, shot));
  show("contact_sheet", sheet_of(cells, 3));
}

ColorImage draw_modes(const ReducedBody& body, const std::vector<ModeShape>& shapes,
                      PictureSize size) {
  StudioScene scene(body, {size.width / 2, size.height / 2});
  const OrbitCamera usual = usual_camera(body, size.aspect());
  OrbitCamera above = usual;
  above.elevation = 0.9;
  const Eigen::Matrix3Xd& X = body.surface.vertices;
  const double body_size = extent_of(X).norm();
  PaintedBody painted(body);
  std::vector<ColorImage> cells;
  draw_shapes(shapes, body_size, usual, scene, painted, cells);
  draw_functions(body, shapes, above, scene, painted, cells);
  return sheet_of(cells, static_cast<int>(shapes.size()));
}

}  // namespace palpable

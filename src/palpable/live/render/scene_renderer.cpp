#include "palpable/live/render/scene_renderer.h"

#include "palpable/live/render/arrow.h"
#include "palpable/live/render/fill_unknown.h"
#include "palpable/live/render/gl_objects.h"
#include "palpable/live/render/ground_shadow.h"
#include "palpable/live/render/legend.h"
#include "palpable/live/render/outlines.h"
#include "palpable/live/render/real_shadows.h"
#include "palpable/live/render/shader_files.h"
#include "palpable/live/render/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace palpable {
namespace {

constexpr float kSceneNear = 0.01f;  // m
constexpr int kHoleRadius = 6;       // texels of the depth image; radius for fill_unknown()
constexpr int kOutlineRadius = 2;    // px by which the soft outline may extend beyond the body
constexpr Rgb kPlainGrey{118, 118, 118};

Eigen::Vector4f floats_of(const PixelBox& box) {
  return Eigen::Vector4i(box.x, box.y, box.right(), box.bottom()).cast<float>();
}

/// OpenGL buffers of one body.
struct BodyBuffers {
  GlBuffer vertices, normals, scalar, marks, shaded, triangles, dots;
  GlVertexArray inputs, dot_inputs;
  Eigen::Matrix3Xi known_triangles;
  GroundShadow shadow;

  BodyBuffers() {
    inputs.floats(0, vertices, 3);
    inputs.floats(1, normals, 3);
    inputs.floats(2, scalar, 1);
    inputs.floats(3, marks, 1);
    inputs.floats(4, shaded, 1);
    inputs.indices(triangles);
    constexpr int kDotBytes = 7 * sizeof(float);
    dot_inputs.floats(0, dots, 3, kDotBytes, 0);
    dot_inputs.floats(1, dots, 1, kDotBytes, 3 * sizeof(float));
    dot_inputs.floats(2, dots, 3, kDotBytes, 4 * sizeof(float));
  }
};

/// Textures and framebuffers of the picture's size.
struct Targets {
  Targets(int width, int height)
      : body_color(GL_RGBA8, width, height),
        body_z(GL_R32F, width, height),
        body_window_depth(GL_DEPTH_COMPONENT32F, width, height),
        picture(GL_RGBA8, width, height),
        visible(GL_R8, width, height),
        body(std::array<const GlTexture*, 2>{&body_color, &body_z}, &body_window_depth),
        ground(std::array<const GlTexture*, 1>{&picture}, nullptr),
        composed(std::array<const GlTexture*, 2>{&picture, &visible}, nullptr) {}

  GlTexture body_color, body_z, body_window_depth;
  GlTexture picture, visible;
  GlFramebuffer body;      // the bodies, hidden or not
  GlFramebuffer ground;    // the camera's image and shadows
  GlFramebuffer composed;  // the picture, and the mask of visible bodies
};

/// The bounding box of projected points.
struct Bounds {
  float x0 = std::numeric_limits<float>::max();
  float y0 = std::numeric_limits<float>::max();
  float x1 = std::numeric_limits<float>::lowest();
  float y1 = std::numeric_limits<float>::lowest();
  bool everything = false;  // a point is nearer than the near plane and may cover any pixel

  void add(const Eigen::Vector3f& x_in_camera, const PinholeCamera& camera, float radius) {
    const float z = x_in_camera.z() - radius;
    if (z < kSceneNear) {
      everything = true;
      return;
    }
    const auto fx = static_cast<float>(camera.fx_px), fy = static_cast<float>(camera.fy_px);
    const float u = fx * x_in_camera.x() / x_in_camera.z() + static_cast<float>(camera.cx_px);
    const float v = fy * x_in_camera.y() / x_in_camera.z() + static_cast<float>(camera.cy_px);
    const float r = std::max(fx, fy) * radius / z;
    x0 = std::min(x0, u - r);
    y0 = std::min(y0, v - r);
    x1 = std::max(x1, u + r);
    y1 = std::max(y1, v + r);
  }

  [[nodiscard]] PixelBox within(int width, int height, int margin) const {
    if (everything) return {0, 0, width, height};
    const auto edge = [](float value, int limit) {
      return static_cast<int>(std::clamp(value, 0.0f, static_cast<float>(limit)));
    };
    const auto m = static_cast<float>(margin);
    return PixelBox::between(edge(std::floor(x0 - m), width), edge(std::floor(y0 - m), height),
                             edge(std::ceil(x1 + m + 1), width),
                             edge(std::ceil(y1 + m + 1), height));
  }
};

Eigen::Vector4f pinhole_of(const PinholeCamera& camera) {
  return Eigen::Vector4d(camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px).cast<float>();
}

void set_camera(const GlProgram& program, const PinholeCamera& camera) {
  program.set("pinhole", pinhole_of(camera));
  program.set("size", Eigen::Vector2i(camera.width, camera.height).cast<float>().eval());
  program.set("near", kSceneNear);
}

/// Directions in the camera frame: the body's up, and the one to the lamp.
struct Light {
  Eigen::Vector3f up;
  Eigen::Vector3f key;
};
Light light_on(const BodyLook& body, const SceneLight& light) {
  const Eigen::Vector3f up = body.camera_from_body.linear().col(2).cast<float>();
  return {up, light.to_lamp.value_or(usual_lamp(up.cast<double>()).cast<float>())};
}

// The least and the largest painted value; NaN if nothing is painted.
struct PaintedRange {
  explicit PaintedRange(const SceneView& view) {
    for (const BodyLook& body : view.bodies) {
      for (const float value : body.scalar) {
        least = std::fmin(least, value);
        largest = std::fmax(largest, value);
      }
    }
  }
  float least = std::numeric_limits<float>::quiet_NaN();
  float largest = std::numeric_limits<float>::quiet_NaN();
};

void draw_on(ColorImage& picture, const Arrow& arrow, const PinholeCamera& camera, float scale) {
  if (arrow.tail.z() < kSceneNear || arrow.tip.z() < kSceneNear) return;
  const Eigen::Vector2f tail = camera.project(arrow.tail).cast<float>();
  const Eigen::Vector2f tip = camera.project(arrow.tip).cast<float>();
  draw_arrow(picture, tail, tip, 5.0f * scale, arrow.color);
  const float size = 15.0f * scale;
  const TextSize text = measure_text(arrow.label, size);
  // The label is beside the tail, on the side away from the arrow.
  const float x = tail.x() + (tail.x() < tip.x() ? -text.width - 8.0f * scale : 8.0f * scale);
  draw_label(picture, x, tail.y() - 0.5f * text.height(), arrow.label, size);
}

// Whether the outlines of real things are found at the picture's resolution.
bool wants_outlines(const SceneView& view) {
  return !view.hard_occlusion && view.background != nullptr && view.real_depth != nullptr &&
         !view.real_depth->empty() && view.camera.width / 2 == view.real_depth->width() &&
         view.camera.height / 2 == view.real_depth->height();
}

bool is_translucent(const BodyLook& look) { return look.opacity < 1.0f; }

bool has_translucent(const SceneView& view) {
  return std::any_of(view.bodies.begin(), view.bodies.end(), is_translucent);
}

void check(const SceneView& view) {
  const PinholeCamera& camera = view.camera;
  PALPABLE_EXPECT(camera.width > 0 && camera.height > 0, "the picture has a size");
  PALPABLE_EXPECT(view.background == nullptr || (view.background->width() == camera.width &&
                                                 view.background->height() == camera.height),
                  "the background has the size of the picture");
  for (const BodyLook& body : view.bodies) {
    PALPABLE_EXPECT(
        body.vertices != nullptr && body.normals != nullptr && body.triangles != nullptr,
        "a body has vertices, normals and triangles");
    const auto count = static_cast<std::size_t>(body.vertices->cols());
    PALPABLE_EXPECT(body.normals->cols() == body.vertices->cols(), "one normal per vertex");
    PALPABLE_EXPECT(body.scalar.empty() || body.scalar.size() == count, "one scalar per vertex");
    PALPABLE_EXPECT(body.marks.empty() || body.marks.size() == count, "one mark per vertex");
    PALPABLE_EXPECT(body.scalar_max > 0.0f, "the colour scale has a length");
    PALPABLE_EXPECT(body.opacity == 1.0f ||
                        (body.opacity > 0.0f && body.opacity < 1.0f && !view.hard_occlusion),
                    "a translucent body has an opacity from 0 to 1, and soft occlusion");
  }
}

}  // namespace

struct SceneRenderer::State {
  GlProgram body_program, dot_program, shadow_program, compose_program;
  GlProgram two_sided_body_program;
  GlProgram compose_fine_program;  // where fine_depth reaches wherever a body may be
  GlProgram compose_hard_program;
  GlProgram compose_translucent_program;
  FullScreenTriangle triangle;
  std::vector<BodyBuffers> buffers;
  std::unique_ptr<Targets> targets;
  GlTexture real_depth{GL_R32F, 1, 1};
  GlTexture nothing_real{GL_R32F, 1, 1};
  GlTexture fine_depth{GL_R32F, 1, 1};  // of the picture's size
  PixelBox real_box;                    // texels of real_depth that are valid for this picture
  PixelBox fine_box;                    // px where fine_depth is valid; empty: nowhere
  RealOutlines outlines;
  ShadeOnReal shade_on_real;
  ShadeOnBody shade_on_body;
  GlTexture light_left{GL_R32F, 1, 1, GL_LINEAR};

  // Kept between frames so that nothing is allocated.
  std::vector<float> zeros, filled, body_z, dot_values, shade_values, z_rows;
  std::vector<signed char> nearest_in_row;
  std::vector<std::uint8_t> rgba, mask_rows;

  struct Boxes {
    PixelBox bodies;
    PixelBox all;  // of bodies and their shadows
  };
  Boxes boxes_of(const SceneView& view) const;
  Eigen::Vector2f upload_real_depth(const SceneView& view, const Boxes& boxes);
  void upload_outlines(const SceneView& view, const PixelBox& bodies);
  void mark_too_close(const MaskImage& moving);
  void read_body_depth(const PixelBox& bodies, const PixelBox& inner);
  void stream(const BodyLook& look, const SceneLight& light, BodyBuffers& to);
  void draw_shadows(const SceneView& view, const PixelBox& box, const RealSurface& real);
  void shade_bodies(const SceneView& view, const RealSurface& real);
  void draw_bodies(const SceneView& view);
  void draw_translucent(const SceneView& view);
  void draw_body(const SceneView& view, std::size_t number);
  void compose_picture(const SceneView& view, const Boxes& boxes,
                       const Eigen::Vector2f& depth_per_picture);
  void read_back(const PixelBox& box, ColorImage& picture, MaskImage* visible, DepthImage* depth);
};

SceneRenderer::SceneRenderer(std::unique_ptr<State> state) : state_(std::move(state)) {}
SceneRenderer::SceneRenderer(SceneRenderer&&) noexcept = default;
SceneRenderer& SceneRenderer::operator=(SceneRenderer&&) noexcept = default;
SceneRenderer::~SceneRenderer() = default;

Result<SceneRenderer> SceneRenderer::make() {
  constexpr std::array<ProgramSource, 8> kSources = {
      {{"body.vert", "body.frag"},
       {"dot.vert", "dot.frag"},
       {"full_screen.vert", "shadow.frag"},
       {"full_screen.vert", "compose.frag"},
       {"full_screen.vert", "compose.frag", "#define ALL_FINE\n"},
       {"full_screen.vert", "compose.frag", "#define HARD\n"},
       {"body.vert", "body.frag", "#define TWO_SIDED\n"},
       {"full_screen.vert", "compose.frag", "#define TRANSLUCENT\n"}}};
  Result<std::vector<GlProgram>> made = make_programs(render_shader_files(), kSources);
  if (!made.ok()) return made.problem();
  std::vector<GlProgram> programs = std::move(made).value();
  auto state =
      std::unique_ptr<State>(new State{.body_program = std::move(programs[0]),
                                       .dot_program = std::move(programs[1]),
                                       .shadow_program = std::move(programs[2]),
                                       .compose_program = std::move(programs[3]),
                                       .two_sided_body_program = std::move(programs[6]),
                                       .compose_fine_program = std::move(programs[4]),
                                       .compose_hard_program = std::move(programs[5]),
                                       .compose_translucent_program = std::move(programs[7]),
                                       .triangle = {},
                                       .buffers = {},
                                       .targets = {},
                                       .real_box = {},
                                       .fine_box = {},
                                       .outlines = {},
                                       .shade_on_real = {},
                                       .shade_on_body = {},
                                       .zeros = {},
                                       .filled = {},
                                       .body_z = {},
                                       .dot_values = {},
                                       .shade_values = {},
                                       .z_rows = {},
                                       .nearest_in_row = {},
                                       .rgba = {},
                                       .mask_rows = {}});
  const float unknown = 0.0f;
  state->nothing_real.upload(0, 0, 1, 1, GL_RED, GL_FLOAT, &unknown);
  return SceneRenderer(std::move(state));
}

void SceneRenderer::draw(const SceneView& view, ColorImage& picture, MaskImage* body_visible,
                         DepthImage* body_depth) {
  check(view);
  State& s = *state_;
  const int width = view.camera.width, height = view.camera.height;
  picture.resize(width, height);
  if (view.background != nullptr) {
    std::copy(view.background->begin(), view.background->end(), picture.begin());
  } else {
    std::fill(picture.begin(), picture.end(), kPlainGrey);
  }
  if (body_visible != nullptr) {
    body_visible->resize(width, height);
    std::fill(body_visible->begin(), body_visible->end(), std::uint8_t{0});
  }
  if (body_depth != nullptr) {
    body_depth->resize(width, height);
    std::fill(body_depth->begin(), body_depth->end(), std::numeric_limits<float>::quiet_NaN());
  }

  while (s.buffers.size() < view.bodies.size()) s.buffers.emplace_back();
  for (std::size_t i = 0; i < view.bodies.size(); ++i)
    s.stream(view.bodies[i], view.light, s.buffers[i]);
  const State::Boxes boxes = s.boxes_of(view);
  const PixelBox& box = boxes.all;
  if (!box.empty()) {
    if (!s.targets || s.targets->picture.width() != width ||
        s.targets->picture.height() != height) {
      s.targets = std::make_unique<Targets>(width, height);
    }
    glEnable(GL_SCISSOR_TEST);
    glScissor(box.x, box.y, box.width, box.height);
    const Eigen::Vector2f depth_per_picture = s.upload_real_depth(view, boxes);
    const RealSurface real{s.filled, s.real_box, depth_per_picture.cast<double>(), view.camera};
    s.shade_bodies(view, real);
    // The shaders read bodies up to one pixel beyond the box, which must be cleared as well.
    const int x0 = std::max(box.x - 1, 0), y0 = std::max(box.y - 1, 0);
    glScissor(x0, y0, std::min(box.right() + 1, width) - x0,
              std::min(box.bottom() + 1, height) - y0);
    s.draw_bodies(view);
    glScissor(box.x, box.y, box.width, box.height);
    if (wants_outlines(view)) s.upload_outlines(view, boxes.bodies);
    // At this point the picture is the background, or plain grey.
    s.targets->picture.upload(box.x, box.y, box.width, box.height, GL_RGB, GL_UNSIGNED_BYTE,
                              picture.row(box.y) + box.x, width);
    if (view.moving != nullptr) s.mark_too_close(*view.moving);
    s.draw_shadows(view, box, real);
    s.compose_picture(view, boxes, depth_per_picture);
    glDisable(GL_SCISSOR_TEST);
    s.read_back(box, picture, body_visible, body_depth);
  }
  const float scale = legend_scale(height);
  for (const Arrow& arrow : view.arrows) draw_on(picture, arrow, view.camera, scale);
  if (!view.legend_title.empty() && !view.bodies.empty()) {
    const BodyLook& first = view.bodies.front();
    const PaintedRange painted(view);
    draw_legend(picture, {.title = view.legend_title,
                          .unit = view.legend_unit,
                          .top = first.scalar_max * view.legend_scale,
                          .two_sided = first.two_sided,
                          .colors = first.colors,
                          .material = first.material,
                          .opaque = first.opaque_share(),
                          .present = painted.largest * view.legend_scale,
                          .present_least = painted.least * view.legend_scale,
                          .stated_error = view.stated_error,
                          .error_of = view.stated_error_of,
                          .scale = scale});
  }
  if (!view.caption.empty()) draw_caption(picture, view.caption, scale);
  if (!view.warning.empty()) draw_warning(picture, view.warning, scale);
}

SceneRenderer::State::Boxes SceneRenderer::State::boxes_of(const SceneView& view) const {
  Bounds bounds;
  const auto box = [&]() -> PixelBox {
    if (!bounds.everything && bounds.x0 > bounds.x1) return {};
    return bounds.within(view.camera.width, view.camera.height, kOutlineRadius);
  };
  for (const BodyLook& body : view.bodies) {
    const Eigen::Isometry3f camera_from_body = body.camera_from_body.cast<float>();
    for (Eigen::Index v = 0; v < body.vertices->cols(); ++v) {
      bounds.add(camera_from_body * Eigen::Vector3f(body.vertices->col(v)), view.camera, 0.0f);
    }
    for (const Dot& dot : body.dots) {
      bounds.add(camera_from_body * dot.at_in_body, view.camera, dot.radius);
    }
  }
  Boxes boxes;
  boxes.bodies = box();
  for (std::size_t i = 0; i < view.bodies.size(); ++i) {
    const BodyLook& body = view.bodies[i];
    if (body.shadow <= 0.0f || body.vertices->cols() == 0) continue;
    const Eigen::Isometry3f camera_from_body = body.camera_from_body.cast<float>();
    const Eigen::Vector4f& patch = buffers[i].shadow.box();
    for (const int corner : {0, 1, 2, 3}) {
      Eigen::Vector3f at(patch[(corner & 1) != 0 ? 2 : 0], patch[(corner & 2) != 0 ? 3 : 1], 0.0f);
      bounds.add(camera_from_body * at, view.camera, 0.0f);
    }
  }
  boxes.all = box();
  return boxes;
}

/// @return texels of the depth image per pixel of the picture
Eigen::Vector2f SceneRenderer::State::upload_real_depth(const SceneView& view, const Boxes& boxes) {
  fine_box = {};
  real_box = {};
  if (view.real_depth == nullptr || view.real_depth->empty()) return Eigen::Vector2f::Zero();
  const DepthImage& depth = *view.real_depth;
  if (real_depth.width() != depth.width() || real_depth.height() != depth.height()) {
    real_depth = GlTexture(GL_R32F, depth.width(), depth.height());
  }
  const double sx = static_cast<double>(depth.width()) / view.camera.width;
  const double sy = static_cast<double>(depth.height()) / view.camera.height;
  const int margin = wants_outlines(view) ? RealOutlines::kMargin : kHoleRadius + 2;
  // Wide enough for both ends of every strip that one eye alone sees.
  const int row_margin = kLongestHalfSeen + 1;
  const PixelBox& box = boxes.all;
  const PixelBox texels =
      PixelBox::between(std::max(static_cast<int>(box.x * sx) - row_margin, 0),
                        std::max(static_cast<int>(box.y * sy) - margin, 0),
                        std::min(static_cast<int>(box.right() * sx) + row_margin, depth.width()),
                        std::min(static_cast<int>(box.bottom() * sy) + margin, depth.height()));
  fill_unknown(depth, view.hard_occlusion ? nullptr : view.borrowed, texels,
               view.hard_occlusion ? 0 : kHoleRadius, nearest_in_row, filled);
  if (view.hard_occlusion) {  // not even the strips that one eye alone sees
    for (std::size_t i = 0; i < filled.size(); ++i) {
      if (nearest_in_row[i] != 0) filled[i] = 0.0f;
    }
  }
  real_depth.upload(texels.x, texels.y, texels.width, texels.height, GL_RED, GL_FLOAT,
                    filled.data());
  real_box = texels;
  return Eigen::Vector2d(sx, sy).cast<float>();
}

// Finds outlines and uploads their depth. @pre the bodies are drawn
void SceneRenderer::State::upload_outlines(const SceneView& view, const PixelBox& bodies) {
  const PixelBox& texels = real_box;
  const PixelBox inner = PixelBox::between(bodies.x / 2, bodies.y / 2,
                                           std::min((bodies.right() + 1) / 2, texels.right()),
                                           std::min((bodies.bottom() + 1) / 2, texels.bottom()));
  if (inner.empty()) return;
  read_body_depth(bodies, inner);
  outlines.find({.picture = *view.background,
                 .box = texels,
                 .depth = filled,
                 .guessed = nearest_in_row,
                 .inner = inner,
                 .body = body_z,
                 .moving = view.moving,
                 .too_close = view.too_close});
  if (fine_depth.width() != view.camera.width || fine_depth.height() != view.camera.height) {
    fine_depth = GlTexture(GL_R32F, view.camera.width, view.camera.height);
  }
  fine_box = {2 * inner.x, 2 * inner.y, 2 * inner.width, 2 * inner.height};
  fine_depth.upload(fine_box.x, fine_box.y, fine_box.width, fine_box.height, GL_RED, GL_FLOAT,
                    outlines.depth().data());
}

// Gives moving pixels without depth the depth kTooClose. Otherwise they would count as parts of the
// body's plane and be shaded.
void SceneRenderer::State::mark_too_close(const MaskImage& moving) {
  if (moving.width() < real_box.right() || moving.height() < real_box.bottom()) return;
  float* z = filled.data();
  for (int y = real_box.y; y < real_box.bottom(); ++y) {
    const std::uint8_t* moves = moving.row(y) + real_box.x;
    for (int x = 0; x < real_box.width; ++x, ++z) {
      if (moves[x] != 0 && !(*z > 0.0f)) *z = RealOutlines::kTooClose;
    }
  }
}

// Reads the bodies' depth within the texels `inner`, at the picture's resolution, into body_z; 0
// outside of `bodies`.
void SceneRenderer::State::read_body_depth(const PixelBox& bodies, const PixelBox& inner) {
  const int width = 2 * inner.width, height = 2 * inner.height;
  assign_with_room(body_z, static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                   0.0f);
  targets->body.read(1, 2 * inner.x, 2 * inner.y, width, height, GL_RED, GL_FLOAT, body_z.data());
  for (int y = 0; y < height; ++y) {
    float* row = body_z.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
    const bool beside = 2 * inner.y + y < bodies.y || 2 * inner.y + y >= bodies.bottom();
    if (beside) std::fill_n(row, width, 0.0f);
    std::fill_n(row, std::max(bodies.x - 2 * inner.x, 0), 0.0f);
    const int end = std::min(bodies.right() - 2 * inner.x, width);
    std::fill_n(row + end, width - end, 0.0f);
  }
}

void SceneRenderer::State::stream(const BodyLook& look, const SceneLight& scene_light,
                                  BodyBuffers& to) {
  const auto count = static_cast<std::size_t>(look.vertices->cols());
  zeros.resize(std::max(zeros.size(), count));
  const auto matrix = [](const Eigen::Matrix3Xf& m) {
    return std::span<const float>(m.data(), static_cast<std::size_t>(m.size()));
  };
  const auto or_zeros = [&](std::span<const float> values) {
    return values.empty() ? std::span<const float>(zeros.data(), count) : values;
  };
  to.vertices.stream(matrix(*look.vertices));
  to.normals.stream(matrix(*look.normals));
  to.scalar.stream(or_zeros(look.scalar));
  to.marks.stream(or_zeros(look.marks));
  if (to.known_triangles.cols() != look.triangles->cols() ||
      to.known_triangles != *look.triangles) {
    to.known_triangles = *look.triangles;
    to.triangles.stream(std::span<const int>(look.triangles->data(),
                                             static_cast<std::size_t>(look.triangles->size())));
  }
  dot_values.clear();
  for (const Dot& dot : look.dots) {
    const Eigen::Vector3f tint = shader_color(dot.color);
    dot_values.insert(dot_values.end(), {dot.at_in_body.x(), dot.at_in_body.y(), dot.at_in_body.z(),
                                         dot.radius, tint.x(), tint.y(), tint.z()});
  }
  to.dots.stream(std::span<const float>(dot_values));
  if (look.shadow > 0.0f) {
    const Light light = light_on(look, scene_light);
    const Eigen::Matrix3f body_from_camera =
        look.camera_from_body.linear().transpose().cast<float>();
    to.shadow.cast(*look.vertices, *look.triangles, body_from_camera * light.key);
  }
}

void SceneRenderer::State::shade_bodies(const SceneView& view, const RealSurface& real) {
  shade_on_body.see(real);
  for (std::size_t i = 0; i < view.bodies.size(); ++i) {
    const BodyLook& look = view.bodies[i];
    const auto count = static_cast<std::size_t>(look.vertices->cols());
    shade_values.resize(std::max(shade_values.size(), count));
    const std::span<float> shaded = std::span(shade_values).first(count);
    shade_on_body.find(*look.vertices, *look.normals, look.camera_from_body,
                       light_on(look, view.light).key, shaded);
    buffers[i].shaded.stream(std::span<const float>(shaded));
  }
}

void SceneRenderer::State::draw_bodies(const SceneView& view) {
  targets->body.bind();
  constexpr std::array<float, 4> kNone{};
  glClearNamedFramebufferfv(targets->body.get(), GL_COLOR, 0, kNone.data());
  glClearNamedFramebufferfv(targets->body.get(), GL_COLOR, 1, kNone.data());
  glClearNamedFramebufferfv(targets->body.get(), GL_DEPTH, 0, kNone.data());
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);  // reversed: 0 is infinity
  glEnable(GL_CULL_FACE);
  glFrontFace(GL_CW);  // counter-clockwise in a frame whose Y points down the rows
  glEnable(GL_PROGRAM_POINT_SIZE);
  for (std::size_t i = 0; i < view.bodies.size(); ++i) {
    if (!is_translucent(view.bodies[i])) draw_body(view, i);
  }
  if (has_translucent(view)) draw_translucent(view);
  glDisable(GL_CULL_FACE);
  glDisable(GL_DEPTH_TEST);
}

// Puts translucent bodies over the opaque ones. Their depth is drawn first, so that of the surfaces
// at a pixel only the nearest is mixed in.
void SceneRenderer::State::draw_translucent(const SceneView& view) {
  const auto draw_all = [&] {
    for (std::size_t i = 0; i < view.bodies.size(); ++i) {
      if (is_translucent(view.bodies[i])) draw_body(view, i);
    }
  };
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  draw_all();
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthFunc(GL_EQUAL);
  glEnablei(GL_BLEND, 0);  // the colour, not the depth in attachment 1
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  draw_all();
  glDisablei(GL_BLEND, 0);
}

// Draws one body with its dots.
void SceneRenderer::State::draw_body(const SceneView& view, std::size_t number) {
  const BodyLook& look = view.bodies[number];
  const Light light = light_on(look, view.light);
  const auto set_common = [&](const GlProgram& program) {
    set_camera(program, view.camera);
    program.set("camera_from_body", look.camera_from_body.matrix().cast<float>().eval());
    program.set("key", light.key);
    program.set("up", light.up);
    program.set("lamp", view.light.lamp);
    program.set("light_color", view.light.color);
    program.use();
  };
  const GlProgram& program = look.two_sided ? two_sided_body_program : body_program;
  set_common(program);
  program.set("scalar_max", look.scalar_max);
  program.set("material", shader_color(look.material));
  if (!look.two_sided) program.set("scale", static_cast<int>(look.colors));
  program.set("opaque", look.opaque_share());
  program.set("opacity", look.opacity);
  program.set("mark_color", shader_color(look.mark_color));
  buffers[number].inputs.bind();
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(look.triangles->size()), GL_UNSIGNED_INT,
                 nullptr);
  if (look.dots.empty()) return;
  set_common(dot_program);
  buffers[number].dot_inputs.bind();
  glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(look.dots.size()));
}

void SceneRenderer::State::draw_shadows(const SceneView& view, const PixelBox& box,
                                        const RealSurface& real) {
  targets->ground.bind();
  shade_on_real.clear(box);
  for (std::size_t i = 0; i < view.bodies.size(); ++i) {
    const BodyLook& look = view.bodies[i];
    if (look.shadow <= 0.0f || look.vertices->cols() == 0) continue;
    shade_on_real.add(buffers[i].shadow, look.camera_from_body, look.shadow, real);
  }
  const PixelBox& shaded = shade_on_real.shaded();
  if (shaded.empty()) return;
  if (light_left.width() < shade_on_real.width() || light_left.height() < shade_on_real.height()) {
    light_left =
        GlTexture(GL_R32F, (view.camera.width + 1) / 2, (view.camera.height + 1) / 2, GL_LINEAR);
  }
  light_left.upload(0, 0, shade_on_real.width(), shade_on_real.height(), GL_RED, GL_FLOAT,
                    shade_on_real.left().data());
  glEnable(GL_BLEND);
  glBlendFunc(GL_ZERO, GL_SRC_COLOR);
  shadow_program.set("corner", Eigen::Vector2i(box.x, box.y).cast<float>().eval());
  shadow_program.set(
      "used", Eigen::Vector2i(shade_on_real.width(), shade_on_real.height()).cast<float>().eval());
  shadow_program.use();
  light_left.bind(0);
  glScissor(shaded.x, shaded.y, shaded.width, shaded.height);
  triangle.draw();
  glScissor(box.x, box.y, box.width, box.height);
  glDisable(GL_BLEND);
}

void SceneRenderer::State::compose_picture(const SceneView& view, const Boxes& boxes,
                                           const Eigen::Vector2f& depth_per_picture) {
  const bool any_real = depth_per_picture.x() > 0.0f;
  targets->composed.bind();
  constexpr std::array<float, 4> kNone{};
  glClearNamedFramebufferfv(targets->composed.get(), GL_COLOR, 1, kNone.data());
  const PixelBox& bodies = boxes.bodies;
  if (bodies.empty()) return;
  const bool translucent = has_translucent(view);
  const bool all_fine = !translucent && fine_box.x <= bodies.x && fine_box.y <= bodies.y &&
                        fine_box.right() >= bodies.right() && fine_box.bottom() >= bodies.bottom();
  const GlProgram& program = view.hard_occlusion ? compose_hard_program
                             : translucent       ? compose_translucent_program
                             : all_fine          ? compose_fine_program
                                                 : compose_program;
  glScissor(bodies.x, bodies.y, bodies.width, bodies.height);
  glEnablei(GL_BLEND, 0);  // attachment 0 only; the mask is not blended
  glBlendFuncSeparate(GL_ONE, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
  targets->body_color.bind(0);
  targets->body_z.bind(1);
  if (!view.hard_occlusion) {
    fine_depth.bind(3);
    program.set("fine_box", floats_of(fine_box));
  }
  if (!all_fine) {
    (any_real ? real_depth : nothing_real).bind(2);
    program.set("depth_per_picture", depth_per_picture);
  }
  glProgramUniform2i(program.get(), glGetUniformLocation(program.get(), "last"),
                     view.camera.width - 1, view.camera.height - 1);
  program.use();
  triangle.draw();
  glDisablei(GL_BLEND, 0);
}

void SceneRenderer::State::read_back(const PixelBox& box, ColorImage& picture, MaskImage* visible,
                                     DepthImage* depth) {
  const auto w = static_cast<std::size_t>(box.width);
  const auto count = w * static_cast<std::size_t>(box.height);
  rgba.resize(std::max(rgba.size(), 4 * count));
  targets->composed.read(0, box.x, box.y, box.width, box.height, GL_RGBA, GL_UNSIGNED_BYTE,
                         rgba.data());
  if (visible != nullptr) {
    mask_rows.resize(std::max(mask_rows.size(), count));
    targets->composed.read(1, box.x, box.y, box.width, box.height, GL_RED, GL_UNSIGNED_BYTE,
                           mask_rows.data());
  }
  if (depth != nullptr) {
    z_rows.resize(std::max(z_rows.size(), count));
    targets->body.read(1, box.x, box.y, box.width, box.height, GL_RED, GL_FLOAT, z_rows.data());
  }
  for (int y = 0; y < box.height; ++y) {
    const std::size_t first = w * static_cast<std::size_t>(y);
    const std::uint8_t* from = rgba.data() + 4 * first;
    Rgb* to = picture.row(box.y + y) + box.x;
    for (std::size_t x = 0; x < w; ++x) to[x] = {from[4 * x], from[4 * x + 1], from[4 * x + 2]};
    if (visible != nullptr) {
      std::memcpy(visible->row(box.y + y) + box.x, mask_rows.data() + first, w);
    }
    if (depth != nullptr) {
      float* z = depth->row(box.y + y) + box.x;
      for (std::size_t x = 0; x < w; ++x) {
        if (z_rows[first + x] > 0.0f) z[x] = z_rows[first + x];
      }
    }
  }
}

}  // namespace palpable

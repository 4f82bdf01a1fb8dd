#include "palpable/live/render/map_renderer.h"

#include "palpable/common/base/contract.h"
#include "palpable/live/render/gl_objects.h"
#include "palpable/live/render/shader_files.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

namespace palpable {
namespace {

constexpr float kMapNear = 0.02f;        // m
constexpr float kThroughSurface = 0.3f;  // opacity of a line behind a surface
constexpr std::array<float, 4> kBackground{0.925f, 0.930f, 0.940f, 1.0f};

// The same view, `factor` times as large: the inverse of PinholeCamera::scaled_down().
PinholeCamera scaled_up(const PinholeCamera& c, int factor) {
  const double f = factor;
  return {c.width * factor, c.height * factor,         c.fx_px * f,
          c.fy_px * f,      (c.cx_px + 0.5) * f - 0.5, (c.cy_px + 0.5) * f - 0.5};
}

void set_map_camera(const GlProgram& program, const PinholeCamera& camera) {
  program.set(
      "pinhole",
      Eigen::Vector4d(camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px).cast<float>().eval());
  program.set("size", Eigen::Vector2i(camera.width, camera.height).cast<float>().eval());
  program.set("near", kMapNear);
}

struct Target {
  Target(int width, int height)
      : color(GL_RGBA8, width, height),
        window_depth(GL_DEPTH_COMPONENT32F, width, height),
        framebuffer(std::array<const GlTexture*, 1>{&color}, &window_depth) {}
  GlTexture color, window_depth;
  GlFramebuffer framebuffer;
};

struct MapBodyBuffers {
  MapBodyBuffers() {
    inputs.floats(0, vertices, 3);
    inputs.floats(1, normals, 3);
    inputs.floats(2, scalar, 1);
    inputs.floats(3, marks, 1);
    inputs.floats(4, marks, 1);  // all 0: no shade by real things, as there are no marks
    inputs.indices(triangles);
  }
  GlBuffer vertices, normals, scalar, marks, triangles;
  GlVertexArray inputs;
};

std::span<const float> floats_in(const Eigen::Matrix3Xf& m) {
  return {m.data(), static_cast<std::size_t>(m.size())};
}

}  // namespace

struct MapRenderer::State {
  /// @param programs  in the order of kSources
  explicit State(std::vector<GlProgram> programs)
      : surface(std::move(programs[0])),
        line(std::move(programs[1])),
        point(std::move(programs[2])),
        body(std::move(programs[3])) {
    constexpr int kFloat = sizeof(float);
    for (const int i : {0, 1, 2}) {
      room.floats(static_cast<GLuint>(i), room_vertices, 3, 9 * kFloat, 3 * i * kFloat);
      lines.floats(static_cast<GLuint>(i), line_values, 3, 10 * kFloat, 3 * i * kFloat, true);
    }
    lines.floats(3, line_values, 1, 10 * kFloat, 9 * kFloat, true);
    room.indices(room_triangles);
    points.floats(0, point_values, 3, 7 * kFloat, 0);
    points.floats(1, point_values, 1, 7 * kFloat, 3 * kFloat);
    points.floats(2, point_values, 3, 7 * kFloat, 4 * kFloat);
  }

  void draw_room(const PinholeCamera& camera, const MapView& view);
  void draw_bodies(const PinholeCamera& camera, const MapView& view);
  void draw_points(const PinholeCamera& camera, const MapView& view);
  void draw_lines(const PinholeCamera& camera, const MapView& view);
  void read_back(int factor, ColorImage& picture);

  GlProgram surface, line, point, body;
  GlBuffer room_vertices, room_triangles, line_values, point_values;
  GlVertexArray room, lines, points;
  GLsizei room_indices = 0;
  std::vector<MapBodyBuffers> bodies;
  std::unique_ptr<Target> target;
  // Kept between frames so that nothing is allocated.
  std::vector<float> values;
  std::vector<std::uint8_t> rgba;
};

MapRenderer::MapRenderer(std::unique_ptr<State> state) : state_(std::move(state)) {}
MapRenderer::MapRenderer(MapRenderer&&) noexcept = default;
MapRenderer& MapRenderer::operator=(MapRenderer&&) noexcept = default;
MapRenderer::~MapRenderer() = default;

Result<MapRenderer> MapRenderer::make() {
  constexpr std::array<ProgramSource, 4> kSources = {{{"map_surface.vert", "map_surface.frag"},
                                                      {"map_line.vert", "map_line.frag"},
                                                      {"dot.vert", "dot.frag"},
                                                      {"body.vert", "body.frag"}}};
  Result<std::vector<GlProgram>> made = make_programs(render_shader_files(), kSources);
  if (!made.ok()) return made.problem();
  return MapRenderer(std::make_unique<State>(std::move(made).value()));
}

void MapRenderer::set_surface(const MapSurface& surface) {
  PALPABLE_EXPECT(
      surface.vertices != nullptr && surface.normals != nullptr && surface.triangles != nullptr,
      "a surface has vertices, normals and triangles");
  const auto& [vertices, normals, triangles, colors] = surface;
  PALPABLE_EXPECT(vertices->cols() == normals->cols() &&
                      static_cast<std::size_t>(vertices->cols()) == colors.size(),
                  "a normal and a colour per vertex");
  State& s = *state_;
  s.values.resize(9 * colors.size());
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    Eigen::Map<Eigen::Matrix<float, 9, 1>> vertex(&s.values[9 * i]);
    vertex << vertices->col(column), normals->col(column), shader_color(colors[i]);
  }
  s.room_vertices.stream(std::span<const float>(s.values));
  s.room_triangles.stream(
      std::span<const int>(triangles->data(), static_cast<std::size_t>(triangles->size())));
  s.room_indices = static_cast<GLsizei>(triangles->size());
}

void MapRenderer::draw(const MapView& view, ColorImage& picture) {
  PALPABLE_EXPECT(view.camera.width > 0 && view.camera.height > 0, "the picture has a size");
  PALPABLE_EXPECT(view.supersampling >= 1, "pictures are not drawn smaller than they are");
  State& s = *state_;
  const PinholeCamera camera = scaled_up(view.camera, view.supersampling);
  if (!s.target || s.target->color.width() != camera.width ||
      s.target->color.height() != camera.height) {
    s.target = std::make_unique<Target>(camera.width, camera.height);
  }
  s.target->framebuffer.bind();
  constexpr std::array<float, 4> kFar{};
  glClearNamedFramebufferfv(s.target->framebuffer.get(), GL_COLOR, 0, kBackground.data());
  glClearNamedFramebufferfv(s.target->framebuffer.get(), GL_DEPTH, 0, kFar.data());
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);  // reversed: 0 is infinity
  glEnable(GL_CULL_FACE);
  glFrontFace(GL_CW);  // counter-clockwise in a frame whose Y points down the rows
  glEnable(GL_PROGRAM_POINT_SIZE);
  s.draw_room(camera, view);
  s.draw_bodies(camera, view);
  glDisable(GL_CULL_FACE);
  s.draw_points(camera, view);
  s.draw_lines(camera, view);
  glDisable(GL_DEPTH_TEST);
  picture.resize(view.camera.width, view.camera.height);
  s.read_back(view.supersampling, picture);
}

void MapRenderer::State::draw_room(const PinholeCamera& camera, const MapView& view) {
  if (room_indices == 0) return;
  set_map_camera(surface, camera);
  surface.set("camera_from_world", view.camera_from_world.matrix().cast<float>().eval());
  surface.set("up", view.up.cast<float>().eval());
  surface.use();
  room.bind();
  glDrawElements(GL_TRIANGLES, room_indices, GL_UNSIGNED_INT, nullptr);
}

void MapRenderer::State::draw_bodies(const PinholeCamera& camera, const MapView& view) {
  while (bodies.size() < view.bodies.size()) bodies.emplace_back();
  for (std::size_t i = 0; i < view.bodies.size(); ++i) {
    const BodyLook& look = view.bodies[i];
    PALPABLE_EXPECT(!look.two_sided, "a map paints fields of one sign");
    MapBodyBuffers& to = bodies[i];
    const auto count = static_cast<std::size_t>(look.vertices->cols());
    to.vertices.stream(floats_in(*look.vertices));
    to.normals.stream(floats_in(*look.normals));
    values.assign(count, 0.0f);
    to.marks.stream(std::span<const float>(values));
    to.scalar.stream(look.scalar.empty() ? std::span<const float>(values) : look.scalar);
    to.triangles.stream(std::span<const int>(look.triangles->data(),
                                             static_cast<std::size_t>(look.triangles->size())));
    const Eigen::Vector3f up = look.camera_from_body.linear().col(2).cast<float>();
    set_map_camera(body, camera);
    body.set("camera_from_body", look.camera_from_body.matrix().cast<float>().eval());
    body.set("scalar_max", look.scalar_max);
    body.set("material", shader_color(look.material));
    body.set("scale", static_cast<int>(look.colors));
    body.set("opaque", look.opaque_share());
    body.set("mark_color", shader_color(look.mark_color));
    body.set("up", up);
    body.set("key", usual_lamp(up.cast<double>()).cast<float>().eval());
    body.set("lamp", 1.0f);
    body.set("light_color", Eigen::Vector3f(1, 1, 1));
    body.use();
    to.inputs.bind();
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(look.triangles->size()), GL_UNSIGNED_INT,
                   nullptr);
  }
}

void MapRenderer::State::draw_points(const PinholeCamera& camera, const MapView& view) {
  if (view.points.empty()) return;
  values.clear();
  for (const MapPoint& p : view.points) {
    const Eigen::Vector3f tint = shader_color(p.color);
    values.insert(values.end(),
                  {p.at.x(), p.at.y(), p.at.z(), p.radius, tint.x(), tint.y(), tint.z()});
  }
  point_values.stream(std::span<const float>(values));
  const Eigen::Vector3f up = (view.camera_from_world.linear() * view.up).cast<float>();
  set_map_camera(point, camera);
  point.set("camera_from_body", view.camera_from_world.matrix().cast<float>().eval());
  point.set("up", up);
  point.set("key", usual_lamp(up.cast<double>()).cast<float>().eval());
  point.set("lamp", 1.0f);
  point.set("light_color", Eigen::Vector3f(1, 1, 1));
  point.use();
  points.bind();
  glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(view.points.size()));
}

void MapRenderer::State::draw_lines(const PinholeCamera& camera, const MapView& view) {
  if (view.lines.empty()) return;
  values.clear();
  for (const MapLine& l : view.lines) {
    const Eigen::Vector3f tint = shader_color(l.color);
    values.insert(values.end(), {l.from.x(), l.from.y(), l.from.z(), l.to.x(), l.to.y(), l.to.z(),
                                 tint.x(), tint.y(), tint.z(), 0.5f * l.width_px});
  }
  line_values.stream(std::span<const float>(values));
  set_map_camera(line, camera);
  line.set("camera_from_world", view.camera_from_world.matrix().cast<float>().eval());
  line.set("width_scale", static_cast<float>(view.supersampling));
  line.use();
  lines.bind();
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glDepthMask(GL_FALSE);
  // Hidden parts of lines are drawn first, without round ends: blended ends that overlap would be
  // visible as dots.
  for (const bool hidden : {true, false}) {
    glDepthFunc(hidden ? GL_LEQUAL : GL_GREATER);
    line.set("opacity", hidden ? kThroughSurface : 1.0f);
    line.set("cap", hidden ? 0.0f : 1.0f);
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(view.lines.size()));
  }
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
}

// Each pixel becomes the mean of factor x factor pixels.
void MapRenderer::State::read_back(int factor, ColorImage& picture) {
  const int width = target->color.width(), height = target->color.height();
  rgba.resize(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  target->framebuffer.read(0, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
  const auto row = 4 * static_cast<std::size_t>(width);
  const auto f = static_cast<std::size_t>(factor);
  const int n = factor * factor;
  for (int y = 0; y < picture.height(); ++y) {
    const std::uint8_t* from = rgba.data() + static_cast<std::size_t>(y) * f * row;
    Rgb* to = picture.row(y);
    const auto columns = static_cast<std::size_t>(picture.width());
    if (factor == 1) {
      for (std::size_t x = 0; x < columns; ++x)
        to[x] = {from[4 * x], from[4 * x + 1], from[4 * x + 2]};
      continue;
    }
    for (std::size_t x = 0; x < columns; ++x) {
      std::array<int, 3> sum{n / 2, n / 2, n / 2};
      for (std::size_t j = 0; j < f; ++j) {
        for (std::size_t i = 0; i < f; ++i) {
          const std::uint8_t* p = from + j * row + 4 * (x * f + i);
          for (std::size_t c = 0; c < 3; ++c) sum[c] += p[c];
        }
      }
      to[x] = {static_cast<std::uint8_t>(sum[0] / n), static_cast<std::uint8_t>(sum[1] / n),
               static_cast<std::uint8_t>(sum[2] / n)};
    }
  }
}

void add_frustum(std::vector<MapLine>& lines, const PinholeCamera& camera,
                 const Rigid3& world_from_camera, double depth, Rgb color, float width_px) {
  const Eigen::Vector3f eye = world_from_camera.translation().cast<float>();
  std::array<Eigen::Vector3f, 4> corner;
  for (std::size_t i = 0; i < 4; ++i) {
    const double u = i == 1 || i == 2 ? camera.width - 0.5 : -0.5;
    const double v = i >= 2 ? camera.height - 0.5 : -0.5;
    corner[i] = (world_from_camera * camera.unproject(u, v, depth)).cast<float>();
  }
  for (std::size_t i = 0; i < 4; ++i) {
    lines.push_back({eye, corner[i], color, width_px});
    lines.push_back({corner[i], corner[(i + 1) % 4], color, width_px});
  }
}

}  // namespace palpable

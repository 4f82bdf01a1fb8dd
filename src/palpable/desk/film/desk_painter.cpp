#include "palpable/desk/film/desk_painter.h"

#include "palpable/desk/film/mover_meshes.h"
#include "palpable/desk/film/seen_box.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace palpable {

namespace {

constexpr double kNearest = SeenBox::kNearest;  // m, near plane
constexpr double kFarthest = 24.0;              // m, far plane

/// m, width of the filtered edge outside a shadow, a few texels of the shadow map.
constexpr double kShadowSpread = 0.005;

/// The projection of an eye at the origin that looks along Z, with Y down. Row 0 of the picture is
/// row 0 of the texture, so that pictures need no flipping when they are read back.
Eigen::Matrix4f clip_from_camera(const PinholeCamera& c) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Zero();
  // u = fx X/Z + cx is 0 at the centre of pixel 0, window coordinates are 0 at its corner.
  m(0, 0) = 2.0 * c.fx_px / c.width;
  m(0, 2) = 2.0 * (c.cx_px + 0.5) / c.width - 1.0;
  m(1, 1) = 2.0 * c.fy_px / c.height;
  m(1, 2) = 2.0 * (c.cy_px + 0.5) / c.height - 1.0;
  m(2, 2) = (kFarthest + kNearest) / (kFarthest - kNearest);
  m(2, 3) = -2.0 * kFarthest * kNearest / (kFarthest - kNearest);
  m(3, 2) = 1.0;
  return m.cast<float>();
}

GlTexture upload(const ColorImage& image) {
  const int larger = std::max(image.width(), image.height());
  const int levels = 1 + static_cast<int>(std::floor(std::log2(larger)));
  GlTexture texture(GL_RGB8, image.width(), image.height(), GL_LINEAR, levels);
  texture.upload(0, 0, image.width(), image.height(), GL_RGB, GL_UNSIGNED_BYTE, image.data());
  texture.make_mipmaps();
  texture.repeat();
  return texture;
}

bool same(std::span<const HandCapsule> a, std::span<const HandCapsule> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const HandCapsule& c, const HandCapsule& d) {
                      return c.shape.a == d.shape.a && c.shape.b == d.shape.b && c.back == d.back &&
                             c.part == d.part;
                    });
}

/// The rectangle of the ideal picture that movers can change, with or without their shadow.
PixelBox touched_by(std::span<const HandCapsule> capsules, const Eye& eye,
                    const Rigid3& eye_from_desk, bool shadow) {
  SeenBox box(eye.ideal);
  for (const HandCapsule& capsule : capsules) {
    const auto& [a, b, ra, rb] = capsule.shape;
    box.include(eye_from_desk * a, ra, eye_from_desk * b, rb);
    if (!shadow) continue;
    // The shadow on the desk. A higher surface with the shadow lies between the mover and this one.
    const auto fallen = [&](const Eigen::Vector3d& x) {
      return Eigen::Vector3d(eye_from_desk * (x - std::max(0.0, x.z()) / to_sun().z() * to_sun()));
    };
    const auto spread = [](double radius) { return radius / to_sun().z() + kShadowSpread; };
    box.include(fallen(a), spread(ra), fallen(b), spread(rb));
    box.include(eye_from_desk * a, ra, fallen(a), spread(ra));
    box.include(eye_from_desk * b, rb, fallen(b), spread(rb));
  }
  return box.pixels();
}

/// Copies a rectangle of a picture to the same position of another with equal format and size.
void copy(const GlTexture& from, GLuint to, GLenum kind, int layer, const PixelBox& box) {
  glCopyImageSubData(from.get(), GL_TEXTURE_2D, 0, box.x, box.y, 0, to, kind, 0, box.x, box.y,
                     layer, box.width, box.height, 1);
}
void copy(const GlTexture& from, const GlTexture& to, const PixelBox& box) {
  copy(from, to.get(), GL_TEXTURE_2D, 0, box);
}
void copy(const GlTexture& from, const GlTextureArray& to, int layer, const PixelBox& box) {
  copy(from, to.get(), GL_TEXTURE_2D_ARRAY, layer, box);
}

void begin_mesh(const Paint& paint, const GpuMesh& mesh, const std::vector<GlTexture>& images) {
  paint.program.use();
  images[mesh.image].bind(0);
  if (!paint.far && paint.sun) {
    paint.program.set("gloss", mesh.gloss);
    paint.program.set("sharpness", mesh.sharpness);
  }
}

}  // namespace

DeskPainter::DeskPainter(PaintPrograms programs, const DeskScene& scene, const DeskLook& look)
    : look_(look),
      programs_(std::move(programs)),
      still_shadow_(2048, light_from_desk({0.0, 0.15, 0.0}, 0.80, 1.5)),
      moving_shadow_(1024, light_from_desk({0.10, 0.0, 0.05}, 0.50, 1.5)),
      shaded_by_movers_(still_shadow_.light) {
  for (const ColorImage& image : scene.images) images_.push_back(upload(image));
  for (const ColorImage& image : mover_images(look)) {
    mover_images_.push_back(upload(image));
    movers_.push_back(std::make_unique<GpuMesh>());
  }
  for (const PaintedMesh& mesh : scene.meshes) {
    meshes_.push_back(std::make_unique<GpuMesh>());
    meshes_.back()->fill(mesh);
  }
  cast_shadows(still_shadow_, 0.0F, [this] {
    for (const auto& mesh : meshes_)
      if (mesh->in_shadows) mesh->draw();
  });
  light_desk(still_shadow_, {0, 0, still_shadow_.depth.width(), still_shadow_.depth.height()});
  for (const PaintedMesh& mesh : scene.meshes) {
    const Caster caster(mesh, still_shadow_.light);
    places_.push_back(caster.box);
    if (mesh.in_shadows) casters_.push_back(caster);
  }
  shade_by_movers(0.5F);  // there are no movers yet
}

void DeskPainter::draw_static() const {
  for (const auto& mesh : meshes_) mesh->draw();
}
void DeskPainter::draw_movers() const {
  for (const auto& mesh : movers_) mesh->draw();
}

void DeskPainter::shade_by_movers(float along) {
  if (shadow_along_ == along) return;
  cast_shadows(moving_shadow_, along, [this] { draw_movers(); });
  light_desk(moving_shadow_, movers_in(moving_shadow_).texels(moving_shadow_.depth.width()));
  shadow_along_ = along;
}

void DeskPainter::place(const Movers& first, const Movers& last) {
  if (same(first_, first.capsules) && same(last_, last.capsules)) return;
  const bool moves = !same(first.capsules, last.capsules);
  const auto meshes_at = [&](const Movers& now, const Movers& then) {
    return mover_meshes(
        now.capsules, now.desk_from_cup, look_,
        moves ? std::span<const HandCapsule>(then.capsules) : std::span<const HandCapsule>());
  };
  const std::vector<PaintedMesh> before = meshes_at(first, last);
  const std::vector<PaintedMesh> after =
      moves ? meshes_at(last, first) : std::vector<PaintedMesh>();
  for (std::size_t i = 0; i < movers_.size(); ++i)
    movers_[i]->fill(before[i], moves ? after[i] : before[i], to_sun().cast<float>());
  first_ = first.capsules;
  last_ = last.capsules;
  shadow_along_.reset();
  in_shade_ = any_in_shade(first_) || any_in_shade(last_);
  shaded_by_movers_ = movers_in(still_shadow_);
}

/// Whether a shadow of a still thing may fall on one of the capsules.
bool DeskPainter::any_in_shade(std::span<const HandCapsule> capsules) const {
  return std::any_of(capsules.begin(), capsules.end(), [&](const HandCapsule& capsule) {
    return std::any_of(casters_.begin(), casters_.end(), [&](const Caster& caster) {
      return caster.may_shade(capsule.shape, still_shadow_.light);
    });
  });
}

/// The part of a shadow map that the movers cover while the shutter is open.
LightBox DeskPainter::movers_in(const ShadowMap& map) const {
  LightBox box(map.light);
  for (const auto* capsules : {&first_, &last_})
    for (const HandCapsule& capsule : *capsules) box.include(capsule.shape);
  return box;
}

/// Computes from a shadow map the share of the sun's light that reaches the desk's top; outside of
/// `box` the share is 1.
void DeskPainter::light_desk(const ShadowMap& map, const PixelBox& box) const {
  map.top_target.bind();
  constexpr std::array<float, 4> kAll = {1, 1, 1, 1};
  glClearBufferfv(GL_COLOR, 0, kAll.data());
  // Beyond its border a texture repeats its outermost texels, so these stay fully lit.
  const int inner = map.depth.width() - 2;
  const PixelBox within = box.cut({1, 1, inner, inner});
  if (within.empty()) return;
  glDisable(GL_DEPTH_TEST);
  cut_to(within);
  programs_.light_top.use();
  programs_.light_top.set("shadow", 0);
  map.depth.bind(0);
  programs_.light_top.set("spread", map.spread());
  programs_.light_top.set("depth_of_top", map.depth_of_top());
  full_screen_.draw();
  glDisable(GL_SCISSOR_TEST);
}

template <class Draw>
void DeskPainter::cast_shadows(const ShadowMap& map, float along, const Draw& draw) const {
  map.target.bind();
  glEnable(GL_DEPTH_TEST);
  glClearDepth(1.0);
  glClear(GL_DEPTH_BUFFER_BIT);
  // The stored depth is shifted away from the light, more so on inclined surfaces. Without the
  // shift, surfaces would cast stripes of shadow on themselves.
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(2.5F, 8.0F);
  programs_.shade.use();
  programs_.shade.set("clip_from_desk", to_clip(map.light));
  programs_.shade.set("along", along);
  draw();
  glDisable(GL_POLYGON_OFFSET_FILL);
}

/// Sets the uniforms that are the same for all surfaces of one view.
void DeskPainter::look_from(const Paint& paint, const Eye& eye, const Rigid3& eye_from_desk,
                            float along) const {
  const GlProgram& program = paint.program;
  const Eigen::Matrix4f view = eye_from_desk.matrix().cast<float>();
  program.set("clip_from_desk", Eigen::Matrix4f(clip_from_camera(eye.ideal) * view));
  program.set("image", 0);
  if (paint.sun) program.set("to_sun", Eigen::Vector3f(to_sun().cast<float>()));
  if (paint.moves) program.set("along", along);
  if (paint.moves && paint.moving_shadows)
    program.set("shadow_along", shadow_along_.value_or(along));
  if (!paint.far && paint.sun)
    program.set("eye", Eigen::Vector3f(eye_from_desk.inverse().translation().cast<float>()));
  if (paint.moving_shadows) {
    program.set("hand_light_from_desk", Eigen::Matrix4f(moving_shadow_.light.cast<float>()));
    program.set("hand_shadow", 2);
  }
  if (paint.still_shadows) {
    program.set("static_light_from_desk", Eigen::Matrix4f(still_shadow_.light.cast<float>()));
    program.set("static_shadow", 1);
  }
}

/// Sets all OpenGL state for painting from an eye, independently of what was drawn before.
void DeskPainter::begin_painting(const Eye& eye, const Rigid3& eye_from_desk, float along) const {
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);  // LEQUAL: a surface painted again over a copy of itself passes
  glClearColor(0.0F, 0.0F, 0.0F, 1.0F);
  const PaintPrograms& p = programs_;
  for (const Paint* paint :
       {&p.far, &p.still, &p.all, &p.still_top, &p.all_top, &p.mover[0], &p.mover[1],
        &p.mover_in_shade[0], &p.mover_in_shade[1], &p.mover_dark})
    look_from(*paint, eye, eye_from_desk, along);
  bind_shadows();
}

void DeskPainter::bind_shadows() const {
  still_shadow_.depth.bind(1);
  moving_shadow_.depth.bind(2);
}

void DeskPainter::draw_still(const Paint& paint, const GpuMesh& mesh) const {
  begin_mesh(paint, mesh, images_);
  mesh.draw();
}

/// Whether the shadow of the movers may fall on still mesh `i`.
bool DeskPainter::may_be_shaded(std::size_t i) const {
  return !first_.empty() && meshes_[i]->in_shadows && places_[i].meets(shaded_by_movers_);
}

void DeskPainter::paint_one(std::size_t i, bool with_moving_shadows) const {
  const GpuMesh& mesh = *meshes_[i];
  if (!mesh.in_shadows) {
    draw_still(programs_.far, mesh);
  } else if (mesh.is_desk_top) {
    // The light on it was computed before (light_desk()).
    still_shadow_.top.bind(1);
    moving_shadow_.top.bind(2);
    draw_still(with_moving_shadows ? programs_.all_top : programs_.still_top, mesh);
    bind_shadows();
  } else {
    draw_still(with_moving_shadows ? programs_.all : programs_.still, mesh);
  }
}

/// Paints all still meshes. Near ones are last in the list and painted first, so that pixels hidden
/// by them are not shaded.
void DeskPainter::paint_static(bool with_moving_shadows) const {
  for (std::size_t i = meshes_.size(); i-- > 0;)
    paint_one(i, with_moving_shadows && may_be_shaded(i));
}

/// Paints only the still meshes on which the shadow of the movers may fall.
void DeskPainter::paint_shaded() const {
  for (std::size_t i = meshes_.size(); i-- > 0;)
    if (may_be_shaded(i)) paint_one(i, true);
}

void DeskPainter::paint_movers() const {
  // Movers are closed surfaces, so triangles that face away are hidden and culled. With Y down, the
  // corners of triangles that face the eye are in clockwise order.
  glFrontFace(GL_CW);
  glEnable(GL_CULL_FACE);
  const auto& [plain, detailed] = in_shade_ ? programs_.mover_in_shade : programs_.mover;
  using Part = GpuMesh::Part;
  for (const auto& mesh : movers_)
    for (const auto& [part, paint] : {std::pair(Part::kLit, &plain),
                                      {Part::kDark, &programs_.mover_dark},
                                      {Part::kDetailed, &detailed}}) {
      if (mesh->count(part) == 0) continue;
      begin_mesh(*paint, *mesh, mover_images_);
      mesh->draw(part);
    }
  glDisable(GL_CULL_FACE);
}

/// Whether the eye's still picture shows the desk from this pose. The picture is painted at the
/// second successive call with the same pose.
bool DeskPainter::has_still(Eye& eye, const Rigid3& eye_from_desk) {
  const auto is = [&](const std::optional<Rigid3>& pose) {
    return pose && pose->matrix() == eye_from_desk.matrix();
  };
  const bool again = is(eye.last_from_desk);
  eye.last_from_desk = eye_from_desk;
  if (is(eye.still_from_desk)) return true;
  if (!again) return false;
  begin_painting(eye, eye_from_desk, 0.0F);
  copy(eye.seen_depth_turned, eye.still_depth, all_of(eye.ideal));
  eye.still_target.bind();
  glClear(GL_COLOR_BUFFER_BIT);
  paint_static(false);
  eye.still_from_desk = eye_from_desk;
  return true;
}

void DeskPainter::paint_ideal(Eye& eye, const Rigid3& eye_from_desk, const PixelBox& wanted,
                              const GlTexture& seen, float along) {
  if (!has_still(eye, eye_from_desk)) {
    begin_painting(eye, eye_from_desk, along);
    copy(seen, eye.ideal_depth, wanted);
    eye.ideal_target.bind();
    cut_to(wanted);
    glClear(GL_COLOR_BUFFER_BIT);
    paint_movers();
    paint_static(true);
    glDisable(GL_SCISSOR_TEST);
    return;
  }
  copy(eye.still_color, eye.ideal_color, wanted);
  const PixelBox box = touched(eye, eye_from_desk).cut(wanted);
  if (box.empty()) return;
  begin_painting(eye, eye_from_desk, along);
  copy(eye.still_depth, eye.ideal_depth, box);
  eye.ideal_target.bind();
  cut_to(box);
  paint_movers();
  paint_shaded();
  glDisable(GL_SCISSOR_TEST);
}

/// The rectangle that the movers can change while the shutter is open.
PixelBox DeskPainter::touched(const Eye& eye, const Rigid3& eye_from_desk, bool shadow) const {
  return united(touched_by(first_, eye, eye_from_desk, shadow),
                touched_by(last_, eye, eye_from_desk, shadow));
}

std::vector<PixelBox> DeskPainter::parts_touched(const Eye& eye, std::span<const Rigid3> poses,
                                                 bool cup) const {
  if (cup) {
    PixelBox all;
    for (const Rigid3& pose : poses) all = united(all, touched(eye, pose, false));
    return {all};
  }
  constexpr int kParts = 4;  // parts of a capsule, each with its own rectangle
  std::vector<PixelBox> parts;
  for (std::size_t i = 0; i < first_.size(); ++i)
    for (int part = 0; part < kParts; ++part) {
      SeenBox box(eye.ideal);
      for (const Rigid3& pose : poses)
        for (const HandCapsule* capsule : {&first_[i], &last_[i]}) {
          const auto& [a, b, ra, rb] = capsule->shape;
          const double from = static_cast<double>(part) / kParts, to = from + 1.0 / kParts;
          box.include(pose * (a + from * (b - a)), ra + from * (rb - ra), pose * (a + to * (b - a)),
                      ra + to * (rb - ra));
        }
      parts.push_back(box.pixels());
    }
  return parts;
}

void DeskPainter::paint_reference(Eye& eye, int index, const Rigid3& eye_from_desk, bool alone) {
  const GlFramebuffer& target = eye.stills.targets[index];
  if (alone && has_still(eye, eye_from_desk)) {
    copy(eye.still_color, eye.stills.pictures, index, all_of(eye.ideal));
    const PixelBox box = touched(eye, eye_from_desk);
    if (box.empty()) return;
    begin_painting(eye, eye_from_desk, 0.0F);
    target.bind();
    cut_to(box);
    paint_shaded();
    glDisable(GL_SCISSOR_TEST);
    return;
  }
  begin_painting(eye, eye_from_desk, 0.0F);
  copy(eye.seen_depth_turned, eye.still_depth, all_of(eye.ideal));
  eye.still_from_desk.reset();  // still_depth now belongs to this reference
  target.bind();
  glClear(GL_COLOR_BUFFER_BIT);
  paint_static(true);
}

void DeskPainter::paint_layer(const Eye& eye, int index, const Rigid3& eye_from_desk, float along) {
  eye.layers.targets[index].bind();
  constexpr std::array<float, 4> kNothing{};
  glClearBufferfv(GL_COLOR, 0, kNothing.data());
  const PixelBox box = touched(eye, eye_from_desk, false);
  if (box.empty()) return;
  copy(eye.still_depth, eye.ideal_depth, box);
  begin_painting(eye, eye_from_desk, along);
  cut_to(box);
  paint_movers();
  glDisable(GL_SCISSOR_TEST);
}

void DeskPainter::measure(const GlFramebuffer& target, const Rigid3& camera_from_desk,
                          const PinholeCamera& view) const {
  target.bind();
  glEnable(GL_DEPTH_TEST);
  const std::array<float, 4> nothing = {std::numeric_limits<float>::quiet_NaN(), 0, 0, 0};
  glClearBufferfv(GL_COLOR, 0, nothing.data());
  glClear(GL_DEPTH_BUFFER_BIT);
  const GlProgram& program = programs_.measure;
  program.use();
  const Eigen::Matrix4f desk = camera_from_desk.matrix().cast<float>();
  program.set("clip_from_desk", Eigen::Matrix4f(clip_from_camera(view) * desk));
  program.set("depth_from_desk", Eigen::Vector4f(desk.row(2)));
  program.set("moves", 1.0F);
  draw_movers();
  program.set("moves", 0.0F);
  draw_static();
}

}  // namespace palpable

#include "palpable/synth/desk_renderer.h"

#include "palpable/base/contract.h"
#include "palpable/render/gl_context.h"
#include "palpable/render/gl_objects.h"
#include "palpable/synth/desk_gpu.h"
#include "palpable/synth/exposure.h"
#include "palpable/synth/lens.h"
#include "palpable/synth/random.h"
#include "palpable/synth/texture_images.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace palpable {

std::span<const ShaderFile> synth_shader_files();

namespace {

constexpr double kNearest = SeenBox::kNearest;  // m, of what is drawn
constexpr double kFarthest = 24.0;

/// Eyes stand at Z = 0 and look along Z with Y down; row 0 of the picture is row 0 of the texture,
/// so nothing is flipped on the way to memory.
Eigen::Matrix4f clip_from_camera(const PinholeCamera& c) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Zero();
  // u = fx X/Z + cx counts from the middle of a pixel, window coordinates from its corner.
  m(0, 0) = 2.0 * c.fx_px / c.width;
  m(0, 2) = 2.0 * (c.cx_px + 0.5) / c.width - 1.0;
  m(1, 1) = 2.0 * c.fy_px / c.height;
  m(1, 2) = 2.0 * (c.cy_px + 0.5) / c.height - 1.0;
  m(2, 2) = (kFarthest + kNearest) / (kFarthest - kNearest);
  m(2, 3) = -2.0 * kFarthest * kNearest / (kFarthest - kNearest);
  m(3, 2) = 1.0;
  return m.cast<float>();
}

const Eigen::Vector3d kToSun = Eigen::Vector3d(-0.46, -0.30, 0.84).normalized();

/// Parallel light over a square of the desk: maps it and what is above into 0..1 cubed.
Eigen::Matrix4d light_from_desk(const Eigen::Vector3d& centre, double half_width, double reach) {
  Eigen::Matrix3d R;
  R.row(2) = -kToSun;
  R.row(0) = Eigen::Vector3d::UnitY().cross(kToSun).normalized();
  R.row(1) = R.row(2).cross(R.row(0));
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.block<2, 3>(0, 0) = R.topRows<2>() / (2.0 * half_width);
  m.block<1, 3>(2, 0) = R.row(2) / (2.0 * reach);
  m.block<3, 1>(0, 3) = Eigen::Vector3d::Constant(0.5) - m.block<3, 3>(0, 0) * centre;
  return m;
}

/// From 0..1 to the -1..1 of clip coordinates.
Eigen::Matrix4f to_clip(const Eigen::Matrix4d& m) {
  Eigen::Matrix4d scale = 2.0 * Eigen::Matrix4d::Identity();
  scale.block<3, 1>(0, 3).setConstant(-1.0);
  scale(3, 3) = 1.0;
  return (scale * m).cast<float>();
}

/// How far (m) the filtered edge of a shadow reaches beyond the shadow: a few texels.
constexpr double kShadowSpread = 0.005;

GlTexture upload(const ColorImage& image) {
  const int larger = std::max(image.width(), image.height());
  const int levels = 1 + static_cast<int>(std::floor(std::log2(larger)));
  GlTexture texture(GL_RGB8, image.width(), image.height(), GL_LINEAR, levels);
  texture.upload(0, 0, image.width(), image.height(), GL_RGB, GL_UNSIGNED_BYTE, image.data());
  texture.make_mipmaps();
  texture.repeat();
  return texture;
}

/// Rows that are read as if at one moment.
struct Band {
  double frame = 0;
  int first_row = 0, last_row = 0;
  double frames_per_row = 0;
};

}  // namespace

struct DeskRenderer::State {
  /// desk.vert and desk.frag, and what was defined for them.
  struct Paint {
    GlProgram program;
    bool far = false, moves = false;
    bool sun = true;  // else it looks away
    bool still_shadows = false, moving_shadows = false;
  };

  GlContext context;  // first, so that it is destroyed last
  DeskCamera rig;
  DeskLook look;
  GlProgram shade, measure, light_top;
  // sensor.frag: of a sharp picture, of rows, and of an exposure [with layers][that turns].
  GlProgram sense, sense_rows;
  std::array<std::array<GlProgram, 2>, 2> sense_exposed;
  // What stands still: far away, with still shadows or with all, and the same on the desk's top.
  Paint paint_far, paint_still, paint_all, paint_still_top, paint_all_top;
  // Plain, and with nails and creases.
  std::array<Paint, 2> paint_mover, paint_mover_in_shade;
  Paint paint_mover_dark;
  FullScreenTriangle full_screen;
  std::vector<GlTexture> images, hand_images;
  std::vector<std::unique_ptr<GpuMesh>> meshes;
  std::vector<std::unique_ptr<GpuMesh>> movers;
  // What `movers` shows: as the shutter opens and as it closes.
  std::vector<HandCapsule> filled, filled_last;
  std::optional<float> shadow_along;  // the moment of their shadow, 0 as it opens .. 1 as it closes
  bool in_shade = false;              // whether shadows of what stands still may fall on it
  std::vector<Caster> casters;
  ShadowMap static_shadow, hand_shadow;
  // Where each of `meshes` is, and the movers, in static_shadow's map.
  std::vector<LightBox> places;
  LightBox shaded_by_movers;
  Eye left, right;
  std::optional<DepthTarget> depth_target;

  State(GlContext gl, const DeskCamera& camera, const DeskScene& scene, const DeskLook& look_,
        std::vector<GlProgram> programs)
      : context(std::move(gl)),
        rig(camera),
        look(look_),
        shade(std::move(programs[0])),
        measure(std::move(programs[1])),
        light_top(std::move(programs[2])),
        sense(std::move(programs[3])),
        sense_rows(std::move(programs[4])),
        sense_exposed{{{std::move(programs[5]), std::move(programs[6])},
                       {std::move(programs[7]), std::move(programs[8])}}},
        paint_far{.program = std::move(programs[9]), .far = true},
        paint_still{.program = std::move(programs[10]), .still_shadows = true},
        paint_all{
            .program = std::move(programs[11]), .still_shadows = true, .moving_shadows = true},
        paint_still_top{.program = std::move(programs[12]), .still_shadows = true},
        paint_all_top{
            .program = std::move(programs[13]), .still_shadows = true, .moving_shadows = true},
        paint_mover{{{.program = std::move(programs[14]), .moves = true, .moving_shadows = true},
                     {.program = std::move(programs[15]), .moves = true, .moving_shadows = true}}},
        paint_mover_in_shade{{{.program = std::move(programs[16]),
                               .moves = true,
                               .still_shadows = true,
                               .moving_shadows = true},
                              {.program = std::move(programs[17]),
                               .moves = true,
                               .still_shadows = true,
                               .moving_shadows = true}}},
        paint_mover_dark{.program = std::move(programs[18]), .moves = true, .sun = false},
        static_shadow(2048, light_from_desk({0.0, 0.15, 0.0}, 0.80, 1.5)),
        hand_shadow(1024, light_from_desk({0.10, 0.0, 0.05}, 0.50, 1.5)),
        shaded_by_movers(static_shadow.light),
        left(camera.rig.left, 1.0F),
        right(camera.rig.right, static_cast<float>(camera.faults.right_gain)) {
    // What the calibration does not know: the right image lies a little lower.
    right = Eye(lowered(camera.rig.right, camera.faults.row_error_px), right.gain);
    for (const ColorImage& image : scene.images) images.push_back(upload(image));
    for (const ColorImage& image : mover_images(look)) hand_images.push_back(upload(image));
    for (const PaintedMesh& mesh : scene.meshes) {
      meshes.push_back(std::make_unique<GpuMesh>());
      meshes.back()->fill(mesh);
    }
    for (std::size_t i = 0; i < hand_images.size(); ++i)
      movers.push_back(std::make_unique<GpuMesh>());
    cast_shadows(static_shadow, 0.0F, [this] {
      for (const auto& mesh : meshes)
        if (mesh->in_shadows) mesh->draw();
    });
    light_desk(static_shadow, {0, 0, static_shadow.depth.width(), static_shadow.depth.height()});
    for (const PaintedMesh& mesh : scene.meshes) {
      const Caster caster(mesh, static_shadow.light);
      places.push_back(caster.box);
      if (mesh.in_shadows) casters.push_back(caster);
    }
    fill({});
  }

  static DistortedCamera lowered(DistortedCamera camera, double rows) {
    camera.pinhole.cy_px += rows;
    return camera;
  }

  void draw_static() const {
    for (const auto& mesh : meshes) mesh->draw();
  }
  void draw_movers() const {
    for (const auto& mesh : movers) mesh->draw();
  }

  /// Uploads what moves and casts its shadow; nothing to do when it has not changed.
  void fill(const Movers& now) {
    place(now, now);
    shade_by_movers(0.5F);
  }
  /// Casts the shadow of what was placed.
  /// @param along  the moment of it, 0 as the shutter opens .. 1 as it closes
  void shade_by_movers(float along) {
    if (shadow_along == along) return;
    cast_shadows(hand_shadow, along, [this] { draw_movers(); });
    light_desk(hand_shadow, movers_in(hand_shadow).texels(hand_shadow.depth.width()));
    shadow_along = along;
  }

  /// Without its shadow.
  void place(const Movers& first, const Movers& last) {
    if (same(filled, first.capsules) && same(filled_last, last.capsules)) return;
    const bool moves = !same(first.capsules, last.capsules);
    const auto meshes_at = [&](const Movers& now, const Movers& then) {
      return mover_meshes(
          now.capsules, now.desk_from_cup, look,
          moves ? std::span<const HandCapsule>(then.capsules) : std::span<const HandCapsule>());
    };
    const std::vector<PaintedMesh> before = meshes_at(first, last);
    const std::vector<PaintedMesh> after =
        moves ? meshes_at(last, first) : std::vector<PaintedMesh>();
    for (std::size_t i = 0; i < movers.size(); ++i) {
      movers[i]->fill(before[i], moves ? after[i] : before[i], kToSun.cast<float>());
    }
    filled = first.capsules;
    filled_last = last.capsules;
    shadow_along.reset();
    in_shade = any_in_shade(filled) || any_in_shade(filled_last);
    shaded_by_movers = movers_in(static_shadow);
  }
  static bool same(std::span<const HandCapsule> a, std::span<const HandCapsule> b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const HandCapsule& c, const HandCapsule& d) {
                        return c.shape.a == d.shape.a && c.shape.b == d.shape.b &&
                               c.back == d.back && c.part == d.part;
                      });
  }

  /// Whether a shadow of what stands still may fall on one of them.
  [[nodiscard]] bool any_in_shade(std::span<const HandCapsule> capsules) const {
    return std::any_of(capsules.begin(), capsules.end(), [&](const HandCapsule& capsule) {
      return std::any_of(casters.begin(), casters.end(), [&](const Caster& caster) {
        return caster.may_shade(capsule.shape, static_shadow.light);
      });
    });
  }

  /// The part of a shadow map that the movers fill while the shutter is open.
  [[nodiscard]] LightBox movers_in(const ShadowMap& map) const {
    LightBox box(map.light);
    for (const auto* capsules : {&filled, &filled_last})
      for (const HandCapsule& capsule : *capsules) box.include(capsule.shape);
    return box;
  }

  /// How much light reaches the desk's top, from a shadow map; all of it outside `box`.
  void light_desk(const ShadowMap& map, const Box& box) const {
    map.top_target.bind();
    constexpr std::array<float, 4> kAll = {1, 1, 1, 1};
    glClearBufferfv(GL_COLOR, 0, kAll.data());
    // Beyond its border the texture goes on as it is there.
    const int inner = map.depth.width() - 2;
    const Box within = box.cut({1, 1, inner, inner});
    if (within.empty()) return;
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_SCISSOR_TEST);
    glScissor(within.x, within.y, within.width, within.height);
    light_top.use();
    light_top.set("shadow", 0);
    map.depth.bind(0);
    light_top.set("spread", map.spread());
    light_top.set("depth_of_top", map.depth_of_top());
    full_screen.draw();
    glDisable(GL_SCISSOR_TEST);
  }

  template <class Draw>
  void cast_shadows(const ShadowMap& map, float along, const Draw& draw) const {
    map.target.bind();
    glEnable(GL_DEPTH_TEST);
    glClearDepth(1.0);
    glClear(GL_DEPTH_BUFFER_BIT);
    // Slopes shift the stored depth away from the light, or surfaces shadow themselves in stripes.
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(2.5F, 8.0F);
    shade.use();
    shade.set("clip_from_desk", to_clip(map.light));
    shade.set("along", along);
    draw();
    glDisable(GL_POLYGON_OFFSET_FILL);
  }

  /// The rectangle of the ideal picture that movers can change, with their shadow or without.
  [[nodiscard]] static Box touched_by(std::span<const HandCapsule> capsules, const Eye& eye,
                                      const Rigid3& eye_from_desk, bool shadow = true) {
    SeenBox box(eye.ideal);
    for (const HandCapsule& capsule : capsules) {
      const auto& [a, b, ra, rb] = capsule.shape;
      box.include(eye_from_desk * a, ra, eye_from_desk * b, rb);
      if (!shadow) continue;
      // Its shadow on the desk; what the shadow meets on the way lies between the two.
      const auto fallen = [&](const Eigen::Vector3d& x) {
        return Eigen::Vector3d(eye_from_desk * (x - std::max(0.0, x.z()) / kToSun.z() * kToSun));
      };
      const auto spread = [](double radius) { return radius / kToSun.z() + kShadowSpread; };
      box.include(fallen(a), spread(ra), fallen(b), spread(rb));
      box.include(eye_from_desk * a, ra, fallen(a), spread(ra));
      box.include(eye_from_desk * b, rb, fallen(b), spread(rb));
    }
    return box.pixels();
  }

  /// What all surfaces of one view have in common.
  void look_from(const Paint& paint, const Eye& eye, const Rigid3& eye_from_desk,
                 float along) const {
    const GlProgram& program = paint.program;
    const Eigen::Matrix4f view = eye_from_desk.matrix().cast<float>();
    program.set("clip_from_desk", Eigen::Matrix4f(clip_from_camera(eye.ideal) * view));
    program.set("image", 0);
    if (paint.sun) program.set("to_sun", Eigen::Vector3f(kToSun.cast<float>()));
    if (paint.moves) program.set("along", along);
    if (paint.moves && paint.moving_shadows)
      program.set("shadow_along", shadow_along.value_or(along));
    if (!paint.far && paint.sun)
      program.set("eye", Eigen::Vector3f(eye_from_desk.inverse().translation().cast<float>()));
    if (paint.moving_shadows) {
      program.set("hand_light_from_desk", Eigen::Matrix4f(hand_shadow.light.cast<float>()));
      program.set("hand_shadow", 2);
    }
    if (paint.still_shadows) {
      program.set("static_light_from_desk", Eigen::Matrix4f(static_shadow.light.cast<float>()));
      program.set("static_shadow", 1);
    }
  }

  static void begin_mesh(const Paint& paint, const GpuMesh& mesh,
                         const std::vector<GlTexture>& from) {
    const GlProgram& program = paint.program;
    program.use();
    from[static_cast<std::size_t>(mesh.image)].bind(0);
    if (!paint.far && paint.sun) {
      program.set("gloss", mesh.gloss);
      program.set("sharpness", mesh.sharpness);
    }
  }
  void draw_still(const Paint& paint, const GpuMesh& mesh) const {
    begin_mesh(paint, mesh, images);
    mesh.draw();
  }

  /// Whether the movers' shadow may fall on what stands still.
  [[nodiscard]] bool may_be_shaded(std::size_t i) const {
    return !filled.empty() && meshes[i]->in_shadows && places[i].meets(shaded_by_movers);
  }
  /// Everything that stands still. Near things are last in the list: what they hide is not shaded.
  void paint_static(bool with_moving_shadows) const {
    for (std::size_t i = meshes.size(); i-- > 0;)
      paint_one(i, with_moving_shadows && may_be_shaded(i));
  }
  /// That of it on which the movers' shadow may fall.
  void paint_shaded() const {
    for (std::size_t i = meshes.size(); i-- > 0;)
      if (may_be_shaded(i)) paint_one(i, true);
  }
  void paint_one(std::size_t i, bool with_moving_shadows) const {
    const GpuMesh& mesh = *meshes[i];
    if (!mesh.in_shadows) {
      draw_still(paint_far, mesh);
    } else if (mesh.is_desk_top) {
      // Its light was looked up before (light_desk).
      static_shadow.top.bind(1);
      hand_shadow.top.bind(2);
      draw_still(with_moving_shadows ? paint_all_top : paint_still_top, mesh);
      bind_shadows();
    } else {
      draw_still(with_moving_shadows ? paint_all : paint_still, mesh);
    }
  }
  void bind_shadows() const {
    static_shadow.depth.bind(1);
    hand_shadow.depth.bind(2);
  }

  void paint_movers() const {
    // Movers are closed: half of their triangles look away. With Y down, the others run clockwise.
    glFrontFace(GL_CW);
    glEnable(GL_CULL_FACE);
    const auto& [plain, detailed] = in_shade ? paint_mover_in_shade : paint_mover;
    using Part = GpuMesh::Part;
    for (const auto& mesh : movers)
      for (const auto& [part, paint] : {std::pair(Part::kLit, &plain),
                                        {Part::kDark, &paint_mover_dark},
                                        {Part::kDetailed, &detailed}}) {
        if (mesh->count(part) == 0) continue;
        begin_mesh(*paint, *mesh, hand_images);
        mesh->draw(part);
      }
    glDisable(GL_CULL_FACE);
  }

  /// What painting from an eye needs, whatever was drawn before.
  /// @param along  the moment of the movers, 0 as the shutter opens .. 1 as it closes
  void begin_painting(const Eye& eye, const Rigid3& eye_from_desk, float along) const {
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);  // what is painted again over its own copy must pass
    glClearColor(0.0F, 0.0F, 0.0F, 1.0F);
    for (const Paint* paint :
         {&paint_far, &paint_still, &paint_all, &paint_still_top, &paint_all_top, &paint_mover[0],
          &paint_mover[1], &paint_mover_in_shade[0], &paint_mover_in_shade[1], &paint_mover_dark})
      look_from(*paint, eye, eye_from_desk, along);
    bind_shadows();
  }

  /// A rectangle of one picture into another of the same kind and size.
  static void copy(const GlTexture& from, const GlTexture& to, const Box& box) {
    copy(from, to.get(), GL_TEXTURE_2D, 0, box);
  }
  static void copy(const GlTexture& from, const GlTextureArray& to, int layer, const Box& box) {
    copy(from, to.get(), GL_TEXTURE_2D_ARRAY, layer, box);
  }
  static void copy(const GlTexture& from, GLuint to, GLenum kind, int layer, const Box& box) {
    glCopyImageSubData(from.get(), GL_TEXTURE_2D, 0, box.x, box.y, 0, to, kind, 0, box.x, box.y,
                       layer, box.width, box.height, 1);
  }
  static void cut_to(const Box& box) {
    glEnable(GL_SCISSOR_TEST);
    glScissor(box.x, box.y, box.width, box.height);
  }
  static Box all_of(const PinholeCamera& camera) { return {0, 0, camera.width, camera.height}; }

  /// Whether the eye's still picture shows the desk from this pose. It is painted when a pose comes
  /// twice in turn.
  bool has_still(Eye& eye, const Rigid3& eye_from_desk) {
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

  /// The ideal picture of one moment, within `wanted`; what is outside is left as it is.
  /// @param seen   depths to begin with where the eye moves
  /// @param along  the moment of the movers, as begin_painting's
  void paint_ideal(Eye& eye, const Rigid3& eye_from_desk, const Box& wanted, const GlTexture& seen,
                   float along) {
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
    const Box box = touched(eye, eye_from_desk).cut(wanted);
    if (box.empty()) return;
    begin_painting(eye, eye_from_desk, along);
    copy(eye.still_depth, eye.ideal_depth, box);
    eye.ideal_target.bind();
    cut_to(box);
    paint_movers();
    paint_shaded();
    glDisable(GL_SCISSOR_TEST);
  }
  /// What the movers can change while the shutter is open.
  [[nodiscard]] Box touched(const Eye& eye, const Rigid3& eye_from_desk, bool shadow = true) const {
    return around(touched_by(filled, eye, eye_from_desk, shadow),
                  touched_by(filled_last, eye, eye_from_desk, shadow));
  }

  /// Rectangles of the ideal picture that hold the movers, without their shadow, while the shutter
  /// is open: one round each quarter of a capsule; or one round all where a cup stands for some.
  [[nodiscard]] std::vector<Box> parts_touched(const Eye& eye, std::span<const Rigid3> poses,
                                               bool cup) const {
    std::vector<Box> parts;
    if (cup) {
      Box all;
      for (const Rigid3& pose : poses) all = around(all, touched(eye, pose, false));
      return {all};
    }
    constexpr int kParts = 4;
    for (std::size_t i = 0; i < filled.size(); ++i)
      for (int part = 0; part < kParts; ++part) {
        SeenBox box(eye.ideal);
        for (const Rigid3& pose : poses)
          for (const HandCapsule* capsule : {&filled[i], &filled_last[i]}) {
            const auto& [a, b, ra, rb] = capsule->shape;
            const double from = static_cast<double>(part) / kParts, to = from + 1.0 / kParts;
            box.include(pose * (a + from * (b - a)), ra + from * (rb - ra),
                        pose * (a + to * (b - a)), ra + to * (rb - ra));
          }
        parts.push_back(box.pixels());
      }
    return parts;
  }

  /// The bands of rows that a frame is read in, each as if at one moment.
  [[nodiscard]] std::vector<Band> bands_of(const DeskMoment& frame) const {
    constexpr int kCount = 6;
    const int rows = rig.rig.left.pinhole.height;
    const double frames_per_row = frame.rig.readout * kFramesPerSecond / (rows - 1);
    std::vector<Band> bands;
    for (int b = 0; b < kCount; ++b) {
      Band band;
      band.first_row = b * rows / kCount;
      band.last_row = (b + 1) * rows / kCount - 1;
      band.frames_per_row = frames_per_row;
      band.frame = frame.frame +
                   frames_per_row * (0.5 * (band.first_row + band.last_row) - 0.5 * (rows - 1));
      bands.push_back(band);
    }
    return bands;
  }

  /// One eye's part of a frame.
  struct View {
    Eye& eye;
    Rigid3 eye_from_camera;
    int noise_key;
  };

  /// What sensor.frag needs to know of lens and sensor.
  void begin_sensing(const GlProgram& program, const View& view, const DeskMoment& frame) const {
    const Eye& eye = view.eye;
    const PinholeCamera& raw = eye.camera.pinhole;
    program.use();
    eye.lens_map.bind(0);
    program.set("lens_map", 0);
    program.set("optical_centre",
                Eigen::Vector2f(static_cast<float>(raw.cx_px), static_cast<float>(raw.cy_px)));
    program.set("corner_radius", static_cast<float>(0.5 * std::hypot(raw.width, raw.height)));
    program.set("vignetting", static_cast<float>(rig.faults.vignetting));
    program.set("gain", eye.gain * static_cast<float>(frame.rig.light));
    program.set("noise", static_cast<float>(rig.faults.noise_grey_levels));
    program.set("noise_key", view.noise_key);
  }
  /// Runs the program in use over a rectangle of the raw picture.
  void draw_raw(const Eye& eye, const Box& box) const {
    if (box.empty()) return;
    eye.raw_target.bind();
    glDisable(GL_DEPTH_TEST);
    cut_to(box);
    full_screen.draw();
    glDisable(GL_SCISSOR_TEST);
  }

  /// A frame of one moment.
  void draw_at_once(const View& view, const DeskMoment& frame) {
    fill(frame.movers(frame.frame));
    Eye& eye = view.eye;
    const bool lowered = eye.lowered_by != 0.0F;
    paint_ideal(eye, view.eye_from_camera * frame.camera_from_desk(frame.frame),
                lowered ? all_of(eye.ideal) : eye.without_margin(),
                lowered ? eye.seen_depth_turned : eye.seen_depth, 0.0F);
    begin_sensing(sense, view, frame);
    sense.set("ideal", 1);
    eye.ideal_color.bind(1);
    draw_raw(eye, all_of(eye.camera.pinhole));
  }

  /// Raw rows of the ideal picture, which shows the moment of the middle one.
  /// @param turn  rad, from one row to the next; the eye's frame
  void sense_band(const View& view, const DeskMoment& frame, const Band& band,
                  const Eigen::AngleAxisd& turn) const {
    const Eye& eye = view.eye;
    begin_sensing(sense_rows, view, frame);
    sense_rows.set("ideal", 1);
    eye.ideal_color.bind(1);
    sense_rows.set("moment_row", static_cast<float>(0.5 * (band.first_row + band.last_row)));
    // Turns this small add up: a ray is that of the moment's row plus ray x turn for each row.
    const Eigen::Vector3d w = turn.angle() * turn.axis();
    Eigen::Matrix3d cross;
    cross << 0, w.z(), -w.y(), -w.z(), 0, w.x(), w.y(), -w.x(), 0;
    const Eigen::Matrix3d place_from_ray = eye.place_from_ray();
    sense_rows.set(
        "turn_per_row",
        Eigen::Matrix3f((place_from_ray * cross * place_from_ray.inverse()).cast<float>()));
    draw_raw(eye,
             {0, band.first_row, eye.camera.pinhole.width, band.last_row - band.first_row + 1});
  }

  /// Rows that are read one after the other: each band is a picture of its own moment, each two
  /// have a shadow of the movers.
  void read_rows(std::span<const View> views, const DeskMoment& frame) {
    const double half = 0.5 * frame.rig.readout * kFramesPerSecond;  // frames
    const double opens = frame.frame - half, closes = frame.frame + half;
    const auto [first, last] = movers_between(frame, opens, closes);
    place(first, last);
    const auto along_at = [&](double at) {
      return static_cast<float>((at - opens) / (closes - opens));
    };
    const std::vector<Band> bands = bands_of(frame);
    for (std::size_t b = 0; b < bands.size(); ++b) {
      const Band& band = bands[b];
      // Shadows have soft edges of 3 mm: one is enough for two bands.
      if (b % 2 == 0) shade_by_movers(along_at(0.5 * (band.frame + bands[b + 1].frame)));
      for (const View& view : views) {
        Eye& eye = view.eye;
        const auto pose_at = [&](double at) {
          return Rigid3(view.eye_from_camera * frame.camera_from_desk(at));
        };
        float top = 1e9F, bottom = -1e9F;
        for (int row = band.first_row; row <= band.last_row; ++row) {
          top = std::min(top, eye.rows[static_cast<std::size_t>(row)][0]);
          bottom = std::max(bottom, eye.rows[static_cast<std::size_t>(row)][1]);
        }
        // A few rows more: the camera turns within the band, and the filter reads neighbours.
        const int y0 = static_cast<int>(top) - 6;
        const Rigid3 pose = pose_at(band.frame);
        paint_ideal(
            eye, pose,
            all_of(eye.ideal).cut({0, y0, eye.ideal.width, static_cast<int>(bottom) + 8 - y0}),
            eye.seen_depth_turned, along_at(band.frame));
        const Eigen::AngleAxisd turn(pose_at(band.frame + band.frames_per_row).linear() *
                                     pose.linear().transpose());
        sense_band(view, frame, band, turn);
      }
    }
  }

  /// What stands still, with the shadow of what moves: into the eye's stack.
  /// @param alone  no other moment of this exposure is painted
  void paint_reference(Eye& eye, int index, const Rigid3& eye_from_desk, bool alone) {
    const GlFramebuffer& target = eye.stills.targets[static_cast<std::size_t>(index)];
    if (alone && has_still(eye, eye_from_desk)) {
      copy(eye.still_color, eye.stills.pictures, index, all_of(eye.ideal));
      const Box box = touched(eye, eye_from_desk);
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
    eye.still_from_desk.reset();
    target.bind();
    glClear(GL_COLOR_BUFFER_BIT);
    paint_static(true);
  }

  /// The movers of one moment, where what stands still does not hide them: into the eye's stack,
  /// with nothing (alpha 0) round them.
  void paint_layer(const Eye& eye, int index, const Rigid3& eye_from_desk, float along) {
    eye.layers.targets[static_cast<std::size_t>(index)].bind();
    constexpr std::array<float, 4> kNothing{};
    glClearBufferfv(GL_COLOR, 0, kNothing.data());
    const Box box = touched(eye, eye_from_desk, false);
    if (box.empty()) return;
    copy(eye.still_depth, eye.ideal_depth, box);
    begin_painting(eye, eye_from_desk, along);
    cut_to(box);
    paint_movers();
    glDisable(GL_SCISSOR_TEST);
  }

  /// The mean over an exposure: references looked at turned, with layers of movers before them.
  void expose(const View& view, const DeskMoment& frame, const Exposure& exposure) {
    const auto [opens, closes, references, layers, looks, turns] = exposure;
    const auto [first, last] = movers_between(frame, opens, closes);
    place(first, last);
    shade_by_movers(0.5F);
    Eye& eye = view.eye;
    const auto pose_at = [&](double at) {
      return Rigid3(view.eye_from_camera * frame.camera_from_desk(at));
    };
    const int all_layers = references * layers;
    const auto layer_at = [&](int layer) { return exposure.middle(layer, all_layers); };
    std::vector<Rigid3> layer_poses;
    for (int layer = 0; layer < all_layers; ++layer)
      layer_poses.push_back(pose_at(layer_at(layer)));
    const Tiles tiles =
        eye.raw_tiles(parts_touched(eye, layer_poses, first.desk_from_cup.has_value()));
    const std::vector<Box> with_movers = tiles.boxes(true);

    eye.stills.hold(references, eye.ideal, eye.still_depth);
    if (!with_movers.empty()) eye.layers.hold(all_layers, eye.ideal, eye.ideal_depth);
    const Eigen::Matrix3d place_from_ray = eye.place_from_ray();
    const Eigen::Matrix3d ray_from_place = place_from_ray.inverse();
    const auto homography = [&](const Eigen::Matrix3d& turn) {
      return Eigen::Matrix3f((place_from_ray * turn * ray_from_place).cast<float>());
    };
    std::vector<Eigen::Matrix3f> still_from_moment, still_from_layer;
    for (int r = 0; r < references; ++r) {
      const Rigid3 reference = pose_at(exposure.middle(r, references));
      paint_reference(eye, r, reference, references == 1);
      const auto turn_from = [&](double at) {
        return Eigen::Matrix3d(reference.linear() * pose_at(at).linear().transpose());
      };
      for (int layer = r * layers; layer < (r + 1) * layers; ++layer) {
        const double at = layer_at(layer);
        // Painted as if turned like the reference: its depth then says what is hidden.
        const Eigen::Matrix3d turn =
            turns ? turn_from(at) : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
        still_from_layer.push_back(homography(turn));
        for (int k = 0; k < looks; ++k)
          still_from_moment.push_back(
              homography(turn_from(exposure.middle(layer * looks + k, all_layers * looks))));
        if (!with_movers.empty())
          paint_layer(eye, layer, Rigid3(turn * pose_at(at)),
                      static_cast<float>((at - opens) / (closes - opens)));
      }
    }
    PALPABLE_EXPECT(
        still_from_layer.size() <= kMostLayers && still_from_moment.size() <= kMostLooks,
        "sensor.frag has so many layers and looks");

    const auto sense_mean = [&](std::span<const Box> boxes, bool with_layers) {
      if (boxes.empty()) return;
      const GlProgram& program = sense_exposed[with_layers ? 1 : 0][turns ? 1 : 0];
      begin_sensing(program, view, frame);
      program.set("stills", 1);
      eye.stills.pictures.bind(1);
      // Where nothing moves and the eye does not turn, one layer of a reference is like another.
      const int of_reference = with_layers || turns ? layers : 1;
      program.set("references", references);
      program.set("layers", of_reference);
      program.set("weight", 1.0F / static_cast<float>(references * of_reference * looks));
      if (with_layers) {
        program.set("movers", 2);
        eye.layers.pictures.bind(2);
      }
      if (turns) {
        program.set("looks", looks);
        program.set("still_from_moment", std::span<const Eigen::Matrix3f>(still_from_moment));
        if (with_layers)
          program.set("still_from_layer", std::span<const Eigen::Matrix3f>(still_from_layer));
      }
      for (const Box& box : boxes) draw_raw(eye, box);
    };
    sense_mean(with_movers, true);
    sense_mean(tiles.boxes(false), false);
  }

  void draw(std::span<const View> views, const DeskMoment& frame) {
    if (frame.rig.readout > 0.0) {
      read_rows(views, frame);
      return;
    }
    for (const View& view : views) {
      const Exposure exposure = split_exposure(view.eye.ideal, view.eye_from_camera, frame);
      if (exposure.is_one_moment())
        draw_at_once(view, frame);
      else
        expose(view, frame, exposure);
    }
  }

  static void read_picture(const Eye& eye, ColorImage& picture) {
    const PinholeCamera& raw = eye.camera.pinhole;
    picture.resize(raw.width, raw.height);
    eye.raw_target.read(0, 0, 0, raw.width, raw.height, GL_RGB, GL_UNSIGNED_BYTE, picture.data());
  }

  /// Z and movers of a view: left in depth_target.
  void measure_view(const Rigid3& camera_from_desk, const PinholeCamera& view) {
    if (!depth_target || depth_target->z.width() != view.width ||
        depth_target->z.height() != view.height)
      depth_target.emplace(view);
    depth_target->target.bind();
    glEnable(GL_DEPTH_TEST);
    const std::array<float, 4> nothing = {std::numeric_limits<float>::quiet_NaN(), 0, 0, 0};
    glClearBufferfv(GL_COLOR, 0, nothing.data());
    glClear(GL_DEPTH_BUFFER_BIT);
    measure.use();
    const Eigen::Matrix4f desk = camera_from_desk.matrix().cast<float>();
    measure.set("clip_from_desk", Eigen::Matrix4f(clip_from_camera(view) * desk));
    measure.set("depth_from_desk", Eigen::Vector4f(desk.row(2)));
    measure.set("moves", 1.0F);
    draw_movers();
    measure.set("moves", 0.0F);
    draw_static();
  }
};

DeskRenderer::DeskRenderer(std::unique_ptr<State> state) : state_(std::move(state)) {}
DeskRenderer::DeskRenderer(DeskRenderer&&) noexcept = default;
DeskRenderer& DeskRenderer::operator=(DeskRenderer&&) noexcept = default;
DeskRenderer::~DeskRenderer() {
  if (state_) state_->context.make_current();
}

DeskMoment moment_of(const Sequence& sequence, int frame) {
  return {frame, sequence.camera_from_desk, sequence.movers, sequence.rig(frame)};
}

Result<DeskRenderer> DeskRenderer::make(const DeskCamera& camera, const DeskScene& scene,
                                        const DeskLook& look) {
  Result<GlContext> context = GlContext::offscreen();
  if (!context.ok()) return context.problem();
  constexpr const char* kFar = "#define FAR\n";
  constexpr const char* kStill = "#define STILL_SHADOWS\n";
  constexpr const char* kAll = "#define STILL_SHADOWS\n#define MOVING_SHADOWS\n";
  constexpr const char* kStillTop = "#define DESK_TOP\n#define STILL_SHADOWS\n";
  constexpr const char* kAllTop =
      "#define DESK_TOP\n#define STILL_SHADOWS\n#define MOVING_SHADOWS\n";
  constexpr const char* kMover = "#define MOVES\n#define MOVING_SHADOWS\n";
  constexpr const char* kMoverDetail = "#define MOVES\n#define DETAIL\n#define MOVING_SHADOWS\n";
  constexpr const char* kMoverInShade =
      "#define MOVES\n#define STILL_SHADOWS\n#define MOVING_SHADOWS\n";
  constexpr const char* kMoverDetailInShade =
      "#define MOVES\n#define DETAIL\n#define STILL_SHADOWS\n#define MOVING_SHADOWS\n";
  constexpr std::array<ProgramSource, 19> kSources = {
      {{"shadow.vert", "shadow.frag"},
       {"depth.vert", "depth.frag"},
       {"sensor.vert", "desk_top.frag"},
       {"sensor.vert", "sensor.frag"},
       {"sensor.vert", "sensor.frag", "#define ROWS\n"},
       {"sensor.vert", "sensor.frag", "#define EXPOSED\n"},
       {"sensor.vert", "sensor.frag", "#define EXPOSED\n#define TURNS\n"},
       {"sensor.vert", "sensor.frag", "#define EXPOSED\n#define LAYERS\n"},
       {"sensor.vert", "sensor.frag", "#define EXPOSED\n#define LAYERS\n#define TURNS\n"},
       {"desk.vert", "desk.frag", kFar},
       {"desk.vert", "desk.frag", kStill},
       {"desk.vert", "desk.frag", kAll},
       {"desk.vert", "desk.frag", kStillTop},
       {"desk.vert", "desk.frag", kAllTop},
       {"desk.vert", "desk.frag", kMover},
       {"desk.vert", "desk.frag", kMoverDetail},
       {"desk.vert", "desk.frag", kMoverInShade},
       {"desk.vert", "desk.frag", kMoverDetailInShade},
       {"desk.vert", "desk.frag", "#define MOVES\n#define DARK\n"}}};
  Result<std::vector<GlProgram>> programs = make_programs(synth_shader_files(), kSources);
  if (!programs.ok()) return programs.problem();
  return DeskRenderer(std::make_unique<State>(std::move(context).value(), camera, scene, look,
                                              std::move(programs).value()));
}

void DeskRenderer::draw(const DeskMoment& moment, RawPair& pictures) {
  State& s = *state_;
  s.context.make_current();
  const Rigid3 left_from_camera = s.rig.camera_from_left.inverse();
  Random random(s.look.seed * 0x10001ULL + static_cast<std::uint64_t>(moment.frame), "noise");
  const auto key = [&random] { return static_cast<int>(random.next() >> 33); };
  const std::array<State::View, 2> views = {
      {{s.left, left_from_camera, key()},
       {s.right, s.rig.rig.right_from_left * left_from_camera, key()}}};
  s.right.lower(static_cast<float>(moment.rig.row_offset_px));
  s.draw(views, moment);
  State::read_picture(s.left, pictures.left);
  State::read_picture(s.right, pictures.right);
}

void DeskRenderer::draw_truth(const DeskMoment& moment, const PinholeCamera& view, double baseline,
                              DeskTruth& truth) {
  State& s = *state_;
  s.context.make_current();
  const Movers movers = moment.movers(moment.frame);
  s.place(movers, movers);
  const Rigid3 camera_from_desk = moment.camera_from_desk(moment.frame);
  const Rigid3 right_from_desk = Eigen::Translation3d(-baseline, 0.0, 0.0) * camera_from_desk;
  std::vector<Eigen::Vector2f> left(static_cast<std::size_t>(view.width * view.height));
  std::vector<Eigen::Vector2f> right(left.size());
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  const auto measure = [&](const Rigid3& pose, std::vector<Eigen::Vector2f>& into) {
    s.measure_view(pose, view);
    s.depth_target->target.read(0, 0, 0, view.width, view.height, GL_RG, GL_FLOAT, into.data());
  };
  measure(right_from_desk, right);
  measure(camera_from_desk, left);
  truth.depth.resize(view.width, view.height);
  truth.labels.resize(view.width, view.height);
  for (int y = 0; y < view.height; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width);
    for (int x = 0; x < view.width; ++x) {
      const Eigen::Vector2f& here = left[row + static_cast<std::size_t>(x)];
      const float z = here.x();
      truth.depth(x, y) = z;
      std::uint8_t label = 0;
      if (std::isfinite(z)) {
        if (here.y() > 0.5F) label |= kMovesLabel;
        // The same point lies f T / Z further left in the right eye; it is seen there unless both
        // pixels beside it show something nearer.
        const double u = x - view.fx_px * baseline / z;
        const auto u0 = static_cast<int>(std::floor(u));
        if (u0 >= 0 && u0 + 1 < view.width) {
          const float nearest = std::fmax(right[row + static_cast<std::size_t>(u0)].x(),
                                          right[row + static_cast<std::size_t>(u0) + 1].x());
          if (z <= 1.005F * nearest) label |= kBothSeeLabel;
        }
      }
      truth.labels(x, y) = label;
    }
  }
}

int DeskRenderer::gl_error_count() const { return state_->context.errors().count(); }
const std::string& DeskRenderer::gl_description() const { return state_->context.description(); }

}  // namespace palpable

#include "palpable/synth/desk_renderer.h"

#include "palpable/base/contract.h"
#include "palpable/render/gl_context.h"
#include "palpable/render/gl_objects.h"
#include "palpable/synth/desk_gpu.h"
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

constexpr double kNearest = 0.02;  // m, of what is drawn
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

/// An exposure's picture of what stands still serves until what is near (m) has shifted by this
/// many px against what is far; and what turns by less than the last stays where it is.
constexpr double kNearStill = 0.4;
constexpr double kReferencePx = 1.5;
constexpr double kNoTurnPx = 0.25;

/// Moments of an exposure: one for so many px that the room's picture moves or a mover's, whose
/// skin has weak texture and soft shading.
constexpr double kRoomPx = 1.5;
constexpr double kMoverPx = 3.0;
constexpr int kMostMoments = 10;

/// One of the moments that make up an exposure: which rows it lights, how much, when.
struct Moment {
  double frame = 0;
  int first_row = 0, last_row = 0;
  float weight = 1;
  double frames_per_row = 0;
};

}  // namespace

struct DeskRenderer::State {
  GlContext context;  // first, so that it is destroyed last
  DeskCamera rig;
  DeskLook look;
  GlProgram paint_far, paint_still, paint_all, shade, measure, sense, gather, develop;
  FullScreenTriangle full_screen;
  std::vector<GlTexture> images, hand_images;
  std::vector<std::unique_ptr<GpuMesh>> meshes;
  std::vector<std::unique_ptr<GpuMesh>> movers;
  // What `movers` shows: as the shutter opens and as it closes.
  std::vector<HandCapsule> filled, filled_last;
  ShadowMap static_shadow, hand_shadow;
  Eye left, right;
  std::optional<DepthTarget> depth_target;
  std::vector<Rgb> packed;

  State(GlContext gl, const DeskCamera& camera, const DeskScene& scene, const DeskLook& look_,
        std::array<GlProgram, 8> programs)
      : context(std::move(gl)),
        rig(camera),
        look(look_),
        paint_far(std::move(programs[0])),
        paint_still(std::move(programs[1])),
        paint_all(std::move(programs[2])),
        shade(std::move(programs[3])),
        measure(std::move(programs[4])),
        sense(std::move(programs[5])),
        gather(std::move(programs[6])),
        develop(std::move(programs[7])),
        static_shadow(2048, light_from_desk({0.0, 0.15, 0.0}, 0.80, 1.5)),
        hand_shadow(1024, light_from_desk({0.10, 0.0, 0.05}, 0.50, 1.5)),
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
    cast_shadows(static_shadow, [this] {
      for (const auto& mesh : meshes)
        if (mesh->in_shadows) mesh->draw();
    });
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
  void fill(const Movers& now) { fill(now, now); }
  void fill(const Movers& first, const Movers& last) {
    if (same(filled, first.capsules) && same(filled_last, last.capsules) &&
        !(filled.empty() && first.capsules.empty()))
      return;
    const std::vector<PaintedMesh> painted =
        mover_meshes(first.capsules, first.desk_from_cup, look);
    if (same(first.capsules, last.capsules)) {
      for (std::size_t i = 0; i < movers.size(); ++i) movers[i]->fill(painted[i]);
    } else {
      const std::vector<PaintedMesh> after = mover_meshes(last.capsules, last.desk_from_cup, look);
      for (std::size_t i = 0; i < movers.size(); ++i) movers[i]->fill(painted[i], after[i]);
    }
    filled = first.capsules;
    filled_last = last.capsules;
    cast_shadows(hand_shadow, [this] { draw_movers(); });
  }
  static bool same(std::span<const HandCapsule> a, std::span<const HandCapsule> b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const HandCapsule& c, const HandCapsule& d) {
                        return c.shape.a == d.shape.a && c.shape.b == d.shape.b &&
                               c.back == d.back && c.part == d.part;
                      });
  }

  template <class Draw>
  void cast_shadows(const ShadowMap& map, const Draw& draw) const {
    map.target.bind();
    glEnable(GL_DEPTH_TEST);
    glClearDepth(1.0);
    glClear(GL_DEPTH_BUFFER_BIT);
    // Slopes shift the stored depth away from the light, or surfaces shadow themselves in stripes.
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(2.5F, 8.0F);
    shade.use();
    shade.set("clip_from_desk", to_clip(map.light));
    draw();
    glDisable(GL_POLYGON_OFFSET_FILL);
  }

  /// The rectangle of the ideal picture that movers can change, with their shadow or without.
  [[nodiscard]] static Box touched_by(std::span<const HandCapsule> capsules, const Eye& eye,
                                      const Rigid3& eye_from_desk, bool shadow = true) {
    double left = eye.ideal.width, right = -1, top = eye.ideal.height, bottom = -1;
    const auto include = [&](const Eigen::Vector3d& x_in_desk, double radius) {
      const Eigen::Vector3d x = eye_from_desk * x_in_desk;
      // Beside or behind the eye nothing useful bounds it.
      const double z = x.z() - radius;
      if (z < kNearest) {
        left = top = 0;
        right = eye.ideal.width;
        bottom = eye.ideal.height;
        return;
      }
      const Eigen::Vector2d at = eye.ideal.project(x);
      // A sphere's picture is wider than r / z off the axis; its rays make at most 60 degrees.
      const double reach = 2.0 * eye.ideal.fx_px * radius / z + 2.0;
      left = std::min(left, at.x() - reach);
      right = std::max(right, at.x() + reach);
      top = std::min(top, at.y() - reach);
      bottom = std::max(bottom, at.y() + reach);
    };
    for (const HandCapsule& capsule : capsules)
      for (const auto& [end, radius] : {std::pair(capsule.shape.a, capsule.shape.ra),
                                        std::pair(capsule.shape.b, capsule.shape.rb)}) {
        include(end, radius);
        if (!shadow) continue;
        // Its shadow on the desk; what the shadow meets on the way lies between the two.
        const double fall = std::max(0.0, end.z()) / kToSun.z();
        include(end - fall * kToSun, radius / kToSun.z() + kShadowSpread);
      }
    const auto clamped = [](double value, int limit) {
      return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(limit)));
    };
    const int x0 = clamped(left, eye.ideal.width);
    const int y0 = clamped(top, eye.ideal.height);
    return {x0, y0, std::max(0, clamped(right + 1, eye.ideal.width) - x0),
            std::max(0, clamped(bottom + 1, eye.ideal.height) - y0)};
  }

  /// What all surfaces of one view have in common.
  void look_from(const GlProgram& program, const Eye& eye, const Rigid3& eye_from_desk) const {
    const Eigen::Matrix4f view = eye_from_desk.matrix().cast<float>();
    program.set("clip_from_desk", Eigen::Matrix4f(clip_from_camera(eye.ideal) * view));
    program.set("eye", Eigen::Vector3f(eye_from_desk.inverse().translation().cast<float>()));
    program.set("to_sun", Eigen::Vector3f(kToSun.cast<float>()));
    program.set("image", 0);
    program.set("along", 0.0F);
    if (&program == &paint_far) return;
    program.set("static_light_from_desk", Eigen::Matrix4f(static_shadow.light.cast<float>()));
    program.set("static_shadow", 1);
    if (&program == &paint_still) return;
    program.set("hand_light_from_desk", Eigen::Matrix4f(hand_shadow.light.cast<float>()));
    program.set("hand_shadow", 2);
  }

  void draw_mesh(const GlProgram& program, const GpuMesh& mesh,
                 const std::vector<GlTexture>& from) const {
    if (mesh.index_count == 0) return;
    program.use();
    from[static_cast<std::size_t>(mesh.image)].bind(0);
    program.set("gloss", mesh.gloss);
    program.set("sharpness", mesh.sharpness);
    mesh.draw();
  }

  /// Everything that stands still. Near things are last in the list: what they hide is not shaded.
  void paint_static(const GlProgram& near) const {
    for (std::size_t i = meshes.size(); i-- > 0;)
      draw_mesh(meshes[i]->in_shadows ? near : paint_far, *meshes[i], images);
  }

  void paint_movers() const {
    // Movers are closed: half of their triangles look away. With Y down, the others run clockwise.
    glFrontFace(GL_CW);
    glEnable(GL_CULL_FACE);
    for (const auto& mesh : movers) draw_mesh(paint_all, *mesh, hand_images);
    glDisable(GL_CULL_FACE);
  }

  /// What painting from an eye needs, whatever was drawn before.
  void begin_painting(const Eye& eye, const Rigid3& eye_from_desk) const {
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);  // what is painted again over its own copy must pass
    glClearColor(0.0F, 0.0F, 0.0F, 1.0F);
    for (const GlProgram* program : {&paint_far, &paint_still, &paint_all})
      look_from(*program, eye, eye_from_desk);
    static_shadow.depth.bind(1);
    hand_shadow.depth.bind(2);
  }

  /// A rectangle of one picture into another of the same kind and size.
  static void copy(const GlTexture& from, const GlTexture& to, const Box& box) {
    glCopyImageSubData(from.get(), GL_TEXTURE_2D, 0, box.x, box.y, 0, to.get(), GL_TEXTURE_2D, 0,
                       box.x, box.y, 0, box.width, box.height, 1);
  }

  /// The ideal picture of one moment, within `wanted`; what is outside is left as it is.
  void paint_ideal(Eye& eye, const Rigid3& eye_from_desk, const Box& wanted) {
    begin_painting(eye, eye_from_desk);
    glEnable(GL_SCISSOR_TEST);
    const auto is = [&](const std::optional<Rigid3>& pose) {
      return pose && pose->matrix() == eye_from_desk.matrix();
    };
    if (!is(eye.still_from_desk) && !is(eye.last_from_desk)) {
      // A moving eye: nothing can be kept.
      eye.last_from_desk = eye_from_desk;
      eye.ideal_target.bind();
      glScissor(wanted.x, wanted.y, wanted.width, wanted.height);
      glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
      paint_movers();
      paint_static(filled.empty() ? paint_still : paint_all);
      glDisable(GL_SCISSOR_TEST);
      return;
    }
    eye.last_from_desk = eye_from_desk;
    if (!is(eye.still_from_desk)) {
      eye.still_target.bind();
      glScissor(0, 0, eye.ideal.width, eye.ideal.height);
      glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
      paint_static(paint_still);
      eye.still_from_desk = eye_from_desk;
    }
    const Box all{0, 0, eye.ideal.width, eye.ideal.height};
    copy(eye.still_color, eye.ideal_color, all);
    if (!filled.empty()) {
      copy(eye.still_depth, eye.ideal_depth, all);
      eye.ideal_target.bind();
      const Box box = touched_by(filled, eye, eye_from_desk).cut(wanted);
      glScissor(box.x, box.y, box.width, box.height);
      paint_movers();
      paint_static(paint_all);
    }
    glDisable(GL_SCISSOR_TEST);
  }

  /// The moments that a frame's exposure consists of.
  [[nodiscard]] std::vector<Moment> moments_of(const DeskMoment& frame) const {
    const int rows = rig.rig.left.pinhole.height;
    const double at = frame.frame;
    std::vector<Moment> moments;
    if (frame.rig.readout > 0.0) {
      constexpr int kBands = 6;
      const double frames_per_row = frame.rig.readout * kFramesPerSecond / (rows - 1);
      for (int b = 0; b < kBands; ++b) {
        Moment band;
        band.first_row = b * rows / kBands;
        band.last_row = (b + 1) * rows / kBands - 1;
        band.frames_per_row = frames_per_row;
        band.frame =
            at + frames_per_row * (0.5 * (band.first_row + band.last_row) - 0.5 * (rows - 1));
        moments.push_back(band);
      }
      return moments;
    }
    const double open = frame.rig.exposure * kFramesPerSecond;  // frames
    const int count = open > 0.0 ? std::clamp(static_cast<int>(std::ceil(std::max(
                                                  room_motion_px(frame, open) / kRoomPx,
                                                  mover_motion_px(frame, open) / kMoverPx))),
                                              1, kMostMoments)
                                 : 1;
    for (int i = 0; i < count; ++i)
      moments.push_back({at + open * ((i + 0.5) / count - 0.5), 0, rows - 1,
                         1.0F / static_cast<float>(count), 0.0});
    return moments;
  }

  /// How far the picture of the room at kNearStill and beyond goes while the shutter is open, px.
  [[nodiscard]] double room_motion_px(const DeskMoment& frame, double open) const {
    const double f = rig.rig.left.pinhole.fx_px;
    const Rigid3 change = frame.camera_from_desk(frame.frame + 0.5 * open) *
                          frame.camera_from_desk(frame.frame - 0.5 * open).inverse();
    return f * Eigen::AngleAxisd(change.linear()).angle() +
           f * change.translation().norm() / kNearStill;
  }

  /// The same of the mover that goes farthest.
  [[nodiscard]] double mover_motion_px(const DeskMoment& frame, double open) const {
    const double f = rig.rig.left.pinhole.fx_px;
    const Rigid3 first = frame.camera_from_desk(frame.frame - 0.5 * open);
    const Rigid3 last = frame.camera_from_desk(frame.frame + 0.5 * open);
    const Movers before = frame.movers(frame.frame - 0.5 * open);
    const Movers after = frame.movers(frame.frame + 0.5 * open);
    const std::size_t count = std::min(before.capsules.size(), after.capsules.size());
    double most = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Vector3d a = first * before.capsules[i].shape.b;
      const Eigen::Vector3d b = last * after.capsules[i].shape.b;
      if (a.z() > 0.05 && b.z() > 0.05)
        most = std::max(most, f * (a.head<2>() / a.z() - b.head<2>() / b.z()).norm());
    }
    return most;
  }

  /// Adds the light of one moment within a rectangle of the raw picture.
  /// @param from               the ideal picture of the moment, or one that is turned
  /// @param ideal_from_moment  by this rotation
  struct Gathering {
    Box raw;
    float weight = 1;
    float row_offset = 0;
    double moment_row = 0;
    Eigen::Vector3d turn_per_row = Eigen::Vector3d::Zero();
    Eigen::Matrix3d ideal_from_moment = Eigen::Matrix3d::Identity();
  };
  void gather_light(const Eye& eye, const GlTexture& from, const Gathering& g) const {
    if (g.raw.empty()) return;
    eye.exposed_target.bind();
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    glEnable(GL_SCISSOR_TEST);
    glScissor(g.raw.x, g.raw.y, g.raw.width, g.raw.height);
    gather.use();
    gather.set("ideal", 0);
    gather.set("lens_map", 1);
    from.bind(0);
    eye.lens_map.bind(1);
    gather.set("ideal_size", size_of(eye.ideal));
    gather.set("ideal_centre", Eigen::Vector2f(static_cast<float>(eye.ideal.cx_px),
                                               static_cast<float>(eye.ideal.cy_px)));
    gather.set("ideal_focal", static_cast<float>(eye.ideal.fx_px));
    gather.set("weight", g.weight);
    gather.set("row_offset", g.row_offset);
    gather.set("moment_row", static_cast<float>(g.moment_row));
    gather.set("turn_per_row", Eigen::Vector3f(g.turn_per_row.cast<float>()));
    gather.set("ideal_from_moment", Eigen::Matrix3f(g.ideal_from_moment.cast<float>()));
    full_screen.draw();
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_BLEND);
  }
  static Eigen::Vector2f size_of(const PinholeCamera& camera) {
    return {static_cast<float>(camera.width), static_cast<float>(camera.height)};
  }

  void clear_exposed(const Eye& eye) const {
    eye.exposed_target.bind();
    glClearColor(0.0F, 0.0F, 0.0F, 0.0F);
    glClear(GL_COLOR_BUFFER_BIT);
  }

  /// Rows that are read one after the other: each band is a picture of its own moment.
  void read_rows(Eye& eye, const Rigid3& eye_from_camera, const DeskMoment& frame,
                 std::span<const Moment> bands, float row_offset) {
    const int width = eye.camera.pinhole.width;
    clear_exposed(eye);
    for (const Moment& band : bands) {
      fill(frame.movers(band.frame));
      const Rigid3 eye_from_desk = eye_from_camera * frame.camera_from_desk(band.frame);
      Box wanted{0, 0, eye.ideal.width, eye.ideal.height};
      if (bands.size() > 1) {
        float top = 1e9F, bottom = -1e9F;
        for (int row = band.first_row; row <= band.last_row; ++row) {
          top = std::min(top, eye.rows[static_cast<std::size_t>(row)][0]);
          bottom = std::max(bottom, eye.rows[static_cast<std::size_t>(row)][1]);
        }
        // A few rows more: the camera turns within the band, and the filter reads neighbours.
        const int y0 = static_cast<int>(top) - 6;
        wanted = wanted.cut({0, y0, eye.ideal.width, static_cast<int>(bottom) + 8 - y0});
      }
      paint_ideal(eye, eye_from_desk, wanted);
      const Rigid3 next =
          eye_from_camera * frame.camera_from_desk(band.frame + band.frames_per_row);
      const Eigen::AngleAxisd turn(next.linear() * eye_from_desk.linear().transpose());
      gather_light(eye, eye.ideal_color,
                   {.raw = {0, band.first_row, width, band.last_row - band.first_row + 1},
                    .weight = band.weight,
                    .row_offset = row_offset,
                    .moment_row = 0.5 * (band.first_row + band.last_row),
                    .turn_per_row = turn.angle() * turn.axis()});
    }
  }

  /// What stands still, with the shadow of what moves: into the eye's still picture.
  void paint_reference(Eye& eye, const Rigid3& eye_from_desk) {
    begin_painting(eye, eye_from_desk);
    eye.still_target.bind();
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    paint_static(filled.empty() ? paint_still : paint_all);
    eye.still_from_desk.reset();  // it holds shadows that pass
    eye.last_from_desk.reset();
  }

  /// The movers of one moment over a part of the still picture, in the eye's ideal picture.
  void paint_movers_over_reference(const Eye& eye, const Rigid3& eye_from_desk, const Box& box,
                                   float along) {
    if (box.empty()) return;
    copy_still(eye, box);
    begin_painting(eye, eye_from_desk);
    paint_all.set("along", along);
    eye.ideal_target.bind();
    glEnable(GL_SCISSOR_TEST);
    glScissor(box.x, box.y, box.width, box.height);
    paint_movers();
    glDisable(GL_SCISSOR_TEST);
  }
  static void copy_still(const Eye& eye, const Box& box) {
    copy(eye.still_color, eye.ideal_color, box);
    copy(eye.still_depth, eye.ideal_depth, box);
  }

  /// The mean of an exposure's moments. What stands still is painted once for each kReferencePx
  /// that its near things shift against its far ones, and turned into the moments between; the
  /// movers are painted for each moment, with the shadow of the middle one.
  void expose(Eye& eye, const Rigid3& eye_from_camera, const DeskMoment& frame,
              std::span<const Moment> moments, float row_offset) {
    const auto pose_at = [&](double at) {
      return Rigid3(eye_from_camera * frame.camera_from_desk(at));
    };
    const double first = moments.front().frame, last = moments.back().frame;
    fill(frame.movers(first), frame.movers(last));
    const Rigid3 change = pose_at(last) * pose_at(first).inverse();
    const double f = eye.ideal.fx_px;
    const auto n = static_cast<int>(moments.size());
    const int references = std::clamp(
        static_cast<int>(std::ceil(f * change.translation().norm() / kNearStill / kReferencePx)), 1,
        n);
    const bool turns = f * Eigen::AngleAxisd(change.linear()).angle() > kNoTurnPx;
    const Box all_ideal{0, 0, eye.ideal.width, eye.ideal.height};
    const Box all_raw{0, 0, eye.camera.pinhole.width, eye.camera.pinhole.height};
    clear_exposed(eye);
    for (int r = 0; r < references; ++r) {
      const auto of_reference =
          moments.subspan(static_cast<std::size_t>(r * n / references),
                          static_cast<std::size_t>((r + 1) * n / references - r * n / references));
      const Rigid3 reference =
          pose_at(0.5 * (of_reference.front().frame + of_reference.back().frame));
      paint_reference(eye, reference);
      if (!filled.empty()) copy_still(eye, all_ideal);
      // Turned as the reference is, so that turning it back puts all where it belongs.
      const auto turned = [&](double at) {
        const Rigid3 pose = pose_at(at);
        return Rigid3(reference.linear() * pose.linear().transpose() * pose);
      };
      Box moved;  // by any moment
      for (const Moment& moment : of_reference) {
        const Rigid3 pose = turned(moment.frame);
        moved = around(moved, touched_by(filled, eye, pose, false));
        moved = around(moved, touched_by(filled_last, eye, pose, false));
      }
      const Box raw_moved = turns ? all_raw : eye.raw_box(moved);
      for (const Moment& moment : of_reference) {
        const Rigid3 pose = turned(moment.frame);
        paint_movers_over_reference(eye, pose, moved,
                                    static_cast<float>((moment.frame - first) / (last - first)));
        const GlTexture& picture = filled.empty() ? eye.still_color : eye.ideal_color;
        gather_light(
            eye, picture,
            {.raw = raw_moved,
             .weight = moment.weight,
             .row_offset = row_offset,
             .ideal_from_moment = reference.linear() * pose_at(moment.frame).linear().transpose()});
      }
      if (turns) continue;
      // Where nothing moves one look is enough.
      const float weight = moments.front().weight * static_cast<float>(of_reference.size());
      for (const Box& rest : beside(all_raw, raw_moved))
        gather_light(eye, eye.still_color,
                     {.raw = rest, .weight = weight, .row_offset = row_offset});
    }
  }

  void draw_eye(Eye& eye, const Rigid3& eye_from_camera, const DeskMoment& frame, bool lowered_row,
                int key, ColorImage& picture) {
    const PinholeCamera& raw = eye.camera.pinhole;
    const std::vector<Moment> moments = moments_of(frame);
    const float row_offset = lowered_row ? static_cast<float>(frame.rig.row_offset_px) : 0.0F;
    const bool rolls = frame.rig.readout > 0.0;
    const bool plain = moments.size() == 1 && row_offset == 0.0F;
    if (plain) {
      fill(frame.movers(moments.front().frame));
      paint_ideal(eye, eye_from_camera * frame.camera_from_desk(moments.front().frame),
                  {0, 0, eye.ideal.width, eye.ideal.height});
    } else if (rolls || moments.size() == 1) {
      read_rows(eye, eye_from_camera, frame, moments, row_offset);
    } else {
      expose(eye, eye_from_camera, frame, moments, row_offset);
    }

    eye.raw_target.bind();
    glDisable(GL_DEPTH_TEST);
    const GlProgram& sensor = plain ? sense : develop;
    sensor.use();
    if (plain) {
      sensor.set("ideal", 0);
      sensor.set("lens_map", 1);
      eye.ideal_color.bind(0);
      eye.lens_map.bind(1);
      sensor.set("ideal_size", size_of(eye.ideal));
    } else {
      sensor.set("exposed", 0);
      eye.exposed.bind(0);
    }
    sensor.set("optical_centre",
               Eigen::Vector2f(static_cast<float>(raw.cx_px), static_cast<float>(raw.cy_px)));
    sensor.set("corner_radius", static_cast<float>(0.5 * std::hypot(raw.width, raw.height)));
    sensor.set("vignetting", static_cast<float>(rig.faults.vignetting));
    sensor.set("gain", eye.gain * static_cast<float>(frame.rig.light));
    sensor.set("noise", static_cast<float>(rig.faults.noise_grey_levels));
    sensor.set("noise_key", key);
    full_screen.draw();
    picture.resize(raw.width, raw.height);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
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
  const auto files = synth_shader_files();
  constexpr const char* kStill = "#define STILL_SHADOWS\n";
  constexpr const char* kAll = "#define STILL_SHADOWS\n#define MOVING_SHADOWS\n";
  const std::array<std::array<const char*, 3>, 8> names = {
      {{"desk.vert", "desk.frag", ""},
       {"desk.vert", "desk.frag", kStill},
       {"desk.vert", "desk.frag", kAll},
       {"shadow.vert", "shadow.frag", ""},
       {"depth.vert", "depth.frag", ""},
       {"sensor.vert", "sensor.frag", ""},
       {"sensor.vert", "lens.frag", ""},
       {"sensor.vert", "sensor.frag", "#define EXPOSED\n"}}};
  std::vector<GlProgram> made;
  for (const auto& [vertex, fragment, defines] : names) {
    Result<GlProgram> program = GlProgram::make(files, vertex, fragment, defines);
    if (!program.ok()) return program.problem();
    made.push_back(std::move(program).value());
  }
  std::array<GlProgram, 8> programs = {std::move(made[0]), std::move(made[1]), std::move(made[2]),
                                       std::move(made[3]), std::move(made[4]), std::move(made[5]),
                                       std::move(made[6]), std::move(made[7])};
  return DeskRenderer(std::make_unique<State>(std::move(context).value(), camera, scene, look,
                                              std::move(programs)));
}

void DeskRenderer::draw(const DeskMoment& moment, RawPair& pictures) {
  State& s = *state_;
  s.context.make_current();
  const Rigid3 left_from_camera = s.rig.camera_from_left.inverse();
  Random random(s.look.seed * 0x10001ULL + static_cast<std::uint64_t>(moment.frame), "noise");
  const auto key = [&random] { return static_cast<int>(random.next() >> 33); };
  s.draw_eye(s.left, left_from_camera, moment, false, key(), pictures.left);
  s.draw_eye(s.right, s.rig.rig.right_from_left * left_from_camera, moment, true, key(),
             pictures.right);
}

void DeskRenderer::draw_truth(const DeskMoment& moment, const PinholeCamera& view, double baseline,
                              DeskTruth& truth) {
  State& s = *state_;
  s.context.make_current();
  s.fill(moment.movers(moment.frame));
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

#include "palpable/synth/desk_renderer.h"

#include "palpable/base/contract.h"
#include "palpable/render/gl_context.h"
#include "palpable/render/gl_objects.h"
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

/// Triangles on the GPU.
struct GpuMesh {
  GlBuffer vertices, indices;
  GlVertexArray array;
  int index_count = 0;
  int image = 0;
  float gloss = 0, sharpness = 1;
  bool in_shadows = true;

  GpuMesh() {
    constexpr int kStride = sizeof(PaintedVertex);
    static_assert(kStride == 12 * sizeof(float));
    array.floats(0, vertices, 3, kStride, 0);
    array.floats(1, vertices, 3, kStride, 12);
    array.floats(2, vertices, 2, kStride, 24);
    array.floats(3, vertices, 4, kStride, 32);
    array.indices(indices);
  }
  void fill(const PaintedMesh& mesh) {
    vertices.stream(std::span<const PaintedVertex>(mesh.vertices));
    indices.stream(std::span<const std::uint32_t>(mesh.indices));
    index_count = static_cast<int>(mesh.indices.size());
    image = mesh.image;
    gloss = mesh.gloss;
    sharpness = mesh.sharpness;
    in_shadows = mesh.in_shadows;
  }
  void draw() const {
    if (index_count == 0) return;
    array.bind();
    glDrawElements(GL_TRIANGLES, index_count, GL_UNSIGNED_INT, nullptr);
  }
};

GlTexture upload(const ColorImage& image) {
  const int larger = std::max(image.width(), image.height());
  const int levels = 1 + static_cast<int>(std::floor(std::log2(larger)));
  GlTexture texture(GL_RGB8, image.width(), image.height(), GL_LINEAR, levels);
  texture.upload(0, 0, image.width(), image.height(), GL_RGB, GL_UNSIGNED_BYTE, image.data());
  texture.make_mipmaps();
  texture.repeat();
  return texture;
}

/// A depth picture from the light, compared and filtered by the texture unit. Outside is lit.
struct ShadowMap {
  GlTexture depth;
  GlFramebuffer target;
  Eigen::Matrix4d light;

  ShadowMap(int size, const Eigen::Matrix4d& light_from_desk_matrix)
      : depth(GL_DEPTH_COMPONENT32F, size, size, GL_LINEAR),
        target({}, &depth),
        light(light_from_desk_matrix) {
    const GLuint name = depth.get();
    glTextureParameteri(name, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glTextureParameteri(name, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    glTextureParameteri(name, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
    glTextureParameteri(name, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
    const std::array<float, 4> lit = {1, 1, 1, 1};
    glTextureParameterfv(name, GL_TEXTURE_BORDER_COLOR, lit.data());
    glNamedFramebufferDrawBuffer(target.get(), GL_NONE);
    glNamedFramebufferReadBuffer(target.get(), GL_NONE);
  }
};

/// One eye: its lens and the pictures on the way.
struct Eye {
  DistortedCamera camera;
  PinholeCamera ideal;
  GlTexture ideal_color, ideal_depth, lens_map, raw_color;
  GlFramebuffer ideal_target, raw_target;
  float gain = 1;
  /// Rows of the ideal picture that a raw row needs.
  std::vector<std::array<float, 2>> rows;
  /// Light of several moments, raw.
  GlTexture exposed;
  GlFramebuffer exposed_target;
  /// The desk without movers, kept while the eye does not move; each frame starts as a copy of it.
  GlTexture still_color, still_depth;
  GlFramebuffer still_target;
  std::optional<Rigid3> still_from_desk, last_from_desk;

  Eye(const DistortedCamera& lens, float gain_)
      : camera(lens),
        ideal(ideal_camera_for(lens, lens.pinhole.fx_px)),
        ideal_color(GL_RGBA8, ideal.width, ideal.height, GL_LINEAR),
        ideal_depth(GL_DEPTH_COMPONENT32F, ideal.width, ideal.height),
        lens_map(GL_RG32F, lens.pinhole.width, lens.pinhole.height),
        raw_color(GL_RGBA8, lens.pinhole.width, lens.pinhole.height),
        gain(gain_),
        exposed(GL_RGBA32F, lens.pinhole.width, lens.pinhole.height),
        still_color(GL_RGBA8, ideal.width, ideal.height),
        still_depth(GL_DEPTH_COMPONENT32F, ideal.width, ideal.height) {
    const std::array<const GlTexture*, 1> ideal_colors = {&ideal_color};
    const std::array<const GlTexture*, 1> still_colors = {&still_color};
    still_target = GlFramebuffer(still_colors, &still_depth);
    const std::array<const GlTexture*, 1> raw_colors = {&raw_color};
    ideal_target = GlFramebuffer(ideal_colors, &ideal_depth);
    raw_target = GlFramebuffer(raw_colors, nullptr);
    const std::array<const GlTexture*, 1> exposed_colors = {&exposed};
    exposed_target = GlFramebuffer(exposed_colors, nullptr);
    const std::vector<Eigen::Vector2f> map = distortion_map(camera, ideal);
    const auto w = static_cast<std::size_t>(lens.pinhole.width);
    rows.assign(static_cast<std::size_t>(lens.pinhole.height), {1e9F, -1e9F});
    for (std::size_t i = 0; i < map.size(); ++i) {
      rows[i / w][0] = std::min(rows[i / w][0], map[i].y());
      rows[i / w][1] = std::max(rows[i / w][1], map[i].y());
    }
    lens_map.upload(0, 0, lens.pinhole.width, lens.pinhole.height, GL_RG, GL_FLOAT, map.data());
  }
};

/// A rectangle of pixels.
struct Box {
  int x = 0, y = 0, width = 0, height = 0;
  [[nodiscard]] Box cut(const Box& other) const {
    const int x0 = std::max(x, other.x);
    const int y0 = std::max(y, other.y);
    return {x0, y0, std::max(0, std::min(x + width, other.x + other.width) - x0),
            std::max(0, std::min(y + height, other.y + other.height) - y0)};
  }
};

/// One of the moments that make up an exposure: which rows it lights, how much, when.
struct Moment {
  double frame = 0;
  int first_row = 0, last_row = 0;
  float weight = 1;
  double frames_per_row = 0;
};

/// The truth's own target.
struct DepthTarget {
  GlTexture z, depth;
  GlFramebuffer target;
  explicit DepthTarget(const PinholeCamera& view)
      : z(GL_RG32F, view.width, view.height),
        depth(GL_DEPTH_COMPONENT32F, view.width, view.height) {
    const std::array<const GlTexture*, 1> colors = {&z};
    target = GlFramebuffer(colors, &depth);
  }
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
  std::vector<HandCapsule> filled;  // what `movers` shows
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
  void fill(const Movers& now) {
    const auto same = [](const HandCapsule& a, const HandCapsule& b) {
      return a.shape.a == b.shape.a && a.shape.b == b.shape.b && a.back == b.back &&
             a.part == b.part;
    };
    if (std::equal(filled.begin(), filled.end(), now.capsules.begin(), now.capsules.end(), same) &&
        !(filled.empty() && now.capsules.empty()))
      return;
    const std::vector<PaintedMesh> painted = mover_meshes(now.capsules, now.desk_from_cup, look);
    for (std::size_t i = 0; i < movers.size(); ++i) movers[i]->fill(painted[i]);
    filled = now.capsules;
    cast_shadows(hand_shadow, [this] { draw_movers(); });
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

  /// The rectangle of the ideal picture that the hand and its shadow can change.
  [[nodiscard]] static Box touched_by(std::span<const HandCapsule> capsules, const Eye& eye,
                                      const Rigid3& eye_from_desk) {
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

  /// The ideal picture of one moment, within `wanted`; what is outside is left as it is.
  void paint_ideal(Eye& eye, const Rigid3& eye_from_desk, const Box& wanted) {
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);  // what is painted again over its own copy must pass
    glClearColor(0.0F, 0.0F, 0.0F, 1.0F);
    for (const GlProgram* program : {&paint_far, &paint_still, &paint_all})
      look_from(*program, eye, eye_from_desk);
    static_shadow.depth.bind(1);
    hand_shadow.depth.bind(2);
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
    const auto copy = [&eye](const GlTexture& from, const GlTexture& to) {
      glCopyImageSubData(from.get(), GL_TEXTURE_2D, 0, 0, 0, 0, to.get(), GL_TEXTURE_2D, 0, 0, 0, 0,
                         eye.ideal.width, eye.ideal.height, 1);
    };
    copy(eye.still_color, eye.ideal_color);
    if (!filled.empty()) {
      copy(eye.still_depth, eye.ideal_depth);
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
    const int count =
        open > 0.0 ? std::clamp(static_cast<int>(std::ceil(motion_px(frame, open) / 1.5)), 1, 10)
                   : 1;
    for (int i = 0; i < count; ++i)
      moments.push_back({at + open * ((i + 0.5) / count - 0.5), 0, rows - 1,
                         1.0F / static_cast<float>(count), 0.0});
    return moments;
  }

  /// How far the picture of the room at 0.4 m and beyond, or of a mover, goes while the shutter is
  /// open, px.
  [[nodiscard]] double motion_px(const DeskMoment& frame, double open) const {
    const double f = rig.rig.left.pinhole.fx_px;
    const Rigid3 first = frame.camera_from_desk(frame.frame - 0.5 * open);
    const Rigid3 last = frame.camera_from_desk(frame.frame + 0.5 * open);
    const Rigid3 change = last * first.inverse();
    double most =
        f * Eigen::AngleAxisd(change.linear()).angle() + f * change.translation().norm() / 0.4;
    const Movers before = frame.movers(frame.frame - 0.5 * open);
    const Movers after = frame.movers(frame.frame + 0.5 * open);
    const std::size_t count = std::min(before.capsules.size(), after.capsules.size());
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Vector3d a = first * before.capsules[i].shape.b;
      const Eigen::Vector3d b = last * after.capsules[i].shape.b;
      if (a.z() > 0.05 && b.z() > 0.05)
        most = std::max(most, f * (a.head<2>() / a.z() - b.head<2>() / b.z()).norm());
    }
    return most;
  }

  void draw_eye(Eye& eye, const Rigid3& eye_from_camera, const DeskMoment& frame, bool lowered_row,
                int key, ColorImage& picture) {
    const PinholeCamera& raw = eye.camera.pinhole;
    const std::vector<Moment> moments = moments_of(frame);
    const float row_offset = lowered_row ? static_cast<float>(frame.rig.row_offset_px) : 0.0F;
    const bool plain = moments.size() == 1 && row_offset == 0.0F;
    const Eigen::Vector2f ideal_size(static_cast<float>(eye.ideal.width),
                                     static_cast<float>(eye.ideal.height));
    if (!plain) {
      eye.exposed_target.bind();
      glClearColor(0.0F, 0.0F, 0.0F, 0.0F);
      glClear(GL_COLOR_BUFFER_BIT);
    }
    for (const Moment& moment : moments) {
      fill(frame.movers(moment.frame));
      const Rigid3 eye_from_desk = eye_from_camera * frame.camera_from_desk(moment.frame);
      Box wanted{0, 0, eye.ideal.width, eye.ideal.height};
      if (moments.size() > 1 && moment.frames_per_row > 0.0) {
        float top = 1e9F, bottom = -1e9F;
        for (int row = moment.first_row; row <= moment.last_row; ++row) {
          top = std::min(top, eye.rows[static_cast<std::size_t>(row)][0]);
          bottom = std::max(bottom, eye.rows[static_cast<std::size_t>(row)][1]);
        }
        // A few rows more: the camera turns within the band, and the filter reads neighbours.
        const int y0 = static_cast<int>(top) - 6;
        wanted = wanted.cut({0, y0, eye.ideal.width, static_cast<int>(bottom) + 8 - y0});
      }
      paint_ideal(eye, eye_from_desk, wanted);
      if (plain) break;
      const Rigid3 next =
          eye_from_camera * frame.camera_from_desk(moment.frame + moment.frames_per_row);
      const Eigen::AngleAxisd turn(next.linear() * eye_from_desk.linear().transpose());
      eye.exposed_target.bind();
      glDisable(GL_DEPTH_TEST);
      glEnable(GL_BLEND);
      glBlendFunc(GL_ONE, GL_ONE);
      glEnable(GL_SCISSOR_TEST);
      glScissor(0, moment.first_row, raw.width, moment.last_row - moment.first_row + 1);
      gather.use();
      gather.set("ideal", 0);
      gather.set("lens_map", 1);
      eye.ideal_color.bind(0);
      eye.lens_map.bind(1);
      gather.set("ideal_size", ideal_size);
      gather.set("ideal_centre", Eigen::Vector2f(static_cast<float>(eye.ideal.cx_px),
                                                 static_cast<float>(eye.ideal.cy_px)));
      gather.set("ideal_focal", static_cast<float>(eye.ideal.fx_px));
      gather.set("weight", moment.weight);
      gather.set("row_offset", row_offset);
      gather.set("moment_row", 0.5F * static_cast<float>(moment.first_row + moment.last_row));
      gather.set("turn_per_row", Eigen::Vector3f((turn.angle() * turn.axis()).cast<float>()));
      full_screen.draw();
      glDisable(GL_SCISSOR_TEST);
      glDisable(GL_BLEND);
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
      sensor.set("ideal_size", ideal_size);
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

#include "palpable/synth/desk_renderer.h"

#include "palpable/base/contract.h"
#include "palpable/render/gl_context.h"
#include "palpable/render/gl_objects.h"
#include "palpable/synth/lens.h"
#include "palpable/synth/random.h"
#include "palpable/synth/texture_images.h"

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace palpable {

std::span<const ShaderFile> synth_shader_files();

namespace {

constexpr double kNearest = 0.02;  // m, of what is drawn
constexpr double kFarthest = 8.0;

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
  /// The desk without a hand, kept while the eye does not move; each frame starts as a copy of it.
  GlTexture still_color, still_depth;
  GlFramebuffer still_target;
  std::optional<Rigid3> still_from_desk;

  Eye(const DistortedCamera& lens, float gain_)
      : camera(lens),
        ideal(ideal_camera_for(lens, lens.pinhole.fx_px)),
        ideal_color(GL_RGBA8, ideal.width, ideal.height, GL_LINEAR),
        ideal_depth(GL_DEPTH_COMPONENT32F, ideal.width, ideal.height),
        lens_map(GL_RG32F, lens.pinhole.width, lens.pinhole.height),
        raw_color(GL_RGBA8, lens.pinhole.width, lens.pinhole.height),
        gain(gain_),
        still_color(GL_RGBA8, ideal.width, ideal.height),
        still_depth(GL_DEPTH_COMPONENT32F, ideal.width, ideal.height) {
    const std::array<const GlTexture*, 1> ideal_colors = {&ideal_color};
    const std::array<const GlTexture*, 1> still_colors = {&still_color};
    still_target = GlFramebuffer(still_colors, &still_depth);
    const std::array<const GlTexture*, 1> raw_colors = {&raw_color};
    ideal_target = GlFramebuffer(ideal_colors, &ideal_depth);
    raw_target = GlFramebuffer(raw_colors, nullptr);
    const std::vector<Eigen::Vector2f> map = distortion_map(camera, ideal);
    lens_map.upload(0, 0, lens.pinhole.width, lens.pinhole.height, GL_RG, GL_FLOAT, map.data());
  }
};

/// The truth's own target.
struct DepthTarget {
  GlTexture z, depth;
  GlFramebuffer target;
  explicit DepthTarget(const PinholeCamera& view)
      : z(GL_R32F, view.width, view.height), depth(GL_DEPTH_COMPONENT32F, view.width, view.height) {
    const std::array<const GlTexture*, 1> colors = {&z};
    target = GlFramebuffer(colors, &depth);
  }
};

}  // namespace

struct DeskRenderer::State {
  GlContext context;  // first, so that it is destroyed last
  DeskCamera rig;
  std::uint64_t seed;
  GlProgram paint, shade, measure, sense;
  FullScreenTriangle full_screen;
  std::vector<GlTexture> images, hand_images;
  std::vector<std::unique_ptr<GpuMesh>> meshes;
  std::array<GpuMesh, 2> hand;
  ShadowMap static_shadow, hand_shadow;
  Eye left, right;
  std::optional<DepthTarget> depth_target;
  std::vector<Rgb> packed;

  State(GlContext gl, const DeskCamera& camera, const DeskScene& scene, std::uint64_t number,
        std::array<GlProgram, 4> programs)
      : context(std::move(gl)),
        rig(camera),
        seed(number),
        paint(std::move(programs[0])),
        shade(std::move(programs[1])),
        measure(std::move(programs[2])),
        sense(std::move(programs[3])),
        static_shadow(2048, light_from_desk({0.0, 0.15, 0.0}, 0.80, 1.5)),
        hand_shadow(1024, light_from_desk({0.10, 0.0, 0.05}, 0.50, 1.5)),
        left(camera.rig.left, 1.0F),
        right(camera.rig.right, static_cast<float>(camera.faults.right_gain)) {
    // What the calibration does not know: the right image lies a little lower.
    right = Eye(lowered(camera.rig.right, camera.faults.row_error_px), right.gain);
    for (const ColorImage& image : scene.images) images.push_back(upload(image));
    hand_images.push_back(upload(skin_image(512, 1.0, seed)));
    hand_images.push_back(upload(cloth_image(256, seed)));
    for (const PaintedMesh& mesh : scene.meshes) {
      meshes.push_back(std::make_unique<GpuMesh>());
      meshes.back()->fill(mesh);
    }
    cast_shadows(static_shadow, [this] { draw_static(); });
  }

  static DistortedCamera lowered(DistortedCamera camera, double rows) {
    camera.pinhole.cy_px += rows;
    return camera;
  }

  void draw_static() const {
    for (const auto& mesh : meshes) mesh->draw();
  }
  void draw_hand() const {
    for (const GpuMesh& mesh : hand) mesh.draw();
  }

  void fill_hand(std::span<const HandCapsule> capsules) {
    const std::vector<PaintedMesh> painted = hand_meshes(capsules);
    for (std::size_t i = 0; i < 2; ++i) hand[i].fill(painted[i]);
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
  [[nodiscard]] static std::array<int, 4> touched_by(std::span<const HandCapsule> capsules,
                                                     const Eye& eye, const Rigid3& eye_from_desk) {
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

  void draw_mesh(const GpuMesh& mesh, const std::vector<GlTexture>& from) const {
    from[static_cast<std::size_t>(mesh.image)].bind(0);
    paint.set("gloss", mesh.gloss);
    paint.set("sharpness", mesh.sharpness);
    mesh.draw();
  }

  /// Everything that stands still. Near things are last in the list: what they hide is not shaded.
  void paint_static() const {
    for (std::size_t i = meshes.size(); i-- > 0;) draw_mesh(*meshes[i], images);
  }

  void draw_eye(Eye& eye, const Rigid3& eye_from_desk, std::span<const HandCapsule> capsules,
                int key, ColorImage& picture) {
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);  // what is painted again over its own copy must pass
    glClearColor(0.0F, 0.0F, 0.0F, 1.0F);
    paint.use();
    const Eigen::Matrix4f view = eye_from_desk.matrix().cast<float>();
    paint.set("clip_from_desk", Eigen::Matrix4f(clip_from_camera(eye.ideal) * view));
    paint.set("static_light_from_desk", Eigen::Matrix4f(static_shadow.light.cast<float>()));
    paint.set("hand_light_from_desk", Eigen::Matrix4f(hand_shadow.light.cast<float>()));
    paint.set("eye", Eigen::Vector3f(eye_from_desk.inverse().translation().cast<float>()));
    paint.set("to_sun", Eigen::Vector3f(kToSun.cast<float>()));
    paint.set("image", 0);
    paint.set("static_shadow", 1);
    paint.set("hand_shadow", 2);
    static_shadow.depth.bind(1);
    hand_shadow.depth.bind(2);

    if (!eye.still_from_desk || eye.still_from_desk->matrix() != eye_from_desk.matrix()) {
      eye.still_target.bind();
      glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
      paint.set("hand_casts_shadow", 0);
      paint_static();
      eye.still_from_desk = eye_from_desk;
    }
    const auto copy = [&eye](const GlTexture& from, const GlTexture& to) {
      glCopyImageSubData(from.get(), GL_TEXTURE_2D, 0, 0, 0, 0, to.get(), GL_TEXTURE_2D, 0, 0, 0, 0,
                         eye.ideal.width, eye.ideal.height, 1);
    };
    copy(eye.still_color, eye.ideal_color);
    if (!capsules.empty()) {
      copy(eye.still_depth, eye.ideal_depth);
      eye.ideal_target.bind();
      const auto [x, y, width, height] = touched_by(capsules, eye, eye_from_desk);
      glEnable(GL_SCISSOR_TEST);
      glScissor(x, y, width, height);
      paint.set("hand_casts_shadow", 1);
      // The hand is closed: half of its triangles look away. With Y down, the others run clockwise.
      glFrontFace(GL_CW);
      glEnable(GL_CULL_FACE);
      for (const GpuMesh& mesh : hand) draw_mesh(mesh, hand_images);
      glDisable(GL_CULL_FACE);
      paint_static();
      glDisable(GL_SCISSOR_TEST);
    }

    eye.raw_target.bind();
    glDisable(GL_DEPTH_TEST);
    sense.use();
    const PinholeCamera& raw = eye.camera.pinhole;
    sense.set("ideal", 0);
    sense.set("lens_map", 1);
    eye.ideal_color.bind(0);
    eye.lens_map.bind(1);
    sense.set("ideal_size", Eigen::Vector2f(static_cast<float>(eye.ideal.width),
                                            static_cast<float>(eye.ideal.height)));
    sense.set("optical_centre",
              Eigen::Vector2f(static_cast<float>(raw.cx_px), static_cast<float>(raw.cy_px)));
    sense.set("corner_radius", static_cast<float>(0.5 * std::hypot(raw.width, raw.height)));
    sense.set("vignetting", static_cast<float>(rig.faults.vignetting));
    sense.set("gain", eye.gain);
    sense.set("noise", static_cast<float>(rig.faults.noise_grey_levels));
    sense.set("noise_key", key);
    full_screen.draw();
    picture.resize(raw.width, raw.height);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    eye.raw_target.read(0, 0, 0, raw.width, raw.height, GL_RGB, GL_UNSIGNED_BYTE, picture.data());
  }
};

DeskRenderer::DeskRenderer(std::unique_ptr<State> state) : state_(std::move(state)) {}
DeskRenderer::DeskRenderer(DeskRenderer&&) noexcept = default;
DeskRenderer& DeskRenderer::operator=(DeskRenderer&&) noexcept = default;
DeskRenderer::~DeskRenderer() {
  if (state_) state_->context.make_current();
}

Result<DeskRenderer> DeskRenderer::make(const DeskCamera& camera, const DeskScene& scene,
                                        std::uint64_t seed) {
  Result<GlContext> context = GlContext::offscreen();
  if (!context.ok()) return context.problem();
  const auto files = synth_shader_files();
  const std::array<std::array<const char*, 2>, 4> names = {{{"desk.vert", "desk.frag"},
                                                            {"shadow.vert", "shadow.frag"},
                                                            {"depth.vert", "depth.frag"},
                                                            {"sensor.vert", "sensor.frag"}}};
  std::vector<GlProgram> made;
  for (const auto& [vertex, fragment] : names) {
    Result<GlProgram> program = GlProgram::make(files, vertex, fragment);
    if (!program.ok()) return program.problem();
    made.push_back(std::move(program).value());
  }
  std::array<GlProgram, 4> programs = {std::move(made[0]), std::move(made[1]), std::move(made[2]),
                                       std::move(made[3])};
  return DeskRenderer(std::make_unique<State>(std::move(context).value(), camera, scene, seed,
                                              std::move(programs)));
}

void DeskRenderer::draw(const Rigid3& camera_from_desk, std::span<const HandCapsule> hand,
                        int frame, RawPair& pictures) {
  State& s = *state_;
  s.context.make_current();
  s.fill_hand(hand);
  s.cast_shadows(s.hand_shadow, [&s] { s.draw_hand(); });
  const Rigid3 left_from_desk = s.rig.camera_from_left.inverse() * camera_from_desk;
  const Rigid3 right_from_desk = s.rig.rig.right_from_left * left_from_desk;
  Random random(s.seed * 0x10001ULL + static_cast<std::uint64_t>(frame), "noise");
  const auto key = [&random] { return static_cast<int>(random.next() >> 33); };
  s.draw_eye(s.left, left_from_desk, hand, key(), pictures.left);
  s.draw_eye(s.right, right_from_desk, hand, key(), pictures.right);
}

void DeskRenderer::draw_depth(const Rigid3& camera_from_desk, std::span<const HandCapsule> hand,
                              const PinholeCamera& view, DepthImage& depth) {
  State& s = *state_;
  s.context.make_current();
  s.fill_hand(hand);
  if (!s.depth_target || s.depth_target->z.width() != view.width ||
      s.depth_target->z.height() != view.height)
    s.depth_target.emplace(view);
  s.depth_target->target.bind();
  glEnable(GL_DEPTH_TEST);
  const std::array<float, 4> nothing = {std::numeric_limits<float>::quiet_NaN(), 0, 0, 0};
  glClearBufferfv(GL_COLOR, 0, nothing.data());
  glClear(GL_DEPTH_BUFFER_BIT);
  s.measure.use();
  const Eigen::Matrix4f desk = camera_from_desk.matrix().cast<float>();
  s.measure.set("clip_from_desk", Eigen::Matrix4f(clip_from_camera(view) * desk));
  s.measure.set("depth_from_desk", Eigen::Vector4f(desk.row(2)));
  s.draw_hand();
  s.draw_static();
  depth.resize(view.width, view.height);
  s.depth_target->target.read(0, 0, 0, view.width, view.height, GL_RED, GL_FLOAT, depth.data());
}

int DeskRenderer::gl_error_count() const { return state_->context.errors().count(); }
const std::string& DeskRenderer::gl_description() const { return state_->context.description(); }

}  // namespace palpable

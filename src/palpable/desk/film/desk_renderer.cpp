#include "palpable/desk/film/desk_renderer.h"

#include "palpable/common/base/contract.h"
#include "palpable/desk/film/desk_painter.h"
#include "palpable/desk/film/exposure.h"
#include "palpable/desk/script/random.h"
#include "palpable/live/render/gl_context.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace palpable {

namespace {

/// A band of raw rows that is painted for one instant.
struct Band {
  double frame = 0;
  int first_row = 0, last_row = 0;
  double frames_per_row = 0;
};

/// The bands in which a frame is read.
/// @param rows  number of rows of the raw picture
std::vector<Band> bands_of(const DeskMoment& frame, int rows) {
  constexpr int kCount = 6;
  const double frames_per_row = frame.rig.readout * kFramesPerSecond / (rows - 1);
  std::vector<Band> bands;
  for (int b = 0; b < kCount; ++b) {
    Band band;
    band.first_row = b * rows / kCount;
    band.last_row = (b + 1) * rows / kCount - 1;
    band.frames_per_row = frames_per_row;
    band.frame =
        frame.frame + frames_per_row * (0.5 * (band.first_row + band.last_row) - 0.5 * (rows - 1));
    bands.push_back(band);
  }
  return bands;
}

DistortedCamera lowered(DistortedCamera camera, double rows) {
  camera.pinhole.cy_px += rows;
  return camera;
}

/// One eye, with its pose and noise, in a frame.
struct View {
  Eye& eye;
  Rigid3 eye_from_camera;
  int noise_key;

  /// eye_from_desk at a time (frames).
  [[nodiscard]] Rigid3 pose_at(const DeskMoment& frame, double at) const {
    return eye_from_camera * frame.camera_from_desk(at);
  }
};

/// The part of the ideal picture that a band of raw rows needs.
PixelBox needed_by(const Band& band, const Eye& eye) {
  float top = 1e9F, bottom = -1e9F;
  for (int row = band.first_row; row <= band.last_row; ++row) {
    top = std::min(top, eye.rows[row][0]);
    bottom = std::max(bottom, eye.rows[row][1]);
  }
  // Some more rows are needed because the camera turns within the band and the filter reads
  // neighbours.
  const int y0 = static_cast<int>(top) - 6;
  return all_of(eye.ideal).cut({0, y0, eye.ideal.width, static_cast<int>(bottom) + 8 - y0});
}

/// The homographies of an exposure between positions in the ideal picture (0..1): to a reference
/// from the instant of each look, and from that of each layer.
struct Looks {
  std::vector<Eigen::Matrix3f> still_from_moment, still_from_layer;
};

/// A render target for Z and the movers of a view.
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

/// Whether the right eye sees a point that the left one sees at column x.
/// @param z      m, depth of the point
/// @param right  the same row in the right eye: (Z, whether it moves)
bool both_see(int x, float z, std::span<const Eigen::Vector2f> right, const PinholeCamera& view,
              double baseline) {
  // In the right eye the point lies f T / Z further left. It is hidden there when both pixels next
  // to it show something nearer.
  const double u = x - view.fx_px * baseline / z;
  const auto u0 = static_cast<int>(std::floor(u));
  if (u0 < 0 || u0 + 1 >= view.width) return false;
  const float nearest = std::fmax(right[u0].x(), right[u0 + 1].x());
  return z <= 1.005F * nearest;
}

}  // namespace

struct DeskRenderer::State {
  GlContext context;  // first, so that it is destroyed last
  DeskCamera camera;
  std::uint64_t seed;
  SensorPrograms sense;
  FullScreenTriangle full_screen;
  DeskPainter painter;
  Eye left, right;
  std::optional<DepthTarget> depth_target;

  State(GlContext gl, DeskPrograms programs, const DeskCamera& desk_camera, const DeskScene& scene,
        const DeskLook& look)
      : context(std::move(gl)),
        camera(desk_camera),
        seed(look.seed),
        sense(std::move(programs.sensor)),
        painter(std::move(programs.paint), scene, look),
        left(camera.rig.left, 1.0F),
        // An error that the calibration does not contain: the right image lies a little lower.
        right(lowered(camera.rig.right, camera.faults.row_error_px),
              static_cast<float>(camera.faults.right_gain)) {}

  /// Sets the uniforms of lens and sensor in sensor.frag.
  void begin_sensing(const GlProgram& program, const View& view, const DeskMoment& frame) const {
    const Eye& eye = view.eye;
    const PinholeCamera& raw = eye.camera.pinhole;
    program.use();
    eye.lens_map.bind(0);
    program.set("lens_map", 0);
    program.set("optical_centre",
                Eigen::Vector2f(static_cast<float>(raw.cx_px), static_cast<float>(raw.cy_px)));
    program.set("corner_radius", static_cast<float>(0.5 * std::hypot(raw.width, raw.height)));
    program.set("vignetting", static_cast<float>(camera.faults.vignetting));
    program.set("gain", eye.gain * static_cast<float>(frame.rig.light));
    program.set("noise", static_cast<float>(camera.faults.noise_grey_levels));
    program.set("noise_key", view.noise_key);
  }
  /// Runs the program in use over a rectangle of the raw picture.
  void draw_raw(const Eye& eye, const PixelBox& box) const {
    if (box.empty()) return;
    eye.raw_target.bind();
    glDisable(GL_DEPTH_TEST);
    cut_to(box);
    full_screen.draw();
    glDisable(GL_SCISSOR_TEST);
  }

  /// Draws a frame without motion during the exposure.
  void draw_at_once(const View& view, const DeskMoment& frame) {
    const Movers movers = frame.movers(frame.frame);
    painter.place(movers, movers);
    painter.shade_by_movers(0.5F);
    Eye& eye = view.eye;
    const bool is_lowered = eye.lowered_by != 0.0F;
    painter.paint_ideal(eye, view.pose_at(frame, frame.frame),
                        is_lowered ? all_of(eye.ideal) : eye.without_margin(),
                        is_lowered ? eye.seen_depth_turned : eye.seen_depth, 0.0F);
    begin_sensing(sense.sharp, view, frame);
    sense.sharp.set("ideal", 1);
    eye.ideal_color.bind(1);
    draw_raw(eye, all_of(eye.camera.pinhole));
  }

  /// Computes raw rows from the ideal picture, which was painted for the instant of the middle row.
  /// @param turn  rotation from one row to the next, in the eye's frame
  void sense_band(const View& view, const DeskMoment& frame, const Band& band,
                  const Eigen::AngleAxisd& turn) const {
    const Eye& eye = view.eye;
    begin_sensing(sense.rows, view, frame);
    sense.rows.set("ideal", 1);
    eye.ideal_color.bind(1);
    sense.rows.set("moment_row", static_cast<float>(0.5 * (band.first_row + band.last_row)));
    // Small rotations are additive: the ray of a row is that of the middle row plus ray x turn for
    // each row in between.
    const Eigen::Vector3d w = turn.angle() * turn.axis();
    Eigen::Matrix3d cross;
    cross << 0, w.z(), -w.y(), -w.z(), 0, w.x(), w.y(), -w.x(), 0;
    const Eigen::Matrix3d place_from_ray = eye.place_from_ray();
    sense.rows.set(
        "turn_per_row",
        Eigen::Matrix3f((place_from_ray * cross * place_from_ray.inverse()).cast<float>()));
    draw_raw(eye,
             {0, band.first_row, eye.camera.pinhole.width, band.last_row - band.first_row + 1});
  }

  /// Draws a frame with a rolling shutter, whose rows are read one after the other.
  void read_rows(std::span<const View> views, const DeskMoment& frame) {
    const double half = 0.5 * frame.rig.readout * kFramesPerSecond;  // frames
    const double opens = frame.frame - half, closes = frame.frame + half;
    const auto [first, last] = movers_between(frame, opens, closes);
    painter.place(first, last);
    const auto along_at = [&](double at) {
      return static_cast<float>((at - opens) / (closes - opens));
    };
    const std::vector<Band> bands = bands_of(frame, camera.rig.left.pinhole.height);
    for (std::size_t b = 0; b < bands.size(); ++b) {
      const Band& band = bands[b];
      // Shadows have soft edges of 3 mm, so one shadow for two bands is accurate enough.
      if (b % 2 == 0) painter.shade_by_movers(along_at(0.5 * (band.frame + bands[b + 1].frame)));
      for (const View& view : views) {
        const Rigid3 pose = view.pose_at(frame, band.frame);
        painter.paint_ideal(view.eye, pose, needed_by(band, view.eye), view.eye.seen_depth_turned,
                            along_at(band.frame));
        const Eigen::AngleAxisd turn(
            view.pose_at(frame, band.frame + band.frames_per_row).linear() *
            pose.linear().transpose());
        sense_band(view, frame, band, turn);
      }
    }
  }

  /// Paints the references of an exposure and, if movers are in view, their layers.
  Looks paint_exposure(const View& view, const DeskMoment& frame, const Exposure& exposure,
                       bool with_movers) {
    const auto [opens, closes, references, layers, looks, turns] = exposure;
    Eye& eye = view.eye;
    const int all_layers = references * layers;
    eye.stills.hold(references, eye.ideal, eye.still_depth);
    if (with_movers) eye.layers.hold(all_layers, eye.ideal, eye.ideal_depth);
    const Eigen::Matrix3d place_from_ray = eye.place_from_ray();
    const Eigen::Matrix3d ray_from_place = place_from_ray.inverse();
    const auto homography = [&](const Eigen::Matrix3d& turn) {
      return Eigen::Matrix3f((place_from_ray * turn * ray_from_place).cast<float>());
    };
    Looks found;
    for (int r = 0; r < references; ++r) {
      const Rigid3 reference = view.pose_at(frame, exposure.middle(r, references));
      painter.paint_reference(eye, r, reference, references == 1);
      const auto turn_from = [&](double at) {
        return Eigen::Matrix3d(reference.linear() * view.pose_at(frame, at).linear().transpose());
      };
      for (int layer = r * layers; layer < (r + 1) * layers; ++layer) {
        const double at = exposure.middle(layer, all_layers);
        // A layer is painted with the rotation of the reference, so that the depth buffer of the
        // reference determines which movers are hidden.
        const Eigen::Matrix3d turn =
            turns ? turn_from(at) : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
        found.still_from_layer.push_back(homography(turn));
        for (int k = 0; k < looks; ++k)
          found.still_from_moment.push_back(
              homography(turn_from(exposure.middle(layer * looks + k, all_layers * looks))));
        if (with_movers)
          painter.paint_layer(eye, layer, Rigid3(turn * view.pose_at(frame, at)),
                              static_cast<float>((at - opens) / (closes - opens)));
      }
    }
    PALPABLE_EXPECT(found.still_from_layer.size() <= kMostLayers &&
                        found.still_from_moment.size() <= kMostLooks,
                    "sensor.frag's arrays hold all layers and looks");
    return found;
  }

  /// Computes the mean of the pictures of paint_exposure() in rectangles of the raw picture.
  void sense_mean(const View& view, const DeskMoment& frame, const Exposure& exposure,
                  const Looks& looks, std::span<const PixelBox> boxes, bool with_layers) const {
    if (boxes.empty()) return;
    const Eye& eye = view.eye;
    const GlProgram& program = sense.exposed[with_layers ? 1 : 0][exposure.turns ? 1 : 0];
    begin_sensing(program, view, frame);
    program.set("stills", 1);
    eye.stills.pictures.bind(1);
    // Without movers and without a rotation of the eye, all layers of a reference are equal.
    const int layers = with_layers || exposure.turns ? exposure.layers : 1;
    program.set("references", exposure.references);
    program.set("layers", layers);
    program.set("weight", 1.0F / static_cast<float>(exposure.references * layers * exposure.looks));
    if (with_layers) {
      program.set("movers", 2);
      eye.layers.pictures.bind(2);
    }
    if (exposure.turns) {
      program.set("looks", exposure.looks);
      program.set("still_from_moment", std::span<const Eigen::Matrix3f>(looks.still_from_moment));
      if (with_layers)
        program.set("still_from_layer", std::span<const Eigen::Matrix3f>(looks.still_from_layer));
    }
    for (const PixelBox& box : boxes) draw_raw(eye, box);
  }

  /// Draws a frame with motion blur.
  void expose(const View& view, const DeskMoment& frame, const Exposure& exposure) {
    const auto [first, last] = movers_between(frame, exposure.opens, exposure.closes);
    painter.place(first, last);
    painter.shade_by_movers(0.5F);
    std::vector<Rigid3> layer_poses;
    const int all_layers = exposure.references * exposure.layers;
    for (int layer = 0; layer < all_layers; ++layer)
      layer_poses.push_back(view.pose_at(frame, exposure.middle(layer, all_layers)));
    const Tiles tiles = view.eye.raw_tiles(
        painter.parts_touched(view.eye, layer_poses, first.desk_from_cup.has_value()));
    const std::vector<PixelBox> with_movers = tiles.boxes(true);
    const Looks looks = paint_exposure(view, frame, exposure, !with_movers.empty());
    sense_mean(view, frame, exposure, looks, with_movers, true);
    sense_mean(view, frame, exposure, looks, tiles.boxes(false), false);
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

  /// Depth of a view, row by row: (Z or NaN, whether the surface moves).
  std::vector<Eigen::Vector2f> measured(const Rigid3& camera_from_desk, const PinholeCamera& view) {
    if (!depth_target || depth_target->z.width() != view.width ||
        depth_target->z.height() != view.height)
      depth_target.emplace(view);
    painter.measure(depth_target->target, camera_from_desk, view);
    std::vector<Eigen::Vector2f> pixels(view.width * view.height);
    depth_target->target.read(0, 0, 0, view.width, view.height, GL_RG, GL_FLOAT, pixels.data());
    return pixels;
  }
};

DeskRenderer::DeskRenderer(std::unique_ptr<State> state) : state_(std::move(state)) {}
DeskRenderer::DeskRenderer(DeskRenderer&&) noexcept = default;
DeskRenderer& DeskRenderer::operator=(DeskRenderer&&) noexcept = default;
DeskRenderer::~DeskRenderer() {
  if (state_) state_->context.make_current();
}

Result<DeskRenderer> DeskRenderer::make(const DeskCamera& camera, const DeskScene& scene,
                                        const DeskLook& look) {
  Result<GlContext> context = GlContext::offscreen();
  if (!context.ok()) return context.problem();
  Result<DeskPrograms> programs = DeskPrograms::make();
  if (!programs.ok()) return programs.problem();
  return DeskRenderer(std::make_unique<State>(std::move(context).value(),
                                              std::move(programs).value(), camera, scene, look));
}

void DeskRenderer::draw(const DeskMoment& moment, RawPair& pictures) {
  State& s = *state_;
  s.context.make_current();
  const Rigid3 left_from_camera = s.camera.camera_from_left.inverse();
  Random random(s.seed * 0x10001ULL + static_cast<std::uint64_t>(moment.frame), "noise");
  const auto key = [&random] { return static_cast<int>(random.next() >> 33); };
  const int left_key = key();
  const int right_key = key();
  const std::array<View, 2> views = {
      {{s.left, left_from_camera, left_key},
       {s.right, s.camera.rig.right_from_left * left_from_camera, right_key}}};
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
  s.painter.place(movers, movers);
  const Rigid3 camera_from_desk = moment.camera_from_desk(moment.frame);
  const Rigid3 right_from_desk = Eigen::Translation3d(-baseline, 0.0, 0.0) * camera_from_desk;
  const std::vector<Eigen::Vector2f> right = s.measured(right_from_desk, view);
  const std::vector<Eigen::Vector2f> left = s.measured(camera_from_desk, view);
  truth.depth.resize(view.width, view.height);
  truth.labels.resize(view.width, view.height);
  for (int y = 0; y < view.height; ++y) {
    const std::span<const Eigen::Vector2f> in_right(&right[y * view.width], view.width);
    for (int x = 0; x < view.width; ++x) {
      const Eigen::Vector2f& here = left[y * view.width + x];
      const float z = here.x();
      truth.depth(x, y) = z;
      std::uint8_t label = 0;
      if (std::isfinite(z)) {
        if (here.y() > 0.5F) label |= kMovesLabel;
        if (both_see(x, z, in_right, view, baseline)) label |= kBothSeeLabel;
      }
      truth.labels(x, y) = label;
    }
  }
}

int DeskRenderer::gl_error_count() const { return state_->context.errors().count(); }
const std::string& DeskRenderer::gl_description() const { return state_->context.description(); }

}  // namespace palpable

// Complete sessions on images of other groups. A case is skipped with a message if its data is
// missing. The body is the dented sphere, whose inside has a closed form, so that the truth about a
// touch is the number of true points inside a ball.

#include "palpable/common/base/error.h"
#include "palpable/common/reduced/reduced_body.h"
#include "palpable/desk/score/picture_scores.h"
#include "palpable/live/render/gl_context.h"
#include "palpable/live/render/scene_renderer.h"
#include "palpable/live/session/frame_loop.h"
#include "palpable/live/sources/folder_source.h"
#include "palpable/live/sources/image_file.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using test::tolerance;

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

// Tests run in the source folder; the data is beside it.
const fs::path kSquirrel = "../shared/data/hands_squirrel";
const fs::path kMotorcycle = "/usr/lib/python3/dist-packages/skimage/data/motorcycle_disp.npz";

// The pose of a body with Z up, for a camera that looks down by `pitch` degrees (as in
// palpable live --place).
Rigid3 upright(const Vector3d& foot, double pitch) {
  Eigen::Matrix3d axes;
  axes << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  Rigid3 pose = Rigid3::Identity();
  pose.linear() =
      Eigen::AngleAxisd(pitch * std::numbers::pi / 180, Vector3d::UnitX()).toRotationMatrix() *
      axes;
  pose.translation() = foot;
  return pose;
}

// Points of a depth image within `radius` of a centre; camera frame, m.
std::vector<Vector3d> points_in_ball(const DepthImage& depth, const PinholeCamera& camera,
                                     const Vector3d& centre, double radius) {
  std::vector<Vector3d> points;
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      if (std::isnan(depth(u, v))) continue;
      const Vector3d x = camera.unproject(u, v, static_cast<double>(depth(u, v)));
      if ((x - centre).norm() < radius) points.push_back(x);
    }
  }
  return points;
}

// --- hands_squirrel ----------------------------------------------------------------------------
// A hand comes from behind and presses a ball of 40 mm on a desk. The virtual sphere of 60 mm
// surrounds that ball, which was there from the beginning and must therefore not press.

const test::DentedSphere kOverTheBall{
    .radius = 0.06,
    .directions = {{0, 0, 1}, {0, 1, 0}, {0, -1, 0}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 1}, {0, -1, 1}}};
const Vector3d kFootOfTheBall(-0.125, 0.063, 0.667);
constexpr double kLookingDown = 29;  // degrees, pitch of the camera in the recording

// The truth, independent of the session: pixels that are 20 mm nearer than the median of the
// first 15 frames belong to the hand. Returns for each frame the number of the hand's points
// inside the ball.
std::vector<int> hand_points_in_ball(const std::vector<Frame>& frames, const PinholeCamera& camera,
                                     const Vector3d& centre, double radius) {
  DepthImage background(camera.width, camera.height, kNone);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      std::vector<float> seen;
      for (std::size_t i = 0; i < 15; ++i) {
        if (!std::isnan(frames[i].depth(u, v))) seen.push_back(frames[i].depth(u, v));
      }
      if (seen.size() < 8) continue;
      std::nth_element(seen.begin(), seen.begin() + static_cast<long>(seen.size() / 2), seen.end());
      background(u, v) = seen[seen.size() / 2];
    }
  }
  std::vector<int> counts;
  for (const Frame& frame : frames) {
    DepthImage hand = frame.depth;
    for (std::size_t i = 0; i < hand.size(); ++i) {
      if (!(hand.data()[i] < background.data()[i] - 0.02f)) hand.data()[i] = kNone;
    }
    counts.push_back(static_cast<int>(points_in_ball(hand, camera, centre, radius).size()));
  }
  return counts;
}

TEST_CASE("a body on the squirrel's desk is touched when the hand reaches it and not before",
          "[sessions][real]") {
  if (!fs::exists(kSquirrel)) PALPABLE_SKIP("no folder " + kSquirrel.string());
  auto source = value_or_throw(open_folder(kSquirrel));
  const FrameFormat format = source->format();
  std::vector<Frame> frames;
  for (Frame frame; source->next(frame) == FrameStatus::kFrame;) frames.push_back(frame);
  REQUIRE(frames.size() == 90);

  const Rigid3 pose = upright(kFootOfTheBall, kLookingDown);
  const Vector3d centre = pose * Vector3d(0, 0, kOverTheBall.radius);
  FrameLoop loop = value_or_throw(FrameLoop::make(kOverTheBall.body(), pose, format, {}));
  std::vector<bool> touched;
  double highest = 0;
  for (const Frame& frame : frames) {
    const Scene& scene = loop.process(frame);
    touched.push_back(!scene.touches.empty());
    for (const Touch& touch : scene.touches) {
      highest = std::max(highest, touch.point_in_body.z());
      CHECK((touch.point_in_body - Vector3d(0, 0, kOverTheBall.radius)).norm() < 0.09);
    }
  }
  // A few points at the skin are noise of the camera (5 mm); a fingertip has 40 pixels.
  const std::vector<int> outer =
      hand_points_in_ball(frames, format.depth_camera, centre, kOverTheBall.radius + 0.008);
  const std::vector<int> inner =
      hand_points_in_ball(frames, format.depth_camera, centre, kOverTheBall.radius - 0.008);
  int arrives = 0;  // the first frame in which the hand is certainly inside
  while (arrives < 90 && inner[arrives] < 20) ++arrives;
  REQUIRE(arrives > 30);

  REQUIRE(arrives < 60);
  const auto first =
      static_cast<int>(std::find(touched.begin(), touched.end(), true) - touched.begin());
  INFO("the hand is inside from frame " << arrives << ", touched from frame " << first);
  CHECK(first <= arrives + 2);
  for (std::size_t i = 0; i < 90; ++i) {
    INFO("frame " << i << ": " << outer[i] << " points near, " << inner[i] << " inside");
    if (outer[i] == 0) CHECK_FALSE(touched[i]);
  }
  int inside = 0, felt = 0;
  for (std::size_t i = 0; i < 90; ++i) {
    if (inner[i] < 40) continue;
    ++inside;
    felt += touched[i];
  }
  CHECK(inside > 10);
  CHECK(felt >= 0.9 * inside);
  // The hand comes from above and behind.
  CHECK(highest > kOverTheBall.radius);
}

TEST_CASE("a body beside the squirrel's hand is never touched", "[sessions][real]") {
  if (!fs::exists(kSquirrel)) PALPABLE_SKIP("no folder " + kSquirrel.string());
  auto source = value_or_throw(open_folder(kSquirrel));
  // On the desk, 12 cm nearer to the camera and to its left.
  FrameLoop loop = value_or_throw(FrameLoop::make(
      kOverTheBall.body(), upright(kFootOfTheBall + Vector3d(-0.03, 0.06, -0.11), kLookingDown),
      source->format(), {}));
  for (Frame frame; source->next(frame) == FrameStatus::kFrame;) {
    INFO("frame " << frame.number);
    CHECK(loop.process(frame).touches.empty());
  }
}

// --- motorcycle --------------------------------------------------------------------------------
// A ball of 12 cm between engine and front wheel, at a distance of 2.35 m: exhaust pipes and fork
// extend into it and in front of it.

const Vector3d kAmongTheParts(0.446, 0.156, 2.35);
// Behind the seat, which hides its lower half.
const Vector3d kBehindTheSeat(-0.202, -0.12, 2.65);

struct Motorcycle {
  test::ScratchFolder folder{"motorcycle"};
  Frame frame;
  FrameFormat format;
  DepthImage true_depth;
};

std::unique_ptr<Motorcycle> motorcycle() {
  auto m = std::make_unique<Motorcycle>();
  const fs::path images = m->folder / "images";
  const std::string command = std::string(PALPABLE_PYTHON) + " " + PALPABLE_SOURCE_DIR +
                              "/tools/motorcycle_to_folder.py '" + images.string() + "' >/dev/null";
  if (std::system(command.c_str()) != 0) throw Error("failed: " + command);
  auto source = value_or_throw(open_folder(images));
  m->format = source->format();
  if (source->next(m->frame) != FrameStatus::kFrame) throw Error("no frame in " + images.string());
  Image<std::uint16_t> disparity;  // 1/256 px; 0: unknown
  static_cast<void>(
      value_or_throw(ImageFileReader().read_16bit(images / "truth/disparity.png", disparity)));
  m->true_depth.resize(disparity.width(), disparity.height());
  for (std::size_t i = 0; i < disparity.size(); ++i) {
    const std::uint16_t d = disparity.data()[i];
    m->true_depth.data()[i] =
        d == 0 ? kNone : static_cast<float>(m->format.rectified.depth(d * (1.0 / 256)));
  }
  return m;
}

// With a single picture it is unknown which things are new.
const SessionSettings kOnePicture{.press_static = true, .map = false};

ReducedBody ball_of_12_cm() { return scaled(test::DentedSphere{}.body(), 0.12 / 0.05); }

TEST_CASE("a body among the motorcycle's parts is pressed where true points are inside it",
          "[sessions][real]") {
  if (!fs::exists(kMotorcycle))
    PALPABLE_SKIP("no file " + kMotorcycle.string() + " (python3-skimage)");
  const auto m = motorcycle();
  const Rigid3 pose = upright(kAmongTheParts, 0);
  const auto inside =
      points_in_ball(m->true_depth, m->format.rectified.camera, pose * Vector3d(0, 0, 0.12), 0.10);
  REQUIRE(inside.size() > 300);  // 2 cm deep

  FrameLoop loop = value_or_throw(FrameLoop::make(ball_of_12_cm(), pose, m->format, kOnePicture));
  const Scene& scene = loop.process(m->frame);
  REQUIRE(scene.touches.size() == 1);
  const Touch& touch = scene.touches.front();
  CHECK(touch.press_depth > 0.01);
  const Vector3d touched = pose * touch.point_in_body;
  double nearest = 1;
  for (const Vector3d& x : inside) nearest = std::min(nearest, (x - touched).norm());
  CHECK(nearest < tolerance(0.05,
                            "the touched point may lie at the skin, 2 cm before the inner ball; "
                            "1 px of disparity is 28 mm"));
}

TEST_CASE("a body in the free space before the motorcycle is not pressed", "[sessions][real]") {
  if (!fs::exists(kMotorcycle))
    PALPABLE_SKIP("no file " + kMotorcycle.string() + " (python3-skimage)");
  const auto m = motorcycle();
  const Rigid3 pose = upright(kAmongTheParts - Vector3d(0.1, 0, 0.6), 0);
  REQUIRE(
      points_in_ball(m->true_depth, m->format.rectified.camera, pose * Vector3d(0, 0, 0.12), 0.20)
          .empty());
  FrameLoop loop = value_or_throw(FrameLoop::make(ball_of_12_cm(), pose, m->format, kOnePicture));
  CHECK(loop.process(m->frame).touches.empty());
}

TEST_CASE("a body behind the motorcycle's seat is hidden as the true depth implies",
          "[sessions][real]") {
  if (!fs::exists(kMotorcycle))
    PALPABLE_SKIP("no file " + kMotorcycle.string() + " (python3-skimage)");
  const auto context = GlContext::offscreen();
  if (!context.ok()) PALPABLE_SKIP("no OpenGL: " + context.problem().message);
  SceneRenderer renderer = value_or_throw(SceneRenderer::make());
  const auto m = motorcycle();
  const Rigid3 pose = upright(kBehindTheSeat, 0);
  FrameLoop loop = value_or_throw(FrameLoop::make(ball_of_12_cm(), pose, m->format, kOnePicture));
  const Scene& scene = loop.process(m->frame);

  SceneView view;
  view.background = &scene.seen.color;
  view.real_depth = &scene.seen.depth;
  view.camera = scene.seen.camera;
  BodyLook look;
  look.vertices = &scene.bodies[0].vertices;
  look.normals = &scene.bodies[0].normals;
  look.triangles = &loop.session.body().model().surface.triangles;
  look.camera_from_body = pose;
  view.bodies.push_back(look);
  ColorImage picture;
  MaskImage visible;
  DepthImage body_depth;
  renderer.draw(view, picture, &visible, &body_depth);
  const SightImage truth = true_sight(body_depth, m->true_depth);
  const MaskOverlap overlap = overlap_of(truth, drawn_sight(visible, body_depth));
  INFO(overlap.body << " px of body, " << overlap.hidden << " truly hidden");
  CHECK(overlap.body > 4000);
  CHECK(overlap.hidden * 10 > overlap.body);
  CHECK(overlap.hidden * 10 < 9 * overlap.body);
  CHECK(overlap.iou() >= 0.8);
  // Without depth the whole body would be drawn:
  MaskImage all(visible.width(), visible.height(), 0);
  for (std::size_t i = 0; i < all.size(); ++i)
    all.data()[i] = std::isnan(body_depth.data()[i]) ? 0 : 255;
  CHECK(overlap.iou() > overlap_of(truth, drawn_sight(all, body_depth)).iou() + 0.05);
}

}  // namespace
}  // namespace palpable

#include "palpable/live/player/anchoring.h"

#include "palpable/common/base/error.h"
#include "palpable/desk/clip_files/scene_files.h"
#include "palpable/live/player/live_run.h"
#include "tests/support/board_picture.h"
#include "tests/support/noise_room.h"
#include "tests/support/seen_wall.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using test::tolerance;

/// Repeats the same colour and depth images in turn.
class Pictures final : public FrameSource {
 public:
  Pictures(const FrameFormat& format, std::vector<Frame> frames, int count, bool live = false)
      : format_(format), frames_(std::move(frames)), count_(count), live_(live) {}
  const FrameFormat& format() const override { return format_; }
  FrameStatus next(Frame& frame) override {
    if (number_ == count_) return FrameStatus::kEnd;
    frame = frames_[static_cast<std::size_t>(number_) % frames_.size()];
    frame.number = number_++;
    frame.time = frame.number / 30.0;
    return FrameStatus::kFrame;
  }
  int frame_count() const override { return count_; }
  std::string last_trouble() const override { return {}; }
  bool is_live() const override { return live_; }
  [[nodiscard]] int given() const { return number_; }

 private:
  FrameFormat format_;
  std::vector<Frame> frames_;
  int count_;
  bool live_;
  int number_ = 0;
};

// A desk 0.4 m below a camera that looks down at 45 degrees: normal . x = -0.4 m.
const Vector3d kUp = Vector3d(0, -1, -1).normalized();
constexpr double kHeight = 0.4;

// @param height  m, of a surface that covers the whole desk
Frame frame_of_desk(double height = 0) {
  const FrameFormat format = test::wall_format();
  Frame frame;
  frame.left = test::frame_of_wall(0, 0).left;  // textured, for tracking
  frame.depth = DepthImage(format.width, format.height);
  for (int v = 0; v < format.height; ++v) {
    for (int u = 0; u < format.width; ++u) {
      const Vector3d ray = format.depth_camera.unproject(u, v, 1.0);
      frame.depth(u, v) = static_cast<float>((height - kHeight) / kUp.dot(ray));
    }
  }
  return frame;
}

TEST_CASE("a body is put upright on the plane that is seen, whatever a third of the frames shows",
          "[player][anchor]") {
  Pictures desk(test::wall_format(), {frame_of_desk(), frame_of_desk(0.15), frame_of_desk()}, 100);
  const Rigid3 pose = pose_on_plane(desk, "the desk", {});
  CHECK(desk.given() == 30);
  CHECK((pose.linear().col(2) - kUp).norm() <= tolerance(1e-4, "depths are floats"));
  CHECK(std::abs(kUp.dot(pose.translation()) + kHeight) <= tolerance(1e-4, "depths are floats"));
  // The intersection of the optical axis with the desk.
  const Vector3d middle(0, 0, kHeight / -kUp.z());
  CHECK((pose.translation() - middle).norm() <=
        tolerance(0.02, "one pixel in 16 is looked at: 4 px of 250 at 0.57 m"));
}

// The same desk with a texture, seen by a camera that rises by 3 mm per frame and turns by 0.3
// degrees about the desk's normal, so that it always looks down at 45 degrees.
constexpr double kRise = 0.003;

Frame frame_of_rising_camera(const FrameFormat& format, int number) {
  const double height = kHeight + kRise * number;
  const Eigen::Matrix3d first_from_camera =
      Eigen::AngleAxisd(0.005 * number, kUp).toRotationMatrix();
  Frame frame;
  frame.left = ColorImage(format.width, format.height);
  frame.depth = DepthImage(format.width, format.height);
  for (int v = 0; v < format.height; ++v) {
    for (int u = 0; u < format.width; ++u) {
      const Vector3d ray = format.depth_camera.unproject(u, v, 1.0);
      const double Z = -height / kUp.dot(ray);
      frame.depth(u, v) = static_cast<float>(Z);
      const Vector3d at = first_from_camera * (Z * ray);
      const auto grey = static_cast<std::uint8_t>(
          test::wall_texture(at.x(), at.dot(Vector3d(0, 1, -1).normalized()), 1));
      frame.left(u, v) = {grey, grey, grey};
    }
  }
  return frame;
}

TEST_CASE(
    "before a moving camera a body stands where the session begins: a recording's first "
    "frame, a live camera's last one",
    "[player][anchor]") {
  FrameFormat format = test::wall_format();
  format.width = 321;
  format.height = 241;
  format.depth_camera = {321, 241, 300, 300, 160, 120};
  std::vector<Frame> frames;
  for (int n = 0; n < 30; ++n) frames.push_back(frame_of_rising_camera(format, n));
  for (const bool live : {false, true}) {
    INFO((live ? "live" : "recorded"));
    Pictures desk(format, frames, 30, live);
    const Rigid3 pose = pose_on_plane(desk, "the desk", {});
    const double height = kHeight + (live ? 29 * kRise : 0);
    CHECK((pose.linear().col(2) - kUp).norm() <= tolerance(5e-4, "of the poses that are followed"));
    CHECK(std::abs(kUp.dot(pose.translation()) + height) <=
          tolerance(5e-4, "of the poses that are followed"));
    const Vector3d middle(0, 0, height / -kUp.z());
    CHECK((pose.translation() - middle).norm() <=
          tolerance(0.02, "one pixel in 16 is looked at: 4 px of 300 at 0.6 m, and the poses"));
  }
}

TEST_CASE("a body is put on the middle of the chessboard that is seen", "[player][anchor]") {
  FrameFormat format = test::wall_format();
  format.width = 321;
  format.height = 241;
  format.depth_camera = {321, 241, 300, 300, 160, 120};
  const BoardPattern pattern{.columns = 5, .rows = 4, .square = 0.03};
  Rigid3 camera_from_board = Rigid3::Identity();  // X right, Y down, tilted back a little
  camera_from_board.linear() = Eigen::AngleAxisd(0.4, Vector3d::UnitX()).toRotationMatrix();
  camera_from_board.translation() = Vector3d(-0.05, -0.04, 0.5);
  Frame frame;
  frame.left = test::board_picture({format.depth_camera}, camera_from_board, pattern, 3);
  frame.depth = DepthImage(format.width, format.height, 0.5F);
  Pictures board(format, {frame}, 3);
  const Rigid3 pose = pose_on_board(board, "the board", {}, pattern);
  const Vector3d middle = camera_from_board * (pattern.square * Vector3d(2, 1.5, 0));
  CHECK((pose.translation() - middle).norm() <=
        tolerance(2e-3, "0.1 px of the corners of a board that is 72 px wide"));
  CHECK(pose.linear().col(2).dot(camera_from_board.linear().col(2)) <
        -0.999);  // Z points out of the board to the camera, within 2.6 degrees
}

TEST_CASE(
    "a body is put on the surface at a pixel: on the desk as it is seen, on a box as it faces",
    "[player][anchor]") {
  // The picture has twice the size of the depth image.
  SeenFrame seen;
  seen.depth_camera = test::wall_format().depth_camera;
  seen.camera = {322, 242, 500, 500, 160.5, 120.5};
  seen.depth = frame_of_desk().depth;
  for (int v = 70; v < 110; ++v) {
    for (int u = 20; u < 70; ++u) seen.depth(u, v) = 0.3F;
  }
  const DepthNoise noise{0, 0, 0.002};
  const Vector2d on_desk(250.3, 160.2), on_box(90, 180);
  const auto desk = pose_at_pixel(seen, noise, on_desk);
  REQUIRE(desk);
  CHECK((desk->linear().col(2) - kUp).norm() <= tolerance(2e-3, "the desk's plane beside a box"));
  const Vector3d ray = seen.camera.unproject(on_desk.x(), on_desk.y(), 1.0);
  CHECK((desk->translation() - ray * (-kHeight / kUp.dot(ray))).norm() <=
        tolerance(1e-3, "the desk's plane beside a box"));
  const auto box = pose_at_pixel(seen, noise, on_box);
  REQUIRE(box);
  CHECK((box->linear().col(2) + Vector3d::UnitZ()).norm() <= tolerance(1e-4, "depths are floats"));
  CHECK((box->translation() - seen.camera.unproject(on_box.x(), on_box.y(), 0.3)).norm() <=
        tolerance(1e-4, "depths are floats"));
  CHECK_FALSE(pose_at_pixel(seen, noise, {-20, 40}));
}

// A desk with a box about 50 mm high in the centre of the picture.
Frame frame_of_crowded_desk() {
  Frame frame = frame_of_desk();
  const int width = frame.depth.width(), height = frame.depth.height();
  for (int v = height / 2 - 25; v < height / 2 + 25; ++v) {
    for (int u = width / 2 - 30; u < width / 2 + 30; ++u) frame.depth(u, v) -= 0.06F;
  }
  return frame;
}

TEST_CASE("on a desk with a thing in the middle a body stands beside it, or at the given pixel",
          "[player][anchor]") {
  const FrameFormat format = test::wall_format();
  const PinholeCamera& camera = format.depth_camera;
  Pictures desk(format, {frame_of_crowded_desk()}, 4);
  const Footprint body{0.03, 0.05};
  const Rigid3 beside = pose_on_plane(desk, "the desk", {}, {body, std::nullopt});
  CHECK((beside.linear().col(2) - kUp).norm() <= tolerance(2e-3, "the desk's plane beside a box"));
  // No point of the box is within the body's radius, seen from above.
  const Frame crowded = frame_of_crowded_desk();
  double nearest = 1;
  for (int v = 0; v < format.height; ++v) {
    for (int u = 0; u < format.width; ++u) {
      const Vector3d off =
          camera.unproject(u, v, static_cast<double>(crowded.depth(u, v))) - beside.translation();
      const double above = kUp.dot(off);
      if (above > 0.01) nearest = std::min(nearest, (off - above * kUp).norm());
    }
  }
  CHECK(nearest >= body.radius);
  CHECK(nearest < 0.1);  // and not farther away than necessary

  Pictures again(format, {frame_of_crowded_desk()}, 4);
  const Vector2d wanted(0.25 * camera.width, 0.75 * camera.height);
  const Rigid3 there = pose_on_plane(again, "the desk", {}, {body, wanted});
  CHECK((camera.project(there.translation()) - wanted).norm() <= tolerance(0.1, "px; the plane"));
  CHECK((there.linear().col(2) - kUp).norm() <= tolerance(2e-3, "the desk's plane"));
  // At the pixel of the box, the body stands on the box.
  Pictures third(format, {frame_of_crowded_desk()}, 4);
  const Vector2d middle(0.5 * camera.width, 0.5 * camera.height);
  const Rigid3 on_top = pose_on_plane(third, "the desk", {}, {body, middle});
  CHECK((camera.project(on_top.translation()) - middle).norm() <= tolerance(0.1, "px; the plane"));
  CHECK(kUp.dot(on_top.translation()) + kHeight > 0.02);

  using Catch::Contains;
  const auto refused = [&](Frame frame, const Spot& spot) {
    Pictures source(format, {std::move(frame)}, 4);
    try {
      (void)pose_on_plane(source, "the desk", {}, spot);
    } catch (const Error& error) { return std::string(error.what()); }
    return std::string("stands");
  };
  CHECK_THAT(refused(frame_of_desk(), {body, Vector2d(-1, 5)}), Contains("-1, 5 is outside of"));
  Frame hole = frame_of_desk();
  std::fill(hole.depth.begin(), hole.depth.end(), std::nanf(""));
  CHECK_THAT(refused(hole, {body, wanted}), Contains("show no surface at pixel"));
  CHECK_THAT(refused(frame_of_crowded_desk(), {{0.5, 0.1}, std::nullopt}),
             Contains("no place of 1.00 m is free"));
}

TEST_CASE("a run that begins anew on a crowded desk puts bodies where its start does",
          "[player][anchor]") {
  const FrameFormat format = test::wall_format();
  const DepthCamera camera = value_or_throw(DepthCamera::make(format, {}));
  SeenFrame seen;
  seen.depth_camera = seen.camera = format.depth_camera;
  seen.depth = frame_of_crowded_desk().depth;
  const SurfaceMesh skin = sphere_surface({0, 0, 0.03}, 0.03, 2);
  LiveSettings settings;
  settings.anchor = Anchor::kPlane;
  const std::vector<BodyPlace> places(1);
  const std::vector<const SurfaceMesh*> skins{&skin};
  const Footprint room = footprint_of(places, skins, settings.anchor);
  CHECK(room.radius == Approx(0.03).epsilon(0.02));
  for (const auto& at_px : {std::optional<Vector2d>(), std::optional(Vector2d(40, 90))}) {
    INFO((at_px ? "at a pixel" : "looked for"));
    settings.at_px = at_px;
    Pictures desk(format, {frame_of_crowded_desk()}, 4);
    const Rigid3 start = pose_on_plane(desk, "the desk", {}, {room, at_px});
    const std::vector<Rigid3> anew =
        places_anew(places, skins, settings, "nowhere", seen, camera.noise());
    REQUIRE(anew.size() == 1);
    CHECK((anew[0].translation() - start.translation()).norm() <=
          tolerance(2e-3, "m: the start's camera is followed"));
    CHECK((anew[0].linear() - start.linear()).norm() <= tolerance(5e-3, "likewise"));
  }
  using Catch::Contains;
  settings.at_px = Vector2d(-20, 40);
  CHECK_THROWS_WITH(places_anew(places, skins, settings, "nowhere", seen, camera.noise()),
                    Contains("no surface is seen at pixel -20, 40"));
  settings.at_px.reset();
  const SurfaceMesh large = sphere_surface({0, 0, 0.5}, 0.5, 2);
  CHECK_THROWS_WITH(places_anew(places, {&large}, settings, "nowhere", seen, camera.noise()),
                    Contains("free place"));
}

TEST_CASE("where no plane, no board or no picture is, the source is named and what is missing",
          "[player][anchor][errors]") {
  using Catch::Contains;
  // The wall is turned, because one that faces the camera cannot be told from a desk
  // seen from above.
  const auto wall = [] {
    Frame turned = test::frame_of_wall(0, 0);
    const PinholeCamera camera = test::wall_format().depth_camera;
    const Vector3d normal(std::sin(0.6), 0, -std::cos(0.6));
    for (int v = 0; v < turned.depth.height(); ++v) {
      for (int u = 0; u < turned.depth.width(); ++u) {
        turned.depth(u, v) = static_cast<float>(-0.6 / normal.dot(camera.unproject(u, v, 1.0)));
      }
    }
    return Pictures(test::wall_format(), {turned}, 4);
  };
  Pictures aside = wall();
  CHECK_THROWS_WITH(pose_on_plane(aside, "my clip", {}),
                    Contains("my clip: its first 4 frames show no plane to stand on"));
  Pictures bare = wall();
  CHECK_THROWS_WITH(pose_on_board(bare, "my clip", {}, {}),
                    Contains("no chessboard of 9x6 inner corners") && !Contains("--"));
  Pictures wall_again = wall();
  CHECK_THROWS_AS(pose_on_plane(wall_again, "my clip", {}), NoPlaceError);
  Pictures empty(test::wall_format(), {}, 0);
  CHECK_THROWS_WITH(pose_on_plane(empty, "my clip", {}), Contains("my clip: gives no picture"));
}

}  // namespace
}  // namespace palpable

#include "palpable/common/base/contract.h"
#include "palpable/common/body_file/touch_file.h"
#include "palpable/live/capi/c_session.h"
#include "palpable/live/capi/guarded.h"
#include "palpable/live/capi/palpable.h"
#include "palpable/live/session/frame_loop.h"
#include "tests/support/allocations.h"
#include "tests/support/c_calls.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/seen_capsules.h"
#include "tests/support/seen_wall.h"
#include "tests/support/some_touch_tables.h"
#include "tests/support/test.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <limits>
#include <new>
#include <span>
#include <string>
#include <thread>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;
using test::tolerance;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// A ball of 10 cm diameter that stands on Z = 0 and can be pressed anywhere.
const std::string& body_file() {
  static const test::ScratchFolder folder("c_interface");
  static const std::string path = test::write_ball_body(folder, "ball.palpable", 0.003);
  return path;
}

// A body's handle, freed by the destructor.
struct Body {
  palpable_body* handle = nullptr;
  explicit Body(const std::string& path = body_file(), double scale = 1) {
    const palpable_status status = palpable_load_body(path.c_str(), scale, &handle);
    INFO(palpable_last_error());
    REQUIRE(status == PALPABLE_OK);
  }
  Body(const Body&) = delete;
  ~Body() { palpable_free_body(handle); }
};

// The body stands in front of the camera: its Z axis is the camera's -Y, tilted a little.
Rigid3 camera_from_body() {
  Rigid3 pose = Rigid3::Identity();
  pose.linear() = (Eigen::AngleAxisd(0.5 - std::acos(0.0), Vector3d::UnitX()) *
                   Eigen::AngleAxisd(2 * std::acos(0.0), Vector3d::UnitX()))
                      .toRotationMatrix();
  pose.translation() = Vector3d(0.01, 0.03, 0.40);
  return pose;
}

std::array<double, 16> rows_of(const Rigid3& pose) {
  std::array<double, 16> rows{};
  Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>{rows.data()} = pose.matrix();
  return rows;
}

struct Session {
  palpable_session* handle = nullptr;
  explicit Session(const palpable_setup& setup, palpable_body* body = nullptr) {
    const Body own;
    if (setup.camera != PALPABLE_NO_CAMERA) {
      REQUIRE(palpable_place_body(own.handle, rows_of(camera_from_body()).data()) == PALPABLE_OK);
    }
    const palpable_body* bodies[] = {body != nullptr ? body : own.handle};
    const palpable_status status = palpable_open(bodies, 1, &setup, &handle);
    INFO(palpable_last_error());
    REQUIRE(status == PALPABLE_OK);
  }
  Session(const Session&) = delete;
  ~Session() { palpable_close(handle); }
  operator palpable_session*() const { return handle; }  // NOLINT: as in C
};

palpable_frame frame_of(const palpable_session* session) {
  auto frame = test::sized<palpable_frame>();
  REQUIRE(palpable_get_frame(session, &frame) == PALPABLE_OK);
  return frame;
}

palpable_skin skin_of(const palpable_session* session) {
  auto skin = test::sized<palpable_skin>();
  REQUIRE(palpable_get_skin(session, 0, &skin) == PALPABLE_OK);
  return skin;
}

Eigen::Matrix3Xf vertices_of(const palpable_session* session) {
  const palpable_skin skin = skin_of(session);
  return Eigen::Map<const Eigen::Matrix3Xf>(skin.vertices, 3, skin.vertex_count);
}

palpable_touch touch_of(const palpable_session* session, int index = 0) {
  auto touch = test::sized<palpable_touch>();
  REQUIRE(palpable_get_touch(session, index, &touch) == PALPABLE_OK);
  return touch;
}

Vector3d whole_force(const palpable_session* session) {
  Vector3d force = Vector3d::Zero();
  for (int k = 0; k < frame_of(session).touch_count; ++k) {
    force += Vector3d(touch_of(session, k).force);
  }
  return force;
}

// A finger of radius 8 mm that penetrates the top of the ball by `depth`, m.
palpable_capsule finger(double depth) {
  const double tip = 0.1 - depth + 0.008;
  return {{0, 0, tip}, {0.01, 0, tip + 0.1}, 0.008, 0.008};
}

palpable_setup no_camera() { return test::sized<palpable_setup>(); }

// A colour and depth camera like the one that sees the synthetic wall.
palpable_setup depth_camera() {
  const FrameFormat format = test::wall_format();
  palpable_setup setup = no_camera();
  setup.camera = PALPABLE_COLOR_DEPTH;
  setup.width = format.width;
  setup.height = format.height;
  setup.fx = format.depth_camera.fx_px;
  setup.fy = format.depth_camera.fy_px;
  setup.cx = format.depth_camera.cx_px;
  setup.cy = format.depth_camera.cy_px;
  setup.press_static = 1;
  return setup;
}

// A picture of the same finger in front of a wall, with the hand that it belongs to.
Frame frame_with_finger(int number, double depth) {
  const palpable_capsule c = finger(depth);
  const auto at = [&](const double x[3]) { return Vector3d(camera_from_body() * Vector3d(x)); };
  const double beside[2][3] = {{-0.04, 0, c.a[2] + 0.02}, {0.04, 0, c.a[2] + 0.02}};
  const DepthImage seen =
      test::depth_of({{at(c.a), at(c.b), 0.008}, {at(beside[0]), at(beside[1]), 0.012}},
                     test::wall_format().depth_camera);
  Frame frame = test::frame_of_wall(number, 0);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (std::isnan(seen.data()[i])) continue;
    frame.depth.data()[i] = seen.data()[i];
    frame.left.data()[i] = Rgb{220, 150, 120};
  }
  return frame;
}

palpable_image image_of(const DepthImage& depth) {
  return {sizeof(palpable_image), depth.data(),       depth.width(),
          depth.height(),         PALPABLE_DEPTH_F32, 0};
}
palpable_image image_of(const ColorImage& color) {
  return {sizeof(palpable_image), color.data(), color.width(), color.height(), PALPABLE_RGB8, 0};
}

palpable_status feed(palpable_session* session, const Frame& frame,
                     const double* world_from_camera = nullptr) {
  const palpable_image depth = image_of(frame.depth), color = image_of(frame.left);
  return palpable_feed_depth(session, &depth, &color, world_from_camera, frame.time);
}

TEST_CASE("the header's version is that of the library", "[capi]") {
  CHECK(std::string(palpable_version()) == std::to_string(PALPABLE_VERSION_MAJOR) + "." +
                                               std::to_string(PALPABLE_VERSION_MINOR) + "." +
                                               std::to_string(PALPABLE_VERSION_PATCH));
}

TEST_CASE("a finger without any camera presses the skin down and lets it go again", "[capi]") {
  const Session session(no_camera());
  const Eigen::Matrix3Xf rest = vertices_of(session);
  CHECK(std::isnan(frame_of(session).time));
  double before = 0;
  for (const double depth : {0.002, 0.004, 0.006}) {
    const palpable_capsule c = finger(depth);
    REQUIRE(palpable_press(session, &c, 1) == PALPABLE_OK);
    const palpable_frame frame = frame_of(session);
    REQUIRE(frame.touch_count == 1);
    CHECK(frame.left_to_go < tolerance(1e-4, "m: what the softness of a point leaves"));
    const palpable_touch touch = touch_of(session);
    CHECK(touch.body == 0);
    CHECK(touch.by == -1);
    CHECK(touch.depth == Approx(depth).margin(tolerance(2e-4, "m: points 2 mm apart")));
    CHECK((Vector3d(touch.point) - Vector3d(0, 0, 0.1 - depth)).norm() <
          tolerance(2e-3, "m, likewise"));
    const Vector3d force(touch.force), normal(touch.normal);
    CHECK(force.norm() > before);
    CHECK(normal.dot(force) == Approx(-force.norm()));
    CHECK(normal.z() > 0.9);
    CHECK(touch.area > 0);
    before = force.norm();
    const Eigen::Matrix3Xf now = vertices_of(session);
    CHECK((rest - now).row(2).maxCoeff() ==
          Approx(depth).margin(tolerance(5e-4, "m: vertices 6 mm apart")));
    const palpable_skin skin = skin_of(session);
    CHECK(*std::max_element(skin.von_mises, skin.von_mises + skin.vertex_count) > 100.0f);
    REQUIRE(skin.contact_pressure != nullptr);
    const auto most =
        std::max_element(skin.contact_pressure, skin.contact_pressure + skin.vertex_count);
    CHECK(*most > 100.0f);
    // The touch is where the contact pressure is largest, to the skin's resolution, 6 mm.
    CHECK((now.col(most - skin.contact_pressure).cast<double>() - Vector3d(touch.point)).norm() <
          0.006);
    CHECK(std::hypot(skin.normals[0], skin.normals[1], skin.normals[2]) == Approx(1));
  }
  CHECK(frame_of(session).time == 3);
  REQUIRE(palpable_press(session, nullptr, 0) == PALPABLE_OK);
  CHECK(frame_of(session).touch_count == 0);
  CHECK((vertices_of(session) - rest).norm() == 0);
}

TEST_CASE("a thing that comes on far is given way to in several calls, and the frame says so",
          "[capi]") {
  const Session session(no_camera());
  const Eigen::Matrix3Xf rest = vertices_of(session);
  const palpable_capsule ball{{0, 0, 0.122}, {0, 0, 0.122}, 0.04, 0.04};  // 18 mm deep
  REQUIRE(palpable_press(session, &ball, 1) == PALPABLE_OK);
  CHECK(frame_of(session).left_to_go > 1e-3);
  for (int k = 0; k < 4; ++k) REQUIRE(palpable_press(session, &ball, 1) == PALPABLE_OK);
  CHECK(frame_of(session).left_to_go < tolerance(3e-4, "m: what the softness of points leaves"));
  CHECK((rest - vertices_of(session)).row(2).maxCoeff() ==
        Approx(0.018).margin(tolerance(1e-3, "m: vertices 6 mm apart")));
}

TEST_CASE("capsules are in the world and forces in the body's frame, wherever that stands",
          "[capi]") {
  Rigid3 world_from_body = Rigid3::Identity();
  world_from_body.linear() =
      Eigen::AngleAxisd(1.1, Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  world_from_body.translation() = Vector3d(3, -1, 2);
  const Body body;
  REQUIRE(palpable_place_body(body.handle, rows_of(world_from_body).data()) == PALPABLE_OK);
  const Session here(no_camera()), there(no_camera(), body.handle);
  const palpable_capsule c = finger(0.004);
  palpable_capsule moved = c;
  Vector3d::Map(moved.a) = world_from_body * Vector3d(c.a);
  Vector3d::Map(moved.b) = world_from_body * Vector3d(c.b);
  REQUIRE(palpable_press(here, &c, 1) == PALPABLE_OK);
  REQUIRE(palpable_press(there, &moved, 1) == PALPABLE_OK);
  CHECK((whole_force(here) - whole_force(there)).norm() <
        tolerance(1e-4, "N: floats, 3 m away from the origin") * whole_force(here).norm());
  CHECK(skin_of(there).world_from_body[3] == 3);
}

TEST_CASE("a body at another scale is as stiff as the larger one of the same material", "[capi]") {
  const Body twice(body_file(), 2);
  const Session one(no_camera()), two(no_camera(), twice.handle);
  const palpable_capsule c = finger(0.004);
  palpable_capsule large = c;
  for (int k = 0; k < 3; ++k) {
    large.a[k] *= 2;
    large.b[k] *= 2;
  }
  large.radius_a = large.radius_b = 0.016;
  REQUIRE(palpable_press(one, &c, 1) == PALPABLE_OK);
  // The step limit is the same for both bodies, so that the larger one needs more calls.
  for (int k = 0; k < 3; ++k) REQUIRE(palpable_press(two, &large, 1) == PALPABLE_OK);
  CHECK(whole_force(two).norm() ==
        Approx(4 * whole_force(one).norm()).epsilon(tolerance(0.05, "other contact points")));
}

TEST_CASE("frames fed through C give the bytes of the C++ loop", "[capi]") {
  const Session session(depth_camera());
  FrameLoop loop = value_or_throw(FrameLoop::make(
      value_or_throw(read_pressable_touchable_body(body_file())), camera_from_body(),
      test::wall_format(), {.press_static = true, .map = false}));
  for (int n = 0; n < 7; ++n) {
    const Frame frame = frame_with_finger(n, n < 2 ? -0.03 : 0.0015 * n);
    REQUIRE(feed(session, frame) == PALPABLE_OK);
    const Scene& scene = loop.process(frame);
    CHECK(frame_of(session).touch_count == static_cast<int>(scene.touches.size()));
    CHECK(vertices_of(session) == scene.bodies[0].vertices);
    CHECK(frame_of(session).time == frame.time);
  }
  REQUIRE_FALSE(loop.scene.touches.empty());
  const Touch& expected = loop.scene.touches[0];
  const palpable_touch touch = touch_of(session);
  CHECK(Vector3d(touch.point) == expected.point_in_body);
  CHECK(Vector3d(touch.force) == expected.force * expected.direction);
  CHECK(touch.depth == expected.press_depth);
  CHECK(touch.area == expected.area);
  CHECK(touch.assumed == expected.assumed);
  const palpable_skin skin = skin_of(session);
  CHECK(std::memcmp(skin.von_mises, loop.scene.bodies[0].von_mises.data(),
                    sizeof(float) * static_cast<std::size_t>(skin.vertex_count)) == 0);
  CHECK((skin.contact_pressure == nullptr) ==
        (loop.session.body(0).response.contact() != ContactKind::kAnywhere));
  CHECK(skin.triangles[4] == loop.session.body().model().surface.triangles(1, 1));
  auto depth = test::sized<palpable_depth>();
  REQUIRE(palpable_get_depth(session, &depth) == PALPABLE_OK);
  CHECK(depth.width == 161);
  CHECK(depth.fx == 250);
  CHECK(depth.depth[0] == static_cast<float>(test::kWallZ));
  CHECK(std::isnan(skin.stated_stress_error));  // these tables have no held-out touches
}

TEST_CASE("a session that was reset gives the same bytes again", "[capi]") {
  const Session session(depth_camera());
  std::vector<Eigen::Matrix3Xf> first;
  for (int run = 0; run < 2; ++run) {
    for (int n = 0; n < 5; ++n) {
      REQUIRE(feed(session, frame_with_finger(n, 0.002 * n)) == PALPABLE_OK);
      if (run == 0) first.push_back(vertices_of(session));
      CHECK(vertices_of(session) == first[static_cast<std::size_t>(n)]);
    }
    REQUIRE(palpable_reset(session) == PALPABLE_OK);
    CHECK(frame_of(session).touch_count == 0);
  }
}

// The colours of `color` in another order of channels, with unused bytes between the rows.
std::vector<std::uint8_t> with_gaps(const ColorImage& color, const std::array<int, 4>& from,
                                    std::size_t bytes, std::size_t stride) {
  std::vector<std::uint8_t> pixels(stride * static_cast<std::size_t>(color.height()), 99);
  for (int y = 0; y < color.height(); ++y) {
    for (int x = 0; x < color.width(); ++x) {
      const Rgb c = color(x, y);
      const std::array<std::uint8_t, 3> rgb{c.r, c.g, c.b};
      for (std::size_t k = 0; k < bytes; ++k) {
        const int channel = from[k];
        pixels[static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(x) * bytes + k] =
            channel < 3 ? rgb[static_cast<std::size_t>(channel)] : std::uint8_t{7};
      }
    }
  }
  return pixels;
}

// Two views of a wall with random colours, shifted by 20 px.
ColorImage eye(int shift) {
  ColorImage image(320, 180);
  for (int y = 0; y < 180; ++y) {
    for (int x = 0; x < 320; ++x) {
      std::uint32_t h = static_cast<std::uint32_t>((x + shift) / 2) * 0x9E3779B1U ^
                        static_cast<std::uint32_t>(y / 2) * 0x85EBCA77U;
      h = (h ^ (h >> 15)) * 0x2C1B3C6DU;
      h ^= h >> 12;
      image(x, y) = {static_cast<std::uint8_t>(h & 0xFF),
                     static_cast<std::uint8_t>((h >> 8) & 0xFF),
                     static_cast<std::uint8_t>((h >> 16) & 0xFF)};
    }
  }
  return image;
}

palpable_setup stereo_camera() {
  palpable_setup setup = no_camera();
  setup.camera = PALPABLE_STEREO;
  setup.width = 320;
  setup.height = 180;
  setup.fx = setup.fy = 175;
  setup.cx = 159.5;
  setup.cy = 89.5;
  setup.baseline = 0.063;
  setup.press_static = 1;
  return setup;
}

TEST_CASE("a pair gives the wall's depth, whatever the order of its bytes and their strides",
          "[capi]") {
  const ColorImage left = eye(0), right = eye(20);
  std::vector<float> of_rgb;
  struct Layout {
    int format;
    std::array<int, 4> from;
    std::size_t bytes, stride;
  };
  for (const Layout& layout :
       {Layout{PALPABLE_RGB8, {0, 1, 2, 3}, 3, 961}, Layout{PALPABLE_BGR8, {2, 1, 0, 3}, 3, 1000},
        Layout{PALPABLE_RGBA8, {0, 1, 2, 3}, 4, 1280}, Layout{PALPABLE_GRAY8, {0}, 1, 320}}) {
    INFO("format " << layout.format);
    const Session session(stereo_camera());
    const auto l = with_gaps(left, layout.from, layout.bytes, layout.stride);
    const auto r = with_gaps(right, layout.from, layout.bytes, layout.stride);
    const palpable_image images[2] = {
        {sizeof(palpable_image), l.data(), 320, 180, layout.format, layout.stride},
        {sizeof(palpable_image), r.data(), 320, 180, layout.format, layout.stride}};
    REQUIRE(palpable_feed_stereo(session, &images[0], &images[1], nullptr, 0) == PALPABLE_OK);
    auto depth = test::sized<palpable_depth>();
    REQUIRE(palpable_get_depth(session, &depth) == PALPABLE_OK);
    REQUIRE(depth.width == 160);
    int right_ones = 0;
    for (int i = 0; i < 160 * 90; ++i) {
      right_ones += std::abs(depth.depth[i] - 175 * 0.063f / 20) < 0.01f;
    }
    CHECK(right_ones > 10000);
    const std::span<const float> all(depth.depth, 160 * 90);
    if (layout.format == PALPABLE_RGB8) of_rgb.assign(all.begin(), all.end());
    if (layout.format == PALPABLE_GRAY8) continue;  // one channel of the three
    CHECK(std::memcmp(all.data(), of_rgb.data(), all.size_bytes()) == 0);
  }
  // Swapped eyes are noticed.
  const Session session(stereo_camera());
  const palpable_image images[2] = {image_of(left), image_of(right)};
  REQUIRE(palpable_feed_stereo(session, &images[0], &images[1], nullptr, 0) == PALPABLE_OK);
  CHECK(frame_of(session).wrong_pair == 0);
  const Session swapped(stereo_camera());
  REQUIRE(palpable_feed_stereo(swapped, &images[1], &images[0], nullptr, 0) == PALPABLE_OK);
  CHECK(frame_of(swapped).wrong_pair == 1);
}

TEST_CASE("raw pairs are rectified by the rig's calibration file", "[capi]") {
  const test::ScratchFolder folder("c_interface_rig");
  const std::string file = (folder / "rig.yml").string();
  const auto matrix = [](const char* name, int rows, int columns, const char* numbers) {
    return std::string(name) + ": !!opencv-matrix\n   rows: " + std::to_string(rows) +
           "\n   cols: " + std::to_string(columns) + "\n   dt: d\n   data: [ " + numbers + " ]\n";
  };
  const char* K = "175., 0., 159.5, 0., 175., 89.5, 0., 0., 1.";
  std::ofstream(file) << "%YAML:1.0\n---\nimage_width: 320\nimage_height: 180\n"
                      << matrix("K1", 3, 3, K) << matrix("D1", 1, 5, "0., 0., 0., 0., 0.")
                      << matrix("K2", 3, 3, K) << matrix("D2", 1, 5, "0., 0., 0., 0., 0.")
                      << matrix("R", 3, 3, "1., 0., 0., 0., 1., 0., 0., 0., 1.")
                      << matrix("T", 3, 1, "-0.063, 0., 0.");
  palpable_setup setup = no_camera();
  setup.camera = PALPABLE_STEREO;
  setup.calibration = file.c_str();
  const Session raw(setup), rectified(stereo_camera());
  const ColorImage left = eye(0), right = eye(20);
  const palpable_image l = image_of(left), r = image_of(right);
  REQUIRE(palpable_feed_stereo(raw, &l, &r, nullptr, 0) == PALPABLE_OK);
  REQUIRE(palpable_feed_stereo(rectified, &l, &r, nullptr, 0) == PALPABLE_OK);
  auto from_raw = test::sized<palpable_depth>(), expected = test::sized<palpable_depth>();
  REQUIRE(palpable_get_depth(raw, &from_raw) == PALPABLE_OK);
  REQUIRE(palpable_get_depth(rectified, &expected) == PALPABLE_OK);
  const auto middle = static_cast<std::ptrdiff_t>(45 * 160 + 80);
  CHECK(from_raw.depth[middle] ==
        Approx(expected.depth[middle]).epsilon(tolerance(0.01, "where stereoRectify puts f")));
}

TEST_CASE("a pose that is given moves the camera, one that is not known lets go", "[capi]") {
  Rigid3 world_from_camera = Rigid3::Identity();
  world_from_camera.translation() = Vector3d(0.5, 0.25, -1);
  const Body body;
  REQUIRE(palpable_place_body(
              body.handle, rows_of(world_from_camera * camera_from_body()).data()) == PALPABLE_OK);
  const Session session(depth_camera(), body.handle);
  const auto pose = rows_of(world_from_camera);
  for (int n = 0; n < 4; ++n) {
    REQUIRE(feed(session, frame_with_finger(n, 0.002 * n), pose.data()) == PALPABLE_OK);
  }
  const palpable_frame frame = frame_of(session);
  CHECK(frame.camera == PALPABLE_TRACKED);
  CHECK(frame.world_from_camera[3] == 0.5);
  CHECK(frame.touch_count > 0);
  CHECK(skin_of(session).camera_from_body[3] == Approx(0.01));
  CHECK(feed(session, frame_with_finger(4, 0.004)) == PALPABLE_WRONG_ARGUMENT);
  auto unknown = pose;
  unknown[0] = kNaN;
  REQUIRE(feed(session, frame_with_finger(4, 0.006), unknown.data()) == PALPABLE_OK);
  CHECK(frame_of(session).camera == PALPABLE_LOST);
  palpable_setup follows = depth_camera();
  follows.follow_camera = 1;
  const Session other(follows);
  CHECK(feed(other, frame_with_finger(0, 0), pose.data()) == PALPABLE_WRONG_ARGUMENT);
  CHECK(feed(other, frame_with_finger(0, 0)) == PALPABLE_OK);
  CHECK(frame_of(other).camera != PALPABLE_LOST);
}

TEST_CASE("without colours what comes is found by its depth alone", "[capi]") {
  palpable_setup setup = depth_camera();
  setup.press_static = 0;
  const Session with(setup), without(setup);
  for (int n = 0; n < 50; ++n) {
    const Frame frame = n < 40 ? test::frame_of_wall(n, 0) : frame_with_finger(n, 0.006);
    const palpable_image depth = image_of(frame.depth);
    REQUIRE(feed(with, frame) == PALPABLE_OK);
    REQUIRE(palpable_feed_depth(without, &depth, nullptr, nullptr, frame.time) == PALPABLE_OK);
    if (n < 40) CHECK(frame_of(without).touch_count == 0);
  }
  REQUIRE(frame_of(with).touch_count > 0);
  CHECK(
      whole_force(without).norm() ==
      Approx(whole_force(with).norm()).epsilon(tolerance(0.15, "outlines lie otherwise by a px")));
}

TEST_CASE("after the first frames nothing is allocated for a frame", "[capi]") {
  const Session session(no_camera());
  const std::array<palpable_capsule, 2> things{finger(0.003), finger(0.005)};
  const auto press = [&] {
    REQUIRE(palpable_press(session, things.data(), 2) == PALPABLE_OK);
    REQUIRE(palpable_press(session, things.data(), 0) == PALPABLE_OK);
    (void)frame_of(session);
  };
  press();
  CHECK(test::allocations_during(press) == 0);

  const Session sees(depth_camera());
  std::vector<Frame> frames;
  for (int n = 0; n < 12; ++n) frames.push_back(frame_with_finger(n, n % 4 == 0 ? -0.03 : 0.004));
  const auto feed_some = [&](std::size_t first, std::size_t last) {
    for (std::size_t n = first; n < last; ++n) REQUIRE(feed(sees, frames[n]) == PALPABLE_OK);
  };
  feed_some(0, 6);
  REQUIRE(frame_of(sees).touch_count > 0);
  CHECK(test::allocations_during([&] { feed_some(6, 12); }) == 0);
}

TEST_CASE("two sessions on one body run on two threads and do not know of each other", "[capi]") {
  const Body body;
  const Session alone(no_camera(), body.handle), one(no_camera(), body.handle),
      two(no_camera(), body.handle);
  const auto run = [](palpable_session* session, double deepest) {
    for (int n = 1; n <= 10; ++n) {
      const palpable_capsule c = finger(deepest * n / 10);
      (void)palpable_press(session, &c, 1);
    }
  };
  run(alone, 0.006);
  std::thread first([&] { run(one, 0.006); }), second([&] { run(two, 0.003); });
  first.join();
  second.join();
  CHECK(vertices_of(one) == vertices_of(alone));
  CHECK(touch_of(two).depth < touch_of(one).depth);
}

// ---- invalid use ----

TEST_CASE("null pointers are refused everywhere, and nothing crashes", "[capi][errors]") {
  palpable_body* body = nullptr;
  palpable_session* session = nullptr;
  const palpable_setup setup = no_camera();
  const double pose[16] = {};
  CHECK(palpable_load_body(nullptr, 1, &body) == PALPABLE_WRONG_ARGUMENT);
  CHECK(palpable_load_body(body_file().c_str(), 1, nullptr) == PALPABLE_WRONG_ARGUMENT);
  CHECK(palpable_place_body(nullptr, pose) == PALPABLE_WRONG_ARGUMENT);
  const Body good;
  CHECK(palpable_place_body(good.handle, nullptr) == PALPABLE_WRONG_ARGUMENT);
  const palpable_body* bodies[] = {good.handle, nullptr};
  CHECK(palpable_open(nullptr, 1, &setup, &session) == PALPABLE_WRONG_ARGUMENT);
  CHECK(palpable_open(bodies, 0, &setup, &session) == PALPABLE_WRONG_ARGUMENT);
  CHECK(palpable_open(bodies, 2, &setup, &session) == PALPABLE_WRONG_ARGUMENT);
  CHECK(palpable_open(bodies, 1, nullptr, &session) == PALPABLE_WRONG_ARGUMENT);
  CHECK(palpable_open(bodies, 1, &setup, nullptr) == PALPABLE_WRONG_ARGUMENT);
  CHECK(session == nullptr);
  CHECK(std::string(palpable_last_error()) == "session is null");

  auto frame = test::sized<palpable_frame>();
  auto touch = test::sized<palpable_touch>();
  auto skin = test::sized<palpable_skin>();
  auto depth = test::sized<palpable_depth>();
  const palpable_capsule c = finger(0.002);
  const Frame images = frame_with_finger(0, 0);
  const palpable_image z = image_of(images.depth), color = image_of(images.left);
  CHECK(palpable_reset(nullptr) == PALPABLE_WRONG_ARGUMENT);
  CHECK(palpable_press(nullptr, &c, 1) == PALPABLE_WRONG_ARGUMENT);
  CHECK(palpable_feed_depth(nullptr, &z, &color, nullptr, 0) == PALPABLE_WRONG_ARGUMENT);
  CHECK(palpable_feed_stereo(nullptr, &color, &color, nullptr, 0) == PALPABLE_WRONG_ARGUMENT);
  CHECK(palpable_get_frame(nullptr, &frame) == PALPABLE_WRONG_ARGUMENT);
  CHECK(palpable_get_touch(nullptr, 0, &touch) == PALPABLE_WRONG_ARGUMENT);
  CHECK(palpable_get_skin(nullptr, 0, &skin) == PALPABLE_WRONG_ARGUMENT);
  CHECK(palpable_get_depth(nullptr, &depth) == PALPABLE_WRONG_ARGUMENT);
  palpable_close(nullptr);
  palpable_free_body(nullptr);

  const Session presses(no_camera()), sees(depth_camera()), pairs(stereo_camera());
  CHECK(palpable_press(presses, nullptr, 1) == PALPABLE_WRONG_ARGUMENT);
  CHECK(palpable_feed_depth(sees, nullptr, &color, nullptr, 0) == PALPABLE_WRONG_ARGUMENT);
  const palpable_image no_pixels{sizeof(palpable_image), nullptr, 161, 121, PALPABLE_DEPTH_F32, 0};
  CHECK(palpable_feed_depth(sees, &no_pixels, &color, nullptr, 0) == PALPABLE_WRONG_ARGUMENT);
  CHECK(palpable_feed_depth(sees, &z, nullptr, nullptr, 0) == PALPABLE_OK);  // without colour
  CHECK(palpable_feed_stereo(pairs, nullptr, nullptr, nullptr, 0) == PALPABLE_WRONG_ARGUMENT);
  CHECK(palpable_get_frame(presses, nullptr) == PALPABLE_WRONG_ARGUMENT);
  REQUIRE(palpable_press(presses, &c, 1) == PALPABLE_OK);
  CHECK(palpable_get_touch(presses, 0, nullptr) == PALPABLE_WRONG_ARGUMENT);
  CHECK(palpable_get_skin(presses, 0, nullptr) == PALPABLE_WRONG_ARGUMENT);
  CHECK(palpable_get_depth(sees, nullptr) == PALPABLE_WRONG_ARGUMENT);
}

TEST_CASE("what is asked of the wrong session, or of what is not there, is refused",
          "[capi][errors]") {
  const Session presses(no_camera()), sees(depth_camera());
  const palpable_capsule c = finger(0.002);
  const ColorImage left = eye(0);
  const palpable_image image = image_of(left);
  auto touch = test::sized<palpable_touch>();
  auto skin = test::sized<palpable_skin>();
  auto depth = test::sized<palpable_depth>();
  CHECK(palpable_press(sees, &c, 1) == PALPABLE_NOT_POSSIBLE);
  CHECK(feed(presses, frame_with_finger(0, 0)) == PALPABLE_NOT_POSSIBLE);
  CHECK(palpable_feed_stereo(sees, &image, &image, nullptr, 0) == PALPABLE_NOT_POSSIBLE);
  CHECK(palpable_get_depth(presses, &depth) == PALPABLE_NOT_POSSIBLE);
  CHECK(palpable_get_depth(sees, &depth) == PALPABLE_NOT_POSSIBLE);
  for (const int index : {-1, 0, 1, 1 << 30}) {
    CHECK(palpable_get_touch(presses, index, &touch) == PALPABLE_WRONG_ARGUMENT);
  }
  for (const int body : {-1, 1, 1 << 30}) {
    CHECK(palpable_get_skin(presses, body, &skin) == PALPABLE_WRONG_ARGUMENT);
  }
  // A body without tables is pressed at its sites, for which a session needs a camera.
  const Body plain("tests/data/ball_v1.palpable");
  const palpable_body* bodies[] = {plain.handle, plain.handle};
  palpable_session* session = nullptr;
  palpable_setup setup = no_camera();
  CHECK(palpable_open(bodies, 1, &setup, &session) == PALPABLE_NOT_POSSIBLE);
  CHECK(std::string(palpable_last_error()).find("bake") != std::string::npos);
  CHECK(palpable_open(bodies, 2, &setup, &session) == PALPABLE_NOT_POSSIBLE);
  setup = depth_camera();
  REQUIRE(palpable_open(bodies, 2, &setup, &session) == PALPABLE_OK);
  CHECK(feed(session, frame_with_finger(0, 0)) == PALPABLE_OK);
  CHECK(frame_of(session).body_count == 2);
  palpable_close(session);
}

TEST_CASE("files that are none, and the body's own cut off anywhere, are refused by name",
          "[capi][errors]") {
  const test::ScratchFolder folder("c_interface_files");
  const std::string bytes = test::file_bytes(body_file());
  palpable_body* body = nullptr;
  const auto refused = [&](const std::string& path) {
    const palpable_status status = palpable_load_body(path.c_str(), 1, &body);
    CHECK(body == nullptr);
    CHECK(std::string(palpable_last_error()).find(path) != std::string::npos);
    return status == PALPABLE_WRONG_FILE;
  };
  CHECK(refused("/no/such/body.palpable"));
  CHECK(refused(folder.path().string()));
  CHECK(refused("README.md"));
  for (const double share : {0.0, 0.001, 0.1, 0.5, 0.9, 0.999}) {
    const std::string path = (folder / "cut.palpable").string();
    std::ofstream(path, std::ios::binary)
        .write(bytes.data(), static_cast<std::streamsize>(share * double(bytes.size())));
    INFO("share " << share);
    CHECK(refused(path));
  }
  palpable_setup setup = stereo_camera();
  const Body good;
  const palpable_body* bodies[] = {good.handle};
  palpable_session* session = nullptr;
  for (const char* file : {"/no/such.yml", "README.md", "", "/dev/zero"}) {
    setup.calibration = file;
    CHECK(palpable_open(bodies, 1, &setup, &session) == PALPABLE_WRONG_FILE);
  }
  const std::string intrinsics = (folder / "depth.txt").string();
  std::ofstream(intrinsics) << "250 250 80 60\n";
  setup.calibration = intrinsics.c_str();
  CHECK(palpable_open(bodies, 1, &setup, &session) == PALPABLE_WRONG_FILE);  // of a depth camera
  setup = depth_camera();
  setup.fx = 0;
  setup.calibration = intrinsics.c_str();
  CHECK(palpable_open(bodies, 1, &setup, &session) == PALPABLE_OK);
  palpable_close(session);
  const std::string rectified = (folder / "rectified.yml").string();
  std::ofstream(rectified) << "%YAML:1.0\n---\nfx: 175.0\nfy: 175.0\ncx: 159.5\ncy: 89.5\n"
                              "width: 320\nheight: 180\nbaseline_m: 0.063\ndoffs_px: 0.0\n";
  setup = no_camera();
  setup.camera = PALPABLE_STEREO;
  setup.calibration = rectified.c_str();
  CHECK(palpable_open(bodies, 1, &setup, &session) == PALPABLE_OK);
  palpable_close(session);
  setup.width = setup.height = 100;
  CHECK(palpable_open(bodies, 1, &setup, &session) == PALPABLE_WRONG_ARGUMENT);
  setup.width = setup.height = 0;
  const auto opened_with = [&](const std::string& cx, const std::string& baseline) {
    std::ofstream(rectified) << "%YAML:1.0\n---\nfx: 175.0\nfy: 175.0\ncx: " + cx +
                                    "\ncy: 89.5\nwidth: 320\nheight: 180\nbaseline_m: " + baseline +
                                    "\n";
    const palpable_status status = palpable_open(bodies, 1, &setup, &session);
    if (status == PALPABLE_OK) palpable_close(session);
    return status;
  };
  const auto says = [](const char* part) {
    return std::string(palpable_last_error()).find(part) != std::string::npos;
  };
  CHECK(opened_with("325.0", "0.063") == PALPABLE_WRONG_FILE);
  CHECK(says("principal point"));
  CHECK(opened_with("159.5", "-0.063") == PALPABLE_WRONG_FILE);
  CHECK(says("the eyes are swapped"));
  CHECK(opened_with("159.5", "2.52") == PALPABLE_WRONG_FILE);
  CHECK(says("2.52 squares of 25 mm"));
  CHECK(says("setup.baseline"));
  setup.baseline = 2.5;
  CHECK(opened_with("159.5", "2.52") == PALPABLE_OK);  // said twice, so it is meant
  CHECK(opened_with("159.5", "6.3") == PALPABLE_WRONG_FILE);
}

TEST_CASE("setups that make no camera are refused", "[capi][errors]") {
  const Body body;
  const palpable_body* bodies[] = {body.handle};
  const auto refused = [&](const palpable_setup& setup) {
    palpable_session* session = nullptr;
    const palpable_status status = palpable_open(bodies, 1, &setup, &session);
    palpable_close(session);
    return status == PALPABLE_WRONG_ARGUMENT;
  };
  CHECK_FALSE(refused(stereo_camera()));
  CHECK_FALSE(refused(depth_camera()));
  for (const palpable_setup& good : {stereo_camera(), depth_camera()}) {
    for (int k = 0; k < 14; ++k) {
      palpable_setup bad = good;
      if (k == 0) bad.width = 0;
      if (k == 1) bad.height = -5;
      if (k == 2) bad.width = 1 << 30;
      if (k == 3) bad.fx = 0;
      if (k == 4) bad.fy = -1;
      if (k == 5) bad.cx = kNaN;
      if (k == 6) bad.fx = std::numeric_limits<double>::infinity();
      if (k == 7) bad.nearest = kNaN;
      if (k == 8) bad.farthest = 0.001;
      if (k == 9) bad.threads = -1;
      if (k == 10) bad.press_static = 2;
      if (k == 11) bad.camera = 7;
      if (k == 12) bad.size = 0;
      if (k == 13) bad.full_resolution = -1;
      INFO("case " << k << " of camera " << good.camera);
      CHECK(refused(bad));
    }
  }
  palpable_setup bad = stereo_camera();
  for (const double baseline : {0.0, -0.06, 60.0, kNaN}) {
    bad.baseline = baseline;
    CHECK(refused(bad));
  }
  bad = stereo_camera();
  bad.threads = 65;
  CHECK(refused(bad));
  bad.threads = 64;
  CHECK_FALSE(refused(bad));
}

TEST_CASE("depths in millimetres are refused, far ones are not", "[capi][errors]") {
  const Session session(depth_camera());
  Frame frame = frame_with_finger(0, 0.002);
  for (std::size_t i = 0; i < frame.depth.size(); ++i) frame.depth.data()[i] *= 1000;
  CHECK(feed(session, frame) == PALPABLE_WRONG_ARGUMENT);
  CHECK_THAT(palpable_last_error(), Catch::Contains("millimetres"));
  CHECK(std::isnan(frame_of(session).time));
  for (std::size_t i = 0; i < frame.depth.size(); ++i) frame.depth.data()[i] /= 1000;
  for (int x = 0; x < frame.depth.width(); ++x) frame.depth(x, 0) = 500;  // the sky
  CHECK(feed(session, frame) == PALPABLE_OK);
}

TEST_CASE("wrong images and times are refused, and the session goes on as if they had not come",
          "[capi][errors]") {
  const Session plain(depth_camera()), session(depth_camera());
  double time = -0.1;
  for (int n = 0; n < 5; ++n) {
    const Frame frame = frame_with_finger(n, 0.002 * n);
    REQUIRE(feed(plain, frame) == PALPABLE_OK);
    const palpable_image z = image_of(frame.depth), color = image_of(frame.left);
    for (int k = 0; k < 12; ++k) {
      palpable_image bad = z, bad_color = color;
      double when = frame.time;
      if (k == 0) bad.size = 0;
      if (k == 1) bad.width = 160;
      if (k == 2) bad.height = -121;
      if (k == 3) bad.format = PALPABLE_RGBA8;
      if (k == 4) bad.stride = 643;
      if (k == 5) bad_color.width = 0;
      if (k == 6) bad_color.format = PALPABLE_DEPTH_F32;
      if (k == 7) bad_color.format = 77;
      if (k == 8) bad_color.pixels = nullptr;
      if (k == 9) when = kNaN;
      if (k == 10) when = std::numeric_limits<double>::infinity();
      if (k == 11) when = n > 0 ? time : -kNaN;
      INFO("case " << k);
      CHECK(palpable_feed_depth(session, &bad, &bad_color, nullptr, when) ==
            PALPABLE_WRONG_ARGUMENT);
    }
    time = frame.time;
    REQUIRE(feed(session, frame) == PALPABLE_OK);
    CHECK(vertices_of(session) == vertices_of(plain));
  }
  REQUIRE(frame_of(session).touch_count > 0);
}

TEST_CASE("depths and capsules that are no numbers press nothing", "[capi][errors]") {
  const Session sees(depth_camera());
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(),
                          std::numeric_limits<float>::infinity(), -1.0f, 0.0f, 1e30f, 1e-30f}) {
    for (int n = 0; n < 2; ++n) {
      const palpable_frame before = frame_of(sees);
      Frame frame = frame_with_finger(0, 0.006);
      frame.time = (std::isnan(before.time) ? 0 : before.time) + 1;
      std::fill(frame.depth.begin(), frame.depth.end(), bad);
      REQUIRE(feed(sees, frame) == PALPABLE_OK);
      CHECK(vertices_of(sees).allFinite());
    }
    CHECK(frame_of(sees).touch_count == 0);
  }
  const Session presses(no_camera());
  REQUIRE(palpable_press(presses, nullptr, 0) == PALPABLE_OK);
  for (int k = 0; k < 8; ++k) {
    palpable_capsule bad = finger(0.004);
    if (k < 3) bad.a[k] = kNaN;
    if (k == 3) bad.b[2] = std::numeric_limits<double>::infinity();
    if (k == 4) bad.radius_a = 0;
    if (k == 5) bad.radius_b = kNaN;
    if (k == 6) bad.radius_a = -0.01;
    if (k == 7) bad.a[0] = 1e300;
    CHECK(palpable_press(presses, &bad, 1) == PALPABLE_WRONG_ARGUMENT);
    CHECK(frame_of(presses).touch_count == 0);
  }
  // Capsules that contain the whole body, first one, then a thousand.
  const palpable_capsule around{{0, 0, 0.05}, {0, 0, 0.05}, 1, 1};
  REQUIRE(palpable_press(presses, &around, 1) == PALPABLE_OK);
  CHECK(vertices_of(presses).allFinite());
  const std::vector<palpable_capsule> many(1000, finger(0.003));
  REQUIRE(palpable_press(presses, many.data(), many.size()) == PALPABLE_OK);
  CHECK(vertices_of(presses).allFinite());
  CHECK(palpable_press(presses, many.data(), std::size_t{1} << 60) == PALPABLE_WRONG_ARGUMENT);
}

TEST_CASE("a session in which something was thrown half way is refused until it is reset",
          "[capi][errors]") {
  const Session session(no_camera());
  const palpable_capsule c = finger(0.002);
  REQUIRE(palpable_press(session, &c, 1) == PALPABLE_OK);
  session.handle->is_broken = true;
  auto frame = test::sized<palpable_frame>();
  CHECK(palpable_press(session, &c, 1) == PALPABLE_BROKEN);
  CHECK(palpable_get_frame(session, &frame) == PALPABLE_BROKEN);
  CHECK(std::string(palpable_last_error()).find("reset") != std::string::npos);
  REQUIRE(palpable_reset(session) == PALPABLE_OK);
  CHECK(palpable_press(session, &c, 1) == PALPABLE_OK);
  CHECK(frame_of(session).touch_count == 1);
  // No exception leaves a C function.
  CHECK(guarded([] { throw 7; }) == PALPABLE_BROKEN);
  CHECK(guarded([] { throw std::bad_alloc(); }) == PALPABLE_NO_MEMORY);
  CHECK(guarded([] { throw ContractViolation(std::string(2000, 'x')); }) == PALPABLE_BROKEN);
  CHECK(std::strlen(palpable_last_error()) == 511);
}

TEST_CASE("poses that are no rotation and translation are refused", "[capi][errors]") {
  const Body body;
  const std::array<double, 16> good = rows_of(camera_from_body());
  CHECK(palpable_place_body(body.handle, good.data()) == PALPABLE_OK);
  for (std::size_t k = 0; k < 16; ++k) {
    for (const double wrong : {kNaN, 1e30, good[k] + 3}) {
      if ((k == 3 || k == 7 || k == 11) && wrong == good[k] + 3) continue;  // a valid position
      std::array<double, 16> bad = good;
      bad[k] = wrong;
      CHECK(palpable_place_body(body.handle, bad.data()) == PALPABLE_WRONG_ARGUMENT);
    }
  }
  std::array<double, 16> mirrored = rows_of(Rigid3::Identity());
  mirrored[0] = -1;
  CHECK(palpable_place_body(body.handle, mirrored.data()) == PALPABLE_WRONG_ARGUMENT);
  for (const double scale : {0.0, -1.0, kNaN, 1e9}) {
    palpable_body* none = nullptr;
    CHECK(palpable_load_body(body_file().c_str(), scale, &none) == PALPABLE_WRONG_ARGUMENT);
    CHECK(none == nullptr);
  }
}

TEST_CASE("members lie where programs that were built for 0.1 look for them", "[capi]") {
  static_assert(sizeof(void*) == 8, "the numbers below are those of 64 bits");
  CHECK(offsetof(palpable_setup, fx) == 24);
  CHECK(offsetof(palpable_setup, calibration) == 64);
  CHECK(offsetof(palpable_setup, nearest) == 80);
  CHECK(offsetof(palpable_setup, full_resolution) == 100);
  CHECK(offsetof(palpable_image, stride) == 32);
  CHECK(sizeof(palpable_capsule) == 64);
  CHECK(offsetof(palpable_frame, world_from_camera) == 32);
  CHECK(offsetof(palpable_frame, left_to_go) == 160);
  CHECK(offsetof(palpable_touch, force) == 64);
  CHECK(offsetof(palpable_touch, unseen_for) == 112);
  CHECK(offsetof(palpable_skin, triangles) == 40);
  CHECK(offsetof(palpable_skin, stated_stress_error) == 312);
  CHECK(offsetof(palpable_depth, cy) == 48);
  CHECK(PALPABLE_BROKEN == 5);
  CHECK(PALPABLE_COLOR_DEPTH == 2);
  CHECK(PALPABLE_DEPTH_F32 == 5);
  CHECK(PALPABLE_LOST == 3);
}

TEST_CASE("structs of callers who know more members work as long as those are zero", "[capi]") {
  struct {
    palpable_setup known = no_camera();
    double later = 0;
  } setup;
  setup.known.size = sizeof setup;
  const Session session(setup.known);
  setup.later = 1;
  const Body body;
  const palpable_body* bodies[] = {body.handle};
  palpable_session* other = nullptr;
  CHECK(palpable_open(bodies, 1, &setup.known, &other) == PALPABLE_NOT_POSSIBLE);

  struct {
    palpable_frame known{};
    double later = 5, behind = 6;
  } frame;
  frame.known.size = sizeof(palpable_frame) + sizeof(double);
  REQUIRE(palpable_get_frame(session, &frame.known) == PALPABLE_OK);
  CHECK(frame.later == 0);
  CHECK(frame.behind == 6);
  CHECK(frame.known.size == sizeof(palpable_frame) + sizeof(double));
  // `inside` and what follows came after 0.1, whose callers give the size without them.
  for (const std::size_t size :
       {std::size_t{0}, offsetof(palpable_frame, inside) - 1, std::size_t{1} << 40}) {
    frame.known.size = size;
    CHECK(palpable_get_frame(session, &frame.known) == PALPABLE_WRONG_ARGUMENT);
  }
}

}  // namespace
}  // namespace palpable

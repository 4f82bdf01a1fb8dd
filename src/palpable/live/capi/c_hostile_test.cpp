// Arguments that no program should pass, and obstacles that have no answer: each C function either
// refuses with the value and its bound, or says in palpable_frame what it could not do.

#include "palpable/common/body_file/touch_file.h"
#include "palpable/common/geometry/capsule.h"
#include "palpable/live/capi/palpable.h"
#include "tests/support/c_calls.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/some_touch_tables.h"
#include "tests/support/test.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <thread>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;
using test::tolerance;

constexpr double kNot = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr std::size_t kLargestSize = std::numeric_limits<std::size_t>::max();

// A ball of 10 cm diameter that stands on Z = 0, held below 5 mm, with contact points of 2 mm.
const std::string& ball_file() {
  static const test::ScratchFolder folder("c_hostile");
  static const std::string path = test::write_ball_body(folder, "ball.palpable", 0.002);
  return path;
}

bool says(const std::string& part) {
  INFO(palpable_last_error());
  return std::string(palpable_last_error()).find(part) != std::string::npos;
}

palpable_body* loaded_ball(const std::string& file = ball_file()) {
  palpable_body* body = nullptr;
  REQUIRE(palpable_load_body(file.c_str(), 1, &body) == PALPABLE_OK);
  return body;
}

palpable_setup depth_setup() {
  auto setup = test::sized<palpable_setup>();
  setup.camera = PALPABLE_COLOR_DEPTH;
  setup.width = 64;
  setup.height = 48;
  setup.fx = setup.fy = 60;
  setup.cx = 31.5;
  setup.cy = 23.5;
  setup.press_static = 1;
  return setup;
}

// A session on the ball, whose body was freed at once.
struct Opened {
  palpable_session* handle = nullptr;
  explicit Opened(const palpable_setup& setup = test::sized<palpable_setup>(),
                  const std::string& file = ball_file()) {
    palpable_body* ball = loaded_ball(file);
    const palpable_status status = palpable_open(&ball, 1, &setup, &handle);
    palpable_free_body(ball);
    INFO(palpable_last_error());
    REQUIRE(status == PALPABLE_OK);
  }
  Opened(const Opened&) = delete;
  ~Opened() { palpable_close(handle); }
  operator palpable_session*() const { return handle; }  // NOLINT: as in C
};

palpable_frame frame_after(palpable_session* session) {
  auto frame = test::sized<palpable_frame>();
  REQUIRE(palpable_get_frame(session, &frame) == PALPABLE_OK);
  return frame;
}

palpable_frame pressed(palpable_session* session, const std::vector<palpable_capsule>& capsules,
                       int calls = 1) {
  for (int k = 0; k < calls; ++k) {
    REQUIRE(palpable_press(session, capsules.data(), capsules.size()) == PALPABLE_OK);
  }
  return frame_after(session);
}

palpable_capsule ball_at(const Vector3d& centre, double radius) {
  return {
      {centre.x(), centre.y(), centre.z()}, {centre.x(), centre.y(), centre.z()}, radius, radius};
}

palpable_capsule standing_at(const Vector3d& tip, const Vector3d& way, double radius) {
  const Vector3d end = tip + way;
  return {{tip.x(), tip.y(), tip.z()}, {end.x(), end.y(), end.z()}, radius, radius};
}

// m, how deep the skin is inside a capsule: of its vertices and of 55 places in each triangle.
double true_depth(palpable_session* session, const palpable_capsule& c) {
  auto skin = test::sized<palpable_skin>();
  REQUIRE(palpable_get_skin(session, 0, &skin) == PALPABLE_OK);
  const CapsuleField field({Vector3d(c.a), Vector3d(c.b), c.radius_a, c.radius_b});
  const auto vertex = [&](int v) {
    return Eigen::Map<const Eigen::Vector3f>(skin.vertices + 3 * v).cast<double>().eval();
  };
  double deepest = 0;
  constexpr int kPieces = 9;
  for (int t = 0; t < skin.triangle_count; ++t) {
    const int* corners = skin.triangles + 3 * t;
    for (int i = 0; i <= kPieces; ++i) {
      for (int j = 0; j <= kPieces - i; ++j) {
        const Vector3d x = (i * vertex(corners[0]) + j * vertex(corners[1]) +
                            (kPieces - i - j) * vertex(corners[2])) /
                           kPieces;
        deepest = std::max(deepest, -field.distance(x));
      }
    }
  }
  return deepest;
}

// The middle and the normal of a triangle near the top.
struct Place {
  Vector3d at, normal;
};
Place middle_of_triangle(palpable_session* session) {
  auto skin = test::sized<palpable_skin>();
  REQUIRE(palpable_get_skin(session, 0, &skin) == PALPABLE_OK);
  Place place{Vector3d::Zero(), Vector3d::UnitZ()};
  for (int t = 0; t < skin.triangle_count; ++t) {
    std::array<Vector3d, 3> x;
    for (std::size_t k = 0; k < 3; ++k) {
      x[k] = Eigen::Map<const Eigen::Vector3f>(skin.vertices + 3 * skin.triangles[3 * t + int(k)])
                 .cast<double>();
    }
    // A little beside the middle of the edges' thirds, where a contact point is.
    const Vector3d middle = 0.44 * x[0] + 0.44 * x[1] + 0.12 * x[2];
    if (middle.z() > place.at.z()) place = {middle, (x[1] - x[0]).cross(x[2] - x[0]).normalized()};
  }
  return place;
}

// --- obstacles without an answer, and with one

TEST_CASE("a ball round the whole body is said to be in it by its depth", "[capi][answer]") {
  for (const Vector3d& centre :
       {Vector3d(0, 0, 0.05), Vector3d(0.01, 0.02, 0.08), Vector3d(0.5, 0, 0.05)}) {
    const Opened session;
    const palpable_capsule around = ball_at(centre, 1);
    for (int call = 0; call < 4; ++call) {
      INFO("centre " << centre.transpose() << ", call " << call);
      const palpable_frame frame = pressed(session, {around});
      const double truth = true_depth(session, around);
      CHECK(truth > 0.4);
      CHECK(frame.inside ==
            Approx(truth).epsilon(tolerance(0.01, "places between contact points")));
      CHECK(frame.left_to_go >= frame.inside);
      CHECK(frame.answer != PALPABLE_REACHED);
    }
    // With its middle in the body's no way out is nearer than another.
    if (centre == Vector3d(0, 0, 0.05)) {
      CHECK(frame_after(session).answer == PALPABLE_NOT_REACHED);
    }
  }
}

TEST_CASE("a ball that advances into the body is said to be as deep in it as it is",
          "[capi][answer]") {
  const Opened session;
  bool was_reached = false;
  for (int step = 0; step < 40; ++step) {
    const double depth = -0.003 + 0.005 * step;  // up to 190 mm
    const palpable_capsule ball = ball_at({0, 0, 0.1 + 1 - depth}, 1);
    const palpable_frame frame = pressed(session, {ball});
    const double truth = true_depth(session, ball);
    INFO("depth " << depth << ", truth " << truth);
    CHECK(frame.left_to_go >= truth - 3e-4);
    CHECK(frame.inside ==
          Approx(truth).margin(tolerance(3e-4, "m: places between contact points") + 0.01 * truth));
    if (frame.answer == PALPABLE_REACHED) CHECK(truth < 6e-4);
    was_reached |= frame.answer == PALPABLE_REACHED && frame.touch_count > 0;
    if (depth > 0.12) CHECK(frame.answer != PALPABLE_REACHED);  // the body is 0.1 m high
  }
  CHECK(was_reached);
}

TEST_CASE("a needle in the middle of a triangle is said to be in it", "[capi][answer]") {
  for (const double radius : {1e-4, 3e-4}) {
    const Opened session;
    const Place place = middle_of_triangle(session);
    const palpable_capsule needle =
        standing_at(place.at + (radius - 0.0025) * place.normal, 0.1 * place.normal, radius);
    const palpable_frame frame = pressed(session, {needle}, 3);
    INFO(radius);
    CHECK(frame.inside == Approx(0.0025).margin(tolerance(5e-4, "m: the skin may slip aside")));
    CHECK(frame.left_to_go >= frame.inside);
    CHECK(frame.answer == PALPABLE_NOT_REACHED);
    // Out again: nothing is left.
    CHECK(pressed(session, {}).answer == PALPABLE_REACHED);
    CHECK(frame_after(session).left_to_go == 0);
  }
}

TEST_CASE("what the body can give way to is reached: fingers, palms, pencils, hands",
          "[capi][answer]") {
  for (const double radius : {0.0035, 0.008, 0.02, 0.15}) {
    const Opened session;
    for (int step = 0; step < 6; ++step) {
      INFO("radius " << radius << ", step " << step);
      const palpable_capsule c =
          standing_at({0, 0, 0.1 - 0.001 * step + radius}, {0, 0, 0.1}, radius);
      const palpable_frame frame = pressed(session, {c}, 2);
      CHECK(frame.answer == PALPABLE_REACHED);
      CHECK(frame.inside <= 3e-4);
      CHECK(frame.left_to_go <= 3e-4);
      CHECK(frame.passed_through == 0);
    }
  }
  const Opened session;
  std::vector<palpable_capsule> hand;
  for (const double x : {-0.027, -0.009, 0.009, 0.027}) {
    hand.push_back(standing_at({x, 0, 0.106}, {0, 0.01, 0.05}, 0.009));
  }
  CHECK(pressed(session, hand, 3).answer == PALPABLE_REACHED);
  CHECK(frame_after(session).touch_count > 0);
}

TEST_CASE("what comes on far is reached later, and the frames say so", "[capi][answer]") {
  const test::ScratchFolder folder("c_hostile_far");
  // Of points 3 mm apart a frame solves all that this ball meets.
  const Opened session(test::sized<palpable_setup>(),
                       test::write_ball_body(folder, "coarse.palpable", 0.003));
  CHECK(frame_after(session).answer == PALPABLE_NOT_JUDGED);
  const palpable_capsule ball = ball_at({0, 0, 0.122}, 0.04);  // 18 mm deep
  palpable_frame frame = pressed(session, {ball});
  CHECK(frame.answer == PALPABLE_LATER);
  CHECK(frame.inside > 1e-3);
  frame = pressed(session, {ball}, 5);
  CHECK(frame.answer == PALPABLE_REACHED);
  REQUIRE(palpable_reset(session) == PALPABLE_OK);
  frame = frame_after(session);
  CHECK(frame.answer == PALPABLE_NOT_JUDGED);
  CHECK(frame.inside == 0);
  CHECK(frame.left_to_go == 0);
}

TEST_CASE("a capsule in the skin that the support holds is said to be in it", "[capi][answer]") {
  const Opened session;
  const palpable_frame frame = pressed(session, {ball_at({0, 0, -0.006}, 0.008)}, 2);
  CHECK(frame.inside > 8e-4);  // the lowest vertex is 3 mm beside the middle at most
  CHECK(frame.inside < 0.0021);
  CHECK(frame.answer == PALPABLE_NOT_REACHED);
}

TEST_CASE("a thin capsule that jumps through the body is counted", "[capi][answer]") {
  const Opened session;
  const auto at = [](double z) { return standing_at({-0.03, 0.001, z}, {0.06, 0, 0}, 5e-4); };
  CHECK(pressed(session, {at(0.12)}).passed_through == 0);
  palpable_frame frame = pressed(session, {at(-0.02)});
  CHECK(frame.passed_through == 1);
  CHECK(frame.touch_count == 0);
  CHECK(pressed(session, {at(-0.021)}).passed_through == 0);          // goes on below
  CHECK(pressed(session, {at(0.12), at(0.13)}).passed_through == 0);  // which is which?
  CHECK(pressed(session, {at(0.13), at(-0.02)}).passed_through == 1);
  // A finger that slides over the top by more than its radius stays outside.
  const auto over = [](double x) { return ball_at({x, 0, 0.1065}, 0.008); };
  CHECK(pressed(session, {over(-0.012)}).passed_through == 0);
  CHECK(pressed(session, {over(0.012)}).passed_through == 0);
  REQUIRE(palpable_reset(session) == PALPABLE_OK);
  CHECK(frame_after(session).passed_through == 0);
}

// --- arguments

TEST_CASE("a scale out of its range is refused with both bounds", "[capi][hostile]") {
  for (const double scale : {0.0, -0.0, -1.0, 5e-324, 1e-308, 9.99e-4, 1000.1, 1e9, 1e308, -1e308,
                             kNot, kInfinite, -kInfinite}) {
    palpable_body* body = loaded_ball();
    palpable_body* const old = body;
    INFO(scale);
    CHECK(palpable_load_body(ball_file().c_str(), scale, &body) == PALPABLE_WRONG_ARGUMENT);
    CHECK(body == nullptr);
    CHECK(says("scale is "));
    CHECK(says("0.001 and 1000"));
    palpable_free_body(old);
  }
  for (const double scale : {1e-3, 1e3}) {
    palpable_body* body = nullptr;
    CHECK(palpable_load_body(ball_file().c_str(), scale, &body) == PALPABLE_OK);
    palpable_free_body(body);
  }
}

TEST_CASE("a capsule out of its range is refused with its number, value and bound",
          "[capi][hostile]") {
  const Opened session;
  const palpable_capsule good = ball_at({0, 0, 0.107}, 0.008);
  const palpable_frame before = pressed(session, {good});
  for (int member = 0; member < 8; ++member) {
    const bool is_radius = member >= 6;
    std::vector<double> values{kNot, kInfinite, -kInfinite, 1e308, -1e308, 1000.1, -1000.1};
    if (is_radius) values = {kNot, kInfinite, 1e308, 100.1, 9.9e-5, 5e-324, 0.0, -0.0, -0.008};
    for (const double value : values) {
      palpable_capsule bad = good;
      (member < 3    ? bad.a[member]
       : member < 6  ? bad.b[member - 3]
       : member == 6 ? bad.radius_a
                     : bad.radius_b) = value;
      const std::array<palpable_capsule, 3> three{good, good, bad};
      INFO("member " << member << ", value " << value);
      CHECK(palpable_press(session, three.data(), 3) == PALPABLE_WRONG_ARGUMENT);
      CHECK(says("capsule 2: a "));
      CHECK(says(is_radius ? "not within 0.1 mm and 100 m" : "not within 1000 m from 0"));
    }
  }
  for (const std::size_t count : {std::size_t{4097}, std::size_t{1} << 32, kLargestSize}) {
    CHECK(palpable_press(session, &good, count) == PALPABLE_WRONG_ARGUMENT);
    CHECK(says("4096"));
  }
  CHECK(frame_after(session).time == before.time);
  // The bounds themselves, and all that are allowed at a time.
  for (const palpable_capsule& far :
       {ball_at({1000, -1000, 1000}, 1e-4), ball_at({-1000, 1000, 0}, 100),
        standing_at({0, 0, 1000}, {0, 0, -800}, 100), ball_at({0, 0, 0.05}, 100)}) {
    CHECK(palpable_press(session, &far, 1) == PALPABLE_OK);
    CHECK(std::isfinite(frame_after(session).inside));
  }
  const std::vector<palpable_capsule> many(4096, standing_at({0, 0, 0.104}, {0, 0, 0.1}, 1e-4));
  CHECK(palpable_press(session, many.data(), many.size()) == PALPABLE_OK);
}

// One picture of 64 x 48 pixels with room for a stride of up to 1024 bytes.
struct Picture {
  std::vector<std::uint8_t> bytes = std::vector<std::uint8_t>(std::size_t{48} * 1024);
  [[nodiscard]] palpable_image image(int format, std::size_t stride) const {
    return {sizeof(palpable_image), bytes.data(), 64, 48, format, stride};
  }
};

TEST_CASE("a stride that does not fit the image is refused, in each format", "[capi][hostile]") {
  const Opened sees(depth_setup());
  const Picture picture;
  double time = 0;
  const palpable_image z = picture.image(PALPABLE_DEPTH_F32, 0);
  const auto feed_color = [&](const palpable_image& color) {
    return palpable_feed_depth(sees, &z, &color, nullptr, time += 1);
  };
  for (const int format : {PALPABLE_GRAY8, PALPABLE_RGB8, PALPABLE_BGR8, PALPABLE_RGBA8}) {
    const std::size_t pixel = format == PALPABLE_GRAY8 ? 1 : format == PALPABLE_RGBA8 ? 4 : 3;
    const std::size_t row = 64 * pixel;
    for (const std::size_t stride :
         {std::size_t{1}, row - 1, (std::size_t{1} << 20) + 1, std::size_t{1} << 32,
          std::size_t{1} << 62, std::size_t{1} << 63, kLargestSize - row + 1, kLargestSize}) {
      INFO("format " << format << ", stride " << stride);
      CHECK(feed_color(picture.image(format, stride)) == PALPABLE_WRONG_ARGUMENT);
      CHECK(says("colour image has a stride of " + std::to_string(stride)));
    }
    for (const std::size_t stride : {std::size_t{0}, row, row + 1, row + 64, std::size_t{1024}}) {
      INFO("format " << format << ", stride " << stride);
      CHECK(feed_color(picture.image(format, stride)) == PALPABLE_OK);
    }
  }
  const auto feed_depth = [&](std::size_t stride) {
    const palpable_image depth = picture.image(PALPABLE_DEPTH_F32, stride);
    return palpable_feed_depth(sees, &depth, nullptr, nullptr, time += 1);
  };
  for (const std::size_t stride : {std::size_t{64}, std::size_t{252}, std::size_t{257},
                                   std::size_t{258}, kLargestSize - 255, kLargestSize - 3}) {
    INFO(stride);
    CHECK(feed_depth(stride) == PALPABLE_WRONG_ARGUMENT);
  }
  CHECK(feed_depth(257) == PALPABLE_WRONG_ARGUMENT);
  CHECK(says("multiple of 4"));
  CHECK(feed_depth(kLargestSize - 255) == PALPABLE_WRONG_ARGUMENT);
  CHECK(says("-256: the top row is to come first"));
  for (const std::size_t stride : {0U, 256U, 260U, 1024U}) CHECK(feed_depth(stride) == PALPABLE_OK);
  // Rows that would end beyond the address space.
  palpable_image high = picture.image(PALPABLE_GRAY8, 64);
  high.pixels = reinterpret_cast<const void*>(kLargestSize - 1000);  // NOLINT: never read
  CHECK(feed_color(high) == PALPABLE_WRONG_ARGUMENT);
}

TEST_CASE("the strides of both eyes are judged", "[capi][hostile]") {
  palpable_setup setup = depth_setup();
  setup.camera = PALPABLE_STEREO;
  setup.width = 320;
  setup.height = 180;
  setup.fx = setup.fy = 175;
  setup.cx = 159.5;
  setup.cy = 89.5;
  setup.baseline = 0.063;
  const Opened pairs(setup);
  const std::vector<std::uint8_t> grey(std::size_t{180} * 384, 90);
  const auto eye = [&](std::size_t stride) {
    return palpable_image{sizeof(palpable_image), grey.data(), 320, 180, PALPABLE_GRAY8, stride};
  };
  const palpable_image good = eye(384);
  for (const std::size_t stride : {std::size_t{319}, kLargestSize - 319, std::size_t{1} << 40}) {
    const palpable_image bad = eye(stride);
    CHECK(palpable_feed_stereo(pairs, &bad, &good, nullptr, 1) == PALPABLE_WRONG_ARGUMENT);
    CHECK(says("left image has a stride of " + std::to_string(stride)));
    CHECK(palpable_feed_stereo(pairs, &good, &bad, nullptr, 1) == PALPABLE_WRONG_ARGUMENT);
    CHECK(says("right image has a stride of " + std::to_string(stride)));
  }
  CHECK(palpable_feed_stereo(pairs, &good, &good, nullptr, 1) == PALPABLE_OK);
}

TEST_CASE("the size of each struct is judged", "[capi][hostile]") {
  const Opened session(depth_setup());
  const Picture picture;
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{8}, std::size_t{4097},
                                 std::size_t{1} << 40, kLargestSize}) {
    INFO(size);
    auto frame = test::sized<palpable_frame>();
    auto touch = test::sized<palpable_touch>();
    auto skin = test::sized<palpable_skin>();
    auto depth = test::sized<palpable_depth>();
    palpable_setup setup = depth_setup();
    palpable_image z = picture.image(PALPABLE_DEPTH_F32, 0);
    frame.size = touch.size = skin.size = depth.size = setup.size = z.size = size;
    CHECK(palpable_get_frame(session, &frame) == PALPABLE_WRONG_ARGUMENT);
    CHECK(palpable_get_touch(session, 0, &touch) == PALPABLE_WRONG_ARGUMENT);
    CHECK(palpable_get_skin(session, 0, &skin) == PALPABLE_WRONG_ARGUMENT);
    CHECK(palpable_get_depth(session, &depth) != PALPABLE_OK);
    CHECK(palpable_feed_depth(session, &z, nullptr, nullptr, 0) == PALPABLE_WRONG_ARGUMENT);
    palpable_body* ball = loaded_ball();
    palpable_session* other = nullptr;
    CHECK(palpable_open(&ball, 1, &setup, &other) == PALPABLE_WRONG_ARGUMENT);
    CHECK(other == nullptr);
    palpable_free_body(ball);
  }
}

TEST_CASE("times and poses that are none are refused with the value, and the session goes on",
          "[capi][hostile]") {
  const Opened session(depth_setup());
  const Picture picture;
  const palpable_image z = picture.image(PALPABLE_DEPTH_F32, 0);
  std::array<double, 16> pose{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  REQUIRE(palpable_feed_depth(session, &z, nullptr, pose.data(), 1) == PALPABLE_OK);
  for (const double time : {1.0, 0.0, -5e-324, kNot, kInfinite, -kInfinite, 1e12, 1e308, -1e308}) {
    INFO(time);
    CHECK(palpable_feed_depth(session, &z, nullptr, pose.data(), time) == PALPABLE_WRONG_ARGUMENT);
    CHECK(says("time is "));
  }
  palpable_body* ball = loaded_ball();
  for (std::size_t k = 0; k < 16; ++k) {
    for (const double value : {kNot, kInfinite, -kInfinite, 1e308, -1e308, 1.1}) {
      if (k == 0 && std::isnan(value)) continue;           // an unknown pose
      if (k % 4 == 3 && k < 12 && value == 1.1) continue;  // a translation
      std::array<double, 16> bad = pose;
      bad[k] = value;
      INFO("entry " << k << ", value " << value);
      CHECK(palpable_feed_depth(session, &z, nullptr, bad.data(), 2) == PALPABLE_WRONG_ARGUMENT);
      CHECK(says("world_from_camera"));
      CHECK(palpable_place_body(ball, bad.data()) == PALPABLE_WRONG_ARGUMENT);
      CHECK(says("world_from_body"));
    }
  }
  palpable_free_body(ball);
  CHECK(palpable_feed_depth(session, &z, nullptr, pose.data(), 1 + 1e-15) == PALPABLE_OK);
  pose[0] = kNot;
  CHECK(palpable_feed_depth(session, &z, nullptr, pose.data(), 9e11) == PALPABLE_OK);
  CHECK(frame_after(session).camera == PALPABLE_LOST);
}

TEST_CASE("counts and indices that are none are refused", "[capi][hostile]") {
  palpable_body* ball = loaded_ball();
  const std::vector<const palpable_body*> many(65, ball);
  palpable_session* session = nullptr;
  const palpable_setup setup = depth_setup();
  for (const std::size_t count : {std::size_t{0}, std::size_t{65}, kLargestSize}) {
    CHECK(palpable_open(many.data(), count, &setup, &session) == PALPABLE_WRONG_ARGUMENT);
    CHECK(session == nullptr);
  }
  palpable_free_body(ball);
  const Opened open;
  auto touch = test::sized<palpable_touch>();
  auto skin = test::sized<palpable_skin>();
  for (const int index :
       {-1, 1, 1 << 30, std::numeric_limits<int>::min(), std::numeric_limits<int>::max()}) {
    CHECK(palpable_get_touch(open, index, &touch) == PALPABLE_WRONG_ARGUMENT);
    CHECK(palpable_get_skin(open, index, &skin) == PALPABLE_WRONG_ARGUMENT);
    CHECK(says(std::to_string(index)));
  }
}

TEST_CASE("results before the first frame, after a refused one and after a reset are whole",
          "[capi][hostile]") {
  for (const palpable_setup& setup : {test::sized<palpable_setup>(), depth_setup()}) {
    const Opened session(setup);
    const auto look = [&] {
      const palpable_frame frame = frame_after(session);
      CHECK(frame.body_count == 1);
      CHECK(frame.touch_count == 0);
      CHECK(std::isnan(frame.time));
      auto skin = test::sized<palpable_skin>();
      REQUIRE(palpable_get_skin(session, 0, &skin) == PALPABLE_OK);
      float sum = 0;
      for (int k = 0; k < 3 * skin.vertex_count; ++k) sum += skin.vertices[k] * skin.normals[k];
      for (int v = 0; v < skin.vertex_count; ++v) sum += skin.von_mises[v];
      CHECK(std::isfinite(sum));
      auto touch = test::sized<palpable_touch>();
      CHECK(palpable_get_touch(session, 0, &touch) == PALPABLE_WRONG_ARGUMENT);
      auto depth = test::sized<palpable_depth>();
      CHECK(palpable_get_depth(session, &depth) == PALPABLE_NOT_POSSIBLE);
    };
    look();
    const palpable_capsule bad = ball_at({kNot, 0, 0}, 1);
    CHECK(palpable_press(session, &bad, 1) != PALPABLE_OK);
    CHECK(palpable_feed_depth(session, nullptr, nullptr, nullptr, 0) != PALPABLE_OK);
    CHECK(palpable_feed_stereo(session, nullptr, nullptr, nullptr, 0) != PALPABLE_OK);
    look();
    REQUIRE(palpable_reset(session) == PALPABLE_OK);
    look();
  }
}

TEST_CASE("a frame of a camera is not judged, and an older caller gets no more than it asked for",
          "[capi][hostile]") {
  const Opened session(depth_setup());
  const Picture picture;
  const palpable_image z = picture.image(PALPABLE_DEPTH_F32, 0);
  REQUIRE(palpable_feed_depth(session, &z, nullptr, nullptr, 0) == PALPABLE_OK);
  const palpable_frame frame = frame_after(session);
  CHECK(frame.answer == PALPABLE_NOT_JUDGED);
  CHECK(frame.left_to_go == 0);
  CHECK(frame.inside == 0);
  static_assert(offsetof(palpable_frame, inside) == 168);
  static_assert(offsetof(palpable_frame, answer) == 176);
  static_assert(offsetof(palpable_frame, passed_through) == 180);
  static_assert(offsetof(palpable_frame, ringing) == 184);
  auto old = test::sized<palpable_frame>();
  old.size = offsetof(palpable_frame, inside);
  old.inside = 7;
  old.answer = 7;
  REQUIRE(palpable_get_frame(session, &old) == PALPABLE_OK);
  CHECK(old.inside == 7);
  CHECK(old.answer == 7);
  CHECK(old.size == offsetof(palpable_frame, inside));
}

TEST_CASE("threads press sessions on one body at once, each with its own errors",
          "[capi][hostile]") {
  constexpr std::size_t kThreads = 4;
  palpable_body* ball = loaded_ball();
  std::array<palpable_session*, kThreads> sessions{};
  const auto setup = test::sized<palpable_setup>();
  for (palpable_session*& session : sessions) {
    REQUIRE(palpable_open(&ball, 1, &setup, &session) == PALPABLE_OK);
  }
  palpable_free_body(ball);
  std::array<double, kThreads> inside{};
  std::array<bool, kThreads> own{};
  std::vector<std::thread> threads;
  for (std::size_t k = 0; k < kThreads; ++k) {
    threads.emplace_back([&, k] {
      own[k] = true;
      for (int n = 1; n <= 8; ++n) {
        const palpable_capsule c = ball_at({0, 0, 0.108 - 5e-4 * n}, 0.008);
        palpable_capsule bad = c;
        bad.radius_a = -1.0 - static_cast<double>(k);
        own[k] = own[k] && palpable_press(sessions[k], &c, 1) == PALPABLE_OK &&
                 palpable_press(sessions[k], &bad, 1) == PALPABLE_WRONG_ARGUMENT &&
                 std::string(palpable_last_error()).find("is -" + std::to_string(k + 1)) !=
                     std::string::npos;
        palpable_body* other = nullptr;  // reading a file beside them
        own[k] = own[k] && palpable_load_body(ball_file().c_str(), 2, &other) == PALPABLE_OK;
        palpable_free_body(other);
      }
      auto frame = test::sized<palpable_frame>();
      own[k] = own[k] && palpable_get_frame(sessions[k], &frame) == PALPABLE_OK;
      inside[k] = frame.inside;
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t k = 0; k < kThreads; ++k) {
    CHECK(own[k]);
    CHECK(inside[k] == inside[0]);
    palpable_close(sessions[k]);
  }
}

}  // namespace
}  // namespace palpable

#include "palpable/common/geometry/rigid.h"
#include "palpable/live/capi/hands.h"
#include "palpable/live/capi/palpable.h"
#include "tests/support/allocations.h"
#include "tests/support/c_calls.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;
using test::tolerance;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// A ball of 10 cm diameter that stands on Z = 0.
const std::string& ball_file() {
  static const test::ScratchFolder folder("c_things");
  static const std::string path = test::write_ball_body(folder, "ball.palpable", 0.003);
  return path;
}

using OpenBody = std::unique_ptr<palpable_body, decltype(&palpable_free_body)>;
using OpenSession = std::unique_ptr<palpable_session, decltype(&palpable_close)>;

OpenBody ball_at(const Vector3d& place) {
  palpable_body* body = nullptr;
  REQUIRE(palpable_load_body(ball_file().c_str(), 1, &body) == PALPABLE_OK);
  const std::array<double, 16> pose{1, 0, 0, place.x(), 0, 1, 0, place.y(),
                                    0, 0, 1, place.z(), 0, 0, 0, 1};
  REQUIRE(palpable_place_body(body, pose.data()) == PALPABLE_OK);
  return OpenBody(body, palpable_free_body);
}

OpenSession session_of(const std::vector<const palpable_body*>& bodies) {
  const auto setup = test::sized<palpable_setup>();
  palpable_session* session = nullptr;
  const palpable_status status = palpable_open(bodies.data(), bodies.size(), &setup, &session);
  INFO(palpable_last_error());
  REQUIRE(status == PALPABLE_OK);
  return OpenSession(session, palpable_close);
}

// A finger that penetrates the top of a ball at `x` by `depth`, m.
palpable_capsule finger_at(double x, double depth) {
  const double tip = 0.1 - depth + 0.008;
  return {{x, 0, tip}, {x, 0, tip + 0.1}, 0.008, 0.008};
}

palpable_thing thing_of(int64_t id, const palpable_capsule& capsule) {
  return {sizeof(palpable_thing), id, &capsule, 1, 0};
}

std::vector<palpable_touch> touches_of(const palpable_session* session) {
  auto frame = test::sized<palpable_frame>();
  REQUIRE(palpable_get_frame(session, &frame) == PALPABLE_OK);
  std::vector<palpable_touch> touches;
  for (int k = 0; k < frame.touch_count; ++k) {
    touches.push_back(test::sized<palpable_touch>());
    REQUIRE(palpable_get_touch(session, k, &touches.back()) == PALPABLE_OK);
  }
  return touches;
}

palpable_skin skin_of(const palpable_session* session, int body = 0) {
  auto skin = test::sized<palpable_skin>();
  REQUIRE(palpable_get_skin(session, body, &skin) == PALPABLE_OK);
  return skin;
}

TEST_CASE("touches carry the ids of the things that press", "[capi]") {
  const OpenBody left = ball_at({0, 0, 0}), right = ball_at({0.3, 0, 0});
  const OpenSession session = session_of({left.get(), right.get()});
  const palpable_capsule deep = finger_at(0.3, 0.005), shallow = finger_at(0, 0.002);
  const std::array things{thing_of(-7, shallow), thing_of(1LL << 40, deep)};
  REQUIRE(palpable_press_at(session.get(), things.data(), 2, 12.5) == PALPABLE_OK);
  const std::vector<palpable_touch> touches = touches_of(session.get());
  REQUIRE(touches.size() == 2);
  CHECK(touches[0].body == 1);
  CHECK(touches[0].thing == 1LL << 40);
  CHECK(touches[1].body == 0);
  CHECK(touches[1].thing == -7);
  CHECK(touches[0].by == -1);
  auto frame = test::sized<palpable_frame>();
  REQUIRE(palpable_get_frame(session.get(), &frame) == PALPABLE_OK);
  CHECK(frame.time == 12.5);
  CHECK(frame.answer == PALPABLE_REACHED);
  // The order of the things and a third one far away change nothing.
  const palpable_capsule away = finger_at(5, 0);
  const std::array others{things[1], thing_of(3, away), things[0]};
  REQUIRE(palpable_reset(session.get()) == PALPABLE_OK);
  REQUIRE(palpable_press_at(session.get(), others.data(), 3, 0) == PALPABLE_OK);
  const std::vector<palpable_touch> again = touches_of(session.get());
  REQUIRE(again.size() == 2);
  for (std::size_t k = 0; k < 2; ++k) {
    CHECK(again[k].thing == touches[k].thing);
    CHECK(Vector3d(again[k].force) == Vector3d(touches[k].force));
  }
}

TEST_CASE("a tick gives the forces on things, and leaves the frame as it is", "[capi]") {
  const OpenBody ball = ball_at({0, 0, 0});
  const OpenSession ticked = session_of({ball.get()}), framed = session_of({ball.get()});
  const palpable_capsule still = finger_at(1, 0);
  std::array<palpable_thing_force, 2> forces{};
  int32_t reached = 0;
  const auto things_at = [&](const palpable_capsule& finger) {
    return std::array{thing_of(5, still), thing_of(6, finger)};
  };
  for (int k = 0; k <= 40; ++k) {
    const palpable_capsule finger = finger_at(0, 1e-4 * k - 1e-3);
    const auto things = things_at(finger);
    REQUIRE(palpable_press_at(framed.get(), things.data(), 2, 1e-3 * k) == PALPABLE_OK);
    if (k == 0) {
      REQUIRE(palpable_press_at(ticked.get(), things.data(), 2, 0) == PALPABLE_OK);
    } else {
      REQUIRE(palpable_tick_at(ticked.get(), things.data(), 2, 1e-3 * k, forces.data(), &reached) ==
              PALPABLE_OK);
    }
  }
  const std::vector<palpable_touch> touches = touches_of(framed.get());
  REQUIRE(touches.size() == 1);
  const Vector3d on_body(touches[0].force), on_thing(forces[1].force);
  CHECK(on_body.norm() > 0.1);
  CHECK((on_thing + on_body).norm() < tolerance(0.01, "a tick's") * on_body.norm());
  const Vector3d torque = Vector3d(touches[0].point).cross(-on_body);
  CHECK((Vector3d(forces[1].torque) - torque).norm() <
        tolerance(0.001, "m, of the centre of pressure") * on_body.norm());
  CHECK(Vector3d(forces[0].force).isZero(0));
  CHECK(reached == 1);
  // The frame is still the one without a touch; the next one goes on from the ticks.
  CHECK(touches_of(ticked.get()).empty());
  auto frame = test::sized<palpable_frame>();
  REQUIRE(palpable_get_frame(ticked.get(), &frame) == PALPABLE_OK);
  CHECK(frame.time == 0);
  const palpable_capsule finger = finger_at(0, 3e-3);
  const auto things = things_at(finger);
  for (const auto& session : {ticked.get(), framed.get()}) {
    REQUIRE(palpable_press_at(session, things.data(), 2, 0.041) == PALPABLE_OK);
  }
  const palpable_skin a = skin_of(ticked.get()), b = skin_of(framed.get());
  double apart = 0;
  for (int k = 0; k < 3 * a.vertex_count; ++k) {
    apart = std::max(apart, static_cast<double>(std::abs(a.vertices[k] - b.vertices[k])));
  }
  CHECK(apart < tolerance(3e-5, "m: 1 % of 3 mm"));
  CHECK(touches_of(ticked.get())[0].thing == 6);
}

TEST_CASE("a touch says how many contact points had no room", "[capi]") {
  const OpenBody ball = ball_at({0, 0, 0});
  const OpenSession session = session_of({ball.get()});
  const palpable_capsule finger = finger_at(0, 0.003);
  const palpable_thing one = thing_of(1, finger);
  REQUIRE(palpable_press_at(session.get(), &one, 1, 1) == PALPABLE_OK);
  CHECK(touches_of(session.get())[0].left_out == 0);
  // Fingertips all over the upper half.
  std::vector<palpable_capsule> all;
  for (int ring = 1; ring <= 5; ++ring) {
    for (int k = 0; k < 6 * ring; ++k) {
      const double down = 0.3 * ring, round = 2 * M_PI * k / (6 * ring);
      const Vector3d out(std::sin(down) * std::cos(round), std::sin(down) * std::sin(round),
                         std::cos(down));
      const Vector3d at = Vector3d(0, 0, 0.05) + (0.05 + 0.006) * out;
      all.push_back({{at.x(), at.y(), at.z()}, {at.x(), at.y(), at.z()}, 0.008, 0.008});
    }
  }
  const palpable_thing many{sizeof(palpable_thing), 2, all.data(), all.size(), 0};
  REQUIRE(palpable_press_at(session.get(), &many, 1, 2) == PALPABLE_OK);
  const std::vector<palpable_touch> touches = touches_of(session.get());
  REQUIRE(!touches.empty());
  for (const palpable_touch& touch : touches) CHECK(touch.left_out > 0);
}

TEST_CASE("a thing that comes in a tick is felt at once, as in a frame", "[capi]") {
  const OpenBody ball = ball_at({0, 0, 0});
  const OpenSession ticked = session_of({ball.get()}), framed = session_of({ball.get()});
  const palpable_capsule one = finger_at(0, 0.003), other = finger_at(0.03, 0.012);
  const std::array things{thing_of(1, one), thing_of(2, other)};
  std::array<palpable_thing_force, 2> forces{};
  for (int k = 0; k < 20; ++k) {
    REQUIRE(palpable_tick_at(ticked.get(), things.data(), 1, 1e-3 * k, forces.data(), nullptr) ==
            PALPABLE_OK);
    REQUIRE(palpable_press_at(framed.get(), things.data(), 1, 1e-3 * k) == PALPABLE_OK);
  }
  REQUIRE(palpable_tick_at(ticked.get(), things.data(), 2, 0.02, forces.data(), nullptr) ==
          PALPABLE_OK);
  REQUIRE(palpable_press_at(framed.get(), things.data(), 2, 0.02) == PALPABLE_OK);
  for (const palpable_touch& touch : touches_of(framed.get())) {
    const Vector3d felt(forces[touch.thing == 1 ? 0 : 1].force), on_body(touch.force);
    CHECK((felt + on_body).norm() < tolerance(0.02, "a tick's") * on_body.norm());
  }
  CHECK(Vector3d(forces[1].force).norm() > 0.05);
  // They go, and nothing is felt.
  REQUIRE(palpable_tick_at(ticked.get(), nullptr, 0, 0.021, nullptr, nullptr) == PALPABLE_OK);
  REQUIRE(palpable_tick_at(ticked.get(), things.data() + 1, 1, 0.022, forces.data(), nullptr) ==
          PALPABLE_OK);
  CHECK(Vector3d(forces[0].force).norm() > 0.05);
}

TEST_CASE("a device that goes round a body in ticks has not passed through it", "[capi]") {
  const OpenBody ball = ball_at({0, 0, 0});
  const OpenSession session = session_of({ball.get()});
  palpable_capsule finger{};
  palpable_thing thing = thing_of(1, finger);
  palpable_thing_force force{};
  constexpr int kTicks = 200;
  for (int k = 0; k <= kTicks; ++k) {
    const double turn = M_PI * k / kTicks;
    const Vector3d at(0.1 * std::cos(turn), 0.1 * std::sin(turn), 0.05);
    finger = {{at.x(), at.y(), at.z()}, {at.x(), at.y(), at.z()}, 0.008, 0.008};
    if (k == 0 || k == kTicks) {
      REQUIRE(palpable_press_at(session.get(), &thing, 1, 1e-3 * k) == PALPABLE_OK);
    } else {
      REQUIRE(palpable_tick_at(session.get(), &thing, 1, 1e-3 * k, &force, nullptr) == PALPABLE_OK);
    }
  }
  auto frame = test::sized<palpable_frame>();
  REQUIRE(palpable_get_frame(session.get(), &frame) == PALPABLE_OK);
  CHECK(frame.passed_through == 0);
}

TEST_CASE("ticks of several bodies, and what ticks refuse", "[capi]") {
  const OpenBody left = ball_at({0, 0, 0}), right = ball_at({0.3, 0, 0});
  const OpenSession session = session_of({left.get(), right.get()});
  const palpable_capsule a = finger_at(0, 0.003), b = finger_at(0.3, 0.002);
  const std::array things{thing_of(1, a), thing_of(2, b)};
  std::array<palpable_thing_force, 2> forces{};
  const auto tick_at = [&](double seconds, palpable_thing_force* to) {
    return palpable_tick_at(session.get(), things.data(), 2, seconds, to, nullptr);
  };
  REQUIRE(tick_at(1, forces.data()) == PALPABLE_OK);
  REQUIRE(tick_at(1.001, forces.data()) == PALPABLE_OK);
  const OpenSession framed = session_of({left.get(), right.get()});
  for (const double seconds : {1.0, 1.001}) {
    REQUIRE(palpable_press_at(framed.get(), things.data(), 2, seconds) == PALPABLE_OK);
  }
  for (const palpable_touch& touch : touches_of(framed.get())) {
    const Vector3d felt(forces[static_cast<std::size_t>(touch.thing - 1)].force);
    CHECK((felt + Vector3d(touch.force)).norm() < tolerance(1e-5, "floats") * felt.norm());
  }
  CHECK(tick_at(1.001, forces.data()) == PALPABLE_WRONG_ARGUMENT);
  CHECK(tick_at(1.002, nullptr) == PALPABLE_WRONG_ARGUMENT);
  CHECK(palpable_press_at(session.get(), things.data(), 2, 1.001) == PALPABLE_WRONG_ARGUMENT);
  CHECK(palpable_tick_at(session.get(), nullptr, 0, 1.002, nullptr, nullptr) == PALPABLE_OK);
  CHECK(palpable_tick_at(nullptr, nullptr, 0, 2, nullptr, nullptr) == PALPABLE_WRONG_ARGUMENT);
}

TEST_CASE("two things side by side are two touches, as one thing they are one", "[capi]") {
  const OpenBody ball = ball_at({0, 0, 0});
  const palpable_capsule a = finger_at(-0.003, 0.004), b = finger_at(0.003, 0.004);
  const std::array apart{thing_of(1, a), thing_of(2, b)};
  const OpenSession two = session_of({ball.get()}), one = session_of({ball.get()});
  REQUIRE(palpable_press_at(two.get(), apart.data(), 2, 1) == PALPABLE_OK);
  const std::array both{a, b};
  REQUIRE(palpable_press(one.get(), both.data(), 2) == PALPABLE_OK);
  const std::vector<palpable_touch> split = touches_of(two.get()), joined = touches_of(one.get());
  REQUIRE(split.size() == 2);
  REQUIRE(joined.size() == 1);
  CHECK(split[0].thing + split[1].thing == 3);
  CHECK(joined[0].thing == 0);
  const Vector3d sum = Vector3d(split[0].force) + Vector3d(split[1].force);
  CHECK((sum - Vector3d(joined[0].force)).norm() <
        tolerance(1e-5, "floats are added in another order") * sum.norm());
}

TEST_CASE("palpable_press is palpable_press_at with one thing, to the byte", "[capi]") {
  const OpenBody ball = ball_at({0, 0, 0});
  const OpenSession old = session_of({ball.get()}), now = session_of({ball.get()});
  for (int k = 1; k <= 5; ++k) {
    const palpable_capsule c = finger_at(0.001 * k, 0.001 * k);
    const palpable_thing thing = thing_of(0, c);
    REQUIRE(palpable_press(old.get(), &c, 1) == PALPABLE_OK);
    REQUIRE(palpable_press_at(now.get(), &thing, 1, k) == PALPABLE_OK);
    const palpable_skin a = skin_of(old.get()), b = skin_of(now.get());
    const auto same = [&](const float* x, const float* y, int count) {
      return std::equal(x, x + count, y);
    };
    CHECK(same(a.vertices, b.vertices, 3 * a.vertex_count));
    CHECK(same(a.von_mises, b.von_mises, a.vertex_count));
    CHECK(same(a.contact_pressure, b.contact_pressure, a.vertex_count));
  }
  auto frame = test::sized<palpable_frame>();
  REQUIRE(palpable_get_frame(old.get(), &frame) == PALPABLE_OK);
  CHECK(frame.time == 5);
}

TEST_CASE("without a camera, too, bodies press each other with opposite forces", "[capi]") {
  // A thick finger pushes the left ball against the right one, which stands beside it.
  const OpenBody left = ball_at({0, 0, 0}), right = ball_at({0.1, 0, 0});
  const OpenSession session = session_of({left.get(), right.get()});
  const palpable_capsule pushes{{-0.080, 0, 0.05}, {-0.080, 0, 0.05}, 0.04, 0.04};
  const palpable_thing thing = thing_of(8, pushes);
  for (int k = 1; k <= 3; ++k) {
    REQUIRE(palpable_press_at(session.get(), &thing, 1, k) == PALPABLE_OK);
  }
  std::array<Vector3d, 2> on{Vector3d::Zero(), Vector3d::Zero()};  // by the other ball
  for (const palpable_touch& touch : touches_of(session.get())) {
    const bool by_ball = touch.by >= 0;
    CHECK(touch.thing == (by_ball ? PALPABLE_NO_THING : 8));
    if (!by_ball) continue;
    CHECK(touch.by == 1 - touch.body);
    on[static_cast<std::size_t>(touch.body)] += Vector3d(touch.force);
  }
  CHECK(on[1].x() > 0.001);
  CHECK((on[0] + on[1]).norm() < tolerance(1e-4, "floats") * on[1].norm());
}

TEST_CASE("a thing that is swept through a body is noticed by its id, whatever the order",
          "[capi]") {
  const OpenBody ball = ball_at({0, 0, 0});
  const OpenSession session = session_of({ball.get()});
  const auto ball_at_x = [](double x) {
    return palpable_capsule{{x, 0, 0.05}, {x, 0, 0.05}, 0.01, 0.01};
  };
  const palpable_capsule still = finger_at(1, 0), before = ball_at_x(-0.2), after = ball_at_x(0.2);
  const std::array first{thing_of(4, still), thing_of(9, before)};
  const std::array second{thing_of(9, after), thing_of(4, still)};
  REQUIRE(palpable_press_at(session.get(), first.data(), 2, 1) == PALPABLE_OK);
  REQUIRE(palpable_press_at(session.get(), second.data(), 2, 2) == PALPABLE_OK);
  auto frame = test::sized<palpable_frame>();
  REQUIRE(palpable_get_frame(session.get(), &frame) == PALPABLE_OK);
  CHECK(frame.passed_through == 1);
  // Another thing that appears there has not passed.
  const std::array third{thing_of(10, before), thing_of(4, still)};
  REQUIRE(palpable_press_at(session.get(), third.data(), 2, 3) == PALPABLE_OK);
  REQUIRE(palpable_get_frame(session.get(), &frame) == PALPABLE_OK);
  CHECK(frame.passed_through == 0);
}

TEST_CASE("a thing that the skin has closed over is not reached, whatever its radius", "[capi]") {
  const OpenBody ball = ball_at({0, 0, 0});
  auto frame = test::sized<palpable_frame>();
  for (const double radius : {0.001, 0.0025, 0.004, 0.008, 0.015}) {
    INFO("radius " << radius << " m");
    const OpenSession session = session_of({ball.get()});
    const palpable_capsule inside{{0, 0, 0.05}, {0, 0, 0.05}, radius, radius};
    REQUIRE(palpable_press(session.get(), &inside, 1) == PALPABLE_OK);
    REQUIRE(palpable_get_frame(session.get(), &frame) == PALPABLE_OK);
    CHECK(frame.answer == PALPABLE_NOT_REACHED);
    CHECK(frame.inside == Approx(0.05 + radius).margin(tolerance(5e-3, "m: vertices 6 mm apart")));
  }
}

TEST_CASE("a thing that stops inside and leaves on the other side has passed through", "[capi]") {
  const OpenBody ball = ball_at({0, 0, 0});
  const OpenSession session = session_of({ball.get()});
  const auto passed = [&](double x) {
    const palpable_capsule c{{x, 0, 0.05}, {x, 0, 0.05}, 0.01, 0.01};
    const palpable_thing thing = thing_of(2, c);
    auto frame = test::sized<palpable_frame>();
    CHECK(palpable_get_frame(session.get(), &frame) == PALPABLE_OK);
    const double seconds = std::isnan(frame.time) ? 0 : frame.time + 1;
    REQUIRE(palpable_press_at(session.get(), &thing, 1, seconds) == PALPABLE_OK);
    REQUIRE(palpable_get_frame(session.get(), &frame) == PALPABLE_OK);
    return frame.passed_through;
  };
  CHECK(passed(-0.2) == 0);
  CHECK(passed(0) == 0);
  CHECK(passed(0.005) == 0);
  CHECK(passed(0.2) == 1);
  CHECK(passed(0.21) == 0);
  // In and out on the same side is no passage.
  CHECK(passed(0) == 0);
  CHECK(passed(0.2) == 0);
}

TEST_CASE("things that cannot be are refused, and the session goes on", "[capi][errors]") {
  const OpenBody ball = ball_at({0, 0, 0});
  const OpenSession session = session_of({ball.get()});
  const palpable_capsule c = finger_at(0, 0.002);
  const auto refused = [&](std::vector<palpable_thing> things, double seconds = 1) {
    CHECK(palpable_press_at(session.get(), things.data(), things.size(), seconds) ==
          PALPABLE_WRONG_ARGUMENT);
    return std::string(palpable_last_error());
  };
  CHECK_THAT(refused({thing_of(1, c), thing_of(2, c), thing_of(1, c)}),
             Catch::Contains("things 0 and 2 have the same id 1"));
  CHECK_THAT(refused({{sizeof(palpable_thing), 1, nullptr, 1, 0}}),
             Catch::Contains("thing 0: capsules is null"));
  CHECK_THAT(refused({{0, 1, &c, 1, 0}}), Catch::Contains("size"));
  CHECK_THAT(refused({thing_of(1, c), {sizeof(palpable_thing) + 8, 2, &c, 1, 0}}),
             Catch::Contains("thing 1"));
  CHECK_THAT(refused({{sizeof(palpable_thing), 1, &c, std::size_t{1} << 60, 0}}),
             Catch::Contains("4096"));
  CHECK_THAT(refused(std::vector<palpable_thing>(257, thing_of(1, c))), Catch::Contains("256"));
  CHECK_THAT(refused({thing_of(PALPABLE_NO_THING, c)}), Catch::Contains("PALPABLE_NO_THING"));
  for (const double time : {kNaN, 1e12, -HUGE_VAL}) {
    CHECK_THAT(refused({thing_of(1, c)}, time), Catch::Contains("time is"));
  }
  palpable_capsule wrong = c;
  wrong.radius_b = 0;
  CHECK_THAT(refused({thing_of(1, wrong)}), Catch::Contains("radius"));
  CHECK(palpable_press_at(session.get(), nullptr, 1, 1) == PALPABLE_WRONG_ARGUMENT);
  const palpable_thing good = thing_of(1, c);
  REQUIRE(palpable_press_at(session.get(), &good, 1, 1) == PALPABLE_OK);
  CHECK_THAT(refused({good}, 1), Catch::Contains("the frame before was 1 s"));
  REQUIRE(palpable_press_at(session.get(), &good, 1, 1.001) == PALPABLE_OK);
  CHECK(touches_of(session.get()).size() == 1);
}

TEST_CASE("a thing rubs a body that has friction, unless it has none of its own",
          "[capi][friction]") {
  const OpenBody ball = ball_at({0, 0, 0}), plain = ball_at({0, 0, 0});
  REQUIRE(palpable_set_friction(ball.get(), 1) == PALPABLE_OK);
  CHECK(palpable_set_friction(ball.get(), -0.5) == PALPABLE_WRONG_ARGUMENT);
  CHECK(palpable_set_friction(ball.get(), kNaN) == PALPABLE_WRONG_ARGUMENT);
  CHECK(palpable_set_friction(nullptr, 1) == PALPABLE_WRONG_ARGUMENT);
  const OpenSession rubs = session_of({ball.get()}), greased = session_of({ball.get()}),
                    without = session_of({plain.get()}), own = session_of({plain.get()}),
                    pressed = session_of({ball.get()});
  for (int k = 1; k <= 6; ++k) {
    const palpable_capsule c = finger_at(0.0001 * k, 0.003);
    palpable_thing thing = thing_of(4, c);
    REQUIRE(palpable_press_at(rubs.get(), &thing, 1, k) == PALPABLE_OK);
    REQUIRE(palpable_press_at(without.get(), &thing, 1, k) == PALPABLE_OK);
    thing.friction = PALPABLE_NO_FRICTION;
    REQUIRE(palpable_press_at(greased.get(), &thing, 1, k) == PALPABLE_OK);
    thing.friction = 1;
    REQUIRE(palpable_press_at(own.get(), &thing, 1, k) == PALPABLE_OK);
    REQUIRE(palpable_press(pressed.get(), &c, 1) == PALPABLE_OK);
  }
  // Along the normal of a touch: what is left is friction.
  const auto rubbing = [](const OpenSession& session) {
    const palpable_touch touch = touches_of(session.get()).at(0);
    const Vector3d force(touch.force), normal(touch.normal);
    return (force - force.dot(normal) * normal).norm() / force.norm();
  };
  CHECK(rubbing(rubs) > 0.02);
  CHECK(rubbing(own) == rubbing(rubs));
  for (const OpenSession* session : {&without, &greased, &pressed}) {
    CHECK(rubbing(*session) < tolerance(1e-12, "rounding"));
  }
  const palpable_capsule c = finger_at(0, 0.002);
  palpable_thing wrong = thing_of(4, c);
  for (const double mu : {-0.5, 11.0, kNaN}) {
    wrong.friction = mu;
    CHECK(palpable_press_at(rubs.get(), &wrong, 1, 9) == PALPABLE_WRONG_ARGUMENT);
    CHECK_THAT(palpable_last_error(), Catch::Contains("friction"));
  }
}

TEST_CASE("what is let go rings in palpable_press_at(), and not in palpable_press()", "[capi]") {
  static const test::ScratchFolder folder("c_swings");
  const std::string file = test::write_ball_body(folder, "ball.palpable", 0.003, true);
  palpable_body* body = nullptr;
  REQUIRE(palpable_load_body(file.c_str(), 1, &body) == PALPABLE_OK);
  const OpenBody ball(body, palpable_free_body);
  const OpenSession moves = session_of({ball.get()}), pressed = session_of({ball.get()});
  REQUIRE(palpable_set_dynamics(ball.get(), 0) == PALPABLE_OK);
  CHECK(palpable_set_dynamics(nullptr, 0) == PALPABLE_WRONG_ARGUMENT);
  const OpenSession still = session_of({ball.get()});
  const auto ringing = [](const OpenSession& session) {
    auto frame = test::sized<palpable_frame>();
    REQUIRE(palpable_get_frame(session.get(), &frame) == PALPABLE_OK);
    return frame.ringing;
  };
  for (int k = 1; k <= 12; ++k) {
    const palpable_capsule c = finger_at(0, k <= 6 ? 0.0005 * k : -0.02);
    const palpable_thing thing = thing_of(4, c);
    REQUIRE(palpable_press_at(moves.get(), &thing, 1, k / 60.0) == PALPABLE_OK);
    REQUIRE(palpable_press_at(still.get(), &thing, 1, k / 60.0) == PALPABLE_OK);
    REQUIRE(palpable_press(pressed.get(), &c, 1) == PALPABLE_OK);
    CHECK(ringing(still) == 0);
    CHECK(ringing(pressed) == 0);
    if (k > 6) CHECK(ringing(moves) > 0);
  }
  const auto top = [](const OpenSession& session) {
    const palpable_skin skin = skin_of(session.get());
    float highest = 0;
    for (int v = 0; v < skin.vertex_count; ++v) {
      highest = std::max(highest, skin.vertices[3 * v + 2]);
    }
    return highest;
  };
  CHECK(top(moves) != top(still));
  CHECK(top(still) == top(pressed));
}

TEST_CASE("things of callers who were built before friction rub as the body does",
          "[capi][friction]") {
  struct Earlier {  // palpable_thing of version 0.1
    size_t size;
    int64_t id;
    const palpable_capsule* capsules;
    size_t count;
  };
  STATIC_REQUIRE(sizeof(Earlier) == offsetof(palpable_thing, friction));
  const OpenBody ball = ball_at({0, 0, 0});
  REQUIRE(palpable_set_friction(ball.get(), 1) == PALPABLE_OK);
  const OpenSession now = session_of({ball.get()}), earlier = session_of({ball.get()});
  for (int k = 1; k <= 4; ++k) {
    const palpable_capsule a = finger_at(-0.012 + 0.0002 * k, 0.003);
    const palpable_capsule b = finger_at(0.012 - 0.0002 * k, 0.003);
    const std::array<Earlier, 2> things{{{sizeof(Earlier), 1, &a, 1}, {sizeof(Earlier), 2, &b, 1}}};
    const auto* list = reinterpret_cast<const palpable_thing*>(things.data());
    REQUIRE(palpable_press_at(earlier.get(), list, things.size(), k) == PALPABLE_OK);
    const std::array<palpable_thing, 2> same{thing_of(1, a), thing_of(2, b)};
    REQUIRE(palpable_press_at(now.get(), same.data(), same.size(), k) == PALPABLE_OK);
  }
  const std::vector<palpable_touch> with = touches_of(now.get()), old = touches_of(earlier.get());
  REQUIRE(with.size() == 2);
  REQUIRE(old.size() == 2);
  for (std::size_t k = 0; k < 2; ++k) {
    CHECK(old[k].thing == with[k].thing);
    CHECK(Vector3d(old[k].force) == Vector3d(with[k].force));
    // It rubs: the force is not along the normal.
    const Vector3d force(old[k].force), normal(old[k].normal);
    CHECK((force - force.dot(normal) * normal).norm() > 0.01 * force.norm());
  }
}

TEST_CASE("things of callers who know more members lie as far apart as they say", "[capi]") {
  struct Later {
    palpable_thing known;
    double charge;
  };
  const OpenBody ball = ball_at({0, 0, 0});
  const OpenSession session = session_of({ball.get()});
  const palpable_capsule a = finger_at(-0.005, 0.003), b = finger_at(0.005, 0.003);
  std::array<Later, 2> things{Later{{sizeof(Later), 1, &a, 1, 0}, 0},
                              {{sizeof(Later), 2, &b, 1, 0}, 0}};
  REQUIRE(palpable_press_at(session.get(), &things[0].known, 2, 1) == PALPABLE_OK);
  CHECK(touches_of(session.get()).size() == 2);
  things[1].charge = 0.5;
  CHECK(palpable_press_at(session.get(), &things[0].known, 2, 2) == PALPABLE_NOT_POSSIBLE);
}

TEST_CASE("pressing by many things allocates nothing after the first calls", "[capi]") {
  const OpenBody left = ball_at({0, 0, 0}), right = ball_at({0.095, 0, 0});
  const OpenSession session = session_of({left.get(), right.get()});
  const auto press = [&](int k) {
    const palpable_capsule a = finger_at(0.0002 * (k % 10), 0.003 + 0.0001 * (k % 7));
    const palpable_capsule b = finger_at(0.095, 0.002);
    const std::array things{thing_of(1, a), thing_of(2, b)};
    return palpable_press_at(session.get(), things.data(), 2, k);
  };
  for (int k = 0; k < 20; ++k) REQUIRE(press(k) == PALPABLE_OK);
  int refused = 0;
  const auto allocated = test::allocations_during([&] {
    for (int k = 20; k < 40; ++k) refused += press(k) != PALPABLE_OK;
  });
  CHECK(allocated == 0);
  CHECK(refused == 0);
  CHECK(touches_of(session.get()).size() >= 2);
}

TEST_CASE("a kept frame outlives the next one, its session and its body, at its address",
          "[capi]") {
  OpenBody ball = ball_at({0, 0, 0});
  OpenSession session = session_of({ball.get()});
  const palpable_capsule c = finger_at(0, 0.004), deeper = finger_at(0, 0.006);
  REQUIRE(palpable_press(session.get(), &c, 1) == PALPABLE_OK);
  const palpable_skin skin = skin_of(session.get());
  const std::vector<float> vertices(skin.vertices, skin.vertices + 3 * skin.vertex_count);
  const std::vector<int32_t> triangles(skin.triangles, skin.triangles + 3 * skin.triangle_count);
  palpable_kept_frame* kept = nullptr;
  REQUIRE(palpable_keep_frame(session.get(), &kept) == PALPABLE_OK);
  auto other = test::sized<palpable_skin>();
  CHECK(palpable_get_skin(session.get(), 0, &other) == PALPABLE_NOT_POSSIBLE);
  palpable_kept_frame* again = kept;
  CHECK(palpable_keep_frame(session.get(), &again) == PALPABLE_NOT_POSSIBLE);
  CHECK(again == nullptr);
  CHECK(touches_of(session.get()).size() == 1);
  REQUIRE(palpable_press(session.get(), &deeper, 1) == PALPABLE_OK);
  const palpable_skin next = skin_of(session.get());
  CHECK(next.vertices != skin.vertices);
  CHECK_FALSE(std::equal(vertices.begin(), vertices.end(), next.vertices));
  session.reset();
  ball.reset();
  CHECK(std::equal(vertices.begin(), vertices.end(), skin.vertices));
  CHECK(std::equal(triangles.begin(), triangles.end(), skin.triangles));
  palpable_free_kept_frame(kept);
  palpable_free_kept_frame(nullptr);
}

TEST_CASE("frames are the same whether those before were kept or not", "[capi]") {
  const OpenBody ball = ball_at({0.1, 0, 0});
  const OpenSession plain = session_of({ball.get()}), keeps = session_of({ball.get()});
  for (int k = 0; k < 4; ++k) {
    const palpable_capsule c = finger_at(0.1, 0.001 * k);
    REQUIRE(palpable_press(plain.get(), &c, 1) == PALPABLE_OK);
    REQUIRE(palpable_press(keeps.get(), &c, 1) == PALPABLE_OK);
    const palpable_skin a = skin_of(plain.get()), b = skin_of(keeps.get());
    CHECK(std::equal(a.vertices, a.vertices + 3 * a.vertex_count, b.vertices));
    CHECK(std::equal(a.von_mises, a.von_mises + a.vertex_count, b.von_mises));
    CHECK(std::equal(a.camera_from_body, a.camera_from_body + 16, b.camera_from_body));
    palpable_kept_frame* kept = nullptr;
    REQUIRE(palpable_keep_frame(keeps.get(), &kept) == PALPABLE_OK);
    palpable_free_kept_frame(kept);
  }
}

TEST_CASE("a hand's joints press through C", "[capi][hands]") {
  std::array<double, 75> joints{};
  const auto set = [&](int k, double x, double y, double z) {
    joints[3 * k] = x, joints[3 * k + 1] = y, joints[3 * k + 2] = z;
  };
  // A right hand flat above the ball, palm down: X towards the fingers, Y to the thumb.
  const double high = 0.11;
  set(0, -0.09, 0, high);
  for (int k = 0; k < 4; ++k) set(1 + k, -0.07 + 0.03 * k, 0.03 + 0.01 * k, high);
  for (int f = 0; f < 4; ++f) {
    const double y = 0.025 - 0.02 * f;
    const double ways[] = {-0.078, 0, 0.048, 0.078, 0.0965};
    for (int k = 0; k < 5; ++k) set(5 + 5 * f + k, ways[k], y, high);
  }
  std::array<palpable_capsule, PALPABLE_HAND_CAPSULES> hand;
  REQUIRE(palpable_hand_capsules(PALPABLE_WEBXR_HAND, PALPABLE_RIGHT, joints.data(), nullptr,
                                 hand.data()) == PALPABLE_OK);
  const OpenBody ball = ball_at({0, 0, 0});
  const OpenSession session = session_of({ball.get()});
  const palpable_thing thing{sizeof(palpable_thing), 5, hand.data(), hand.size(), 0};
  REQUIRE(palpable_press_at(session.get(), &thing, 1, 0) == PALPABLE_OK);
  REQUIRE_FALSE(touches_of(session.get()).empty());
  for (const palpable_touch& touch : touches_of(session.get())) CHECK(touch.thing == 5);

  const auto refused = [&](int32_t layout, int32_t side, const double* places, double* radii) {
    CHECK(palpable_hand_capsules(layout, side, places, radii, hand.data()) ==
          PALPABLE_WRONG_ARGUMENT);
    return std::string(palpable_last_error());
  };
  CHECK_THAT(refused(0, PALPABLE_LEFT, joints.data(), nullptr), Catch::Contains("layout 0"));
  CHECK_THAT(refused(PALPABLE_WEBXR_HAND, 0, joints.data(), nullptr), Catch::Contains("side"));
  CHECK_THAT(refused(PALPABLE_WEBXR_HAND, PALPABLE_LEFT, nullptr, nullptr),
             Catch::Contains("joints is null"));
  for (double& x : joints) x *= 1000;
  CHECK_THAT(refused(PALPABLE_WEBXR_HAND, PALPABLE_LEFT, joints.data(), nullptr),
             Catch::Contains("in metres"));
  CHECK(palpable_hand_capsules(PALPABLE_WEBXR_HAND, PALPABLE_LEFT, joints.data(), nullptr,
                               nullptr) == PALPABLE_WRONG_ARGUMENT);
}

}  // namespace
}  // namespace palpable

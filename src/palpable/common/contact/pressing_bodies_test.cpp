#include "palpable/common/contact/pressing_bodies.h"

#include "palpable/common/contact/moving_surface.h"
#include "tests/support/allocations.h"
#include "tests/support/elastic_cushion.h"
#include "tests/support/seen_surface.h"
#include "tests/support/test.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <numbers>
#include <thread>
#include <vector>

namespace palpable {
namespace {

using Eigen::Matrix3Xf;
using Eigen::Vector3d;
using Eigen::Vector3f;
using test::ElasticCushion;
using test::tolerance;

constexpr float kFinger = 0.008f;  // m, radius
constexpr float kApart = 0.0002f;  // m between cushions
const auto kTop = static_cast<float>(ElasticCushion::kHigh);

// One of a heap of cushions, the first on top. Each lies another way.
struct Layer {
  ElasticCushion cushion;
  SkinContact contact{cushion.skin, cushion.fixed, cushion.tables};
  ObjectSurface seen;
  TouchState state;
  std::vector<Touch> touches;

  // A finger that points down, its tip `depth` under the top.
  void see_finger(double depth) {
    std::vector<ObjectBall> balls;
    for (float along = kFinger; along < 0.045f; along += 0.0005f) {
      const Vector3f centre(0.001f, -0.002f, along + kTop - static_cast<float>(depth));
      balls.push_back({centre + Vector3f(0, 0, kFinger), Vector3f::UnitZ(), centre, kFinger, 0, 0});
    }
    see(balls);
  }
  void see(const std::vector<ObjectBall>& balls) {
    const Eigen::AlignedBox3d region(Vector3d(-0.04, -0.04, -0.02), Vector3d(0.04, 0.04, 0.02));
    seen.build(balls, region, Vector3f(0, 0, 0.5f));
  }
  [[nodiscard]] Matrix3Xf skin() const {
    Matrix3Xf x = cushion.skin.vertices.cast<float>();
    if (state.u.cols() > 0) x += state.u;
    return x;
  }
};

struct Heap {
  // The first of them under the finger.
  std::vector<std::unique_ptr<Layer>> layers;
  std::vector<PressingBodies::Body> bodies;
  std::unique_ptr<PressingBodies> all;
  PressingReport report;

  explicit Heap(int count, bool last_gives_way = true, double apart = static_cast<double>(kApart)) {
    for (int k = 0; k < count; ++k) {
      layers.push_back(std::make_unique<Layer>());
      Layer& layer = *layers.back();
      PressingBodies::Body body{&layer.cushion.skin};
      body.world_from_body.linear() =
          (Eigen::AngleAxisd(0.7 * k, Vector3d::UnitZ()) *
           Eigen::AngleAxisd(k % 2 * std::numbers::pi, Vector3d::UnitX()))
              .toRotationMatrix();
      body.world_from_body.translation().z() = -k * (2 * ElasticCushion::kHigh + apart);
      if (k + 1 < count || last_gives_way) {
        body.tables = &layer.cushion.tables;
        body.contact = &layer.contact;
        body.state = &layer.state;
        body.seen = &layer.seen;
      }
      bodies.push_back(body);
    }
    all = std::make_unique<PressingBodies>(bodies);
  }
  // The top one alone sees it: the others lie farther from it than what presses them.
  void press(double depth) {
    layers.front()->see_finger(depth);
    advance();
  }
  void let_go() {
    layers.front()->see({});
    advance();
  }
  void advance() {
    report = all->advance();
    for (std::size_t k = 0; k < layers.size(); ++k) {
      if (bodies[k].contact != nullptr) {
        all->find_touches(static_cast<int>(k), layers[k]->touches);
      }
    }
  }
  // m: how deep a vertex of the upper one is in the lower one, at most.
  [[nodiscard]] double entry(std::size_t upper) const {
    MovingSurface lower(layers[upper + 1]->cushion.skin);
    lower.move(layers[upper + 1]->skin());
    float deepest = 0;
    const Matrix3Xf above = layers[upper]->skin();
    for (const auto& x : above.colwise()) {
      const auto found = lower.nearest(from_to(upper, upper + 1) * Vector3f(x), 0.01f);
      if (found) deepest = std::max(deepest, -found->distance);
    }
    return static_cast<double>(deepest);
  }
  [[nodiscard]] Eigen::Isometry3f from_to(std::size_t from, std::size_t to) const {
    return (bodies[to].world_from_body.inverse() * bodies[from].world_from_body).cast<float>();
  }
  // N, on one of them by another; in the world.
  [[nodiscard]] Vector3d force_by(std::size_t on, int by) const {
    Vector3d sum = Vector3d::Zero();
    for (const Touch& touch : layers[on]->touches) {
      if (touch.by == by) sum += touch.force * touch.direction;
    }
    return bodies[on].world_from_body.linear() * sum;
  }
};

double largest(const Matrix3Xf& u) { return static_cast<double>(u.colwise().norm().maxCoeff()); }

TEST_CASE("a pressed cushion presses the one below, which presses back as hard",
          "[contact][bodies]") {
  Heap heap(2);
  for (const double depth : {0.0015, 0.003, 0.0045, 0.006}) {
    heap.press(depth);
    INFO(depth);
    CHECK(heap.report.imbalance == 0.0);
    CHECK(heap.report.between < tolerance(5e-5, "m: softness, a hundredth of how it gives way"));
    CHECK(heap.entry(0) < tolerance(1.5e-4, "m: points 6 mm apart on a dent of this size"));
  }
  const Vector3d down = heap.force_by(1, 0), up = heap.force_by(0, 1);
  CHECK(down.z() < -0.5);
  CHECK((down + up).norm() < tolerance(1e-6, "N: rounding"));
  CHECK(largest(heap.layers[1]->state.u) > 0.0015);
  // By itself the upper one gives way to less.
  const double pressed = heap.layers[0]->touches.front().force;
  Heap alone(2, true, 0.02);
  alone.press(0.006);
  CHECK(alone.report.rounds == 1);
  CHECK(pressed > 1.1 * alone.layers[0]->touches.front().force);
  CHECK(alone.layers[1]->touches.empty());
}

TEST_CASE("what a body bears of another is its whole answer to these forces", "[contact][bodies]") {
  Heap heap(2);
  for (int frame = 0; frame < 4; ++frame) heap.press(0.005);
  // The lower one's linear answer to the upper one's forces, from the closed form.
  const Layer &upper = *heap.layers[0], &lower = *heap.layers[1];
  const Eigen::Isometry3f to_lower = heap.from_to(0, 1);
  Eigen::Matrix3Xd f = Eigen::Matrix3Xd::Zero(3, lower.cushion.skin.vertex_count());
  MovingSurface skin(lower.cushion.skin);
  skin.move(lower.skin());
  auto& solver = heap.layers[0]->contact.solver();
  for (const PointForce& at : upper.state.forces) {
    if (at.by != 1) continue;
    const SkinPoint& point = solver.points()[static_cast<std::size_t>(at.point)];
    const auto found = skin.nearest(to_lower * point.at(upper.skin()), 0.01f);
    REQUIRE(found);
    for (int k = 0; k < 3; ++k) {
      f.col(skin.corners(found->triangle)[k]) -=
          (found->weights[k] * (to_lower.linear() * at.force)).cast<double>();
    }
  }
  double off = 0;
  for (int v = 0; v < lower.cushion.skin.vertex_count(); v += 7) {
    Vector3d u = Vector3d::Zero();
    for (int w = 0; w < lower.cushion.skin.vertex_count(); ++w) {
      u += lower.cushion.compliance(v, w) * f.col(w);
    }
    off = std::max(off, (lower.state.u.col(v).cast<double>() - u).norm());
  }
  CHECK(largest(lower.state.u) > 0.001);
  CHECK(off < tolerance(1e-5, "m: the places of forces are those of a round ago"));
}

TEST_CASE("held still nothing oscillates", "[contact][bodies]") {
  for (const int count : {2, 3}) {
    Heap heap(count);
    heap.press(0.006);
    heap.press(0.006);
    std::vector<Matrix3Xf> before;
    for (const auto& layer : heap.layers) before.push_back(layer->state.u);
    for (int frame = 0; frame < 30; ++frame) {
      heap.press(0.006);
      for (std::size_t k = 0; k < heap.layers.size(); ++k) {
        INFO("frame " << frame << ", body " << k << " of " << count);
        CHECK(largest(heap.layers[k]->state.u - before[k]) <
              tolerance(2e-5, "m: of the solver's iterations"));
      }
    }
    CHECK(heap.report.rounds == 1);
  }
}

TEST_CASE("what one frame cannot do converges in the next", "[contact][bodies]") {
  Heap slow(2), fast(2);
  for (int frame = 1; frame <= 20; ++frame) slow.press(0.0003 * frame);
  for (int frame = 0; frame < 3; ++frame) fast.press(0.006);
  for (const std::size_t k : {0, 1}) {
    CHECK(largest(slow.layers[k]->state.u - fast.layers[k]->state.u) <
          tolerance(1e-4, "m: of 4 mm; points that press are not quite the same"));
  }
}

TEST_CASE("a body that is let go goes back to rest, and so does the one below",
          "[contact][bodies]") {
  Heap heap(3);
  heap.press(0.006);
  heap.press(0.006);
  CHECK(heap.layers[2]->touches.size() == 1);
  CHECK(heap.layers[2]->touches.front().by == 1);
  for (int frame = 0; frame < 4; ++frame) heap.let_go();
  for (const auto& layer : heap.layers) {
    CHECK(layer->state.u.isZero(0));
    CHECK(layer->touches.empty());
  }
  heap.let_go();
  CHECK(heap.report.rounds == 0);  // nobody is asked
}

TEST_CASE("what cannot give way is an obstacle, and is told where it is", "[contact][bodies]") {
  Heap heap(2, false);
  for (int frame = 0; frame < 3; ++frame) heap.press(0.006);
  const double on_hard = heap.force_by(0, 1).z();
  CHECK(heap.entry(0) < tolerance(1.5e-4, "m, as of two"));
  Heap both(2);
  for (int frame = 0; frame < 3; ++frame) both.press(0.006);
  CHECK(on_hard > 1.2 * both.force_by(0, 1).z());
  // It moves out of the way.
  Matrix3Xf lower = heap.layers[1]->skin();
  lower.row(2).array() += 0.01f;  // it lies upside down
  heap.all->move_obstacle(1, lower);
  for (int frame = 0; frame < 3; ++frame) heap.press(0.006);
  CHECK(heap.force_by(0, 1).isZero(0));
}

TEST_CASE("the same frames give the same bytes, and take no memory", "[contact][bodies]") {
  Heap one(3), other(3);
  for (const double depth : {0.001, 0.006, 0.004, 0.002}) {
    one.press(depth);
    other.press(depth);
    for (std::size_t k = 0; k < 3; ++k) {
      CHECK(one.layers[k]->state.u == other.layers[k]->state.u);
    }
  }
  for (const double depth : {0.001, 0.006}) {
    one.layers.front()->see_finger(depth);
    CHECK(test::allocations_during([&] { one.advance(); }) == 0);
  }
}

TEST_CASE("bodies that press each other have the same bytes whoever else is answered at once",
          "[contact][bodies]") {
  // A heap is answered by one thread. What heaps might share would show where several are.
  const auto played = [] {
    Heap heap(2);
    for (const double depth : {0.002, 0.006, 0.003}) heap.press(depth);
    return std::array<Matrix3Xf, 2>{heap.layers[0]->state.u, heap.layers[1]->state.u};
  };
  const std::array<Matrix3Xf, 2> alone = played();
  REQUIRE(largest(alone[1]) > 1e-4);
  for (const std::size_t count : {1, 2, 8}) {
    INFO(count << " threads");
    std::vector<std::array<Matrix3Xf, 2>> found(count);
    std::vector<std::thread> threads;
    for (std::array<Matrix3Xf, 2>& result : found) {
      threads.emplace_back([&result, &played] { result = played(); });
    }
    for (std::thread& thread : threads) thread.join();
    for (const std::array<Matrix3Xf, 2>& result : found) {
      CHECK(result[0] == alone[0]);
      CHECK(result[1] == alone[1]);
    }
  }
}

}  // namespace
}  // namespace palpable

#include "bench/live/device_study.h"

#include "palpable/common/base/cpu_time.h"
#include "palpable/common/contact/capsule_obstacles.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/response/touch_solver.h"
#include "palpable/live/things/pressed_bodies.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <thread>

namespace palpable::app {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double kTick = 1e-3;    // s
constexpr double kDepth = 5e-3;   // m
constexpr double kAside = 5e-3;   // m
constexpr double kLength = 0.04;  // m, of a finger
constexpr int kEachFrame = 33;    // ticks between frames of a camera
constexpr double kShakeHz = 5;
constexpr double kShakes = 0.002;  // m/s: the hand that holds still shakes faster than a device may

// A body that one finger presses, tick by tick.
class PressedByFinger {
 public:
  PressedByFinger(const TouchableBody& body, const Fingertip& finger, double friction)
      : finger_(finger),
        solver_(body.body.surface, body.body.fixed, *body.touch, {.friction = friction}) {}

  void show(const Vector3d& centre) {
    const std::array now{finger_.at(centre)};
    static constexpr std::array kOfBody{kFrictionOfBody};
    static constexpr std::array kSame{0};
    obstacles_.set(now);
    obstacles_.set_friction(kOfBody, std::span(before_).first(is_there_ ? 1 : 0),
                            std::span(kSame).first(is_there_ ? 1 : 0));
    before_ = now;
    is_there_ = true;
  }
  void tick() { solver_.tick(state_, obstacles_, kTick, way()); }
  void frame() {
    solver_.advance(state_, obstacles_, std::numeric_limits<double>::infinity(), kTick);
  }
  // N, on the body
  [[nodiscard]] Vector3d force() const {
    Vector3d sum = Vector3d::Zero();
    for (const PointForce& at : state_.forces) sum += at.force.cast<double>();
    return sum;
  }

 private:
  [[nodiscard]] double way() const { return static_cast<double>(obstacles_.largest_way()); }

  Fingertip finger_;
  TouchSolver solver_;
  TouchState state_;
  CapsuleObstacles obstacles_;
  std::array<Capsule, 1> before_;
  bool is_there_ = false;
};

// The finger's way in a press at a speed: m into the body and aside, at a time (s).
struct Press {
  double speed;

  [[nodiscard]] double begin() const { return -2e-3 / speed; }
  [[nodiscard]] double end() const { return 2 * kDepth / speed + 2 * kAside / speed; }
  [[nodiscard]] double in(double t) const {
    const double back = 2 * kAside / speed + kDepth / speed;
    return t < back ? std::min(kDepth, speed * t) : kDepth - speed * (t - back);
  }
  [[nodiscard]] double aside(double t) const {
    return std::clamp(speed / 2 * (t - kDepth / speed), 0.0, kAside);
  }
};

// N/m, of the body for a further way of 0.2 mm, from where the finger is.
double stiffness_of(PressedByFinger& pressed, const Vector3d& from, const Vector3d& into) {
  constexpr double kWay = 2e-4;
  constexpr int kTicks = 500;
  const auto force_at = [&](double begin, double end) {
    for (int k = 1; k <= 2 * kTicks; ++k) {  // goes there, and stays until nothing rings
      const double share = std::min(1.0, static_cast<double>(k) / kTicks);
      pressed.show(from + (begin + share * (end - begin)) * into);
      pressed.tick();
    }
    return pressed.force();
  };
  const Vector3d before = force_at(0, 0);
  return (force_at(0, kWay) - before).norm() / kWay;
}

double rounded_to(double step, double value) { return step * std::round(value / step); }

}  // namespace

Capsule Fingertip::at(const Vector3d& centre) const {
  return {centre, centre - kLength * (into - 0.3 * aside).normalized(), radius, 1.1 * radius};
}

std::vector<Fingertip> fingertips(const TouchableBody& body, int count, std::uint64_t seed) {
  const SurfaceMesh& skin = body.body.surface;
  Matrix3Xd normals(3, skin.vertex_count());
  vertex_normals(skin.vertices, skin.triangles, normals);
  const double bottom = skin.vertices.row(2).minCoeff(), top = skin.vertices.row(2).maxCoeff();
  std::mt19937_64 random(seed);
  std::vector<Fingertip> found;
  while (std::ssize(found) < count) {
    const auto v = static_cast<Index>(random() % static_cast<std::uint64_t>(skin.vertex_count()));
    if (body.body.fixed[static_cast<std::size_t>(v)] != 0) continue;
    if (skin.vertices(2, v) < bottom + 0.15 * (top - bottom)) continue;
    Fingertip finger;
    finger.into = -normals.col(v);
    finger.aside = finger.into.unitOrthogonal();
    finger.touching = skin.vertices.col(v) - finger.radius * finger.into;
    found.push_back(finger);
  }
  return found;
}

TickFigures tick_figures(const TouchableBody& body, const Fingertip& finger, double friction,
                         double speed) {
  PressedByFinger alone(body, finger, friction), ticked(body, finger, friction),
      framed(body, finger, friction), mixed(body, finger, friction);
  PressedBodies whole({{std::make_shared<TouchableBody>(body), Rigid3::Identity(), friction}});
  std::vector<SceneBody> shown(1);
  std::vector<Touch> touches;
  const Press press{speed};
  TickFigures figures;
  std::vector<double> apart, sizes;
  int n = 0;
  const auto timed = [](const auto& call) {
    double seconds = 0;
    {
      const CpuTimer timer(seconds);
      call();
    }
    return 1e3 * seconds;
  };
  const auto centre_at = [&](double t) {
    const double in = press.in(t), aside = press.aside(t);
    return Vector3d(finger.touching + in * finger.into + aside * finger.aside);
  };
  // By itself, as in a device's loop: beside the others it would find its memory out of the caches.
  for (double t = press.begin(); t < press.end(); t += kTick) {
    alone.show(centre_at(t));
    const double tick = timed([&] { alone.tick(); });
    (alone.force().norm() > 0 ? figures.ms : figures.air_ms).push_back(tick);
  }
  for (double t = press.begin(); t < press.end(); t += kTick, ++n) {
    const Vector3d centre = centre_at(t);
    for (PressedByFinger* one : {&ticked, &framed, &mixed}) one->show(centre);
    const Capsule capsule = finger.at(centre);
    const CapsuleThing thing{1, {&capsule, 1}};
    ticked.tick();
    const double frame = timed([&] { framed.frame(); });
    const double call = timed([&] { whole.advance({&thing, 1}, shown, touches, kTick); });
    const bool comes_in = n % kEachFrame == kEachFrame - 1;
    if (comes_in) {
      mixed.frame();
    } else {
      mixed.tick();
    }
    const double size = framed.force().norm();
    if (!(size > 0) && !(ticked.force().norm() > 0)) continue;
    figures.frame_ms.push_back(frame);
    figures.press_ms.push_back(call);
    sizes.push_back(size);
    apart.push_back((ticked.force() - framed.force()).norm());
    if (comes_in && size > 0) {
      figures.jump.push_back((mixed.force() - ticked.force()).norm() / size);
    }
  }
  const double largest = sizes.empty() ? 0.0 : *std::max_element(sizes.begin(), sizes.end());
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    if (sizes[k] > 0.1 * largest) {
      figures.force.push_back(apart[k] / sizes[k]);
    } else {
      figures.faint.push_back(apart[k]);
    }
  }
  return figures;
}

bool LeanFigures::is_stable() const { return shake < kShakes; }

LeanFigures lean(const TouchableBody& body, const Fingertip& finger, const DeviceSettings& device,
                 double seconds, bool fast) {
  PressedByFinger pressed(body, finger, device.friction);
  const double step = device.workspace / std::pow(2.0, device.bits), h = 1 / device.rate;
  const double lead = fast ? 0.05 : 1.0;  // s
  Vector3d x = finger.touching - 2e-3 * finger.into, velocity = Vector3d::Zero();
  Vector3d force = Vector3d::Zero(), next = Vector3d::Zero();
  LeanFigures figures;
  figures.least_in_cycle = fast ? std::numeric_limits<double>::infinity() : 0;
  double energy = 0, at_cycle = 0, squares = 0, forces = 0, depths = 0;
  int last = 0;
  const auto shakes_at = [&](double t) { return fast && t > lead && t < seconds - 1.5; };
  const auto target = [&](double t) -> Vector3d {
    const double in = -2e-3 + (kDepth + 2e-3) * std::min(1.0, t / lead);
    const double swing =
        shakes_at(t) ? 3e-3 * std::sin(2 * std::numbers::pi * kShakeHz * (t - lead)) : 0.0;
    return finger.touching + (in + swing) * finger.into;
  };
  const auto measure = [&] {
    pressed.show(x.unaryExpr([step](double value) { return rounded_to(step, value); }));
    pressed.tick();
    return Vector3d(-device.gain * pressed.force());
  };
  const int each_cycle = static_cast<int>(std::lround(device.rate / kShakeHz));
  for (int n = 0; n * h < seconds; ++n) {
    const double t = n * h;
    force = next;
    next = measure();
    const Vector3d before = x;
    constexpr int kParts = 20;  // the device itself moves on in between
    for (int part = 0; part < kParts; ++part) {
      const double dt = h / kParts;
      const Vector3d hand = device.grip * (target(t + part * dt) - x) - device.damping * velocity;
      velocity += dt / device.mass * (hand + force);
      x += dt * velocity;
    }
    energy -= force.dot(x - before);
    figures.largest_energy = std::max(figures.largest_energy, energy);
    // The first cycles begin from rest.
    if (n % each_cycle == 0) {
      if (shakes_at(t - 3 / kShakeHz) && shakes_at(t)) {
        figures.least_in_cycle = std::min(figures.least_in_cycle, energy - at_cycle);
      }
      at_cycle = energy;
    }
    if (t < seconds - 1) continue;
    ++last;
    squares += velocity.squaredNorm();
    forces += force.norm();
    depths += (x - finger.touching).dot(finger.into);
    if (!(velocity.norm() < 100)) break;
  }
  figures.shake = std::sqrt(squares / last);
  figures.force = forces / last;
  figures.depth = depths / last;
  if (figures.is_stable()) figures.stiffness = device.gain * stiffness_of(pressed, x, finger.into);
  return figures;
}

std::vector<double> lateness(const TouchableBody& body, const Fingertip& finger, double friction) {
  using Clock = std::chrono::steady_clock;
  PressedByFinger pressed(body, finger, friction);
  constexpr int kApproach = 500, kMeasured = 1000;  // ticks
  std::vector<double> late;
  Clock::time_point due = Clock::now();
  for (int k = 0; k < kApproach + kMeasured; ++k) {
    const double in = std::min(4e-3, 1e-5 * k - 1e-3) + 1e-4 * std::sin(0.05 * k);
    if (k >= kApproach) std::this_thread::sleep_until(due);
    pressed.show(finger.touching + in * finger.into);
    pressed.tick();
    const std::chrono::duration<double, std::milli> after = Clock::now() - due;
    if (k >= kApproach) late.push_back(after.count());
    // One that is late does not delay those after the next.
    due = k < kApproach ? Clock::now() : due + std::chrono::milliseconds(1);
  }
  return late;
}

}  // namespace palpable::app

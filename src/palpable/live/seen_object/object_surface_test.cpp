#include "palpable/live/seen_object/object_surface.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/order_statistics.h"
#include "tests/support/allocations.h"
#include "tests/support/seen_capsules.h"
#include "tests/support/test.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using test::Capsule;
using test::tolerance;

// The focal length of the stereo chain at half resolution. Only 161 x 121 pixels, so that the debug
// build is quick.
constexpr PinholeCamera kCamera{161, 121, 350, 350, 80, 60};

// A body frame that is parallel to no axis of the camera, so that an inverted transform is noticed.
Rigid3 some_pose() {
  Rigid3 body_from_camera = Rigid3::Identity();
  body_from_camera.linear() =
      (Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized())).toRotationMatrix();
  body_from_camera.translation() = Vector3d(0.1, -0.2, 0.05);
  return body_from_camera;
}

Eigen::AlignedBox3d box_around(const Vector3d& centre, double half_side) {
  return {centre - Vector3d::Constant(half_side), centre + Vector3d::Constant(half_side)};
}

TEST_CASE("the front of a wide thing lies where it is seen, and its normals face the camera",
          "[seen_object][object surface]") {
  // A plane through (0, 0, 0.4) tilted by 45 degrees: z = 0.4 + x + 0.3 y.
  DepthImage depth(kCamera.width, kCamera.height);
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      const Vector3d ray = kCamera.unproject(u, v, 1.0);
      depth(u, v) = static_cast<float>(0.4 / (1 - ray.x() - 0.3 * ray.y()));
    }
  }
  const Rigid3 body_from_camera = some_pose();
  const Vector3d normal = body_from_camera.linear() * Vector3d(1, 0.3, -1).normalized();
  const Vector3d on_plane = body_from_camera * Vector3d(0, 0, 0.4);
  ObjectSurface seen;
  seen.build(depth, {}, kCamera, body_from_camera, box_around(on_plane, 0.03));
  REQUIRE(seen.balls().size() > 100);
  for (const ObjectBall& ball : seen.balls()) {
    CHECK(std::abs((ball.point.cast<double>() - on_plane).dot(normal)) <
          tolerance(1e-6, "floats of half a metre"));
    CHECK((ball.normal.cast<double>() - normal).norm() <
          tolerance(1e-4, "float depth (3e-8 m) over a window of 11 px of 1 mm"));
    // The ball touches the plane from behind.
    CHECK((ball.centre.cast<double>() - on_plane).dot(normal) ==
          Approx(-static_cast<double>(ball.radius)).margin(1e-5));
  }
  CHECK(seen.cloud().size() > 1000);
}

// Errors of a finger's surface (m), around its shaft and at its tip; `covered` is the share of the
// points that got a distance.
struct FingerErrors {
  double median = 0, worst = 0, tip_median = 0;
  double covered = 0;
};

FingerErrors errors_of(const ObjectSurface& seen, const Capsule& finger,
                       const Rigid3& body_from_camera) {
  const Vector3d axis = (finger.b - finger.a).normalized();
  const Vector3d across = axis.unitOrthogonal(), other = axis.cross(across);
  std::vector<double> side, tip;
  int queried = 0;
  const auto query = [&](const Vector3d& x, std::vector<double>& errors) {
    ++queried;
    const auto found = seen.nearest((body_from_camera * x).cast<float>());
    if (found) errors.push_back(std::abs(static_cast<double>(found->distance)));
  };
  for (int k = 0; k < 48; ++k) {
    const double angle = k * std::numbers::pi / 24;
    const Vector3d out = std::cos(angle) * across + std::sin(angle) * other;
    for (int i = 0; i <= 20; ++i) {
      query(finger.a + 0.04 * i / 20 * axis + finger.radius * out, side);
    }
    for (int i = 1; i < 12; ++i) {
      const double up = i * std::numbers::pi / 24;
      query(finger.a + finger.radius * (std::cos(up) * out - std::sin(up) * axis), tip);
    }
  }
  FingerErrors errors;
  errors.covered = static_cast<double>(side.size() + tip.size()) / queried;
  errors.worst = *std::max_element(side.begin(), side.end());
  errors.median = upper_median(side);
  errors.tip_median = upper_median(tip);
  return errors;
}

TEST_CASE("balls stand for the whole finger, on all sides", "[seen_object][object surface]") {
  // A pencil, a finger and a thumb; perpendicular to the view, pointing at the camera, and away
  // from it. Their far ends lie outside of the region.
  for (const double radius : {0.0035, 0.008, 0.012}) {
    for (const double tilt : {0.0, 0.5, 0.9, -0.5}) {
      INFO("radius " << radius << " tilt " << tilt);
      const Vector3d axis(std::cos(tilt) * std::cos(0.4), std::cos(tilt) * std::sin(0.4),
                          -std::sin(tilt));
      const Vector3d tip(-0.03, -0.01, 0.40);
      const Capsule finger{tip, tip + 0.12 * axis, radius};
      const DepthImage depth = test::depth_of({finger}, kCamera);
      const Rigid3 body_from_camera = some_pose();
      ObjectSurface seen;
      seen.build(depth, {}, kCamera, body_from_camera, box_around(body_from_camera * tip, 0.05));
      const FingerErrors errors = errors_of(seen, finger, body_from_camera);
      CHECK(errors.covered == 1.0);
      // A pixel is 1.1 mm; the outline is known to half of one.
      CHECK(errors.median < tolerance(0.00045, "0.4 of a pixel"));
      CHECK(errors.worst < tolerance(0.0018, "one and a half pixels"));
      CHECK(errors.tip_median < tolerance(0.0020, "two pixels: a tip has one disc, not many"));
    }
  }
}

TEST_CASE("what the camera sees is measured, the other side assumed",
          "[seen_object][object surface]") {
  const Capsule finger{{-0.05, 0, 0.4}, {0.05, 0, 0.4}, 0.008};
  ObjectSurface seen;
  seen.build(test::depth_of({finger}, kCamera), {}, kCamera, Rigid3::Identity(),
             box_around({0, 0, 0.4}, 0.05));
  CHECK(seen.nearest(Vector3f(0, 0, 0.391f))->known == Known::kMeasured);
  CHECK(seen.nearest(Vector3f(0, 0, 0.409f))->known == Known::kAssumed);
  // In the next frame nothing is measured.
  const DepthImage nothing(kCamera.width, kCamera.height, std::numeric_limits<float>::quiet_NaN());
  seen.build(nothing, {}, kCamera, Rigid3::Identity(), box_around({0, 0, 0.4}, 0.05), 1.0 / 30);
  CHECK(seen.nearest(Vector3f(0, 0, 0.391f))->known == Known::kUnknown);
  CHECK(seen.nearest(Vector3f(0, 0, 0.409f))->known == Known::kUnknown);
}

// The two principal curvatures (1/m): the eigenvalues except the one of the normal, which is 0.
std::pair<double, double> principal(const SurfaceShape& shape) {
  Eigen::Vector3f v = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f>(shape.curvature).eigenvalues();
  std::sort(v.begin(), v.end(), [](float a, float b) { return std::abs(a) > std::abs(b); });
  return {static_cast<double>(v[0]), static_cast<double>(v[1])};
}

TEST_CASE("the shape of the surface is that of the thing: normal and curvature",
          "[seen_object][object surface][shape]") {
  // A row of balls as dense as pixels makes a finger: curved across, straight along its axis.
  std::vector<ObjectBall> finger;
  for (int i = -40; i <= 40; ++i) {
    const Vector3f centre(0.001f * static_cast<float>(i), 0, 0);
    finger.push_back({centre, {0, 0, -1}, centre, 0.008f, 0.0005f});
  }
  ObjectSurface seen;
  seen.build(finger, box_around({0, 0, 0}, 0.1), {0, 0, -0.4f});
  for (const float outside : {0.0f, 0.002f, -0.003f}) {
    INFO("outside by " << outside);
    const float R = 0.008f + outside;
    const auto side = seen.shape_at({0.0053f, 0.6f * R, -0.8f * R});
    REQUIRE(side.has_value());
    CHECK(side->distance == Approx(outside).margin(tolerance(2e-5, "bumps of 0.5^2 / 16 mm")));
    CHECK((side->normal - Vector3f(0, 0.6f, -0.8f)).norm() <
          tolerance(0.01f, "bumps of 0.02 mm over 8 mm"));
    CHECK(side->sigma == 0.0005f);
    CHECK(side->known == Known::kMeasured);
    CHECK((side->curvature * side->normal).norm() < 1e-2f);
    const auto [most, least] = principal(*side);
    CHECK(most == Approx(1 / static_cast<double>(R)).epsilon(tolerance(0.06, "4 mm of the round")));
    CHECK(std::abs(least) < 0.05 * most);
    // The normal does not change along the finger.
    CHECK((side->curvature * Vector3f::UnitX()).norm() < 0.05 * most);
  }
  // The tip is a sphere.
  const auto tip = seen.shape_at({-0.048f, 0, 0.0001f});
  REQUIRE(tip.has_value());
  CHECK((tip->normal + Vector3f::UnitX()).norm() < 0.02f);
  const auto [most, least] = principal(*tip);
  CHECK(most == Approx(125).epsilon(0.03));
  CHECK(least == Approx(125).epsilon(0.03));
  CHECK_FALSE(seen.shape_at({0, 0.02f, 0}).has_value());
  // At a ball's centre, where the direction outwards is undefined, the front's normal is used.
  CHECK(seen.shape_at({0, 0, 0})->normal.allFinite());
}

TEST_CASE("a flat thing is flat, though it is made of balls",
          "[seen_object][object surface][shape]") {
  const DepthImage depth(kCamera.width, kCamera.height, 0.4f);
  ObjectSurface seen;
  seen.build(depth, {}, kCamera, Rigid3::Identity(), box_around({0, 0, 0.4}, 0.04));
  auto random = test::random_case(4);
  std::uniform_real_distribution<float> where(-0.02f, 0.02f);
  for (int i = 0; i < 200; ++i) {
    // Its other side, 25 mm deeper.
    const auto found = seen.shape_at({where(random), where(random), 0.4255f});
    REQUIRE(found.has_value());
    CHECK(found->known == Known::kAssumed);
    CHECK(found->distance > 0.0004f);
    CHECK(found->distance < tolerance(0.0008f, "dents of 0.2 mm between balls 3 mm apart"));
    CHECK(found->normal.z() > std::cos(0.09f));
    CHECK(principal(*found).first < tolerance(25, "a ball's own is 80 / m"));
  }
}

TEST_CASE("a finger partly behind another keeps its thickness, and a hand on a desk is no desk",
          "[seen_object][object surface]") {
  // The nearer finger hides the lower half of the other's front; that edge is not an outline.
  const Capsule hidden{{-0.06, 0, 0.42}, {0.06, 0, 0.42}, 0.010};
  const Capsule nearer{{-0.06, 0.012, 0.36}, {0.06, 0.012, 0.36}, 0.008};
  ObjectSurface seen;
  seen.build(test::depth_of({hidden, nearer}, kCamera), {}, kCamera, Rigid3::Identity(),
             box_around({0, 0, 0.42}, 0.03));
  double largest = 0;
  for (const ObjectBall& ball : seen.balls()) {
    if (ball.point.z() > 0.39f) largest = std::max(largest, static_cast<double>(ball.radius));
  }
  CHECK(largest > 0.0085);

  // A thing ends where pixels show the room, also at the same depth.
  DepthImage depth(kCamera.width, kCamera.height, 0.4f);
  MaskImage presses(kCamera.width, kCamera.height, 0);
  for (int v = 50; v < 61; ++v) {
    for (int u = 10; u < 150; ++u) presses(u, v) = 255;
  }
  seen.build(depth, presses, kCamera, Rigid3::Identity(), box_around({0, 0, 0.4}, 0.05));
  REQUIRE(!seen.balls().empty());
  for (const ObjectBall& ball : seen.balls()) {
    CHECK(ball.radius < 0.0075);
    CHECK(std::abs(ball.point.y() + 0.0057f) < 0.004f);
  }
}

TEST_CASE("the fattening of things by a matcher is undone", "[seen_object][object surface]") {
  const Capsule thin{{-0.06, 0, 0.4}, {0.06, 0, 0.4}, 0.008};
  Capsule wide = thin;
  wide.radius += 1.0 * 0.4 / kCamera.fx_px;  // by one pixel
  ObjectSurfaceSettings settings;
  settings.balls.fattening = 1.0;
  ObjectSurface seen(settings);
  seen.build(test::depth_of({wide}, kCamera), {}, kCamera, Rigid3::Identity(),
             box_around({0, 0, 0.4}, 0.03));
  std::vector<double> radii;
  for (const ObjectBall& ball : seen.balls()) radii.push_back(static_cast<double>(ball.radius));
  REQUIRE(!radii.empty());
  CHECK(upper_median(radii) ==
        Approx(thin.radius).margin(tolerance(6e-4, "half a pixel: it lies along the rows")));
}

TEST_CASE("outlines that a matcher does not fatten are not made thinner",
          "[seen_object][object surface]") {
  // 17 px wide.
  const Capsule thing{{-0.06, 0, 0.4}, {0.06, 0, 0.4}, 0.0097};
  const DepthImage depth = test::depth_of({thing}, kCamera);
  MaskImage shows(kCamera.width, kCamera.height, kShowsRoom);
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      if (depth(u, v) > 0) shows(u, v) = kShowsPresser;
    }
  }
  const auto radius = [&](double by_color, double beside_unknown, std::uint8_t room,
                          double by_edge = 0) {
    ObjectSurfaceSettings settings;
    settings.balls.fattening = 1.5;
    settings.silhouette.by_color = by_color;
    settings.silhouette.beside_unknown = beside_unknown;
    settings.silhouette.by_edge = by_edge;
    for (std::uint8_t& s : shows) s = s == kShowsPresser ? s : room;
    // The room has a depth unless it is unknown.
    DepthImage whole = depth;
    for (std::size_t i = 0; i < whole.size() && room != kShowsUnknown; ++i) {
      if (!(whole.data()[i] > 0)) whole.data()[i] = 0.6f;
    }
    ObjectSurface seen(settings);
    seen.build(whole, shows, kCamera, Rigid3::Identity(), box_around({0, 0, 0.4}, 0.03));
    std::vector<double> radii;
    for (const ObjectBall& ball : seen.balls()) radii.push_back(static_cast<double>(ball.radius));
    REQUIRE(!radii.empty());
    return upper_median(radii);
  };
  const double px = 0.4 / kCamera.fx_px;
  const double thin = radius(1, 1, kShowsRoom);
  CHECK(radius(1, 0, kShowsRoomByColor) ==
        Approx(thin + px).margin(tolerance(2e-4, "1/8 px: perspective")));
  CHECK(radius(1, 0, kShowsRoomByEdge, 0.5) ==
        Approx(thin + 0.5 * px).margin(tolerance(2e-4, "1/8 px: perspective")));
  CHECK(radius(0, 1, kShowsUnknown) ==
        Approx(thin + px).margin(tolerance(2e-4, "1/8 px: perspective")));
}

TEST_CASE("the fronts of thin things are moved nearer by the setting too_far",
          "[seen_object][object surface]") {
  const Capsule thin{{-0.06, 0, 0.4}, {0.06, 0, 0.4}, 0.008};
  const auto front = [&](double too_far) {
    ObjectSurfaceSettings settings;
    settings.balls.too_far = too_far;
    ObjectSurface seen(settings);
    seen.build(test::depth_of({thin}, kCamera), {}, kCamera, Rigid3::Identity(),
               box_around({0, 0, 0.4}, 0.03));
    std::vector<double> z;
    for (const ObjectBall& ball : seen.balls()) z.push_back(static_cast<double>(ball.point.z()));
    REQUIRE(!z.empty());
    return upper_median(z);
  };
  CHECK(1 / front(0.006) - 1 / front(0) == Approx(0.006).margin(1e-5));
}

TEST_CASE("a finger's end is located to a fraction of a pixel", "[seen_object][object surface]") {
  // Measured behind the end, where the camera does not see it: 45 degrees off the axis.
  double sum = 0;
  constexpr int kPlaces = 8;
  for (int k = 0; k < kPlaces; ++k) {
    const double end = 0.02 + static_cast<double>(k) / kPlaces * 0.4 / kCamera.fx_px;
    const Capsule finger{{-0.06, 0, 0.4}, {end, 0, 0.4}, 0.008};
    ObjectSurface seen;
    seen.build(test::depth_of({finger}, kCamera), {}, kCamera, Rigid3::Identity(),
               box_around({end, 0, 0.4}, 0.03));
    const double off = finger.radius * std::numbers::sqrt2 / 2;
    const auto found = seen.nearest(Vector3d(end + off, 0, 0.4 + off).cast<float>());
    REQUIRE(found.has_value());
    sum += static_cast<double>(found->distance);
  }
  CHECK(std::abs(sum / kPlaces) <
        tolerance(4.5e-4, "0.4 px; 0.59 mm if the last ball is not moved"));
}

// The share of each pixel that shows a thing, from 8 x 8 rays.
Image<float> shares_of(const std::vector<Capsule>& things) {
  constexpr int kRays = 8;
  // Pixel x of kCamera holds the pixels 8 x to 8 x + 7 of this one, with the middle at 8 x + 3.5.
  constexpr double kMiddle = 0.5 * (kRays - 1);
  const PinholeCamera fine{kRays * kCamera.width,           kRays * kCamera.height,
                           kRays * kCamera.fx_px,           kRays * kCamera.fy_px,
                           kRays * kCamera.cx_px + kMiddle, kRays * kCamera.cy_px + kMiddle};
  const DepthImage depth = test::depth_of(things, fine);
  Image<float> shares(kCamera.width, kCamera.height);
  for (int v = 0; v < fine.height; ++v) {
    for (int u = 0; u < fine.width; ++u) {
      if (std::isfinite(depth(u, v))) shares(u / kRays, v / kRays) += 1.0f / (kRays * kRays);
    }
  }
  return shares;
}

TEST_CASE("a finger whose share of each pixel is known is as wide and as thick as it is",
          "[seen_object][object surface]") {
  for (const double slant : {0.0, 0.2, 0.4, 0.6, std::numbers::pi / 4}) {
    INFO("slant " << slant);
    const Vector3d axis(std::cos(slant), std::sin(slant), 0), across(-axis.y(), axis.x(), 0);
    const Vector3d middle(0.0004, 0.0002, 0.4);  // its outlines lie between pixels
    const Capsule finger{middle - 0.06 * axis, middle + 0.06 * axis, 0.008};
    const Image<float> shares = shares_of({finger});
    const DepthImage depth = test::depth_of({finger}, kCamera);
    MaskImage shows(kCamera.width, kCamera.height);
    for (std::size_t i = 0; i < shows.size(); ++i) {
      shows.data()[i] = is_depth(depth.data()[i]) ? kShowsPresser : kShowsRoom;
    }
    ObjectSurface seen;
    seen.build(depth, shows, kCamera, Rigid3::Identity(), box_around(middle, 0.03), 0, &shares);
    for (const Vector3d& out : {across, Vector3d(-across), Vector3d(0, 0, 1)}) {
      INFO("outwards " << out.transpose());
      double sum = 0, worst = 0;
      constexpr int kPlaces = 40;
      for (int k = 0; k < kPlaces; ++k) {
        const double along = 0.02 * (2.0 * k / (kPlaces - 1) - 1);
        const auto found =
            seen.nearest((middle + along * axis + finger.radius * out).cast<float>());
        REQUIRE(found.has_value());
        sum += static_cast<double>(found->distance) / kPlaces;
        worst = std::max(worst, std::abs(static_cast<double>(found->distance)));
      }
      CHECK(std::abs(sum) < tolerance(2.5e-4, "0.2 px of 1.14 mm"));
      CHECK(worst < tolerance(5e-4, "0.4 px"));
    }
  }
}

TEST_CASE("the tree finds what looking at every ball finds", "[seen_object][object surface][law]") {
  for (unsigned seed = 0; seed < 6; ++seed) {
    INFO("seed " << seed);
    auto random = test::random_case(seed);
    std::uniform_real_distribution<float> where(-0.08f, 0.08f), wide(-0.14f, 0.14f),
        radius(0.001f, 0.02f);
    std::vector<ObjectBall> balls;
    for (unsigned i = 0; i < 40 + 60 * seed; ++i) {
      const Vector3f y(where(random), where(random) * 0.5f, where(random) * 0.3f);
      const Vector3f n = Vector3f(where(random), where(random), where(random)).normalized();
      const float r = radius(random);
      balls.push_back({y, n, y - r * n, r});
    }
    ObjectSurface seen;
    seen.build(balls,
               Eigen::AlignedBox3d(Vector3d(-0.05, -0.03, -0.02), Vector3d(0.06, 0.02, 0.03)));
    int found = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vector3f x(wide(random), wide(random), wide(random));
      const auto fast = seen.nearest(x);
      const auto slow = seen.nearest_by_brute_force(x);
      REQUIRE(fast.has_value() == slow.has_value());
      if (!fast) continue;
      ++found;
      CHECK(fast->distance == slow->distance);
    }
    CHECK(found > 50);
    CHECK(found < 2000);
  }
}

TEST_CASE("the displacement of a thing is found from its measured part",
          "[seen_object][object surface]") {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> within(-0.01f, 0.01f);
  std::vector<ObjectBall> balls(200);
  for (ObjectBall& ball : balls) {
    ball.point = Vector3f(within(random), within(random), within(random));
    ball.centre = ball.point;
    ball.radius = 0.003f;
  }
  const auto box = box_around(Vector3d::Zero(), 0.05);
  ObjectSurface seen;
  seen.build(balls, box);
  CHECK(std::isinf(seen.moved()));  // has just come
  seen.build(balls, box);
  CHECK(seen.moved() == 0.0);
  std::vector<ObjectBall> guessed = balls;
  for (ObjectBall& ball : guessed) ball.centre.z() -= 0.004f;
  guessed.resize(guessed.size() + 1);
  guessed.back().point = Vector3f(0.03f, 0, 0);
  guessed.back().unseen_for = 0.1f;  // held
  seen.build(guessed, box);
  CHECK(seen.moved() == 0.0);
  const Vector3f way(0.003f, -0.002f, 0.001f);
  for (int frame = 0; frame < 2; ++frame) {
    for (ObjectBall& ball : balls) ball.point += way, ball.centre += way;
    seen.build(balls, box);
  }
  // moved() is 4/3 of the displacement of a thing seen as a whole, and 2/3 for one that is cut off.
  CHECK(seen.moved() > 0.9 * static_cast<double>(way.norm()));
  CHECK(seen.moved() < 1.5 * static_cast<double>(way.norm()));
  seen.build(std::vector<ObjectBall>{}, box);
  CHECK(std::isinf(seen.moved()));
}

TEST_CASE("balls on their way are where they came from, each by its own way",
          "[seen_object][object surface]") {
  std::vector<ObjectBall> balls(2);
  balls[0].centre = Vector3f(0, 0, 0);
  balls[1].centre = Vector3f(0.04f, 0, 0);
  for (ObjectBall& ball : balls) {
    ball.normal = Vector3f::UnitZ();
    ball.point = ball.centre + ball.radius * ball.normal;
  }
  ObjectSurface surface;
  surface.build(balls, Eigen::AlignedBox3d(Vector3d::Constant(-0.2), Vector3d::Constant(0.2)),
                Vector3f(0, 0, 0.5f));
  CHECK(surface.on_the_way(0.5f) == nullptr);  // nothing rubs
  const Vector3f way(0, 0.004f, 0.002f);
  const std::vector<ObjectSurface::BallMotion> motion{{way, 1, false},
                                                      {Vector3f::Zero(), 1, false}};
  surface.set_motion(motion);
  for (const float done : {0.0f, 0.25f, 1.0f}) {
    INFO("done " << done);
    const Obstacles& there = *surface.on_the_way(done);
    const Vector3f moved = balls[0].centre - (1 - done) * way;
    const Vector3f above(0, 0, balls[0].radius + 0.001f);
    CHECK(gap_at(there, moved + above).distance == Approx(0.001).margin(1e-7));
    CHECK((*there.way_of({-1, moved + above}) - done * way).norm() < 1e-9f);
    CHECK(gap_at(there, balls[1].centre + above).distance == Approx(0.001).margin(1e-7));
  }
}

TEST_CASE("a thing that is far from the region makes no balls", "[seen_object][object surface]") {
  const Capsule near{{0, 0, 0.4}, {0, 0, 0.4}, 0.02}, far{{0.1, 0, 0.6}, {0.1, 0, 0.6}, 0.02};
  const DepthImage depth = test::depth_of({near, far}, kCamera);
  ObjectSurface seen;
  seen.build(depth, {}, kCamera, Rigid3::Identity(), box_around({0, 0, 0.4}, 0.01));
  REQUIRE(!seen.balls().empty());
  for (const ObjectBall& ball : seen.balls()) CHECK(ball.point.z() < 0.45f);
  for (const Vector3f& point : seen.cloud()) CHECK(point.z() < 0.45f);
}

TEST_CASE(
    "the cloud is every third pixel of every third row that presses, as deep as in this frame",
    "[seen_object][object surface][Alg1]") {
  const Capsule finger{{0, 0, 0.4}, {0, 0.1, 0.4}, 0.02};
  const DepthImage rests = test::depth_of({finger}, kCamera);
  MaskImage shows(kCamera.width, kCamera.height);
  std::size_t expected = 0;
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      // The lower part has a depth, but shows the room.
      const bool presses = std::isfinite(rests(u, v)) && v < 100;
      shows(u, v) = presses ? kShowsPresser : kShowsRoom;
      if (presses && u % 3 == 0 && v % 3 == 0) ++expected;
    }
  }
  REQUIRE(expected > 100);
  ObjectSurface seen({.step = 3});
  std::mt19937 random(5);
  std::normal_distribution<float> noise(0, 0.001f);
  const Rigid3 pose = some_pose();
  for (int frame = 0; frame < 12; ++frame) {  // the average of 12 frames differs from the last one
    DepthImage depth = rests;
    for (float& z : depth) z += noise(random);
    seen.build(depth, shows, kCamera, pose, box_around(pose * Vector3d(0, 0, 0.4), 0.1),
               frame / 30.0);
    REQUIRE(seen.cloud().size() == expected);
    for (const Vector3f& point : seen.cloud()) {
      const Vector3d x = pose.inverse() * point.cast<double>();
      const Vector3d pixel = x / x.z() * 350 + Vector3d(80, 60, 0);
      const int u = static_cast<int>(std::lround(pixel.x()));
      const int v = static_cast<int>(std::lround(pixel.y()));
      REQUIRE((u % 3 == 0 && v % 3 == 0));
      CHECK(std::abs(x.z() - static_cast<double>(depth(u, v))) <
            tolerance(1e-6, "floats of half a metre"));
    }
  }
}

TEST_CASE("pixels without depth, and single flickering ones, make no balls",
          "[seen_object][object surface]") {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  constexpr float kFar = std::numeric_limits<float>::infinity();
  DepthImage depth(kCamera.width, kCamera.height, kNone);
  depth(20, 20) = kFar;
  depth(30, 30) = 0.0f;
  depth(41, 41) = -0.4f;
  depth(61, 61) = 0.4f;  // alone
  ObjectSurface seen;
  const auto everywhere = box_around({0, 0, 0.4}, 0.5);
  seen.build(depth, {}, kCamera, Rigid3::Identity(), everywhere);
  CHECK(seen.balls().empty());
  CHECK_FALSE(seen.nearest(kCamera.unproject(61, 61, 0.4).cast<float>()).has_value());

  for (float& z : depth) z = 0.6f;
  depth(61, 61) = 0.4f;  // alone in front of a wall
  seen.build(depth, {}, kCamera, Rigid3::Identity(), everywhere);
  REQUIRE(seen.balls().size() > 100);
  for (const ObjectBall& ball : seen.balls()) CHECK(ball.point.z() == Approx(0.6f).epsilon(1e-5));
}

TEST_CASE("the second frame allocates nothing, though it shows more than the first",
          "[seen_object][frame loop]") {
  const auto seen_at = [](double radius) {
    return test::depth_of({{{-0.05, 0, 0.4}, {0.05, 0, 0.4}, radius}}, kCamera);
  };
  const DepthImage first = seen_at(0.006), more = seen_at(0.03);
  ObjectSurface seen;
  const auto region = box_around({0, 0, 0.4}, 0.05);
  seen.build(first, {}, kCamera, Rigid3::Identity(), region);
  const std::size_t balls = seen.balls().size();
  float distance = 0;
  CHECK(test::allocations_during([&] {
          seen.build(more, {}, kCamera, Rigid3::Identity(), region);
          distance = seen.nearest(Vector3f(0, 0, 0.395f))->distance;
        }) == 0);
  CHECK(distance < 0);
  CHECK(seen.balls().size() > 2 * balls);
}

TEST_CASE("a surface refuses a camera of another size and impossible settings",
          "[seen_object][errors]") {
  ObjectSurface seen;
  CHECK_THROWS_AS(
      seen.build(DepthImage(10, 10), {}, kCamera, Rigid3::Identity(), box_around({0, 0, 0}, 1)),
      ContractViolation);
  CHECK_THROWS_AS(seen.build(std::vector<ObjectBall>{}, Eigen::AlignedBox3d()), ContractViolation);
  CHECK_THROWS_AS(ObjectSurface({.step = 0}), ContractViolation);
  CHECK_THROWS_AS(ObjectSurface({.band = 0}), ContractViolation);
  CHECK_THROWS_AS(ObjectSurface({.balls = {.most_radius = 0}}), ContractViolation);
  CHECK_THROWS_AS(ObjectSurface({.balls = {.reach = 0}}), ContractViolation);
  CHECK_THROWS_AS(ObjectSurface({.silhouette = {.largest_jump_at_1m = 0}}), ContractViolation);
  CHECK_THROWS_AS(seen.build(DepthImage(kCamera.width, kCamera.height), MaskImage(3, 3), kCamera,
                             Rigid3::Identity(), box_around({0, 0, 0}, 1)),
                  ContractViolation);
}

}  // namespace
}  // namespace palpable

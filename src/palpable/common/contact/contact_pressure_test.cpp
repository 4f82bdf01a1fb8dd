#include "palpable/common/contact/contact_pressure.h"

#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace palpable {
namespace {

using Eigen::Matrix3Xf;
using Eigen::Vector3d;
using Eigen::Vector3f;
using test::tolerance;

constexpr int kSide = 25;           // vertices of a plate, each way
constexpr double kEdge = 0.004;     // m between them
constexpr double kThick = 0.003;    // m, thickness of the plate
constexpr float kPoints = 0.0025f;  // m between pressed points

// Two sheets that face away from each other, the upper one first.
SurfaceMesh plate() {
  SurfaceMesh skin;
  constexpr int kSheet = kSide * kSide;
  skin.vertices.resize(3, 2 * kSheet);
  skin.triangles.resize(3, 4 * (kSide - 1) * (kSide - 1));
  int t = 0;
  for (int sheet = 0; sheet < 2; ++sheet) {
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        skin.vertices.col(sheet * kSheet + y * kSide + x) =
            Vector3d(kEdge * x, kEdge * y, -kThick * sheet);
      }
    }
    for (int y = 0; y + 1 < kSide; ++y) {
      for (int x = 0; x + 1 < kSide; ++x) {
        const int a = sheet * kSheet + y * kSide + x, b = a + 1, c = b + kSide, d = a + kSide;
        if (sheet == 0) {
          skin.triangles.col(t++) = Eigen::Vector3i(a, b, c);
          skin.triangles.col(t++) = Eigen::Vector3i(a, c, d);
        } else {
          skin.triangles.col(t++) = Eigen::Vector3i(a, c, b);
          skin.triangles.col(t++) = Eigen::Vector3i(a, d, c);
        }
      }
    }
  }
  return skin;
}

// A square of points of the upper sheet under an even pressure of 20 kPa, scaled with the plate.
TouchPatches pressed_square(float scale = 1) {
  TouchPatches pressed(400);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      pressed.points().push_back({scale * Vector3f(0.028f + kPoints * static_cast<float>(x),
                                                   0.028f + kPoints * static_cast<float>(y), 0),
                                  Vector3f::Zero(), Vector3f(0, 0, -20e3f * kPoints * kPoints),
                                  kPoints * kPoints});
    }
  }
  std::vector<Touch> touches;
  pressed.find(nullptr, touches);
  return pressed;
}

struct Shape {
  SurfaceMesh skin = plate();
  Matrix3Xf vertices, normals;
  explicit Shape(float scale = 1) : vertices(scale * skin.vertices.cast<float>()) {
    normals.resize(3, vertices.cols());
    vertex_normals(vertices, skin.triangles, normals);
  }
  // N
  [[nodiscard]] double force_of(const std::vector<float>& pressure) const {
    SurfaceMesh now = skin;
    now.vertices = vertices.cast<double>();
    const Eigen::VectorXd areas = vertex_areas(now);
    double sum = 0;
    for (Eigen::Index v = 0; v < areas.size(); ++v) {
      sum += areas[v] * static_cast<double>(pressure[static_cast<std::size_t>(v)]);
    }
    return sum;
  }
};

TEST_CASE("even forces give even pressure, which adds up to the forces and stays on its side",
          "[contact]") {
  const Shape shape;
  ContactPressure contact(shape.skin);
  std::vector<float> pressure;
  contact.spread(pressed_square(), shape.vertices, shape.normals, pressure);
  REQUIRE(pressure.size() == 2 * kSide * kSide);
  const double force = 256 * 20e3 * static_cast<double>(kPoints * kPoints);
  CHECK(shape.force_of(pressure) == Approx(force).epsilon(1e-4));
  for (int v = 0; v < kSide * kSide; ++v) {
    const Vector3f x = shape.vertices.col(v);
    const float p = pressure[static_cast<std::size_t>(v)];
    const float beside = std::max(std::abs(x.x() - 0.04675f), std::abs(x.y() - 0.04675f));
    // Inside the square by more than the reach (6 mm), and outside by more than it.
    if (beside < 0.012f) {
      CHECK(std::abs(p - 20e3f) <
            tolerance(0.05, "moire of points 2.5 mm and vertices 4 mm apart") * 20e3);
    }
    if (beside > 0.026f) CHECK(p == 0);
  }
  // The plate is thinner than the reach.
  CHECK(std::all_of(pressure.begin() + kSide * kSide, pressure.end(),
                    [](float p) { return p == 0; }));
}

TEST_CASE("pressure is force per present area", "[contact]") {
  const Shape rest, wider(1.2f);
  ContactPressure contact(rest.skin);
  std::vector<float> pressure, stretched;
  contact.spread(pressed_square(), rest.vertices, rest.normals, pressure);
  contact.spread(pressed_square(1.2f), wider.vertices, wider.normals, stretched);
  const std::size_t middle = 11 * kSide + 11;
  CHECK(wider.force_of(stretched) == Approx(rest.force_of(pressure)).epsilon(1e-4));
  CHECK(std::abs(stretched[middle] - 20e3f / 1.44f) <
        tolerance(0.05, "moire of points and vertices") * 20e3 / 1.44);
}

TEST_CASE("a force that no vertex faces acts on the nearest one, and without forces pressure is 0",
          "[contact]") {
  const Shape shape;
  ContactPressure contact(shape.skin);
  TouchPatches pressed(400);
  std::vector<Touch> touches;
  std::vector<float> pressure;
  pressed.find(nullptr, touches);
  contact.spread(pressed, shape.vertices, shape.normals, pressure);
  CHECK(shape.force_of(pressure) == 0);
  CHECK(pressure.size() == 2 * kSide * kSide);

  // A force along the plate, as on a ridge.
  pressed.points().push_back(
      {Vector3f(0.0405f, 0.0405f, 0), Vector3f::Zero(), Vector3f(-1, 0, 0), kPoints * kPoints});
  pressed.find(nullptr, touches);
  contact.spread(pressed, shape.vertices, shape.normals, pressure);
  CHECK(pressure[10 * kSide + 10] == Approx(1 / (kEdge * kEdge)).epsilon(1e-4));
  CHECK(shape.force_of(pressure) == Approx(1).epsilon(1e-4));

  const TouchPatches square = pressed_square();
  CHECK(test::allocations_during(
            [&] { contact.spread(square, shape.vertices, shape.normals, pressure); }) == 0);
}

}  // namespace
}  // namespace palpable

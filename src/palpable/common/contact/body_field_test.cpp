#include "palpable/common/contact/body_field.h"

#include "tests/support/allocations.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/test.h"

#include <cmath>

namespace palpable {
namespace {

using Eigen::Vector3f;
using test::tolerance;

TEST_CASE("a ball overlaps the body by as much as it reaches beyond its skin", "[contact]") {
  const test::DentedSphere sphere;
  const BodyField field(sphere.body());
  const Vector3f middle(0, 0, 0.05f);
  auto random = test::random_case(1);
  std::normal_distribution<float> some;
  std::uniform_real_distribution<float> away(0.02f, 0.09f), radius(0.001f, 0.03f);
  int overlaps = 0;
  for (int i = 0; i < 3000; ++i) {
    Vector3f d = Vector3f(some(random), some(random), some(random)).normalized();
    d.z() = std::abs(d.z());  // the lower half is held in part
    const float a = away(random), r = radius(random);
    const auto found = field.overlap(middle + a * d, r);
    const double depth = static_cast<double>(r) - static_cast<double>(a) + 0.05;
    // The triangles of 642 vertices lie up to 0.3 mm inside the sphere.
    if (depth < 0) CHECK_FALSE(found);
    if (depth > 4e-4) {
      REQUIRE(found);
      CHECK(found->depth == Approx(depth).margin(tolerance(4e-4, "flat triangles")));
      if (a > 0.03f) CHECK((found->place - (middle + 0.05f * d)).norm() < 0.003f);
      ++overlaps;
    }
  }
  CHECK(overlaps > 500);
}

TEST_CASE("a ball at the support does not overlap, and a query allocates nothing", "[contact]") {
  const BodyField field(test::DentedSphere{}.body());
  CHECK_FALSE(field.overlap({0, 0, -0.002f}, 0.006f));
  std::optional<BodyField::Overlap> found;
  CHECK(test::allocations_during([&] { found = field.overlap({0, 0, 0.104f}, 0.008f); }) == 0);
  REQUIRE(found);
  CHECK_FALSE(field.overlap({0, 0, 0.5f}, 0.008f));
  CHECK(
      field.overlap({0, 0, 0.5f}, 0.45f));  // a huge ball whose centre is far outside of the table
}

}  // namespace
}  // namespace palpable

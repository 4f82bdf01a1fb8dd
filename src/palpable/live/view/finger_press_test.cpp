#include "palpable/live/view/finger_press.h"

#include "palpable/common/base/contract.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/some_touch_tables.h"
#include "tests/support/test.h"

#include <cmath>
#include <cstddef>
#include <memory>

namespace palpable {
namespace {

std::shared_ptr<const TouchableBody> sphere_with_tables() {
  const ReducedBody body = test::DentedSphere{}.body();
  return std::make_shared<const TouchableBody>(body, test::yielding_tables(body.surface));
}

TEST_CASE("a finger presses where it is put, deeper with its level, and leaves no trace",
          "[view][finger_press]") {
  const auto body = sphere_with_tables();
  FingerPress finger(body);
  const Eigen::Matrix3Xf rest = *finger.look().vertices;
  CHECK(rest.isApprox(body->body.surface.vertices.cast<float>()));
  CHECK(finger.force() == 0);
  // Between sites: any vertex in the upper half.
  Eigen::Index vertex = 0;
  body->body.surface.vertices.row(1).minCoeff(&vertex);
  const FingerPress::Place place = finger.place_at(body->body.surface.vertices.col(vertex));
  CHECK(place.inwards.y() > 0.9);
  CHECK(place.inwards.norm() == Approx(1));
  double force = 0, depth = 0;
  for (const double level : {0.25, 0.5, 1.0}) {
    INFO("level " << level);
    for (int i = 0; i < 20 && (i == 0 || finger.moving()); ++i) finger.press(place, level);
    CHECK_FALSE(finger.moving());
    CHECK(finger.level() == level);
    CHECK(finger.force() > force);
    const double moved =
        static_cast<double>(((*finger.look().vertices).col(vertex) - rest.col(vertex))
                                .dot(place.inwards.cast<float>()));
    // The finger touches this point first, because its tip is a sphere. By the solver's softness it
    // enters the skin by a hundredth of the displacement of this point alone
    // (TouchSettings::softness).
    CHECK(moved > depth);
    CHECK(moved <= finger.push() + 1e-6);
    CHECK(moved > 0.9 * finger.push());
    CHECK(finger.push() <= level * FingerPress::kDeepest);
    force = finger.force();
    depth = moved;
  }
  CHECK(finger.cauchy().size() == 6 * finger.look().scalar.size());
  CHECK(finger.contact_pressure().size() == finger.look().scalar.size());
  CHECK(finger.contact_pressure()[static_cast<std::size_t>(vertex)] > 0);
  // The same point of the skin, queried at its displaced position.
  const FingerPress::Place again =
      finger.place_at(finger.look().vertices->col(vertex).cast<double>());
  CHECK((again.point - place.point).norm() < 1e-6);
  finger.rest();
  CHECK(*finger.look().vertices == rest);
  CHECK(finger.force() == 0);
}

TEST_CASE("a body without tables of touch has no finger", "[view][finger_press]") {
  CHECK_THROWS_AS(FingerPress(std::make_shared<const TouchableBody>(test::DentedSphere{}.body())),
                  ContractViolation);
}

}  // namespace
}  // namespace palpable

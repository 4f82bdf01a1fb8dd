#include "palpable/live/view/painted_stress.h"

#include "palpable/common/reduced/reduced_body.h"
#include "palpable/live/view/show_names.h"
#include "tests/support/allocations.h"
#include "tests/support/bodies.h"
#include "tests/support/test.h"

#include <array>
#include <set>
#include <string>
#include <vector>

namespace palpable {
namespace {

using Component = SceneShow::Component;
using Field = SceneShow::Field;

// xx yy zz xy yz zx of three vertices: pressed from all sides, pulled along z, sheared.
const std::vector<float> kSix{-300, -300, -300, 0,  0,  0,  //
                              0,    0,    600,  0,  0,  0,  //
                              10,   20,   -60,  40, 50, 60};

std::vector<float> painted(Field field, Component component = Component::kZz) {
  std::vector<float> value;
  painted_stress(field, component, kSix, value);
  return value;
}

TEST_CASE("pressure is above 0 where a body is compressed, and below where it is pulled",
          "[view][painted_stress]") {
  CHECK(painted(Field::kPressure) == std::vector<float>{300, -200, 10});
}

TEST_CASE("each component is painted as it is, by its name", "[view][painted_stress]") {
  const std::array<std::vector<float>, 6> expected{
      {{-300, 0, 10}, {-300, 0, 20}, {-300, 600, -60}, {0, 0, 40}, {0, 0, 50}, {0, 0, 60}}};
  for (std::size_t c = 0; c < 6; ++c) {
    const auto component = static_cast<Component>(c);
    CHECK(painted(Field::kComponent, component) == expected[c]);
    std::string name;
    name_painted_stress(Field::kComponent, component, name);
    CHECK(name == std::string("stress ") + kComponentNames[c]);
  }
  // Their names in the option --paint.
  std::set<std::string> names;
  for (const NamedPaint& paint : kPaints) {
    names.insert(paint.name);
    if (paint.field != Field::kComponent) continue;
    CHECK(paint.name ==
          std::string("s") + kComponentNames[static_cast<std::size_t>(paint.component)]);
  }
  CHECK(names.size() == kPaints.size());
}

TEST_CASE(
    "only pressure and components need the six numbers, and painting them again takes no memory",
    "[view][painted_stress]") {
  CHECK(needs_components(Field::kPressure));
  CHECK(needs_components(Field::kComponent));
  for (const Field field : {Field::kVonMises, Field::kDisplacement, Field::kNone}) {
    CHECK_FALSE(needs_components(field));
  }
  std::vector<float> value;
  painted_stress(Field::kPressure, {}, kSix, value);
  CHECK(test::allocations_during([&] { painted_stress(Field::kPressure, {}, kSix, value); }) == 0);
}

TEST_CASE("a file whose stress is 0 everywhere knows none", "[view][painted_stress]") {
  ReducedBody body = test::pressed_ball(0.05, 0.01, 1);
  CHECK(knows_stress(body));
  body.largest_von_mises = 0;  // as modes of another program without stress
  CHECK_FALSE(knows_stress(body));
}

}  // namespace
}  // namespace palpable

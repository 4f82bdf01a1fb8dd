#include "palpable/live/view/painted_stress.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstddef>

namespace palpable {

bool needs_components(SceneShow::Field field) {
  return field == SceneShow::Field::kPressure || field == SceneShow::Field::kComponent;
}

SceneExtras extras_for(SceneShow::Field field) {
  return {.components = needs_components(field),
          .contact_pressure = field == SceneShow::Field::kContact};
}

bool knows_stress(const ReducedBody& body) { return body.largest_von_mises > 0; }

bool knows_stress(const Session& session, int number) {
  return knows_contact(session, number) || knows_stress(session.body(number).model());
}

bool knows_contact(const Session& session, int number) {
  return session.body(number).response.contact() == ContactKind::kAnywhere;
}

const NamedPaint& paint_named(const std::string& name) {
  const auto found = std::find_if(kPaints.begin(), kPaints.end(),
                                  [&](const NamedPaint& paint) { return paint.name == name; });
  PALPABLE_EXPECT(found != kPaints.end(), "the option takes known names alone");
  return *found;
}

void expect_paintable(const std::string& paint, bool knows_stress, bool knows_contact,
                      const std::filesystem::path& body) {
  const SceneExtras needed = extras_for(paint_named(paint).field);
  if (needed.contact_pressure && !knows_contact) {
    throw Error(
        fmt::format("--paint {}: {} is pressed at its sites here, of which the force alone is "
                    "known; it is known where a body with tables of touch is pressed anywhere",
                    paint, body.string()));
  }
  if (knows_stress || !needed.components) return;
  throw Error(fmt::format("--paint {}: {} holds no stress; displacement or none can be painted",
                          paint, body.string()));
}

void painted_stress(SceneShow::Field field, SceneShow::Component component,
                    std::span<const float> cauchy, std::vector<float>& value) {
  PALPABLE_EXPECT(needs_components(field) && cauchy.size() % 6 == 0,
                  "a field made of six numbers for each vertex");
  value.resize(cauchy.size() / 6);
  if (field == SceneShow::Field::kPressure) {
    for (std::size_t v = 0; v < value.size(); ++v) {
      const float* s = cauchy.data() + 6 * v;
      value[v] = -(s[0] + s[1] + s[2]) / 3.0f;
    }
    return;
  }
  const auto c = static_cast<std::size_t>(component);
  for (std::size_t v = 0; v < value.size(); ++v) value[v] = cauchy[6 * v + c];
}

void name_painted_stress(SceneShow::Field field, SceneShow::Component component,
                         std::string& name) {
  if (field == SceneShow::Field::kPressure) {
    name = "pressure";
    return;
  }
  name = "stress ";
  name += kComponentNames[static_cast<std::size_t>(component)];
}

}  // namespace palpable

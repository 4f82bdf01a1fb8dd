#include "apps/palpable/paint_option.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/live/view/painted_stress.h"

#include <fmt/core.h>

#include <algorithm>
#include <vector>

namespace palpable::app {

void add_paint_option(Command command, std::string& paint) {
  std::vector<std::string> names;
  for (const NamedPaint& known : kPaints) names.emplace_back(known.name);
  command
      .add_option("--paint", paint,
                  "What is painted on bodies: stress (von Mises), pressure (above 0 where it is "
                  "compressed), sxx ... szx: a component of the Cauchy stress along the body's own "
                  "axes, z up (above 0 where it is pulled), contact (how hard things press the "
                  "skin), displacement, or none: the material alone")
      .one_of(names)
      .show_default();
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

}  // namespace palpable::app

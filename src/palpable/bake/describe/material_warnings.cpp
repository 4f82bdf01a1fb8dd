#include "palpable/bake/describe/material_warnings.h"

#include "palpable/bake/describe/body_mesh.h"
#include "palpable/bake/describe/body_problem.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/material/material.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace palpable {
namespace {

// A material with the place where its constants are written.
struct Stated {
  YoungPoisson law;
  const std::string* place;
};

std::vector<Stated> stated_materials(const BodyDescription& description) {
  const auto stated = [](const BodyDescription::MaterialLaw& law) {
    // As typed, where it was: constants would return it with an error of rounding.
    const YoungPoisson typed{law.young, law.poisson};
    return Stated{law.constants.empty() ? typed : young_poisson(material_of(law)), &law.place};
  };
  std::vector<Stated> all{stated(description.material)};
  for (const auto& part : description.groups) all.push_back(stated(part.material));
  using What = BodyDescription::Parameter::What;
  for (const BodyDescription::Parameter& parameter : description.parameters) {
    Stated varied = all[static_cast<std::size_t>(parameter.group + 1)];
    varied.place = &parameter.place;
    const double largest = parameter.values.back();
    if (parameter.what == What::kPoisson) varied.law.poisson = largest;
    if (parameter.what == What::kYoung) varied.law.young = largest;
    if (parameter.what == What::kStiffness) varied.law.young *= largest;
    all.push_back(varied);
  }
  return all;
}

// How many times too large forces come out with 4-node elements: of the block of
// docs/body.md, at the nearest smaller ratio.
double measured_locking(double poisson) {
  struct Measured {
    double poisson, times;
  };
  constexpr std::array kBlock{Measured{kLockingPoisson, 1.2}, Measured{0.49, 1.3},
                              Measured{0.495, 1.5}, Measured{0.499, 2.4}, Measured{0.4999, 10.0}};
  double times = 1.0;
  for (const Measured& measured : kBlock) {
    if (poisson >= measured.poisson) times = measured.times;
  }
  return times;
}

std::string locking_text(const Stated& material, bool has_intrusive) {
  return fmt::format(
      "{}: Poisson's ratio {} with 4-node elements, which lock near 0.5: forces come out some {} "
      "times too large (measured on a block of five edges); write order = 2 in [shape] for 10-node "
      "elements, which do not, and take some twenty times as long on the same edge{}",
      *material.place, poisson_text(material.law.poisson), measured_locking(material.law.poisson),
      has_intrusive
          ? "; a bake with --intrusive takes 4-node elements only: bake this body without "
            "it, or give a smaller Poisson's ratio"
          : "");
}

// Density below which a weight is a gas's, kg/m^3: air has 1.2, the lightest foams have some 10.
constexpr double kLightest = 5.0;
// Osmium has 22600.
constexpr double kDensest = 2.3e4;

void add_gravity_warnings(const BodyDescription& description, std::vector<std::string>& warnings) {
  if (!description.gravity) return;
  const auto& [density, acceleration, place] = *description.gravity;
  if (acceleration.isZero(0.0)) {
    warnings.push_back(fmt::format(
        "{}: its acceleration is 0, so that the density does nothing; leave [gravity] out, or "
        "'acceleration' for 9.81 m/s^2 along -Z",
        place));
  } else if (density < kLightest) {
    warnings.push_back(
        fmt::format("{}: density {} kg/m^3 is that of air: look at its unit (1 g/cm^3 is 1000 "
                    "kg/m^3)",
                    place, number_text(density)));
  } else if (density > kDensest) {
    warnings.push_back(fmt::format(
        "{}: density {} kg/m^3 is above that of osmium: look at its unit (1 g/cm^3 is 1000 kg/m^3)",
        place, number_text(density)));
  }
}

}  // namespace

std::vector<std::string> material_warnings(const BodyDescription& description) {
  std::vector<std::string> warnings;
  const std::vector<Stated> all = stated_materials(description);
  const auto stiffest =
      std::max_element(all.begin(), all.end(),
                       [](const Stated& a, const Stated& b) { return a.law.young < b.law.young; });
  if (stiffest->law.young > kStiffest) {
    warnings.push_back(
        fmt::format("{}: Young's modulus is {}: look at its unit (Pa, kPa, MPa, GPa)",
                    *stiffest->place, stiffness_text(stiffest->law.young)));
  }
  const auto locked = std::max_element(
      all.begin(), all.end(),
      [](const Stated& a, const Stated& b) { return a.law.poisson < b.law.poisson; });
  // Half a rounding error, so that a ratio of 0.48 given by constants counts as 0.48.
  if (locked->law.poisson >= kLockingPoisson - 1e-12 && !is_of_ten_nodes(description.shape)) {
    warnings.push_back(locking_text(*locked, description.intrusive.has_value()));
  }
  add_gravity_warnings(description, warnings);
  return warnings;
}

std::string young_words(const BodyDescription& description) {
  const YoungPoisson law = stated_materials(description).front().law;
  const std::string words = stiffness_text(law.young);
  if (law.poisson < kLockingPoisson) return words;
  return fmt::format("{} (and Poisson's ratio {}, near the 0.5 of a body that keeps its volume)",
                     words, poisson_text(law.poisson));
}

std::string preload_words(const BodyDescription& description) {
  std::string words;
  if (const auto& gravity = description.gravity) {
    words += fmt::format("gravity of {:.4g} m/s^2 on {:.4g} kg/m^3, ", gravity->acceleration.norm(),
                         gravity->density);
  }
  for (const BodyDescription::Pressure& pressure : description.pressures) {
    words += fmt::format("a pressure of {:.4g} Pa, ", pressure.pressure);
  }
  double moved = 0.0;
  for (const BodyDescription::Support& support : description.supports) {
    moved = std::max(moved, support.displacement.norm());
  }
  if (moved > 0.0) words += fmt::format("supports moved by up to {:.4g} mm, ", 1e3 * moved);
  return fmt::format("{}on Young's modulus {}: look at the units of these", words,
                     young_words(description));
}

std::string full_press_text(const BodyDescription& description, const FullPress& press) {
  return fmt::format("full load: up to {:.4g} N; Young's modulus is {}", press.force,
                     young_words(description));
}

std::optional<std::string> absurd_press_text(const BodyDescription& description,
                                             const FullPress& press) {
  // Steel wire bears a sixtieth of its modulus, titanium a ninetieth, window glass far less.
  // Plastics and rubber bear more, and are below 10 GPa.
  constexpr double kHard = 1e10, kBornePart = 1.0 / 50.0;
  // Brain and the softest gels in use have some hundreds of Pa.
  constexpr double kSoftest = 100.0, kFaint = 1e-4;
  if (description.press.force) return std::nullopt;
  const double young = stated_materials(description).front().law.young;
  if (young >= kHard && press.von_mises > kBornePart * young) {
    return fmt::format(
        "a press by depth takes {:.4g} N and a stress of {:.3g} Pa, more than any such material "
        "bears: Young's modulus is {}; look at its unit (Pa, kPa, MPa, GPa), or press less",
        press.force, press.von_mises, young_words(description));
  }
  if (young < kSoftest && press.force < kFaint) {
    return fmt::format(
        "a press by depth takes {:.3g} N only: Young's modulus is {}, less than that of the "
        "softest "
        "gel; look at its unit (Pa, kPa, MPa, GPa)",
        press.force, young_words(description));
  }
  return std::nullopt;
}

std::optional<std::string> hardly_moves_text(const BodyDescription& description,
                                             const Movement& movement) {
  if (!(movement.largest < kHardlyMoves * movement.extent)) return std::nullopt;
  return fmt::format(
      "it hardly moves: by {:.2g} m at most under {:.3g} N, {:.1g} of its size. Young's modulus is "
      "{}; if that is not what was meant, look at its unit and at the force's",
      movement.largest, movement.force, movement.largest / movement.extent,
      young_words(description));
}

}  // namespace palpable

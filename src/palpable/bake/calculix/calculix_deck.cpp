#include "palpable/bake/calculix/calculix_deck.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <variant>
#include <vector>

namespace palpable {

using Eigen::Matrix3Xd;

namespace {

// The number with as many digits as fit into the 20 characters that ccx reads.
std::string number(double value) {
  std::string text;
  for (int digits = 17; digits >= 12; --digits) {
    text = fmt::format("{:.{}g}", value, digits);
    if (text.size() <= 20) break;
  }
  // Without a point ccx would read 5 as an integer in some places and refuse it.
  if (text.find_first_of(".e") == std::string::npos) text += '.';
  return text;
}

void check_input(const SolidModel& model, const Matrix3Xd& load, std::span<const double> levels,
                 bool pressed) {
  check_model(model);
  if (load.cols() != model.mesh.node_count()) {
    throw Error(fmt::format("the load has {} nodal forces and the body {} nodes", load.cols(),
                            model.mesh.node_count()));
  }
  if (!load.allFinite()) throw Error("a nodal force is not finite");
  const std::vector<HeldComponent> held = held_components(model);
  const bool moved = std::any_of(held.begin(), held.end(),
                                 [](const HeldComponent& h) { return h.displacement != 0.0; });
  if (load.isZero(0) && !moved && !pressed) { throw Error("the load is zero; give a force"); }
  double before = 0.0;
  for (const double level : levels) {
    PALPABLE_EXPECT(level > before && std::isfinite(level), "levels are above 0 and increase");
    before = level;
  }
  PALPABLE_EXPECT(!levels.empty(), "at least one level");
}

// 1 / (unit of stress): ccx 2.20 takes a D1 up to this for missing.
constexpr double kMissingD1 = 1e-10;

// Material section of the deck; `unit` is Pa per unit of stress in the deck.
std::string material_section(const Material& material, const std::string& name, double unit) {
  if (const auto* m = std::get_if<SaintVenantKirchhoff>(&material)) {
    const double sum = m->lambda + m->mu;
    return fmt::format("*MATERIAL, NAME={}\n*ELASTIC\n{}, {}\n", name,
                       number(m->mu * (3.0 * m->lambda + 2.0 * m->mu) / sum / unit),
                       number(m->lambda / (2.0 * sum)));
  }
  if (const auto* m = std::get_if<NeoHookeanAbaqus>(&material)) {
    if (m->D1 * unit <= kMissingD1) {
      throw Error(fmt::format(
          "CalculiX would take D1 = {:.3g} 1/Pa of the material {} for missing and set Poisson's "
          "ratio to 0.475: it is {:.3g} in the deck's unit, where {:.0e} is the limit; lower "
          "Poisson's ratio, or take materials that differ less in stiffness, or our solver",
          m->D1, name, m->D1 * unit, kMissingD1));
    }
    return fmt::format("*MATERIAL, NAME={}\n*HYPERELASTIC, NEO HOOKE\n{}, {}\n", name,
                       number(m->C10 / unit), number(m->D1 * unit));
  }
  throw Error(fmt::format(
      "CalculiX has no law like {}; use neo-hooke-abaqus or saint-venant-kirchhoff, or our solver",
      law_name(material)));
}

// Nodes and elements, numbered from 1.
void append_mesh(const TetMesh& mesh, const CalculixUnits& units, std::string& deck) {
  const auto out = std::back_inserter(deck);
  deck += "*NODE, NSET=NALL\n";
  for (int n = 0; n < mesh.node_count(); ++n) {
    const Eigen::Vector3d X = mesh.nodes.col(n) / units.length;
    fmt::format_to(out, "{},{},{},{}\n", n + 1, number(X[0]), number(X[1]), number(X[2]));
  }
  const bool quadratic = mesh.is_quadratic();
  fmt::format_to(out, "*ELEMENT, TYPE={}, ELSET=EALL\n", quadratic ? "C3D10" : "C3D4");
  for (int e = 0; e < mesh.tet_count(); ++e) {
    fmt::format_to(out, "{}", e + 1);
    for (const int v : mesh.tets.col(e)) fmt::format_to(out, ",{}", v + 1);
    if (quadratic) {
      for (const int v : mesh.edge_nodes.col(e)) fmt::format_to(out, ",{}", v + 1);
    }
    deck += '\n';
  }
}

// Elements of no group form the set BODY; the groups are GROUP1, GROUP2, ...
// @param density  in the deck's units; 0: none is stated
void append_materials(const SolidModel& model, const CalculixUnits& units, double density,
                      std::string& deck) {
  const auto out = std::back_inserter(deck);
  const std::vector<int> group_of = material_groups(model);
  for (int g = -1; g < static_cast<int>(model.groups.size()); ++g) {
    if (std::find(group_of.begin(), group_of.end(), g) == group_of.end()) continue;
    const std::string name = g < 0 ? "BODY" : fmt::format("GROUP{}", g + 1);
    const Material& material = g < 0 ? model.material : model.groups[g].material;
    fmt::format_to(out, "*ELSET, ELSET={}\n", name);
    for (std::size_t e = 0; e < group_of.size(); ++e) {
      if (group_of[e] == g) fmt::format_to(out, "{}\n", e + 1);
    }
    deck += material_section(material, name, units.stress);
    if (density > 0) fmt::format_to(out, "*DENSITY\n{}\n", number(density));
    fmt::format_to(out, "*SOLID SECTION, ELSET={0}, MATERIAL={0}\n", name);
  }
}

// The lid: a box of one element, whose nodes and element are numbered after the body's.
void write_lid(const SolidModel& model, const CalculixLid& lid, const CalculixUnits& units,
               std::string& deck) {
  const auto out = std::back_inserter(deck);
  const int N = model.mesh.node_count(), E = model.mesh.tet_count();
  const Eigen::Vector3d back = -lid.normal, u = back.unitOrthogonal(), v = back.cross(u);
  deck += "*NODE, NSET=NLID\n";
  for (int k = 0; k < 8; ++k) {
    // The pressing face first, anticlockwise seen from inside the box.
    const double along_u = k % 4 == 1 || k % 4 == 2 ? 0.5 : -0.5, along_v = k % 4 >= 2 ? 0.5 : -0.5;
    const Eigen::Vector3d x =
        (lid.middle + lid.side * (along_u * u + along_v * v + (k >= 4 ? 1.0 : 0.0) * back)) /
        units.length;
    fmt::format_to(out, "{},{},{},{}\n", N + 1 + k, number(x[0]), number(x[1]), number(x[2]));
  }
  fmt::format_to(out, "*ELEMENT, TYPE=C3D8, ELSET=LID\n{}", E + 1);
  for (int k = 0; k < 8; ++k) fmt::format_to(out, ",{}", N + 1 + k);
  // All nodes of the box have prescribed displacements, so its material has no effect.
  deck += "\n*MATERIAL, NAME=LID\n*ELASTIC\n1000., 0.\n*SOLID SECTION, ELSET=LID, MATERIAL=LID\n";
  deck += "*SURFACE, NAME=SKIN, TYPE=NODE\n";
  for (const int node : boundary_of(model.mesh).node_of_vertex) {
    fmt::format_to(out, "{}\n", node + 1);
  }
  fmt::format_to(out, "*SURFACE, NAME=FACE, TYPE=ELEMENT\n{},S1\n", E + 1);
  // The second number is the tension of an open contact: here a millionth of the shear modulus,
  // which is of order 1e3 in the deck's units.
  fmt::format_to(out,
                 "*SURFACE INTERACTION, NAME=TOUCH\n"
                 "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{},{}\n",
                 number(lid.stiffness * units.length / units.stress), number(1e-3));
  if (lid.friction > 0.0) {
    fmt::format_to(out, "*FRICTION\n{},{}\n", number(lid.friction),
                   number(lid.sticking * units.length / units.stress));
  }
  deck += "*CONTACT PAIR, INTERACTION=TOUCH, TYPE=NODE TO SURFACE\nSKIN,FACE\n";
}

void move_lid(const CalculixLid& lid, int first_node, double last, const CalculixUnits& units,
              std::string& deck) {
  deck += "*BOUNDARY\n";
  for (int k = 0; k < 8; ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      fmt::format_to(std::back_inserter(deck), "{0},{1},{1},{2}\n", first_node + k, axis + 1,
                     number(last * lid.way[axis] / units.length));
    }
  }
}

// The body: its mesh, its materials, and what is held.
void append_body(const SolidModel& model, const CalculixUnits& units, double density,
                 std::string& deck) {
  append_mesh(model.mesh, units, deck);
  append_materials(model, units, density, deck);
}

void append_support(const std::vector<HeldComponent>& held, std::string& deck) {
  deck += "*BOUNDARY\n";
  for (const HeldComponent& h : held) {
    fmt::format_to(std::back_inserter(deck), "{0},{1},{1}\n", h.at / 3 + 1, h.at % 3 + 1);
  }
}

std::string head_of(const CalculixUnits& units) {
  return fmt::format("** Written by Palpable. Lengths in {:g} m, stresses in {:g} Pa.\n",
                     units.length, units.stress);
}

// The beginning of the step: the levels at which results are printed, and the criteria that end an
// iteration or an increment.
void write_step(std::span<const double> levels, double tolerance, std::string& deck) {
  const auto out = std::back_inserter(deck);
  double smallest_step = levels.front(), before = 0.0;
  for (const double level : levels) {
    smallest_step = std::min(smallest_step, level - before);
    before = level;
  }
  deck += "*TIME POINTS, NAME=LEVELS\n";
  for (const double level : levels) fmt::format_to(out, "{}\n", number(level));

  // Loads and displacements are given at the end of the step and grow linearly with time. Where an
  // increment would have to be below a thousandth of the smallest step, ccx gives up.
  fmt::format_to(out, "*STEP, NLGEOM, INC=1000000\n*STATIC\n{},{},{}\n", number(levels.front()),
                 number(levels.back()), number(1e-3 * smallest_step));
  // R_n, C_n, q_0, q_u, R_p, eps, C_eps, R_l. C_n = 1 switches off the test of the last correction.
  // R_l: a residual below it ends the iteration whatever the correction.
  fmt::format_to(out, "*CONTROLS, PARAMETERS=FIELD\n{0:g},1.,,,{0:g},,,{1:g}\n", tolerance,
                 1e-4 * tolerance);
  // I_0, I_R, I_P, I_C: with a tight tolerance, more iterations are allowed than by default before
  // divergence is checked (I_0), convergence counts as slow (I_R) and the increment fails (I_C).
  deck += "*CONTROLS, PARAMETERS=TIME INCREMENTATION\n8,16,9,24\n";
}

// Displacements of supports and nodal forces at the end of the step, i.e. at level `last`.
void write_loads(const Matrix3Xd& full_load, const std::vector<HeldComponent>& held, double last,
                 const CalculixUnits& units, std::string& deck) {
  const auto out = std::back_inserter(deck);
  deck += "*BOUNDARY\n";
  Matrix3Xd load = full_load;
  for (const HeldComponent& h : held) {
    load.reshaped()[h.at] = 0.0;  // a force on a held component has no effect
    if (h.displacement == 0.0) continue;
    fmt::format_to(out, "{0},{1},{1},{2}\n", h.at / 3 + 1, h.at % 3 + 1,
                   number(last * h.displacement / units.length));
  }
  deck += "*CLOAD\n";
  for (Eigen::Index at = 0; at < load.size(); ++at) {
    const double force = load.reshaped()[at];
    if (force == 0.0) continue;
    fmt::format_to(out, "{},{},{}\n", at / 3 + 1, at % 3 + 1, number(last * force / units.force()));
  }
}

}  // namespace

CalculixUnits calculix_units(const SolidModel& model) {
  const auto power_of_ten = [](double value) {
    return std::pow(10.0, std::round(std::log10(value)));
  };
  const double edge = std::cbrt(tet_volumes(model.mesh).mean());
  return {.length = power_of_ten(edge / 1e3),
          .stress = power_of_ten(lame_constants(model.material).mu / 1e3)};
}

std::string calculix_deck(const SolidModel& model, const Matrix3Xd& full_load,
                          std::span<const double> levels, double tolerance,
                          const CalculixLid* lid) {
  check_input(model, full_load, levels, lid != nullptr);
  PALPABLE_EXPECT(tolerance > 0.0 && tolerance < 1.0, "the tolerance is between 0 and 1");
  const CalculixUnits units = calculix_units(model);
  std::string deck = head_of(units) + "** Time is the load level.\n";
  append_body(model, units, 0, deck);
  if (lid != nullptr) write_lid(model, *lid, units, deck);
  const std::vector<HeldComponent> held = held_components(model);
  append_support(held, deck);
  write_step(levels, tolerance, deck);
  write_loads(full_load, held, levels.back(), units, deck);
  if (lid != nullptr) move_lid(*lid, model.mesh.node_count() + 1, levels.back(), units, deck);
  // .dat has seven digits, .frd would have six.
  deck += "*NODE PRINT, NSET=NALL, TIME POINTS=LEVELS\nU\n";
  deck += "*EL PRINT, ELSET=EALL, TIME POINTS=LEVELS\nS\n";
  deck += "*END STEP\n";
  return deck;
}

std::string calculix_frequency_deck(const SolidModel& model, int modes) {
  PALPABLE_EXPECT(modes >= 1, "at least one mode");
  check_model(model);
  const auto refuse = [](const Material& material) {
    if (std::holds_alternative<SaintVenantKirchhoff>(material)) return;
    throw Error(
        fmt::format("the vibration of {} is not asked of CalculiX, only that of "
                    "saint-venant-kirchhoff",
                    law_name(material)));
  };
  refuse(model.material);
  for (const MaterialGroup& group : model.groups) refuse(group.material);
  const CalculixUnits units = calculix_units(model);
  std::string deck = head_of(units);
  append_body(model, units, kFrequencyDeckDensity, deck);
  append_support(held_components(model), deck);
  fmt::format_to(std::back_inserter(deck), "*STEP\n*FREQUENCY\n{}\n*END STEP\n", modes);
  return deck;
}

// K = (stress length) K' and M = (density / density' length^3) M', where ' is in the deck's units.
double calculix_eigenvalue_unit(const SolidModel& model, double density) {
  PALPABLE_EXPECT(density > 0.0 && std::isfinite(density), "a density above 0");
  const CalculixUnits units = calculix_units(model);
  return units.stress * kFrequencyDeckDensity / (density * units.length * units.length);
}

}  // namespace palpable

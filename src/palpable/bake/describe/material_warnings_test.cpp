#include "palpable/bake/describe/material_warnings.h"

#include "palpable/bake/describe/body_problem.h"
#include "palpable/bake/mesh/msh_file.h"
#include "palpable/common/base/error.h"
#include "palpable/common/geometry/tet_mesh.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <string>
#include <tuple>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;

// A description of a block of 60 mm whose file has 4-node tetrahedra, or 10-node ones.
class Block {
 public:
  Block() {
    const TetMesh mesh = box_tets({0, 0, 0}, {0.06, 0.05, 0.04}, 2, 2, 2);
    write_msh_file(folder_.path() / "4.msh", mesh);
    write_msh_file(folder_.path() / "10.msh", with_edge_nodes(mesh));
  }
  [[nodiscard]] BodyDescription description(const std::string& material,
                                            const std::string& shape = "mesh = '4.msh'") const {
    return parse_body_description("name = 'block'\n[shape]\n" + shape + "\n[material]\n" +
                                      material + "\n[sites]\ncount = 1\n",
                                  folder_.path() / "block.toml");
  }
  [[nodiscard]] std::vector<std::string> warnings(
      const std::string& material, const std::string& shape = "mesh = '4.msh'") const {
    return material_warnings(description(material, shape));
  }

 private:
  test::ScratchFolder folder_{"material_warnings"};
};

TEST_CASE("4-node elements near Poisson's ratio 0.5 get a warning with remedy and cost",
          "[describe][material]") {
  const Block block;
  const auto of = [](const std::string& poisson) {
    return "young = '60 kPa'\npoisson = " + poisson;
  };
  for (const char* fine : {"0", "0.3", "0.45", "0.479"}) CHECK(block.warnings(of(fine)).empty());
  for (const char* near : {"0.48", "0.495", "0.4999", "0.49999999"}) {
    const std::vector<std::string> warnings = block.warnings(of(near));
    REQUIRE(warnings.size() == 1);
    CHECK_THAT(warnings[0], Contains("block.toml:4: [material]: Poisson's ratio " +
                                     std::string(near) + " with 4-node") &&
                                Contains("order = 2 in [shape]") && Contains("times as long"));
  }
  CHECK_THAT(block.warnings(of("0.495"))[0], Contains("some 1.5 times too large"));
  CHECK_THAT(block.warnings(of("0.4999"))[0], Contains("some 10 times too large"));
  // Elements with ten nodes do not lock, whether asked for or in the file.
  CHECK(block.warnings(of("0.499"), "mesh = '4.msh'\norder = 2").empty());
  CHECK(block.warnings(of("0.499"), "mesh = '10.msh'").empty());
  // A surface is filled with 4-node ones unless it says otherwise; its file is not read for that.
  CHECK(block.warnings(of("0.499"), "surface = 'none.off'").size() == 1);
  CHECK(block.warnings(of("0.499"), "surface = 'none.off'\norder = 2").empty());
}

TEST_CASE("constants, parts and parameters lock, too", "[describe][material]") {
  const Block block;
  const std::string usual = "young = '60 kPa'\npoisson = 0.4";
  // lambda / (2 (lambda + mu)), mu = 2 C1 and lambda = 2 D1: 0.4950 and 0.4000.
  CHECK_THAT(block.warnings("C1 = '1 kPa'\nD1 = '99 kPa'").at(0),
             Contains("Poisson's ratio 0.495 "));
  CHECK(block.warnings("C1 = '1 kPa'\nD1 = '4 kPa'").empty());
  CHECK_THAT(block
                 .warnings(usual + "\n[[material.group]]\nabove = 0.5\nyoung = '1 kPa'\n"
                                   "poisson = 0.49")
                 .at(0),
             Contains("block.toml:7: [[material.group]]: Poisson's ratio 0.49 "));
  CHECK_THAT(block
                 .warnings(usual + "\n[[parameter]]\nname = 'nu'\nof = 'body'\n"
                                   "poisson = [0.3, 0.4, 0.485]")
                 .at(0),
             Contains("block.toml:7: [[parameter]]: Poisson's ratio 0.485 "));
  CHECK(block.warnings(usual + "\n[[parameter]]\nname = 'E'\nof = 'body'\nstiffness = [1, 2]")
            .empty());
}

TEST_CASE("a modulus above that of diamond is taken for a wrong unit, that of steel is not",
          "[describe][material]") {
  const Block block;
  const auto of = [](const std::string& young) { return "young = '" + young + "'\npoisson = 0.3"; };
  for (const char* real : {"3 kPa", "60 kPa", "210 GPa", "1.05e12 Pa"}) {
    CHECK(block.warnings(of(real)).empty());
  }
  const std::vector<std::string> warnings = block.warnings(of("2100 GPa"));
  REQUIRE(warnings.size() == 1);
  CHECK_THAT(warnings[0],
             Contains("block.toml:4: [material]: Young's modulus is 2.1e+12 Pa, stiffer "
                      "than diamond") &&
                 Contains("unit"));
  try {
    (void)block.description(of("210000 GPa"));
    FAIL("nothing is that stiff");
  } catch (const Error& error) {
    CHECK_THAT(error.what(), Contains("block.toml:5: 'young' in [material] is 2.1e+14 Pa") &&
                                 Contains("diamond") && Contains("unit"));
  }
}

TEST_CASE("a body that hardly moves says so with its stiffness in words", "[describe][material]") {
  const Block block;
  const BodyDescription steel = block.description("young = '210 GPa'\npoisson = 0.3");
  const auto text = hardly_moves_text(steel, {.largest = 4e-10, .extent = 0.06, .force = 1.0});
  REQUIRE(text);
  CHECK_THAT(*text, Contains("4e-10 m") && Contains("under 1 N") &&
                        Contains("2.1e+11 Pa, as of steel") && Contains("unit"));
  // A ten-thousandth of a millimetre of 100 mm is the limit.
  CHECK_FALSE(hardly_moves_text(steel, {.largest = 1.1e-7, .extent = 0.1, .force = 1.0}));
  CHECK(hardly_moves_text(steel, {.largest = 0.9e-7, .extent = 0.1, .force = 1.0}));
}

TEST_CASE("a press by depth whose force cannot be meant names the unit of Young's modulus",
          "[describe][material]") {
  const Block block;
  const auto of = [&](const std::string& young, const std::string& more = "") {
    return block.description("young = '" + young + "'\npoisson = 0.3\n" + more);
  };
  // Ordinary ones: stress up to the modulus on what is soft, up to what metals bear on what is
  // hard.
  const std::vector<std::tuple<const char*, double, double>> usual{
      {"3 kPa", 1e-3, 2e3}, {"200 Pa", 1e-5, 100.0}, {"60 kPa", 0.07, 4e4},  {"5 MPa", 4e4, 4e6},
      {"3 GPa", 1e3, 9e7},  {"70 GPa", 5e3, 5e8},    {"210 GPa", 2.5e4, 2e9}};
  for (const auto& [young, force, stress] : usual) {
    INFO(young);
    CHECK_FALSE(absurd_press_text(of(young), {force, stress}));
    CHECK_THAT(full_press_text(of(young), {force, stress}), Contains("Young's modulus is "));
  }
  CHECK_THAT(absurd_press_text(of("60 GPa"), {2.5e4, 1.43e9}).value(),
             Contains("2.5e+04 N") && Contains("6e+10 Pa") && Contains("unit (Pa, kPa, MPa, GPa)"));
  CHECK_THAT(absurd_press_text(of("1.5 Pa"), {1.8e-6, 1.0}).value(),
             Contains("1.8e-06 N only") && Contains("1.5 Pa") && Contains("unit"));
  // A press by force says by its movement whether the unit is right.
  CHECK_FALSE(absurd_press_text(of("1.5 Pa", "[press]\nforce = '0.001 mN'"), {1e-6, 1.0}));
}

TEST_CASE("a weight of a gas, or without acceleration, gets a warning", "[describe][material]") {
  const Block block;
  const auto of = [&](const std::string& gravity) {
    return block.warnings("young = '60 kPa'\npoisson = 0.3\n[gravity]\n" + gravity);
  };
  for (const char* usual : {"10 kg/m^3", "1000 kg/m^3", "7.85 g/cm^3", "22.5 g/cm^3"}) {
    CHECK(of("density = '" + std::string(usual) + "'").empty());
  }
  CHECK_THAT(of("density = '1.1 kg/m^3'").at(0),
             Contains("block.toml:7: [gravity]: density 1.1 kg/m^3 is that of air") &&
                 Contains("1 g/cm^3 is 1000 kg/m^3"));
  CHECK_THAT(of("density = '50 g/cm^3'").at(0), Contains("osmium"));
  CHECK_THAT(of("density = '1000 kg/m^3'\nacceleration = ['0 m/s^2', '0 m/s^2', '0 m/s^2']").at(0),
             Contains("acceleration is 0"));
  CHECK_THROWS_WITH(of("density = '1100 g/cm^3'"),
                    Contains("'density' in [gravity] is 1.1e+06 kg/m^3") && Contains("osmium"));
}

TEST_CASE("the preload in words names every load, its value and the stiffness",
          "[describe][material]") {
  const Block block;
  const BodyDescription loaded = block.description(
      "young = '60 kPa'\npoisson = 0.4999\n[gravity]\ndensity = '1100 kg/m^3'\n"
      "acceleration = ['0 m/s^2', '0 m/s^2', '-9810 m/s^2']\n[[pressure]]\npressure = '5 MPa'\n"
      "above = 0.99\n[[support]]\nbelow = 0.1\n[[support]]\nabove = 0.9\n"
      "displacement = ['0 mm', '3 m', '0 mm']");
  CHECK_THAT(preload_words(loaded),
             Contains("gravity of 9810 m/s^2 on 1100 kg/m^3") && Contains("5e+06 Pa") &&
                 Contains("supports moved by up to 3000 mm") && Contains("6e+04 Pa") &&
                 Contains("Poisson's ratio 0.4999") && Contains("units"));
  CHECK_THAT(preload_words(block.description("young = '60 kPa'\npoisson = 0.4")),
             Contains("Young's modulus 6e+04 Pa") && !Contains("Poisson") && !Contains("gravity"));
}

TEST_CASE("materials that differ print differently", "[describe][material]") {
  const Block block;
  const auto line = [&](const std::string& material) {
    return material_line(block.description(material).material);
  };
  CHECK_THAT(line("young = '60 kPa'\npoisson = 0.4"),
             Contains("Young's modulus 6e+04 Pa, Poisson's ratio 0.4") && !Contains("0.400"));
  CHECK_THAT(line("young = '60.0001 kPa'\npoisson = 0.4999"),
             Contains("Young's modulus 60000.1 Pa, Poisson's ratio 0.4999"));
  CHECK(line("young = '1 kPa'\npoisson = 0.4999999") !=
        line("young = '1 kPa'\npoisson = 0.4999998"));
  CHECK(line("C1 = '1.23456 kPa'\nD1 = '1 MPa'") != line("C1 = '1.23457 kPa'\nD1 = '1 MPa'"));
}

}  // namespace
}  // namespace palpable

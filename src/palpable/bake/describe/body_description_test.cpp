#include "palpable/bake/describe/body_description.h"

#include "palpable/common/base/error.h"
#include "tests/support/replaced.h"
#include "tests/support/test.h"

#include <fmt/format.h>

#include <string>
#include <variant>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

const std::string kBody = R"(name = "cube"
[shape]
surface = "cube.ply"
height = "10 cm"
edge = "8mm"
up = "x"
[material]
law = "saint-venant-kirchhoff"
young = "0.5 MPa"
poisson = 0.3
[support]
below = 0.05
[sites]
count = 7
above = 0.2
patch = 1
[press]
depth = 0.08
levels = 12
[reduction]
tolerance = 1e-4
max_modes = 50
)";

std::string with(const std::string& what, const std::string& replacement) {
  std::string text = kBody;
  const std::size_t at = text.find(what);
  REQUIRE(at != std::string::npos);
  return text.replace(at, what.size(), replacement);
}

std::string complaint(const std::string& text) {
  try {
    (void)parse_body_description(text, "dir/cube.toml");
  } catch (const Error& error) { return error.what(); }
  return "";
}

TEST_CASE("every key of a description arrives in SI units", "[describe][description]") {
  const BodyDescription body = parse_body_description(kBody, "dir/cube.toml");
  CHECK(body.name == "cube");
  CHECK(body.shape.file == "dir/cube.ply");
  CHECK_FALSE(body.shape.is_volume());
  CHECK(body.shape.up == UpAxis::kX);
  CHECK(std::abs(body.shape.height.value() - 0.1) < 1e-15);
  CHECK(std::abs(body.shape.edge.value() - 0.008) < 1e-15);
  CHECK(body.material.law == "saint-venant-kirchhoff");
  CHECK(body.material.young == 0.5e6);
  CHECK(body.material.poisson == 0.3);
  REQUIRE(body.supports.size() == 1);
  CHECK(std::get<Where::Below>(body.supports[0].where.what).fraction == 0.05);
  CHECK(body.supports[0].held.all());
  CHECK(body.sites.count == 7);
  CHECK(body.sites.above == 0.2);
  CHECK(body.sites.patch == 1);
  CHECK(body.press.depth == 0.08);
  CHECK(body.press.levels == 12);
  CHECK(body.reduction.tolerance == 1e-4);
  CHECK(body.reduction.max_modes == 50);
}

TEST_CASE("a description says how to reduce, and each method has defaults of its own",
          "[describe][description]") {
  const ReductionSettings usual = parse_body_description(kBody, "cube.toml").reduction;
  CHECK(usual.method == ReductionMethod::kPerSite);
  CHECK(usual.weight_snapshots);
  const ReductionSettings paper =
      parse_body_description(with("tolerance = 1e-4", "method = \"pgd\""), "cube.toml").reduction;
  CHECK(paper.method == ReductionMethod::kPgd);
  CHECK(paper.tolerance == 1e-3);
  CHECK_FALSE(paper.weight_snapshots);
  const ReductionSettings given =
      parse_body_description(with("tolerance = 1e-4", "method = \"cp\"\nnorm = \"own\""),
                             "cube.toml")
          .reduction;
  CHECK(given.method == ReductionMethod::kCp);
  CHECK(given.weight_snapshots);
  CHECK_THAT(complaint(with("tolerance = 1e-4", "method = \"svd\"")),
             Contains("cube.toml:21") && Contains("'method' in [reduction]") && Contains("hosvd"));
}

TEST_CASE("what has a default may be left out", "[describe][description]") {
  const BodyDescription body = parse_body_description(
      "name = 'a'\nshape.mesh = '/x/a.msh'\nmaterial = {young = '1 kPa', poisson = 0}\n"
      "sites.count = 1\n",
      "a.toml");
  CHECK(body.shape.file == "/x/a.msh");
  CHECK(body.shape.is_volume());
  CHECK_FALSE(body.shape.height.has_value());
  CHECK(body.material.law == "neo-hookean");
  CHECK(body.press.levels == BodyDescription{}.press.levels);
}

TEST_CASE("the shipped demo body is the one that the issue asks for", "[describe][description]") {
  const BodyDescription body = read_body_description("bodies/bunny-demo.toml");
  CHECK(body.name == "bunny");
  CHECK(body.shape.height.value() == 0.15);
  CHECK(body.material.young == 60e3);
  CHECK(body.material.poisson == 0.4);
  CHECK(body.sites.count >= 12);
  CHECK(body.press.levels >= 10);
  CHECK(body.press.depth == 0.1);
  CHECK(body.reduction.tolerance <= 1e-3);
}

TEST_CASE("an unknown key is refused with the nearest known one", "[describe][description]") {
  CHECK_THAT(
      complaint(with("poisson =", "poison =")),
      StartsWith("dir/cube.toml:10: unknown key 'poison' in [material]; did you mean 'poisson'?"));
  CHECK_THAT(complaint(with("poisson = 0.3", "")),
             StartsWith("dir/cube.toml: 'poisson' in [material] is missing"));
  CHECK_THAT(complaint(with("patch = 1", "patsh = 1")),
             StartsWith("dir/cube.toml:16: unknown key 'patsh' in [sites]; did you mean 'patch'?"));
  CHECK_THAT(complaint(with("[reduction]", "[redcution]")),
             StartsWith("dir/cube.toml:20: unknown key 'redcution'; did you mean 'reduction'?"));
  CHECK_THAT(complaint(kBody + "zzzzz = 1\n"), Contains("known are 'method', 'tolerance', 'norm'"));
}

TEST_CASE("quantities need a unit that fits", "[describe][description]") {
  CHECK_THAT(complaint(with("\"10 cm\"", "0.1")),
             Contains("dir/cube.toml:4: 'height' in [shape] must be a text with a unit, such as "
                      "\"150 mm\""));
  CHECK_THAT(complaint(with("10 cm", "10 kPa")), Contains("'height' in [shape] is \"10 kPa\""));
  CHECK_THAT(complaint(with("10 cm", "10")), Contains("must be a text with a unit"));
  CHECK_THAT(complaint(with("10 cm", "ten cm")), Contains("must be a text with a unit"));
  CHECK_THAT(
      complaint(with("10 cm", "10 yd")),
      Contains("is \"10 yd\", must be a text with a unit, such as \"150 mm\"; the units known "
               "here are m, cm, mm, in, um, ft"));
  CHECK_THAT(complaint(with("0.5 MPa", "0,5 MPa")),
             Contains("is \"0,5 MPa\", has a decimal comma; write 0.5, not 0,5"));
  CHECK_THAT(complaint(with("10 cm", "-1 cm")), Contains("is -0.01, must be above 0"));
  CHECK_THAT(complaint(with("0.5 MPa", "nan MPa")), Contains("must be above 0"));
}

TEST_CASE("values that cannot be are refused", "[describe][description]") {
  CHECK_THAT(complaint(with("poisson = 0.3", "poisson = 0.5")),
             Contains(":10: 'poisson' in [material] is 0.5, must be at least 0 and below 0.5"));
  CHECK_THAT(complaint(with("poisson = 0.3", "poisson = nan")), Contains("must be"));
  CHECK_THAT(complaint(with("below = 0.05", "below = \"5 mm\"")), Contains("without unit"));
  CHECK_THAT(complaint(with("depth = 0.08", "depth = 1.2")), Contains("at most 1"));
  CHECK_THAT(complaint(with("count = 7", "count = 0")), Contains("at least 1"));
  CHECK_THAT(complaint(with("count = 7", "count = 7.5")), Contains("whole number"));
  CHECK_THAT(complaint(with("levels = 12", "levels = 1")), Contains("at least 2"));
  CHECK_THAT(complaint(with("1e-4", "1e-9")), Contains("at least 1e-06"));
  CHECK_THAT(complaint(with("up = \"x\"", "up = \"q\"")), Contains("one of 'x', 'y', 'z'"));
  CHECK_THAT(complaint(with("saint-venant-kirchhoff", "saint-venant-kirchoff")),
             Contains("did you mean 'saint-venant-kirchhoff'?"));
  CHECK_THAT(complaint(with("name = \"cube\"", "name = 3")), Contains("text in quotes"));
  CHECK_THAT(complaint(with("[shape]", "shape = 3\n[shap]")),
             Contains("must be a section [shape]"));
}

TEST_CASE("a shape is either a surface or a mesh", "[describe][description]") {
  CHECK_THAT(complaint(with("surface = \"cube.ply\"", "")), Contains("needs either"));
  CHECK_THAT(complaint(with("up =", "mesh = \"a.msh\"\nup =")), Contains("not both"));
  CHECK_THAT(complaint(with("surface = \"cube.ply\"", "mesh = \"cube.ply\"")),
             Contains("does not end in .msh, .inp, .vtu or .vtk"));
  CHECK_THAT(complaint(with("surface = \"cube.ply\"", "mesh = \"cube.msh\"")),
             Contains("dir/cube.toml:5: 'edge' in [shape] remeshes a surface"));
  for (const char* key : {"wrap", "inner_edge"}) {
    CHECK_THAT(complaint(with("surface = \"cube.ply\"\nheight = \"10 cm\"\nedge = \"8mm\"",
                              std::string("mesh = \"cube.msh\"\n") + key + " = \"2 mm\"")),
               Contains(std::string("'") + key + "' in [shape] is for a surface"));
  }
  CHECK_THAT(complaint(with("edge = \"8mm\"", "wrap = \"2 mm\"")), Contains("give an 'edge'"));
  const BodyDescription body = parse_body_description(
      with("up =", "wrap = \"2 mm\"\ninner_edge = \"2 cm\"\nup ="), "dir/cube.toml");
  CHECK(body.shape.wrap.value() == Approx(0.002).margin(1e-15));
  CHECK(body.shape.inner_edge.value() == Approx(0.02).margin(1e-15));
}

TEST_CASE("a shape's credit has a text, and may have an address and terms",
          "[describe][description]") {
  const BodyDescription body = parse_body_description(
      with("up =",
           "credit = \"A. Carver\"\ncredit_url = \"https://example.org\"\nterms = \"CC0\"\nup ="),
      "cube.toml");
  CHECK(body.shape.credit == "A. Carver");
  CHECK(body.shape.credit_url == "https://example.org");
  CHECK(body.shape.terms == "CC0");
  CHECK(parse_body_description(kBody, "cube.toml").shape.credit.empty());
  CHECK_THAT(complaint(with("up =", "terms = \"CC0\"\nup =")),
             Contains("'terms'") && Contains("there is none"));
  CHECK_THAT(complaint(with("up =", "credit = \"a\"\ncredit_url = \"javascript:x()\"\nup =")),
             Contains("'credit_url'") && Contains("https://"));
}

TEST_CASE("sites are chosen far apart, or where the skin is curved most",
          "[describe][description]") {
  CHECK_FALSE(parse_body_description(kBody, "dir/cube.toml").sites.salient);
  CHECK(
      parse_body_description(with("count = 7", "count = 7\nchoose = \"salient\""), "dir/cube.toml")
          .sites.salient);
  CHECK_THAT(complaint(with("count = 7", "count = 7\nchoose = \"saliant\"")), Contains("salient"));
}

// A description with the given sections; [material] and [sites] of a cube are added where they are
// missing.
std::string described(const std::string& sections, const std::string& shape = "") {
  std::string text = "name = 'a'\n[shape]\nmesh = 'a.inp'\n" + shape;
  if (sections.find("[material]") == std::string::npos) {
    text += "[material]\nyoung = '1 kPa'\npoisson = 0.3\n";
  }
  if (sections.find("[sites]") == std::string::npos) text += "[sites]\ncount = 1\n";
  return text + sections;
}
BodyDescription parsed(const std::string& sections, const std::string& shape = "") {
  return parse_body_description(described(sections, shape), "a.toml");
}
std::string refused(const std::string& sections, const std::string& shape = "") {
  return complaint(described(sections, shape));
}

TEST_CASE("each law takes its own constants instead of Young's modulus",
          "[describe][description]") {
  const auto constants = [](const std::string& keys) {
    return parsed("[material]\n" + keys).material.constants;
  };
  CHECK(constants("C1 = '10 kPa'\nD1 = '20 kPa'\n") == std::vector{10e3, 20e3});
  CHECK(constants("law = 'saint-venant-kirchhoff'\nmu = '3 Pa'\nlambda = '0 Pa'\n") ==
        std::vector{0.0, 3.0});
  CHECK(constants("law = 'neo-hooke-abaqus'\nC10 = '10 kPa'\nD1 = '0.02 1/kPa'\n") ==
        std::vector{10e3, 0.02e-3});
  CHECK(constants("law = 'mooney-rivlin'\nC1 = '4 kPa'\nC2 = '1 kPa'\nD1 = '9 kPa'\n") ==
        std::vector{4e3, 1e3, 9e3});
  CHECK(parsed("").material.constants.empty());

  const auto refusal = [](const std::string& keys) { return refused("[material]\n" + keys); };
  CHECK_THAT(refusal("C1 = '10 kPa'\nyoung = '1 kPa'\n"),
             Contains("dir/cube.toml:8: 'young' in [material] does not go with 'C1'"));
  CHECK_THAT(refusal("C1 = '10 kPa'\n"), Contains("'D1' in [material] is missing"));
  CHECK_THAT(refusal("C1 = '-1 kPa'\nD1 = '20 kPa'\n"),
             Contains(":7: 'C1' in [material] is -1000, must be above 0"));
  CHECK_THAT(refusal("C1 = '1 kPa'\nD1 = '20 1/kPa'\n"), Contains("must be a text with a unit"));
  CHECK_THAT(refusal("law = 'neo-hooke-abaqus'\nC10 = '10 kPa'\nD1 = '20 kPa'\n"),
             Contains("such as \"0.05 1/kPa\""));
  // 2 / D1 - 4/3 C10 is below zero.
  CHECK_THAT(refusal("law = 'neo-hooke-abaqus'\nC10 = '10 kPa'\nD1 = '1 1/kPa'\n"),
             Contains(":8: 'C10' in [material]") && Contains("lambda"));
  CHECK_THAT(refusal("lambda = '1 kPa'\nyoung = '1 kPa'\npoisson = 0\n"),
             Contains("unknown key 'lambda'"));
}

TEST_CASE("parts of the body may be made of something else", "[describe][description]") {
  const BodyDescription body = parsed(
      "[material]\nlaw = 'mooney-rivlin'\nyoung = '1 kPa'\npoisson = 0.3\n"
      "[[material.group]]\nbelow = 0.5\nyoung = '2 kPa'\npoisson = 0.1\n"
      "[[material.group]]\nset = 'CORE'\nlaw = 'neo-hookean'\nC1 = '1 Pa'\nD1 = '1 Pa'\n");
  REQUIRE(body.groups.size() == 2);
  CHECK(body.groups[0].material.law == "mooney-rivlin");  // that of [material]
  CHECK(body.groups[0].material.young == 2e3);
  CHECK(std::get<Where::Below>(body.groups[0].where.what).fraction == 0.5);
  CHECK(body.groups[1].material.law == "neo-hookean");
  CHECK(std::get<Where::Named>(body.groups[1].where.what).name == "CORE");
  CHECK(body.groups[1].where.place == "a.toml:15: 'set' in [[material.group]]");

  const std::string material = "[material]\nyoung = '1 kPa'\npoisson = 0\n[[material.group]]\n";
  CHECK_THAT(refused(material + "young = '1 kPa'\npoisson = 0\n"),
             Contains("dir/cube.toml:9: [[material.group]] does not say which elements"));
  CHECK_THAT(refused(material + "young = '1 kPa'\npoisson = 0.5\nset = 'A'\n"),
             Contains(":11: 'poisson' in [[material.group]] is 0.5"));
  CHECK_THAT(refused(material + "young = '1 kPa'\npoisson = 0\nset = 'A'\nabove = 0.2\n"),
             Contains("'set' in [[material.group]] does not go with 'above'"));
  CHECK_THAT(refused(material + "young = '1 kPa'\npoisson = 0\nset = 'A'\nnaerest = 1\n"),
             Contains("unknown key 'naerest'"));
}

TEST_CASE("supports are places, directions and displacements", "[describe][description]") {
  const BodyDescription body = parsed(
      "[[support]]\nplane = {point = ['0 mm', '0 mm', '1 cm'], normal = [0, 0, 2]}\nhold = 'xz'\n"
      "[[support]]\nbox = {low = ['0 m', '0 m', '0 m'], high = ['1 m', '1 m', '1 m']}\n"
      "displacement = ['0 mm', '0 mm', '-2 mm']\n"
      "[[support]]\nnearest = [['0 m', '0 m', '0 m'], ['0 m', '0 m', '1 m']]\n"
      "[[support]]\nset = 'BASE'\nhold = 'y'\n");
  REQUIRE(body.supports.size() == 4);
  const auto plane = std::get<Where::Plane>(body.supports[0].where.what);
  CHECK(plane.point == Eigen::Vector3d(0, 0, 0.01));
  CHECK(plane.normal == Eigen::Vector3d(0, 0, 1));
  CHECK((body.supports[0].held == Eigen::Array<bool, 3, 1>(true, false, true)).all());
  CHECK(std::get<Where::Box>(body.supports[1].where.what).high == Eigen::Vector3d(1, 1, 1));
  CHECK(body.supports[1].displacement == Eigen::Vector3d(0, 0, -0.002));
  CHECK(std::get<Where::Nearest>(body.supports[2].where.what).points.size() == 2);
  CHECK(std::get<Where::Named>(body.supports[3].where.what).name == "BASE");
  CHECK((body.supports[3].held == Eigen::Array<bool, 3, 1>(false, true, false)).all());
  CHECK(parsed("[support]\nhold = 'z'\n").supports.size() == 1);  // at the default place

  CHECK_THAT(refused("[support]\nhold = 'xq'\n"),
             Contains(":10: 'hold' in [support] is 'xq', must be made of x, y and z"));
  CHECK_THAT(refused("[support]\nhold = 'xx'\n"), Contains("each once at most"));
  CHECK_THAT(refused("[support]\nhold = 'x'\ndisplacement = ['0 m', '1 mm', '0 m']\n"),
             Contains("moves nodes in y, where 'hold' leaves them free"));
  CHECK_THAT(
      refused("[support]\nbox = {low = ['1 m', '0 m', '0 m'], high = ['0 m', '1 m', '1 m']}\n"),
      Contains("'low' in [box] lies above 'high'"));
  CHECK_THAT(refused("[support]\nplane = {point = ['0 m', '0 m', '0 m'], normal = [0, 0, 0]}\n"),
             Contains("'normal' in [plane] has no direction"));
  CHECK_THAT(refused("[support]\nplane = {point = [0, 0, 0], normal = [0, 0, 1]}\n"),
             Contains("'point' in [plane] must be a text with a unit"));
  CHECK_THAT(refused("[support]\nnearest = ['0 m', '0 m']\n"), Contains("three texts with units"));
  CHECK_THAT(refused("[support]\nset = 3\n"), Contains("must be a text in quotes"));
  CHECK_THAT(refused("[[support]]\nbelwo = 0.1\n"),
             Contains("unknown key 'belwo' in [[support]]; did you mean 'below'?"));
}

TEST_CASE("weight and pressures act on a body all the while", "[describe][description]") {
  const BodyDescription body =
      parsed("[gravity]\ndensity = '1.1 g/cm^3'\n[[pressure]]\npressure = '2 kPa'\nabove = 0.9\n");
  CHECK(body.gravity.value().density == Approx(1100));
  CHECK(body.gravity->acceleration == Eigen::Vector3d(0, 0, -9.81));
  REQUIRE(body.pressures.size() == 1);
  CHECK(body.pressures[0].pressure == 2e3);
  CHECK_FALSE(parsed("").gravity.has_value());
  CHECK(
      parsed("[gravity]\ndensity = '1 kg/m^3'\nacceleration = ['1 m/s^2', '0 m/s^2', '0 m/s^2']\n")
          .gravity->acceleration == Eigen::Vector3d(1, 0, 0));
  CHECK_THAT(refused("[gravity]\n"), Contains("'density' in [gravity] is missing"));
  CHECK_THAT(refused("[gravity]\ndensity = '-1 kg/m^3'\n"), Contains("must be above 0"));
  CHECK_THAT(refused("[[pressure]]\npressure = '2 kPa'\n"),
             Contains(":9: [[pressure]] does not say on which faces"));
  CHECK_THAT(refused("[[pressure]]\npressure = '2 N'\nabove = 0.5\n"), Contains("60 kPa"));
}

// The usual body with more keys in [material], and more sections.
BodyDescription heavy(const std::string& material, const std::string& sections = "") {
  return parse_body_description(with("poisson = 0.3\n", "poisson = 0.3\n" + material) + sections,
                                "dir/cube.toml");
}
std::string heavy_refused(const std::string& material, const std::string& sections = "") {
  return complaint(with("poisson = 0.3\n", "poisson = 0.3\n" + material) + sections);
}

TEST_CASE("a density makes a body heavy, wherever it stands", "[describe][description]") {
  CHECK_FALSE(heavy("").inertia.has_value());
  const BodyDescription rubber = heavy("density = '1.07 g/cm^3'\nloss_factor = 0.15\n");
  CHECK(rubber.inertia.value().density == Approx(1070));
  CHECK(rubber.inertia->loss_factor == 0.15);
  CHECK_FALSE(rubber.gravity.has_value());
  CHECK(rubber.touch.modes == 20);
  CHECK(heavy("density = '1070 kg/m3'\n").inertia.value().loss_factor == 0);

  // In [gravity] alone, as in 0.1; with the loss factor in [material].
  const BodyDescription weighed =
      heavy("loss_factor = 0.1\n", "[gravity]\ndensity = '1070 kg/m^3'\n");
  CHECK(weighed.inertia.value().density == Approx(1070));
  CHECK(weighed.inertia->loss_factor == 0.1);
  CHECK(weighed.gravity.value().density == Approx(1070));
  // In [material] alone it serves gravity as well.
  CHECK(heavy("density = '1.07 g/cm^3'\n", "[gravity]\n").gravity.value().density == Approx(1070));
  // In both, the same in other units.
  CHECK(heavy("density = '1.07 g/cm^3'\n", "[gravity]\ndensity = '1070 kg/m^3'\n")
            .inertia.value()
            .density == Approx(1070));
  CHECK_THAT(heavy_refused("density = '1.07 g/cm^3'\n", "[gravity]\ndensity = '1080 kg/m^3'\n"),
             StartsWith("dir/cube.toml:25: 'density' in [gravity] is 1080 kg/m^3") &&
                 Contains("'density' in [material] is 1070 kg/m^3"));

  CHECK_THAT(heavy_refused("density = 1070\n"), Contains("'density' in [material] must be a text"));
  CHECK_THAT(heavy_refused("density = '0 kg/m^3'\n"), Contains("must be above 0"));
  CHECK_THAT(heavy_refused("density = '1070 g/cm^3'\n"), Contains("denser than osmium"));
  CHECK_THAT(heavy_refused("density = '1 g/cm^3'\nloss_factor = 1\n"),
             Contains("'loss_factor' in [material]") && Contains("below 1"));
  CHECK_THAT(heavy_refused("density = '1 g/cm^3'\nloss_factor = -0.1\n"),
             Contains("'loss_factor' in [material]"));
  CHECK_THAT(heavy_refused("loss_factor = 0.1\n"), StartsWith("dir/cube.toml:") &&
                                                       Contains("[material] has a 'loss_factor'") &&
                                                       Contains("no 'density'"));

  CHECK(heavy("", "[touch]\nmodes = 0\n").touch.modes == 0);
  CHECK(heavy("", "[touch]\nmodes = 33\n").touch.modes == 33);
  CHECK_THAT(heavy_refused("", "[touch]\nmodes = 201\n"), Contains("'modes' in [touch]"));
  CHECK_THAT(heavy_refused("", "[touch]\nmodes = -1\n"), Contains("'modes' in [touch]"));
  CHECK_THAT(heavy_refused("", "[touch]\ntables = 'none'\nmodes = 5\n"),
             Contains("'modes' in [touch] is of tables, and there are none"));
}

TEST_CASE("sites are counted, listed as points or named, and pressed in a direction",
          "[describe][description]") {
  using Sites = BodyDescription::Sites;
  CHECK(std::holds_alternative<Sites::ToCentre>(parsed("").sites.direction));
  const BodyDescription points =
      parsed("[sites]\npoints = [['0 mm', '0 mm', '1 mm']]\ndirection = 'normal'\n");
  CHECK(std::holds_alternative<Sites::AlongNormal>(points.sites.direction));
  REQUIRE(points.sites.at.size() == 1);
  CHECK(std::get<Where::Nearest>(points.sites.at[0].what).points[0][2] == 1e-3);
  const BodyDescription sets = parsed("[sites]\nsets = ['EAR', 'NOSE']\ndirection = [0, 0, -3]\n");
  CHECK(sets.sites.at.size() == 2);
  CHECK(std::get<Eigen::Vector3d>(sets.sites.direction) == Eigen::Vector3d(0, 0, -1));

  CHECK_THAT(refused("[sites]\nsets = 'EAR'\ncount = 3\n"),
             Contains(":9: 'count' in [sites] chooses sites, which 'sets' lists"));
  CHECK_THAT(refused("[sites]\nsets = 'EAR'\npoints = []\n"), Contains("give one of the two"));
  CHECK_THAT(refused("[sites]\ncount = 1\ndirection = 'nromal'\n"),
             Contains("did you mean 'normal'?"));
  CHECK_THAT(refused("[sites]\ncount = 1\ndirection = [1, 2]\n"), Contains("three numbers"));
}

TEST_CASE("a press is a fraction of the height, a length or a force", "[describe][description]") {
  CHECK(parsed("[press]\ndepth = 0.2\n").press.depth == 0.2);
  CHECK(parsed("[press]\ndepth = '5 mm'\n").press.length.value() == 0.005);
  CHECK(parsed("[press]\nforce = '2 N'\n").press.force.value() == 2.0);
  CHECK_THAT(refused("[press]\nforce = '2 N'\ndepth = 0.1\n"),
             Contains("'force' in [press] does not go with 'depth'"));
  CHECK_THAT(refused("[press]\nforce = '2 Pa'\n"), Contains("such as \"2 N\""));
  CHECK_THAT(refused("[press]\nforce = '0 N'\n"), Contains("above 0"));
}

TEST_CASE("tables of touch are none, linear or full, with regions in full ones alone",
          "[describe][description]") {
  using Tables = BodyDescription::Touch::Tables;
  const BodyDescription silent = parsed("");
  CHECK((silent.touch.tables == Tables::kFull && silent.touch.by_default));
  CHECK(silent.touch.held_out == 20);
  CHECK_FALSE(parsed("[touch]\ntables = 'full'\n").touch.by_default);
  CHECK(parsed("[touch]\ntables = 'none'\n").touch.tables == Tables::kNone);
  CHECK(parsed("[touch]\nheld_out = 3\n").touch.held_out == 3);
  CHECK(silent.touch.friction == 0);  // as in 0.1
  CHECK(parsed("[touch]\nfriction = 0.6\n").touch.friction == 0.6);
  CHECK_THAT(refused("[touch]\nfriction = -0.1\n"), Contains("friction"));
  CHECK_THAT(refused("[touch]\ntables = 'none'\nheld_out = 3\n"),
             Contains(":11: 'held_out' in [touch] tells how good tables are"));
  CHECK(parsed("[touch]\ntables = 'linear'\n").touch.tables == Tables::kLinear);
  const BodyDescription full = parsed("[touch]\ntables = 'full'\nregions = 12\n");
  CHECK(full.touch.tables == Tables::kFull);
  CHECK(full.touch.regions == 12);
  CHECK_FALSE(parsed("[touch]\ntables = 'full'\n").touch.regions.has_value());
  CHECK_FALSE(full.touch.cross_modes.has_value());
  CHECK(parsed("[touch]\ncross_modes = 96\n").touch.cross_modes == 96);
  CHECK_THAT(refused("[touch]\ncross_modes = 90\n"), Contains("multiple of 16"));
  CHECK_THAT(refused("[touch]\ncross_modes = 208\n"), Contains("at most 192"));
  CHECK_THAT(refused("[touch]\ntables = 'linear'\ncross_modes = 96\n"),
             Contains(":11: 'cross_modes' in [touch] is for tables = \"full\""));
  const BodyDescription::Touch small =
      parsed("[touch]\nclusters = 64\ncluster_modes = 16\nregion_modes = 48\nleading_modes = 12\n")
          .touch;
  CHECK(small.clusters == 64);
  CHECK(small.cluster_modes == 16);
  CHECK(small.region_modes == 48);
  CHECK(small.leading_modes == 12);
  CHECK(parsed("[touch]\ntables = 'linear'\nclusters = 64\n").touch.clusters == 64);
  CHECK_THAT(refused("[touch]\ntables = 'linear'\nregion_modes = 48\n"),
             Contains(":11: 'region_modes' in [touch] is for tables = \"full\""));
  CHECK_THAT(refused("[touch]\ntables = 'none'\nclusters = 64\n"), Contains("there are none"));
  CHECK_THAT(refused("[touch]\ncluster_modes = 24\n"), Contains("multiple of 16"));
  CHECK_THAT(refused("[touch]\nregion_modes = 16\nleading_modes = 17\n"),
             Contains("at most 'region_modes'"));

  CHECK_THAT(refused("[touch]\ntables = 'ful'\n"),
             Contains(":10: 'tables' in [touch]") && Contains("did you mean 'full'?"));
  CHECK_THAT(refused("[touch]\ntables = 'linear'\nregions = 12\n"),
             Contains(":11: 'regions' in [touch] is for tables = \"full\""));
  CHECK_THAT(refused("[touch]\ntables = 'full'\nregions = 0\n"), Contains("at least 1"));
  CHECK_THAT(refused("[touch]\ntable = 'full'\n"), Contains("did you mean 'tables'?"));
  const std::string parameter = "[[parameter]]\nname = 'soft'\nof = 'body'\nstiffness = [1, 2]\n";
  CHECK(parsed(parameter).touch.tables == Tables::kNone);
  CHECK_THAT(refused(parameter + "[touch]\ntables = 'linear'\n"),
             Contains("'tables' in [touch] does not go with [[parameter]]"));
}

TEST_CASE("elements are of order 1 or 2, lengths of a mesh in a unit", "[describe][description]") {
  CHECK_FALSE(parsed("").shape.order.has_value());
  CHECK(parsed("", "order = 2\nunit = 'mm'\n").shape.order.value() == 2);
  CHECK(parsed("", "order = 2\nunit = 'mm'\n").shape.unit == 1e-3);
  CHECK_THAT(
      refused("", "order = 3\n"),
      Contains("dir/cube.toml:4: 'order' in [shape] is 3, must be at least 1 and at most 2"));
  CHECK_THAT(refused("", "unit = 'mm'\nheight = '1 m'\n"), Contains("leave one of the two out"));
}

TEST_CASE("text that is not TOML is refused with its line", "[describe][description]") {
  CHECK_THAT(complaint("name = \"a\"\nshape = [\n"), StartsWith("dir/cube.toml:"));
  CHECK_THAT(complaint(std::string("\xff\xfe\0\1", 4)), StartsWith("dir/cube.toml:1: "));
  CHECK_THAT(complaint(fmt::format("name = \"a\"\nx = {}", test::repeated("[", 60'000))),
             StartsWith("dir/cube.toml:2: nested more than 64 deep"));
  CHECK_THAT(complaint(fmt::format("a{} = 1", test::repeated(".a", 60'000))),
             StartsWith("dir/cube.toml:1: nested more than 64 deep"));
  CHECK_THROWS_WITH(read_body_description("no/such.toml"), Contains("no/such.toml: no such file"));
}

}  // namespace
}  // namespace palpable

#include "palpable/bake/body_description.h"

#include "palpable/base/error.h"
#include "tests/support/test.h"

#include <string>

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

TEST_CASE("every key of a description arrives in SI units", "[bake][description]") {
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
  CHECK(body.support.below == 0.05);
  CHECK(body.sites.count == 7);
  CHECK(body.sites.above == 0.2);
  CHECK(body.sites.patch == 1);
  CHECK(body.press.depth == 0.08);
  CHECK(body.press.levels == 12);
  CHECK(body.reduction.tolerance == 1e-4);
  CHECK(body.reduction.max_modes == 50);
}

TEST_CASE("what has a default may be left out", "[bake][description]") {
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

TEST_CASE("the shipped demo body is the one that the issue asks for", "[bake][description]") {
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

TEST_CASE("an unknown key is refused with the nearest known one", "[bake][description]") {
  CHECK_THAT(
      complaint(with("poisson =", "poison =")),
      StartsWith("dir/cube.toml:10: unknown key 'poison' in [material]; did you mean 'poisson'?"));
  CHECK_THAT(complaint(with("poisson = 0.3", "")),
             StartsWith("dir/cube.toml: 'poisson' in [material] is missing"));
  CHECK_THAT(complaint(with("patch = 1", "patsh = 1")),
             StartsWith("dir/cube.toml:16: unknown key 'patsh' in [sites]; did you mean 'patch'?"));
  CHECK_THAT(complaint(with("[reduction]", "[redcution]")),
             StartsWith("dir/cube.toml:20: unknown key 'redcution'; did you mean 'reduction'?"));
  CHECK_THAT(complaint(kBody + "zzzzz = 1\n"), Contains("known are 'tolerance', 'max_modes'"));
}

TEST_CASE("quantities need a unit that fits", "[bake][description]") {
  CHECK_THAT(complaint(with("\"10 cm\"", "0.1")),
             Contains("dir/cube.toml:4: 'height' in [shape] must be a text with a unit, such as "
                      "\"150 mm\""));
  CHECK_THAT(complaint(with("10 cm", "10 kPa")), Contains("'height' in [shape] is \"10 kPa\""));
  CHECK_THAT(complaint(with("10 cm", "10")), Contains("must be a text with a unit"));
  CHECK_THAT(complaint(with("10 cm", "ten cm")), Contains("must be a text with a unit"));
  CHECK_THAT(complaint(with("10 cm", "-1 cm")), Contains("is -0.01, must be above 0"));
  CHECK_THAT(complaint(with("0.5 MPa", "nan MPa")), Contains("must be above 0"));
}

TEST_CASE("values that cannot be are refused", "[bake][description]") {
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

TEST_CASE("a shape is either a surface or a mesh", "[bake][description]") {
  CHECK_THAT(complaint(with("surface = \"cube.ply\"", "")), Contains("needs either"));
  CHECK_THAT(complaint(with("up =", "mesh = \"a.msh\"\nup =")), Contains("not both"));
  CHECK_THAT(complaint(with("surface = \"cube.ply\"", "mesh = \"cube.ply\"")),
             Contains("does not end in .msh"));
  CHECK_THAT(complaint(with("surface = \"cube.ply\"", "mesh = \"cube.msh\"")),
             Contains("'edge' in [shape] remeshes a surface"));
}

TEST_CASE("text that is not TOML is refused with its line", "[bake][description]") {
  CHECK_THAT(complaint("name = \"a\"\nshape = [\n"), StartsWith("dir/cube.toml:"));
  CHECK_THAT(complaint(std::string("\xff\xfe\0\1", 4)), StartsWith("dir/cube.toml:1: "));
  CHECK_THROWS_WITH(read_body_description("no/such.toml"), Contains("no/such.toml: no such file"));
}

}  // namespace
}  // namespace palpable

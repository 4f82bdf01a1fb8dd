#include "palpable/common/body_file/body_facts.h"

#include "palpable/common/body_file/body_file.h"
#include "tests/support/bodies.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <map>
#include <string>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;

std::map<std::string, std::string> facts_of(const ReducedBody& body) {
  const test::ScratchFolder folder("body_facts");
  const std::filesystem::path file = folder.path() / "ball.palpable";
  write_body_file(file, body);
  std::map<std::string, std::string> facts;
  for (const FactGroup& group : body_facts(body, file, "--set")) {
    CHECK_FALSE(group.heading.empty());
    for (const auto& [name, text] : group.lines) facts[name] = text;
  }
  return facts;
}

TEST_CASE("the facts of a body are those of its closed form", "[body_file][facts]") {
  const ReducedBody ball = test::pressed_ball(0.05, 0.01, 3, 5);
  std::map<std::string, std::string> facts = facts_of(ball);
  CHECK(facts["body"] == "ball");
  CHECK_THAT(facts["file"],
             Contains("ball.palpable, ") && Contains(" MB, version 1 of the format"));
  CHECK_THAT(facts["surface"], Contains("642 vertices, 1280 triangles; "));
  CHECK(facts["levels"] == "4 of the load, and rest");
  CHECK(facts["full load"] == "2 to 2 N per site");
  CHECK_THAT(facts["displacement"],
             Contains("6 modes, up to 1 of its own per site; off by 0 % over all snapshots"));
  CHECK_THAT(facts["between sites"], Contains("what that costs is not known"));
  CHECK(facts["several loads"] == "no: of these, one at a time");
  CHECK(facts["inside"] == "none, the boundary only");
  CHECK(facts["largest stress"] == "1.73 kPa (von Mises)");
  CHECK_FALSE(facts.contains("parameter"));
}

TEST_CASE("the facts include those that only some bodies have", "[body_file][facts]") {
  ReducedBody shared = test::pressed_ball();
  std::vector<ParameterAxis> axes = shared.displacement.axes();
  axes[0].functions.setConstant(0.5);
  shared.displacement = SeparatedField(shared.displacement.modes(), axes);
  CHECK_THAT(facts_of(shared)["displacement"], Contains("6 modes for all sites; off by "));
  CHECK(json_of(shared)["basis"].get<std::string>() == "global");
  const ReducedBody free = test::with_further(test::pressed_ball());
  CHECK(facts_of(free)["parameter"] == "heat: 0 to 1 from 3 samples, 0 unless --set");
  CHECK(facts_of(free)["inside"] == "4 nodes, 1 tetrahedra");
  ReducedBody several = test::with_several(test::pressed_ball());
  several.error.between_sites = 0.25;
  std::map<std::string, std::string> facts = facts_of(several);
  CHECK_THAT(facts["several loads"],
             Contains("yes") && Contains("pushes back at 1, at x ") &&
                 Contains("up to one of 3 N; 4 modes; displacement off by 0.4 % in the "
                          "median of 6 pairs, 2 % in the worst"));
  CHECK(facts["between sites"] == "nothing: the nearest one counts, wrong by 25 % in the median");
}

TEST_CASE("pressures are told in the unit in which they are short", "[body_file][facts]") {
  CHECK(with_larger_pascals("neo-hookean, Young's modulus 6e+04 Pa, Poisson's ratio 0.4") ==
        "neo-hookean, Young's modulus 60 kPa, Poisson's ratio 0.4");
  CHECK(with_larger_pascals("C1 = 1.25e+06 Pa, C2 = 999 Pa, D = 1e-06 1/Pa, E 3e+09 Pa") ==
        "C1 = 1.25 MPa, C2 = 999 Pa, D = 1e-06 1/Pa, E 3 GPa");
  for (const char* same : {"", " Pa", "Pa", "no Pa here", "5000 Paths", "60 kPa"}) {
    CHECK(with_larger_pascals(same) == same);
  }
  // Two materials that differ are told apart.
  CHECK(with_larger_pascals("999999 Pa") == "999.999 kPa");
  CHECK(with_larger_pascals("1e+06 Pa") == "1 MPa");
}

TEST_CASE("the facts of a body are available as JSON numbers", "[body_file][facts]") {
  const Json ball = json_of(test::pressed_ball(0.05, 0.01, 3, 5));
  CHECK(ball["vertices"].get<int>() == 642);
  CHECK(ball["sites"].get<int>() == 6);
  CHECK(ball["levels"].get<int>() == 4);
  CHECK(ball["basis"].get<std::string>() == "per-site");
  CHECK(ball["displacement_modes_per_site"].get<int>() == 1);
  CHECK(ball["several_loads"].is_null());
  CHECK(ball["volume_nodes"].get<int>() == 0);
  CHECK(ball["provenance"]["source"].get<std::string>() == "tests/support/bodies.h");
  CHECK_FALSE(ball.contains("parameters"));
  CHECK_FALSE(ball.contains("between_sites_error"));
  const Json free = json_of(test::with_further(test::pressed_ball()));
  CHECK(free["parameters"]["softness"].dump() ==
        R"({"first":0.5,"last":2.0,"samples":3,"value":1.0})");
  const Json several = json_of(test::with_several(test::pressed_ball()));
  CHECK(several["several_loads"].dump() ==
        R"({"modes":4,"reactions":1,"pairs_checked":6,"error_median":0.004,"error_worst":0.02})");
}

}  // namespace
}  // namespace palpable

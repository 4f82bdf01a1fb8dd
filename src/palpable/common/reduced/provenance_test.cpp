#include "palpable/common/reduced/provenance.h"

#include "palpable/common/reduced/reduced_body.h"
#include "tests/support/bodies.h"
#include "tests/support/test.h"

namespace palpable {
namespace {

using Lines = std::vector<std::pair<std::string, std::string>>;

Provenance full_provenance() {
  return {.description = "a",
          .mesh_source = "b",
          .credit = "x",
          .credit_url = "y",
          .terms = "z",
          .mesh = "c",
          .material = "d",
          .support = "e",
          .preload = "f",
          .preload_moves = 0.1,
          .loads = "g",
          .sites_reached = 7,
          .snapshots = "h",
          .solver = "i",
          .series = "j",
          .reduction = "k",
          .displacement = "l",
          .stress = "m",
          .several_loads = "n",
          .between_sites = "o",
          .modes = "p",
          .errors = "q",
          .touch = "r",
          .stage = BodyStage::kTables,
          .program = "s",
          .command_line = "palpable bake \"\xc3\xa4\".toml",
          .held_out = "u",
          .held_out_values = {{"stiffness", 1.0 / 3.0, "v"}, {"age", 2, "w"}},
          .scaled_by = 0.7,
          .others = {{"note", ""}, {"reduction", "not the member"}}};
}

TEST_CASE("a provenance survives JSON to the bit", "[reduced][provenance]") {
  for (const Provenance& provenance : {full_provenance(), Provenance{}}) {
    const Result<Provenance> again = provenance_of_json(json_of(provenance).dump());
    REQUIRE(again.ok());
    CHECK(again.value() == provenance);
  }
  CHECK(json_of(Provenance{}).dump() == "{}");
  CHECK(json_of(Provenance{.mesh = "fine", .sites_reached = 3}).dump() ==
        R"({"mesh":"fine","sites_reached":3})");
}

TEST_CASE("a body file states its stage unless its bake was finished", "[reduced][provenance]") {
  CHECK(missing_at(BodyStage::kFinished).empty());
  for (const auto& [stage, key] :
       {std::pair{BodyStage::kReduced, "reduced"}, std::pair{BodyStage::kLinear, "linear"},
        std::pair{BodyStage::kTables, "tables"}}) {
    const Provenance provenance{.stage = stage};
    CHECK(json_of(provenance).dump() == std::string(R"({"stage":")") + key + R"("})");
    CHECK(value_or_throw(provenance_of_json(json_of(provenance).dump())) == provenance);
    REQUIRE(lines_of(provenance).size() == 1);
    CHECK(lines_of(provenance)[0].second ==
          "the bake has not ended: " + std::string(missing_at(stage)));
    CHECK_FALSE(missing_at(stage).empty());
  }
  // Of a later program.
  CHECK(value_or_throw(provenance_of_json(R"({"stage":"polished"})")).stage ==
        BodyStage::kFinished);
}

TEST_CASE("a provenance that is not as written is refused, further keys are not",
          "[reduced][provenance][errors]") {
  for (const char* text :
       {"", "{", R"({"mesh":1})", R"({"sites_reached":"x"})", R"({"sites_reached":1e300})",
        R"({"preload_moves":null})", R"({"held_out_values":[{"parameter":"a","value":1}]})",
        R"({"others":[["a"]]})"}) {
    INFO(text);
    const Result<Provenance> result = provenance_of_json(text);
    REQUIRE_FALSE(result.ok());
    CHECK(result.problem().message == "the provenance is damaged");
  }
  const Result<Provenance> later = provenance_of_json(R"({"mesh":"fine","weather":[{"wind":1}]})");
  REQUIRE(later.ok());
  CHECK(later.value() == Provenance{.mesh = "fine"});
}

TEST_CASE("a provenance is shown in one order, with what became of loads and preload",
          "[reduced][provenance]") {
  const Lines lines = lines_of(full_provenance());
  REQUIRE(lines.size() == 30);
  CHECK(lines[1] == std::pair<std::string, std::string>("mesh source", "b"));
  CHECK(lines[3].first == "credit url");
  CHECK(lines[8].second ==
        "f: nodes move by up to 0.1 m. The surface is that of the body so loaded; displacement and "
        "stress are what a press adds");
  CHECK(lines[9] == std::pair<std::string, std::string>("loads", "g; 7 sites reach it"));
  CHECK(lines[24].first == "held out, stiffness = 0.333333333");
  CHECK(lines[26].first == "stage");
  CHECK(lines[27] == std::pair<std::string, std::string>("scaled by", "0.7"));
  CHECK(lines_of({.sites_reached = 7}).empty());
}

// As 0.1 wrote them, for a campaign and for an intrusive bake.
TEST_CASE("lines of older files are read into the members and shown the same",
          "[reduced][provenance]") {
  const Lines old{{"description", "bunny.toml"},
                  {"mesh source", "bunny.ply"},
                  {"material", "neo-hookean"},
                  {"loads", "64 sites; 63 sites reach it"},
                  {"reduction", "per-site (a POD of each site's levels)"},
                  {"between sites", "0.26"},
                  {"program", "palpable 0.1"},
                  {"command line", "palpable bake bunny.toml"},
                  {"held out", "0.001"},
                  {"held out, ears = 0.5", "0.002"},
                  {"scaled by", "2"},
                  {"note", ""},
                  {"held out, ears", "no value"}};
  const Provenance read = provenance_of_lines(old);
  CHECK(lines_of(read) == old);
  CHECK(read.mesh_source == "bunny.ply");
  CHECK(read.command_line == "palpable bake bunny.toml");
  CHECK(read.held_out_values == std::vector<Provenance::HeldOutValue>{{"ears", 0.5, "0.002"}});
  CHECK(read.scaled_by == 2.0);
  CHECK(read.others.size() == 2);
  CHECK(provenance_of_lines({{"body", "beam.toml"}}).description == "beam.toml");
}

TEST_CASE("a body that is scaled twice states the factor of both", "[reduced][provenance]") {
  const ReducedBody body = test::pressed_ball();
  CHECK_FALSE(body.provenance.scaled_by);
  CHECK(scaled(scaled(body, 3), 0.5).provenance.scaled_by == 1.5);
}

}  // namespace
}  // namespace palpable

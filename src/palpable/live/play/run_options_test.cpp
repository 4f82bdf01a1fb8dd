#include "palpable/live/play/run_options.h"

#include "palpable/common/base/error.h"
#include "tests/support/test.h"

#include <string>

namespace palpable {
namespace {

RunOptions through_json(const RunOptions& options) {
  Json json = Json::object();
  add_run_options(options, json);
  return run_options_of(json);
}

TEST_CASE("a recording returns the options of its run", "[play][recording]") {
  RunOptions options;
  options.contact = "paper";
  options.paper = {
      .step = 3, .press_distance = 0.0045, .release_distance = 0.02025, .nodes = "all"};
  options.paper.distance = "voxmap";
  options.matcher = "opencv";
  options.depth = "auto";
  options.farthest = 12;
  options.fixed_camera = true;
  options.press_static = true;
  options.friction = 0.4;
  options.dynamics = true;
  options.refine = "bodies/bunny.toml";
  const RunOptions read = through_json(options);
  CHECK(read.contact == "paper");
  CHECK(read.paper.step == 3);
  CHECK(read.paper.press_distance == 0.0045);
  CHECK(read.paper.release_distance == 0.02025);
  CHECK(read.paper.nodes == "all");
  CHECK(read.paper.distance == "voxmap");
  CHECK(read.matcher == "opencv");
  CHECK(read.depth == "auto");
  CHECK(read.farthest == 12);
  CHECK(read.fixed_camera);
  CHECK(read.press_static);
  CHECK(read.friction == 0.4);
  CHECK(read.dynamics == true);
  CHECK(through_json({}).dynamics == false);  // a recording is of a camera
  CHECK_FALSE(through_json({}).friction);     // that of the bodies' files
  CHECK(read.refine == "bodies/bunny.toml");

  const SessionSettings settings = session_settings(read);
  CHECK(settings.contact == ContactKind::kPaper);
  CHECK(settings.paper.press_distance == 0.0045);
  CHECK(settings.paper.release_distance == 0.02025);
  CHECK(settings.paper.nodes == QueriedNodes::kAll);
  CHECK(settings.paper.distance == DistanceQuery::kVoxmap);
  CHECK(settings.surface.step == 3);
  CHECK(settings.depth.matcher == DepthSettings::Matcher::kOpenCv);
  CHECK(settings.depth.full_up_to_px == 640);
  CHECK(settings.depth.farthest == 12);
  CHECK_FALSE(settings.track);
  CHECK(settings.press_static);
}

TEST_CASE("defaults of the paper's law are recorded as their values", "[play][recording]") {
  RunOptions options;
  CHECK(through_json(options).paper.step == 0);  // another law: nothing is recorded
  options.contact = "paper";
  const PaperOptions paper = through_json(options).paper;
  CHECK(paper.step == ObjectSurfaceSettings{}.step);
  CHECK(paper.press_distance == PaperSettings{}.press_distance);
  CHECK(paper.release_distance == PaperSettings{}.release_distance);
  CHECK(paper.nodes == "sites");
  CHECK(paper.distance == "grid");
}

TEST_CASE("the distances of the paper's law are read from recordings of 0.1, in mm",
          "[play][recording]") {
  RunOptions options;
  options.contact = "paper";
  Json json = Json::object();
  add_run_options(options, json);
  json["paper"] = {{"step", 2},
                   {"press_mm", 4.5},
                   {"release_mm", 20.25},
                   {"nodes", "all"},
                   {"distance", "grid"}};
  const PaperOptions paper = run_options_of(json).paper;
  CHECK(paper.press_distance == 0.0045);
  CHECK(paper.release_distance == 0.02025);
}

TEST_CASE("recordings of earlier versions, without some options, are read", "[play][recording]") {
  const Json early{{"contact", "site"},
                   {"matcher", "census"},
                   {"fixed_camera", false},
                   {"press_static", true},
                   {"refine", ""}};
  const RunOptions options = run_options_of(early);
  CHECK(options.contact == "site");
  CHECK(options.depth.empty());
  CHECK(options.farthest == 0);
  CHECK(options.friction == 0.0);    // they knew none
  CHECK(options.dynamics == false);  // nor inertia
  CHECK_FALSE(session_settings(options).depth.full_resolution);
}

TEST_CASE("options that are not known, or do not fit each other, are refused",
          "[play][recording][refusal]") {
  const auto refusal = [](const auto& change) -> std::string {
    RunOptions options;
    change(options);
    try {
      (void)through_json(options);
    } catch (const Error& error) { return error.what(); }
    return "";
  };
  CHECK(refusal([](RunOptions&) {}).empty());
  CHECK(refusal([](RunOptions& o) { o.contact = "soft"; }) ==
        "its contact is 'soft', which this program does not know");
  CHECK(refusal([](RunOptions& o) { o.matcher = "sgbm"; }) ==
        "its matcher is 'sgbm', which this program does not know");
  CHECK(refusal([](RunOptions& o) { o.depth = "double"; }) ==
        "its depth is 'double', which this program does not know");
  CHECK_THAT(refusal([](RunOptions& o) {
               o.contact = "paper";
               o.paper.nodes = "some";
             }),
             Catch::StartsWith("its --contact paper has step "));
  CHECK(refusal([](RunOptions& o) {
          o.contact = "paper";
          o.paper.press_distance = 0.03;
          o.paper.release_distance = 0.02;
        }) == "--paper-press 30 mm must be above 0 and below --paper-release 20 mm");
  CHECK_THROWS_WITH((PaperOptions{.step = 2}.check("site")),
                    "--paper-step is of --contact paper: give that, too");
  CHECK_NOTHROW(PaperOptions{}.check("anywhere"));
}

}  // namespace
}  // namespace palpable

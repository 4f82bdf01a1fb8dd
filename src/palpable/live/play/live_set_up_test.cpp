#include "palpable/live/play/live_set_up.h"

#include "palpable/common/base/error.h"
#include "palpable/common/body_file/body_file.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/misbehaving_camera.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using test::Act;

// A run with a sphere twice as large as in its file, before a camera that shows nothing.
LiveSetUp set_up(const fs::path& file) {
  const DescribedBody body{.file = file, .scale = 2, .color = Rgb{1, 2, 3}};
  Rigid3 pose = Rigid3::Identity();
  pose.translation() = Eigen::Vector3d(0.1, 0.2, 0.5);
  std::vector<PlacedBody> bodies;
  bodies.push_back({read_live_body(body, "site"), pose, "cup", body.color});
  RunOptions options;
  options.contact = "site";
  auto camera = std::make_unique<test::MisbehavingCamera>(std::vector<Act>{Act::kGood});
  return {
      .run = run_of(std::move(bodies), std::move(camera), session_settings(options), "a camera"),
      .bodies = {body},
      .options = options,
      .scene = "scene.toml",
      .version = "1.2.3"};
}

TEST_CASE("a body is read at its scale, and with tables where the law needs them", "[play]") {
  const test::ScratchFolder folder("read_live_body");
  const fs::path file = folder / "sphere.palpable";
  write_body_file(file, test::DentedSphere{.radius = 0.05}.body());
  const auto height = [&](double scale) {
    const TouchableBody body = read_live_body({.file = file, .scale = scale}, "site");
    return body.body.surface.vertices.row(2).maxCoeff();
  };
  CHECK(height(1) == Approx(0.1));
  CHECK(height(2.5) == Approx(0.25));
  CHECK_THROWS_WITH(read_live_body({.file = file}, "anywhere"),
                    Catch::Contains("has no tables of touch for --contact anywhere"));
}

TEST_CASE("a recording says how its run was set up", "[play][recording]") {
  const test::ScratchFolder folder("recorded_run");
  const fs::path file = folder / "sphere.palpable";
  write_body_file(file, test::DentedSphere{}.body());
  const LiveSetUp setup = set_up(file);
  RecordedRun run = recorded_run_of(json_of_run(setup));
  CHECK(run.version == "1.2.3");
  CHECK(run.source == "a camera");
  CHECK(run.scene == fs::absolute("scene.toml"));
  CHECK(run.options.contact == "site");
  REQUIRE(run.bodies.size() == 1);
  const RecordedRun::Body& body = run.bodies.front();
  CHECK(body.body.file == file);
  CHECK(body.body.name == "cup");
  CHECK(body.body.scale == 2);
  CHECK(body.body.color == Rgb{1, 2, 3});
  CHECK(body.world_from_body.matrix() == setup.run.loop.session.body().world_from_body.matrix());

  // The file is found by its checksum where it is now.
  CHECK_NOTHROW(find_body_files(run, {}));
  const fs::path elsewhere = folder / "elsewhere.palpable";
  fs::rename(file, elsewhere);
  CHECK_THROWS_WITH(find_body_files(run, {}),
                    Catch::Contains("which is not there; name that file"));
  test::write_bytes(file, "another body");
  CHECK_THROWS_WITH(find_body_files(run, {}), Catch::Contains("is another file now (checksum)"));
  CHECK_THROWS_WITH(find_body_files(run, {file.string()}),
                    Catch::Contains("no file of --body is that one (checksum)"));
  find_body_files(run, {file.string(), elsewhere.string()});
  CHECK(run.bodies.front().body.file == elsewhere);
}

TEST_CASE("a recording that does not say how its run was set up is refused",
          "[play][recording][refusal]") {
  const test::ScratchFolder folder("no_recorded_run");
  const fs::path file = folder / "sphere.palpable";
  write_body_file(file, test::DentedSphere{}.body());
  const Json good = json_of_run(set_up(file));
  Json json = good;
  json["bodies"] = Json::array();
  CHECK_THROWS_WITH(recorded_run_of(json), "it says of no body where it stood");
  json = good;
  json["contact"] = "soft";
  CHECK_THROWS_WITH(recorded_run_of(json), Catch::StartsWith("its contact is 'soft'"));
  Json body = std::as_const(good)["bodies"][0];
  for (const double scale : {0.0, 9e-4, 1001.0, 1e308}) {
    body["scale"] = scale;
    json = good;
    json["bodies"] = Json::array({body});
    CHECK_THROWS_WITH(
        recorded_run_of(json),
        fmt::format("the body 'cup' has the scale {}, not within 0.001 and 1000", scale));
  }
  body["checksum"] = "12x";
  json["bodies"] = Json::array({body});
  CHECK_THROWS_WITH(recorded_run_of(json), "'12x' is no checksum");
}

}  // namespace
}  // namespace palpable

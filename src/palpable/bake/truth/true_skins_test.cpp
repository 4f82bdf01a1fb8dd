// A finger that comes down on a rubber block in a clip made by hand.
#include "palpable/bake/truth/true_skins.h"

#include "palpable/bake/campaign/fill_store.h"
#include "palpable/bake/campaign/solid_file.h"
#include "palpable/bake/describe/body_problem.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/body_file/body_file.h"
#include "palpable/desk/clip_files/camera_paths.h"
#include "palpable/desk/clip_files/film_friction.h"
#include "palpable/desk/clip_files/frame_records.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using Catch::Matchers::Contains;
using Eigen::Vector3d;
using test::tolerance;

constexpr double kHeight = 0.06, kRadius = 0.01;

// Depth of the finger in frame n: comes, stays, goes, and comes again.
double depth_at(int n) {
  constexpr double kDepths[] = {-2, 1, 3, 5, 5, 2, -1, -3, 1, 4, 4, -1};  // mm
  return 1e-3 * kDepths[n];
}
constexpr int kFrames = 12;

// @param aside  m: how far beside the block the finger comes down
void write_clip(const fs::path& clip, double aside = 0.0) {
  make_folder(clip / "frames");
  make_folder(clip / "truth");
  write_whole_file(clip / "frames" / "scene.toml",
                   "camera_from_body = [1,0,0,0, 0,0,-1,0, 0,1,0,0.4, 0,0,0,1]\n");
  std::string hands, contacts, poses;
  for (int n = 0; n < kFrames; ++n) {
    const double depth = depth_at(n);
    const double low = kHeight + kRadius - depth;  // of the ball's centre, along the body's Z
    hands += hand_line({n, {{{aside, -low, 0.4}, {aside, -low - 0.1, 0.4}, kRadius, kRadius}}});
    ContactLine contact{.frame = n};
    if (depth > 0) {
      contact = {.frame = n,
                 .touching = true,
                 .depth = depth,
                 .site = -1,
                 .point = Vector3d(0, 0, kHeight)};
    }
    contacts += contact_line(contact);
    StampedPose pose;
    pose.time = n / 30.0;
    poses += trajectory_line(pose);
  }
  write_whole_file(clip / "truth" / "hand.jsonl", hands);
  write_whole_file(clip / "truth" / "contact.jsonl", contacts);
  write_whole_file(clip / "truth" / "trajectory.txt", poses);
}

BodyDescription block(const fs::path& folder) {
  write_ply(folder / "block.ply", box_surface({-0.03, -0.03, 0}, {0.03, 0.03, kHeight}));
  write_whole_file(folder / "block.toml",
                   "name = \"block\"\n[shape]\nsurface = \"block.ply\"\nup = \"z\"\nunit = \"m\"\n"
                   "edge = \"12 mm\"\n[material]\nlaw = \"neo-hookean\"\nyoung = \"60 kPa\"\n"
                   "poisson = 0.3\n[support]\nbelow = 0.03\n[sites]\ncount = 1\nabove = 0.5\n"
                   "patch = 1\n[press]\ndepth = 0.1\nlevels = 2\n");
  return read_body_description(folder / "block.toml");
}

// A minimal reduced body of the block: its skin, with fields that are constant in space.
ReducedBody reduced_block(const BodyProblem& problem) {
  const SurfaceMesh& skin = problem.mesh.boundary.surface;
  const Eigen::Vector2d levels(0, 1);
  const auto field = [&](int components) {
    const ParameterAxis site{"site", Eigen::VectorXd::Zero(1), Eigen::MatrixXd::Ones(1, 1),
                             Between::kNothing};
    const ParameterAxis level{"level", levels, levels, Between::kSmooth};
    const Eigen::MatrixXf modes =
        Eigen::MatrixXf::Constant(components * skin.vertex_count(), 1, 1e-3f);
    return SeparatedField(modes, {site, level});
  };
  ReducedBody body{.name = "block",
                   .surface = skin,
                   .fixed = fixed_vertices(problem.mesh),
                   .sites = problem.sites,
                   .displacement = field(3),
                   .stress = field(6),
                   .press_depth = 1e-3 * levels,
                   .largest_von_mises = 1,
                   .error = {},
                   .material = "a test's",
                   .provenance = {},
                   .method = std::string(kWithoutCampaign)};
  body.sites.front().full_load = 1;
  tabulate_press(body);
  return body;
}

TEST_CASE("the true skin is pressed where the finger is and free where it is not", "[truth]") {
  const test::ScratchFolder folder("true_skins");
  const fs::path clip = folder.path() / "clip";
  // Exactly over the middle of the block the solution is unstable, and rounding decides to which
  // side it tips.
  write_clip(clip, 0.0007);
  const BodyDescription description = block(folder.path());
  const std::vector<TrueFrame> frames = write_true_skins(clip, description, {.frames = 99}, {});
  REQUIRE(frames.size() == 8);

  const fs::path deformed = clip / "truth" / "deformed";
  const ValuedSurface rest = value_or_throw(read_valued_ply(deformed / "rest.ply", "von_mises"));
  CHECK(rest.values.isZero());
  for (const TrueFrame& frame : frames) {
    INFO("frame " << frame.line.frame);
    const double depth = depth_at(frame.line.frame);
    CHECK(frame.line.depth == Approx(depth));
    CHECK(frame.line.scored);
    CHECK(frame.path_change < 1e-3);
    CHECK_FALSE(frame.was_there);
    const ValuedSurface skin = value_or_throw(
        read_valued_ply(deformed_skin_file(deformed, frame.line.frame), "von_mises"));
    CHECK(skin.surface.triangles == rest.surface.triangles);
    const Eigen::Matrix3Xd moves = skin.surface.vertices - rest.surface.vertices;
    CHECK(-moves.row(2).minCoeff() ==
          Approx(depth).epsilon(tolerance(0.3, "no vertex need lie under the tip")));
    CHECK(frame.line.force.z() < 0.0);
    CHECK(frame.line.point->head<2>().norm() < 5e-3);
    CHECK(skin.values.maxCoeff() == Approx(frame.largest_von_mises));
    CHECK(frame.entry <= tolerance(2.1e-4, "points 4 mm apart: spacing^2 / (8 radius)"));
  }
  // The same depth on the way in and after it.
  CHECK(frames[2].line.force.z() == Approx(frames[3].line.force.z()).epsilon(1e-4));

  SECTION("an interrupted run goes on where it was, to the same bytes") {
    const std::vector<DeformedLine> lines = read_deformed_lines(deformed);
    REQUIRE(lines.size() == 8);
    fs::remove(deformed_skin_file(deformed, 9));
    const std::vector<TrueFrame> again = write_true_skins(clip, description, {.frames = 99}, {});
    REQUIRE(again.size() == 8);
    for (const TrueFrame& frame : again) CHECK(frame.was_there == (frame.line.frame != 9));
    CHECK(again[6].line.force == frames[6].line.force);
  }
  SECTION("the truth of another mesh is not mixed in") {
    write_ply(deformed / "rest.ply", box_surface({0, 0, 0}, {1, 1, 1}));
    CHECK_THROWS_WITH(write_true_skins(clip, description, {}, {}),
                      Contains("is the truth of another body") && Contains("rest.ply"));
  }
}

TEST_CASE("a truth with friction is the same on one thread and two, and is not mixed with others",
          "[truth][friction][threads]") {
  const test::ScratchFolder folder("true_skins_friction");
  const BodyDescription description = block(folder.path());
  const auto solve = [&](const char* name, int threads, std::optional<double> friction) {
    return write_true_skins(folder.path() / name, description,
                            {.frames = 99, .threads = threads, .friction = friction}, {});
  };
  for (const char* name : {"one", "two", "none"}) write_clip(folder.path() / name, 0.0007);
  const std::vector<TrueFrame> one = solve("one", 1, 0.3), two = solve("two", 2, 0.3);
  const std::vector<TrueFrame> none = solve("none", 2, std::nullopt);
  REQUIRE(one.size() == 8);
  REQUIRE(two.size() == 8);
  REQUIRE(none.size() == 8);
  double apart = 0.0;
  for (std::size_t k = 0; k < one.size(); ++k) {
    CHECK(one[k].line.force == two[k].line.force);
    CHECK(one[k].largest_displacement == two[k].largest_displacement);
    apart = std::max(apart, (one[k].line.force - none[k].line.force).norm());
  }
  CHECK(apart > 1e-3);
  CHECK(read_film_friction(folder.path() / "one") == 0.3);
  CHECK_FALSE(read_film_friction(folder.path() / "none"));
  // Without the option a later run goes on with what the clip states.
  for (const TrueFrame& frame : solve("one", 2, std::nullopt)) CHECK(frame.was_there);
  CHECK_THROWS_WITH(solve("one", 2, 0.2), Contains("a coefficient of friction of 0.3, and 0.2"));
  CHECK_THROWS_WITH(solve("none", 2, 0.2), Contains("a coefficient of friction of 0, and 0.2"));
  CHECK(read_film_friction(folder.path() / "one") == 0.3);
}

TEST_CASE("another mesh than that of the body that was filmed, or baked, is refused", "[truth]") {
  const test::ScratchFolder folder("true_skins_mesh");
  const fs::path clip = folder.path() / "clip";
  write_clip(clip);
  const BodyDescription description = block(folder.path());
  const auto solve = [&](const fs::path& baked) {
    return write_true_skins(clip, description, {.frames = 1, .baked = baked}, {});
  };
  const BodyProblem problem = pose_body(description);
  SurfaceMesh skin = problem.mesh.boundary.surface;
  const fs::path filmed = clip / "truth" / "body.ply";
  write_ply(filmed, skin);
  CHECK(solve({}).size() == 1);
  skin.vertices(2, 5) += 2e-6 * kHeight;
  write_ply(filmed, skin);
  CHECK_THROWS_WITH(solve({}), Contains("body.ply: the description makes another skin") &&
                                   Contains("up to 0.00012 mm elsewhere"));
  skin.triangles.conservativeResize(3, skin.triangles.cols() - 1);
  write_ply(filmed, skin);
  CHECK_THROWS_WITH(solve({}), Contains("makes another skin (it has"));
  fs::remove(filmed);

  // Of a body file, the skin is compared, and the solid that is stored beside it.
  const fs::path baked = folder.path() / "block.palpable";
  ReducedBody body = value_or_throw(read_body_file("tests/data/ball_v1.palpable"));
  write_body_file(baked, body);
  CHECK_THROWS_WITH(solve(baked), Contains("block.palpable: the description makes another skin"));
  body = reduced_block(problem);
  write_body_file(baked, body);
  CHECK(solve(baked).size() == 1);  // nothing is kept beside it
  StoreContent kept = content_of(description, problem);
  write_solid_file(solid_file_of(baked), kept);
  CHECK(solve(baked).size() == 1);
  kept.materials = {material_from_young("neo-hookean", 61e3, 0.3)};
  write_solid_file(solid_file_of(baked), kept);
  CHECK_THROWS_WITH(solve(baked), Contains("block.palpable: was baked from another material"));
}

TEST_CASE("a clip of another body, and one without a touch, are refused", "[truth]") {
  const test::ScratchFolder folder("no_true_skins");
  const fs::path clip = folder.path() / "clip";
  write_clip(clip, 0.1);
  const BodyDescription description = block(folder.path());
  CHECK_THROWS_WITH(write_true_skins(clip, description, {}, {}),
                    Contains("the clip was filmed with another one"));
  std::string contacts;
  for (int n = 0; n < kFrames; ++n) contacts += contact_line({.frame = n});
  write_whole_file(clip / "truth" / "contact.jsonl", contacts);
  CHECK_THROWS_WITH(write_true_skins(clip, description, {}, {}),
                    Contains("nothing touches the body"));
}

}  // namespace
}  // namespace palpable

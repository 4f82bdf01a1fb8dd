#include "palpable/bake/pipeline/bake_body.h"

#include "palpable/bake/mesh/msh_file.h"
#include "palpable/common/base/error.h"
#include "palpable/common/body_file/body_file.h"
#include "palpable/common/geometry/mesh_file.h"
#include "tests/support/egg_body.h"
#include "tests/support/solved_sites.h"
#include "tests/support/test.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <unistd.h>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using test::tolerance;

// A folder with an egg to bake.
struct Kitchen {
  std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("palpable-bake-test-" + std::to_string(::getpid()));
  Kitchen() {
    std::filesystem::create_directories(folder);
    test::write_egg(folder);
  }
  ~Kitchen() { std::filesystem::remove_all(folder); }

  [[nodiscard]] BodyDescription egg() const {
    BodyDescription body = test::egg_description(folder, 4);
    body.sites = {.count = 3, .above = 0.4, .patch = 1};
    body.reduction = {.tolerance = 1e-3, .max_modes = 100};
    return body;
  }
};

TEST_CASE("a shape is turned, scaled and stood on the ground", "[pipeline][mesh]") {
  Eigen::Matrix3Xd points(3, 3);
  points << 1, 3, 1,  // x
      10, 10, 12,     // y
      5, 6, 9;        // z
  Eigen::Matrix3Xd up_y = points;
  place_in_body_frame(up_y, UpAxis::kY, 0.5);  // 2 high: a quarter of the size
  Eigen::Matrix3Xd expected(3, 3);
  expected << -0.5, -0.25, 0.5,  // z
      -0.25, 0.25, -0.25,        // x
      0, 0, 0.5;                 // y
  CHECK((up_y - expected).cwiseAbs().maxCoeff() <= tolerance(1e-15, "rounding"));
  Eigen::Matrix3Xd up_z = points;
  place_in_body_frame(up_z, UpAxis::kZ, std::nullopt);
  CHECK(up_z.row(2) == points.row(2).array().operator-(5).matrix());
  Eigen::Matrix3Xd flat = points;
  flat.row(2).setZero();
  CHECK_THROWS_AS(place_in_body_frame(flat, UpAxis::kZ, 1.0), Error);
}

TEST_CASE("a shape is turned, not mirrored", "[pipeline][mesh]") {
  for (const UpAxis up : {UpAxis::kX, UpAxis::kY, UpAxis::kZ}) {
    SurfaceMesh box = box_surface({0, 0, 0}, {1, 2, 3});
    place_in_body_frame(box.vertices, up, std::nullopt);
    CHECK(enclosed_volume(box) > 0.0);
  }
}

TEST_CASE("a baked body gives its snapshots back within the error that it states",
          "[pipeline][body]") {
  const Kitchen kitchen;
  const BodyDescription description = kitchen.egg();
  const BakedBody baked =
      bake_body(description, {.threads = 2, .version = "test 1", .command_line = {}});
  const ReducedBody& body = baked.body;
  CHECK(body.error.displacement_pooled <= 1e-3);
  CHECK(body.error.stress_pooled <= 1e-3);
  CHECK(body.error.displacement_worst >= body.error.displacement_pooled);
  CHECK(body.sites.size() == 3);
  CHECK(body.levels().size() == 5);
  CHECK(std::abs(body.surface.vertices.row(2).maxCoeff() - 0.08) <= tolerance(1e-12, "rounding"));
  CHECK(std::count(body.fixed.begin(), body.fixed.end(), 1) > 3);

  // The same solves once more, by hand.
  const BodyMesh mesh = make_body_mesh(description);
  const EquilibriumSolver solver(
      SolidModel{.mesh = mesh.mesh,
                 .material = material_from_young("neo-hookean", 40e3, 0.35),
                 .fixed_nodes = mesh.fixed_nodes,
                 .fixed_displacement = {}});
  const test::SolvedSites campaign =
      test::solved_sites(solver, mesh.boundary, body.sites, {.press = 0.06 * 0.08, .levels = 4});
  double lost = 0, whole = 0;
  std::vector<float> u(body.displacement.value_count());
  for (int s = 0; s < 3; ++s) {
    for (int l = 0; l < 4; ++l) {
      const double mu[2] = {double(s), body.levels()[l + 1]};
      body.displacement.evaluate(mu, u);
      const Eigen::VectorXd truth = campaign.displacement.col(s * 4 + l);
      for (std::size_t v = 0; v < u.size(); ++v) {
        const int node = mesh.boundary.node_of_vertex[v / 3];
        const double t = truth[3 * node + static_cast<int>(v % 3)];
        lost += (u[v] - t) * (u[v] - t);
        whole += t * t;
      }
    }
  }
  CHECK(std::sqrt(lost / whole) <=
        tolerance(3e-3, "the stated 1e-3 is over the volume, this is over the skin"));
  CHECK(std::sqrt(lost / whole) > 1e-7);  // it is reduced, not copied
  CHECK(baked.report.displacement.evaluated_worst < 0.02);
  CHECK(baked.report.stress.evaluated_worst < 0.02);

  // At rest nothing moves.
  body.displacement.evaluate(std::array{1.0, 0.0}, u);
  CHECK(*std::max_element(u.begin(), u.end()) == 0.0f);
}

TEST_CASE("a baked body survives its file, with where it comes from", "[pipeline][body]") {
  const Kitchen kitchen;
  const BakedBody baked = bake_body(
      kitchen.egg(), {.threads = 1, .version = "test 1", .command_line = "palpable bake egg.toml"});
  const std::filesystem::path file = kitchen.folder / "egg.palpable";
  write_body_file(file, baked.body);
  const ReducedBody again = value_or_throw(read_body_file(file));
  CHECK(again.name == "egg");
  CHECK(again.displacement.modes() == baked.body.displacement.modes());
  CHECK(again.press_depth == baked.body.press_depth);
  // How the errors fall: down to what the body states.
  const ReductionError& error = again.error;
  REQUIRE((error.displacement_course && error.stress_course && error.von_mises_course));
  CHECK(error.displacement_course->modes.tail(1)[0] == again.displacement.largest_block());
  CHECK(error.displacement_course->pooled.tail(1)[0] == error.displacement_pooled);
  CHECK(error.stress_course->pooled.tail(1)[0] == error.stress_pooled);
  CHECK(error.stress_course->snapshots.rightCols(1).maxCoeff() ==
        static_cast<float>(error.stress_worst));
  CHECK(error.von_mises_course->modes.tail(1)[0] == again.stress.largest_block());
  CHECK(error.von_mises_course->snapshots.rows() == 3 * 4);
  CHECK(error.von_mises_course->pooled.tail(1)[0] <
        tolerance(5e-3, "1e-3 of the stress was asked for, over the volume; this is the skin"));
  CHECK(error.von_mises_course->pooled.tail(1)[0] < 0.3 * error.von_mises_course->pooled[0]);
  CHECK_FALSE(error.held_out);
  std::string all;
  for (const auto& [key, value] : lines_of(again.provenance)) all += key + ": " + value + "\n";
  CHECK_THAT(all, Contains("program: test 1") && Contains("command line: palpable bake egg.toml") &&
                      Contains("egg.ply") && Contains("tetrahedra") && Contains("4 levels"));
}

TEST_CASE("a body with its inside gives the snapshots back at every node",
          "[pipeline][body][volume]") {
  const Kitchen kitchen;
  BodyDescription heavy = kitchen.egg();
  heavy.gravity = BodyDescription::Gravity{.density = 2000};  // sags below its drawn shape
  heavy.sites.count = 2;
  heavy.shape.order = 2;
  LocalCrew crew;
  FillSettings bake;
  bake.threads = 1;
  bake.store = kitchen.folder / "egg.snapshots";
  const SnapshotStore store = fill_store(heavy, bake, crew).store;
  const TetMesh& mesh = store.content().mesh;
  ReduceSettings settings;
  settings.volume = true;
  settings.tolerance = 1e-5;
  settings.own_norms = true;
  const ReducedBody body = reduce_store(store, settings).body;
  REQUIRE(body.volume.has_value());
  REQUIRE(body.volume->stress.has_value());
  CHECK(body.volume->tets.topRows(4) == mesh.tets);
  CHECK(body.volume->tets.bottomRows(6) == mesh.edge_nodes);
  CHECK(body.volume->nodes == mesh.nodes + store.unit(0).rest);
  for (const ModeStorage storage : {ModeStorage::kFloat32, ModeStorage::kFloat16}) {
    const std::filesystem::path file = kitchen.folder / "egg.palpable";
    const ReductionError stated = write_body_file(file, body, storage);
    const ReducedBody again = value_or_throw(read_body_file(file));
    const bool half = storage == ModeStorage::kFloat16;
    // Half precision has eleven bits: the rounding error of a value is at most 2^-12 of it, and
    // less on average.
    CHECK((stated.displacement_rounding > 0) == half);
    CHECK(stated.displacement_rounding <= 0.5 / 2048);
    CHECK(stated.stress_rounding == again.error.stress_rounding);
    for (const char* name : {"displacement", "stress"}) {
      const bool is_u = std::string(name) == "displacement";
      const SeparatedField& inside = is_u ? again.volume->displacement : *again.volume->stress;
      const SeparatedField& skin = is_u ? again.displacement : again.stress;
      const StoredField field{name, is_u ? 3 : 6};
      std::vector<float> all(inside.value_count());
      std::vector<float> outside(skin.value_count());
      const Boundary boundary = split_boundary_of(mesh);
      for (int s = 0; s < 2; ++s) {
        const Eigen::MatrixXf truth = store.rows(s, field, 0, inside.value_count());
        for (int l = 0; l < 4; ++l) {
          const double mu[2] = {double(s), again.levels()[l + 1]};
          inside.evaluate(mu, all);
          skin.evaluate(mu, outside);
          const Eigen::Map<const Eigen::VectorXf> found(all.data(), inside.value_count());
          CHECK((found - truth.col(l)).norm() <=
                tolerance(half ? 5e-4f : 1e-4f, "1e-5 by volume and site, not by node; 2^-12") *
                    truth.col(l).norm());
          for (std::size_t v = 0; v < boundary.node_of_vertex.size(); ++v) {
            const auto node = static_cast<std::size_t>(boundary.node_of_vertex[v]);
            CHECK(all[node * std::size_t(field.components)] ==
                  outside[v * std::size_t(field.components)]);
          }
        }
      }
    }
  }
  // By default there is none.
  CHECK_FALSE(reduce_store(store, {}).body.volume.has_value());
}

TEST_CASE("the bake is the same on one thread and on three", "[pipeline][body][threads]") {
  const Kitchen kitchen;
  const auto bake = [&](int threads) {
    return bake_body(kitchen.egg(), {.threads = threads, .version = {}, .command_line = {}}).body;
  };
  const ReducedBody one = bake(1), three = bake(3);
  CHECK(one.displacement.modes() == three.displacement.modes());
  CHECK(one.stress.modes() == three.stress.modes());
  CHECK(one.press_depth == three.press_depth);
}

TEST_CASE("a volume mesh is baked like a surface", "[pipeline][body]") {
  const Kitchen kitchen;
  write_msh_file(kitchen.folder / "block.msh", box_tets({0, 0, 0}, {0.06, 0.05, 0.04}, 4, 4, 3));
  BodyDescription block = kitchen.egg();
  block.shape = {.file = kitchen.folder / "block.msh", .up = UpAxis::kZ, .height = {}, .edge = {}};
  block.sites.count = 2;
  block.press.levels = 2;
  const BakedBody baked = bake_body(block, {});
  CHECK(baked.report.nodes == 5 * 5 * 4);
  CHECK(baked.report.tets == 4 * 4 * 3 * 6);
  CHECK(baked.body.surface.vertices.col(0).isApprox(Eigen::Vector3d(-0.03, -0.025, 0.0)));
}

TEST_CASE("a body of 10-node elements has all nodes of its skin in the file",
          "[pipeline][body][quadratic]") {
  const Kitchen kitchen;
  write_msh_file(kitchen.folder / "block.msh", box_tets({0, 0, 0}, {0.06, 0.05, 0.04}, 3, 3, 2));
  BodyDescription block = kitchen.egg();
  block.shape = {.file = kitchen.folder / "block.msh", .up = UpAxis::kZ, .height = {}, .edge = {}};
  block.sites.count = 2;
  block.press.levels = 3;
  const BakedBody one = bake_body(block, {});
  block.shape.order = 2;
  const BakedBody two = bake_body(block, {});
  CHECK(two.report.nodes == 7 * 7 * 5);
  CHECK(two.report.tets == one.report.tets);
  CHECK(two.report.triangles == 4 * one.report.triangles);
  CHECK(two.body.error.displacement_pooled <= 1e-3);
  CHECK(two.body.error.stress_pooled <= 1e-3);
  CHECK(two.report.displacement.evaluated_worst < 0.02);
  CHECK(two.report.stress.evaluated_worst < 0.02);
  const std::filesystem::path file = kitchen.folder / "block.palpable";
  write_body_file(file, two.body);
  CHECK(value_or_throw(read_body_file(file)).surface.vertices == two.body.surface.vertices);
}

TEST_CASE("a body that sags under its weight lies so in its file, and presses start there",
          "[pipeline][body][preload]") {
  const Kitchen kitchen;
  BodyDescription heavy = kitchen.egg();
  heavy.gravity = BodyDescription::Gravity{.density = 3000};
  heavy.sites.count = 2;
  heavy.press.levels = 2;
  const BakedBody baked = bake_body(heavy, {});
  const BodyMesh mesh = make_body_mesh(heavy);
  const double sag = mesh.height - baked.body.surface.vertices.row(2).maxCoeff();
  CHECK(sag > 0.001);
  CHECK(baked.body.press_depth.row(0).isZero(0.0));
  CHECK(baked.body.press_depth(2, 0) == Approx(0.06 * 0.08).epsilon(1e-3));
  std::vector<float> u(baked.body.displacement.value_count());
  baked.body.displacement.evaluate(std::array{0.0, 0.0}, u);
  CHECK(*std::max_element(u.begin(), u.end()) == 0.0f);
  std::string all;
  for (const auto& [key, value] : lines_of(baked.body.provenance)) all += key + ": " + value + "\n";
  CHECK_THAT(all, Contains("preload: weight at 3000 kg/m^3") && Contains("what a press adds"));
}

TEST_CASE("a bake that cannot be says why in one line", "[pipeline][body]") {
  const Kitchen kitchen;
  const auto complaint = [](const BodyDescription& description) -> std::string {
    try {
      (void)bake_body(description, {});
    } catch (const Error& error) { return error.what(); }
    return "";
  };
  {
    INFO("missing file");
    BodyDescription body = kitchen.egg();
    body.shape.file = kitchen.folder / "none.ply";
    CHECK_THAT(complaint(body), Contains("none.ply: no such file"));
  }
  {
    INFO("not watertight");
    SurfaceMesh open = sphere_surface({0, 0, 0}, 1, 1);
    open.triangles.conservativeResize(3, open.triangle_count() - 1);
    write_ply(kitchen.folder / "open.ply", open);
    BodyDescription body = kitchen.egg();
    body.shape.file = kitchen.folder / "open.ply";
    CHECK_THAT(complaint(body), Contains("open.ply: not watertight: 3 open edges"));
  }
  {
    INFO("flat tetrahedron");
    TetMesh mesh = box_tets({0, 0, 0}, {0.1, 0.1, 0.1}, 2, 2, 2);
    mesh.tets(3, 5) = mesh.tets(2, 5);
    write_msh_file(kitchen.folder / "flat.msh", mesh);
    BodyDescription body = kitchen.egg();
    body.shape = {.file = kitchen.folder / "flat.msh", .up = UpAxis::kZ, .height = {}, .edge = {}};
    CHECK_THAT(complaint(body), Contains("1 of 48 tetrahedra is inverted or flat"));
  }
  {
    INFO("singular supports");
    BodyDescription body = kitchen.egg();
    body.supports[0].where.what = Where::Below{1e-6};  // the egg stands on one point
    CHECK_THAT(complaint(body), Contains("egg.toml:8: [support] does not hold the body") &&
                                    Contains("free to turn"));
  }
  {
    INFO("a load that cannot be reached");
    BodyDescription body = kitchen.egg();
    body.press.depth = 0.9;
    CHECK_THAT(complaint(body),
               Contains("past the centre of mass") && Contains("ask for a depth below 0."));
  }
}

TEST_CASE("a parameter without a given value stays free in the body", "[pipeline][body]") {
  const Kitchen kitchen;
  BodyDescription description = kitchen.egg();
  description.sites.count = 2;
  description.press.levels = 3;
  description.parameters = {{.name = "stiffness", .values = {0.5, 1.0, 2.0}}};
  const std::filesystem::path folder = kitchen.folder / "free.snapshots";
  LocalCrew crew;
  FillSettings bake;
  bake.threads = 1;
  bake.store = folder;
  const FilledStore filled = fill_store(description, bake, crew);
  CHECK_THROWS_WITH(FolderLock(folder), Contains("another run"));  // it stays locked meanwhile
  for (const ReductionMethod method : {ReductionMethod::kPerSite, ReductionMethod::kPgd}) {
    INFO(method_name(method));
    const ReducedBody body = reduce_store(filled.store, {.method = method, .tolerance = 1e-4}).body;
    REQUIRE(body.further.size() == 1);
    CHECK(body.further[0].name == "stiffness");
    CHECK(body.further[0].value == 1.0);
    REQUIRE(body.displacement.axes().size() == 3);
    CHECK(body.error.displacement_course->snapshots.rows() == 2 * 3 * 3);
    // Errors of the von Mises stress of all combinations, in the order of the others: about as
    // large as those of the stress, apart from what single precision adds in the evaluation.
    const Eigen::VectorXf vm = body.error.von_mises_course->snapshots.rightCols(1);
    const Eigen::VectorXf stress = body.error.stress_course->snapshots.rightCols(1);
    REQUIRE(vm.size() == stress.size());
    CAPTURE(1e6F * vm.maxCoeff(), 1e6F * stress.maxCoeff());
    CHECK(vm.maxCoeff() < std::max(20 * stress.maxCoeff(), 1e-5F));
    std::vector<float> u(body.displacement.value_count()), one = u;
    for (const double value : {0.5, 2.0}) {
      const ReducedBody settled_body = value_or_throw(settled(body, {{"stiffness", value}}));
      const ReducedBody alone =
          reduce_store(filled.store,
                       {.method = method, .tolerance = 1e-4, .at = {{"stiffness", value}}})
              .body;
      CHECK(alone.further.empty());
      for (int s = 0; s < 2; ++s) {
        INFO("stiffness " << value << " site " << s);
        const double mu[2] = {double(s), body.levels()[2]};
        settled_body.displacement.evaluate(mu, u);
        alone.displacement.evaluate(mu, one);
        float lost = 0, whole = 0;
        for (std::size_t v = 0; v < u.size(); ++v) {
          lost += (u[v] - one[v]) * (u[v] - one[v]);
          whole += one[v] * one[v];
        }
        CHECK(std::sqrt(lost / whole) <=
              tolerance(1e-3f, "both are reduced to 1e-4 over the volume"));
        CHECK(std::abs(settled_body.sites[std::size_t(s)].full_load /
                           alone.sites[std::size_t(s)].full_load -
                       1) <= tolerance(1e-6, "single precision"));
        CHECK((settled_body.press_depth.col(s) - alone.press_depth.col(s)).norm() <=
              tolerance(1e-6, "single precision") * alone.press_depth.col(s).norm());
      }
    }
  }
  CHECK_THROWS_AS(reduce_store(filled.store, {.method = ReductionMethod::kPod}), Error);
}

}  // namespace
}  // namespace palpable

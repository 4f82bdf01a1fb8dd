#include "palpable/bake/campaign/campaign.h"

#include "palpable/bake/campaign/merge_stores.h"
#include "palpable/bake/campaign/press_solver.h"
#include "palpable/bake/describe/contact_sites.h"
#include "palpable/common/base/error.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/solved_sites.h"
#include "tests/support/test.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <pugixml.hpp>
#include <sys/wait.h>
#include <unistd.h>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using Catch::Matchers::Contains;
using Catch::Matchers::EndsWith;
using test::file_bytes;

// A block of rubber that stands on the ground; the stiffness of every second element is a
// parameter.
struct Block {
  CampaignPlan plan;
  StoreContent content;

  explicit Block(const char* law = "neo-hookean", double press = 0.004, int points = 1) {
    SolidModel& model = plan.model;
    model.mesh = box_tets({-0.03, -0.02, 0}, {0.03, 0.02, 0.05}, 4, 3, 4);
    model.material = material_from_young(law, 60e3, 0.4);
    for (int n = 0; n < model.mesh.node_count(); ++n) {
      if (model.mesh.nodes(2, n) < 0.001) model.fixed_nodes.push_back(n);
    }
    MaterialGroup upper{model.material, {}};
    for (int e = 0; e < model.mesh.tet_count(); e += 2) upper.elements.push_back(e);
    model.groups.push_back(upper);
    plan.boundary = boundary_of(model.mesh);
    for (const auto& x : plan.boundary.surface.vertices.colwise()) {
      content.fixed.push_back(x[2] < 0.001);
    }
    plan.sites = choose_sites(plan.boundary.surface, content.fixed,
                              {.count = 3, .lowest = 0.02, .patch_distance = 1});
    plan.run = {.press = press, .levels = 2};
    for (int p = 0; p < points; ++p) {
      plan.points.push_back({model.material, {material_from_young(law, 60e3 * (1 + p), 0.4)}});
    }
    content.name = "block";
    content.mesh = model.mesh;
    content.sites = plan.sites;
    content.levels = Eigen::VectorXd::LinSpaced(3, 0.0, 1.0);
    if (points > 1) {
      content.parameters.push_back({"upper", Eigen::VectorXd::LinSpaced(points, 1, points)});
    }
    content.keys = unit_keys(plan);
  }
  CampaignReport run(const fs::path& folder, const CampaignSettings& settings = {},
                     const Progress& progress = {}) const {
    LocalCrew crew;
    return run_campaign(plan, SnapshotStore::create(folder, content), crew, settings, progress);
  }
};

std::map<std::string, std::string> all_files(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    files[entry.path().filename().string()] = file_bytes(entry.path());
  }
  return files;
}

TEST_CASE("a store has the same bytes from one thread and from five", "[campaign][threads]") {
  const test::ScratchFolder folder("campaign_threads");
  const Block block;
  block.run(folder / "one", {.threads = 1});
  block.run(folder / "five", {.threads = 5});
  const auto one = all_files(folder / "one");
  CHECK(one.size() == 3 + 2);  // sites, campaign.h5, campaign.xdmf
  CHECK(one == all_files(folder / "five"));
}

TEST_CASE("what is valid is used again, what is damaged, foreign or gone is solved again",
          "[campaign]") {
  const test::ScratchFolder folder("campaign_resume");
  const Block block("neo-hookean", 0.004, 2);
  const CampaignReport first = block.run(folder / "store", {.threads = 1});
  CHECK((first.solved == 6 && first.reused == 0));
  const auto files = all_files(folder / "store");
  REQUIRE(files.contains("point_001_site_0002.h5"));

  CHECK(block.run(folder / "store").solved == 0);
  CHECK(all_files(folder / "store") == files);

  fs::remove(folder / "store/point_000_site_0001.h5");
  std::string bytes = files.at("point_001_site_0000.h5");
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  std::ofstream(folder / "store/point_001_site_0000.h5", std::ios::binary) << bytes;
  std::ofstream(folder / "store/point_001_site_0001.h5", std::ios::binary)
      << files.at("point_001_site_0002.h5");
  std::ofstream(folder / "store/point_001_site_0002.h5.part-elsewhere-7") << "killed";
  const CampaignReport again = block.run(folder / "store");
  CHECK(again.solved == 3);
  CHECK(again.solved + again.reused == 6);
  CHECK(all_files(folder / "store") == files);
}

TEST_CASE("what killed processes left goes, and what one beside this is writing stays",
          "[campaign]") {
  const test::ScratchFolder folder("campaign_leftovers");
  const pid_t ended = ::fork();
  if (ended == 0) ::_exit(0);
  ::waitpid(ended, nullptr, 0);
  char host[256] = {};
  ::gethostname(host, sizeof host - 1);
  const auto part = [&](const std::string& machine, long process) {
    return folder / "store" / ("site_0000.h5.part-" + machine + "-" + std::to_string(process));
  };
  const SnapshotStore store =
      SnapshotStore::create(folder / "store", Block("neo-hookean", 0.004, 2).content);
  const fs::path other = part("elsewhere", 7), killed = part(host, ended),
                 running = part(host, ::getppid());
  for (const fs::path& file : {other, killed, running}) test::write_bytes(file, "half");
  const std::vector<std::string> of_the_user{"site_notes.txt", "linear_study.csv", "point_7.png",
                                             "site_0099.h5", "thesis.part-1.txt"};
  for (const std::string& name : of_the_user) test::write_bytes(folder / "store" / name, "mine");
  store.finish();
  CHECK_FALSE(fs::exists(other));
  CHECK_FALSE(fs::exists(killed));
  CHECK(fs::exists(running));
  for (const std::string& name : of_the_user) {
    INFO(name);
    CHECK(fs::exists(folder / "store" / name));
  }
}

TEST_CASE("a store's list for ParaView is XML, whatever parameters and fields are called",
          "[campaign]") {
  const test::ScratchFolder folder("campaign_names");
  StoreContent content = Block("neo-hookean", 0.004, 2).content;
  content.parameters[0].name = "a & b <c> \"d\"";
  content.fields.push_back({"T < \"0\" & more", 1});
  SnapshotStore::create(folder / "store", content).finish();
  pugi::xml_document document;
  REQUIRE(document.load_file((folder / "store/campaign.xdmf").c_str()));
  const pugi::xml_node grid = document.select_node("//Grid/Grid").node();
  CHECK_THAT(grid.attribute("Name").value(), Contains("site 0, a & b <c> \"d\" 1, level"));
  const pugi::xml_node field = grid.last_child();
  CHECK(field.attribute("Name").value() == content.fields.back().name);
  CHECK_THAT(field.select_node("DataItem/DataItem[@Format='HDF']").node().child_value(),
             EndsWith(":/" + content.fields.back().name));
}

TEST_CASE("a snapshot is of its mesh, material, load and levels, and of no other", "[campaign]") {
  const Block block;
  const std::vector<std::uint64_t> keys = block.content.keys;
  const auto changed = [&](const auto& change) {
    Block other;
    change(other.plan);
    const std::vector<std::uint64_t> now = unit_keys(other.plan);
    return std::none_of(keys.begin(), keys.end(), [&](std::uint64_t key) {
      return std::find(now.begin(), now.end(), key) != now.end();
    });
  };
  CHECK_FALSE(changed([](CampaignPlan&) {}));
  CHECK(changed([](CampaignPlan& p) { p.model.mesh.nodes(0, 7) += 1e-15; }));
  CHECK(changed([](CampaignPlan& p) {
    p.points[0].material = material_from_young("neo-hookean", 61e3, 0.4);
  }));
  CHECK(changed([](CampaignPlan& p) {
    p.points[0].groups[0] = material_from_young("mooney-rivlin", 60e3, 0.4);
  }));
  CHECK(changed([](CampaignPlan& p) { p.model.groups[0].elements.pop_back(); }));
  CHECK(changed([](CampaignPlan& p) { p.model.fixed_nodes.pop_back(); }));
  CHECK(changed([](CampaignPlan& p) { p.run.press *= 1.01; }));
  CHECK(changed([](CampaignPlan& p) { p.run.levels = 3; }));
  CHECK(changed([](CampaignPlan& p) { p.solver = FeSolver::kCalculix; }));
  CHECK(changed([](CampaignPlan& p) {
    for (Site& site : p.sites) site.direction = -site.direction;
  }));
  CHECK(changed(
      [](CampaignPlan& p) { p.preload = Eigen::Matrix3Xd::Zero(3, p.model.mesh.node_count()); }));
}

TEST_CASE("shards merge to what one bake leaves, byte for byte", "[campaign]") {
  const test::ScratchFolder folder("campaign_shards");
  const Block block("neo-hookean", 0.004, 2);
  block.run(folder / "whole", {.threads = 2});
  block.run(folder / "a", {.shard = 0, .shards = 2});
  CHECK_THROWS_WITH(merge_stores({folder / "a"}, folder / "merged"),
                    Contains("of 6 snapshot files are in none of the folders") &&
                        Contains("missing") && Contains("once more"));
  block.run(folder / "b", {.shard = 1, .shards = 2});
  merge_stores({folder / "a", folder / "b"}, folder / "merged");
  CHECK(all_files(folder / "merged") == all_files(folder / "whole"));

  const Block other("neo-hookean", 0.003, 2);
  other.run(folder / "c", {.shard = 1, .shards = 2});
  CHECK_THROWS_WITH(merge_stores({folder / "a", folder / "c"}, folder / "merged"),
                    Contains("c: not of the same campaign as"));
}

TEST_CASE("snapshots come back from the store as they were solved", "[campaign]") {
  const test::ScratchFolder folder("campaign_rows");
  const Block block;
  block.run(folder / "store");
  const SnapshotStore store = SnapshotStore::open(folder / "store");
  CHECK(store.content().name == "block");
  CHECK(store.content().mesh.nodes == block.content.mesh.nodes);
  CHECK(store.content().sites[2].patch == block.plan.sites[2].patch);
  const test::SolvedSites solved =
      test::solved_sites(EquilibriumSolver(block.plan.model, {.tolerance = kSnapshotTolerance}),
                         block.plan.boundary, block.plan.sites, block.plan.run);
  for (int s = 0; s < 3; ++s) {
    const Eigen::MatrixXd u = solved.displacement.middleCols(2 * s, 2);
    CHECK(store.rows(s, {"displacement", 3}, 0, u.rows()).cast<double>() == u);
    // A block that begins and ends within nodes.
    CHECK(store.rows(s, {"stress", 6}, 13, 40).cast<double>() ==
          solved.stress.block(13, 2 * s, 40, 2));
    CHECK(store.unit(s).press_depth == solved.press_depth.col(s));
    CHECK(store.unit(s).full_load == solved.sites[s].full_load);
  }
}

TEST_CASE("linear responses are reciprocal and the beginning of every press", "[campaign]") {
  const test::ScratchFolder folder("campaign_linear");
  Block block;
  std::vector<int> vertices;
  for (int v = 0; v < block.plan.boundary.surface.vertex_count(); ++v) {
    if (block.content.fixed[v] == 0) vertices.push_back(v);
  }
  // Some twice, so that there are two files.
  for (std::size_t k = 0; k < 10; ++k) vertices.push_back(vertices[k]);
  block.plan.linear =
      sites_at(block.plan.boundary.surface, block.content.fixed, vertices, {.patch_distance = 1});
  block.content.linear = vertices;
  block.content.linear_key = linear_key(block.plan);
  REQUIRE(vertices.size() > kLinearRow);  // two files
  const CampaignReport report = block.run(folder / "store", {.threads = 2});
  CHECK(report.linear_solved == 2);
  CHECK(block.run(folder / "store").linear_solved == 0);
  const SnapshotStore store = SnapshotStore::open(folder / "store");
  CHECK(store.content().linear == vertices);
  Eigen::MatrixXd G(store.linear(0).rows(), static_cast<Eigen::Index>(vertices.size()));
  G << store.linear(0).cast<double>(), store.linear(1).cast<double>();
  // (n x n) work of each site's load on each response: w_i . G_j, symmetric (Betti).
  Eigen::MatrixXd work(G.cols(), G.cols());
  for (Eigen::Index i = 0; i < G.cols(); ++i) {
    const Site& site = block.plan.linear[i];
    Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(G.cols());
    for (std::size_t k = 0; k < site.patch.size(); ++k) {
      sum += static_cast<double>(site.weights[k]) * site.direction.transpose() *
             G.middleRows(3 * site.patch[k], 3);
    }
    work.row(i) = sum;
  }
  CHECK((work - work.transpose()).cwiseAbs().maxCoeff() <=
        test::tolerance(1e-4, "the square of a small load") * work.cwiseAbs().maxCoeff());
  CHECK(work.diagonal().minCoeff() > 0.0);
  // The first of two levels of a gentle press is nearly linear.
  block.plan.run.press = 1e-5;
  block.content.keys = unit_keys(block.plan);
  block.run(folder / "gentle");
  const SnapshotStore gentle = SnapshotStore::open(folder / "gentle");
  const Site& site = block.plan.sites[0];
  const auto at = std::find(vertices.begin(), vertices.end(), site.vertex) - vertices.begin();
  const double half = 0.5 * gentle.unit(0).full_load;
  CHECK(half * work(at, at) == Approx(gentle.unit(0).press_depth[1]).epsilon(1e-3));
}

TEST_CASE("progress is reported one at a time and reaches the end", "[campaign][threads]") {
  const test::ScratchFolder folder("campaign_progress");
  std::mutex only_one;
  double done = 0, last = 0;
  const auto listen = [&](const ProgressReport& r) {
    const std::unique_lock lock(only_one, std::try_to_lock);
    CHECK(lock.owns_lock());
    if (r.task != "solving sites") return;
    CHECK(r.done >= done);
    CHECK(r.total == 3.0);
    done = last = r.done;
  };
  Block("neo-hookean", 0.003).run(folder / "store", {.threads = 3}, listen);
  CHECK(last == 3.0);
}

TEST_CASE("a press that no load reaches is refused", "[campaign]") {
  const test::ScratchFolder folder("campaign_refused");
  // St. Venant-Kirchhoff's law softens in compression until it collapses.
  CHECK_THROWS_WITH(Block("saint-venant-kirchhoff", 0.04).run(folder / "store"),
                    Contains("ask for a smaller press"));
}

TEST_CASE("a folder that holds something else is no place for snapshots", "[campaign]") {
  const test::ScratchFolder folder("campaign_folder");
  std::ofstream(folder / "letter.txt") << "dear reader";
  CHECK_THROWS_WITH(Block().run(folder.path()), Contains("holds something else than snapshots"));
  CHECK_THROWS_WITH(SnapshotStore::open(folder.path()), Contains("not a folder of snapshots"));
  CHECK_THROWS_WITH(SnapshotStore::open(folder / "none"), Contains("no such folder"));
}

}  // namespace
}  // namespace palpable

#include "palpable/bake/calculix/calculix_dat.h"
#include "palpable/bake/campaign/import_snapshots.h"
#include "palpable/bake/campaign/snapshot_store.h"
#include "palpable/bake/describe/contact_sites.h"
#include "palpable/bake/mesh/msh_file.h"
#include "tests/fuzz/checked_hdf5.h"
#include "tests/fuzz/fuzz_reader.h"
#include "tests/support/scratch_folder.h"

#include <fmt/format.h>

#include <fstream>

namespace palpable::fuzz {
namespace {

namespace fs = std::filesystem;

// A store of two sites and two levels with arbitrary numbers.
std::vector<std::string> write_store(const fs::path& folder) {
  StoreContent content;
  content.name = "block";
  content.mesh = box_tets({0, 0, 0}, {0.1, 0.1, 0.1}, 1, 1, 1);
  const Boundary skin = boundary_of(content.mesh);
  content.fixed.assign(static_cast<std::size_t>(skin.surface.vertex_count()), 0);
  content.fixed[0] = 1;
  content.sites = sites_at(skin.surface, content.fixed, {5, 6}, {.count = 2, .patch_distance = 0});
  content.levels = Eigen::Vector3d(0, 0.5, 1);
  content.parameters.push_back({"ears", Eigen::Vector2d(1, 2)});
  content.keys = {1, 2, 3, 4};
  content.linear = {5, 6};
  content.linear_key = 9;
  content.provenance.mesh_source = "a test";
  const SnapshotStore store = SnapshotStore::create(folder / "a.snapshots", content);
  SiteSnapshots snapshots;
  snapshots.full_load = 1.5;
  snapshots.displacement = Eigen::MatrixXf::Random(3 * content.mesh.node_count(), 2);
  snapshots.stress = Eigen::MatrixXf::Random(6 * content.mesh.node_count(), 2);
  snapshots.press_depth = Eigen::Vector3d(0, 0.01, 0.02);
  for (int unit = 0; unit < 4; ++unit) {
    store.write(unit, snapshots, Eigen::Matrix3Xd::Ones(3, content.mesh.node_count()));
  }
  store.write_linear(0, Eigen::MatrixXf::Random(3 * skin.surface.vertex_count(), 2));
  store.finish();
  return {"a.snapshots/campaign.h5", "a.snapshots/point_000_site_0001.h5",
          "a.snapshots/linear_0000.h5"};
}

std::string read_store(const fs::path& folder, const fs::path& /*file*/) {
  const SnapshotStore store = SnapshotStore::open(folder / "a.snapshots");
  for (int unit = 0; unit < store.content().unit_count(); ++unit) {
    const std::string why = store.why_not(unit);
    if (!why.empty()) return store.unit_file(unit).string() + ": " + why;
    (void)store.unit(unit);
    for (const StoredField& field : store.content().fields) { (void)store.rows(unit, field, 0, 3); }
  }
  for (int k = 0; k < store.content().linear_file_count(); ++k) {
    if (store.has_linear(k)) (void)store.linear(k);
  }
  return {};
}

std::string dat_text() {
  std::string text;
  for (int k = 1; k <= 2; ++k) {
    const double time = 0.5 * k;
    text += fmt::format("\n displacements (vx,vy,vz) for set NALL and time  {:.7E}\n\n", time);
    for (int n = 1; n <= 3; ++n) {
      text += fmt::format("{:10d} {:13.6E} {:13.6E} {:13.6E}\n", n, 0.1 * n * k, -0.2 * k, 1e-12);
    }
    text += fmt::format(
        "\n stresses (elem, integ.pnt.,sxx,syy,szz,sxy,sxz,syz) for set EALL and time  {:.7E}\n\n",
        time);
    for (int e = 1; e <= 2; ++e) {
      text += fmt::format("{:10d} {:3d} {:13.6E} {:13.6E} {:13.6E} {:13.6E} {:13.6E} {:13.6E}\n", e,
                          1, 1.0 * e, 2.0, 3.0, 4.0 * k, 5.0, 6.0);
    }
  }
  return text;
}

std::string read_dat(const fs::path& /*folder*/, const fs::path& file) {
  const CalculixDatLayout layout{.node_count = 3,
                                 .tet_count = 2,
                                 .levels = {0.5, 1.0},
                                 .units = {.length = 10.0, .stress = 100.0}};
  std::ifstream in(file);
  return said(read_calculix_dat(in, layout, file.string()), [](const auto&) {});
}

// A manifest, its body, its mesh and two fields.
std::vector<std::string> write_import(const fs::path& folder) {
  const TetMesh mesh = box_tets({0, 0, 0}, {0.1, 0.1, 0.1}, 1, 1, 1);
  write_msh_file(folder / "box.msh", mesh);
  test::write_bytes(folder / "body.toml",
                    "name = \"box\"\n[shape]\nmesh = \"box.msh\"\n[material]\nyoung = \"60 kPa\"\n"
                    "poisson = 0.4\n[support]\nbelow = 0.1\n[sites]\npoints = [[\"0.1 m\", "
                    "\"0.1 m\", \"0.1 m\"]]\npatch = 0\n");
  for (int level = 1; level <= 2; ++level) {
    std::string text = "node, U1, U2, U3\n";
    for (int n = 1; n <= mesh.node_count(); ++n) {
      const double z = mesh.nodes(2, n - 1);
      text += fmt::format("{}, {}, {}, {}\n", n, -0.01 * level * z, -0.01 * level * z,
                          -0.02 * level * z);
    }
    test::write_bytes(folder / fmt::format("u{}.csv", level), text);
  }
  test::write_bytes(folder / "import.toml",
                    "body = \"body.toml\"\n[[field]]\nname = \"displacement\"\n"
                    "from = [\"U1\", \"U2\", \"U3\"]\nunit = \"m\"\n"
                    "[[snapshot]]\nsite = 0\nlevel = 0.5\nforce = \"1 N\"\nfile = \"u1.csv\"\n"
                    "[[snapshot]]\nsite = 0\nlevel = 1\nforce = \"2 N\"\nfile = \"u2.csv\"\n");
  return {"import.toml", "u1.csv", "u2.csv", "box.msh"};
}

std::string read_import(const fs::path& folder, const fs::path& /*file*/) {
  const fs::path output = folder / "imported.snapshots";
  fs::remove_all(output);
  (void)import_snapshots(folder, read_import_manifest(folder / "import.toml"), output);
  return {};
}

}  // namespace

void add_campaign_readers(std::vector<FuzzReader>& readers) {
  readers.push_back(
      {.name = "store.files", .write = write_store, .read = read_store, .names_folder = true});
  readers.push_back({.name = "store.values",
                     .write = write_store,
                     .read = read_store,
                     .names_folder = true,
                     .mutate = with_spoilt_values});
  readers.push_back({.name = "calculix.dat",
                     .write = [](const fs::path& folder) -> std::vector<std::string> {
                       test::write_bytes(folder / "a.dat", dat_text());
                       return {"a.dat"};
                     },
                     .read = read_dat});
  readers.push_back(
      {.name = "import.files", .write = write_import, .read = read_import, .names_folder = true});
}

}  // namespace palpable::fuzz

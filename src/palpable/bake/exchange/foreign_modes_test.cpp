#include "palpable/bake/exchange/foreign_modes.h"

#include "palpable/bake/exchange/press_series.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/npy_file.h"
#include "palpable/common/body_file/body_file.h"
#include "palpable/common/body_file/foreign_hdf5.h"
#include "tests/support/bodies.h"
#include "tests/support/full_disk.h"
#include "tests/support/replaced.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <array>
#include <fstream>
#include <functional>
#include <hdf5.h>
#include <iterator>
#include <map>
#include <pugixml.hpp>
#include <string>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using test::ScratchFolder;
using test::tolerance;

Eigen::VectorXf field_at(const SeparatedField& field, const std::vector<double>& mu) {
  Eigen::VectorXf u(field.value_count());
  field.evaluate(mu, std::span<float>(u.data(), static_cast<std::size_t>(u.size())));
  return u;
}

ForeignModes there_and_back(const ForeignModes& modes, const fs::path& folder, bool numpy) {
  if (numpy) {
    write_numpy_modes(folder / "modes", modes);
    return read_numpy_modes(folder / "modes");
  }
  write_pxdmf(folder / "modes.pxdmf", modes);
  return read_pxdmf(folder / "modes.pxdmf");
}

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void replace_in(const fs::path& path, const std::string& what, const std::string& by) {
  std::string text = text_of(path);
  const std::size_t at = text.find(what);
  REQUIRE(at != std::string::npos);
  std::ofstream(path) << text.replace(at, what.size(), by);
}

TEST_CASE("a body's modes come back from NumPy and from PXDMF as the same body", "[exchange]") {
  for (const ReducedBody& body :
       {test::pressed_ball(0.05, 0.01, 1), test::with_further(test::pressed_ball(0.05, 0.01, 1))}) {
    for (const bool numpy : {true, false}) {
      INFO((numpy ? "NumPy" : "PXDMF") << ", " << body.displacement.axes().size() << " axes");
      const ScratchFolder folder("modes_files");
      const ForeignModes modes = there_and_back(modes_of_body(body), folder.path(), numpy);
      CHECK(modes.surface.vertices == body.surface.vertices);
      CHECK(modes.surface.triangles == body.surface.triangles);
      const ReducedBody again = body_of_modes(modes, {.name = "again"});
      CHECK(again.displacement.modes() == body.displacement.modes());
      CHECK(again.stress.modes() == body.stress.modes());  // xx yy zz xy yz zx are told apart
      std::vector<double> mu{3, 0.37, 0.8, 0.2};
      mu.resize(body.displacement.axes().size());
      CHECK(field_at(again.displacement, mu) == field_at(body.displacement, mu));
      CHECK(field_at(again.stress, mu) == field_at(body.stress, mu));
      for (std::size_t s = 0; s < body.sites.size(); ++s) {
        CHECK(again.sites[s].vertex == body.sites[s].vertex);
        CHECK(again.sites[s].patch == body.sites[s].patch);
        CHECK((again.sites[s].direction - body.sites[s].direction).norm() <=
              tolerance(1e-15, "divided by its length"));
        CHECK(again.sites[s].full_load == Approx(body.sites[s].full_load));
      }
      const ReducedBody here = settled(body).value(), there = settled(again).value();
      CHECK(there.further.size() == here.further.size());
      // Their own value is the middle sample: softness 1, heat 0.5 instead of 0.
      const double factor = here.further.empty() ? 1.0 : 1.5;
      CHECK((there.press_depth - factor * here.press_depth).cwiseAbs().maxCoeff() <=
            tolerance(1e-8, "single precision of 10 mm"));
      CHECK_NOTHROW(write_body_file(folder.path() / "again.palpable", again));
    }
  }
}

TEST_CASE("what a file does not say is found from the field", "[exchange]") {
  const ReducedBody body = test::pressed_ball(0.05, 0.01, 1);
  ForeignModes modes = modes_of_body(body);
  modes.site_vertices.clear();
  modes.stress.reset();
  // Loads in newtons from 0.5 N up, the place under another name and behind it.
  std::vector<ParameterAxis> axes = modes.displacement.axes();
  axes[1].name = "force";
  axes[1].samples = Eigen::VectorXd::LinSpaced(4, 0.5, 2);
  axes[1].functions = axes[1].functions.bottomRows(4).eval();
  axes[0].name = "place";
  std::swap(axes[0], axes[1]);
  modes.displacement = SeparatedField(modes.displacement.modes(), axes);
  const ReducedBody found =
      body_of_modes(modes, {.name = "found", .site = "place", .level = "force"});
  CHECK(found.levels() == Eigen::VectorXd::LinSpaced(5, 0, 1));
  CHECK((field_at(found.displacement, {2, 0.5}) - field_at(body.displacement, {2, 0.5})).norm() <=
        tolerance(1e-8, "single precision"));
  for (std::size_t s = 0; s < 6; ++s) {
    CHECK(found.sites[s].vertex == body.sites[s].vertex);
    CHECK((found.sites[s].direction - body.sites[s].direction).norm() <=
          tolerance(1e-6, "single precision"));
    CHECK(found.sites[s].full_load == Approx(1));
  }
  CHECK(found.fixed == body.fixed);
  CHECK(field_at(found.stress, {2, 0.5}).isZero(0));
  // Without a place there is one site: the field of the first.
  axes.pop_back();
  modes.displacement =
      SeparatedField(modes.displacement.modes().leftCols(1),
                     {{"force", axes[0].samples, axes[0].functions.leftCols(1), Between::kSmooth}});
  const ReducedBody one = body_of_modes(modes, {.name = "one", .level = "force"});
  CHECK(one.sites.size() == 1);
  CHECK(one.sites[0].vertex == body.sites[0].vertex);
}

TEST_CASE("modes that cannot be pressed say why", "[exchange][errors]") {
  const ForeignModes good = modes_of_body(test::pressed_ball(0.05, 0.01, 1));
  CHECK_THROWS_WITH(body_of_modes(good, {.level = "load"}),
                    Catch::Contains("no parameter 'load'") && Catch::Contains("'level'"));
  ForeignModes bad = good;
  bad.surface.triangles = bad.surface.triangles.leftCols(70).eval();
  CHECK_THROWS_WITH(body_of_modes(bad, {}), Catch::Contains("the surface is"));
  bad = good;
  bad.site_loads.col(1) *= -1;
  CHECK_THROWS_WITH(body_of_modes(bad, {}), Catch::Contains("site 1 does not give way"));
  bad = good;
  bad.site_vertices[2] = 4711;
  CHECK_THROWS_WITH(body_of_modes(bad, {}), Catch::Contains("vertex 4711"));
  bad = good;
  bad.displacement = SeparatedField(good.displacement.modes().topRows(9), good.displacement.axes());
  CHECK_THROWS_WITH(body_of_modes(bad, {}), Catch::Contains("3 or 6 values"));
}

TEST_CASE("names of files and parameters that XML has to spell otherwise come back", "[exchange]") {
  const ScratchFolder folder("modes_names");
  const std::string strange = "a & b <c> \"d\" 'e'";
  ForeignModes modes = modes_of_body(test::with_further(test::pressed_ball(0.05, 0.01, 1)));
  {
    std::vector<ParameterAxis> axes = modes.displacement.axes();
    axes.back().name = strange;
    modes.displacement = SeparatedField(modes.displacement.modes(), axes);
  }
  const fs::path file = folder / (strange + ".pxdmf");
  write_pxdmf(file, modes);
  const ForeignModes again = read_pxdmf(file);
  CHECK(again.displacement.axes().back().name == strange);
  CHECK(again.displacement.modes() == modes.displacement.modes());

  write_xdmf_series(folder / (strange + ".xdmf"), test::pressed_ball(0.05, 0.01, 1), 3);
  pugi::xml_document document;
  REQUIRE(document.load_file((folder / (strange + ".xdmf")).c_str()));
  const std::string item =
      document.select_node("//Attribute[@Name='displacement']/DataItem").node().child_value();
  const std::string heavy = strange + ".xdmf.h5";
  REQUIRE(item.substr(0, item.find(':')) == heavy);
  CHECK(hdf5::read_foreign(folder / heavy, item.substr(item.find(':') + 1)).size ==
        std::vector<std::size_t>{42, 3});
}

// What `work` throws; empty when it throws nothing.
std::string error_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) { return error.what(); }
  return {};
}

TEST_CASE("a full disk leaves XDMF and PXDMF as they were", "[exchange][errors]") {
  const ReducedBody ball = test::pressed_ball(0.05, 0.01, 1);
  const ForeignModes modes = modes_of_body(ball);
  const ScratchFolder folder("full_disk");
  const fs::path xdmf = folder / "a.xdmf", pxdmf = folder / "a.pxdmf";
  for (const bool there_before : {false, true}) {
    INFO("with files of an earlier run: " << there_before);
    if (there_before) {
      write_xdmf_series(xdmf, ball, 0);
      write_pxdmf(pxdmf, modes);
    }
    const auto contents = [&] {
      std::map<fs::path, std::string> files;
      for (const auto& entry : fs::directory_iterator(folder.path())) {
        files[entry.path()] = test::file_bytes(entry.path());
      }
      return files;
    };
    const auto before = contents();
    REQUIRE(before.size() == (there_before ? 4 : 0));
    for (const rlim_t bytes : {0, 1'000, 20'000}) {
      INFO(bytes << " bytes");
      CHECK(test::run_with_full_disk(bytes, [&] {
              const std::string first = error_of([&] { write_xdmf_series(xdmf, ball); });
              const std::string second = error_of([&] { write_pxdmf(pxdmf, modes); });
              const auto says = [](const std::string& error, const char* what) {
                return error.find(what) != std::string::npos;
              };
              return says(first, "a.xdmf") && says(first, "cannot be written: File too large") &&
                             says(second, "a.pxdmf") &&
                             says(second, "cannot be written: File too large")
                         ? 42
                         : 43;
            }) == 42);
    }
    CHECK((contents() == before));
  }
}

TEST_CASE("a damaged PXDMF file says what is wrong with it", "[exchange][errors]") {
  const ForeignModes modes = modes_of_body(test::pressed_ball(0.05, 0.01, 1));
  const std::vector<std::array<std::string, 3>> faults{
      {"</Xdmf>", "", "is no XML"},
      {"\"Triangle\"", "\"Quadrilateral\"", "no grid of triangles"},
      {"Name=\"displacement_2\"", "Name=\"velocity_2\"", "there is no displacement_2"},
      {":/vertices", ":/corners", "'/corners' is missing"},
      {"modes.pxdmf.h5:/triangles", "none.h5:/triangles", "none.h5: no such file"},
      {"Dimensions=\"42 3\"", "Dimensions=\"43 3\"", "126 numbers where its Dimensions say 129"},
      {"Dimensions=\"42 3\"", "Dimensions=\"999999999 999999999\"", "claims the size"},
      {"Format=\"HDF\"", "Format=\"Binary\"", "the format 'Binary'"},
      {"<Domain", test::repeated("<a>", 60'000) + "<Domain", "line 3: nested more than 64 deep"},
  };
  for (const auto& [what, by, says] : faults) {
    INFO(what << " -> " << by);
    const ScratchFolder folder("modes_files");
    write_pxdmf(folder.path() / "modes.pxdmf", modes);
    replace_in(folder.path() / "modes.pxdmf", what, by);
    CHECK_THROWS_WITH(read_pxdmf(folder.path() / "modes.pxdmf"), Catch::Contains(says));
  }
}

TEST_CASE("numbers in the XML itself are read, too", "[exchange]") {
  const ScratchFolder folder("modes_files");
  std::ofstream(folder.path() / "plain.pxdmf") << R"(<Xdmf><Domain>
    <Grid Name="PGD1"><Topology TopologyType="Triangle"><DataItem Dimensions="4 3">
      0 2 1  0 1 3  1 2 3  0 3 2</DataItem></Topology>
      <Geometry><DataItem Dimensions="4 3">0 0 0 1 0 0 0 1 0 0 0 1</DataItem></Geometry>
      <Attribute Name="displacement_0" AttributeType="Vector"><DataItem Dimensions="4 3">
        0 0 0 0 0 0 0 0 0 0 0 -0.1</DataItem></Attribute></Grid>
    <Grid Name="PGD2"><Information Name="Dims" Value="1"/><Information Name="Dim0" Value="level"/>
      <Topology TopologyType="Polyline"/>
      <Geometry><DataItem Dimensions="3 1">0 0.5 1</DataItem></Geometry>
      <Attribute Name="displacement_0"><DataItem Dimensions="3 1">0 0.4 1</DataItem></Attribute>
    </Grid></Domain></Xdmf>)";
  const ReducedBody body = body_of_modes(read_pxdmf(folder.path() / "plain.pxdmf"), {});
  CHECK(body.sites[0].vertex == 3);
  CHECK(body.sites[0].direction == Eigen::Vector3d(0, 0, -1));
  CHECK(field_at(body.displacement, {0, 0.5})[11] == Approx(-0.04));
  CHECK(body.press_depth(2, 0) > 0);
}

TEST_CASE("arrays that are missing or do not fit are named", "[exchange][errors]") {
  const ForeignModes modes = modes_of_body(test::pressed_ball(0.05, 0.01, 1));
  const ScratchFolder folder("modes_files");
  const fs::path there = folder.path() / "modes";
  write_numpy_modes(there, modes);
  const std::vector<float> few(6);
  const std::vector<double> falling{1, 0, 2, 3, 4, 5};
  const auto refused = [&](const std::string& file, const auto& spoil) {
    fs::copy_file(there / file, folder.path() / "kept");
    spoil(there / file);
    std::string message = "(read)";
    try {
      (void)read_numpy_modes(there);
    } catch (const Error& error) { message = error.what(); }
    fs::rename(folder.path() / "kept", there / file);
    return message;
  };
  using Catch::Contains;
  const auto gone = [](const fs::path& path) { fs::remove(path); };
  CHECK_THAT(refused("vertices.npy", gone), Contains("vertices.npy: no such file"));
  CHECK_THAT(refused("parameters.txt", gone), Contains("parameters.txt: no such file"));
  CHECK_THAT(refused("displacement_functions_1.npy",
                     [&](const fs::path& path) {
                       write_npy(path, {2, 3}, std::span<const float>(few));
                     }),
             Contains("2 x 3 where 6 modes x 5 samples"));
  CHECK_THAT(refused("samples_0.npy",
                     [&](const fs::path& path) {
                       write_npy(path, {6}, std::span<const double>(falling));
                     }),
             Contains("samples must increase"));
  CHECK_THAT(refused("triangles.npy",
                     [&](const fs::path& path) {
                       write_npy(path, {2, 3},
                                 std::span<const double>(std::vector<double>{0, 1, 2, 3, 4, 42}));
                     }),
             Contains("a vertex that is not there"));
  CHECK_THAT(refused("parameters.txt",
                     [](const fs::path& path) { std::ofstream(path) << "site maybe\n"; }),
             Contains("neither 'choice' nor 'quantity'"));
  CHECK_NOTHROW(read_numpy_modes(there));
}

TEST_CASE("presses are written as series for ParaView", "[exchange]") {
  ReducedBody ball = test::pressed_ball(0.05, 0.01, 1);
  // All six components of its stress differ.
  Eigen::MatrixXf stress = ball.stress.modes();
  for (Eigen::Index row = 0; row < stress.rows(); ++row) {
    stress.row(row).array() += static_cast<float>(100 * (row % 6 + 1));
  }
  ball.stress = SeparatedField(stress, ball.stress.axes());
  const ReducedBody solid = settled(test::with_further(ball)).value();
  const ScratchFolder folder("modes_files");
  write_vtu_series(folder.path() / "all", ball);
  CHECK(std::distance(fs::directory_iterator(folder.path() / "all"), {}) == 6 * 5 + 6);
  write_vtu_series(folder.path() / "one", solid, 2);
  CHECK(std::distance(fs::directory_iterator(folder.path() / "one"), {}) == 5 + 1);
  CHECK_THAT(text_of(folder.path() / "one" / "site_002.pvd"),
             Catch::Contains("timestep=\"0.25\" file=\"site_002_level_001.vtu\""));
  CHECK_THAT(text_of(folder.path() / "all" / "site_002_level_001.vtu").substr(0, 300),
             Catch::Contains("NumberOfPoints=\"42\" NumberOfCells=\"80\""));
  CHECK_THAT(text_of(folder.path() / "one" / "site_002_level_001.vtu").substr(0, 300),
             Catch::Contains("NumberOfPoints=\"4\" NumberOfCells=\"1\""));
  write_xdmf_series(folder.path() / "ball.xdmf", ball, 3);
  CHECK_THAT(text_of(folder.path() / "ball.xdmf"),
             Catch::Contains("ball.xdmf.h5:/displacement_3_4") &&
                 Catch::Contains("<Time Value=\"0.75\"/>"));
  CHECK(fs::exists(folder.path() / "ball.xdmf.h5"));
  // XDMF's Tensor6 is xx xy xz yy yz zz; ours is xx yy zz xy yz zx.
  const hid_t heavy =
      H5Fopen((folder.path() / "ball.xdmf.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  REQUIRE(heavy >= 0);
  const Eigen::VectorXf ours = field_at(ball.stress, {3, 1});
  std::vector<float> theirs(static_cast<std::size_t>(ours.size()));
  const hid_t table = H5Dopen2(heavy, "stress_3_4", H5P_DEFAULT);
  REQUIRE(H5Dread(table, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, theirs.data()) >= 0);
  H5Dclose(table);
  H5Fclose(heavy);
  constexpr std::array kXdmf{0, 3, 5, 1, 4, 2};
  REQUIRE((ours[0] != ours[1] && ours[1] != ours[2] && ours[4] != ours[5]));
  for (Eigen::Index v = 0; v < ours.size() / 6; ++v) {
    for (std::size_t c = 0; c < kXdmf.size(); ++c) {
      CHECK(theirs[static_cast<std::size_t>(6 * v) + c] == ours[6 * v + kXdmf[c]]);
    }
  }
  CHECK_THROWS_WITH(write_vtu_series(folder.path() / "none", ball, 6),
                    Catch::Contains("sites 0 to 5"));
}

}  // namespace

}  // namespace palpable

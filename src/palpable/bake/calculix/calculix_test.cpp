#include "palpable/bake/calculix/calculix.h"

#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/load_response.h"
#include "palpable/bake/solid/vibration_modes.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "tests/support/replaced.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <sstream>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Eigen::Matrix3Xd;
using test::replaced;
using test::tolerance;

constexpr const char* kNoCalculix = "CalculiX (ccx, Debian calculix-ccx) is not installed";

// A soft block of 0.1 m on its base; not a cube, so that swapped axes are noticed.
SolidModel block(const Material& material = material_from_young("neo-hooke-abaqus", 60e3, 0.4)) {
  SolidModel model;
  model.mesh = box_tets({0, 0, 0}, {0.1, 0.08, 0.06}, 3, 2, 2);
  model.material = material;
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (model.mesh.nodes(2, n) == 0.0) model.fixed_nodes.push_back(n);
  }
  return model;
}

Matrix3Xd push_on_top(const SolidModel& model, const Eigen::Vector3d& force) {
  Matrix3Xd load = Matrix3Xd::Zero(3, model.mesh.node_count());
  int count = 0;
  for (int n = 0; n < model.mesh.node_count(); ++n) count += model.mesh.nodes(2, n) > 0.0599;
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (model.mesh.nodes(2, n) > 0.0599) load.col(n) = force / count;
  }
  return load;
}

// A .dat file as ccx 2.20 prints it, of a body with 3 nodes and 2 elements.
const CalculixDatLayout kTwoLevels{.node_count = 3,
                                   .tet_count = 2,
                                   .levels = {0.5, 1.0},
                                   .units = {.length = 10.0, .stress = 100.0}};

std::string some_dat(int states = 2) {
  std::string text;
  for (int k = 1; k <= states; ++k) {
    text += fmt::format("\n displacements (vx,vy,vz) for set NALL and time  0.{:07d}E+{:02d}\n\n",
                        k == 1 ? 5000000 : 1000000, k == 1 ? 0 : 1);
    for (int n = 1; n <= 3; ++n) {
      text +=
          fmt::format("{:10d} {:13.6E} {:13.6E} {:13.6E}\n", n, 0.1 * n * k, -0.2 * k, 1e-12 * n);
    }
    text += fmt::format(
        "\n stresses (elem, integ.pnt.,sxx,syy,szz,sxy,sxz,syz) for set EALL and time  "
        "0.{:07d}E+{:02d}\n\n",
        k == 1 ? 5000000 : 1000000, k == 1 ? 0 : 1);
    for (int e = 1; e <= 2; ++e) {
      text += fmt::format("{:10d} {:3d} {:13.6E} {:13.6E} {:13.6E} {:13.6E} {:13.6E} {:13.6E}\n", e,
                          1, 1.0 * e, 2.0, 3.0, 4.0 * k, 5.0, 6.0);
    }
  }
  return text;
}

Result<std::vector<CalculixState>> parse(const std::string& text,
                                         const CalculixDatLayout& layout = kTwoLevels) {
  std::istringstream in(text);
  return read_calculix_dat(in, layout, "body.dat");
}

TEST_CASE("the printed results of CalculiX are read in our order and units", "[calculix][reader]") {
  const auto result = parse(some_dat());
  REQUIRE(result.ok());
  const auto& states = result.value();
  REQUIRE(states.size() == 2);
  CHECK(states[0].level == 0.5);
  CHECK(states[1].level == 1.0);
  CHECK(states[1].displacement.col(2) == Eigen::Vector3d(6, -4, 3e-11));
  // ccx prints xx yy zz xy xz yz in the deck's units; ours is xx yy zz xy yz zx in Pa.
  Eigen::Matrix<double, 6, 1> expected;
  expected << 200, 200, 300, 800, 600, 500;
  CHECK(states[1].stress.col(1) == expected);
}

TEST_CASE("fewer states than levels are accepted, as when CalculiX stops early",
          "[calculix][reader]") {
  REQUIRE(parse(some_dat(1)).ok());
  CHECK(parse(some_dat(1)).value().size() == 1);
  REQUIRE(parse("\n").ok());
  CHECK(parse("\n").value().empty());
}

TEST_CASE("an exponent of three digits, which Fortran prints without its E, is read",
          "[calculix][reader]") {
  const std::string with_e = fmt::format("{:13.6E}", 1e-12);
  const auto result = parse(replaced(some_dat(), with_e, " 2.500000-101"));
  REQUIRE(result.ok());
  CHECK(result.value()[0].displacement(2, 0) == Approx(2.5e-100));
  CHECK(parse(replaced(some_dat(), with_e, " 2.500000-999")).value()[0].displacement(2, 0) == 0.0);
}

TEST_CASE("what CalculiX cannot have printed is refused with the line",
          "[calculix][reader][errors]") {
  const std::string good = some_dat();
  const auto refusal = [](const std::string& text) {
    const auto result = parse(text);
    REQUIRE(!result.ok());
    return result.problem().message;
  };
  const std::string x = fmt::format("{:13.6E}", 0.1);
  CHECK_THAT(refusal(replaced(good, x, "          NaN")), Contains("body.dat:4: 'NaN' is not"));
  CHECK_THAT(refusal(replaced(good, x, "     Infinity")), Contains("'Infinity'"));
  CHECK_THAT(refusal(replaced(good, x, "*************")), Contains("'*************'"));
  CHECK_THAT(refusal(replaced(good, x, " 9.999999+999")), Contains("not a finite number"));
  CHECK_THAT(refusal(replaced(good, x, "")), Contains("has 3 columns"));
  CHECK_THAT(refusal(replaced(good, "         3 ", "         4 ")),
             Contains("node number '4'; there are 3"));
  CHECK_THAT(refusal(replaced(good, "         1 ", "        -1 ")), Contains("node number '-1'"));
  CHECK_THAT(refusal(replaced(good, "         3 ", "         2 ")), Contains("node 2 comes twice"));
  CHECK_THAT(refusal(replaced(good, "   1  1.000000E+00", "   2  1.000000E+00")),
             Contains("integration point '2'"));
  CHECK_THAT(refusal(replaced(good, "0.5000000E+00", "0.6000000E+00")),
             Contains("time 0.6 where level 0.5"));
  CHECK_THAT(refusal(replaced(good, "stresses", "strains ")), Contains("heading of the stresses"));
  CHECK_THAT(refusal(good + good), Contains("after all 2 levels"));
  CHECK_THAT(refusal("\x7f"
                     "ELF\x02\x01"),
             Contains("heading of the displacements"));
}

TEST_CASE("a file that is cut off anywhere gives whole states or one clear line",
          "[calculix][reader][errors]") {
  const std::string good = some_dat();
  const std::size_t one = some_dat(1).size();
  int accepted = 0;
  for (std::size_t size = 0; size < good.size(); ++size) {
    const auto result = parse(good.substr(0, size));
    if (!result.ok()) {
      CHECK_THAT(result.problem().message, Contains("body.dat:"));
      continue;
    }
    ++accepted;
    const std::size_t whole = result.value().size();
    // The reader cannot notice a cut within the last number of a state; ccx's exit code reveals it.
    CHECK(whole <= (size < one - 30 ? 0u : size < good.size() - 30 ? 1u : 2u));
  }
  CHECK(accepted < 100);
}

TEST_CASE("no damage to a file of results makes the reader crash or return what is not finite",
          "[calculix][reader][errors]") {
  const std::string good = some_dat();
  for (unsigned seed = 0; seed < 2000; ++seed) {
    auto random = test::random_case(seed);
    std::string text = good;
    const int changes = 1 + static_cast<int>(random() % 4);
    for (int k = 0; k < changes; ++k) {
      const std::size_t at = random() % text.size();
      switch (random() % 3) {
        case 0:
          text[at] = static_cast<char>(random() % 256);
          break;
        case 1:
          text.erase(at, random() % 40);
          break;
        default:
          text.insert(at, text.substr(random() % text.size(), random() % 40));
      }
      if (text.empty()) text.push_back('x');
    }
    INFO("seed " << seed);
    const auto result = parse(text);
    if (!result.ok()) {
      CHECK(result.problem().message.find('\n') == std::string::npos);
      continue;
    }
    for (const CalculixState& state : result.value()) {
      CHECK(state.displacement.allFinite());
      CHECK(state.stress.allFinite());
    }
  }
}

TEST_CASE("CalculiX' message becomes one line", "[calculix]") {
  CHECK(calculix_error(" STEP 1\n\n *ERROR in e_c3d: nonpositive jacobian\n        determinant in "
                       "element          12\n *ERROR in e_c3d: again\n") ==
        "in e_c3d: nonpositive jacobian determinant in element 12");
  CHECK(calculix_error("\n *ERROR: increment size smaller than minimum\n best solution and "
                       "residuals are in the frd file\n\n") ==
        "increment size smaller than minimum best solution and residuals are in the frd file");
  CHECK(calculix_error(" Job finished\n").empty());
  CHECK(calculix_error(" *ERROR").empty());
}

TEST_CASE("no field of a deck is longer than the twenty characters that CalculiX reads",
          "[calculix][deck]") {
  SolidModel model = block();
  model.mesh.nodes *= std::numbers::pi * 1e-3;  // numbers with all digits
  const Matrix3Xd everywhere =
      Matrix3Xd::Constant(3, model.mesh.node_count(), -std::numbers::pi * 1e-7);
  std::istringstream deck(calculix_deck(model, everywhere, std::array{1.0 / 3.0, 1.0}));
  std::string line;
  long fields = 0;
  while (std::getline(deck, line)) {
    if (line.starts_with("*")) continue;
    std::istringstream row(line);
    for (std::string field; std::getline(row, field, ','); ++fields) {
      INFO(line);
      CHECK(field.size() <= 20);
    }
  }
  CHECK(fields > 500);
}

TEST_CASE("a node of a deck is the node of the model to thirteen digits", "[calculix][deck]") {
  SolidModel model = block();
  model.mesh.nodes *= -std::numbers::pi * 1e-3;
  model.mesh.tets.row(2).swap(model.mesh.tets.row(3));  // the mirror image is inside out again
  const Matrix3Xd everywhere = Matrix3Xd::Constant(3, model.mesh.node_count(), 1e-6);
  std::istringstream deck(calculix_deck(model, everywhere, std::array{1.0}));
  std::string line;
  while (std::getline(deck, line) && !line.starts_with("*NODE")) {}
  const double metre = calculix_units(model).length;
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    REQUIRE(std::getline(deck, line));
    int index = 0;
    std::array<double, 3> X{};
    REQUIRE(std::sscanf(line.c_str(), "%d,%lf,%lf,%lf", &index, &X[0], &X[1], &X[2]) == 4);
    CHECK(index == n + 1);
    for (int i = 0; i < 3; ++i) {
      const double exact = model.mesh.nodes(i, n);
      CHECK(std::abs(metre * X[i] - exact) <=
            tolerance(1e-12, "13 significant digits") * std::abs(exact));
    }
  }
}

TEST_CASE("a body or load that CalculiX cannot be given is refused before it is started",
          "[calculix][errors]") {
  const std::array full{1.0};
  const auto solve = [&](const SolidModel& model, const Matrix3Xd& load) {
    return solve_with_calculix(model, load, full, {.program = "/nowhere/ccx", .folder = {}});
  };
  const SolidModel good = block();
  const Matrix3Xd load = push_on_top(good, {0, 0, -1});
  CHECK_THROWS_WITH(solve(block(material_from_young("neo-hookean", 6e4, 0.3)), load),
                    Contains("no law like neo-hookean") && Contains("neo-hooke-abaqus"));
  SolidModel free = good;
  free.fixed_nodes.clear();
  CHECK_THROWS_AS(solve(free, load), Error);
  CHECK_THROWS_WITH(solve(good, load.leftCols(5)), Contains("5 nodal forces"));
  CHECK_THROWS_WITH(solve(good, 0.0 * load), Contains("load is zero"));
  CHECK_THROWS_WITH(solve(good, Matrix3Xd(load / 0.0)), Contains("not finite"));
  CHECK_THROWS_AS(calculix_deck(good, load, std::array{0.5, 0.5}), ContractViolation);
  CHECK_THROWS_WITH(solve(good, load), Contains("/nowhere/ccx") && Contains("calculix-ccx"));
}

// A shell script that runs in place of ccx.
std::filesystem::path stand_in(const test::ScratchFolder& folder, const std::string& script) {
  const std::filesystem::path path = folder / "stand-in";
  test::write_bytes(path, "#!/bin/sh\n" + script + "\n");
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  return path;
}

TEST_CASE("whatever becomes of the CalculiX process, the error is one line that says what",
          "[calculix][errors]") {
  const test::ScratchFolder folder("calculix_process");
  const SolidModel model = block();
  const Matrix3Xd load = push_on_top(model, {0, 0, -1});
  const auto error = [&](const std::string& script) -> std::string {
    const CalculixSettings settings{.program = stand_in(folder, script).string(),
                                    .folder = folder / "run"};
    try {
      static_cast<void>(solve_with_calculix(model, load, std::array{0.5, 1.0}, settings));
    } catch (const Error& thrown) { return thrown.what(); }
    return "no error";
  };
  CHECK_THAT(error("echo ' *ERROR in calinput: no such thing'; exit 201"),
             Contains("CalculiX failed: in calinput: no such thing (see ") && Contains("body.log"));
  CHECK_THAT(error("exit 3"), Contains("exit code 3"));
  CHECK_THAT(error("kill -9 $$"), Contains("ended by signal 9"));
  CHECK_THAT(error("exit 0"), Contains("printed 0 of 2 levels"));
  CHECK_THAT(error("echo garbage > body.dat"), Contains("body.dat:1: 'garbage'"));
}

TEST_CASE("CalculiX gets one thread, whatever the caller's environment asks for", "[calculix]") {
  const test::ScratchFolder folder("calculix_environment");
  ::setenv("OMP_NUM_THREADS", "7", 1);
  ::setenv("CCX_NPROC_STIFFNESS", "7", 1);
  const SolidModel model = block();
  const CalculixSettings settings{.program = stand_in(folder, "env > seen; exit 1").string(),
                                  .folder = folder / "run"};
  CHECK_THROWS_AS(
      solve_with_calculix(model, push_on_top(model, {0, 0, -1}), std::array{1.0}, settings), Error);
  ::unsetenv("OMP_NUM_THREADS");
  ::unsetenv("CCX_NPROC_STIFFNESS");
  const std::string seen = test::file_bytes(folder / "run/seen");
  CHECK_THAT(seen, Contains("OMP_NUM_THREADS=1\n"));
  CHECK_THAT(seen, !Contains("CCX_NPROC"));
}

TEST_CASE("a solve by CalculiX reports its way, prints every level and leaves nothing behind",
          "[calculix]") {
  if (!find_calculix()) PALPABLE_SKIP(kNoCalculix);
  const SolidModel model = block();
  const Matrix3Xd load = push_on_top(model, {0.6, 0.3, -1.5});
  const std::array levels{0.2, 0.5, 1.0};
  const test::ScratchFolder temporary("calculix_temporary");
  const char* const before = std::getenv("TMPDIR");
  const std::string restore = before != nullptr ? before : "";
  ::setenv("TMPDIR", temporary.path().c_str(), 1);
  std::vector<ProgressReport> reports;
  const CalculixRun run = solve_with_calculix(
      model, load, levels, {}, [&](const ProgressReport& report) { reports.push_back(report); });
  restore.empty() ? ::unsetenv("TMPDIR") : ::setenv("TMPDIR", restore.c_str(), 1);
  CHECK(std::filesystem::is_empty(temporary.path()));
  CHECK(run.complete);
  CHECK(run.why_stopped.empty());
  REQUIRE(run.states.size() == 3);
  CHECK(run.increments >= 3);
  CHECK(run.iterations >= run.increments);
  CHECK(run.last_level == Approx(1.0));
  CHECK((run.cpu_seconds > 0.0 && run.cpu_seconds < 10.0));
  REQUIRE(!reports.empty());
  CHECK(reports.back().done == 3.0);
  CHECK(reports.back().total == 3.0);
  for (const int n : model.fixed_nodes) {
    CHECK(run.states[2].displacement.col(n) == Eigen::Vector3d::Zero());
  }
}

TEST_CASE("the residual that CalculiX leaves is as small as asked for, however soft the body",
          "[calculix]") {
  if (!find_calculix()) PALPABLE_SKIP(kNoCalculix);
  // Written in newtons, the soft block would not be solved at all (ccx takes any residual below
  // 1e-6 in the deck's unit for zero); written in pascals, the stiff one would get another bulk
  // modulus (ccx takes D1 below 1e-10 in the deck's unit for not given).
  for (const char* law : {"saint-venant-kirchhoff", "neo-hooke-abaqus"}) {
    for (const double E : {1e-4, 60e3, 2e11}) {
      INFO(law << ", E = " << E << " Pa");
      const SolidModel model = block(material_from_young(law, E, 0.4));
      const Matrix3Xd load = push_on_top(model, 4e-4 * E * Eigen::Vector3d(0.1, 0.05, -1.0));
      const CalculixRun run = solve_with_calculix(model, load, std::array{1.0});
      REQUIRE(run.complete);
      const Matrix3Xd& u = run.states.back().displacement;
      CHECK(u.cwiseAbs().maxCoeff() > 0.003);  // not the linear problem
      Matrix3Xd left_over = EquilibriumSolver(model).internal_force(u) - load;
      for (const int n : model.fixed_nodes) left_over.col(n).setZero();
      CHECK(left_over.norm() / load.norm() <=
            tolerance(3e-6,
                      "seven printed digits of u, times the stiffness of an element over that "
                      "of the body"));
    }
  }
}

TEST_CASE("CalculiX stretches ten-node tetrahedra as the closed form says, at all four points",
          "[calculix]") {
  if (!find_calculix()) PALPABLE_SKIP(kNoCalculix);
  SolidModel model;
  model.mesh = with_edge_nodes(box_tets({0, 0, 0}, {1, 0.8, 0.6}, 1, 1, 1));
  model.material = NeoHookeanAbaqus{.C10 = 200, .D1 = 0.001};
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (model.mesh.nodes.col(n) != Eigen::Vector3d(0.5, 0.4, 0.3)) model.fixed_nodes.push_back(n);
  }
  model.fixed_displacement =
      Eigen::Vector3d(0.5, 0, 0).asDiagonal() * model.mesh.nodes(Eigen::all, model.fixed_nodes);
  const CalculixRun run =
      solve_with_calculix(model, Matrix3Xd::Zero(3, model.mesh.node_count()), std::array{1.0});
  REQUIRE(run.complete);
  CHECK((run.states[0].displacement.row(0) - 0.5 * model.mesh.nodes.row(0)).cwiseAbs().maxCoeff() <=
        tolerance(1e-6, "seven printed digits"));
  const auto xx = run.states[0].stress.row(0);
  REQUIRE(xx.size() == 4 * model.mesh.tet_count());
  // tests/verification has the formula.
  CHECK((xx.array() - 1169.587).abs().maxCoeff() <= tolerance(2e-3, "seven printed digits"));
}

// A .dat file of *FREQUENCY as ccx 2.20 prints it.
const std::string kFrequencies = R"(
                        S T E P       1


     E I G E N V A L U E   O U T P U T

 MODE NO    EIGENVALUE                       FREQUENCY
                                     REAL PART            IMAGINARY PART
                           (RAD/TIME)      (CYCLES/TIME     (RAD/TIME)

      1   0.6442449E-04   0.8026487E-02   0.1277455E-02   0.0000000E+00
      2   0.6442449E-04   0.8026487E-02   0.1277455E-02   0.0000000E+00
      3   0.2400000E-02   0.4898979E-01   0.7796969E-02   0.0000000E+00

     P A R T I C I P A T I O N   F A C T O R S

MODE NO.   X-COMPONENT     Y-COMPONENT
      1   0.1000000E+01   0.1000000E+01   0.1000000E+01   0.1000000E+01
)";

TEST_CASE(
    "the printed frequencies of CalculiX are read, and what it cannot have printed is refused",
    "[calculix][reader]") {
  const auto read = [](const std::string& text, int modes) {
    std::istringstream in(text);
    return read_calculix_eigenvalues(in, modes, "body.dat");
  };
  const std::vector<double> values = value_or_throw(read(kFrequencies, 3));
  CHECK(values == std::vector<double>{0.6442449e-4, 0.6442449e-4, 0.0024});
  CHECK(value_or_throw(read(kFrequencies, 2)).size() == 2);
  CHECK_THAT(read(kFrequencies, 4).problem().message,
             Contains("body.dat:") && Contains("no row of eigenvalue 4"));
  CHECK_THAT(read(kFrequencies.substr(0, kFrequencies.find("      3 ")), 3).problem().message,
             Contains("body.dat: ends after"));
  CHECK_THAT(read("", 1).problem().message, Contains("ends after 0 of 1"));
  CHECK_FALSE(read(replaced(kFrequencies, "0.2400000E-02", "NaN"), 3).ok());
  CHECK_FALSE(read(replaced(kFrequencies, "0.2400000E-02", "0.1000000E-05"), 3).ok());
  CHECK_FALSE(read(replaced(kFrequencies, "      3   ", "      4   "), 3).ok());
  for (std::size_t cut = 0; cut < kFrequencies.size(); cut += 7) {
    const auto some = read(kFrequencies.substr(0, cut), 3);
    if (some.ok()) CHECK(some.value().size() == 3);
  }
}

TEST_CASE("CalculiX finds the same frequencies on the same mesh", "[calculix][vibration]") {
  if (!find_calculix()) PALPABLE_SKIP(kNoCalculix);
  constexpr double kDensity = 1070;
  // Soft and stiff, so that the units of decks differ; a block, and a slender one whose lowest
  // modes are 30 times slower.
  for (const double E : {60e3, 2e9}) {
    for (const int kind : {0, 1, 2}) {
      SolidModel model = block(material_from_young("saint-venant-kirchhoff", E, 0.4));
      if (kind == 1) model.mesh = with_edge_nodes(model.mesh);
      if (kind == 2) model.mesh = with_edge_nodes(box_tets({0, 0, 0}, {0.01, 0.02, 0.2}, 1, 2, 12));
      model.fixed_nodes.clear();
      for (int n = 0; n < model.mesh.node_count(); ++n) {
        if (model.mesh.nodes(2, n) == 0.0) model.fixed_nodes.push_back(n);
      }
      const LoadResponse body(model);
      const VibrationModes own = vibration_modes(body, kDensity, {.least = 12, .below = 0});
      const VibrationModes with_their_mass =
          vibration_modes(body, calculix_mass(model.mesh, kDensity), {.least = 12, .below = 0});
      const std::vector<double> theirs = frequencies_by_calculix(model, kDensity, 12);
      INFO("E = " << E << ", body " << kind);
      for (int k = 0; k < 12; ++k) {
        INFO("mode " << k << ": " << own.omega[k] << ", with CalculiX' mass "
                     << with_their_mass.omega[k] << ", by CalculiX " << theirs[k] << " rad/s");
        CHECK(std::abs(with_their_mass.omega[k] - theirs[k]) <=
              tolerance(1e-6, "seven printed digits of omega^2, the same elements") * theirs[k]);
        // The slender body has five quadratic elements and more in a wave of these modes.
        if (kind != 2) continue;
        CHECK(std::abs(own.omega[k] - theirs[k]) <=
              tolerance(1e-3, "CalculiX' rule for the mass") * theirs[k]);
      }
    }
  }
}

TEST_CASE("of a block of 10-node tetrahedra CalculiX finds our frequencies within a thousandth",
          "[calculix][vibration][long]") {
  if (!find_calculix()) PALPABLE_SKIP(kNoCalculix);
  SolidModel model = block(material_from_young("saint-venant-kirchhoff", 60e3, 0.4));
  model.mesh = with_edge_nodes(box_tets({0, 0, 0}, {0.1, 0.08, 0.06}, 9, 7, 6));
  model.fixed_nodes.clear();
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (model.mesh.nodes(2, n) == 0.0) model.fixed_nodes.push_back(n);
  }
  const VibrationModes own = vibration_modes(LoadResponse(model), 1070, {.least = 12, .below = 0});
  const std::vector<double> theirs = frequencies_by_calculix(model, 1070, 12);
  for (int k = 0; k < 12; ++k) {
    INFO("mode " << k << ": " << own.omega[k] << ", by CalculiX " << theirs[k] << " rad/s");
    CHECK(std::abs(own.omega[k] - theirs[k]) <=
          tolerance(1e-3, "CalculiX' rule for the mass") * theirs[k]);
  }
}

TEST_CASE("a law that is not asked of CalculiX for its vibration is refused",
          "[calculix][errors]") {
  CHECK_THROWS_WITH(frequencies_by_calculix(block(), 1000, 3),
                    Contains("neo-hooke-abaqus") && Contains("saint-venant-kirchhoff"));
}

TEST_CASE("where CalculiX gives up, the states reached so far are returned", "[calculix]") {
  if (!find_calculix()) PALPABLE_SKIP(kNoCalculix);
  // St. Venant-Kirchhoff collapses below 0.58 of its height.
  const SolidModel model = block(material_from_young("saint-venant-kirchhoff", 60e3, 0.3));
  const Matrix3Xd load = push_on_top(model, {0, 0, -400});
  const std::array levels{0.05, 0.1, 1.0};
  const CalculixRun run = solve_with_calculix(model, load, levels);
  CHECK(!run.complete);
  CHECK(run.states.size() == 2);
  CHECK((run.last_level > 0.1 && run.last_level < 1.0));
  CHECK_THAT(run.why_stopped, Contains("load level 1 was not reached") &&
                                  Contains("increment size smaller than minimum"));
}

TEST_CASE("an exception from the progress callback stops CalculiX", "[calculix]") {
  const test::ScratchFolder folder("calculix_cancel");
  const SolidModel model = block();
  struct Cancelled {};
  const CalculixSettings settings{
      .program = stand_in(folder, "echo $$ > pid; exec sleep 60").string(),
      .folder = folder / "run"};
  const auto start = std::chrono::steady_clock::now();
  CHECK_THROWS_AS(solve_with_calculix(model, push_on_top(model, {0, 0, -1}), std::array{1.0},
                                      settings, [](const ProgressReport&) { throw Cancelled(); }),
                  Cancelled);
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(30));
  const int pid = std::atoi(test::file_bytes(folder / "run/pid").c_str());
  REQUIRE(pid > 0);
  CHECK(::kill(pid, 0) == -1);  // gone
}

TEST_CASE("a D1 that CalculiX would take for missing is refused", "[calculix][deck]") {
  SolidModel model = block(material_from_young("neo-hooke-abaqus", 60e3, 0.499999999));
  const Matrix3Xd push = push_on_top(model, {0, 0, -1});
  const auto deck = [&] { return calculix_deck(model, push, std::array{1.0}, 1e-4); };
  CHECK_THROWS_WITH(deck(), Contains("BODY for missing") && Contains("Poisson's ratio to 0.475"));
  // A stiff part of a soft body: the units are those of the body.
  model.material = material_from_young("neo-hooke-abaqus", 60e3, 0.4);
  CHECK_NOTHROW(deck());
  model.groups.push_back({material_from_young("neo-hooke-abaqus", 210e9, 0.4999), {0}});
  CHECK_THROWS_WITH(deck(), Contains("GROUP1 for missing"));
}

TEST_CASE("a deck has the Poisson's ratio of the body, close to 0.5, too", "[calculix][deck]") {
  // CalculiX takes 0.475 where D1 is 0 or left out.
  for (const double nu : {0.0, 0.3, 0.475, 0.499, 0.4999999}) {
    for (const char* law : {"neo-hooke-abaqus", "saint-venant-kirchhoff"}) {
      INFO(law << ", nu " << nu);
      const SolidModel model = block(material_from_young(law, 60e3, nu));
      const std::string deck =
          calculix_deck(model, push_on_top(model, {0, 0, -1}), std::array{1.0}, 1e-4);
      const bool hyperelastic = std::string(law) == "neo-hooke-abaqus";
      const std::string heading = hyperelastic ? "*HYPERELASTIC, NEO HOOKE\n" : "*ELASTIC\n";
      const std::size_t at = deck.find(heading);
      REQUIRE(at != std::string::npos);
      std::istringstream row(deck.substr(at + heading.size()));
      double first = 0, second = 0;
      char comma = 0;
      row >> first >> comma >> second;
      REQUIRE(comma == ',');
      // mu = 2 C10, kappa = 2 / D1, in the deck's units, which cancel.
      const double mu = 2 * first, kappa = 2 / second;
      const double told = hyperelastic ? (3 * kappa - 2 * mu) / (6 * kappa + 2 * mu) : second;
      CHECK(told == Approx(nu).epsilon(0).margin(tolerance(1e-12, "12 digits in the deck")));
    }
  }
}

}  // namespace
}  // namespace palpable

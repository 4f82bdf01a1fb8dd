#include "palpable/live/session/refiner.h"

#include "tests/support/allocations.h"
#include "tests/support/ball_gap.h"
#include "tests/support/elastic_sheet.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <unistd.h>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;

using Eigen::Matrix3Xf;
using Eigen::Vector3f;

const std::string kStays = "exec cat > /dev/null";

void write_file(const fs::path& path, const std::vector<std::byte>& bytes) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

// A sheet under a ball, and a program that writes prepared bytes whatever it reads.
struct Pressed {
  test::ScratchFolder folder{"refiner"};
  test::ElasticSheet body;
  TouchSettings settings;
  TouchSolver solver{body.skin, body.fixed, body.tables, settings};
  TouchState state;
  TouchReport report;
  std::vector<std::byte> output;
  test::GapFunction gap = test::gap_to_ball(Vector3f(0, 0, 0.017f), 0.02f);
  test::GapFunction nothing = test::nothing_near();

  // Writes kReady, and the right solution of the probe.
  void write_start(float probe_factor = 1) {
    RequestedLoad probe;
    solver.probe(probe);
    std::vector<std::byte> bytes;
    write_ready(static_cast<int>(probe.tables.cols()), bytes);
    write(bytes);
    write_solution(1, Matrix3Xf(probe_factor * probe.tables), bytes);
    write(bytes);
  }
  // Shell commands by which the program solves the first load: an eighth more than the tables.
  std::string solve_load() {
    TouchState pressed;
    RequestedLoad load;
    std::vector<std::byte> bytes;
    solver.probe(load);
    write_load(1, load.forces, bytes);
    std::size_t bytes_read = bytes.size();
    solver.advance(pressed, gap);
    REQUIRE(solver.request(pressed, load));
    write_load(2, load.forces, bytes);
    bytes_read += bytes.size();
    write_solution(2, Matrix3Xf(1.125f * load.tables), bytes);
    write_file(folder / "solution", bytes);
    return "head -c " + std::to_string(bytes_read) + " > /dev/null\ncat '" +
           (folder / "solution").string() + "'\n" + kStays;
  }
  void write(const std::vector<std::byte>& bytes) {
    output.insert(output.end(), bytes.begin(), bytes.end());
  }
  // @param then  shell commands of the program after that
  Refiner refiner(const RefinerSettings& how, const std::string& then = kStays) {
    write_file(folder / "output", output);
    std::ofstream(folder / "program") << "#!/bin/sh\ncat \"$2\"\n" << then << "\n";
    fs::permissions(folder / "program", fs::perms::owner_all);
    RefinerSettings wanted = how;
    wanted.program = folder / "program";
    wanted.description = folder / "output";
    return std::move(Refiner::start(wanted).value());
  }
  void frame(Refiner& refiner, const test::GapFunction& seen) {
    refiner.begin_frame(solver, state);
    report = solver.advance(state, seen);
    refiner.end_frame(solver, state, report);
  }
};

const RefinerSettings kWaits{.latency = 4, .waits = true, .patience = 20};
const RefinerSettings kDoesNotWait{.latency = 4, .waits = false};

TEST_CASE("a full-order solution is taken up a fixed number of frames after it was requested",
          "[session]") {
  Pressed pressed;
  pressed.write_start();
  Refiner refiner = pressed.refiner(kWaits, pressed.solve_load());
  for (int n = 0; n < 3; ++n) pressed.frame(refiner, pressed.nothing);
  CHECK(refiner.counts().asked == 0);
  pressed.frame(refiner, pressed.gap);
  CHECK(refiner.counts().asked == 1);
  const Matrix3Xf first = pressed.state.u;
  for (int n = 1; n < kWaits.latency; ++n) {
    pressed.frame(refiner, pressed.gap);
    CHECK(refiner.counts().taken_up == 0);
    CHECK_FALSE(pressed.state.refinement.acts());
  }
  pressed.frame(refiner, pressed.gap);
  CHECK(refiner.counts().taken_up == 1);
  CHECK(pressed.state.refinement.blended == Approx(1.0 / 6));
  CHECK(pressed.state.refinement.weights[1] > 0.1f);
  CHECK_FALSE(refiner.take_trouble());
}

TEST_CASE("a recording that waits for its solutions is the same again", "[session]") {
  std::vector<Matrix3Xf> states;
  for (int times = 0; times < 2; ++times) {
    Pressed pressed;
    pressed.write_start();
    // The time that the solution takes changes nothing.
    const std::string takes = times == 0 ? "" : "sleep 0.3\n";
    Refiner refiner = pressed.refiner(kWaits, takes + pressed.solve_load());
    for (int n = 0; n < 9; ++n) pressed.frame(refiner, pressed.gap);
    CHECK(refiner.counts().taken_up == 1);
    states.push_back(pressed.state.u);
  }
  CHECK(std::memcmp(states[0].data(), states[1].data(),
                    sizeof(float) * static_cast<std::size_t>(states[0].size())) == 0);
}

TEST_CASE("recorded requests and solutions are repeated in a replay", "[session]") {
  std::vector<RefinerStep> steps;
  std::vector<Matrix3Xf> states;
  int asked = 0;
  {
    Pressed pressed;
    pressed.write_start();
    Refiner refiner = pressed.refiner(kWaits, pressed.solve_load());
    for (int n = 0; n < 9; ++n) {
      pressed.frame(refiner, n < 2 ? pressed.nothing : pressed.gap);
      RefinerStep& step = steps.emplace_back();
      step.asked = refiner.asked();
      if (const Matrix3Xf* exact = refiner.taken_up()) step.exact = *exact;
      states.push_back(pressed.state.u);
    }
    REQUIRE(refiner.counts().taken_up == 1);
    asked = refiner.counts().asked;
  }
  CHECK(steps[2].asked);
  CHECK(steps[2 + kWaits.latency].exact.cols() > 0);
  Pressed again;
  Refiner refiner = Refiner::repeating([&](int n, RefinerStep& step) { step = steps.at(n); });
  for (int n = 0; n < 9; ++n) {
    INFO("frame " << n);
    again.frame(refiner, n < 2 ? again.nothing : again.gap);
    CHECK(again.state.u == states[n]);
    CHECK(refiner.asked() == steps[n].asked);
    CHECK((refiner.taken_up() != nullptr) == (steps[n].exact.cols() > 0));
  }
  CHECK(refiner.counts().asked == asked);
  CHECK(refiner.counts().taken_up == 1);
  CHECK(again.state.refinement.acts());
  CHECK_FALSE(refiner.take_trouble());
}

TEST_CASE("a recorded solution that does not fit the body is skipped", "[session][errors]") {
  Pressed pressed;
  Pressed plain;
  Refiner refiner = Refiner::repeating([](int, RefinerStep& step) {
    step.asked = true;
    step.exact.setConstant(3, 5, 0.01F);
  });
  for (int n = 0; n < 4; ++n) {
    pressed.frame(refiner, pressed.gap);
    plain.solver.advance(plain.state, plain.gap);
  }
  CHECK(pressed.state.u == plain.state.u);
  CHECK(refiner.counts().taken_up == 0);
}

TEST_CASE("a solution that a camera would have to wait for is dropped", "[session]") {
  Pressed pressed;
  pressed.write_start();
  Refiner refiner = pressed.refiner(kDoesNotWait);
  for (int n = 0; n < 400 && refiner.counts().late == 0; ++n) {
    pressed.frame(refiner, pressed.gap);
    // The program takes some time to start.
    if (refiner.counts().asked == 0) ::usleep(10'000);
  }
  CHECK(refiner.counts().late == 1);
  for (int n = 0; n < 10; ++n) pressed.frame(refiner, pressed.gap);
  // Nothing else is requested while the program is busy.
  CHECK(refiner.counts().asked == 1);
  CHECK(refiner.counts().taken_up == 0);
  CHECK_FALSE(pressed.state.refinement.acts());
}

TEST_CASE(
    "a program that dies, sends rubbish or has another body is reported once, and contact "
    "continues",
    "[session]") {
  struct Case {
    std::string why;
    std::function<void(Pressed&)> prepare;
    std::string then;
  };
  std::vector<std::byte> bytes;
  const std::vector<Case> cases{
      {"it ended with exit code 3", [](Pressed&) {}, "exit 3"},
      {"it ended with exit code 4", [](Pressed& p) { p.write_start(); }, "exit 4"},
      {"it ended by signal 9 (Killed)", [](Pressed& p) { p.write_start(); }, "kill -9 $$"},
      {"it sent an invalid message", [](Pressed&) {},
       "echo palpable-bake: what kind of program is this; sleep 9"},
      {"it sent an invalid message",
       [&](Pressed& p) {
         p.write_start();
         write_solution(2, Matrix3Xf::Zero(3, 5).eval(), bytes);
         p.write(bytes);
       },
       kStays},
      {"it was started for another body",
       [&](Pressed& p) {
         write_ready(5, bytes);
         p.write(bytes);
       },
       kStays},
      {"it was started for another body", [](Pressed& p) { p.write_start(1.2f); }, kStays},
      {"no such material",
       [&](Pressed& p) {
         write_sorry("no such material", bytes);
         p.write(bytes);
       },
       "exit 0"},
      {"no solution came within 0.2 s", [](Pressed& p) { p.write_start(); }, kStays},
  };
  Pressed plain;
  for (int n = 0; n < 9; ++n) plain.solver.advance(plain.state, plain.gap);
  for (const Case& one : cases) {
    INFO(one.why);
    Pressed pressed;
    one.prepare(pressed);
    RefinerSettings settings = kWaits;
    settings.patience = one.why.starts_with("no solution") ? 0.2 : 20;
    Refiner refiner = pressed.refiner(settings, one.then);
    std::vector<std::string> troubles;
    for (int n = 0; n < 9; ++n) {
      pressed.frame(refiner, pressed.gap);
      if (auto trouble = refiner.take_trouble()) troubles.push_back(*trouble);
    }
    REQUIRE(troubles.size() == 1);
    CHECK(troubles[0] == "--refine " + (pressed.folder / "output").string() + ": " + one.why +
                             "; contact continues without it");
    CHECK(pressed.state.u == plain.state.u);
    CHECK(refiner.counts().taken_up == 0);
  }
}

TEST_CASE("what is wrong with a description is said before the run begins", "[session][errors]") {
  const test::ScratchFolder folder("refine_check");
  const fs::path program = folder / "program";
  const auto trouble = [&](const std::string& commands) {
    std::ofstream(program)
        << "#!/bin/sh\n[ \"$1 $2 $3\" = 'refine --check-description x.toml' ] || exit 9\n"
        << commands << "\n";
    fs::permissions(program, fs::perms::owner_all);
    return Refiner::trouble_of_description({.program = program, .description = "x.toml"});
  };
  CHECK(trouble("exit 0").empty());
  CHECK(trouble("exit 5").empty());  // that it does not work is said when it is started
  CHECK(trouble("sleep 0.2; echo 'x.toml: line 3: none'; echo more") == "x.toml: line 3: none");
  CHECK(trouble("yes x | head -c 100000 | tr -d '\\n'").size() > 4000);
  CHECK(Refiner::trouble_of_description({.program = folder / "none", .description = "x.toml"})
            .empty());
}

TEST_CASE("a program that does not start is a problem", "[session]") {
  const auto result = Refiner::start({.program = "/no/such/program", .description = "x.toml"});
  REQUIRE_FALSE(result.ok());
  CHECK(result.problem().message.find("/no/such/program") != std::string::npos);
}

TEST_CASE("refined frames allocate nothing", "[session]") {
  Pressed pressed;
  pressed.write_start();
  Refiner refiner = pressed.refiner(kWaits, pressed.solve_load());
  pressed.frame(refiner, pressed.gap);
  for (int n = 0; n < 3; ++n) {
    CHECK(test::allocations_during([&] { pressed.frame(refiner, pressed.gap); }) == 0);
  }
  // The correction has its room from the first solution on.
  pressed.frame(refiner, pressed.gap);
  for (int n = 0; n < 4; ++n) {
    CHECK(test::allocations_during([&] { pressed.frame(refiner, pressed.gap); }) == 0);
  }
}

}  // namespace
}  // namespace palpable

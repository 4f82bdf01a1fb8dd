#include "palpable/common/body_file/body_file.h"

#include "palpable/common/base/output_file.h"
#include "palpable/common/body_file/body_file_groups.h"
#include "palpable/common/body_file/hdf5_tools.h"
#include "tests/support/bodies.h"
#include "tests/support/test.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <thread>
#include <unistd.h>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using test::tolerance;

// A folder of its own for each test case, removed afterwards.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / fmt::format("palpable_body_file_{}", ::getpid())) {
    fs::create_directories(path_);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() { fs::remove_all(path_); }
  [[nodiscard]] fs::path operator/(const char* name) const { return path_ / name; }

 private:
  fs::path path_;
};

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void write_bytes(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

ReducedBody small_ball() { return test::pressed_ball(0.05, 0.01, 1); }

// A body with further parameters, a volume, and the error between sites.
ReducedBody full_ball() {
  ReducedBody body = test::with_further(small_ball());
  body.error = {1e-4, 2e-3, 3e-4, 4e-3, 0, 0, 0.26};
  return body;
}

// The same with error courses, over 6 sites x 4 levels x 9 combinations of further values.
ReducedBody reported_ball() {
  ReducedBody body = full_ball();
  body.method = "pgd";
  body.provenance.loads = "6 sites";
  body.provenance.sites_reached = 5;
  body.provenance.held_out_values = {{"softness", 0.1, "wrong by a hair"}};
  ErrorCourse course{Eigen::Vector3i(1, 2, 5), Eigen::Vector3d(0.1, 0.02, 0.003),
                     Eigen::MatrixXf(6 * 4 * 9, 3)};
  for (Eigen::Index k = 0; k < course.snapshots.size(); ++k) {
    course.snapshots.data()[k] = 1e-3f * static_cast<float>(k);
  }
  body.error.displacement_course = course;
  course.pooled *= 2;
  body.error.stress_course = course;
  course.modes[2] = 7;
  body.error.von_mises_course = course;
  body.error.held_out = HeldOutRecord{Eigen::Vector2d(0.25, 0.75), course.snapshots.topRows(2),
                                      3e-4, course.snapshots.middleRows(2, 2)};
  body.error.held_out->displacement.conservativeResize(2, 6);
  body.error.held_out->displacement.rightCols(3).setConstant(0.5f);
  body.error.held_out->von_mises = body.error.held_out->displacement * 3;
  return body;
}

// A settled body with several loads at once.
ReducedBody several_ball() { return test::with_several(small_ball()); }

void check_same(const SeparatedField& a, const SeparatedField& b) {
  CHECK(a.modes() == b.modes());
  REQUIRE(a.axes().size() == b.axes().size());
  for (std::size_t j = 0; j < a.axes().size(); ++j) {
    CHECK(a.axes()[j].name == b.axes()[j].name);
    CHECK(a.axes()[j].samples == b.axes()[j].samples);
    CHECK(a.axes()[j].functions == b.axes()[j].functions);
    CHECK(a.axes()[j].between == b.axes()[j].between);
  }
}

void check_same(const std::vector<Site>& a, const std::vector<Site>& b) {
  REQUIRE(a.size() == b.size());
  for (std::size_t s = 0; s < b.size(); ++s) {
    CHECK(a[s].vertex == b[s].vertex);
    CHECK(a[s].patch == b[s].patch);
    CHECK(a[s].weights == b[s].weights);
    CHECK(a[s].direction == b[s].direction);
    CHECK(a[s].full_load == b[s].full_load);
  }
}

void check_same(const std::optional<ErrorCourse>& a, const std::optional<ErrorCourse>& b) {
  REQUIRE(a.has_value() == b.has_value());
  if (!a) return;
  CHECK(a->modes == b->modes);
  CHECK(a->pooled == b->pooled);
  CHECK(a->snapshots == b->snapshots);
}

ReducedBody written_and_read(const ReducedBody& body, ModeStorage storage = ModeStorage::kFloat32) {
  const Folder folder;
  write_body_file(folder / "ball.palpable", body, storage);
  return value_or_throw(read_body_file(folder / "ball.palpable"));
}

// Writes a body file without the attribute "method" and with the provenance as lines, as older
// programs did.
void write_old_file(const fs::path& path, const ReducedBody& body) {
  constexpr std::string_view kKind = "palpable body file";
  write_body_file(path, body);
  const hdf5::Image image(hdf5::all_bytes(path), {kKind, kBodyFileVersion, "a body", ""});
  const hdf5::Handle none(H5Pcreate(H5P_OBJECT_COPY), H5Pclose, "no memory");
  hdf5::write_durably(
      path, hdf5::image_of(kKind, kBodyFileVersion, [&](hid_t file) {
        for (const char* text : {"name", "material"}) {
          hdf5::write_text(file, text, hdf5::read_text(image.file(), text));
        }
        hdf5::write_number(file, "largest_von_mises",
                           hdf5::read_number(image.file(), "largest_von_mises"));
        for (const char* group : {"surface", "sites", "displacement", "stress", "error"}) {
          REQUIRE(H5Ocopy(image.file(), group, file, group, none, H5P_DEFAULT) >= 0);
        }
        const auto lines = lines_of(body.provenance);
        const hdf5::Handle g = hdf5::make_group(file, "provenance");
        hdf5::write_number(g, "count", static_cast<double>(lines.size()));
        for (std::size_t k = 0; k < lines.size(); ++k) {
          hdf5::write_text(g, fmt::format("{:03}_key", k).c_str(), lines[k].first);
          hdf5::write_text(g, fmt::format("{:03}_value", k).c_str(), lines[k].second);
        }
      }));
}

TEST_CASE("an older file names its method in its provenance, or nowhere", "[body_file][files]") {
  const Folder folder;
  ReducedBody body = small_ball();
  body.method = "lost with the attribute";
  write_old_file(folder / "old.palpable", body);
  CHECK(value_or_throw(read_body_file(folder / "old.palpable")).method.empty());
  body.provenance.reduction = "per-site (a POD of each site's levels)";
  write_old_file(folder / "old.palpable", body);
  CHECK(value_or_throw(read_body_file(folder / "old.palpable")).method == "per-site");
  // If there is the attribute, the text in the provenance is not used.
  body.method = "hosvd";
  CHECK(written_and_read(body).method == "hosvd");
}

TEST_CASE("the provenance of an older file is shown as it stands", "[body_file][files]") {
  const Folder folder;
  ReducedBody body = small_ball();
  body.provenance.loads = "6 sites";
  body.provenance.sites_reached = 5;
  body.provenance.held_out_values = {{"stiffness", 1.5, "wrong by a hair"}};
  write_old_file(folder / "old.palpable", body);
  const Provenance old = value_or_throw(read_body_file(folder / "old.palpable")).provenance;
  CHECK(lines_of(old) == lines_of(body.provenance));
  CHECK(old.loads == "6 sites; 5 sites reach it");
  CHECK(old.held_out_values == body.provenance.held_out_values);
}

TEST_CASE("a body that was written is read back the same", "[body_file][files]") {
  for (const ReducedBody& body : {small_ball(), full_ball(), reported_ball(), several_ball()}) {
    const ReducedBody again = written_and_read(body);
    CHECK(again.name == body.name);
    CHECK(again.material == body.material);
    CHECK(again.surface.vertices == body.surface.vertices);
    CHECK(again.surface.triangles == body.surface.triangles);
    CHECK(again.fixed == body.fixed);
    CHECK(again.press_depth == body.press_depth);
    CHECK(again.depth_slope == body.depth_slope);
    CHECK(again.level_slope == body.level_slope);
    CHECK(again.largest_von_mises == body.largest_von_mises);
    CHECK(again.provenance == body.provenance);
    CHECK(again.method == body.method);
    CHECK(again.error.displacement_worst == body.error.displacement_worst);
    CHECK(again.error.stress_pooled == body.error.stress_pooled);
    CHECK(again.error.stress_rounding == 0);
    CHECK(again.error.between_sites == body.error.between_sites);
    check_same(again.error.displacement_course, body.error.displacement_course);
    check_same(again.error.stress_course, body.error.stress_course);
    check_same(again.error.von_mises_course, body.error.von_mises_course);
    REQUIRE(again.error.held_out.has_value() == body.error.held_out.has_value());
    if (const auto& held_out = body.error.held_out) {
      CHECK(again.error.held_out->levels == held_out->levels);
      CHECK(again.error.held_out->displacement == held_out->displacement);
      CHECK(again.error.held_out->displacement_pooled == held_out->displacement_pooled);
      CHECK(again.error.held_out->von_mises == held_out->von_mises);
    }
    check_same(again.sites, body.sites);
    REQUIRE(again.several.has_value() == body.several.has_value());
    if (const auto& several = body.several) {
      CHECK(again.several->energy.K == several->energy.K);
      CHECK(again.several->energy.C == several->energy.C);
      CHECK(again.several->energy.D == several->energy.D);
      CHECK(again.several->modes == several->modes);
      check_same(again.several->reactions, several->reactions);
      CHECK(again.several->checked == several->checked);
      CHECK(again.several->error_median == several->error_median);
      CHECK(again.several->error_worst == several->error_worst);
    }
    check_same(again.displacement, body.displacement);
    check_same(again.stress, body.stress);
    REQUIRE(again.further.size() == body.further.size());
    for (std::size_t j = 0; j < body.further.size(); ++j) {
      CHECK(again.further[j].name == body.further[j].name);
      CHECK(again.further[j].value == body.further[j].value);
      CHECK(again.further[j].samples == body.further[j].samples);
    }
    CHECK(again.further_press_depth == body.further_press_depth);
    CHECK(again.further_full_load == body.further_full_load);
    REQUIRE(again.volume.has_value() == body.volume.has_value());
    if (!body.volume) continue;
    CHECK(again.volume->nodes == body.volume->nodes);
    CHECK(again.volume->tets == body.volume->tets);
    check_same(again.volume->displacement, body.volume->displacement);
    REQUIRE(again.volume->stress);
    check_same(*again.volume->stress, *body.volume->stress);
  }
}

TEST_CASE("a body in half precision takes half the bytes and states the rounding error",
          "[body_file][files]") {
  const Folder folder;
  const ReducedBody body = test::pressed_ball();
  write_body_file(folder / "full.palpable", body);
  write_body_file(folder / "half.palpable", body, ModeStorage::kFloat16);
  const auto modes =
      static_cast<double>(body.displacement.modes().size() + body.stress.modes().size());
  const double saved = static_cast<double>(fs::file_size(folder / "full.palpable")) -
                       static_cast<double>(fs::file_size(folder / "half.palpable"));
  CHECK(saved == Approx(2 * modes).epsilon(tolerance(0.02, "HDF5's own tables")));

  const ReducedBody half = value_or_throw(read_body_file(folder / "half.palpable"));
  // 11 bits give an error of at most 2^-12 = 2.4e-4 for each value; if errors are uniformly
  // distributed, their root mean square is 1 / sqrt(3) of that.
  double error = 0, whole = 0;
  std::vector<float> a(body.stress.value_count()), b(a.size());
  for (int s = 0; s < 6; ++s) {
    for (const double level : body.levels()) {
      body.stress.evaluate(std::array{double(s), level}, a);
      half.stress.evaluate(std::array{double(s), level}, b);
      for (std::size_t i = 0; i < a.size(); ++i) {
        error += std::pow(double(a[i]) - double(b[i]), 2);
        whole += std::pow(double(a[i]), 2);
      }
    }
  }
  CHECK(half.error.stress_rounding == Approx(std::sqrt(error / whole)).epsilon(1e-3));
  CHECK(half.error.stress_rounding < 2.5e-4);
  CHECK(half.error.stress_rounding > 2e-5);
  // Writing it again loses nothing more, and the stated error stays.
  const ReducedBody again = written_and_read(half, ModeStorage::kFloat16);
  CHECK(again.stress.modes() == half.stress.modes());
  CHECK(again.error.stress_rounding == half.error.stress_rounding);
}

TEST_CASE("a body for the live half is settled on the requested values", "[body_file][files]") {
  const Folder folder;
  const fs::path path = folder / "ball.palpable";
  write_body_file(path, full_ball());
  const ReducedBody soft = value_or_throw(read_pressable_body(path, {{"softness", 2}}));
  CHECK(soft.is_settled());
  CHECK(soft.sites[0].full_load == Approx(full_ball().sites[0].full_load));
  CHECK(read_pressable_body(path, {{"age", 2}}).problem().message.find(path.string() + ": 'age'") !=
        std::string::npos);
  // A settled body can be written and read like any other.
  const ReducedBody again = written_and_read(soft);
  CHECK(again.further.empty());
  CHECK(again.press_depth == soft.press_depth);
}

// These files were committed when layout 1 was new; every later program must read them.
TEST_CASE("a file of layout 1 is read for ever", "[body_file][files]") {
  for (const char* name : {"ball_v1.palpable", "ball_v1_full.palpable"}) {
    INFO(name);
    const Result<ReducedBody> result = read_body_file(fs::path("tests/data") / name);
    if (!result.ok()) FAIL(result.problem().message);
    const ReducedBody& body = result.value();
    CHECK(body.name == "ball");
    CHECK(body.sites.size() == 6);
    const bool full = body.volume.has_value();
    CHECK(full == (std::string(name) == "ball_v1_full.palpable"));
    // The closed form of tests/support/bodies.h; the full one is in half precision.
    const ReducedBody here = settled(full ? full_ball() : small_ball()).value();
    const ReducedBody one = settled(body).value();
    std::vector<float> a(one.displacement.value_count()), b(a.size());
    one.displacement.evaluate(std::array{4.0, 0.6}, a);
    here.displacement.evaluate(std::array{4.0, 0.6}, b);
    for (std::size_t i = 0; i < a.size(); ++i) {
      CHECK(a[i] == Approx(b[i]).margin(full ? tolerance(3e-6, "half precision of 10 mm")
                                             : tolerance(1e-9, "libm")));
    }
    CHECK(one.press_depth(3, 2) == Approx(here.press_depth(3, 2)));
    CHECK(lines_of(body.provenance) == lines_of(small_ball().provenance));
    CHECK(body.error.between_sites == (full ? std::optional(0.26) : std::nullopt));
    CHECK_FALSE(body.several);  // such a file has responses to one load at a time only
  }
}

TEST_CASE("the same body gives the same bytes", "[body_file][files]") {
  const Folder folder;
  write_body_file(folder / "a.palpable", small_ball());
  write_body_file(folder / "b.palpable", small_ball());
  CHECK(bytes_of(folder / "a.palpable") == bytes_of(folder / "b.palpable"));
}

TEST_CASE("a file that is missing, foreign or of another version says so", "[body_file][errors]") {
  const Folder folder;
  CHECK(read_body_file(folder / "none.palpable").problem().message.find("no such body file") !=
        std::string::npos);
  write_bytes(folder / "text.palpable", "this is not a body\n");
  CHECK(read_body_file(folder / "text.palpable").problem().message.find("not a body file") !=
        std::string::npos);
  write_bytes(folder / "empty.palpable", "");
  CHECK_FALSE(read_body_file(folder / "empty.palpable").ok());
}

TEST_CASE("a body that breaks a rule of its own is not written over a good one",
          "[body_file][errors]") {
  const Folder folder;
  const fs::path path = folder / "ball.palpable";
  write_body_file(path, small_ball());
  const std::string good = bytes_of(path);

  const std::vector<std::pair<std::string, std::function<void(ReducedBody&)>>> faults{
      {"not watertight",
       [](auto& b) { b.surface.triangles = b.surface.triangles.leftCols(70).eval(); }},
      {"'fixed' does not have", [](auto& b) { b.fixed.pop_back(); }},
      {"one weight per vertex", [](auto& b) { b.sites[0].weights.pop_back(); }},
      {"no load", [](auto& b) { b.sites[1].full_load = 0; }},
      {"unit vector", [](auto& b) { b.sites[2].direction *= 2; }},
      {"off the surface", [](auto& b) { b.sites[3].patch[1] = 4711; }},
      {"its own patch", [](auto& b) { b.sites[4].vertex = b.sites[4].patch[1]; }},
      {"sum to 1", [](auto& b) { b.sites[5].weights[0] += 0.5f; }},
      {"does not grow", [](auto& b) { b.press_depth(2, 3) = 0; }},
      {"the press of site 1 does not grow", [](auto& b) { b.level_slope(2, 1) = -1; }},
      {"the press of site 1 does not grow", [](auto& b) { b.depth_slope(2, 1) *= 4; }},
      {"not tabulated", [](auto& b) { b.depth_slope.resize(2, 2); }},
      {"different parameters", [](auto& b) { b.stress = b.stress.settled(3, 0); }},
      {"not known at all values", [](auto& b) { b.further_full_load.resize(6, 8); }},
      {"not that of the fields", [](auto& b) { b.further[1].name = "cold"; }},
      {"not that of the fields", [](auto& b) { b.further[0].value = 3; }},
      {"not those of the fields",
       [](auto& b) {
         b.further.pop_back();
         b.further_press_depth = b.further_press_depth.leftCols(18).eval();
         b.further_full_load = b.further_full_load.leftCols(3).eval();
       }},
      {"a press depth does not grow", [](auto& b) { b.further_press_depth(1, 50) = 0; }},
      {"no such node", [](auto& b) { b.volume->tets(2, 0) = 4; }},
      {"no tetrahedra", [](auto& b) { b.volume->tets = b.volume->tets.topRows(3).eval(); }},
      {"other parameters than the surface",
       [](auto& b) { b.volume->displacement = b.volume->displacement.settled(3, 0); }},
      {"one error for each number of modes",
       [](auto& b) { b.error.stress_course->pooled.conservativeResize(2); }},
      {"'stress_course' is not of this body's snapshots",
       [](auto& b) {
         auto& errors = b.error.stress_course->snapshots;
         errors = errors.topRows(25).eval();
       }},
      {"an error of 'displacement_course' is not valid",
       [](auto& b) { b.error.displacement_course->snapshots(7, 1) = -1e-3f; }},
      {"'von_mises_course' do not increase",
       [](auto& b) { b.error.von_mises_course->modes[1] = 1; }},
      {"one error for each level and site",
       [](auto& b) { b.error.held_out->levels = Eigen::Vector3d(0.1, 0.2, 0.3); }},
      {"an error of 'held_out' is not valid",
       [](auto& b) { b.error.held_out->von_mises(1, 2) = NAN; }},
      {"held-out levels do not increase", [](auto& b) { b.error.held_out->levels[1] = 0.25; }},
      {"not a stress", [](auto& b) { b.largest_von_mises = NAN; }},
      {"no site",
       [](auto& b) {
         b.sites.clear();
         b.press_depth.resize(5, 0);
         tabulate_press(b);
         b.further_press_depth.resize(5, 0);
         b.further_full_load.resize(0, 9);
       }},
  };
  for (const auto& [expected, spoil] : faults) {
    ReducedBody body = reported_ball();
    spoil(body);
    std::string message = "(written)";
    try {
      write_body_file(path, body);
    } catch (const Error& error) { message = error.what(); }
    INFO(expected << " <- " << message);
    CHECK(message.find(expected) != std::string::npos);
    CHECK(bytes_of(path) == good);
    CHECK_FALSE(fs::exists(part_of(folder / "ball.palpable")));
  }
}

TEST_CASE("an energy of several loads that breaks a rule is not written", "[body_file][errors]") {
  const Folder folder;
  const std::vector<std::pair<std::string, std::function<void(SeveralLoads&)>>> faults{
      {"not those of this surface", [](auto& s) { s.modes.conservativeResize(30, 4); }},
      {"not those of their energy", [](auto& s) { s.modes.conservativeResize(s.modes.rows(), 3); }},
      {"not those of their energy", [](auto& s) { s.energy.K.conservativeResize(9); }},
      {"a mode of several loads is not a number", [](auto& s) { s.modes(7, 1) = NAN; }},
      {"'quadratic' is not a number", [](auto& s) { s.energy.K[3] = NAN; }},
      {"'cubic' is not a number", [](auto& s) { s.energy.C(2, 3) = INFINITY; }},
      {"'quartic' is not a number", [](auto& s) { s.energy.D(4, 9) = NAN; }},
      {"is not positive definite", [](auto& s) { s.energy.K[5] = -s.energy.K[5]; }},
      {"reaction 0 has no load", [](auto& s) { s.reactions[0].full_load = 0; }},
      {"reaction 0 has a patch off", [](auto& s) { s.reactions[0].patch[0] = -1; }},
      {"load direction of reaction 0", [](auto& s) { s.reactions[0].direction *= 1.5; }},
      {"error of several loads is not valid", [](auto& s) { s.error_worst = NAN; }},
      {"error of several loads is not valid", [](auto& s) { s.error_median = 0.03; }},
      {"error of several loads is not valid", [](auto& s) { s.checked = -1; }},
  };
  const auto message = [&](const ReducedBody& body) {
    try {
      write_body_file(folder / "ball.palpable", body);
    } catch (const Error& error) { return std::string(error.what()); }
    return std::string("(written)");
  };
  for (const auto& [expected, spoil] : faults) {
    ReducedBody body = several_ball();
    spoil(*body.several);
    CHECK_THAT(message(body), Catch::Contains(expected));
    CHECK_FALSE(fs::exists(folder / "ball.palpable"));
  }
  CHECK_THAT(message(test::with_further(several_ball())),
             Catch::Contains("do not go with further parameters"));
  // A body without reactions is allowed: it can have several presses at its sites.
  ReducedBody no_reactions = several_ball();
  no_reactions.several->reactions.clear();
  CHECK(written_and_read(no_reactions).several->reactions.empty());
}

TEST_CASE("a further group is stored beside the body, and readers that do not know it skip it",
          "[body_file][files]") {
  const Folder folder;
  const fs::path path = folder / "ball.palpable";
  write_body_file(path, small_ball(), ModeStorage::kFloat32,
                  [](hid_t file) { hdf5::write_number(hdf5::make_group(file, "more"), "x", 7); });
  double x = 0;
  int vertices = 0;
  const Result<ReducedBody> read = read_body_file(path, [&](hid_t file, const ReducedBody& body) {
    x = hdf5::read_number(hdf5::open_group(file, "more"), "x");
    vertices = body.surface.vertex_count();
  });
  REQUIRE(read.ok());
  CHECK(x == 7);
  CHECK(vertices == read.value().surface.vertex_count());
  CHECK(read_body_file(path).ok());

  const std::string good = bytes_of(path);
  const Result<ReducedBody> refused =
      read_body_file(path, [](hid_t, const ReducedBody&) { throw hdf5::Trouble{"x is no 8"}; });
  CHECK(refused.problem().message == path.string() + ": x is no 8");
  CHECK_THROWS_WITH(write_body_file(path, small_ball(), ModeStorage::kFloat32,
                                    [](hid_t) { throw hdf5::Trouble{"x is no 9"}; }),
                    path.string() + ": x is no 9");
  CHECK(bytes_of(path) == good);
}

TEST_CASE("a folder that does not exist is a clear error", "[body_file][errors]") {
  CHECK_THROWS_WITH(write_body_file("/nowhere/ball.palpable", small_ball()),
                    Catch::Contains("/nowhere/ball.palpable: cannot be created"));
}

TEST_CASE("a full disk is a clear error and leaves the old file", "[body_file][errors]") {
  if (!fs::exists("/dev/full")) PALPABLE_SKIP("/dev/full is not there");
  const Folder folder;
  fs::create_symlink("/dev/full", part_of(folder / "ball.palpable"));
  CHECK_THROWS_AS(write_body_file(folder / "ball.palpable", small_ball()), Error);
  CHECK_FALSE(fs::exists(folder / "ball.palpable"));
}

// The promise of read_body_file(): for any bytes, a valid body or a problem.
TEST_CASE("a truncated body file is refused at every length", "[body_file][fuzz]") {
  const Folder folder;
  const fs::path path = folder / "ball.palpable";
  write_body_file(path, several_ball(), ModeStorage::kFloat16);
  const std::string good = bytes_of(path);
  for (std::size_t n = 0; n < good.size(); n += 1 + good.size() / 200) {
    write_bytes(path, good.substr(0, n));
    if (read_body_file(path).ok()) FAIL("read a file cut at byte " << n << " of " << good.size());
  }
}

TEST_CASE("a body file with one changed byte is refused", "[body_file][fuzz]") {
  const Folder folder;
  const fs::path path = folder / "ball.palpable";
  std::array<std::string, 2> files;
  write_body_file(path, full_ball(), ModeStorage::kFloat16);
  files[0] = bytes_of(path);
  write_body_file(path, several_ball());
  files[1] = bytes_of(path);
  for (unsigned seed = 0; seed < 500; ++seed) {
    const std::string& good = files[seed / 2 % 2];
    auto random = test::random_case(seed);
    std::string damaged = good;
    // Half of the hits go to the first kilobytes, where the structure lies.
    const std::size_t range =
        seed % 2 == 0 ? good.size() : std::min<std::size_t>(good.size(), 4096);
    damaged[random() % range] ^= static_cast<char>(1 + random() % 255);
    write_bytes(path, damaged);
    if (read_body_file(path).ok()) FAIL("read a damaged file, seed " << seed);
  }
}

TEST_CASE("a file of another layout is refused by its version", "[body_file][errors]") {
  const Folder folder;
  write_bytes(folder / "new.palpable", "palpable body file, layout 99\nwhatever comes then");
  CHECK(read_body_file(folder / "new.palpable").problem().message.find("layout version '99'") !=
        std::string::npos);
  write_bytes(folder / "old.palpable", "palpable body file, layout 0\nbytes 5\n");
  CHECK_THAT(read_body_file(folder / "old.palpable").problem().message,
             Catch::Contains("layout version '0'") && Catch::Contains("bake the body again"));
}

TEST_CASE("several threads read and write body files at the same time", "[body_file]") {
  const Folder folder;
  const ReducedBody ball = small_ball();
  write_body_file(folder / "read.palpable", ball);
  const std::string bytes = bytes_of(folder / "read.palpable");
  constexpr int kThreads = 4;
  std::array<int, kThreads> right{};
  std::vector<std::thread> threads;
  for (int k = 0; k < kThreads; ++k) {
    threads.emplace_back([&, k] {
      const fs::path own = folder / fmt::format("own-{}.palpable", k).c_str();
      for (int turn = 0; turn < 20; ++turn) {
        const Result<ReducedBody> body = read_body_file(folder / "read.palpable");
        if (!body) return;
        write_body_file(own, ball);
        if (bytes_of(own) == bytes) ++right[k];
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const int count : right) CHECK(count == 20);
}

}  // namespace
}  // namespace palpable

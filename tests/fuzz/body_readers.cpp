#include "palpable/bake/describe/body_description.h"
#include "palpable/bake/exchange/foreign_modes.h"
#include "palpable/bake/mesh/field_files.h"
#include "palpable/common/base/checksum.h"
#include "palpable/common/base/npy_file.h"
#include "palpable/common/body_file/body_file.h"
#include "palpable/common/body_file/hdf5_tools.h"
#include "palpable/common/body_file/touch_file.h"
#include "palpable/common/reduced/loaded_body.h"
#include "palpable/common/response/touch_solver.h"
#include "palpable/common/web_file/web_file.h"
#include "tests/fuzz/checked_hdf5.h"
#include "tests/fuzz/fuzz_reader.h"
#include "tests/support/ball_gap.h"
#include "tests/support/bodies.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/some_touch_tables.h"

#include <span>
#include <utility>

namespace palpable::fuzz {
namespace {

namespace fs = std::filesystem;

// Presses it a little, as programs do after reading a body.
void press(const ReducedBody& whole) {
  const Result<ReducedBody> settled_body = settled(whole, {});
  if (!settled_body.ok()) return;
  const ReducedBody& body = settled_body.value();
  const double mu[2] = {0.0, 0.6};
  std::vector<float> u(static_cast<std::size_t>(body.displacement.value_count()));
  body.displacement.evaluate(mu, u);
  std::vector<float> stress(static_cast<std::size_t>(body.stress.value_count()));
  body.stress.evaluate(mu, stress);
  (void)load_at(body, body.surface.vertices.col(0), 0.1);
}

std::string read_body(const fs::path& /*folder*/, const fs::path& file) {
  return said(read_body_file(file), press);
}

std::vector<std::string> write_bodies(const fs::path& folder) {
  const ReducedBody ball = test::pressed_ball(0.05, 0.01, 0);
  write_body_file(folder / "plain.palpable", ball);
  write_body_file(folder / "further.palpable", test::with_further(ball), ModeStorage::kFloat16);
  write_body_file(folder / "several.palpable", test::with_several(ball));
  return {"plain.palpable", "further.palpable", "several.palpable"};
}

// Presses a plane into it, using its tables.
void touch(const TouchableBody& read) {
  if (!read.touch) return;
  TouchSolver solver(read.body.surface, read.body.fixed, *read.touch);
  TouchState state;
  for (const float height : {0.099f, 0.097f}) {
    (void)solver.advance(state,
                         test::GapFunction([height](const Eigen::Vector3f& place, SurfaceGap& gap) {
                           gap.distance = height - place.z();
                           gap.normal = -Eigen::Vector3f::UnitZ();
                           return gap.distance < kGapReach;
                         }));
  }
}

std::string read_touch(const fs::path& /*folder*/, const fs::path& file) {
  return said(read_touchable_body(file), touch);
}

std::vector<std::string> write_touch(const fs::path& folder) {
  const ReducedBody ball = test::pressed_ball(0.05, 0.01, 1);
  write_touchable_body(folder / "linear.palpable", ball, test::some_touch_tables(ball.surface, 0));
  write_touchable_body(folder / "full.palpable", ball, test::some_touch_tables(ball.surface));
  return {"linear.palpable", "full.palpable"};
}

// Delivery files. Reading them presses them, at a site and anywhere.
std::string read_web(const fs::path& /*folder*/, const fs::path& file) {
  return said(load_web_file(file), [](const TouchableBody& read) {
    press(read.body);
    touch(read);
  });
}

std::vector<std::string> write_web(const fs::path& folder) {
  const ReducedBody ball = test::pressed_ball(0.05, 0.01, 1);
  write_web_file(folder / "full.palpweb", {ball, test::some_touch_tables(ball.surface)});
  ReducedBody several = test::with_several(ball);
  ModalTables modal{test::some_touch_tables(ball.surface, 0).shell,
                    Eigen::MatrixXf::Constant(3, several.several->mode_count(), 0.001f), 1.4e-5,
                    0.012};
  write_web_file(folder / "modal.palpweb", {std::move(several), std::nullopt, std::move(modal)});
  return {"full.palpweb", "modal.palpweb"};
}

// Damage that the checksum does not show: of the header and its sizes, or of numbers in arrays.
std::string with_hidden_damage(const std::string& bytes, Random& random) {
  if (random() % 2 == 0) return with_web_checksum(mutated(bytes, {&bytes, 1}, random));
  std::string damaged = bytes;
  constexpr std::size_t kPrefix = 32;
  for (auto left = 1 + random() % 8; left > 0; --left) {
    const std::size_t size = std::size_t{1} << random() % 4;
    // On a multiple of its size, as all numbers lie.
    const std::size_t at = kPrefix + random() % (damaged.size() - kPrefix - 8) / size * size;
    spoil_number(std::span(damaged).subspan(at, size), size, size >= 4 && random() % 2 == 0,
                 random);
  }
  return with_web_checksum(std::move(damaged));
}

const std::string kDescription = R"(name = "cube" # a comment
[shape]
surface = "cube.stl"
up = "y"
height = "150 mm"
edge = "7.5 mm"
wrap = "2 mm"
[material]
law = "neo-hookean"
young = "60 kPa"
poisson = 0.4
[[material.group]]
name = "ears"
box = { low = ["0 mm", "0 mm", "0 mm"], high = ["1 mm", "2 mm", "3 mm"] }
young = "1.5 MPa"
poisson = 0.3
[[parameter]]
name = "ears"
of = "ears"
stiffness = [0.5, 1, 2]
[[support]]
plane = { point = ["0 m", "0 m", "0 m"], normal = [0, 0, 1], distance = "1 mm" }
hold = "xz"
displacement = ["1 mm", "0 m", "0 m"]
[[support]]
below = 0.03
[gravity]
density = "1000 kg/m^3"
acceleration = ["0 m/s^2", "0 m/s^2", "-9.81 m/s^2"]
[[pressure]]
pressure = "1 kPa"
above = 0.9
[sites]
count = 24
above = 0.10
choose = "salient"
patch = 2
direction = [0, 0, -1]
[press]
depth = "5 mm"
levels = 10
[reduction]
method = "pgd"
tolerance = 1e-3
norm = "own"
max_modes = 50
[touch]
tables = "none"
[intrusive]
positions = ["TOP"]
force = "2 N"
)";

std::string read_description(const fs::path& /*folder*/, const fs::path& file) {
  (void)read_body_description(file);
  return {};
}

}  // namespace

void add_body_readers(std::vector<FuzzReader>& readers) {
  readers.push_back({.name = "body.file", .write = write_bodies, .read = read_body});
  readers.push_back({.name = "body.values",
                     .write = write_bodies,
                     .read = read_body,
                     .mutate = with_spoilt_values});
  readers.push_back({.name = "body.touch",
                     .write = write_touch,
                     .read = read_touch,
                     .mutate = with_spoilt_values});
  readers.push_back({.name = "web.file", .write = write_web, .read = read_web});
  readers.push_back(
      {.name = "web.values", .write = write_web, .read = read_web, .mutate = with_hidden_damage});
  readers.push_back({.name = "body.description",
                     .write = [](const fs::path& folder) -> std::vector<std::string> {
                       test::write_bytes(folder / "body.toml", kDescription);
                       return {"body.toml"};
                     },
                     .read = read_description});
  const auto body_of = [](const ForeignModes& modes, const fs::path& source) {
    const ReducedBody body = body_of_modes(modes, {.source = source.string()});
    press(body);
    write_body_file(source.string() + ".palpable", body);
    return std::string();
  };
  readers.push_back({.name = "modes.pxdmf",
                     .write = [](const fs::path& folder) -> std::vector<std::string> {
                       const ReducedBody ball = test::pressed_ball(0.05, 0.01, 0, 3);
                       write_pxdmf(folder / "a.pxdmf", modes_of_body(ball));
                       return {"a.pxdmf", "a.pxdmf.h5"};
                     },
                     .read =
                         [body_of](const fs::path& folder, const fs::path& /*file*/) {
                           return body_of(read_pxdmf(folder / "a.pxdmf"), folder / "a.pxdmf");
                         },
                     .names_folder = true});
  readers.push_back({.name = "modes.numpy",
                     .write =
                         [](const fs::path& folder) {
                           const ReducedBody ball = test::pressed_ball(0.05, 0.01, 0);
                           write_numpy_modes(folder, modes_of_body(ball));
                           std::vector<std::string> names;
                           for (const auto& entry : fs::directory_iterator(folder)) {
                             names.push_back(entry.path().filename().string());
                           }
                           return names;
                         },
                     .read =
                         [body_of](const fs::path& folder, const fs::path& /*file*/) {
                           return body_of(read_numpy_modes(folder), folder);
                         },
                     .names_folder = true});
  readers.push_back({.name = "field.npy",
                     .write = [](const fs::path& folder) -> std::vector<std::string> {
                       const std::vector<double> values(24, 0.5);
                       write_npy(folder / "a.npy", {8, 3}, std::span<const double>(values));
                       return {"a.npy"};
                     },
                     .read =
                         [](const fs::path& /*folder*/, const fs::path& file) {
                           (void)read_npy(file);
                           (void)read_nodal_file(file);
                           return std::string();
                         }});
}

}  // namespace palpable::fuzz

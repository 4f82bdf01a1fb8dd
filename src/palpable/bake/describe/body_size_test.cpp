#include "palpable/bake/describe/body_size.h"

#include "palpable/bake/describe/body_mesh.h"
#include "palpable/common/base/error.h"
#include "tests/support/meshes.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Eigen::Vector3d;

// A pyramid with a square base as an OFF file.
std::string pyramid(double width, double height) {
  const std::string w = std::to_string(width);
  return "OFF\n5 6 0\n0 0 0\n" + w + " 0 0\n" + w + " " + w + " 0\n0 " + w + " 0\n0 0 " +
         std::to_string(height) + "\n3 0 2 1\n3 0 3 2\n3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4\n";
}

BodyDescription described(const test::ScratchFolder& folder, const std::string& shape) {
  return parse_body_description("name = 'p'\n[shape]\nsurface = 'p.off'\n" + shape +
                                    "[material]\nyoung = '60 kPa'\npoisson = 0.4\n"
                                    "[sites]\ncount = 1\n",
                                folder.path() / "p.toml");
}

TEST_CASE("a body of an unusual size is warned of, with its likely unit", "[describe][size]") {
  const std::string write = "--unit {}";
  for (const double usual : {0.003, 0.08, 3.0}) {
    CHECK_FALSE(size_warning(Vector3d::Constant(usual), 1.0, write));
  }
  CHECK_THAT(size_warning({80, 76, 68}, 1.0, write).value(),
             Contains("the body is 80 x 76 x 68 m, larger than 3 m: if lengths in its file are "
                      "millimetres, write --unit mm"));
  CHECK_THAT(size_warning({8e-5, 7e-5, 7e-5}, 1e-3, write).value(),
             Contains("smaller than 3 mm") && Contains("metres, write --unit m"));
  CHECK_THAT(size_warning({5, 4, 3}, std::nullopt, write).value(), Contains("height"));
  CHECK_THAT(size_warning({1e9, 1, 1}, 1.0, write).value(), Contains("give its height"));
}

TEST_CASE("a forgotten unit is said with file and line before anything is meshed",
          "[describe][size]") {
  const test::ScratchFolder folder("body_size");
  std::ofstream(folder.path() / "p.off") << pyramid(80, 60);
  const BodyDescription metres = described(folder, "");
  const Vector3d size = size_of_body(metres);
  CHECK(size == Vector3d(80, 80, 60));
  CHECK_THAT(size_warning(metres.shape, size).value(),
             Contains("p.toml:2: [shape]: the body is 80 x 80 x 60 m") &&
                 Contains("write unit = \"mm\" in [shape]"));
  const BodyDescription millimetres = described(folder, "unit = 'mm'\n");
  CHECK_FALSE(size_warning(millimetres.shape, size_of_body(millimetres)));
  const BodyDescription scaled = described(folder, "height = '60 mm'\n");
  CHECK_FALSE(size_warning(scaled.shape, size_of_body(scaled)));
}

TEST_CASE("what is repaired of a shape is said in the file's lengths, and kept with the body",
          "[describe][repair]") {
  const test::ScratchFolder folder("repaired_shape");
  std::string faces = pyramid(80, 60);
  std::ofstream(folder.path() / "p.off") << faces;
  std::string repair = "not yet";
  (void)size_of_body(described(folder, "unit = 'mm'\n"), &repair);
  CHECK(repair.empty());
  // One face of the pyramid with its corners the other way round.
  const std::size_t last = faces.rfind("\n3 ", faces.size() - 2);
  std::istringstream words(faces.substr(last + 1));
  int three = 0, a = 0, b = 0, c = 0;
  words >> three >> a >> b >> c;
  faces.resize(last + 1);
  std::ofstream(folder.path() / "p.off") << faces << "3 " << a << ' ' << c << ' ' << b << '\n';
  const BodyDescription turned = described(folder, "unit = 'mm'\n");
  CHECK(size_of_body(turned, &repair) == 1e-3 * Vector3d(80, 80, 60));
  CHECK_THAT(repair, Contains("repaired: 1 of 6 faces turned, which now enclose a volume of 128000 "
                              "(in the file's lengths)"));
  CHECK_THAT(make_body_mesh(turned).origin, Contains("p.off, repaired: 1 of 6 faces turned"));
}

TEST_CASE("a body of a kilometre or of a micron is refused", "[describe][size]") {
  const test::ScratchFolder folder("impossible_size");
  std::ofstream(folder.path() / "p.off") << pyramid(800, 600);
  CHECK_THROWS_WITH(make_body_mesh(described(folder, "")),
                    Contains("p.toml:2: [shape]: the body is 800 x 800 x 600 m; bodies are from "
                             "0.1 mm to 100 m: if lengths in its file are millimetres, write "
                             "unit = \"mm\" in [shape]"));
  std::ofstream(folder.path() / "p.off") << pyramid(0.01, 0.01);
  CHECK_THROWS_WITH(make_body_mesh(described(folder, "unit = 'mm'\n")),
                    Contains("0.01 x 0.01 x 0.01 mm") && Contains("write unit = \"m\""));
}

TEST_CASE("a wrap that would fill cavities says so", "[describe][size]") {
  const test::ScratchFolder folder("wrapped_cavity");
  const auto box = [](double low, double high) {
    return box_surface(Vector3d::Constant(low), Vector3d::Constant(high));
  };
  const auto warning = [&](const SurfaceMesh& surface, const std::string& shape) {
    std::ofstream file(folder / "p.off");
    file << "OFF\n" << surface.vertex_count() << ' ' << surface.triangle_count() << " 0\n";
    for (const auto& x : surface.vertices.colwise()) file << x.transpose() << '\n';
    for (const auto& t : surface.triangles.colwise()) file << "3 " << t.transpose() << '\n';
    file.close();
    return wrap_warning(described(folder, shape).shape);
  };
  const std::string wrap = "wrap = '20 mm'\nedge = '50 mm'\n";
  const SurfaceMesh hollow = test::joined(box(0, 1), test::flipped(box(0.2, 0.3)));
  CHECK_THAT(warning(hollow, wrap).value(),
             Contains("p.toml:2: [shape]: the surface has 1 cavity, which a wrap fills"));
  CHECK_THAT(warning(test::joined(hollow, test::flipped(box(0.5, 0.7))), wrap).value(),
             Contains("2 cavities"));
  CHECK_FALSE(warning(hollow, "edge = '50 mm'\n"));
  CHECK_FALSE(warning(test::joined(box(0, 1), box(2, 3)), wrap));
  CHECK_FALSE(warning(test::joined(box(0, 1), box(0.2, 0.3)), wrap));  // the inner box is no cavity
  SurfaceMesh open = hollow;
  open.triangles.conservativeResize(3, open.triangle_count() - 1);
  CHECK_FALSE(warning(open, wrap));
}

}  // namespace
}  // namespace palpable

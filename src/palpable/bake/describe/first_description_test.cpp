#include "palpable/bake/describe/first_description.h"

#include "palpable/bake/describe/body_description.h"
#include "palpable/bake/mesh/msh_file.h"
#include "palpable/common/base/error.h"
#include "palpable/common/geometry/mesh_file.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <fstream>

namespace palpable {
namespace {

namespace fs = std::filesystem;

TEST_CASE("shapes are known by their endings", "[describe][first]") {
  for (const char* name : {"a.stl", "a.STL", "a.Ply", "a.obj", "a.3ds", "a.off", "a.msh", "a.vtu"})
    CHECK(is_shape_file(name));
  for (const char* name : {"a.toml", "a", "stl", "a.stl.toml"}) CHECK_FALSE(is_shape_file(name));
}

TEST_CASE("a shape's first description is one that can be read, in its likely unit",
          "[describe][first]") {
  const test::ScratchFolder folder("first_description");
  const auto described = [&](double longest, const std::string& name) {
    write_ply(folder / name, box_surface({0, 0, 0}, {0.5 * longest, longest, 0.25 * longest}));
    return parse_body_description(first_description(folder / name), folder / "a.toml");
  };
  const BodyDescription millimetres = described(120, "bunny.ply");
  CHECK(millimetres.name == "bunny");
  CHECK(millimetres.shape.file == (folder / "bunny.ply").lexically_normal());
  CHECK(millimetres.shape.unit == 1e-3);
  CHECK(millimetres.shape.edge == Approx(6e-3));
  CHECK(millimetres.sites.count == 24);
  CHECK(described(0.12, "metres.ply").shape.unit == 1.0);
  CHECK(described(12, "cm.ply").shape.unit == 1e-2);
  CHECK(described(2, "large.ply").shape.unit == 1.0);
  CHECK_THAT(first_description(folder / "large.ply"),
             Catch::Contains("# then it is 1 x 2 x 0.5 m\n"));
  CHECK(described(12, "a \"b\" \\c.ply").name == "a \"b\" \\c");

  write_msh_file(folder / "box.msh", box_tets({0, 0, 0}, {0.2, 0.1, 0.1}, 2, 1, 1));
  const BodyDescription mesh =
      parse_body_description(first_description(folder / "box.msh"), folder / "a.toml");
  CHECK(mesh.shape.is_volume());
  CHECK_FALSE(mesh.shape.edge.has_value());
}

TEST_CASE("a shape that cannot be read is refused as such", "[describe][first]") {
  const test::ScratchFolder folder("first_description");
  std::ofstream(folder / "bad.stl") << "solid\nfacet\n";
  CHECK_THROWS_WITH(first_description(folder / "bad.stl"), Catch::Contains("bad.stl: "));
  CHECK_THROWS_WITH(first_description(folder / "none.stl"), Catch::Contains("no such file"));
}

}  // namespace
}  // namespace palpable

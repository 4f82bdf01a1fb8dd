#include "palpable/bake/mesh/msh_file.h"

#include "tests/support/replaced.h"
#include "tests/support/test.h"

#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

namespace palpable {
namespace {

using test::replaced;

using Catch::Matchers::Contains;

struct TemporaryFile {
  std::filesystem::path path = std::filesystem::temp_directory_path() /
                               ("palpable-msh-test-" + std::to_string(::getpid()) + ".msh");
  ~TemporaryFile() { std::filesystem::remove(path); }
};

// One tetrahedron of volume 1/6 among a point and a triangle, as Gmsh writes it.
const std::string kVersion2 = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
1
3 1 "body"
$EndPhysicalNames
$Nodes
5
1 0 0 0
2 1 0 0
7 0 1 0
9 0 0 1
20 5 5 5
$EndNodes
$Elements
3
1 15 2 0 1 1
2 2 2 0 1 1 7 2
3 4 3 1 1 0 1 2 7 9
$EndElements
)";

const std::string kVersion4 = R"($MeshFormat
4.1 0 8
$EndMeshFormat
$Entities
0 0 0 1
1 0 0 0 1 1 1 0 0
$EndEntities
$Nodes
2 4 1 9
2 1 0 3
1
2
7
0 0 0
1 0 0
0 1 0
3 1 0 1
9
0 0 1
$EndNodes
$Elements
2 2 1 2
2 1 2 1
1 1 7 2
3 1 4 1
2 1 2 7 9
$EndElements
)";

std::string complaint(const std::string& text) {
  const Result<VolumeMesh> result = parse_msh(text, "a.msh");
  return result.ok() ? "" : result.problem().message;
}

TEST_CASE("a written mesh reads back to the last bit", "[mesh][msh]") {
  TetMesh mesh = box_tets({0, 0, 0}, {0.3, 0.1, 0.2}, 3, 2, 4);
  mesh.nodes.array() += 1.0 / 3.0;  // digits that do not end
  const TemporaryFile file;
  write_msh_file(file.path, mesh);
  const TetMesh again = value_or_throw(read_msh_file(file.path)).mesh;
  REQUIRE(again.node_count() == mesh.node_count());
  REQUIRE(again.tet_count() == mesh.tet_count());
  // Nodes are numbered anew in the order in which tetrahedra use them; corners keep their order.
  for (int e = 0; e < mesh.tet_count(); ++e) {
    for (int k = 0; k < 4; ++k) {
      CHECK(again.nodes.col(again.tets(k, e)) == mesh.nodes.col(mesh.tets(k, e)));
    }
  }
}

TEST_CASE("versions 2.2 and 4.1 of the format give the same tetrahedron", "[mesh][msh]") {
  for (const std::string& text : {kVersion2, kVersion4}) {
    const TetMesh mesh = value_or_throw(parse_msh(text, "a.msh")).mesh;
    REQUIRE(mesh.tet_count() == 1);
    CHECK(mesh.node_count() == 4);  // the node that no tetrahedron uses is dropped
    CHECK(std::abs(tet_volumes(mesh)[0] - 1.0 / 6.0) < 1e-15);
  }
}

TEST_CASE("10-node tetrahedra are written and read with their edges in our order",
          "[mesh][msh][quadratic]") {
  const TetMesh mesh = with_edge_nodes(box_tets({0, 0, 0}, {0.3, 0.1, 0.2}, 2, 1, 1));
  const TemporaryFile file;
  write_msh_file(file.path, mesh);
  const VolumeMesh again = value_or_throw(read_msh_file(file.path));
  REQUIRE(again.mesh.is_quadratic());
  REQUIRE(again.mesh.node_count() == mesh.node_count());
  for (int e = 0; e < mesh.tet_count(); ++e) {
    for (int k = 0; k < 6; ++k) {
      CHECK(again.mesh.nodes.col(again.mesh.edge_nodes(k, e)) ==
            mesh.nodes.col(mesh.edge_nodes(k, e)));
    }
  }
  CHECK(again.sets.tets.at("body").size() == static_cast<std::size_t>(mesh.tet_count()));
  CHECK(again.sets.faces.at("boundary").size() ==
        static_cast<std::size_t>(boundary_of(mesh).surface.triangle_count()));
}

TEST_CASE("the ten nodes of Gmsh's type 11 are corners and the edges 01 12 20 30 23 13",
          "[mesh][msh][quadratic]") {
  const std::string text = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
10
1 0 0 0
2 2 0 0
3 0 2 0
4 0 0 2
5 1 0 0
6 1 1 0
7 0 1 0
8 0 0 1
9 0 1 1
10 1 0 1
$EndNodes
$Elements
1
1 11 2 1 1 1 2 3 4 5 6 7 8 9 10
$EndElements
)";
  const TetMesh mesh = value_or_throw(parse_msh(text, "a.msh")).mesh;
  for (int k = 0; k < 6; ++k) {
    const Eigen::Vector3d middle = 0.5 * (mesh.nodes.col(mesh.tets(kTetEdges[k][0], 0)) +
                                          mesh.nodes.col(mesh.tets(kTetEdges[k][1], 0)));
    CHECK(mesh.nodes.col(mesh.edge_nodes(k, 0)) == middle);
  }
}

TEST_CASE("physical groups become sets, by name or number, in both versions", "[mesh][msh]") {
  const VolumeMesh two = value_or_throw(
      parse_msh(replaced(replaced(kVersion2, "1\n3 1 \"body\"", "2\n3 1 \"the body\"\n0 4 \"tip\""),
                         "1 15 2 0 1 1\n2 2 2 0 1", "1 15 2 4 1 9\n2 2 2 8 1"),
                "a.msh"));
  CHECK(two.sets.tets.at("the body") == std::vector{0});
  REQUIRE(two.sets.nodes.at("tip").size() == 1);
  CHECK(two.mesh.nodes.col(two.sets.nodes.at("tip")[0]) == Eigen::Vector3d(0, 0, 1));
  CHECK(two.sets.faces.at("8").size() == 1);

  std::string text = replaced(kVersion4, "$Entities\n0 0 0 1\n1 0 0 0 1 1 1 0 0\n",
                              "$PhysicalNames\n2\n2 5 \"foot\"\n3 6 \"rubber\"\n$EndPhysicalNames\n"
                              "$Entities\n1 0 1 1\n7 0 0 1 1 3\n1 0 0 0 1 1 0 1 -5 0\n"
                              "1 0 0 0 1 1 1 1 6 1 1\n");
  text = replaced(text, "2 2 1 2\n2 1 2 1\n", "3 3 1 3\n0 7 15 1\n3 9\n2 1 2 1\n");
  const VolumeMesh four = value_or_throw(parse_msh(text, "a.msh"));
  CHECK(four.sets.tets.at("rubber") == std::vector{0});
  CHECK(four.sets.faces.at("foot").size() == 1);
  REQUIRE(four.sets.nodes.at("3").size() == 1);
  CHECK(four.mesh.nodes.col(four.sets.nodes.at("3")[0]) == Eigen::Vector3d(0, 0, 1));
}

TEST_CASE("an element in two groups of version 2 is one element", "[mesh][msh]") {
  const std::string again = "3 4 3 1 1 0 1 2 7 9\n3 4 3 2 1 0 1 2 7 9\n";
  const std::string text =
      replaced(replaced(kVersion2, "3 4 3 1 1 0 1 2 7 9\n", again), "$Elements\n3", "$Elements\n4");
  const VolumeMesh volume = value_or_throw(parse_msh(text, "a.msh"));
  CHECK(volume.mesh.tet_count() == 1);
  CHECK(volume.sets.tets.at("body") == std::vector{0});
  CHECK(volume.sets.tets.at("2") == std::vector{0});
  CHECK_THAT(complaint(replaced(text, "2 1 0 1 2 7 9\n$", "2 1 0 1 7 9 2\n$")),
             Contains("element 3 comes twice, with different nodes"));
}

// meshio#956: Gmsh 4.1 saves what is in a physical group alone, if there is any group.
TEST_CASE("a mesh that lacks its volume for want of a group says which group", "[mesh][msh]") {
  CHECK(complaint("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"skin\"\n"
                  "$EndPhysicalNames\n$Entities\n0 0 1 1\n1 0 0 0 1 1 0 1 1 0\n1 0 0 0 1 1 1 0 0\n"
                  "$EndEntities\n$Nodes\n1 3 1 3\n2 1 0 3\n1\n2\n3\n0 0 0\n1 0 0\n0 1 0\n"
                  "$EndNodes\n$Elements\n1 1 1 1\n2 1 2 1\n1 1 2 3\n$EndElements\n") ==
        "a.msh: holds no tetrahedra (1 triangles among its 1 elements): where a model has physical "
        "groups, Gmsh saves nothing else; add a Physical Volume to the .geo file, or set "
        "Mesh.SaveAll = 1, and mesh it in 3D (gmsh -3)");
}

TEST_CASE("line ends of Windows are read", "[mesh][msh]") {
  std::string text;
  for (const char c : kVersion2) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  CHECK(parse_msh(text, "a.msh").ok());
}

TEST_CASE("a flat tetrahedron is refused by its number and line", "[mesh][msh]") {
  CHECK_THAT(
      value_or_throw(parse_msh(replaced(kVersion2, "1 2 7 9\n", "1 2 9 7\n"), "a.msh")).repair,
      Contains("1 of 1 tetrahedra turned"));
  const std::string text = replaced(kVersion2, "1 2 7 9\n", "1 2 9 9\n");
  CHECK_THAT(complaint(text), Contains("a.msh: line 20: 1 of 1 tetrahedra is inverted or flat, the "
                                       "first is number 3"));
}

TEST_CASE("bad meshes are refused with file, line and reason", "[mesh][msh]") {
  CHECK_THAT(complaint(""), Contains("not a Gmsh file"));
  CHECK_THAT(complaint("solid x\n"), Contains("line 1: not a Gmsh file"));
  CHECK_THAT(complaint(replaced(kVersion2, "2.2 0 8", "2.2 1 8")), Contains("line 2: a binary"));
  CHECK_THAT(complaint(replaced(kVersion2, "2.2 0 8", "3.0 0 8")),
             Contains("2.2 and 4.1 are read"));
  CHECK_THAT(complaint(replaced(kVersion2, "2 1 0 0\n", "2 1 zero 0\n")),
             Contains("line 11: a coordinate is 'zero', not a number"));
  CHECK_THAT(complaint(replaced(kVersion2, "2 1 0 0\n", "2 1 0\n")),
             Contains("line 11: a coordinate is missing"));
  CHECK_THAT(complaint(replaced(kVersion2, "2 1 0 0\n", "1 1 0 0\n")),
             Contains("line 11: node 1 comes twice"));
  CHECK_THAT(complaint(replaced(kVersion2, "2 1 0 0\n", "2 nan 0 0\n")), Contains("not a finite"));
  CHECK_THAT(complaint(replaced(kVersion2, "$Nodes\n5", "$Nodes\n500000000000")),
             Contains("line 9: the number of nodes is 500000000000, more than the file holds"));
  CHECK_THAT(complaint(replaced(kVersion2, "$Nodes\n5", "$Nodes\n-5")), Contains("more than"));
  CHECK_THAT(complaint(replaced(kVersion2, "1 2 7 9\n", "1 2 7 8\n")),
             Contains("line 20: tetrahedron 3 has a corner 8 that is not a node"));
  CHECK_THAT(complaint(replaced(kVersion2, "3 4 3", "3 11 3")),
             Contains("line 20: a node number is missing"));
  CHECK_THAT(complaint(replaced(kVersion2, "3 4 3", "3 5 3")),
             Contains("line 20: an element of Gmsh's type 5; only tetrahedra"));
  CHECK_THAT(complaint(replaced(kVersion2, "3 1 \"body\"", "3 1 body")), Contains("not in quotes"));
  CHECK_THAT(complaint(replaced(kVersion2, "3 4 3 1 1 0 1 2 7 9\n", "3 15 2 0 1 1\n")),
             Contains("a.msh: holds no tetrahedra (") && Contains("Physical Volume"));
  CHECK_THAT(complaint("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"),
             Contains("a.msh: holds no tetrahedra; make some"));
  CHECK_THAT(read_msh_file("no/such.msh").problem().message, Contains("no/such.msh: no such file"));
}

TEST_CASE("a file that is cut off or overwritten gives a mesh or an error, never a crash",
          "[mesh][msh]") {
  for (const std::string& text : {kVersion2, kVersion4}) {
    for (std::size_t length = 0; length + 2 < text.size(); ++length) {
      INFO("first " << length << " bytes");
      CHECK_FALSE(parse_msh(text.substr(0, length), "a.msh").ok());
    }
    for (unsigned seed = 0; seed < 2000; ++seed) {
      auto random = test::random_case(seed);
      std::string damaged = text;
      for (int i = 0; i < 3; ++i) {
        damaged[random() % damaged.size()] = static_cast<char>(random() % 256);
      }
      const Result<VolumeMesh> result = parse_msh(damaged, "a.msh");
      if (!result.ok()) continue;
      INFO("seed " << seed);
      CHECK(tet_volumes(result.value().mesh).minCoeff() > 0.0);
      CHECK(result.value().mesh.nodes.allFinite());
    }
  }
}

}  // namespace
}  // namespace palpable

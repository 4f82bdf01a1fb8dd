#include "palpable/bake/mesh/inp_file.h"

#include "tests/support/replaced.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using test::replaced;
using test::tolerance;

// Two tetrahedra on a common face, as Abaqus writes them; no element uses node 50.
const std::string kDeck = R"(*HEADING
 two tetrahedra
** a comment
*NODE, NSET=ALL
1, 0., 0., 0.
2, 1., 0., 0.
3, 0., 1.0D0, 0.
4, 0., 0., 1.
5, 1., 1., 1.
50, 9., 9., 9.
*ELEMENT, TYPE=C3D4, ELSET=Left
10, 1, 2, 3, 4
*Element, type=c3d4h, elset=right
20, 2, 5, 3,
4
*NSET, NSET=base, GENERATE
1, 3
*NSET, NSET=more
base, 5,
*ELSET, ELSET=BOTH
left, 20
*SURFACE, NAME=FOOT, TYPE=ELEMENT
LEFT, S1
20, S1
*MATERIAL, NAME=RUBBER
*HYPERELASTIC, NEO HOOKE
10000., 0.0001
*STEP
*STATIC
*END STEP
*SURFACE, NAME=SHELL, TYPE=ELEMENT
LEFT, SPOS
*SURFACE, NAME=GONE, TYPE=ELEMENT
unknown, S1
*NSET, NSET=OF LEFT, ELSET=left
)";

std::string complaint(const std::string& text) {
  const Result<VolumeMesh> result = parse_inp(text, "a.inp");
  return result.ok() ? "" : result.problem().message;
}

TEST_CASE("a deck gives nodes, tetrahedra and sets, whatever the case of its words",
          "[mesh][inp]") {
  const VolumeMesh volume = value_or_throw(parse_inp(kDeck, "a.inp"));
  const TetMesh& mesh = volume.mesh;
  REQUIRE(mesh.tet_count() == 2);
  CHECK(mesh.node_count() == 5);
  CHECK_FALSE(mesh.is_quadratic());
  CHECK(tet_volumes(mesh)[0] == Approx(1.0 / 6.0));
  CHECK(tet_volumes(mesh)[1] == Approx(1.0 / 3.0));
  CHECK(volume.sets.nodes.at("ALL").size() == 5);
  CHECK(volume.sets.nodes.at("base") == std::vector{0, 1, 2});
  CHECK(volume.sets.nodes.at("more") == std::vector{0, 1, 2, 4});
  CHECK(volume.sets.tets.at("Left") == std::vector{0});
  CHECK(volume.sets.tets.at("right") == std::vector{1});
  CHECK(volume.sets.tets.at("BOTH") == std::vector{0, 1});
  REQUIRE(volume.sets.faces.at("FOOT").size() == 2);
  CHECK(volume.sets.faces.at("FOOT")[0] == Eigen::Vector3i(0, 1, 2));
  CHECK(volume.sets.nodes.at("OF LEFT") == std::vector{0, 1, 2, 3});
  // Surfaces of other elements are recorded with the reason, those of tetrahedra are read.
  CHECK(volume.sets.faces.size() == 1);
  CHECK_THAT(volume.sets.unusable.at("SHELL"), Contains("line 32") && Contains("SPOS"));
  CHECK_THAT(volume.sets.unusable.at("GONE"), Contains("'unknown' is neither"));
}

TEST_CASE("each face of a tetrahedron has Abaqus' number", "[mesh][inp]") {
  // S1 to S4 lie opposite to corners 4, 3, 1 and 2.
  for (int face = 1; face <= 4; ++face) {
    const std::string row = "LEFT, S" + std::to_string(face);
    const VolumeMesh volume =
        value_or_throw(parse_inp(replaced(kDeck, "LEFT, S1\n20, S1", row), "a.inp"));
    const int opposite = std::array{3, 2, 0, 1}[face - 1];
    INFO(row);
    CHECK_FALSE((volume.sets.faces.at("FOOT").at(0).array() == opposite).any());
  }
}

TEST_CASE("10-node tetrahedra are read with the middles of their edges", "[mesh][inp][quadratic]") {
  const TetMesh box = with_edge_nodes(box_tets({0, 0, 0}, {1, 2, 3}, 1, 1, 1));
  std::string deck = "*NODE\n";
  for (int n = 0; n < box.node_count(); ++n) {
    deck += std::to_string(n + 1);
    for (int k = 0; k < 3; ++k) deck += ", " + std::to_string(box.nodes(k, n));
    deck += "\n";
  }
  deck += "*ELEMENT, TYPE=C3D10M\n";
  for (int e = 0; e < box.tet_count(); ++e) {
    deck += std::to_string(e + 1);
    for (const int n : box.tets.col(e)) deck += ", " + std::to_string(n + 1);
    deck += ",\n ";  // Abaqus breaks long lines
    for (const int n : box.edge_nodes.col(e)) deck += std::to_string(n + 1) + ", ";
    deck += "\n";
  }
  deck += "*NSET, NSET=LONG\n";
  for (int n = 1; n <= box.node_count(); ++n) {
    deck += std::to_string(n) + (n % 16 == 0 ? ",\n" : ", ");
  }
  const VolumeMesh volume = value_or_throw(parse_inp(deck, "a.inp"));
  REQUIRE(volume.mesh.is_quadratic());
  REQUIRE(volume.mesh.tet_count() == box.tet_count());
  for (int e = 0; e < box.tet_count(); ++e) {
    for (int k = 0; k < 6; ++k) {
      CHECK(volume.mesh.nodes.col(volume.mesh.edge_nodes(k, e))
                .isApprox(box.nodes.col(box.edge_nodes(k, e)), 1e-6));
    }
  }
  CHECK(volume.sets.nodes.at("LONG").size() == static_cast<std::size_t>(box.node_count()));
  CHECK_THAT(complaint(deck + "\n*ELEMENT, TYPE=C3D4\n900, 1, 2, 3, 4\n"),
             Contains("tetrahedron 900 has 4 nodes, those before have 10"));
}

TEST_CASE("CalculiX' own beams of hexahedra are refused by their element type", "[mesh][inp]") {
  const std::filesystem::path folder = "../shared/data/solids_ccx";
  if (!std::filesystem::exists(folder)) PALPABLE_SKIP("no folder " + folder.string());
  for (const char* name : {"beammr", "beamnh", "beamnlp", "beamog"}) {
    INFO(name);
    CHECK_THAT(read_inp_file(folder / (std::string(name) + ".inp")).problem().message,
               Contains("element type C3D20R is not supported") ||
                   Contains("element type C3D8 is not supported"));
  }
}

TEST_CASE("triangles name faces, beams and springs are skipped", "[mesh][inp]") {
  // What Gmsh exports.
  const VolumeMesh volume = value_or_throw(
      parse_inp(replaced(kDeck, "*NSET, NSET=base",
                         "*ELEMENT, TYPE=CPS3, ELSET=Surface1\n101, 1, 3, 2\n102, 1, 2, 4\n"
                         "*ELEMENT, TYPE=T3D2, ELSET=Line1\n201, 1, 2\n202, 2, 3\n"
                         "*ELSET, ELSET=edge\n201, 202\n*ELSET, ELSET=skin\n101\n*NSET, NSET=base"),
                "a.inp"));
  CHECK(volume.mesh.tet_count() == 2);
  CHECK(volume.sets.faces.at("Surface1").size() == 2);
  CHECK(volume.sets.faces.at("skin").size() == 1);
  CHECK_FALSE(volume.sets.tets.contains("edge"));
}

TEST_CASE("one part with one instance may stand around a mesh", "[mesh][inp]") {
  const std::string part =
      replaced(replaced(kDeck, "*NODE, NSET=ALL", "*PART, NAME=P\n*NODE"), "*MATERIAL",
               "*END PART\n*ASSEMBLY, NAME=A\n*INSTANCE, NAME=I, PART=P\n"
               "*END INSTANCE\n*END ASSEMBLY\n*MATERIAL");
  CHECK(value_or_throw(parse_inp(part, "a.inp")).mesh.tet_count() == 2);
  // Moved by (10, 0, 0), then turned by 90 degrees about the axis through (10, 0, 0) along z.
  const Eigen::Matrix3Xd still = value_or_throw(parse_inp(part, "a.inp")).mesh.nodes;
  const auto moved = [&](const std::string& lines) {
    return value_or_throw(parse_inp(replaced(part, "PART=P\n", "PART=P\n" + lines), "a.inp"))
        .mesh.nodes;
  };
  CHECK(moved("10., 0., 0.\n") == still.colwise() + Eigen::Vector3d(10, 0, 0));
  const Eigen::Matrix3Xd turned = moved("10., 0., 0.\n10., 0., 0., 10., 0., 1., 90.\n");
  for (Eigen::Index n = 0; n < still.cols(); ++n) {
    const Eigen::Vector3d expected(10.0 - still(1, n), still(0, n), still(2, n));
    CHECK((turned.col(n) - expected).norm() < tolerance(1e-14, "rounding of sine and cosine"));
  }
  for (const char* lines :
       {"1., 0.\n", "1., 0., zero\n", "1., 0., 0.\n0., 0., 0., 0., 0., 0., 90.\n",
        "1., 0., 0.\n0., 0., 0., 0., 0., 1.\n"}) {
    CHECK_THAT(complaint(replaced(part, "PART=P\n", std::string("PART=P\n") + lines)),
               Contains("line 28: the lines of the *INSTANCE 'I' are not a translation"));
  }
  CHECK_THAT(complaint(replaced(part, "*END PART\n", "*END PART\n*PART, NAME=Tool\n")),
             Contains("a second *PART, 'Tool', beside 'P'; one body is read: delete the others"));
  CHECK_THAT(complaint(replaced(part, "*END INSTANCE\n",
                                "*END INSTANCE\n*INSTANCE, NAME=Second, PART=P\n")),
             Contains("a second *INSTANCE, 'Second', beside 'I'"));
}

TEST_CASE("an element whose nodes have the other order is turned, and that is said",
          "[mesh][inp][repair]") {
  const VolumeMesh plain = value_or_throw(parse_inp(kDeck, "a.inp"));
  CHECK(plain.repair.empty());
  const VolumeMesh volume =
      value_or_throw(parse_inp(replaced(kDeck, "10, 1, 2, 3, 4", "10, 1, 2, 4, 3"), "a.inp"));
  CHECK(tet_volumes(volume.mesh).minCoeff() > 0.0);
  // A corner of a cube, and what is between it and the opposite corner: 1/6 and 1/3.
  CHECK(
      volume.repair ==
      "repaired: 1 of 2 tetrahedra turned, whose nodes had the other order; all now fill a volume "
      "of 0.5 (in the file's lengths)");
}

// nschloe/meshio#1531: the deck of a mesher beside that of the model.
TEST_CASE("a deck is read with the files that it includes", "[mesh][inp][include]") {
  const test::ScratchFolder folder("inp_include");
  const std::size_t split = kDeck.find("*ELEMENT");
  const std::string sets = kDeck.substr(kDeck.find("*NSET"));
  const VolumeMesh whole = value_or_throw(parse_inp(kDeck, "a.inp"));
  const auto same = [&](const std::string& main) {
    test::write_bytes(folder / "main.inp", main);
    const VolumeMesh volume = value_or_throw(read_inp_file(folder / "main.inp"));
    CHECK(volume.mesh.nodes == whole.mesh.nodes);
    CHECK(volume.mesh.tets == whole.mesh.tets);
    CHECK(volume.sets.nodes == whole.sets.nodes);
    CHECK(volume.sets.tets == whole.sets.tets);
    CHECK(volume.sets.faces.at("FOOT") == whole.sets.faces.at("FOOT"));
  };
  const std::string mesh = kDeck.substr(0, kDeck.size() - sets.size());
  std::filesystem::create_directories(folder / "parts");
  test::write_bytes(folder / "parts/mesh.inp", "*INCLUDE, INPUT=nodes.inp\n" + mesh.substr(split));
  test::write_bytes(folder / "parts/nodes.inp", mesh.substr(0, split));
  same("** a model\n*Include, input=parts/mesh.inp\n" + sets);
  same("*INCLUDE,\r\n INPUT = \"parts\\mesh.inp\"\r\n" + sets);
  // Lines of data in files of their own, with and without the end of the last line.
  test::write_bytes(folder / "nodes.txt",
                    "1, 0., 0., 0.\n2, 1., 0., 0.\n3, 0., 1., 0.\n4, 0., 0., 1.");
  const std::string rest = "5, 1., 1., 1.\n50, 9., 9., 9.\n" + kDeck.substr(split);
  same("*NODE, NSET=ALL, INPUT=nodes.txt\n" + rest);
  same("*NODE, NSET=ALL\n*INCLUDE, INPUT=nodes.txt\n" + rest);
}

TEST_CASE(
    "an included file that is bad is refused with its own line, or with that which includes it",
    "[mesh][inp][include][errors]") {
  const test::ScratchFolder folder("inp_include");
  const auto complaint_of = [&](const std::string& main) {
    test::write_bytes(folder / "main.inp", main);
    const Result<VolumeMesh> result = read_inp_file(folder / "main.inp");
    return result.ok() ? "" : result.problem().message;
  };
  CHECK_THAT(complaint_of("*HEADING\n*INCLUDE, INPUT=none.inp\n"),
             Contains("main.inp: line 2: includes 'none.inp': no such file"));
  test::write_bytes(folder / "a.inp", "*INCLUDE, INPUT=b.inp\n");
  test::write_bytes(folder / "b.inp", "**\n*INCLUDE, INPUT=./a.inp\n");
  CHECK_THAT(complaint_of("*INCLUDE, INPUT=a.inp\n"),
             Contains("b.inp: line 2: includes './a.inp': which would include itself"));
  CHECK_THAT(complaint_of("*INCLUDE, INPUT=main.inp\n"), Contains("would include itself"));
  for (int k = 0; k < 12; ++k) {
    test::write_bytes(folder / fmt::format("{}.inp", k),
                      fmt::format("*INCLUDE, INPUT={}.inp\n", k + 1));
  }
  CHECK_THAT(complaint_of("*INCLUDE, INPUT=0.inp\n"), Contains("more than 10 files within"));
  // Each of two files of 100 lines includes the next one: 10 000 in all.
  std::string many = test::repeated("*INCLUDE, INPUT=q.inp\n", 100);
  test::write_bytes(folder / "q.inp", test::repeated("*INCLUDE, INPUT=r.inp\n", 100));
  test::write_bytes(folder / "r.inp", "** nothing\n");
  CHECK_THAT(complaint_of(many), Contains("more than 1000 files"));
  test::write_bytes(folder / "nodes.inp", "*NODE\n1, 0., 0., 0.\n2, one, 0., 0.\n");
  CHECK_THAT(complaint_of("*HEADING\nx\n*INCLUDE, INPUT=nodes.inp\n"),
             Contains("nodes.inp: line 3: a coordinate is 'one'"));
  test::write_bytes(folder / "nodes.inp", "*NODE\n1, 0., 0., 0.\n");
  CHECK_THAT(complaint_of("*HEADING\nx\n*INCLUDE, INPUT=nodes.inp\n*NODE\n2, two, 0, 0\n"),
             Contains("main.inp: line 5: a coordinate is 'two'"));
  CHECK_THAT(complaint_of("*INCLUDE, INPUT=.\n"), Contains("is a folder"));
  test::write_bytes(folder / "wide.inp", std::string("\xff\xfe*\0", 4));
  CHECK_THAT(complaint_of("*INCLUDE, INPUT=wide.inp\n"), Contains("is UTF-16"));
}

TEST_CASE("an element that is there twice under two numbers is refused with both", "[mesh][inp]") {
  // The same corners in another order, still of positive volume.
  CHECK_THAT(complaint(replaced(kDeck, "10, 1, 2, 3, 4\n", "10, 1, 2, 3, 4\n11, 2, 3, 1, 4\n")),
             Contains("a.inp: line 13: tetrahedra 10 and 11 have the same corners (1, 2, 3, 4)"));
}

TEST_CASE("bad decks are refused with file, line and reason", "[mesh][inp]") {
  CHECK_THAT(complaint(""), Contains("a.inp: holds no tetrahedra"));
  CHECK_THAT(complaint("solid x\n"), Contains("a.inp: line 1: not an Abaqus or CalculiX deck"));
  CHECK_THAT(complaint(replaced(kDeck, "TYPE=C3D4,", "TYPE=C3D8R,")),
             Contains("a.inp: line 11: element type C3D8R is not supported; only tetrahedra, C3D4 "
                      "and C3D10"));
  CHECK_THAT(complaint(replaced(kDeck, "TYPE=C3D4,", "")), Contains("*ELEMENT without TYPE="));
  CHECK_THAT(complaint(replaced(kDeck, "10, 1, 2, 3, 4", "10, 1, 2, 3, 7")),
             Contains("line 12: tetrahedron 10 has a corner 7 that is not a node"));
  CHECK_THAT(complaint(replaced(kDeck, "10, 1, 2, 3, 4", "10, 1, 2, 3, 3")),
             Contains("line 12: 1 of 2 tetrahedra is inverted or flat, the first is number 10"));
  CHECK_THAT(complaint(replaced(kDeck, "10, 1, 2, 3, 4\n", "10, 1, 2, 3\n")),
             Contains("line 12: element 10 has 3 nodes of 4; the file may have been cut off"));
  CHECK_THAT(complaint(replaced(kDeck, "10, 1, 2, 3, 4\n", "10, 1, 2, 3, 4, 5\n")),
             Contains("element 10 has 5 nodes instead of 4"));
  CHECK_THAT(complaint(replaced(kDeck, "20, 2, 5", "10, 2, 5")),
             Contains("element 10 comes twice"));
  CHECK_THAT(complaint(replaced(kDeck, "2, 1., 0., 0.", "1, 1., 0., 0.")),
             Contains("line 6: node 1 comes twice"));
  CHECK_THAT(complaint(replaced(kDeck, "2, 1., 0., 0.", "2, 1., 0.")),
             Contains("line 6: node 2 has no three coordinates"));
  CHECK_THAT(complaint(replaced(kDeck, "2, 1., 0., 0.", "2, one, 0., 0.")),
             Contains("line 6: a coordinate is 'one', not a number"));
  CHECK_THAT(complaint(replaced(kDeck, "2, 1., 0., 0.", "2, nan, 0., 0.")),
             Contains("not a finite"));
  CHECK_THAT(complaint(replaced(kDeck, "base, 5,", "base, 77")),
             Contains("line 18: the set 'more' has a node 77 that does not exist"));
  CHECK_THAT(complaint(replaced(kDeck, "base, 5,", "bass, 5")),
             Contains("'bass' is neither a node nor a set of nodes"));
  CHECK_THAT(complaint(replaced(kDeck, "1, 3\n", "1, 2000000000\n")),
             Contains("GENERATE names more nodes than there are"));
  CHECK_THAT(complaint(replaced(kDeck, "1, 3\n", "3, 1\n")), Contains("GENERATE needs a first"));
  CHECK_THAT(complaint(replaced(kDeck, "left, 20", "left, 21")),
             Contains("element 21 does not exist"));
  const auto unusable = [](const std::string& row) {
    return value_or_throw(parse_inp(replaced(kDeck, "20, S1", row), "a.inp"))
        .sets.unusable.at("FOOT");
  };
  CHECK_THAT(unusable("20, S5"), Contains("'S5' is no face"));
  CHECK_THAT(unusable("LOST, S1"), Contains("'LOST' is neither"));
  CHECK_THAT(complaint(replaced(kDeck, "*MATERIAL", "*INCLUDE\n*MATERIAL")),
             Contains("line 25: *INCLUDE names no file"));
  CHECK_THAT(read_inp_file("no/such.inp").problem().message, Contains("no/such.inp: no such file"));
}

TEST_CASE("a deck that is cut off or overwritten gives a mesh or an error, never a crash",
          "[mesh][inp]") {
  // The format has no end mark, so what is left may be a smaller mesh, but never a broken one.
  const std::size_t first_tet = kDeck.find("10, 1, 2, 3, 4") + 14;
  for (std::size_t length = 0; length < kDeck.size(); ++length) {
    INFO("first " << length << " bytes");
    const Result<VolumeMesh> result = parse_inp(kDeck.substr(0, length), "a.inp");
    if (length < first_tet) CHECK_FALSE(result.ok());
  }
  for (unsigned seed = 0; seed < 4000; ++seed) {
    auto random = test::random_case(seed);
    std::string damaged = kDeck;
    for (int i = 0; i < 3; ++i) {
      damaged[random() % damaged.size()] = static_cast<char>(random() % 256);
    }
    const Result<VolumeMesh> result = parse_inp(damaged, "a.inp");
    if (!result.ok()) continue;
    INFO("seed " << seed);
    const VolumeMesh& volume = result.value();
    CHECK(tet_volumes(volume.mesh).minCoeff() > 0.0);
    CHECK(volume.mesh.nodes.allFinite());
    for (const auto& [name, nodes] : volume.sets.nodes) {
      CHECK((nodes.empty() || (nodes.front() >= 0 && nodes.back() < volume.mesh.node_count())));
    }
    for (const auto& [name, tets] : volume.sets.tets) {
      CHECK((tets.empty() || (tets.front() >= 0 && tets.back() < volume.mesh.tet_count())));
    }
  }
}

}  // namespace
}  // namespace palpable

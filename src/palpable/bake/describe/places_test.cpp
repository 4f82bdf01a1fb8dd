#include "palpable/bake/describe/places.h"

#include "palpable/common/base/error.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <string>

namespace palpable {
namespace {

using Catch::Matchers::Contains;

// A box of 1 x 1 x 2 m on Z = 0 with a set of each kind.
VolumeMesh box(bool quadratic = false) {
  VolumeMesh volume;
  volume.mesh = box_tets({0, 0, 0}, {1, 1, 2}, 2, 2, 4);
  volume.sets.nodes["BASE"] = nodes_at(volume, {Where::Below{0.01}, {}});
  volume.sets.tets["LOW"] = tets_at(volume, {Where::Below{0.5}, {}});
  const Eigen::Matrix3Xi lid = faces_at(volume, {Where::Above{0.99}, {}});
  for (const auto& t : lid.colwise()) {
    volume.sets.faces["Lid"].push_back({t[2], t[1], t[0]});  // turned inwards
  }
  volume.sets.nodes["NOTHING"] = {};
  return quadratic ? with_edge_nodes(volume) : volume;
}

Where at(decltype(Where::what) what) { return {std::move(what), "a.toml:7: 'set' in [support]"}; }

template <class Choose>
std::string complaint(const Choose& choose) {
  try {
    (void)choose();
  } catch (const Error& error) { return error.what(); }
  return "";
}

TEST_CASE("nodes are chosen by height, plane, box, points and sets", "[describe][places]") {
  const VolumeMesh volume = box();
  CHECK(nodes_at(volume, at(Where::Below{0.25})).size() == 18);  // two layers of nine
  CHECK(nodes_at(volume, at(Where::Above{0.75})).size() == 18);
  CHECK(nodes_at(volume, at(Where::Plane{{1, 0, 0}, {1, 0, 0}, 1e-6})).size() == 15);
  CHECK(nodes_at(volume, at(Where::Box{{0, 0, 0}, {1, 0, 0}})).size() == 3);
  CHECK(nodes_at(volume, at(Where::Nearest{{{0, 0, 0}, {0.1, 0, 0}, {1, 1, 2}}})) ==
        std::vector{0, volume.mesh.node_count() - 1});
  CHECK(nodes_at(volume, at(Where::Named{"BASE"})).size() == 9);
  CHECK(nodes_at(volume, at(Where::Named{"base"})).size() == 9);  // names are case-insensitive
  CHECK(nodes_at(volume, at(Where::Named{"Lid"})).size() == 9);   // those of its faces
}

TEST_CASE("a set of a mesh that gets edge nodes has those between its own", "[describe][places]") {
  const VolumeMesh volume = box(true);
  for (const char* name : {"BASE", "Lid"}) {
    const std::vector<int> nodes = nodes_at(volume, at(Where::Named{name}));
    CHECK(nodes.size() == 25);
    for (const int n : nodes) { CHECK(volume.mesh.nodes(2, n) == volume.mesh.nodes(2, nodes[0])); }
  }
}

TEST_CASE("elements are chosen by their middles, a plane's by the side to which it points",
          "[describe][places]") {
  const VolumeMesh volume = box();
  const auto count = static_cast<std::size_t>(volume.mesh.tet_count());
  CHECK(tets_at(volume, at(Where::Below{0.5})).size() == count / 2);
  CHECK(tets_at(volume, at(Where::Above{0.75})).size() == count / 4);
  CHECK(tets_at(volume, at(Where::Plane{{0, 0, 1.5}, {0, 0, 1}, 0})).size() == count / 4);
  CHECK(tets_at(volume, at(Where::Plane{{0, 0, 1.5}, {0, 0, -1}, 0})).size() == 3 * count / 4);
  CHECK(tets_at(volume, at(Where::Box{{0, 0, 0}, {1, 1, 0.5}})).size() == count / 4);
  CHECK(tets_at(volume, at(Where::Named{"LOW"})).size() == count / 2);
}

TEST_CASE("faces are those of the skin, turned outwards, whichever way a set has them",
          "[describe][places]") {
  for (const VolumeMesh& volume : {box(), box(true)}) {
    for (const Where& where : {at(Where::Above{0.99}), at(Where::Named{"Lid"})}) {
      const Eigen::Matrix3Xi faces = faces_at(volume, where);
      REQUIRE(faces.cols() == 8);
      for (const auto& t : faces.colwise()) {
        const auto X = [&](int k) -> Eigen::Vector3d { return volume.mesh.nodes.col(t[k]); };
        CHECK((X(1) - X(0)).cross(X(2) - X(0))[2] > 0.0);
      }
    }
  }
}

TEST_CASE("a place that holds nothing and a set that is not there are refused with the key",
          "[describe][places]") {
  const VolumeMesh volume = box();
  const auto nodes = [&](auto what) {
    return complaint([&] { return nodes_at(volume, at(what)); });
  };
  CHECK_THAT(nodes(Where::Box{{5, 0, 0}, {6, 1, 1}}),
             Contains("a.toml:7: 'set' in [support]: no node lies in the box"));
  CHECK_THAT(nodes(Where::Plane{{9, 0, 0}, {1, 0, 0}, 1e-6}), Contains("no node lies within"));
  CHECK_THAT(nodes(Where::Named{"BASS"}), Contains("a.toml:7: 'set' in [support]: the mesh has no "
                                                   "set 'BASS'; did you mean 'BASE'?"));
  CHECK_THAT(nodes(Where::Named{"xxxxxxxxx"}),
             Contains("its sets of nodes or faces are 'BASE', 'Lid', 'NOTHING'"));
  CHECK_THAT(nodes(Where::Named{"LOW"}), Contains("no set of nodes or faces 'LOW'"));
  CHECK_THAT(nodes(Where::Named{"NOTHING"}), Contains("the set 'NOTHING' is empty"));
  CHECK_THAT(complaint([&] { return tets_at(volume, at(Where::Named{"BASE"})); }),
             Contains("the mesh has no set of elements 'BASE'"));
  CHECK_THAT(complaint([&] {
               return tets_at(volume, at(Where::Box{{5, 5, 5}, {6, 6, 6}}));
             }),
             Contains("no element has its middle there; the body reaches from (0, 0, 0)"));
  CHECK_THAT(complaint([&] {
               return faces_at(volume, at(Where::Nearest{{{0, 0, 0}}}));
             }),
             Contains("no triangle of the skin"));
  VolumeMesh odd = volume;
  odd.sets.unusable["SHELL"] = "line 3 of its file: 'SPOS' is no face of a tetrahedron";
  CHECK_THAT(complaint([&] { return faces_at(odd, at(Where::Named{"shell"})); }),
             Contains("the mesh's set 'shell' cannot be used: line 3 of its file"));
  VolumeMesh inner = volume;
  inner.sets.faces["Lid"] = {Eigen::Vector3i(0, 1, 40)};
  CHECK_THAT(complaint([&] { return faces_at(inner, at(Where::Named{"Lid"})); }),
             Contains("none of the faces of the set is on the skin"));
}

}  // namespace
}  // namespace palpable

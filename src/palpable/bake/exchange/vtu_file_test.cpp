#include "palpable/bake/exchange/vtu_file.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;

std::string content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// The values of an array as a reader finds them: its offset, counted from behind the underscore,
// the length in bytes, then the numbers.
template <class T>
std::vector<T> array(const std::string& file, const std::string& name) {
  const std::size_t at = file.find("Name=\"" + name + "\"");
  REQUIRE(at != std::string::npos);
  const std::size_t offset = file.find("offset=\"", at) + 8;
  const std::size_t data = file.find("<AppendedData encoding=\"raw\">");
  const std::size_t begin = file.find('_', data) + 1 + std::stoul(file.substr(offset));
  std::uint64_t size = 0;
  std::memcpy(&size, file.data() + begin, sizeof(size));
  REQUIRE(begin + sizeof(size) + size <= file.size());
  std::vector<T> values(size / sizeof(T));
  std::memcpy(values.data(), file.data() + begin + sizeof(size), size);
  return values;
}

TEST_CASE("a grid's points, cells and fields come back from the file as they were",
          "[exchange][vtu]") {
  const test::ScratchFolder folder("vtu");
  for (const bool quadratic : {false, true}) {
    TetMesh mesh = box_tets({0, 0, 0}, {1, 2, 3}, 1, 2, 1);
    if (quadratic) mesh = with_edge_nodes(mesh);
    const int N = mesh.node_count(), E = mesh.tet_count(), K = quadratic ? 10 : 4;
    const std::vector<VtuField> nodal{{"displacement", Eigen::MatrixXd::Random(3, N)},
                                      {"von Mises", Eigen::MatrixXd::Random(1, N)}};
    const std::vector<VtuField> elements{{"J < 1", Eigen::MatrixXd::Random(1, E)}};
    const auto path = folder.path() / "body.vtu";
    write_vtu_file(path, mesh, nodal, elements);
    const std::string file = content(path);

    CHECK_THAT(file, Contains("NumberOfPoints=\"" + std::to_string(N) + "\"") &&
                         Contains("NumberOfCells=\"" + std::to_string(E) + "\""));
    const auto same = [&](const std::string& name, const Eigen::MatrixXd& values) {
      const std::vector<double> read = array<double>(file, name);
      return read == std::vector<double>(values.data(), values.data() + values.size());
    };
    CHECK(same("points", mesh.nodes));
    CHECK(same("displacement", nodal[0].values));
    CHECK(same("von Mises", nodal[1].values));
    CHECK(same("J &lt; 1", elements[0].values));
    const auto cells = array<std::int32_t>(file, "connectivity");
    REQUIRE(cells.size() == static_cast<std::size_t>(K * E));
    for (int e = 0; e < E; ++e) {
      for (int k = 0; k < K; ++k) {
        CHECK(cells[K * e + k] == (k < 4 ? mesh.tets(k, e) : mesh.edge_nodes(k - 4, e)));
      }
    }
    const auto ends = array<std::int32_t>(file, "offsets");
    CHECK(
        (ends.size() == static_cast<std::size_t>(E) && ends.front() == K && ends.back() == K * E));
    CHECK(array<std::uint8_t>(file, "types") ==
          std::vector<std::uint8_t>(static_cast<std::size_t>(E), quadratic ? 24 : 10));
  }
}

TEST_CASE("a ten-node tetrahedron has VTK's order: its edges 01 12 20 03 13 23",
          "[exchange][vtu]") {
  const test::ScratchFolder folder("vtu_order");
  TetMesh one;
  one.nodes.resize(3, 4);
  one.nodes << 0, 2, 0, 0,  // x
      0, 0, 4, 0,           // y
      0, 0, 0, 6;           // z
  one.tets.resize(4, 1);
  one.tets << 0, 1, 2, 3;
  const TetMesh mesh = with_edge_nodes(one);
  write_vtu_file(folder.path() / "one.vtu", mesh, {});
  const std::string file = content(folder.path() / "one.vtu");
  const auto points = array<double>(file, "points");
  const auto cells = array<std::int32_t>(file, "connectivity");
  REQUIRE(cells.size() == 10);
  const std::vector<Eigen::Vector3d> middles{{1, 0, 0}, {1, 2, 0}, {0, 2, 0},
                                             {0, 0, 3}, {1, 0, 3}, {0, 2, 3}};
  for (std::size_t k = 0; k < middles.size(); ++k) {
    const auto node = static_cast<std::size_t>(cells[4 + k]);
    CHECK(Eigen::Vector3d(points[3 * node], points[3 * node + 1], points[3 * node + 2]) ==
          middles[k]);
  }
}

TEST_CASE("a grid that cannot be written or whose fields do not fit is refused",
          "[exchange][vtu][errors]") {
  const TetMesh mesh = box_tets({0, 0, 0}, {1, 1, 1}, 1, 1, 1);
  CHECK_THROWS_WITH(write_vtu_file("/nowhere/body.vtu", mesh, {}),
                    Contains("/nowhere/body.vtu") && Contains("cannot be written"));
  const std::vector<VtuField> wrong{{"u", Eigen::MatrixXd::Zero(3, 5)}};
  const test::ScratchFolder folder("vtu");
  CHECK_THROWS_AS(write_vtu_file(folder.path() / "x.vtu", mesh, wrong), ContractViolation);
}

}  // namespace
}  // namespace palpable

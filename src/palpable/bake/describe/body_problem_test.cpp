#include "palpable/bake/describe/body_problem.h"

#include "palpable/bake/describe/contact_sites.h"
#include "palpable/bake/mesh/msh_file.h"
#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/loads.h"
#include "palpable/common/base/error.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

namespace palpable {
namespace {

using Eigen::Matrix3Xd;
using test::tolerance;

struct Block {
  SolidModel model;
  Boundary boundary;
  Site site;

  Block() {
    model.mesh = box_tets({0, 0, 0}, {0.1, 0.1, 0.1}, 4, 4, 4);
    model.material = material_from_young("neo-hookean", 60e3, 0.4);
    boundary = boundary_of(model.mesh);
    std::vector<std::uint8_t> fixed;
    for (const int n : boundary.node_of_vertex) {
      fixed.push_back(model.mesh.nodes(2, n) == 0.0);
      if (fixed.back() != 0) model.fixed_nodes.push_back(n);
    }
    site = choose_sites(boundary.surface, fixed, {.count = 1, .lowest = 0.08}).front();
  }
};

// (3 x N) the same traction field as unit_load(), consistently on a mesh that may have edge nodes.
Matrix3Xd unit_traction(const Site& site, const Boundary& boundary, const TetMesh& mesh) {
  Eigen::Matrix3Xi triangles = boundary.surface.triangles;
  for (int& n : triangles.reshaped()) n = boundary.node_of_vertex[n];
  return traction_load(mesh, triangles, patch_traction(site, boundary, mesh.node_count()));
}

TEST_CASE("a traction on 4-node or 10-node elements carries the patch's newton along its direction",
          "[describe][problem]") {
  const Block block;
  const SolidModel fine = with_edge_nodes(block.model);
  for (const TetMesh& mesh : {block.model.mesh, fine.mesh}) {
    const Matrix3Xd force = unit_traction(block.site, block.boundary, mesh);
    CHECK((force.rowwise().sum() - block.site.direction).norm() <=
          tolerance(1e-6, "weights of single precision"));
  }
  CHECK((unit_load(block.site, block.boundary, fine.mesh.node_count()).rowwise().sum() -
         block.site.direction)
            .norm() <= tolerance(1e-6, "weights of single precision"));
}

TEST_CASE("10-node elements hold the edges of the held face and deform more",
          "[describe][problem]") {
  const Block block;
  const SolidModel fine = with_edge_nodes(block.model);
  CHECK(fine.fixed_nodes.size() == 9 * 9);  // of a face of 4 x 4 cells, with their diagonals
  for (const int n : fine.fixed_nodes) CHECK(fine.mesh.nodes(2, n) == 0.0);
  const auto press = [&](const SolidModel& model) {
    const Matrix3Xd unit = unit_traction(block.site, block.boundary, model.mesh);
    const PathResult path = EquilibriumSolver(model).solve_path(0.5 * unit, std::array{1.0});
    REQUIRE(path.complete);
    return unit.cwiseProduct(path.steps.back().displacement).sum();
  };
  const double coarse = press(block.model), better = press(fine);
  CHECK(better > 1.02 * coarse);
  CHECK(better < 2.0 * coarse);
}

using Catch::Matchers::Contains;

// A block of 60 x 50 x 40 mm as a file, and descriptions of it.
class BlockFile {
 public:
  BlockFile() {
    const TetMesh mesh = box_tets({0, 0, 0}, {0.06, 0.05, 0.04}, 4, 4, 3);
    write_msh_file(folder_.path() / "block.msh", mesh);
    write_msh_file(folder_.path() / "block10.msh", with_edge_nodes(mesh));
  }

  // A site in the middle of the top is added where `sections` have no [sites].
  [[nodiscard]] BodyDescription description(const std::string& sections,
                                            const std::string& shape = "",
                                            const std::string& mesh = "block.msh") const {
    std::string text = "name = 'block'\n[shape]\nmesh = '" + mesh + "'\n" + shape;
    if (sections.find("[material]") == std::string::npos) {
      text += "[material]\nyoung = '60 kPa'\npoisson = 0.4\n";
    }
    if (sections.find("[sites]") == std::string::npos) {
      text += "[sites]\npoints = ['0 mm', '0 mm', '40 mm']\n";
    }
    return parse_body_description(text + sections, folder_.path() / "block.toml");
  }
  [[nodiscard]] BodyProblem pose(const std::string& sections, const std::string& shape = "",
                                 const std::string& mesh = "block.msh") const {
    return pose_body(description(sections, shape, mesh));
  }
  [[nodiscard]] std::string refused(const std::string& sections, const std::string& shape = "",
                                    const std::string& mesh = "block.msh") const {
    try {
      (void)pose(sections, shape, mesh);
    } catch (const Error& error) { return error.what(); }
    return "";
  }

 private:
  test::ScratchFolder folder_{"body-problem"};
};

TEST_CASE("groups of elements have materials of their own and may not overlap",
          "[describe][problem]") {
  const BlockFile file;
  const std::string material =
      "[material]\nyoung = '60 kPa'\npoisson = 0.4\n"
      "[[material.group]]\nbelow = 0.34\nC1 = '1 MPa'\nD1 = '2 MPa'\n"
      "[[material.group]]\nplane = {point = ['0 mm', '0 mm', '26.6 mm'], normal = [0, 0, 1]}\n"
      "young = '1 kPa'\npoisson = 0.1\n";
  const BodyProblem problem = file.pose(material);
  REQUIRE(problem.model.groups.size() == 2);
  CHECK(problem.model.groups[0].elements.size() == 4 * 4 * 6);
  CHECK(problem.model.groups[1].elements.size() == 4 * 4 * 6);
  CHECK(std::get<NeoHookean>(problem.model.groups[0].material).C1 == 1e6);
  CHECK(lame_constants(problem.model.groups[1].material).mu == Approx(1e3 / 2.2));
  CHECK_THAT(
      file.refused(material + "[[material.group]]\nset = 'body'\nyoung = '1 kPa'\n"
                              "poisson = 0.1\n"),
      Contains("block.toml:18: 'set' in [[material.group]]: 192 elements of this group are in "
               "another one already") &&
          Contains("block.toml:14: 'plane' in [[material.group]]"));
}

TEST_CASE("the text of a problem lists elements, materials and held nodes", "[describe][problem]") {
  const BlockFile file;
  const BodyDescription plain = file.description("[support]\nbelow = 0.01\n");
  CHECK(problem_text(plain, pose_body(plain)) == "block: 100 nodes, 288 tetrahedra of 4 nodes; " +
                                                     material_line(plain.material) +
                                                     "\nheld: 25 nodes in all directions\n");
  const BodyDescription rich = file.description(
      "[material]\nyoung = '60 kPa'\npoisson = 0.4\n"
      "[[material.group]]\nbelow = 0.34\nC1 = '1 MPa'\nD1 = '2 MPa'\n"
      "[[support]]\nbelow = 0.01\n"
      "[[support]]\nabove = 0.99\nhold = 'x'\ndisplacement = ['1 mm', '0 mm', '0 mm']\n",
      "", "block10.msh");
  const BodyProblem problem = pose_body(rich);
  REQUIRE(rich.groups.size() == 1);
  CHECK_THAT(
      problem_text(rich, problem),
      Contains(" 288 tetrahedra of 10 nodes; ") &&
          Contains("\nheld: 81 nodes in all directions, 81 in some or moved\na part of it: " +
                   material_line(rich.groups[0].material) + "\n"));
}

TEST_CASE("supports hold nodes direction by direction and may not contradict each other",
          "[describe][problem]") {
  const BlockFile file;
  const BodyProblem problem = file.pose(
      "[[support]]\nbelow = 0.01\nhold = 'z'\n"
      "[[support]]\nnearest = [['-30 mm', '-25 mm', '0 mm'], ['30 mm', '25 mm', '0 mm']]\n"
      "[[support]]\nabove = 0.99\nhold = 'x'\ndisplacement = ['1 mm', '0 mm', '0 mm']\n");
  CHECK(problem.mesh.fixed_nodes.size() == 2);
  CHECK(problem.mesh.supports.size() == 23 + 25);
  CHECK(problem.preload.cols() == 0);  // moved supports are in the model
  for (const Support& support : problem.model.supports) {
    const bool lid = problem.model.mesh.nodes(2, support.node) > 0.039;
    CHECK((support.held == Eigen::Array<bool, 3, 1>(lid, false, !lid)).all());
    CHECK(support.displacement == Eigen::Vector3d(lid ? 1e-3 : 0.0, 0, 0));
  }
  CHECK(std::count(problem.model.fixed_nodes.begin(), problem.model.fixed_nodes.end(), 0) <= 1);
  CHECK(std::ranges::count(fixed_vertices(problem.mesh), 1) == 2);

  CHECK_THAT(file.refused("[[support]]\nbelow = 0.01\n[[support]]\nset = 'boundary'\nhold = 'y'\n"
                          "displacement = ['0 mm', '1 mm', '0 mm']\n"),
             Contains("block.toml:12: 'set' in [[support]]: moves the node at") &&
                 Contains("in y, but") && Contains("block.toml:10: 'below' in [[support]] by 0 m"));
  CHECK_THAT(file.refused("[support]\nbelow = 0.01\nhold = 'z'\n"),
             Contains("block.toml:10: 'below' in [support] does not hold the body") &&
                 Contains("leave 3 of its 6 rigid motions free"));
  CHECK_THAT(
      file.refused("[support]\nnearest = [['0 m', '0 m', '0 m'], ['0 m', '0 m', '40 mm']]\n"),
      Contains("only 2 of its nodes are fixed"));
  CHECK_THAT(file.refused("[support]\nset = 'body'\n"),
             Contains("block.toml:10: 'set' in [support]: the mesh has no set of nodes or faces"));
  CHECK_THAT(
      file.refused("[support]\nplane = {point = ['0 m', '0 m', '9 m'], normal = [0, 0, 1]}\n"),
      Contains("block.toml:10: 'plane' in [support]: no node lies within"));
  CHECK_THAT(file.refused("[support]\nbox = {low = ['-1 m', '-1 m', '0 m'], high = ['1 m', '1 m', "
                          "'1 m']}\n[sites]\ncount = 1\n"),
             Contains("holds every node"));
}

TEST_CASE("sites are where points and sets say, pressed the way that is asked for",
          "[describe][problem]") {
  const BlockFile file;
  const auto site = [&](const std::string& keys) {
    return file.pose("[sites]\n" + keys).sites.at(0);
  };
  const std::string corner = "points = [['30 mm', '25 mm', '40 mm'], ['30 mm', '0 mm', '20 mm']]\n";
  const BodyProblem problem = file.pose("[sites]\n" + corner);
  REQUIRE(problem.sites.size() == 2);
  const SurfaceMesh& skin = problem.mesh.boundary.surface;
  CHECK(skin.vertices.col(problem.sites[0].vertex).isApprox(Eigen::Vector3d(0.03, 0.025, 0.04)));
  CHECK(problem.sites[0].direction.isApprox(Eigen::Vector3d(-0.03, -0.025, -0.02).normalized()));
  CHECK(site(corner + "direction = [0, 3, -4]\n").direction == Eigen::Vector3d(0, 0.6, -0.8));
  // The middle of the side whose normal is x.
  CHECK(site("points = [['30 mm', '0 mm', '27 mm']]\npatch = 1\ndirection = 'normal'\n")
            .direction.isApprox(-Eigen::Vector3d::UnitX()));
  CHECK(site("points = [['30 mm', '0 mm', '27 mm']]\npatch = 0\ndirection = 'normal'\n")
            .direction.isApprox(-Eigen::Vector3d::UnitX()));

  CHECK_THAT(
      file.refused("[sites]\npoints = ['0 mm', '0 mm', '0 mm']\n"),
      Contains("block.toml:8: 'points' in [sites]: the site at (0, 0, 0) m lies on a node that "
               "[support] holds"));
  CHECK_THAT(
      file.refused("[sites]\npoints = [['0 mm', '0 mm', '41 mm'], ['1 mm', '0 mm', '40 mm']]\n"),
      Contains("sites 0 and 1 are the same vertex"));
  CHECK_THAT(file.refused("[sites]\nsets = 'lid'\n"),
             Contains("block.toml:8: 'sets' in [sites]: the mesh has no set 'lid'"));
}

TEST_CASE("points far from the body are refused with their distance, those beside it are taken",
          "[describe][problem]") {
  const BlockFile file;
  // 440 mm above the block of 40 mm.
  CHECK_THAT(file.refused("[sites]\npoints = ['0 mm', '0 mm', '480 mm']\n"),
             Contains("block.toml:8: 'points' in [sites]: the point (0, 0, 0.48) m lies 440 mm "
                      "outside the body's skin") &&
                 Contains("unit"));
  CHECK_THAT(
      file.refused("[sites]\npoints = [['30 mm', '0 mm', '20 mm'], ['30 m', '0 m', '20 m']]\n"),
      Contains("the point (30, 0, 20) m lies 3.601e+04 mm outside"));
  CHECK_THAT(file.refused("[support]\nnearest = [['0 m', '0 m', '2 m'], ['9 mm', '9 mm', '0 mm'], "
                          "['0 mm', '9 mm', '0 mm']]\n"),
             Contains("block.toml:10: 'nearest' in [support]: the point (0, 0, 2) m lies 1960 mm"));
  // Two edges off, as a surface read off by eye or from before a wrap; and a node deep inside.
  const BodyMesh& mesh = file.pose("").mesh;
  const double edge = mean_edge_length(mesh.boundary.surface);
  CHECK(file.refused(fmt::format("[sites]\npoints = ['0 mm', '0 mm', '{} mm']\n", 40 + 2e3 * edge))
            .empty());
  CHECK(
      file.refused("[support]\nnearest = [['0 mm', '0 mm', '20 mm'], ['-30 mm', '-25 mm', '0 mm'], "
                   "['30 mm', '-25 mm', '0 mm'], ['0 mm', '25 mm', '0 mm']]\n")
          .empty());
}

TEST_CASE("the range of a model is a share of its largest extent, or a length",
          "[describe][problem][range]") {
  const BlockFile file;
  CHECK(file.pose("").model.largest_displacement == Approx(0.02));
  CHECK(file.pose("[press]\nrange = 0.8\n").model.largest_displacement == Approx(0.048));
  CHECK(file.pose("[press]\nrange = '70 mm'\n").model.largest_displacement == Approx(0.07));
  CHECK_THAT(file.refused("[press]\nrange = 0\n"), Contains("'range' in [press]"));
  // A press by depth may take what it bends along, unless the description says how far.
  CHECK(file.pose("[press]\ndepth = '5 mm'\n").press_range == Approx(0.03));
  CHECK(file.pose("[press]\ndepth = '2 mm'\n").press_range == Approx(0.02));
  CHECK(file.pose("[press]\ndepth = '5 mm'\nrange = '9 mm'\n").press_range == Approx(0.009));
  CHECK(file.pose("[press]\nforce = '5 N'\n").press_range == Approx(0.02));
  const auto refusal = [&](const std::string& press) {
    const BodyDescription description = file.description("[press]\n" + press);
    try {
      refuse_beyond_range(description, pose_body(description));
    } catch (const Error& error) { return std::string(error.what()); }
    return std::string();
  };
  CHECK(refusal("depth = '19 mm'\n").empty());
  CHECK_THAT(refusal("depth = '21 mm'\n"), Contains("block.toml: a press of 21 mm") &&
                                               Contains("more than 20 mm") &&
                                               Contains("a third of the body's largest extent") &&
                                               Contains("'range' in [press]"));
  CHECK(refusal("depth = '21 mm'\nrange = 0.5\n").empty());
  CHECK_THAT(refusal("depth = '2 mm'\nrange = '1 mm'\n"), Contains("('range' in [press])"));
  CHECK(refusal("force = '1 kN'\n").empty());  // what it does is known once it is solved
}

TEST_CASE("weight and pressure add up to what they are", "[describe][problem]") {
  const BlockFile file;
  for (const char* shape : {"", "order = 2\n"}) {
    const BodyProblem problem = file.pose(
        "[gravity]\ndensity = '2000 kg/m^3'\n[[pressure]]\npressure = '3 kPa'\nabove = 0.99\n",
        shape);
    const Eigen::Vector3d total = problem.preload.rowwise().sum();
    const double weight = 2000 * 9.81 * 0.06 * 0.05 * 0.04, push = 3e3 * 0.06 * 0.05;
    CHECK((total - Eigen::Vector3d(0, 0, -weight - push)).norm() <= tolerance(1e-12, "rounding"));
  }
  CHECK(file.pose("").preload.cols() == 0);
}

TEST_CASE("order 2 puts a node on each edge and the load of a patch where such elements take it",
          "[describe][problem][quadratic]") {
  const BlockFile file;
  const BodyProblem one = file.pose(""), two = file.pose("", "order = 2\n"),
                    read = file.pose("", "", "block10.msh");
  CHECK_FALSE(one.model.mesh.is_quadratic());
  CHECK(two.model.mesh.is_quadratic());
  CHECK(read.model.mesh.node_count() == two.model.mesh.node_count());
  CHECK(two.mesh.boundary.surface.triangle_count() ==
        4 * one.mesh.boundary.surface.triangle_count());
  CHECK(check_watertight(two.mesh.boundary.surface).watertight());
  // The base of 4 x 4 cells, with the middles of its edges.
  CHECK(two.mesh.fixed_nodes.size() == 81);
  const Site& site = two.sites.at(0);
  float sum = 0;
  const int corners = one.model.mesh.node_count();
  for (std::size_t k = 0; k < site.patch.size(); ++k) {
    const int node = two.mesh.boundary.node_of_vertex[site.patch[k]];
    CHECK((site.weights[k] == 0.0f) == (node < corners));  // int N_a dA is 0 at corners
    sum += site.weights[k];
  }
  CHECK(sum == Approx(1.0f));
  CHECK(unit_load(site, two.mesh.boundary, two.model.mesh.node_count())
            .rowwise()
            .sum()
            .isApprox(site.direction, 1e-6));
  CHECK_THAT(file.refused("", "order = 1\n", "block10.msh"),
             Contains("block.toml:4: 'order' in [shape] is 1, but 'block10.msh' has 10-node"));
}

TEST_CASE("a press is given by fraction, length or force, a mesh in its own unit",
          "[describe][problem]") {
  const BlockFile file;
  CHECK(file.pose("[press]\ndepth = 0.2\n").press == Approx(0.008));
  CHECK(file.pose("[press]\ndepth = '3 mm'\n").press == Approx(0.003));
  const BodyProblem force = file.pose("[press]\nforce = '2 N'\n");
  CHECK(force.force == 2.0);
  CHECK(force.press == 0.0);
  CHECK(file.pose("[sites]\npoints = ['0 mm', '0 mm', '0.4 mm']\n", "unit = 'cm'\n").mesh.height ==
        Approx(4e-4));
}

}  // namespace
}  // namespace palpable

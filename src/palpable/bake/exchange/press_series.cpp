#include "palpable/bake/exchange/press_series.h"

#include "palpable/bake/exchange/heavy_file.h"
#include "palpable/bake/exchange/vtu_file.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/markup_text.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/body_file/hdf5_tools.h"

#include <fmt/format.h>

#include <array>
#include <string>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using Eigen::Index;

// The fields of one press at one level.
struct Shown {
  Eigen::Matrix3Xf displacement;
  Eigen::Matrix<float, 6, Eigen::Dynamic> stress;
  std::vector<float> von_mises;
};

const SeparatedField* stress_of(const ReducedBody& body) {
  if (!body.volume) return &body.stress;
  return body.volume->stress ? &*body.volume->stress : nullptr;
}

void evaluate(const ReducedBody& body, int site, double level, Shown& shown) {
  const SeparatedField& u = body.volume ? body.volume->displacement : body.displacement;
  const std::array mu{static_cast<double>(site), level};
  shown.displacement.resize(3, u.value_count() / 3);
  u.evaluate(
      mu, std::span<float>(shown.displacement.data(), static_cast<std::size_t>(u.value_count())));
  const SeparatedField* stress = stress_of(body);
  if (stress == nullptr) return;
  const auto count = static_cast<std::size_t>(stress->value_count());
  shown.stress.resize(6, stress->value_count() / 6);
  shown.von_mises.resize(count / 6);
  const std::span<float> values(shown.stress.data(), count);
  stress->evaluate(mu, values);
  von_mises(values, shown.von_mises);
}

std::vector<int> sites_of(const ReducedBody& body, std::optional<int> site) {
  PALPABLE_EXPECT(body.is_settled(), "a press has a site and a level");
  const int S = static_cast<int>(body.sites.size());
  if (site) {
    if (*site < 0 || *site >= S) {
      throw Error(fmt::format("site {}: the body has the sites 0 to {}", *site, S - 1));
    }
    return {*site};
  }
  std::vector<int> all;
  for (int s = 0; s < S; ++s) all.push_back(s);
  return all;
}

}  // namespace

void write_vtu_series(const fs::path& folder, const ReducedBody& body, std::optional<int> site) {
  const std::vector<int> sites = sites_of(body, site);
  make_folder(folder);
  TetMesh inside;
  if (body.volume) {
    inside.nodes = body.volume->nodes;
    inside.tets = body.volume->tets.topRows(4);
    if (body.volume->tets.rows() == 10) inside.edge_nodes = body.volume->tets.bottomRows(6);
  }
  Shown shown;
  for (const int s : sites) {
    std::string list =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n  <Collection>\n";
    for (Index l = 0; l < body.levels().size(); ++l) {
      evaluate(body, s, body.levels()[l], shown);
      std::vector<VtuField> fields{{"displacement", shown.displacement.cast<double>()}};
      if (!shown.von_mises.empty()) {
        fields.push_back({"stress", shown.stress.cast<double>()});
        fields.push_back({"von_mises", Eigen::Map<const Eigen::RowVectorXf>(shown.von_mises.data(),
                                                                            shown.stress.cols())
                                           .cast<double>()});
      }
      const std::string name = fmt::format("site_{:03}_level_{:03}.vtu", s, l);
      if (body.volume) {
        write_vtu_file(folder / name, inside, fields);
      } else {
        write_vtu_file(folder / name, body.surface, fields);
      }
      list += fmt::format("    <DataSet timestep=\"{}\" file=\"{}\"/>\n", body.levels()[l], name);
    }
    write_whole_file(folder / fmt::format("site_{:03}.pvd", s),
                     list + "  </Collection>\n</VTKFile>\n");
  }
}

namespace {

// The parts of XDMF that several grids share.
struct XdmfNames {
  std::string heavy;  // the file of the numbers, as it stands in XML

  [[nodiscard]] std::string item(const std::string& name, Index rows, Index columns,
                                 const char* kind, int bytes) const {
    return fmt::format(
        "<DataItem Dimensions=\"{} {}\" NumberType=\"{}\" Precision=\"{}\" "
        "Format=\"HDF\">{}:/{}</DataItem>",
        rows, columns, kind, bytes, heavy, name);
  }
};

// Topology and geometry of all grids; their numbers go into `file`.
std::string write_xdmf_mesh(hid_t file, const ReducedBody& body, const XdmfNames& names) {
  const Eigen::Matrix3Xd& nodes = body.volume ? body.volume->nodes : body.surface.vertices;
  const Eigen::MatrixXi cells =
      body.volume ? body.volume->tets : Eigen::MatrixXi(body.surface.triangles);
  const char* type = cells.rows() == 3 ? "Triangle" : cells.rows() == 4 ? "Tetrahedron" : "Tet_10";
  hdf5::write_table(file, "nodes", nodes.data(), static_cast<hsize_t>(nodes.cols()), 3);
  hdf5::write_table(file, "cells", cells.data(), static_cast<hsize_t>(cells.cols()),
                    static_cast<hsize_t>(cells.rows()));
  return fmt::format(
      "<Topology TopologyType=\"{}\" NumberOfElements=\"{}\">{}</Topology>\n"
      "<Geometry GeometryType=\"XYZ\">{}</Geometry>\n",
      type, cells.cols(), names.item("cells", cells.cols(), cells.rows(), "Int", 4),
      names.item("nodes", nodes.cols(), 3, "Float", 8));
}

// The attributes of one grid.
std::string write_xdmf_fields(hid_t file, const Shown& shown, const std::string& which,
                              const XdmfNames& names) {
  std::string xml;
  const auto attribute = [&](const char* name, const char* rank, Index columns,
                             const float* values) {
    const std::string dataset = fmt::format("{}_{}", name, which);
    hdf5::write_table(file, dataset.c_str(), values,
                      static_cast<hsize_t>(shown.displacement.cols()),
                      static_cast<hsize_t>(columns));
    xml += fmt::format(
        "<Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"Node\">{}</Attribute>\n", name, rank,
        names.item(dataset, shown.displacement.cols(), columns, "Float", 4));
  };
  attribute("displacement", "Vector", 3, shown.displacement.data());
  if (!shown.von_mises.empty()) {
    const std::array order{0, 3, 5, 1, 4, 2};  // XDMF's: xx xy xz yy yz zz
    const Eigen::MatrixXf theirs = shown.stress(order, Eigen::all);
    attribute("stress", "Tensor6", 6, theirs.data());
    attribute("von_mises", "Scalar", 1, shown.von_mises.data());
  }
  return xml;
}

}  // namespace

void write_xdmf_series(const fs::path& path, const ReducedBody& body, std::optional<int> site) {
  const std::vector<int> sites = sites_of(body, site);
  const fs::path heavy = heavy_beside(path);
  const XdmfNames names{markup_text(heavy.filename().string())};
  std::string xml = "<?xml version=\"1.0\"?>\n<Xdmf Version=\"2.0\">\n<Domain>\n";
  const auto fill = [&](hid_t file) {
    const std::string mesh = write_xdmf_mesh(file, body, names);
    Shown shown;
    for (const int s : sites) {
      xml += fmt::format(
          "<Grid Name=\"site {}\" GridType=\"Collection\" CollectionType=\"Temporal\">\n", s);
      for (Index l = 0; l < body.levels().size(); ++l) {
        evaluate(body, s, body.levels()[l], shown);
        xml += fmt::format(
            "<Grid Name=\"level {}\" GridType=\"Uniform\">\n<Time Value=\"{}\"/>\n{}{}</Grid>\n", l,
            body.levels()[l], mesh,
            write_xdmf_fields(file, shown, fmt::format("{}_{}", s, l), names));
      }
      xml += "</Grid>\n";
    }
    xml += "</Domain>\n</Xdmf>\n";
  };
  write_heavy_and_light(heavy, fill, path, xml);
}

}  // namespace palpable

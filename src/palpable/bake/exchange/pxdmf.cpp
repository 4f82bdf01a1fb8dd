#include "palpable/bake/exchange/foreign_modes.h"
#include "palpable/bake/exchange/heavy_file.h"
#include "palpable/common/base/bounded_text.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/markup_text.h"
#include "palpable/common/body_file/foreign_hdf5.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <map>
#include <pugixml.hpp>
#include <sstream>
#include <string>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using Eigen::Index;
using Eigen::MatrixXd;

// XDMF's symmetric tensors are xx xy xz yy yz zz: the place of each component in ours.
constexpr std::array<int, 6> kOursOfTheirs{0, 3, 5, 1, 4, 2};

// ---- writing ---------------------------------------------------------------------------------

// Writes the XML and the HDF5 file to which it refers, together.
class Writer {
 public:
  /// @param heavy  the name of that file, as it stands in XML
  Writer(hid_t file, std::string heavy) : file_(file), heavy_(std::move(heavy)) {}

  void line(int depth, const std::string& text) {
    xml_.append(2 * static_cast<std::size_t>(depth), ' ');
    xml_ += text + "\n";
  }
  /// @param columns  each becomes one row of the data set
  template <class Matrix>
  void item(int depth, const std::string& dataset, const Matrix& columns) {
    using Scalar = typename Matrix::Scalar;
    hdf5::write_table(file_, dataset.c_str(), columns.data(), static_cast<hsize_t>(columns.cols()),
                      static_cast<hsize_t>(columns.rows()));
    line(depth,
         fmt::format("<DataItem Dimensions=\"{} {}\" NumberType=\"{}\" Precision=\"{}\" "
                     "Format=\"HDF\">{}:/{}</DataItem>",
                     columns.cols(), columns.rows(), std::is_integral_v<Scalar> ? "Int" : "Float",
                     sizeof(Scalar), heavy_, dataset));
  }
  void attribute(const std::string& name, const char* type, const std::string& dataset,
                 const auto& columns) {
    line(3,
         fmt::format("<Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"Node\">", name, type));
    item(4, dataset, columns);
    line(3, "</Attribute>");
  }
  [[nodiscard]] const std::string& xml() const { return xml_; }

 private:
  hid_t file_;
  std::string heavy_, xml_;
};

void write_space(Writer& out, const ForeignModes& modes) {
  out.line(2, "<Grid Name=\"PGD1\" GridType=\"Uniform\">");
  out.line(3, "<Information Name=\"Dims\" Value=\"3\"/>");
  for (int d = 0; d < 3; ++d) {
    out.line(3, fmt::format("<Information Name=\"Dim{}\" Value=\"{}\"/>", d, "XYZ"[d]));
    out.line(3, fmt::format("<Information Name=\"Unit{}\" Value=\"m\"/>", d));
  }
  out.line(3, fmt::format("<Topology TopologyType=\"Triangle\" NumberOfElements=\"{}\">",
                          modes.surface.triangle_count()));
  out.item(4, "triangles", modes.surface.triangles);
  out.line(3, "</Topology>");
  out.line(3, "<Geometry GeometryType=\"XYZ\">");
  out.item(4, "vertices", modes.surface.vertices);
  out.line(3, "</Geometry>");
  const Index V = modes.surface.vertices.cols();
  for (int i = 0; i < modes.displacement.mode_count(); ++i) {
    const Eigen::Matrix3Xf mode = modes.displacement.modes().col(i).reshaped(3, V);
    const std::string name = fmt::format("displacement_{}", i);
    out.attribute(name, "Vector", name, mode);
  }
  for (int i = 0; modes.stress && i < modes.stress->mode_count(); ++i) {
    const auto ours = modes.stress->modes().col(i).reshaped(6, V);
    Eigen::MatrixXf theirs(6, V);
    for (std::size_t c = 0; c < 6; ++c) {
      theirs.row(static_cast<Index>(c)) = ours.row(kOursOfTheirs[c]);
    }
    const std::string name = fmt::format("stress_{}", i);
    out.attribute(name, "Tensor6", name, theirs);
  }
  out.line(2, "</Grid>");
}

void write_parameter(Writer& out, const ForeignModes& modes, std::size_t j) {
  const ParameterAxis& axis = modes.displacement.axes()[j];
  const Index n = axis.samples.size();
  out.line(2, fmt::format("<Grid Name=\"PGD{}\" GridType=\"Uniform\">", j + 2));
  out.line(3, "<Information Name=\"Dims\" Value=\"1\"/>");
  out.line(3, fmt::format("<Information Name=\"Dim0\" Value=\"{}\"/>", markup_text(axis.name)));
  out.line(3, "<Information Name=\"Unit0\" Value=\"-\"/>");
  if (axis.between == Between::kNothing || n == 1) {
    const Eigen::RowVectorXi points = Eigen::RowVectorXi::LinSpaced(n, 0, static_cast<int>(n) - 1);
    out.line(3, fmt::format("<Topology TopologyType=\"Polyvertex\" NumberOfElements=\"{}\" "
                            "NodesPerElement=\"1\">",
                            n));
    out.item(4, fmt::format("points_{}", j), points);
  } else {
    Eigen::Matrix2Xi lines(2, n - 1);
    for (int k = 0; k + 1 < n; ++k) lines.col(k) << k, k + 1;
    out.line(3, fmt::format("<Topology TopologyType=\"Polyline\" NumberOfElements=\"{}\" "
                            "NodesPerElement=\"2\">",
                            n - 1));
    out.item(4, fmt::format("lines_{}", j), lines);
  }
  out.line(3, "</Topology>");
  out.line(3, "<Geometry GeometryType=\"XYZ\">");
  Eigen::Matrix3Xd at = Eigen::Matrix3Xd::Zero(3, n);
  at.row(0) = axis.samples.transpose();
  out.item(4, fmt::format("samples_{}", j), at);
  out.line(3, "</Geometry>");
  const auto functions = [&](const char* field, const Eigen::MatrixXd& G) {
    for (Index i = 0; i < G.cols(); ++i) {
      const Eigen::RowVectorXd g = G.col(i).transpose();
      out.attribute(fmt::format("{}_{}", field, i), "Scalar",
                    fmt::format("{}_{}_of_{}", field, i, j), g);
    }
  };
  functions("displacement", axis.functions);
  if (modes.stress) functions("stress", modes.stress->axes()[j].functions);
  out.line(2, "</Grid>");
}

// ---- reading ---------------------------------------------------------------------------------

class Reader {
 public:
  explicit Reader(const fs::path& path) : path_(path) {}

  [[nodiscard]] Error refuse(const std::string& what) const {
    return Error(fmt::format("{}: {}", path_.string(), what));
  }

  /// The numbers of the first DataItem below `node`, one column for each entry.
  [[nodiscard]] MatrixXd columns(const pugi::xml_node& node, const std::string& what) {
    const pugi::xml_node item = node.child("DataItem");
    if (!item) throw refuse(fmt::format("{} has no DataItem", what));
    std::istringstream sizes(item.attribute("Dimensions").as_string());
    long long count = 1, first = -1;
    for (long long n = 0; sizes >> n;) {
      if (n < 1 || n > 100'000'000 || count > 400'000'000 / n) {
        throw refuse(
            fmt::format("{} claims the size '{}'", what, item.attribute("Dimensions").as_string()));
      }
      if (first < 0) first = n;
      count *= n;
    }
    if (first < 0) throw refuse(fmt::format("{} has no Dimensions", what));
    const std::string format = item.attribute("Format").as_string("XML");
    std::vector<double> values;
    if (format == "XML") {
      std::istringstream numbers(item.child_value());
      for (double x = 0; numbers >> x;) values.push_back(x);
    } else if (format == "HDF") {
      values = heavy(item.child_value(), what);
    } else {
      throw refuse(fmt::format("{} is in the format '{}'; HDF and XML are read", what, format));
    }
    if (static_cast<long long>(values.size()) != count) {
      throw refuse(
          fmt::format("{} has {} numbers where its Dimensions say {}", what, values.size(), count));
    }
    MatrixXd result = Eigen::Map<const MatrixXd>(values.data(), count / first, first);
    if (!result.allFinite()) throw refuse(fmt::format("{} is not a number somewhere", what));
    return result;
  }

  /// The numbers of a data set of the HDF5 file `file`; nothing if it has no such data set.
  [[nodiscard]] std::vector<double> heavy(const std::string& text, const std::string& what) {
    const std::size_t begin = text.find_first_not_of(" \t\r\n");
    const std::size_t end = text.find_last_not_of(" \t\r\n");
    const std::size_t colon = text.rfind(":/");
    if (begin == std::string::npos || colon == std::string::npos || colon < begin) {
      throw refuse(fmt::format("{} does not say FILE:/DATASET", what));
    }
    const std::string name = text.substr(begin, colon - begin);
    const std::string dataset = text.substr(colon + 1, end - colon);
    const fs::path file = path_.parent_path() / name;
    try {
      return hdf5::read_foreign(file, dataset).values;
    } catch (const hdf5::Trouble& trouble) {
      throw Error(fmt::format("{}: {}", file.string(), trouble.what));
    }
  }

 private:
  fs::path path_;
};

// The attributes name_0, name_1, ... of a grid, each as a column.
MatrixXd modes_of(Reader& reader, const pugi::xml_node& grid, const std::string& field) {
  std::map<long, pugi::xml_node> found;
  for (const pugi::xml_node& attribute : grid.children("Attribute")) {
    const std::string name = attribute.attribute("Name").as_string();
    const std::size_t cut = name.rfind('_');
    if (cut == std::string::npos || name.substr(0, cut) != field) continue;
    char* end = nullptr;
    const long number = std::strtol(name.c_str() + cut + 1, &end, 10);
    if (end != name.c_str() + cut + 1 && *end == '\0') found[number] = attribute;
  }
  MatrixXd columns;
  for (const auto& [number, attribute] : found) {
    const auto i = static_cast<Index>(number);
    if (i != columns.cols())
      throw reader.refuse(fmt::format("there is no {}_{}", field, columns.cols()));
    const std::string what = fmt::format("{}_{}", field, number);
    MatrixXd values = reader.columns(attribute, what);
    if (std::string(attribute.attribute("AttributeType").as_string()) == "Tensor6") {
      if (values.rows() != 6) throw reader.refuse(what + " does not have six components");
      MatrixXd ours(6, values.cols());
      for (std::size_t c = 0; c < 6; ++c) {
        ours.row(kOursOfTheirs[c]) = values.row(static_cast<Index>(c));
      }
      values = std::move(ours);
    }
    if (i > 0 && values.size() != columns.rows()) {
      throw reader.refuse(what + " has another size than the modes before it");
    }
    columns.conservativeResize(values.size(), i + 1);
    columns.col(i) = values.reshaped();
  }
  return columns;
}

// The grids of a file: the surface's, then those of the parameters in the file's order.
struct Grids {
  pugi::xml_node space;
  std::vector<pugi::xml_node> parameters;
};

Grids grids_of(const Reader& reader, const pugi::xml_document& document) {
  Grids grids;
  for (const pugi::xml_node& grid : document.child("Xdmf").child("Domain").children("Grid")) {
    const std::string type = grid.child("Topology")
                                 .attribute("TopologyType")
                                 .as_string(grid.child("Topology").attribute("Type").as_string());
    if (type == "Triangle" && !grids.space) {
      grids.space = grid;
    } else {
      grids.parameters.push_back(grid);
    }
  }
  if (!grids.space) throw reader.refuse("has no grid of triangles, which would be the surface");
  if (grids.parameters.empty() || grids.parameters.size() > SeparatedField::kMostAxes) {
    throw reader.refuse(fmt::format("has {} parameters; 1 to {} are read", grids.parameters.size(),
                                    SeparatedField::kMostAxes));
  }
  return grids;
}

SurfaceMesh surface_of(Reader& reader, const pugi::xml_node& space) {
  const MatrixXd vertices = reader.columns(space.child("Geometry"), "the surface's Geometry");
  const MatrixXd triangles = reader.columns(space.child("Topology"), "the surface's Topology");
  if (vertices.rows() != 3 || triangles.rows() != 3 || !(triangles.minCoeff() >= 0) ||
      !(triangles.maxCoeff() < static_cast<double>(vertices.cols()))) {
    throw reader.refuse("the surface is not one of triangles between points in space");
  }
  return {vertices, triangles.cast<int>()};
}

// Name and samples of a parameter; each field has its own functions.
ParameterAxis axis_of(Reader& reader, const pugi::xml_node& grid) {
  ParameterAxis axis;
  axis.name = grid.find_child_by_attribute("Information", "Name", "Dim0")
                  .attribute("Value")
                  .as_string(grid.attribute("Name").as_string());
  const MatrixXd points =
      reader.columns(grid.child("Geometry"), fmt::format("the Geometry of '{}'", axis.name));
  axis.samples = points.row(0).transpose();
  if (points.rows() > 1 && !points.bottomRows(points.rows() - 1).isZero(0)) {
    throw reader.refuse(
        fmt::format("'{}' is a grid of more than one dimension, not read yet", axis.name));
  }
  for (Index k = 1; k < axis.samples.size(); ++k) {
    if (axis.samples[k - 1] < axis.samples[k]) continue;
    throw reader.refuse(fmt::format("the points of '{}' do not increase", axis.name));
  }
  const std::string type = grid.child("Topology").attribute("TopologyType").as_string();
  axis.between = type == "Polyvertex" ? Between::kNothing : Between::kSmooth;
  return axis;
}

// Nothing when the file has no modes of that name. @param axes  of the grids, without functions
std::optional<SeparatedField> field_of(Reader& reader, const Grids& grids,
                                       std::vector<ParameterAxis> axes, const char* name) {
  const MatrixXd F = modes_of(reader, grids.space, name);
  if (F.cols() == 0) return std::nullopt;
  if (!is_single_precision(F)) throw reader.refuse(fmt::format("{} is above 1e30", name));
  for (std::size_t j = 0; j < axes.size(); ++j) {
    MatrixXd& functions = axes[j].functions;
    functions = modes_of(reader, grids.parameters[j], name);
    if (functions.cols() != F.cols() || functions.rows() != axes[j].samples.size()) {
      throw reader.refuse(fmt::format(
          "'{}' has {} functions of {} values for '{}', where {} of {} are needed", axes[j].name,
          functions.cols(), functions.rows(), name, F.cols(), axes[j].samples.size()));
    }
  }
  return SeparatedField(F.cast<float>(), std::move(axes));
}

// Vertices and loads of the sites, if the file has them: write_pxdmf() writes them, other programs
// do not.
void read_sites(const fs::path& path, ForeignModes& modes) {
  fs::path heavy = path;
  heavy += ".h5";
  if (!fs::exists(heavy)) return;  // all numbers are in the XML, or in files of other names
  try {
    std::vector<int> vertices =
        vertex_numbers(hdf5::read_foreign(heavy, "/site_vertices").values, heavy.string());
    const std::vector<double> loads = hdf5::read_foreign(heavy, "/site_loads").values;
    if (loads.size() != 3 * vertices.size()) {
      throw hdf5::Trouble{fmt::format("has {} numbers in site_loads, where {} sites need {}",
                                      loads.size(), vertices.size(), 3 * vertices.size())};
    }
    modes.site_vertices = std::move(vertices);
    modes.site_loads =
        Eigen::Map<const Eigen::Matrix3Xd>(loads.data(), 3, static_cast<Index>(loads.size() / 3));
  } catch (const hdf5::MissingDataset&) { return; } catch (const hdf5::Trouble& trouble) {
    throw Error(fmt::format("{}: {}", heavy.string(), trouble.what));
  }
}

}  // namespace

void write_pxdmf(const fs::path& path, const ForeignModes& modes) {
  const fs::path heavy = heavy_beside(path);
  std::string xml;
  const auto fill = [&](hid_t file) {
    Writer out(file, markup_text(heavy.filename().string()));
    out.line(0, "<?xml version=\"1.0\"?>");
    out.line(0, "<Xdmf Version=\"2.0\">");
    out.line(1, fmt::format("<Domain Name=\"{}\">", markup_text(path.filename().string())));
    write_space(out, modes);
    for (std::size_t j = 0; j < modes.displacement.axes().size(); ++j)
      write_parameter(out, modes, j);
    out.line(1, "</Domain>");
    out.line(0, "</Xdmf>");
    xml = out.xml();
    if (!modes.site_vertices.empty()) {  // PXDMF has no place for them
      hdf5::write_table(file, "site_vertices", modes.site_vertices.data(),
                        modes.site_vertices.size(), 1);
      hdf5::write_table(file, "site_loads", modes.site_loads.data(),
                        static_cast<hsize_t>(modes.site_loads.cols()), 3);
    }
  };
  write_heavy_and_light(heavy, fill, path, xml);
}

ForeignModes read_pxdmf(const fs::path& path) {
  Reader reader(path);
  const std::string text = value_or_throw(read_bounded_text(path, Notation::kXml));
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(text.data(), text.size());
  if (!parsed) {
    const auto line = std::count(text.begin(), text.begin() + parsed.offset, '\n') + 1;
    throw reader.refuse(fmt::format("line {}: is no XML: {}", line, parsed.description()));
  }
  const Grids grids = grids_of(reader, document);
  SurfaceMesh surface = surface_of(reader, grids.space);
  std::vector<ParameterAxis> axes;
  for (const pugi::xml_node& grid : grids.parameters) axes.push_back(axis_of(reader, grid));
  std::optional<SeparatedField> displacement = field_of(reader, grids, axes, "displacement");
  if (!displacement) throw reader.refuse("has no modes displacement_0, displacement_1, ...");
  ForeignModes modes{std::move(surface), std::move(*displacement),
                     field_of(reader, grids, axes, "stress")};
  read_sites(path, modes);
  return modes;
}

}  // namespace palpable

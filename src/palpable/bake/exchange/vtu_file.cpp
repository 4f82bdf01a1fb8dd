#include "palpable/bake/exchange/vtu_file.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/markup_text.h"
#include "palpable/common/base/output_file.h"

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <vector>

namespace palpable {
namespace {

static_assert(std::endian::native == std::endian::little,
              "numbers are written as they lie in memory");

// Collects the header's lines about arrays together with the bytes to which they refer.
class Arrays {
 public:
  template <class T>
  void add(std::string& xml, const char* type, const std::string& name, int components,
           const T* values, std::size_t count) {
    fmt::format_to(std::back_inserter(xml),
                   "        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" "
                   "format=\"appended\" offset=\"{}\"/>\n",
                   type, markup_text(name), components, bytes_.size());
    const std::uint64_t size = count * sizeof(T);
    append(&size, sizeof(size));
    append(values, size);
  }
  [[nodiscard]] const std::vector<char>& bytes() const { return bytes_; }

 private:
  void append(const void* data, std::size_t size) {
    if (size == 0) return;
    const std::size_t at = bytes_.size();
    bytes_.resize(at + size);
    std::memcpy(bytes_.data() + at, data, size);
  }
  std::vector<char> bytes_;
};

void add_fields(std::string& xml, const char* section, std::span<const VtuField> fields, int count,
                Arrays& arrays) {
  xml += fmt::format("      <{}>\n", section);
  for (const VtuField& field : fields) {
    PALPABLE_EXPECT(field.values.cols() == count, "one column for each node or element");
    arrays.add(xml, "Float64", field.name, static_cast<int>(field.values.rows()),
               field.values.data(), static_cast<std::size_t>(field.values.size()));
  }
  xml += fmt::format("      </{}>\n", section);
}

/// @param cells  (nodes per element x E)
void write_grid(const std::filesystem::path& path, const Eigen::Matrix3Xd& nodes,
                const Eigen::MatrixXi& cells, std::uint8_t type,
                std::span<const VtuField> node_fields, std::span<const VtuField> element_fields) {
  const auto N = static_cast<int>(nodes.cols()), E = static_cast<int>(cells.cols());
  const auto per_element = static_cast<std::int32_t>(cells.rows());
  std::vector<std::int32_t> ends;
  for (int e = 1; e <= E; ++e) ends.push_back(per_element * e);
  const std::vector<std::uint8_t> types(static_cast<std::size_t>(E), type);

  Arrays arrays;
  std::string xml = fmt::format(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n"
      "  <UnstructuredGrid>\n"
      "    <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
      N, E);
  add_fields(xml, "PointData", node_fields, N, arrays);
  add_fields(xml, "CellData", element_fields, E, arrays);
  xml += "      <Points>\n";
  arrays.add(xml, "Float64", "points", 3, nodes.data(), static_cast<std::size_t>(nodes.size()));
  xml += "      </Points>\n      <Cells>\n";
  arrays.add(xml, "Int32", "connectivity", 1, cells.data(), static_cast<std::size_t>(cells.size()));
  arrays.add(xml, "Int32", "offsets", 1, ends.data(), ends.size());
  arrays.add(xml, "UInt8", "types", 1, types.data(), types.size());
  xml +=
      "      </Cells>\n    </Piece>\n  </UnstructuredGrid>\n"
      "  <AppendedData encoding=\"raw\">\n_";

  write_whole_file(
      path,
      {xml, {arrays.bytes().data(), arrays.bytes().size()}, "\n  </AppendedData>\n</VTKFile>\n"});
}

}  // namespace

void write_vtu_file(const std::filesystem::path& path, const TetMesh& mesh,
                    std::span<const VtuField> node_fields,
                    std::span<const VtuField> element_fields) {
  Eigen::MatrixXi cells(mesh.is_quadratic() ? 10 : 4, mesh.tet_count());
  cells.topRows(4) = mesh.tets;
  if (mesh.is_quadratic()) cells.bottomRows(6) = mesh.edge_nodes;
  write_grid(path, mesh.nodes, cells, mesh.is_quadratic() ? std::uint8_t{24} : std::uint8_t{10},
             node_fields, element_fields);
}

void write_vtu_file(const std::filesystem::path& path, const SurfaceMesh& surface,
                    std::span<const VtuField> node_fields) {
  write_grid(path, surface.vertices, surface.triangles, 5, node_fields, {});
}

}  // namespace palpable

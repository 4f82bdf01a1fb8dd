#include "palpable/bake/exchange/vtu_file.h"
#include "palpable/bake/mesh/field_files.h"
#include "palpable/bake/mesh/msh_file.h"
#include "palpable/bake/mesh/volume_mesh.h"
#include "palpable/common/body_file/hdf5_tools.h"
#include "palpable/common/geometry/tet_mesh.h"
#include "tests/fuzz/fuzz_reader.h"
#include "tests/support/scratch_folder.h"

#include <array>
#include <cstring>
#include <zlib.h>

namespace palpable::fuzz {
namespace {

namespace fs = std::filesystem;

std::string read_volume(const fs::path& /*folder*/, const fs::path& file) {
  return said(read_volume_file(file), [](const VolumeMesh& volume) {
    (void)boundary_of(volume.mesh);
    (void)tet_volumes(volume.mesh).sum();
  });
}

// Reads fields and, if the format has them, tetrahedra.
std::string read_fields(const fs::path& /*folder*/, const fs::path& file) {
  const NodalFile nodal = read_nodal_file(file);
  double sum = 0;
  for (const NodalFile::Field& field : nodal.fields) sum += field.values.sum();
  (void)sum;
  return is_volume_file(file) ? read_volume({}, file) : std::string();
}

const std::string kMsh4 =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"body\"\n$EndPhysicalNames\n"
    "$Entities\n0 0 0 1\n1 0 0 0 1 1 1 1 1 0\n$EndEntities\n"
    "$Nodes\n2 4 1 9\n2 1 0 3\n1\n2\n7\n0 0 0\n1 0 0\n0 1 0\n3 1 0 1\n9\n0 0 1\n$EndNodes\n"
    "$Elements\n2 2 1 2\n2 1 2 1\n1 1 7 2\n3 1 4 1\n2 1 2 7 9\n$EndElements\n";

const std::string kInp =
    "*HEADING\na cube's corner\n*PART, NAME=P\n*NODE, NSET=ALL\n1, 0., 0., 0.\n2, 1., 0., 0.\n"
    "3, 0., 1., 0.\n4, 0., 0., 1.\n5, 1., 1., 1.\n*ELEMENT, TYPE=C3D4, ELSET=BODY\n"
    "1, 1, 2, 3, 4\n2, 2, 3, 4, 5\n*NSET, NSET=BASE, GENERATE\n1, 3, 1\n*NSET, NSET=TWO\nBASE, 4\n"
    "*ELSET, ELSET=ONE\n1\n*SURFACE, NAME=TOP, TYPE=ELEMENT\nBODY, S1\n1, S2\n*END PART\n"
    "*ASSEMBLY\n*INSTANCE, NAME=I, PART=P\n*END INSTANCE\n*END ASSEMBLY\n*MATERIAL, NAME=M\n"
    "*ELASTIC\n1e5, 0.3\n";

const std::string kVtk =
    "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n"
    "0 0 0 1 0 0\n0 1 0 0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\nPOINT_DATA 4\n"
    "VECTORS u double\n1 2 3 4 5 6\n7 8.5 -9e-7 10 11 12\nSCALARS T float 1\n"
    "LOOKUP_TABLE default\n1 2 3 4\nFIELD f 1\nv 2 4 double\n1 2 3 4 5 6 7 8\n";

const std::string kVtk51 =
    "# vtk DataFile Version 5.1\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n"
    "0 0 0 1 0 0\n0 1 0 0 0 1\nMETADATA\nINFORMATION 0\n\nCELLS 2 4\nOFFSETS vtktypeint64\n0 4\n"
    "CONNECTIVITY vtktypeint64\n0 1 2 3\nCELL_TYPES 1\n10\nPOINT_DATA 4\nVECTORS u double\n"
    "1 2 3 4 5 6\n7 8.5 -9e-7 10 11 12\n";

const std::string kFrd =
    "    1C\n    2C                             2                                     1\n"
    " -1         7 0.00000E+00 0.00000E+00 1.00000E+00\n"
    " -1         9 1.00000E+00-2.00000E+00 0.00000E+00\n -3\n"
    "  100CL  101 0.5\n -4  DISP        4    1\n -5  D1          1    2    1    0\n"
    " -5  D2          1    2    2    0\n -5  D3          1    2    3    0\n"
    " -5  ALL         1    2    0    0    1ALL\n"
    " -1         7 9.00000E+00 9.00000E+00 9.00000E+00\n"
    " -1         9 9.00000E+00 9.00000E+00 9.00000E+00\n -3\n 9999\n";

std::string binary_vtk() {
  const auto big = [](const auto& values) {
    std::string bytes;
    for (const auto value : values) {
      std::string one(sizeof value, '\0');
      std::memcpy(one.data(), &value, sizeof value);
      bytes.append(one.rbegin(), one.rend());
    }
    return bytes;
  };
  const std::array points{0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1.};
  return "# vtk DataFile Version 3.0\ntitle\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n" +
         big(points) + "\nCELLS 1 5\n" + big(std::array{4, 0, 1, 2, 3}) + "\nCELL_TYPES 1\n" +
         big(std::array{10}) + "\nPOINT_DATA 4\nFIELD f 1\nu 3 4 double\n" + big(points) + "\n";
}

// Arrays as text, as base64 and compressed by zlib, after the XML.
std::string packed_vtu() {
  const std::array points{0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1.};
  const auto size = static_cast<std::uint32_t>(sizeof points);
  std::string packed(200, '\0');
  uLongf length = packed.size();
  ::compress(reinterpret_cast<Bytef*>(packed.data()), &length,
             reinterpret_cast<const Bytef*>(points.data()), sizeof points);
  packed.resize(length);
  std::string appended;
  for (const std::uint32_t number : {1u, size, 0u, static_cast<std::uint32_t>(length)}) {
    appended.append(reinterpret_cast<const char*>(&number), sizeof number);
  }
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" "
         "byte_order=\"LittleEndian\" compressor=\"vtkZLibDataCompressor\">\n<UnstructuredGrid>\n"
         "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\">\n<PointData>\n"
         "<DataArray type=\"Float64\" Name=\"u\" NumberOfComponents=\"3\" format=\"appended\" "
         "offset=\"0\"/>\n</PointData>\n<Points><DataArray type=\"Float32\" "
         "NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points>\n"
         "<Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1 2 3"
         "</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">4</DataArray>"
         "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">10</DataArray></Cells>\n"
         "</Piece></UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_" +
         appended + packed + "\n</AppendedData>\n</VTKFile>\n";
}

void write_vtu(const fs::path& file, bool quadratic) {
  TetMesh mesh = box_tets({0, 0, 0}, {0.1, 0.1, 0.1}, 1, 1, 1);
  if (quadratic) mesh = with_edge_nodes(mesh);
  const std::vector<VtuField> fields{{"u", Eigen::MatrixXd::Random(3, mesh.node_count())},
                                     {"T", Eigen::MatrixXd::Random(1, mesh.node_count())}};
  write_vtu_file(file, mesh, fields);
}

void write_hdf5(const fs::path& file) {
  const hdf5::Quiet quiet;
  hdf5::write_file(
      file,
      [](hid_t h) {
        std::vector<double> values(60);
        for (std::size_t i = 0; i < values.size(); ++i) values[i] = 0.5 * static_cast<double>(i);
        hdf5::write_table(h, "u", values.data(), 20, 3);
        const hdf5::Handle group = hdf5::make_group(h, "other");
        hdf5::write_number(group, "n", 1);
        const hsize_t size[2] = {20, 3}, chunk[2] = {10, 3};
        const hdf5::Handle space(H5Screate_simple(2, size, nullptr), H5Sclose, "space");
        const hdf5::Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "creation");
        H5Pset_chunk(creation, 2, chunk);
        H5Pset_deflate(creation, 6);
        const hdf5::Handle set(H5Dcreate2(group, "packed", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT,
                                          creation, H5P_DEFAULT),
                               H5Dclose, "set");
        H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
      },
      [] {});
}

FuzzReader of_texts(const char* name, std::vector<std::pair<std::string, std::string>> files,
                    std::string (*read)(const fs::path&, const fs::path&)) {
  return {.name = name,
          .write =
              [files = std::move(files)](const fs::path& folder) {
                std::vector<std::string> names;
                for (const auto& [file, bytes] : files) {
                  test::write_bytes(folder / file, bytes);
                  names.push_back(file);
                }
                return names;
              },
          .read = read};
}

}  // namespace

void add_mesh_readers(std::vector<FuzzReader>& readers) {
  readers.push_back({.name = "volume.msh",
                     .write = [](const fs::path& folder) -> std::vector<std::string> {
                       const TetMesh mesh = box_tets({0, 0, 0}, {0.1, 0.1, 0.1}, 1, 1, 1);
                       write_msh_file(folder / "linear.msh", mesh);
                       write_msh_file(folder / "quadratic.msh", with_edge_nodes(mesh));
                       test::write_bytes(folder / "version4.msh", kMsh4);
                       return {"linear.msh", "quadratic.msh", "version4.msh"};
                     },
                     .read = read_volume});
  readers.push_back(
      of_texts("volume.inp",
               {{"a.inp", kInp},
                {"deck.inp", "*HEADING\n*INCLUDE, INPUT=a.inp\n*NSET, NSET=MORE\n1, 2\n"},
                {"around.inp", "*Include,\n input=\"deck.inp\"\n"}},
               read_volume));
  readers.back().names_folder = true;  // a damaged deck may include another twice, which is named
  readers.push_back({.name = "field.vtu",
                     .write = [](const fs::path& folder) -> std::vector<std::string> {
                       write_vtu(folder / "linear.vtu", false);
                       write_vtu(folder / "quadratic.vtu", true);
                       test::write_bytes(folder / "packed.vtu", packed_vtu());
                       return {"linear.vtu", "quadratic.vtu", "packed.vtu"};
                     },
                     .read = read_fields});
  readers.push_back(of_texts(
      "field.vtk", {{"text.vtk", kVtk}, {"binary.vtk", binary_vtk()}, {"newer.vtk", kVtk51}},
      read_fields));
  readers.push_back(of_texts("field.frd", {{"a.frd", kFrd}}, read_fields));
  readers.push_back(of_texts(
      "field.table",
      {{"a.csv", "node, U1, U2\n3, 0.5, -1e-3\n1, 2, 3\n"},
       {"a.rpt",
        "********\nField Output Report, written Mon Jan  1\n\n       Node          U.U1   U.U2\n"
        "      Label        @Loc 1        @Loc 1\n-----------------------------\n       1   1.5"
        "        -2.E-03\n       2       0.       3.\n\n  Minimum   0.   -2.E-03\n"},
       {"a.txt", "1 5 7\n2 6 8\n"}},
      read_fields));
  readers.push_back({.name = "field.h5",
                     .write = [](const fs::path& folder) -> std::vector<std::string> {
                       write_hdf5(folder / "a.h5");
                       return {"a.h5"};
                     },
                     .read =
                         [](const fs::path& folder, const fs::path& file) {
                           const std::string first = read_fields(folder, file.string() + ":/u");
                           return first + read_fields(folder, file.string() + ":other/packed");
                         }});
}

}  // namespace palpable::fuzz

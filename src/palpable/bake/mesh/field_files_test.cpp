#include "palpable/bake/mesh/field_files.h"

#include "palpable/common/base/error.h"
#include "tests/support/replaced.h"
#include "tests/support/test.h"

#include <cstring>
#include <string>
#include <zlib.h>

namespace palpable {
namespace {

using Catch::Matchers::Contains;

std::string bytes_of(const std::vector<double>& values) {
  std::string bytes(values.size() * sizeof(double), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

std::string base64(const std::string& bytes) {
  static const char* letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      bits = (bits << 8) | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    }
    for (int k = 3; k >= 0; --k) {
      const bool beyond = i + static_cast<std::size_t>(3 - k) > bytes.size();
      text += beyond ? '=' : letters[(bits >> (6 * k)) & 63];
    }
  }
  return text;
}

std::string size_header(std::initializer_list<std::uint32_t> numbers) {
  std::string bytes;
  for (const std::uint32_t n : numbers) {
    bytes.append(reinterpret_cast<const char*>(&n), sizeof n);
  }
  return bytes;
}

const std::vector<double> kPoints{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
const std::vector<double> kValues{1, 2, 3, 4, 5, 6, 7, 8.5, -9e-7, 10, 11, 12};

std::string vtu(const std::string& format, const std::string& data, const std::string& extra = "",
                const std::string& appended = "") {
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" "
         "byte_order=\"LittleEndian\"" +
         extra +
         ">\n<UnstructuredGrid>\n"
         "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\">\n<PointData>\n"
         "<DataArray type=\"Float64\" Name=\"u\" NumberOfComponents=\"3\" format=\"" +
         format + "\" offset=\"0\">" + data +
         "</DataArray>\n</PointData>\n<Points><DataArray "
         "type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1"
         "</DataArray></Points>\n<Cells>"
         "<DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1 2 3</DataArray>"
         "<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">4</DataArray>"
         "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">10</DataArray></Cells>\n"
         "</Piece></UnstructuredGrid>" +
         appended + "</VTKFile>\n";
}

void check_u(const NodalFile& file) {
  REQUIRE(file.fields.size() == 1);
  CHECK(file.fields[0].name == "u");
  CHECK(file.fields[0].values == Eigen::Map<const Eigen::MatrixXd>(kValues.data(), 3, 4));
  CHECK(file.points == Eigen::Map<const Eigen::MatrixXd>(kPoints.data(), 3, 4));
  CHECK(file.tets == std::vector<std::vector<std::int64_t>>{{0, 1, 2, 3}});
}

TEST_CASE("a .vtu is read as text, binary, appended and packed", "[mesh][import]") {
  check_u(parse_vtu(vtu("ascii", "1 2 3 4 5 6 7 8.5 -9e-7 10 11 12"), "x"));
  const std::string raw = bytes_of(kValues);
  const auto size = static_cast<std::uint32_t>(raw.size());
  check_u(parse_vtu(vtu("binary", base64(size_header({size}) + raw)), "x"));
  check_u(parse_vtu(
      vtu("appended", "", "",
          "<AppendedData encoding=\"raw\">_" + size_header({size}) + raw + "</AppendedData>"),
      "x"));
  // Two blocks of 64 bytes, the second one shorter.
  std::string packed, sizes = size_header({2, 64, size - 64});
  for (const std::string& block : {raw.substr(0, 64), raw.substr(64)}) {
    std::string small(200, '\0');
    uLongf made = small.size();
    REQUIRE(::compress(reinterpret_cast<Bytef*>(small.data()), &made,
                       reinterpret_cast<const Bytef*>(block.data()), block.size()) == Z_OK);
    packed += small.substr(0, made);
    sizes += size_header({static_cast<std::uint32_t>(made)});
  }
  const std::string zlib = " compressor=\"vtkZLibDataCompressor\"";
  check_u(parse_vtu(vtu("binary", base64(sizes) + base64(packed), zlib), "x"));
  CHECK_THROWS_WITH(parse_vtu(vtu("binary", base64(sizes) + base64(packed.substr(9)), zlib), "x"),
                    Contains("cut short") || Contains("damaged"));
}

TEST_CASE("a .vtu whose base64 header is encoded apart from its data is read", "[mesh][import]") {
  const std::string raw = bytes_of(kValues);
  const auto size = static_cast<std::uint32_t>(raw.size());
  const std::uint64_t wide = size;
  const std::string long_header(reinterpret_cast<const char*>(&wide), sizeof wide);
  const std::string wide_type = " header_type=\"UInt64\"";
  const auto appended = [](const std::string& text) {
    return "<AppendedData encoding=\"base64\">\n _" + text + "\n</AppendedData>";
  };
  const std::string apart = base64(size_header({size})) + base64(raw);
  REQUIRE(apart.find('=') < apart.size() - 4);
  check_u(parse_vtu(vtu("binary", "\n  " + apart + "\n"), "x"));
  check_u(parse_vtu(vtu("binary", base64(long_header) + base64(raw), wide_type), "x"));
  check_u(parse_vtu(vtu("binary", base64(long_header + raw), wide_type), "x"));
  check_u(parse_vtu(vtu("appended", "", "", appended(apart)), "x"));
  check_u(parse_vtu(vtu("appended", "", "", appended(base64(size_header({size}) + raw))), "x"));
  check_u(
      parse_vtu(vtu("appended", "", wide_type, appended(base64(long_header) + base64(raw))), "x"));
  CHECK_THROWS_WITH(parse_vtu(vtu("binary", apart.substr(0, apart.size() - 8)), "a.vtu"),
                    Contains("a.vtu: 'u' is cut short"));
}

TEST_CASE("a bad .vtu says what is wrong", "[mesh][import]") {
  CHECK_THROWS_WITH(parse_vtu("<VTKFile", "a.vtu"), Contains("a.vtu: line 1: not XML"));
  CHECK_THROWS_WITH(parse_vtu("<VTKFile type=\"PolyData\"/>", "a.vtu"),
                    Contains("not an UnstructuredGrid"));
  CHECK_THROWS_WITH(parse_vtu(vtu("ascii", "1 2 three"), "a.vtu"), Contains("'three' in 'u'"));
  CHECK_THROWS_WITH(parse_vtu("<VTKFile>\n" + test::repeated("<a>", 1'000'000), "a.vtu"),
                    Contains("a.vtu: line 2: nested more than 64 deep"));
  CHECK_THROWS_WITH(parse_vtu(vtu("ascii", "1 2 3"), "a.vtu"), Contains("each of its 4 points"));
  CHECK_THROWS_WITH(parse_vtu(vtu("appended", ""), "a.vtu"), Contains("cut short"));
  std::string hexahedron = vtu("ascii", "1 2 3 4 5 6 7 8 9 10 11 12");
  hexahedron.replace(hexahedron.find(">10<"), 4, ">12<");
  CHECK_THROWS_WITH(parse_vtu(hexahedron, "a.vtu"), Contains("VTK's type 12"));
}

TEST_CASE("a legacy .vtk is read as text and binary", "[mesh][import]") {
  const std::string head = "# vtk DataFile Version 3.0\ntitle\n";
  check_u(parse_vtk(head +
                        "ASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 0 1 0 0\n0 1 0 0 0 "
                        "1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\nPOINT_DATA 4\nVECTORS u "
                        "double\n1 2 3 4 5 6\n7 8.5 -9e-7 10 11 12\n",
                    "x"));
  const auto big = [](const auto& values) {
    std::string bytes;
    for (const auto value : values) {
      std::string one(sizeof value, '\0');
      std::memcpy(one.data(), &value, sizeof value);
      bytes.append(one.rbegin(), one.rend());
    }
    return bytes;
  };
  check_u(parse_vtk(head + "BINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n" + big(kPoints) +
                        "\nCELLS 1 5\n" + big(std::vector<std::int32_t>{4, 0, 1, 2, 3}) +
                        "\nCELL_TYPES 1\n" + big(std::vector<std::int32_t>{10}) +
                        "\nPOINT_DATA 4\nFIELD f 1\nu 3 4 double\n" + big(kValues) + "\n",
                    "x"));
  // meshio#877: version 5.1, which VTK 9 and ParaView write; with the notes that they add.
  const std::string newer = "# vtk DataFile Version 5.1\ntitle\n";
  const std::string note =
      "METADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 1\n\n";
  const std::string text =
      newer + "ASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0\n0 0 1 \n" +
      note +
      "CELLS 2 4\nOFFSETS vtktypeint64\n0 4 \nCONNECTIVITY vtktypeint64\n0 1 2 3 \n\n"
      "CELL_TYPES 1\n10\n\nPOINT_DATA 4\nVECTORS u double\n1 2 3 4 5 6\n7 8.5 -9e-7 10 11 12\n" +
      note;
  check_u(parse_vtk(text, "x"));
  check_u(parse_vtk(newer + "BINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n" + big(kPoints) +
                        "\n" + note + "CELLS 2 4\nOFFSETS vtktypeint64\n" +
                        big(std::vector<std::int64_t>{0, 4}) + "\nCONNECTIVITY vtktypeint64\n" +
                        big(std::vector<std::int64_t>{0, 1, 2, 3}) + "\nCELL_TYPES 1\n" +
                        big(std::vector<std::int32_t>{10}) +
                        "\nPOINT_DATA 4\nFIELD f 1\nu 3 4 double\n" + big(kValues) + "\n",
                    "x"));
  CHECK_THROWS_WITH(parse_vtk(test::replaced(text, "0 4 \nCONN", "0 5 \nCONN"), "x"),
                    Contains("the OFFSETS of cell 0"));
  CHECK_THROWS_WITH(
      parse_vtk(head + "ASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 zero", "x"),
      Contains("x: line 6: 'zero'"));
}

TEST_CASE("an .frd gives the results of its last step by their names", "[mesh][import]") {
  const std::string text =
      "    1C\n    2C                             2                                     1\n"
      " -1         7 0.00000E+00 0.00000E+00 1.00000E+00\n"
      " -1         9 1.00000E+00-2.00000E+00 0.00000E+00\n -3\n"
      "  100CL  101 0.5\n -4  DISP        4    1\n -5  D1          1    2    1    0\n"
      " -5  D2          1    2    2    0\n -5  D3          1    2    3    0\n"
      " -5  ALL         1    2    0    0    1ALL\n"
      " -1         7 9.00000E+00 9.00000E+00 9.00000E+00\n"
      " -1         9 9.00000E+00 9.00000E+00 9.00000E+00\n -3\n"
      "  100CL  102 1.0\n -4  DISP        4    1\n -5  D1          1    2    1    0\n"
      " -5  D2          1    2    2    0\n -5  D3          1    2    3    0\n"
      " -5  ALL         1    2    0    0    1ALL\n"
      " -1         9 1.00000E-01-2.00000E-01 3.00000E-01\n"
      " -1         7 4.00000E-01 5.00000E-01-6.00000E-01\n -3\n 9999\n";
  const NodalFile file = parse_frd(text, "x");
  CHECK(file.numbers == std::vector<std::int64_t>{7, 9});
  CHECK(file.points.col(1) == Eigen::Vector3d(1, -2, 0));
  REQUIRE(file.fields.size() == 1);
  CHECK(file.fields[0].name == "DISP");
  CHECK(file.fields[0].values.col(0) == Eigen::Vector3d(0.4, 0.5, -0.6));
  CHECK(file.fields[0].values.col(1) == Eigen::Vector3d(0.1, -0.2, 0.3));
  std::string torn = text;
  torn.erase(torn.rfind(" -1         7"), 50);
  CHECK_THROWS_WITH(parse_frd(torn, "a.frd"), Contains("a.frd: line") && Contains("for node 7"));
  CHECK_THROWS_WITH(parse_frd("\x01\x02", "a.frd"), Contains("not an ASCII .frd"));
}

// FreeCAD#29515: CalculiX for Windows; pyvista#8447: the short form.
TEST_CASE("an .frd with exponents of three digits, or of the short form, is read",
          "[mesh][import]") {
  const auto frd = [](const std::string& first, const std::string& second, char form) {
    const std::string head = "    1C\n    2C" + std::string(67, ' ') + form + "\n";
    return head + first + " 0.00000E+00 0.00000E+00 1.00000E+00\n -3\n -4  DISP        4    1\n" +
           " -5  D1          1    2    1    0\n -5  D2          1    2    2    0\n" +
           " -5  D3          1    2    3    0\n" + second + "\n -3\n 9999\n";
  };
  const NodalFile windows = parse_frd(
      frd(" -1         4", " -1         4-5.28012E-0033.06745E-003-7.70711E-003", '1'), "x");
  CHECK(windows.numbers == std::vector<std::int64_t>{4});
  CHECK(windows.fields[0].values.col(0) == Eigen::Vector3d(-5.28012e-3, 3.06745e-3, -7.70711e-3));
  const NodalFile positive = parse_frd(
      frd(" -1         4", " -1         45.28012E-0033.06745E+0027.70711E-003", '1'), "x");
  CHECK(positive.fields[0].values.col(0) == Eigen::Vector3d(5.28012e-3, 306.745, 7.70711e-3));
  const NodalFile brief =
      parse_frd(frd(" -1    4", " -1    4 1.00000E+00-2.00000E+00 3.00000E+00", '0'), "x");
  CHECK(brief.numbers == std::vector<std::int64_t>{4});
  CHECK(brief.fields[0].values.col(0) == Eigen::Vector3d(1, -2, 3));
  CHECK_THROWS_WITH(parse_frd(frd(" -1         4", " -1         4-5.2E", '1'), "a.frd"),
                    Contains("'-5.2E' is not a number"));
  CHECK_THROWS_WITH(parse_frd(frd("", "", '2'), "a.frd"), Contains("line 2: binary; only ASCII"));
  // Nodes of the same kind, and an element of 20 nodes, which takes two lines.
  const std::string whole =
      "    1C\n    2C" + std::string(67, ' ') +
      "1\n -1         45.28012E-0030.00000E+000-7.70711E-003\n"
      " -3\n    3C                             1                                     1\n"
      " -1         1    4    0    1\n -2         4         4         4         4         4         "
      "4"
      "         4         4         4         4\n -2         4         4         4         4       "
      "  4"
      "         4         4         4         4         4\n -3\n -4  NDTEMP      1    1\n"
      " -5  T           1    1    0    0\n -1         41.00000E-300\n -3\n 9999\n";
  const NodalFile solid = parse_frd(whole, "x");
  CHECK(solid.points.col(0) == Eigen::Vector3d(5.28012e-3, 0, -7.70711e-3));
  REQUIRE(solid.fields.size() == 1);
  CHECK(solid.fields[0].values(0, 0) == 1e-300);
}

TEST_CASE("a .vtk is read with any line ends, and a .vtu whose blocks announce too much is refused",
          "[mesh][import]") {
  std::string text =
      "\xef\xbb\xbf# vtk DataFile Version 3.0\rtitle\rASCII\rDATASET UNSTRUCTURED_GRID\rPOINTS 4 "
      "float\r0 0 0 1 0 0\r0 1 0 0 0 1\rCELLS 1 5\r4 0 1 2 3\rCELL_TYPES 1\r10\rPOINT_DATA 4\r"
      "VECTORS u double\r1 2 3 4 5 6\r7 8.5 -9e-7 10 11 12\r";
  check_u(parse_vtk(text, "x"));
  check_u(parse_vtk(text + '\0', "x"));
  CHECK_THROWS_WITH(parse_vtk(text + std::string(2, '\0'), "a.vtk"),
                    Contains("a.vtk: line 16: a zero byte"));
  std::string zeros = vtu("ascii", "1 2 3 4 5 6 7 8.5 -9e-7 10 11 12");
  check_u(parse_vtu(zeros, "x"));
  CHECK_THROWS_WITH(parse_vtu(zeros + std::string(100, '\0'), "a.vtu"), Contains("a zero byte"));
  std::string order = zeros;
  order.replace(order.find("LittleEndian"), 12, "MiddleEndian");
  CHECK_THROWS_WITH(parse_vtu(order, "a.vtu"), Contains("byte_order"));
  CHECK_THROWS_WITH(parse_table("node;x;y\n1;0,5;0,25\n", "a.csv"),
                    Contains("line 2: has decimal commas"));
}

TEST_CASE("a .npy is an array of nodes x components", "[mesh][import]") {
  const auto npy = [](const std::string& header, const std::string& data) {
    std::string bytes = "\x93NUMPY";
    bytes += '\1';
    bytes += '\0';
    bytes += static_cast<char>(header.size());
    bytes += '\0';
    return bytes + header + data;
  };
  const std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': (4, 3), }\n";
  const NodalFile file = parse_npy(npy(header, bytes_of(kValues)), "x");
  CHECK(file.fields[0].values == Eigen::Map<const Eigen::MatrixXd>(kValues.data(), 3, 4));
  CHECK_THROWS_WITH(parse_npy(npy(header, bytes_of(kPoints).substr(8)), "x"),
                    Contains("88 bytes of numbers where its shape needs 96"));
  CHECK_THROWS_WITH(
      parse_npy(npy("{'descr': '<i8', 'fortran_order': False, 'shape': (4, 3), }", ""), "x"),
      Contains("float64 or float32"));
  CHECK_THROWS_WITH(
      parse_npy(npy("{'descr': '<f8', 'fortran_order': True, 'shape': (4, 3), }", ""), "x"),
      Contains("ascontiguousarray"));
  CHECK_THROWS_WITH(
      parse_npy(npy("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 4, 3), }", ""), "x"),
      Contains("nodes x components"));
}

TEST_CASE("tables of node and values are read with and without titles", "[mesh][import]") {
  const NodalFile csv = parse_table("node, U1, U2\n3, 0.5, -1e-3\n1, 2, 3\n", "x");
  CHECK(csv.numbers == std::vector<std::int64_t>{3, 1});
  REQUIRE(csv.fields.size() == 2);
  CHECK(csv.fields[1].name == "U2");
  CHECK(csv.fields[1].values == Eigen::RowVector2d(-1e-3, 3));
  // As Abaqus prints a report.
  const NodalFile rpt = parse_table(
      "********\nField Output Report, written Mon Jan  1\n\n"
      "       Node          U.U1          U.U2\n      Label        @Loc 1        @Loc 1\n"
      "-----------------------------\n       1       1.5        -2.E-03\n       2       0.       "
      "3.\n"
      "\n  Minimum   0.   -2.E-03\n      At Node     2    1\n",
      "x");
  CHECK(rpt.numbers == std::vector<std::int64_t>{1, 2});
  REQUIRE(rpt.fields.size() == 2);
  CHECK(rpt.fields[0].name == "U.U1");
  CHECK(rpt.fields[0].values == Eigen::RowVector2d(1.5, 0));
  CHECK(parse_table("1 5\n2 6\n", "x").fields[0].name == "1");
  CHECK_THROWS_WITH(parse_table("1 5 6\n2 6\n", "a.csv"),
                    Contains("a.csv: line 2: 2 columns where those before have 3"));
  CHECK_THROWS_WITH(parse_table("1 5\n2.5 6\n", "a.csv"),
                    Contains("line 2: '2.5' is not the number"));
  CHECK_THROWS_WITH(parse_table("1 5 7\n2 6 six\n", "a.csv"), Contains("line 2: 'six'"));
  CHECK_THROWS_WITH(parse_table("nothing here\n", "a.csv"), Contains("has no line"));
}

}  // namespace
}  // namespace palpable

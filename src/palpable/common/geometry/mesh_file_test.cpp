#include "palpable/common/geometry/mesh_file.h"

#include "tests/support/scratch_folder.h"
#include "tests/support/surface_bytes.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using namespace std::string_literals;
using namespace test;  // the bytes of every format

std::string problem_of(const std::string& bytes, const char* extension) {
  const Result<SurfaceMesh> result = parse_surface(bytes, extension, "x"s + extension);
  return result ? "(read)" : result.problem().message;
}

// The same tetrahedron in every format; its volume is 1/6.
std::vector<std::pair<std::string, const char*>> all_formats() {
  return {{kOff, ".off"},         {kObj, ".obj"},       {kPly, ".PLY"},
          {binary_stl(), ".stl"}, {text_stl(), ".stl"}, {big_endian_ply(), ".ply"},
          {studio_3ds(), ".3ds"}};
}

TEST_CASE("every format gives the same watertight tetrahedron", "[geometry][files]") {
  for (const auto& [bytes, extension] : all_formats()) {
    INFO(extension << " of " << bytes.size() << " bytes");
    const Result<SurfaceMesh> surface = parse_surface(bytes, extension, "x");
    REQUIRE(surface.ok());
    CHECK(surface.value().vertex_count() == 4);
    CHECK(surface.value().triangle_count() == 4);
    CHECK(check_watertight(surface.value()).describe() == "watertight");
    CHECK(enclosed_volume(surface.value()) == 1.0 / 6.0);  // corners of 0 and 1: exact
  }
}

TEST_CASE("wrong input names the place and the reason", "[geometry][errors]") {
  CHECK(problem_of("", ".off") == "x.off: line 0: the file is empty");
  CHECK(
      problem_of("OFF\n4 4 0\n0 0 zero\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n",
                 ".off") == "x.off: line 3: 'zero' is not a coordinate");
  CHECK(problem_of("v 0 0 0\nf 1 2 3\n", ".obj") ==
        "x.obj: line 2: '2' is not one of the 1 vertices so far");
  CHECK(problem_of("v 0 0 nan\n", ".obj") == "x.obj: line 1: 'nan' is not a coordinate");
  CHECK(problem_of("S" + binary_stl().substr(1, 200), ".stl").find("4 triangles are announced") !=
        std::string::npos);
  CHECK(problem_of("# nothing\n", ".obj") == "x.obj: holds no triangles");
  CHECK(problem_of("hello", ".3ds") == "x.3ds: byte 0: not a 3DS file");
  CHECK(problem_of("hello", ".blend").find("not '.blend'") != std::string::npos);
  CHECK(read_surface_file("/nowhere/a.stl").problem().message == "/nowhere/a.stl: no such file");
}

TEST_CASE("a count beyond the file's size is refused before memory is taken",
          "[geometry][errors]") {
  CHECK(problem_of("OFF\n99999999999 1 0\n", ".off") ==
        "x.off: line 2: 99999999999 vertices are announced, there is room for 0");
  CHECK(problem_of("OFF\n-1 1 0\n", ".off") ==
        "x.off: line 2: '-1' is not a possible number of vertices");
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\n"
      "element face 1\nproperty list uchar int vertex_index\nend_header\n";
  CHECK(problem_of(ply + "1 2 3\n", ".ply") ==
        "x.ply: line 7: 4000000000 of the element 'vertex' are announced, there is room for 3");
  std::string binary = ply;
  binary.replace(binary.find("ascii"), 5, "binary_little_endian");
  CHECK(problem_of(binary + "1234567", ".ply").find("4000000000 of the element 'vertex' are") !=
        std::string::npos);
  std::string stl = binary_stl();
  stl.replace(80, 4, "\xff\xff\xff\xff");
  CHECK(problem_of(stl, ".stl") ==
        "x.stl: byte 84: 4294967295 triangles are announced, there is room for 4");
  std::string chunk = studio_3ds();
  chunk[5] = '\x7f';
  CHECK(problem_of(chunk, ".3ds").find("claims 21") != std::string::npos);
}

// A text as other editors and systems write it.
std::vector<std::pair<std::string, std::string>> written_otherwise(const std::string& text) {
  std::string dos, mac = text;
  for (const char c : text) dos += c == '\n' ? "\r\n" : std::string(1, c);
  std::replace(mac.begin(), mac.end(), '\n', '\r');
  const std::string mark = "\xef\xbb\xbf";
  return {{"CRLF", dos},
          {"CR", mac},
          {"BOM", mark + text},
          {"BOM, CR", mark + mac},
          {"BOM, CRLF", mark + dos},
          {"a zero at the end", text + "\0"s}};
}

TEST_CASE("a text gives the same surface with a byte-order mark and with any line ends",
          "[geometry][files]") {
  for (const auto& [text, extension] : all_formats()) {
    if (text.find('\0') != std::string::npos) continue;  // binary
    const SurfaceMesh expected = value_or_throw(parse_surface(text, extension, "x"));
    for (const auto& [how, other] : written_otherwise(text)) {
      INFO(extension << ", " << how);
      const Result<SurfaceMesh> found = parse_surface(other, extension, "x");
      REQUIRE(found.ok());
      CHECK(found.value().vertices == expected.vertices);
      CHECK(found.value().triangles == expected.triangles);
    }
    std::string wide;
    for (const char c : text) wide += {c, '\0'};
    CHECK(problem_of("\xff\xfe"s + wide, extension).find(extension) != std::string::npos);
    CHECK(problem_of(wide, extension) != "(read)");
    CHECK(problem_of(text + "\0\0"s, extension).find("a zero byte") != std::string::npos);
  }
  CHECK(problem_of("\xff\xfev\0"s, ".obj") == "x.obj: is UTF-16: save it as UTF-8");
}

TEST_CASE("a binary STL may begin with 'solid', a text one with SOLID", "[geometry][files]") {
  std::string binary = binary_stl();
  binary.replace(0, 11, "solid part1");
  CHECK(value_or_throw(parse_surface(binary, ".stl", "x")).triangle_count() == 4);
  // Where the size does not decide, the zeros of the header do: the counts are what is wrong.
  CHECK(problem_of(binary + "more", ".stl") ==
        "x.stl: byte 84: 4 triangles are announced, which end at byte 284, but 4 more bytes follow "
        "(there is room for 4): the file was padded, or its count is wrong; export it again");
  CHECK(problem_of(binary.substr(0, 200), ".stl") ==
        "x.stl: byte 84: 4 triangles are announced, there is room for 2");
  CHECK(problem_of(binary.substr(0, 70), ".stl").find("has 70 bytes, where the header of an STL") !=
        std::string::npos);
  // A header of blanks, and a word of texts in it, as a program for CAD writes it.
  std::string blank = binary;
  blank.replace(0, 80, ("solid facet part" + std::string(80, ' ')).substr(0, 80));
  CHECK(value_or_throw(parse_surface(blank, ".stl", "x")).triangle_count() == 4);
  CHECK(problem_of(blank + "more", ".stl").find("4 more bytes follow") != std::string::npos);
  CHECK(problem_of("solid part\n", ".stl").find("has no facets in its 11 bytes") !=
        std::string::npos);
  std::string loud = text_stl();
  std::transform(loud.begin(), loud.end(), loud.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  CHECK(value_or_throw(parse_surface(loud, ".stl", "x")).triangle_count() == 4);
  const std::string text = text_stl();
  CHECK(problem_of(text.substr(0, text.rfind("endloop")), ".stl").find("within a facet") !=
        std::string::npos);
}

// trimesh#753: ModelNet's header without a blank; meshlab#292: vertices with colours.
TEST_CASE("headers of OFF that programs write are read", "[geometry][files]") {
  const SurfaceMesh expected = value_or_throw(parse_surface(kOff, ".off", "x"));
  const std::string rest = kOff.substr(kOff.find('\n') + 1);
  const std::string colored =
      "4 4 0\n0 0 0 255 0 0 255\n1 0 0 0 255 0 255\n0 1 0 9 9 9 255\n0 0 1 1 2 3 255\n" +
      rest.substr(rest.find("3 0 2 1"));
  for (const std::string& text : {"OFF" + rest, "OFF " + rest, "OFF\n\n" + rest, "COFF\n" + colored,
                                  "STCNOFF\n" + colored, "COFF4 4 0\n" + colored.substr(6)}) {
    const SurfaceMesh found = value_or_throw(parse_surface(text, ".off", "x"));
    CHECK(found.vertices == expected.vertices);
    CHECK(found.triangles == expected.triangles);
  }
  for (const char* header : {"4OFF\n", "nOFF\n", "off\n", "OF\n"}) {
    CHECK(problem_of(header + rest, ".off").find("begins with the word OFF") != std::string::npos);
  }
  CHECK(problem_of("OFF BINARY\n" + rest, ".off").find("'BINARY' is not a possible number") !=
        std::string::npos);
}

TEST_CASE("a line of an OBJ may be continued on the next one", "[geometry][files]") {
  const std::string one = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
  const SurfaceMesh expected = value_or_throw(parse_surface(one, ".obj", "x"));
  for (const std::string& text :
       {"v 0 0 0\nv 1 \\\n0 0\nv 1 1 0\nv 0 1 0\nf 1 2 \\\n3 \\\n4\n"s,
        "v 0 0 0\r\nv 1 0\\\r\n0\r\nv 1 1 0\r\nv 0 1 0\r\nf 1 2 3\\ \r\n4 \\"s}) {
    const SurfaceMesh found = value_or_throw(parse_surface(text, ".obj", "x"));
    CHECK(found.vertices == expected.vertices);
    CHECK(found.triangles == expected.triangles);
  }
  CHECK(problem_of("v 0 0 0\nv 1 0 \\\nzero\n", ".obj") ==
        "x.obj: line 3: 'zero' is not a coordinate");
}

// Three tetrahedra, each with its own block of vertices and of faces that count back from the line
// on which they stand (mikedh/trimesh#2364).
TEST_CASE("relative indices of an OBJ count from the line on which they stand",
          "[geometry][files]") {
  std::string text;
  for (int block = 0; block < 3; ++block) {
    for (const char* corner : {"0 0 0", "1 0 0", "0 1 0", "0 0 1"}) {
      text += "v " + std::to_string(3 * block) + std::string(corner).substr(1) + "\n";
      if (corner[0] == '1') text.replace(text.rfind("v "), 3, "v " + std::to_string(3 * block + 1));
    }
    text += "f -4 -2 -3\nf -4 -3 -1\nf -4 -1 -2\nf -3 -2 -1\n";
  }
  const SurfaceMesh surface = value_or_throw(parse_surface(text, ".obj", "x"));
  CHECK(surface.vertex_count() == 12);
  CHECK(surface.triangle_count() == 12);
  CHECK(check_watertight(surface).describe() == "watertight");
  CHECK_THAT(enclosed_volume(surface), Catch::WithinAbs(0.5, 1e-12));
}

// tinyobjloader#140 and #382
TEST_CASE("an OBJ's index 0 is refused with its line, and polygons become fans",
          "[geometry][files][errors]") {
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 0.5 0\n";
  CHECK(problem_of(square + "f 0 1 2\n", ".obj") ==
        "x.obj: line 6: '0' is not one of the 5 vertices so far");
  CHECK(problem_of(square + "f -6 1 2\n", ".obj") ==
        "x.obj: line 6: '-6' is not one of the 5 vertices so far");
  CHECK(value_or_throw(parse_surface(square + "f 1 2 3 4 5\n", ".obj", "x")).triangle_count() == 3);
}

TEST_CASE("a surface file is refused by its first bytes, its size or its ending",
          "[geometry][files][errors]") {
  const test::ScratchFolder folder("surface_bounds");
  const auto refused = [&](const char* name, const std::string& start, std::uintmax_t size) {
    test::write_bytes(folder / name, start);
    std::filesystem::resize_file(folder / name, size);
    return read_surface_file(folder / name).problem().message;
  };
  const std::uintmax_t large = 5'000'000'000;
  CHECK_THAT(refused("a.stl", binary_stl(), large), Catch::Contains("5000 MB, where 500 are read"));
  CHECK_THAT(refused("b.stl", "", large), Catch::Contains("no triangles are announced"));
  CHECK_THAT(refused("c.stl", text_stl(), large), Catch::Contains("a zero byte"));
  CHECK_THAT(refused("a.obj", "", large), Catch::Contains("line 1: a zero byte"));
  CHECK_THAT(refused("b.obj", kObj, large), Catch::Contains("a zero byte"));
  CHECK_THAT(refused("a.off", kOff, large), Catch::Contains("a zero byte"));
  CHECK_THAT(refused("a.ply", kPly, large), Catch::Contains("where 500 are read"));
  CHECK_THAT(refused("b.ply", "", large), Catch::Contains("begins with 'ply'"));
  CHECK_THAT(refused("a.3ds", studio_3ds(), large), Catch::Contains("where 500 are read"));
  CHECK_THAT(refused("b.3ds", "", large), Catch::Contains("not a 3DS file"));
  CHECK_THAT(refused("film.mp4", "", large), Catch::Contains("not '.mp4'"));
  CHECK_THAT(refused("empty.stl", "", 0), Catch::Contains("empty.stl: is empty"));
}

// A simple fuzz test that runs everywhere: each format cut at every length, and with bytes
// replaced. The result must be what read_surface_file() promises: a valid surface or a problem.
TEST_CASE("damaged files are read or refused, never worse", "[geometry][fuzz]") {
  int read = 0, refused = 0;
  const auto feed = [&](const std::string& bytes, const char* extension) {
    const Result<SurfaceMesh> result = parse_surface(bytes, extension, "x");
    ++(result ? read : refused);
    if (!result) return;
    const SurfaceMesh& surface = result.value();
    const bool keeps_promise = surface.triangle_count() >= 1 && surface.vertices.allFinite() &&
                               surface.triangles.minCoeff() >= 0 &&
                               surface.triangles.maxCoeff() < surface.vertex_count();
    if (!keeps_promise) FAIL("a surface that breaks its promise from a damaged " << extension);
  };
  for (const auto& [bytes, extension] : all_formats()) {
    for (std::size_t n = 0; n < bytes.size(); ++n) feed(bytes.substr(0, n), extension);
    for (unsigned seed = 0; seed < 1000; ++seed) {
      auto random = test::random_case(seed);
      std::string damaged = bytes;
      for (int hit = 0; hit < 3; ++hit) {
        const std::size_t at = random() % damaged.size();
        damaged[at] = static_cast<char>(random());
      }
      feed(damaged, extension);
    }
  }
  CHECK(read > 0);  // with a changed comment or coordinate a file can still be read
  CHECK(refused > 1000);
}

TEST_CASE("what write_ply writes is read back unchanged", "[geometry][files]") {
  const auto path = std::filesystem::temp_directory_path() / "palpable_mesh_file_test.ply";
  const SurfaceMesh sphere = sphere_surface({0.1, 0.2, 0.3}, 1.7, 1);
  write_ply(path, sphere);
  const Result<SurfaceMesh> again = read_surface_file(path);
  REQUIRE(again.ok());
  CHECK(enclosed_volume(again.value()) == enclosed_volume(sphere));
  CHECK(again.value().triangle_count() == sphere.triangle_count());
  std::filesystem::remove(path);
  CHECK_THROWS_AS(write_ply("/nowhere/a.ply", sphere), Error);
}

TEST_CASE("a coloured surface is read back as the same surface, its colours behind its vertices",
          "[geometry][files]") {
  const test::ScratchFolder folder("colored_ply");
  SurfaceMesh square;
  square.vertices.resize(3, 4);
  square.vertices << 0, 1, 1, 0, 0, 0, 2, 2, 0.5, 0.5, 0.5, 0.5;
  square.triangles.resize(3, 2);
  square.triangles << 0, 0, 1, 2, 2, 3;
  const std::vector<Rgb> colors{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {255, 254, 253}};
  write_colored_ply(folder / "square.ply", square, colors, "a square");
  const SurfaceMesh read = value_or_throw(read_surface_file(folder / "square.ply"));
  CHECK(read.vertices == square.vertices);
  CHECK(read.triangles == square.triangles);
  const std::string bytes = test::file_bytes(folder / "square.ply");
  CHECK(bytes.find("\ncomment a square\n") != std::string::npos);
  const std::size_t vertices = bytes.find("end_header\n") + 11;
  const std::size_t stride = 15;  // bytes of a vertex: three floats, three colours
  CHECK(bytes.substr(vertices + 12, 3) == "\x01\x02\x03");
  CHECK(bytes.substr(vertices + 3 * stride + 12, 3) == "\xff\xfe\xfd");
  CHECK_THROWS_AS(write_colored_ply("/nowhere/a.ply", square, colors, ""), Error);
}

}  // namespace
}  // namespace palpable

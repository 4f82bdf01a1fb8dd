#include "palpable/common/geometry/mesh_file.h"

#include "tests/support/scratch_folder.h"
#include "tests/support/surface_bytes.h"
#include "tests/support/test.h"

#include <filesystem>

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
  CHECK(problem_of("OFF\n4 4 0\n0 0 zero\n", ".off") ==
        "x.off: line 3: 'zero' is not a coordinate");
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
  CHECK(problem_of("OFF\n99999999999 1 0\n", ".off").find("not a possible number") !=
        std::string::npos);
  CHECK(problem_of("ply\nformat ascii 1.0\nelement vertex 4000000000\n", ".ply")
            .find("not a possible number") != std::string::npos);
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

#include "palpable/geometry/mesh_file.h"

#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <filesystem>

namespace palpable {
namespace {

using namespace std::string_literals;

std::string problem_of(const std::string& bytes, const char* extension) {
  const Result<SurfaceMesh> result = parse_surface(bytes, extension, "x"s + extension);
  return result ? "(read)" : result.problem().message;
}

template <class T>
void put(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

// The same tetrahedron in every format; its volume is 1/6.
const std::string kOff =
    "OFF # a comment\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
    "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3 255 0 0\n";
const std::string kObj =
    "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\n"
    "f 1 3 2\nf 1/1 2/1 4/1\nf 2//1 3//1 4//1\nf -2 -4 -1\n";
const std::string kPly =
    "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\n"
    "property float x\nproperty float y\nproperty float z\nproperty uchar red\n"
    "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0 9\n1 0 0 9\n0 1 0 9\n0 0 1 9\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";

constexpr double kCorners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
constexpr int kFaces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};

std::string binary_stl() {
  std::string bytes = "solid but binary all the same";
  bytes.resize(80);
  put(bytes, std::uint32_t{4});
  for (const auto& face : kFaces) {
    for (int k = 0; k < 3; ++k) put(bytes, 0.0f);
    for (const int v : face) {
      for (const double x : kCorners[v]) put(bytes, static_cast<float>(x));
    }
    put(bytes, std::uint16_t{0});
  }
  return bytes;
}

std::string text_stl() {
  std::string text = "solid tetra\n";
  for (const auto& face : kFaces) {
    text += "facet normal 0 0 0\n outer loop\n";
    for (const int v : face) {
      text += "  vertex";
      for (const double x : kCorners[v]) text += " " + std::to_string(x);
      text += "\n";
    }
    text += " endloop\nendfacet\n";
  }
  return text + "endsolid\n";
}

std::string big_endian_ply() {
  std::string bytes =
      "ply\nformat binary_big_endian 1.0\nelement vertex 4\nproperty double x\n"
      "property double y\nproperty double z\nelement face 4\n"
      "property list uchar short vertex_index\nend_header\n";
  const auto put_swapped = [&](auto value) {
    std::string raw;
    put(raw, value);
    bytes.append(raw.rbegin(), raw.rend());
  };
  for (const auto& corner : kCorners) {
    for (const double x : corner) put_swapped(x);
  }
  for (const auto& face : kFaces) {
    put(bytes, std::uint8_t{3});
    for (const int v : face) put_swapped(static_cast<std::int16_t>(v));
  }
  return bytes;
}

std::string chunk(std::uint16_t id, const std::string& content) {
  std::string bytes;
  put(bytes, id);
  put(bytes, static_cast<std::uint32_t>(content.size() + 6));
  return bytes + content;
}

std::string studio_3ds() {
  std::string vertices, faces;
  put(vertices, std::uint16_t{4});
  for (const auto& corner : kCorners) {
    for (const double x : corner) put(vertices, static_cast<float>(x));
  }
  put(faces, std::uint16_t{4});
  for (const auto& face : kFaces) {
    for (const int v : face) put(faces, static_cast<std::uint16_t>(v));
    put(faces, std::uint16_t{7});
  }
  const std::string mesh = chunk(0x4100, chunk(0x4110, vertices) + chunk(0x4120, faces));
  return chunk(0x4D4D, chunk(0x0002, "1234") + chunk(0x3D3D, chunk(0x4000, "Box\0"s + mesh)));
}

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

// A poor man's fuzzer that runs everywhere: each format cut at every length, and with bytes
// replaced. What is asked for is in the docstring: a surface that keeps its promise, or a problem.
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
  CHECK(read > 0);  // damage to a comment or a coordinate is none
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

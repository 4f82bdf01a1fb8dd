/// @file
/// The surface of one tetrahedron in every format of surfaces, as written by other programs: for
/// tests of readers.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

namespace palpable::test {

template <class T>
void put(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

inline const std::string kOff =
    "OFF # a comment\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
    "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3 255 0 0\n";
inline const std::string kObj =
    "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\n"
    "f 1 3 2\nf 1/1 2/1 4/1\nf 2//1 3//1 4//1\nf -2 -4 -1\n";
inline const std::string kPly =
    "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\n"
    "property float x\nproperty float y\nproperty float z\nproperty uchar red\n"
    "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0 9\n1 0 0 9\n0 1 0 9\n0 0 1 9\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";

inline constexpr double kCorners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
inline constexpr int kFaces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};

inline std::string binary_stl() {
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

inline std::string text_stl() {
  std::string text = "solid tetra\n";
  for (const auto& face : kFaces) {
    text += "facet normal 0 0 0\n outer loop\n";
    for (const int v : face) {
      text += "  vertex";
      for (const double x : kCorners[v]) {
        text += " ";
        text += std::to_string(x);
      }
      text += "\n";
    }
    text += " endloop\nendfacet\n";
  }
  return text + "endsolid\n";
}

inline std::string big_endian_ply() {
  std::string bytes =
      "ply\nformat binary_big_endian 1.0\nelement vertex 4\nproperty double x\n"
      "property double y\nproperty double z\nelement face 4\n"
      "property list uchar short vertex_index\nend_header\n";
  const auto put_swapped = [&](auto value) {
    std::string raw;
    put(raw, value);
    std::ranges::reverse(raw);
    bytes += raw;
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

inline std::string chunk(std::uint16_t id, const std::string& content) {
  std::string bytes;
  put(bytes, id);
  put(bytes, static_cast<std::uint32_t>(content.size() + 6));
  return bytes + content;
}

inline std::string studio_3ds() {
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
  return chunk(
      0x4D4D, chunk(0x0002, "1234") + chunk(0x3D3D, chunk(0x4000, std::string("Box\0", 4) + mesh)));
}

}  // namespace palpable::test

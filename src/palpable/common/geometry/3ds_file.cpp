#include "palpable/common/geometry/surface_files.h"

#include <cstdint>
#include <utility>

namespace palpable::surface_files {

namespace {

// Chunks of 3D Studio: identifier, length with the header's six bytes, content.
constexpr std::uint16_t kMain = 0x4D4D, kEditor = 0x3D3D, kObject = 0x4000, kMesh = 0x4100,
                        kVertexList = 0x4110, kFaceList = 0x4120;

void parse_3ds_chunks(std::string_view data, std::size_t offset, Soup& soup, int depth) {
  if (depth > 8) throw Bad{fmt::format("byte {}", offset), "chunks are nested too deeply"};
  // Faces refer to the vertices of their own mesh, which precede them in the same parent.
  const int base = static_cast<int>(soup.vertices.size());
  std::size_t at = 0;
  while (data.size() - at >= 6) {
    Bytes bytes(data.substr(at));
    const auto id = bytes.get<std::uint16_t>();
    const auto length = bytes.get<std::uint32_t>();
    if (length < 6 || length > data.size() - at) {
      throw Bad{fmt::format("byte {}", offset + at),
                fmt::format("chunk {:#06x} claims {} bytes of {}", id, length, data.size() - at)};
    }
    const std::string_view content = data.substr(at + 6, length - 6);
    const std::size_t content_offset = offset + at + 6;
    Bytes inside(content);
    switch (id) {
      case kMain:
      case kEditor:
      case kMesh:
        parse_3ds_chunks(content, content_offset, soup, depth + 1);
        break;
      case kObject: {
        const std::size_t name = content.find('\0');
        if (name == std::string_view::npos) {
          throw Bad{fmt::format("byte {}", content_offset), "an object's name does not end"};
        }
        parse_3ds_chunks(content.substr(name + 1), content_offset + name + 1, soup, depth + 1);
        break;
      }
      case kVertexList: {
        const auto count = inside.get<std::uint16_t>();
        for (int i = 0; i < count; ++i) {
          const float x = inside.get<float>(), y = inside.get<float>(), z = inside.get<float>();
          soup.vertices.push_back(finite_point(inside, static_cast<double>(x),
                                               static_cast<double>(y), static_cast<double>(z)));
        }
        break;
      }
      case kFaceList: {
        const auto count = inside.get<std::uint16_t>();
        const int vertex_count = static_cast<int>(soup.vertices.size()) - base;
        for (int i = 0; i < count; ++i) {
          Eigen::Vector3i corners;
          for (int k = 0; k < 3; ++k) corners[k] = inside.get<std::uint16_t>();
          inside.skip(2);  // visibility of the edges
          if (corners.maxCoeff() >= vertex_count) {
            throw Bad{fmt::format("byte {}", content_offset),
                      fmt::format("face {} has a corner that is not one of the {} vertices", i,
                                  vertex_count)};
          }
          soup.triangles.emplace_back(corners.array() + base);
        }
        break;
      }
      default:
        break;  // materials, lights, cameras, key frames
    }
    at += length;
  }
}

}  // namespace

std::string why_no_3ds(std::string_view first, std::size_t size) {
  if (first.size() < 6 || !first.starts_with("\x4D\x4D")) return "byte 0: not a 3DS file";
  std::uint32_t length;
  std::memcpy(&length, first.data() + 2, sizeof length);
  if (length < 6 || length > size) {
    return fmt::format("byte 0: chunk {:#06x} claims {} bytes of {}", kMain, length, size);
  }
  return {};
}

Soup parse_3ds(std::string_view data) {
  if (std::string why = why_no_3ds(data, data.size()); !why.empty()) throw Bad{"", std::move(why)};
  Soup soup;
  parse_3ds_chunks(data, 0, soup, 0);
  return soup;
}

}  // namespace palpable::surface_files

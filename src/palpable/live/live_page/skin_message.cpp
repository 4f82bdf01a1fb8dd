#include "palpable/live/live_page/skin_message.h"

#include <bit>
#include <cstdint>

namespace palpable {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they are");

void add_count(std::string& bytes, std::ptrdiff_t count) {
  const auto number = static_cast<std::uint32_t>(count);
  bytes.append(reinterpret_cast<const char*>(&number),
               sizeof(number));  // NOLINT(*-reinterpret-cast)
}

// @param count  numbers of four bytes
template <class Number>
void add_numbers(std::string& bytes, const Number* numbers, std::ptrdiff_t count) {
  static_assert(sizeof(Number) == 4);
  bytes.append(reinterpret_cast<const char*>(numbers),  // NOLINT(*-reinterpret-cast)
               4 * static_cast<std::size_t>(count));
}

}  // namespace

std::string mesh_message(std::span<const Eigen::Matrix3Xi> triangles) {
  std::string bytes = "MESH";
  add_count(bytes, static_cast<std::ptrdiff_t>(triangles.size()));
  for (const Eigen::Matrix3Xi& of_body : triangles) {
    add_count(bytes, of_body.cols());
    add_numbers(bytes, of_body.data(), of_body.size());
  }
  return bytes;
}

void write_skin_message(int frame, std::span<const SceneBody> bodies, std::string& bytes) {
  bytes = "SKIN";
  add_count(bytes, frame);
  add_count(bytes, static_cast<std::ptrdiff_t>(bodies.size()));
  for (const SceneBody& body : bodies) {
    const Eigen::Index count = body.vertices.cols();
    add_count(bytes, count);
    add_numbers(bytes, body.vertices.data(), 3 * count);
    if (body.normals.cols() == count) {
      add_numbers(bytes, body.normals.data(), 3 * count);
    } else {
      bytes.append(12 * static_cast<std::size_t>(count), '\0');
    }
    if (static_cast<Eigen::Index>(body.von_mises.size()) == count) {
      add_numbers(bytes, body.von_mises.data(), count);
    } else {
      bytes.append(4 * static_cast<std::size_t>(count), '\0');
    }
  }
}

}  // namespace palpable

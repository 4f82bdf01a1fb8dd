#include "palpable/common/geometry/mesh_file.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/plain_text.h"
#include "palpable/common/base/whole_file.h"
#include "palpable/common/geometry/surface_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <iterator>
#include <new>
#include <string>
#include <utility>

namespace palpable {

namespace {

Result<SurfaceMesh> surface_of_soup(const surface_files::Soup& soup, std::string_view name) {
  if (soup.triangles.empty()) return Problem{fmt::format("{}: holds no triangles", name)};
  SurfaceMesh surface;
  surface.vertices.resize(3, static_cast<Eigen::Index>(soup.vertices.size()));
  for (std::size_t i = 0; i < soup.vertices.size(); ++i) {
    surface.vertices.col(static_cast<Eigen::Index>(i)) = soup.vertices[i];
  }
  surface.triangles.resize(3, static_cast<Eigen::Index>(soup.triangles.size()));
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    // A face list that comes before its vertices (PLY allows it) is checked only here.
    if (soup.triangles[t].maxCoeff() >= surface.vertex_count()) {
      return Problem{fmt::format("{}: triangle {} has a corner that is not a vertex", name, t)};
    }
    surface.triangles.col(static_cast<Eigen::Index>(t)) = soup.triangles[t];
  }
  return surface;
}

void add_bytes(std::string& bytes, const void* data, std::size_t size) {
  bytes.append(static_cast<const char*>(data), size);
}

// Appends the triangles in the form of a binary PLY: the number of corners, then the corners.
void add_triangles(std::string& bytes, const SurfaceMesh& surface) {
  for (int t = 0; t < surface.triangle_count(); ++t) {
    bytes += '\3';
    add_bytes(bytes, surface.triangles.col(t).data(), 3 * sizeof(int));
  }
}

// Largest surface that is read, bytes: ten million triangles of a binary STL, of which a remesher
// keeps a hundredth. While they are joined, they need six times as much memory.
constexpr std::uintmax_t kLargestSurface = 500'000'000;

std::string lower_case(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

// @param kind  the file's ending, in lower case
Result<std::string> surface_bytes(const std::filesystem::path& path, const std::string& kind) {
  FileBound bound{.most = kLargestSurface,
                  .remedy = "reduce its triangles in a mesh program, to a million for example"};
  bound.why_not = [&](std::string_view first, std::uintmax_t size) -> std::string {
    if (kind == ".stl") return surface_files::why_no_stl(first, size);
    if (kind == ".ply") return surface_files::why_no_ply(first, size);
    if (kind == ".3ds") return surface_files::why_no_3ds(first, size);
    return why_no_text(first, first.size() < size ? TextPart::kFirst : TextPart::kAll);
  };
  Result<std::string> bytes = read_whole_file(path, bound);
  if (!bytes) return Problem{fmt::format("{}: {}", path.string(), bytes.problem().message)};
  return bytes;
}

bool is_surface_ending(std::string_view kind) {
  constexpr std::array<std::string_view, 5> kEndings{".stl", ".ply", ".obj", ".3ds", ".off"};
  return std::find(kEndings.begin(), kEndings.end(), kind) != kEndings.end();
}

Problem unknown_ending(std::string_view name, std::string_view ending) {
  return {fmt::format("{}: surfaces are read from .stl, .ply, .obj, .3ds or .off, not '{}'", name,
                      ending)};
}

Problem problem_of(std::string_view name, const surface_files::Bad& bad) {
  if (bad.where.empty()) return {fmt::format("{}: {}", name, bad.what)};
  return {fmt::format("{}: {}: {}", name, bad.where, bad.what)};
}

}  // namespace

Result<SurfaceMesh> parse_surface(std::string_view bytes, std::string_view extension,
                                  std::string_view name) {
  const std::string kind = lower_case(extension);
  try {
    surface_files::Soup soup;
    if (kind == ".stl") {
      soup = surface_files::parse_stl(bytes);
    } else if (kind == ".ply") {
      soup = surface_files::parse_ply(bytes);
    } else if (kind == ".obj") {
      soup = surface_files::parse_obj(bytes);
    } else if (kind == ".3ds") {
      soup = surface_files::parse_3ds(bytes);
    } else if (kind == ".off") {
      soup = surface_files::parse_off(bytes);
    } else {
      return unknown_ending(name, extension);
    }
    const Result<SurfaceMesh> surface = surface_of_soup(soup, name);
    if (!surface) return surface;
    return merge_equal_vertices(surface.value());
  } catch (const surface_files::Bad& bad) {
    return problem_of(name, bad);
  } catch (const std::bad_alloc&) {
    return Problem{fmt::format("{}: needs more memory than there is", name)};
  }
}

Result<SurfaceMesh> read_surface_file(const std::filesystem::path& path) {
  const std::string ending = path.extension().string();
  if (!is_surface_ending(lower_case(ending))) return unknown_ending(path.string(), ending);
  const Result<std::string> bytes = surface_bytes(path, lower_case(ending));
  if (!bytes) return Problem{bytes.problem()};
  return parse_surface(bytes.value(), ending, path.string());
}

Result<ValuedSurface> read_valued_ply(const std::filesystem::path& path,
                                      std::string_view property) {
  const Result<std::string> bytes = surface_bytes(path, ".ply");
  if (!bytes) return Problem{bytes.problem()};
  const std::string name = path.string();
  try {
    const surface_files::Soup soup = surface_files::parse_ply(bytes.value(), property);
    Result<SurfaceMesh> surface = surface_of_soup(soup, name);
    if (!surface) return Problem{surface.problem()};
    ValuedSurface valued{std::move(surface).value(), {}};
    if (!soup.values.empty() && soup.values.size() != soup.vertices.size()) {
      return Problem{fmt::format("{}: {} vertices and {} of '{}'", name, soup.vertices.size(),
                                 soup.values.size(), property)};
    }
    valued.values = Eigen::Map<const Eigen::VectorXd>(
        soup.values.data(), static_cast<Eigen::Index>(soup.values.size()));
    return valued;
  } catch (const surface_files::Bad& bad) {
    return problem_of(name, bad);
  } catch (const std::bad_alloc&) {
    return Problem{fmt::format("{}: needs more memory than there is", name)};
  }
}

void write_ply(const std::filesystem::path& path, const SurfaceMesh& surface) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\n"
      "property double y\nproperty double z\nelement face {}\n"
      "property list uchar int vertex_indices\nend_header\n",
      surface.vertex_count(), surface.triangle_count());
  add_bytes(bytes, surface.vertices.data(),
            sizeof(double) * static_cast<std::size_t>(surface.vertices.size()));
  add_triangles(bytes, surface);
  write_whole_file(path, bytes);
}

void write_valued_ply(const std::filesystem::path& path, const ValuedSurface& surface,
                      std::string_view property) {
  const SurfaceMesh& mesh = surface.surface;
  PALPABLE_EXPECT(surface.values.size() == mesh.vertex_count(), "a value for each vertex");
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\n"
      "property double y\nproperty double z\nproperty float {}\nelement face {}\n"
      "property list uchar int vertex_indices\nend_header\n",
      mesh.vertex_count(), property, mesh.triangle_count());
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    add_bytes(bytes, mesh.vertices.col(v).data(), 3 * sizeof(double));
    const auto value = static_cast<float>(surface.values[v]);
    add_bytes(bytes, &value, sizeof value);
  }
  add_triangles(bytes, mesh);
  write_whole_file(path, bytes);
}

void write_colored_ply(const std::filesystem::path& path, const SurfaceMesh& surface,
                       std::span<const Rgb> colors, std::string_view comment) {
  PALPABLE_EXPECT(std::ssize(colors) == surface.vertex_count(), "a colour for each vertex");
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment {}\n"
      "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face {}\n"
      "property list uchar int vertex_indices\nend_header\n",
      comment, surface.vertex_count(), surface.triangle_count());
  for (int i = 0; i < surface.vertex_count(); ++i) {
    const Eigen::Vector3f p = surface.vertices.col(i).cast<float>();
    add_bytes(bytes, p.data(), 3 * sizeof(float));
    const Rgb c = colors[i];
    const char rgb[3] = {static_cast<char>(c.r), static_cast<char>(c.g), static_cast<char>(c.b)};
    add_bytes(bytes, rgb, sizeof rgb);
  }
  add_triangles(bytes, surface);
  write_whole_file(path, bytes);
}

}  // namespace palpable

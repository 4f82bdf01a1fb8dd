#include "palpable/geometry/mesh_file.h"

#include "palpable/base/contract.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

namespace palpable {
namespace {

static_assert(std::endian::native == std::endian::little, "binary meshes are read as they lie");

// Thrown inside this file only; parse_surface turns it into a Problem.
struct Bad {
  std::string where;  // "line 12" or "byte 340"
  std::string what;
};

// A surface while it is being read.
struct Soup {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> triangles;

  void add_fan(const std::vector<int>& polygon) {
    for (std::size_t k = 2; k < polygon.size(); ++k) {
      triangles.emplace_back(polygon[0], polygon[k - 1], polygon[k]);
    }
  }
};

// ---- text --------------------------------------------------------------------------------------

class Words {
 public:
  explicit Words(std::string_view line) : rest_(line) {}

  std::string_view next() {
    const std::size_t begin = rest_.find_first_not_of(" \t\r\v\f");
    if (begin == std::string_view::npos) return rest_ = {};
    rest_.remove_prefix(begin);
    const std::string_view word = rest_.substr(0, rest_.find_first_of(" \t\r\v\f"));
    rest_.remove_prefix(word.size());
    return word;
  }

 private:
  std::string_view rest_;
};

class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}

  bool next(std::string_view& line) {
    if (rest_.empty()) return false;
    ++number_;
    const std::size_t end = rest_.find('\n');
    line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    return true;
  }

  // The next line with content: comments (from `comment` on) and blank lines are skipped.
  bool next_content(std::string_view& line, char comment) {
    while (next(line)) {
      line = line.substr(0, line.find(comment));
      if (!Words(line).next().empty()) return true;
    }
    return false;
  }

  [[noreturn]] void bad(const std::string& what) const {
    throw Bad{fmt::format("line {}", number_), what};
  }

  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

template <class T>
std::optional<T> as_number(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  T value{};
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (code != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

double coordinate(Lines& lines, std::string_view word) {
  const auto value = as_number<double>(word);
  if (!value || !std::isfinite(*value)) {
    lines.bad(fmt::format("'{}' is not a coordinate", word.substr(0, 40)));
  }
  return *value;
}

Eigen::Vector3d point(Lines& lines, Words& words) {
  const double x = coordinate(lines, words.next());
  const double y = coordinate(lines, words.next());
  return {x, y, coordinate(lines, words.next())};
}

std::size_t count_of(Lines& lines, std::string_view word, const char* what) {
  const auto value = as_number<std::size_t>(word);
  // A line holds at least two bytes, so a file cannot hold more things than bytes left.
  if (!value || *value > lines.rest().size()) {
    lines.bad(fmt::format("'{}' is not a possible number of {}", word.substr(0, 40), what));
  }
  return *value;
}

int index_in(Lines& lines, std::string_view word, std::size_t count) {
  const auto value = as_number<long long>(word);
  if (!value || *value < 0 || static_cast<std::size_t>(*value) >= count) {
    lines.bad(fmt::format("'{}' is not one of the {} vertices", word.substr(0, 40), count));
  }
  return static_cast<int>(*value);
}

// ---- OFF ---------------------------------------------------------------------------------------

Soup parse_off(std::string_view text) {
  Lines lines(text);
  std::string_view line;
  if (!lines.next_content(line, '#')) lines.bad("the file is empty");
  Words header(line);
  if (header.next() != "OFF") lines.bad("an OFF file begins with the word OFF");
  std::string_view first = header.next();
  Words words = header;
  if (first.empty()) {
    if (!lines.next_content(line, '#')) lines.bad("the counts are missing");
    words = Words(line);
    first = words.next();
  }
  const std::size_t vertex_count = count_of(lines, first, "vertices");
  const std::size_t face_count = count_of(lines, words.next(), "faces");

  Soup soup;
  soup.vertices.reserve(vertex_count);
  for (std::size_t i = 0; i < vertex_count; ++i) {
    if (!lines.next_content(line, '#')) lines.bad("the file ends before its last vertex");
    Words w(line);
    soup.vertices.push_back(point(lines, w));
  }
  std::vector<int> polygon;
  for (std::size_t i = 0; i < face_count; ++i) {
    if (!lines.next_content(line, '#')) lines.bad("the file ends before its last face");
    Words w(line);
    const auto corners = as_number<int>(w.next());
    if (!corners || *corners < 3 || static_cast<std::size_t>(*corners) > line.size()) {
      lines.bad("a face needs at least three corners");
    }
    polygon.clear();
    for (int k = 0; k < *corners; ++k) polygon.push_back(index_in(lines, w.next(), vertex_count));
    soup.add_fan(polygon);
  }
  return soup;
}

// ---- OBJ ---------------------------------------------------------------------------------------

Soup parse_obj(std::string_view text) {
  Lines lines(text);
  std::string_view line;
  Soup soup;
  std::vector<int> polygon;
  while (lines.next_content(line, '#')) {
    Words words(line);
    const std::string_view what = words.next();
    if (what == "v") {
      soup.vertices.push_back(point(lines, words));
    } else if (what == "f") {
      polygon.clear();
      for (std::string_view w = words.next(); !w.empty(); w = words.next()) {
        const std::string_view number = w.substr(0, w.find('/'));  // v/vt/vn: only v is wanted
        const auto value = as_number<long long>(number);
        const auto count = static_cast<long long>(soup.vertices.size());
        // Counted from 1, or backwards from the last vertex if negative.
        const long long index = value ? (*value > 0 ? *value - 1 : count + *value) : -1;
        if (!value || index < 0 || index >= count) {
          lines.bad(
              fmt::format("'{}' is not one of the {} vertices so far", w.substr(0, 40), count));
        }
        polygon.push_back(static_cast<int>(index));
      }
      if (polygon.size() < 3) lines.bad("a face needs at least three corners");
      soup.add_fan(polygon);
    }
  }
  return soup;
}

// ---- binary ------------------------------------------------------------------------------------

class Bytes {
 public:
  explicit Bytes(std::string_view bytes) : bytes_(bytes) {}

  template <class T>
  T get(bool swap = false) {
    need(sizeof(T));
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes_.data() + at_, sizeof(T));
    if (swap) std::reverse(raw.begin(), raw.end());
    at_ += sizeof(T);
    return std::bit_cast<T>(raw);
  }

  void skip(std::size_t count) {
    need(count);
    at_ += count;
  }

  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  [[nodiscard]] std::size_t at() const { return at_; }
  [[noreturn]] void bad(const std::string& what) const {
    throw Bad{fmt::format("byte {}", at_), what};
  }

 private:
  void need(std::size_t count) const {
    if (left() < count) bad("the file is cut short");
  }

  std::string_view bytes_;
  std::size_t at_ = 0;
};

Eigen::Vector3d finite_point(Bytes& bytes, double x, double y, double z) {
  const Eigen::Vector3d p(x, y, z);
  if (!p.allFinite()) bytes.bad("a coordinate is not a number");
  return p;
}

// ---- STL ---------------------------------------------------------------------------------------

Soup parse_binary_stl(std::string_view data) {
  Bytes bytes(data);
  bytes.skip(80);
  const auto count = bytes.get<std::uint32_t>();
  constexpr std::size_t kTriangleBytes = 50;
  if (bytes.left() / kTriangleBytes < count) {
    bytes.bad(fmt::format("{} triangles are announced, there is room for {}", count,
                          bytes.left() / kTriangleBytes));
  }
  Soup soup;
  for (std::uint32_t t = 0; t < count; ++t) {
    bytes.skip(12);  // the normal follows from the corners
    const int first = static_cast<int>(soup.vertices.size());
    for (int k = 0; k < 3; ++k) {
      const float x = bytes.get<float>(), y = bytes.get<float>(), z = bytes.get<float>();
      soup.vertices.push_back(finite_point(bytes, static_cast<double>(x), static_cast<double>(y),
                                           static_cast<double>(z)));
    }
    bytes.skip(2);
    soup.triangles.emplace_back(first, first + 1, first + 2);
  }
  return soup;
}

Soup parse_text_stl(std::string_view text) {
  Lines lines(text);
  std::string_view line;
  Soup soup;
  std::vector<int> polygon;
  while (lines.next(line)) {
    Words words(line);
    const std::string_view what = words.next();
    if (what == "outer") {
      polygon.clear();
    } else if (what == "vertex") {
      polygon.push_back(static_cast<int>(soup.vertices.size()));
      soup.vertices.push_back(point(lines, words));
    } else if (what == "endloop") {
      if (polygon.size() < 3) lines.bad("a facet needs three vertices");
      soup.add_fan(polygon);
    }
  }
  return soup;
}

Soup parse_stl(std::string_view data) {
  // Some binary files begin with "solid" too, so the size decides where it can.
  if (data.size() >= 84) {
    std::uint32_t count;
    std::memcpy(&count, data.data() + 80, sizeof count);
    if (data.size() == 84 + std::size_t{50} * count) return parse_binary_stl(data);
  }
  return data.substr(0, 5) == "solid" ? parse_text_stl(data) : parse_binary_stl(data);
}

// ---- PLY ---------------------------------------------------------------------------------------

enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

PlyType ply_type(Lines& lines, std::string_view word) {
  constexpr std::array<std::pair<std::string_view, PlyType>, 16> kNames{{
      {"char", PlyType::kInt8},
      {"int8", PlyType::kInt8},
      {"uchar", PlyType::kUint8},
      {"uint8", PlyType::kUint8},
      {"short", PlyType::kInt16},
      {"int16", PlyType::kInt16},
      {"ushort", PlyType::kUint16},
      {"uint16", PlyType::kUint16},
      {"int", PlyType::kInt32},
      {"int32", PlyType::kInt32},
      {"uint", PlyType::kUint32},
      {"uint32", PlyType::kUint32},
      {"float", PlyType::kFloat},
      {"float32", PlyType::kFloat},
      {"double", PlyType::kDouble},
      {"float64", PlyType::kDouble},
  }};
  for (const auto& [name, type] : kNames) {
    if (name == word) return type;
  }
  lines.bad(fmt::format("'{}' is not a type of PLY", word.substr(0, 40)));
}

struct PlyProperty {
  std::string name;
  PlyType type{};
  std::optional<PlyType> length_type;  // set for a list
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;
};

enum class PlyCoding { kText, kLittle, kBig };

struct PlyHeader {
  PlyCoding coding = PlyCoding::kText;
  std::vector<PlyElement> elements;
  std::size_t lines = 0;
};

PlyHeader parse_ply_header(Lines& lines) {
  std::string_view line;
  if (!lines.next(line) || Words(line).next() != "ply") lines.bad("a PLY file begins with 'ply'");
  PlyHeader header;
  while (lines.next(line)) {
    Words words(line);
    const std::string_view what = words.next();
    if (what == "end_header") return header;
    if (what == "format") {
      const std::string_view coding = words.next();
      if (coding == "ascii") {
        header.coding = PlyCoding::kText;
      } else if (coding == "binary_little_endian") {
        header.coding = PlyCoding::kLittle;
      } else if (coding == "binary_big_endian") {
        header.coding = PlyCoding::kBig;
      } else {
        lines.bad(fmt::format("'{}' is not a format of PLY", coding.substr(0, 40)));
      }
    } else if (what == "element") {
      PlyElement element;
      element.name = words.next();
      element.count = count_of(lines, words.next(), "elements");
      header.elements.push_back(std::move(element));
    } else if (what == "property") {
      if (header.elements.empty()) lines.bad("a property before the first element");
      PlyProperty property;
      const std::string_view type = words.next();
      if (type == "list") {
        property.length_type = ply_type(lines, words.next());
        property.type = ply_type(lines, words.next());
      } else {
        property.type = ply_type(lines, type);
      }
      property.name = words.next();
      header.elements.back().properties.push_back(std::move(property));
    }  // comments, obj_info: skipped
  }
  lines.bad("the header has no end");
}

// Reads one number after another, from text or from bytes.
class PlyValues {
 public:
  PlyValues(PlyCoding coding, Lines& lines)
      : coding_(coding), lines_(lines), bytes_(lines.rest()), words_("") {}

  void next_row() {
    if (coding_ != PlyCoding::kText) return;
    std::string_view line;
    do {
      if (!lines_.next(line)) lines_.bad("the file ends before its last element");
    } while (Words(line).next().empty());
    words_ = Words(line);
  }

  double get(PlyType type) {
    if (coding_ == PlyCoding::kText) {
      const std::string_view word = words_.next();
      const auto value = as_number<double>(word);
      if (!value) lines_.bad(fmt::format("'{}' is not a number", word.substr(0, 40)));
      return *value;
    }
    const bool swap = coding_ == PlyCoding::kBig;
    switch (type) {
      case PlyType::kInt8:
        return bytes_.get<std::int8_t>();
      case PlyType::kUint8:
        return bytes_.get<std::uint8_t>();
      case PlyType::kInt16:
        return bytes_.get<std::int16_t>(swap);
      case PlyType::kUint16:
        return bytes_.get<std::uint16_t>(swap);
      case PlyType::kInt32:
        return bytes_.get<std::int32_t>(swap);
      case PlyType::kUint32:
        return bytes_.get<std::uint32_t>(swap);
      case PlyType::kFloat:
        return static_cast<double>(bytes_.get<float>(swap));
      case PlyType::kDouble:
        return bytes_.get<double>(swap);
    }
    return 0.0;
  }

  // Length of a list; cannot exceed what is left of the file.
  std::size_t get_length(PlyType type) {
    const double value = get(type);
    const double limit = static_cast<double>(bytes_.left());
    if (!(value >= 0.0) || value > limit) bad("a list has an impossible length");
    return static_cast<std::size_t>(value);
  }

  [[noreturn]] void bad(const std::string& what) {
    if (coding_ == PlyCoding::kText) lines_.bad(what);
    throw Bad{fmt::format("byte {} of the data", bytes_.at()), what};
  }

 private:
  PlyCoding coding_;
  Lines& lines_;
  Bytes bytes_;
  Words words_;
};

Soup parse_ply(std::string_view text) {
  Lines lines(text);
  const PlyHeader header = parse_ply_header(lines);
  PlyValues values(header.coding, lines);
  Soup soup;
  std::size_t vertex_count = 0;
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex") vertex_count = element.count;
  }
  std::vector<int> polygon;
  for (const PlyElement& element : header.elements) {
    if (element.properties.empty()) continue;
    for (std::size_t i = 0; i < element.count; ++i) {
      values.next_row();
      Eigen::Vector3d x(NAN, NAN, NAN);
      for (const PlyProperty& property : element.properties) {
        const bool is_face = element.name == "face" && property.length_type &&
                             (property.name == "vertex_indices" || property.name == "vertex_index");
        if (property.length_type) {
          const std::size_t length = values.get_length(*property.length_type);
          polygon.clear();
          for (std::size_t k = 0; k < length; ++k) {
            const double value = values.get(property.type);
            if (!is_face) continue;
            if (!(value >= 0.0) || value >= static_cast<double>(vertex_count)) {
              values.bad(fmt::format("{} is not one of the {} vertices", value, vertex_count));
            }
            polygon.push_back(static_cast<int>(value));
          }
          if (is_face && polygon.size() < 3) values.bad("a face needs at least three corners");
          if (is_face) soup.add_fan(polygon);
        } else {
          const double value = values.get(property.type);
          if (property.name == "x") x[0] = value;
          if (property.name == "y") x[1] = value;
          if (property.name == "z") x[2] = value;
        }
      }
      if (element.name == "vertex") {
        if (!x.allFinite()) values.bad("a vertex without finite x, y and z");
        soup.vertices.push_back(x);
      }
    }
  }
  return soup;
}

// ---- 3DS ---------------------------------------------------------------------------------------

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

Soup parse_3ds(std::string_view data) {
  if (data.size() < 6 || static_cast<unsigned char>(data[0]) != 0x4D ||
      static_cast<unsigned char>(data[1]) != 0x4D) {
    throw Bad{"byte 0", "not a 3DS file"};
  }
  Soup soup;
  parse_3ds_chunks(data, 0, soup, 0);
  return soup;
}

}  // namespace

Result<SurfaceMesh> parse_surface(std::string_view bytes, std::string_view extension,
                                  std::string_view name) {
  std::string kind(extension);
  std::transform(kind.begin(), kind.end(), kind.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  try {
    Soup soup;
    if (kind == ".stl") {
      soup = parse_stl(bytes);
    } else if (kind == ".ply") {
      soup = parse_ply(bytes);
    } else if (kind == ".obj") {
      soup = parse_obj(bytes);
    } else if (kind == ".3ds") {
      soup = parse_3ds(bytes);
    } else if (kind == ".off") {
      soup = parse_off(bytes);
    } else {
      return Problem{fmt::format(
          "{}: surfaces are read from .stl, .ply, .obj, .3ds or .off, not '{}'", name, extension)};
    }
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
    return merge_equal_vertices(surface);
  } catch (const Bad& bad) {
    return Problem{fmt::format("{}: {}: {}", name, bad.where, bad.what)};
  } catch (const std::bad_alloc&) {
    return Problem{fmt::format("{}: needs more memory than there is", name)};
  }
}

Result<SurfaceMesh> read_surface_file(const std::filesystem::path& path) {
  std::error_code code;
  if (!std::filesystem::is_regular_file(path, code)) {
    return Problem{fmt::format("{}: no such file", path.string())};
  }
  std::ifstream file(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (!file) return Problem{fmt::format("{}: cannot be read", path.string())};
  return parse_surface(bytes, path.extension().string(), path.string());
}

void write_ply(const std::filesystem::path& path, const SurfaceMesh& surface) {
  std::ofstream file(path, std::ios::binary);
  file << "ply\nformat binary_little_endian 1.0\nelement vertex " << surface.vertex_count()
       << "\nproperty double x\nproperty double y\nproperty double z\nelement face "
       << surface.triangle_count() << "\nproperty list uchar int vertex_indices\nend_header\n";
  file.write(reinterpret_cast<const char*>(surface.vertices.data()),
             static_cast<std::streamsize>(sizeof(double)) * surface.vertices.size());
  for (int t = 0; t < surface.triangle_count(); ++t) {
    file.put(3);
    file.write(reinterpret_cast<const char*>(surface.triangles.col(t).data()), 3 * sizeof(int));
  }
  file.close();
  if (!file) throw Error(fmt::format("{}: cannot be written", path.string()));
}

void write_colored_ply(const std::filesystem::path& path, const SurfaceMesh& surface,
                       std::span<const Rgb> colors, std::string_view comment) {
  PALPABLE_EXPECT(std::ssize(colors) == surface.vertex_count(), "a colour for each vertex");
  std::ofstream file(path, std::ios::binary);
  file << fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment {}\n"
      "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face {}\n"
      "property list uchar int vertex_indices\nend_header\n",
      comment, surface.vertex_count(), surface.triangle_count());
  for (int i = 0; i < surface.vertex_count(); ++i) {
    const Eigen::Vector3f p = surface.vertices.col(i).cast<float>();
    file.write(reinterpret_cast<const char*>(p.data()), 12);
    const Rgb c = colors[i];
    const char rgb[3] = {static_cast<char>(c.r), static_cast<char>(c.g), static_cast<char>(c.b)};
    file.write(rgb, 3);
  }
  for (int i = 0; i < surface.triangle_count(); ++i) {
    const Eigen::Vector3i t = surface.triangles.col(i);
    file.put(3);
    file.write(reinterpret_cast<const char*>(t.data()), 12);
  }
  file.close();
  if (!file) throw Error(fmt::format("{}: cannot be written", path.string()));
}

}  // namespace palpable

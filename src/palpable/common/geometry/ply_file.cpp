#include "palpable/common/base/plain_text.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/geometry/surface_files.h"

#include <cmath>
#include <cstdint>
#include <utility>

namespace palpable::surface_files {

namespace {

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

constexpr std::string_view kEndHeader = "end_header";

enum class PlyCoding { kText, kLittle, kBig };

struct PlyHeader {
  PlyCoding coding = PlyCoding::kText;
  std::vector<PlyElement> elements;
};

// The number of elements that a line of the header announces. @throws Bad for no whole number
std::size_t announced_count(const Lines& lines, std::string_view word) {
  const auto count = to_whole_number(word);
  if (!count || *count < 0) {
    lines.bad(fmt::format("'{}' is not a possible number of elements", word.substr(0, 40)));
  }
  return static_cast<std::size_t>(*count);
}

PlyHeader parse_ply_header(Lines& lines) {
  std::string_view line;
  if (!lines.next(line) || Words(line).next() != "ply") lines.bad("a PLY file begins with 'ply'");
  PlyHeader header;
  while (lines.next(line)) {
    Words words(line);
    const std::string_view what = words.next();
    if (what == kEndHeader) return header;
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
      element.count = announced_count(lines, words.next());
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

std::size_t ply_type_size(PlyType type) {
  switch (type) {
    case PlyType::kInt8:
    case PlyType::kUint8:
      return 1;
    case PlyType::kInt16:
    case PlyType::kUint16:
      return 2;
    case PlyType::kInt32:
    case PlyType::kUint32:
    case PlyType::kFloat:
      return 4;
    case PlyType::kDouble:
      return 8;
  }
  return 1;
}

// Fewest bytes of an element: a list may be empty, a number of a text has a digit and a separator.
std::size_t shortest_row(const PlyElement& element, PlyCoding coding) {
  std::size_t bytes = 0;
  for (const PlyProperty& property : element.properties) {
    const std::size_t size = ply_type_size(property.length_type.value_or(property.type));
    bytes += coding == PlyCoding::kText ? 2 : size;
  }
  return bytes;
}

// Why elements that the header announces cannot be in `room` bytes; empty: they can be.
std::string why_no_room(const PlyHeader& header, std::size_t room) {
  for (const PlyElement& element : header.elements) {
    const std::size_t row = shortest_row(element, header.coding);
    if (row == 0) continue;
    // The last line of a text may lack its end.
    const std::size_t fits = (room + 1) / row;
    if (element.count > fits) {
      return fmt::format("{} of the element '{}' are announced, there is room for {}",
                         element.count, element.name.substr(0, 40), fits);
    }
    room -= std::min(room, element.count * row);
  }
  return {};
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
      const auto value = to_any_number(word);
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

// Whether a line of the header, however lines end, says that the numbers are text.
bool is_text_ply(std::string_view text) {
  const std::string_view header = text.substr(0, text.find(kEndHeader));
  return header.find("\nformat ascii") != std::string_view::npos ||
         header.find("\rformat ascii") != std::string_view::npos;
}

}  // namespace

std::string why_no_ply(std::string_view first, std::size_t size) {
  try {
    std::string_view text = without_mark(first);
    std::string kept;
    const std::string_view header_text = text.substr(0, text.find(kEndHeader));
    // Line ends are unified in the header only: behind it, a text may be cut within a letter.
    if (is_text_ply(text))
      text = plain(text.substr(0, header_text.size() + kEndHeader.size() + 2), kept);
    Lines lines(text);
    const PlyHeader header = parse_ply_header(lines);
    return why_no_room(header, size - header_text.size());
  } catch (const Bad& bad) { return fmt::format("{}: {}", bad.where, bad.what); }
}

Soup parse_ply(std::string_view bytes, std::string_view property_wanted) {
  std::string kept;
  std::string_view text = without_mark(bytes);
  if (is_text_ply(text)) text = plain(bytes, kept);
  Lines lines(text);
  const PlyHeader header = parse_ply_header(lines);
  if (const std::string why = why_no_room(header, lines.rest().size()); !why.empty()) {
    lines.bad(why);
  }
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
          const bool wanted = !property_wanted.empty() && property.name == property_wanted;
          if (wanted && element.name == "vertex") {
            if (!std::isfinite(value)) values.bad(property.name + " is not finite");
            soup.values.push_back(value);
          }
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

}  // namespace palpable::surface_files

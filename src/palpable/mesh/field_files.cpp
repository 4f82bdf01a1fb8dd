#include "palpable/mesh/field_files.h"

#include "palpable/base/error.h"
#include "palpable/base/npy_file.h"
#include "palpable/reduced/hdf5_tools.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <pugixml.hpp>
#include <sstream>
#include <string_view>
#include <utility>
#include <zlib.h>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

static_assert(std::endian::native == std::endian::little, "files say which end comes first");

// Far above any mesh, and far below what would not fit into memory.
constexpr std::int64_t kMostNumbers = 500'000'000;

[[noreturn]] void bad(const std::string& name, const std::string& what) {
  throw Error(fmt::format("{}: {}", name, what));
}

// ---- numbers as bytes ------------------------------------------------------------------------

template <class T>
std::vector<double> converted(std::string_view bytes, bool swap) {
  std::vector<double> values(bytes.size() / sizeof(T));
  for (std::size_t i = 0; i < values.size(); ++i) {
    char raw[sizeof(T)];
    std::memcpy(raw, bytes.data() + i * sizeof(T), sizeof(T));
    if (swap) std::reverse(raw, raw + sizeof(T));
    T value;
    std::memcpy(&value, raw, sizeof(T));
    values[i] = static_cast<double>(value);
  }
  return values;
}

using Convert = std::vector<double> (*)(std::string_view, bool);
struct NumberType {
  std::size_t size;
  Convert convert;
};

// By the names of VTK's XML files.
std::optional<NumberType> number_type(std::string_view name) {
  static const std::map<std::string_view, NumberType> types{
      {"Float64", {8, converted<double>}},       {"Float32", {4, converted<float>}},
      {"Int64", {8, converted<std::int64_t>}},   {"Int32", {4, converted<std::int32_t>}},
      {"UInt64", {8, converted<std::uint64_t>}}, {"UInt32", {4, converted<std::uint32_t>}},
      {"Int16", {2, converted<std::int16_t>}},   {"UInt16", {2, converted<std::uint16_t>}},
      {"Int8", {1, converted<std::int8_t>}},     {"UInt8", {1, converted<std::uint8_t>}}};
  const auto at = types.find(name);
  return at == types.end() ? std::nullopt : std::optional(at->second);
}

std::optional<double> number_of(std::string_view word) {
  double value = 0;
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

MatrixXd as_columns(const std::vector<double>& values, Index components) {
  return Eigen::Map<const MatrixXd>(values.data(), components,
                                    static_cast<Index>(values.size()) / components);
}

// ---- .vtu ------------------------------------------------------------------------------------

std::string base64(std::string_view text, const std::string& name) {
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    int value = -1;
    if (c >= 'A' && c <= 'Z') value = c - 'A';
    if (c >= 'a' && c <= 'z') value = c - 'a' + 26;
    if (c >= '0' && c <= '9') value = c - '0' + 52;
    if (c == '+') value = 62;
    if (c == '/') value = 63;
    if (c == '=') break;
    if (value < 0) bad(name, "its base64 text holds other characters");
    bits = (bits << 6) | static_cast<std::uint32_t>(value);
    if (++count % 4 == 0) {
      for (int k = 2; k >= 0; --k) bytes += static_cast<char>((bits >> (8 * k)) & 0xff);
      bits = 0;
    }
  }
  if (count % 4 == 2) bytes += static_cast<char>((bits >> 4) & 0xff);
  if (count % 4 == 3) {
    bytes += static_cast<char>((bits >> 10) & 0xff);
    bytes += static_cast<char>((bits >> 2) & 0xff);
  }
  return bytes;
}

class VtuReader {
 public:
  VtuReader(const std::string& bytes, const std::string& name) : name_(name) {
    // Appended raw bytes are no XML: they are cut out before it is parsed.
    std::string xml = bytes;
    const std::size_t tag = bytes.find("<AppendedData");
    if (tag != std::string::npos) {
      const std::size_t open = bytes.find('>', tag), mark = bytes.find('_', open);
      const std::size_t close = bytes.rfind("</AppendedData");
      if (open == std::string::npos || mark == std::string::npos || close == std::string::npos ||
          close < mark) {
        bad(name, "its appended data is cut short");
      }
      appended_ = std::string_view(bytes).substr(mark + 1, close - mark - 1);
      appended_is_base64_ = bytes.substr(tag, open - tag).find("base64") != std::string::npos;
      xml = bytes.substr(0, open + 1) + bytes.substr(close);
    }
    const pugi::xml_parse_result parsed = document_.load_buffer(xml.data(), xml.size());
    if (!parsed) {
      const auto line = std::count(xml.begin(), xml.begin() + parsed.offset, '\n') + 1;
      bad(name, fmt::format("line {}: not XML: {}", line, parsed.description()));
    }
    const pugi::xml_node root = document_.child("VTKFile");
    if (std::string_view(root.attribute("type").value()) != "UnstructuredGrid") {
      bad(name, "not an UnstructuredGrid of VTK");
    }
    swap_ = std::string_view(root.attribute("byte_order").value()) == "BigEndian";
    header_ = number_type(root.attribute("header_type").as_string("UInt32")).value_or(NumberType{});
    if (header_.size != 4 && header_.size != 8) bad(name, "its header_type is unknown");
    compressed_ = !root.attribute("compressor").empty();
    const std::string compressor = root.attribute("compressor").value();
    if (compressed_ && compressor != "vtkZLibDataCompressor") {
      bad(name, fmt::format("is compressed by {}: save it with zlib, or without", compressor));
    }
    grid_ = root.child("UnstructuredGrid");
    piece_ = grid_.child("Piece");
    if (!piece_) bad(name, "has no Piece");
    if (piece_.next_sibling("Piece")) bad(name, "has several pieces: save it as one");
  }

  NodalFile read() {
    NodalFile file;
    const auto count = piece_.attribute("NumberOfPoints").as_llong();
    if (count < 1 || count > kMostNumbers) bad(name_, "has no points");
    const MatrixXd points = array(piece_.child("Points").child("DataArray"));
    if (points.rows() != 3 || points.cols() != count) bad(name_, "its points are not complete");
    file.points = points;
    for (const pugi::xml_node node : piece_.child("PointData").children("DataArray")) {
      if (!number_type(node.attribute("type").value())) continue;  // texts
      MatrixXd values = array(node);
      if (values.cols() != count) {
        bad(name_, fmt::format("'{}' does not have a value for each of its {} points",
                               node.attribute("Name").value(), count));
      }
      file.fields.push_back({node.attribute("Name").value(), std::move(values)});
    }
    read_cells(file);
    return file;
  }

 private:
  void read_cells(NodalFile& file) {
    std::map<std::string, std::vector<double>> cells;
    for (const pugi::xml_node node : piece_.child("Cells").children("DataArray")) {
      const MatrixXd values = array(node);
      cells[node.attribute("Name").value()].assign(values.data(), values.data() + values.size());
    }
    const std::vector<double>& nodes = cells["connectivity"];
    const std::vector<double>& ends = cells["offsets"];
    const std::vector<double>& types = cells["types"];
    if (ends.size() != types.size()) bad(name_, "its cells are not complete");
    double begin = 0;
    for (std::size_t c = 0; c < ends.size(); ++c) {
      const int type = static_cast<int>(types[c]);
      const auto size = static_cast<std::size_t>(ends[c] - begin);
      if (!(ends[c] >= begin) || ends[c] > static_cast<double>(nodes.size())) {
        bad(name_, "its cells are not complete");
      }
      if (type == 10 || type == 24) {
        if (size != (type == 10 ? 4u : 10u)) bad(name_, "a tetrahedron has the wrong nodes");
        std::vector<std::int64_t> tet;
        for (std::size_t k = 0; k < size; ++k) {
          const double node = nodes[static_cast<std::size_t>(begin) + k];
          if (!(node >= 0) || node >= static_cast<double>(file.points.cols())) {
            bad(name_, fmt::format("cell {} has a node that does not exist", c));
          }
          tet.push_back(static_cast<std::int64_t>(node));
        }
        file.tets.push_back(std::move(tet));
      } else if (type >= 11 && type != 21 && type != 22) {
        bad(name_, fmt::format("cell {} is of VTK's type {}: only tetrahedra (10 and 24) make a "
                               "body here; mesh it with those",
                               c, type));
      }
      begin = ends[c];
    }
  }

  // (components x count)
  MatrixXd array(const pugi::xml_node& node) {
    if (!node) bad(name_, "an array is missing");
    const std::string title = node.attribute("Name").value();
    const std::optional<NumberType> type = number_type(node.attribute("type").value());
    if (!type) bad(name_, fmt::format("'{}' is of an unknown type", title));
    const std::string_view format = node.attribute("format").as_string("ascii");
    std::vector<double> values;
    if (format == "ascii") {
      std::istringstream words(node.child_value());
      for (std::string word; words >> word;) {
        const std::optional<double> value = number_of(word);
        if (!value) bad(name_, fmt::format("'{}' in '{}' is not a number", word, title));
        values.push_back(*value);
      }
    } else {
      values = type->convert(payload(node, format, title), swap_);
    }
    const Index components = std::max(1, node.attribute("NumberOfComponents").as_int(1));
    if (static_cast<Index>(values.size()) % components != 0) {
      bad(name_, fmt::format("'{}' is not complete", title));
    }
    return as_columns(values, components);
  }

  std::string payload(const pugi::xml_node& node, std::string_view format,
                      const std::string& title) {
    std::string_view source;
    std::string text;
    bool encoded = true;
    if (format == "binary") {
      for (const char c : std::string_view(node.child_value())) {
        if (std::strchr(" \t\r\n", c) == nullptr) text += c;
      }
      source = text;
    } else {
      const auto offset = node.attribute("offset").as_ullong();
      if (offset > appended_.size()) bad(name_, fmt::format("'{}' lies behind the end", title));
      source = appended_.substr(offset);
      encoded = appended_is_base64_;
    }
    // The header and the data are encoded one after the other.
    const auto decode = [&](std::size_t begin, std::size_t bytes) {
      const std::size_t letters = encoded ? (bytes + 2) / 3 * 4 : bytes;
      if (begin > source.size() || letters > source.size() - begin) {
        bad(name_, fmt::format("'{}' is cut short", title));
      }
      std::string part = encoded ? base64(source.substr(begin, letters), name_)
                                 : std::string(source.substr(begin, letters));
      if (part.size() < bytes) bad(name_, fmt::format("'{}' is cut short", title));
      part.resize(bytes);
      return std::pair(std::move(part), begin + letters);
    };
    const auto head = [&](std::size_t begin, std::size_t numbers) {
      auto [bytes, end] = decode(begin, numbers * header_.size);
      return std::pair(header_.convert(bytes, swap_), end);
    };
    const auto checked = [&](double size) {
      if (!(size >= 0) || size > 8.0 * static_cast<double>(kMostNumbers)) {
        bad(name_, fmt::format("'{}' claims {} bytes", title, size));
      }
      return static_cast<std::size_t>(size);
    };
    if (!compressed_) {
      const std::size_t size = checked(head(0, 1).first[0]);
      // Encoded, header and data are one text.
      auto bytes = decode(0, header_.size + size).first;
      return bytes.substr(header_.size);
    }
    const std::vector<double> first = head(0, 3).first;
    const std::size_t blocks = checked(first[0]);
    if (blocks == 0) return {};
    const auto [sizes, data] = head(0, 3 + blocks);
    std::size_t total = 0;
    for (std::size_t b = 0; b < blocks; ++b) total += checked(sizes[3 + b]);
    const std::string packed = decode(data, total).first;
    std::string whole;
    std::size_t at = 0;
    for (std::size_t b = 0; b < blocks; ++b) {
      const std::size_t size = checked(b + 1 == blocks && first[2] > 0 ? first[2] : first[1]);
      std::string block(size, '\0');
      uLongf made = size;
      const auto length = static_cast<std::size_t>(sizes[3 + b]);
      if (::uncompress(reinterpret_cast<Bytef*>(block.data()), &made,
                       reinterpret_cast<const Bytef*>(packed.data() + at), length) != Z_OK ||
          made != size) {
        bad(name_, fmt::format("'{}' is damaged: zlib refuses it", title));
      }
      whole += block;
      at += length;
    }
    return whole;
  }

  const std::string& name_;
  pugi::xml_document document_;
  pugi::xml_node grid_, piece_;
  std::string_view appended_;
  bool appended_is_base64_ = false, swap_ = false, compressed_ = false;
  NumberType header_{};
};

// ---- legacy .vtk -----------------------------------------------------------------------------

class VtkReader {
 public:
  VtkReader(const std::string& bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  NodalFile read() {
    if (!line().starts_with("# vtk DataFile")) bad(name_, "not a legacy file of VTK");
    (void)line();  // a title
    const std::string kind = word();
    if (kind != "ASCII" && kind != "BINARY") complain("neither ASCII nor BINARY");
    binary_ = kind == "BINARY";
    if (word() != "DATASET" || word() != "UNSTRUCTURED_GRID") {
      complain("not a DATASET UNSTRUCTURED_GRID");
    }
    while (true) {
      const std::string key = word();
      if (key.empty()) break;
      read_section(key);
    }
    if (file_.points.cols() == 0) complain("has no POINTS");
    return std::move(file_);
  }

 private:
  void read_section(const std::string& key) {
    if (key == "POINTS") {
      const std::int64_t count = whole();
      const std::vector<double> values = numbers(3 * count, word());
      file_.points = as_columns(values, 3);
    } else if (key == "CELLS") {
      const std::int64_t count = whole(), size = whole();
      if (peek() == "OFFSETS") complain("CELLS of version 5.1: save it as version 4.2 or as .vtu");
      cells_ = numbers(size, "int");
      (void)count;
    } else if (key == "CELL_TYPES") {
      read_types(numbers(whole(), "int"));
    } else if (key == "POINT_DATA") {
      at_points_ = true;
      count_ = whole();
      if (count_ != file_.points.cols())
        complain("POINT_DATA does not have a value for each point");
    } else if (key == "CELL_DATA") {
      at_points_ = false;
      count_ = whole();
    } else if (key == "METADATA") {
      while (!line().empty()) {}
    } else {
      read_attribute(key);
    }
  }

  void read_attribute(const std::string& key) {
    if (key == "FIELD") {
      (void)word();
      const std::int64_t arrays = whole();
      for (std::int64_t a = 0; a < arrays; ++a) {
        const std::string title = word();
        const std::int64_t components = whole(), tuples = whole();
        add(title, components, numbers(components * tuples, word()), tuples);
      }
      return;
    }
    const std::string title = word();
    if (key == "VECTORS" || key == "NORMALS") {
      add(title, 3, numbers(3 * count_, word()), count_);
    } else if (key == "TENSORS") {
      add(title, 9, numbers(9 * count_, word()), count_);
    } else if (key == "TENSORS6") {
      add(title, 6, numbers(6 * count_, word()), count_);
    } else if (key == "SCALARS") {
      const std::string type = word();
      const std::int64_t components = peek() == "LOOKUP_TABLE" ? 1 : whole();
      if (word() != "LOOKUP_TABLE") complain("SCALARS without LOOKUP_TABLE");
      (void)word();
      add(title, components, numbers(components * count_, type), count_);
    } else {
      complain(fmt::format("'{}' is not understood here", key));
    }
  }

  void add(const std::string& title, std::int64_t components, const std::vector<double>& values,
           std::int64_t tuples) {
    if (!at_points_ || tuples != file_.points.cols() || components < 1) return;
    file_.fields.push_back({title, as_columns(values, static_cast<Index>(components))});
  }

  void read_types(const std::vector<double>& types) {
    std::size_t at = 0;
    for (std::size_t c = 0; c < types.size(); ++c) {
      if (at >= cells_.size()) complain("CELLS are not complete");
      const auto size = static_cast<std::size_t>(cells_[at++]);
      if (size > cells_.size() - at) complain("CELLS are not complete");
      const int type = static_cast<int>(types[c]);
      if ((type == 10 && size == 4) || (type == 24 && size == 10)) {
        std::vector<std::int64_t> tet;
        for (std::size_t k = 0; k < size; ++k) {
          const double node = cells_[at + k];
          if (!(node >= 0) || node >= static_cast<double>(file_.points.cols())) {
            complain(fmt::format("cell {} has a node that does not exist", c));
          }
          tet.push_back(static_cast<std::int64_t>(node));
        }
        file_.tets.push_back(std::move(tet));
      } else if (type >= 10 && type != 21 && type != 22) {
        complain(
            fmt::format("cell {} is of VTK's type {}: only tetrahedra (10 and 24) make a body "
                        "here; mesh it with those",
                        c, type));
      }
      at += size;
    }
  }

  [[noreturn]] void complain(const std::string& what) const {
    const auto line =
        std::count(bytes_.begin(),
                   bytes_.begin() + static_cast<std::ptrdiff_t>(std::min(at_, bytes_.size())),
                   '\n') +
        1;
    bad(name_, binary_ ? what : fmt::format("line {}: {}", line, what));
  }

  std::string line() {
    const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
    std::string text = bytes_.substr(at_, end - at_);
    at_ = std::min(end + 1, bytes_.size());
    if (!text.empty() && text.back() == '\r') text.pop_back();
    return text;
  }
  std::string word() {
    at_ = std::min(bytes_.find_first_not_of(" \t\r\n", at_), bytes_.size());
    const std::size_t end = std::min(bytes_.find_first_of(" \t\r\n", at_), bytes_.size());
    std::string text = bytes_.substr(at_, end - at_);
    at_ = end;
    return text;
  }
  std::string peek() {
    const std::size_t before = at_;
    std::string text = word();
    at_ = before;
    return text;
  }
  std::int64_t whole() {
    const std::string text = word();
    const std::optional<double> value = number_of(text);
    if (!value || *value < 0 || *value > static_cast<double>(kMostNumbers)) {
      complain(fmt::format("'{}' where a count is needed", text));
    }
    return static_cast<std::int64_t>(*value);
  }
  std::vector<double> numbers(std::int64_t count, const std::string& type) {
    if (count > kMostNumbers) complain("claims too many numbers");
    if (!binary_) {
      std::vector<double> values;
      for (std::int64_t i = 0; i < count; ++i) {
        const std::string text = word();
        const std::optional<double> value = number_of(text);
        if (!value) complain(fmt::format("'{}' where a number is needed", text));
        values.push_back(*value);
      }
      return values;
    }
    static const std::map<std::string, std::string> names{{"double", "Float64"},
                                                          {"float", "Float32"},
                                                          {"int", "Int32"},
                                                          {"long", "Int64"},
                                                          {"vtktypeint64", "Int64"},
                                                          {"vtkIdType", "Int64"},
                                                          {"unsigned_char", "UInt8"},
                                                          {"char", "Int8"},
                                                          {"unsigned_int", "UInt32"},
                                                          {"short", "Int16"},
                                                          {"unsigned_short", "UInt16"},
                                                          {"unsigned_long", "UInt64"}};
    const auto known = names.find(type);
    if (known == names.end()) complain(fmt::format("numbers of type '{}' are not known", type));
    const NumberType number = *number_type(known->second);
    at_ = std::min(bytes_.find('\n', at_), bytes_.size());
    if (at_ < bytes_.size()) ++at_;
    const std::size_t size = static_cast<std::size_t>(count) * number.size;
    if (size > bytes_.size() - at_) complain("is cut short");
    std::vector<double> values =
        number.convert(std::string_view(bytes_).substr(at_, size), true);  // the big end first
    at_ += size;
    return values;
  }

  const std::string& bytes_;
  const std::string& name_;
  std::size_t at_ = 0;
  bool binary_ = false, at_points_ = false;
  std::int64_t count_ = 0;
  std::vector<double> cells_;
  NodalFile file_;
};

// ---- texts by lines --------------------------------------------------------------------------

struct Line {
  std::size_t number;
  std::string_view text;
};

std::vector<Line> lines_of(const std::string& bytes) {
  std::vector<Line> lines;
  std::size_t at = 0, number = 0;
  while (at < bytes.size()) {
    const std::size_t end = std::min(bytes.find('\n', at), bytes.size());
    std::string_view text = std::string_view(bytes).substr(at, end - at);
    if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
    lines.push_back({++number, text});
    at = end + 1;
  }
  return lines;
}

std::vector<std::string_view> words_of(std::string_view text, const char* separators) {
  std::vector<std::string_view> words;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t begin = text.find_first_not_of(separators, at);
    if (begin == std::string_view::npos) break;
    const std::size_t end = std::min(text.find_first_of(separators, begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    at = end;
  }
  return words;
}

std::string_view trimmed(std::string_view text) {
  const std::vector<std::string_view> words = words_of(text, " \t");
  return words.empty() ? std::string_view() : words.front();
}

}  // namespace

NodalFile parse_vtu(const std::string& bytes, const std::string& name) {
  return VtuReader(bytes, name).read();
}

NodalFile parse_vtk(const std::string& bytes, const std::string& name) {
  return VtkReader(bytes, name).read();
}

NodalFile parse_frd(const std::string& bytes, const std::string& name) {
  // Records by their first columns: "    2C" nodes follow, " -4" a result's name, " -1" a node of
  // it in (1X,"-1",I10,6E12.5), " -2" its continuation, " -3" the end of a block.
  NodalFile file;
  std::map<std::int64_t, std::size_t> row;
  std::vector<double> points;
  struct Block {
    std::map<std::int64_t, std::vector<double>> at;
    std::size_t components = 0;
    std::size_t line = 0;
  };
  std::map<std::string, Block> blocks;
  std::vector<std::string> order;
  enum { kNothing, kNodes, kResult } inside = kNothing;
  std::string result;
  for (const auto& [number, text] : lines_of(bytes)) {
    const auto complain = [&, n = number](const std::string& what) {
      bad(name, fmt::format("line {}: {}", n, what));
    };
    const std::string_view key = text.substr(0, std::min<std::size_t>(text.size(), 3));
    if (text.starts_with("    2C")) {
      inside = kNodes;
      continue;
    }
    if (key == " -3" || text.starts_with("    3C") || text.starts_with("  100C")) {
      inside = kNothing;
      continue;
    }
    if (key == " -4") {
      result = std::string(trimmed(text.substr(std::min<std::size_t>(text.size(), 3))));
      if (!blocks.contains(result)) order.push_back(result);
      blocks[result] = Block{{}, 0, number};  // a later step replaces an earlier one
      inside = kResult;
      continue;
    }
    if (key == " -5" && inside == kResult) {
      // Columns computed by readers (ALL, such as a vector's length) are not in the file.
      const std::vector<std::string_view> words = words_of(text, " \t");
      if (words.size() < 2 || words[1] != "ALL") ++blocks[result].components;
      continue;
    }
    if (inside == kNothing || (key != " -1" && key != " -2")) continue;
    const auto field = [&](std::size_t begin, std::size_t width) {
      return begin < text.size() ? trimmed(text.substr(begin, width)) : std::string_view();
    };
    std::int64_t node = 0;
    if (key == " -1") {
      const std::optional<double> label = number_of(field(3, 10));
      if (!label || *label < 1) complain("a node without its number (only ASCII .frd is read)");
      node = static_cast<std::int64_t>(*label);
    }
    std::vector<double> values;
    for (std::size_t at = 13; at < text.size(); at += 12) {
      const std::string_view word = field(at, 12);
      if (word.empty()) continue;
      const std::optional<double> value = number_of(word);
      if (!value) complain(fmt::format("'{}' is not a number", word));
      values.push_back(*value);
    }
    if (inside == kNodes) {
      if (values.size() != 3) complain("a node does not have three coordinates");
      if (!row.try_emplace(node, row.size()).second) complain("a node that was there already");
      file.numbers.push_back(node);
      points.insert(points.end(), values.begin(), values.end());
    } else if (key == " -1") {
      blocks[result].at[node] = std::move(values);
    } else if (!blocks[result].at.empty()) {
      complain("results of more than six components are not read");
    }
  }
  if (file.numbers.empty()) bad(name, "has no nodes: not an ASCII .frd file");
  file.points = as_columns(points, 3);
  for (const std::string& title : order) {
    const Block& block = blocks[title];
    const auto c = static_cast<Index>(block.components);
    if (c == 0) continue;
    MatrixXd values(c, static_cast<Index>(file.numbers.size()));
    for (std::size_t i = 0; i < file.numbers.size(); ++i) {
      const auto at = block.at.find(file.numbers[i]);
      if (at == block.at.end() || static_cast<Index>(at->second.size()) != c) {
        bad(name, fmt::format("line {}: '{}' does not have {} values for node {}", block.line,
                              title, c, file.numbers[i]));
      }
      values.col(static_cast<Index>(i)) = Eigen::Map<const Eigen::VectorXd>(at->second.data(), c);
    }
    file.fields.push_back({title, std::move(values)});
  }
  return file;
}

NodalFile parse_npy(const std::string& bytes, const std::string& name) {
  const NpyHeader header = npy_header(bytes, name);
  if (header.type != "<f8" && header.type != "<f4") {
    bad(name,
        fmt::format("holds numbers of type '{}': save it as float64 or float32", header.type));
  }
  if (header.column_by_column) {
    bad(name, "is stored column by column: save numpy.ascontiguousarray() of it");
  }
  const std::size_t dimensions = header.shape.size(), count = header.count();
  if (dimensions == 0 || dimensions > 2 || count == 0 ||
      count > static_cast<std::size_t>(kMostNumbers)) {
    bad(name, "must be an array of nodes x components");
  }
  const std::size_t there = bytes.size() - header.begin;
  if (there != count * header.number_size()) {
    bad(name, fmt::format("has {} bytes of numbers where its shape needs {}", there,
                          count * header.number_size()));
  }
  const Index components = dimensions == 2 ? static_cast<Index>(header.shape[1]) : 1;
  NodalFile file;
  file.fields.push_back({"", as_columns(npy_array(header, bytes, name).values, components)});
  return file;
}

NodalFile parse_table(const std::string& bytes, const std::string& name) {
  NodalFile file;
  std::vector<std::vector<double>> rows;
  std::vector<std::vector<std::string>> headers;
  for (const auto& [number, text] : lines_of(bytes)) {
    const std::vector<std::string_view> words = words_of(text, " \t,;");
    if (words.empty()) continue;
    std::vector<double> row;
    for (const std::string_view word : words) {
      const std::optional<double> value = number_of(word);
      if (!value) break;
      row.push_back(*value);
    }
    if (row.size() != words.size()) {
      // Words before the numbers may be their titles; after them, sums and remarks.
      if (rows.empty()) headers.emplace_back(words.begin(), words.end());
      if (!row.empty() && row.size() > 1 && !rows.empty() && row.size() + 1 == words.size()) {
        bad(name, fmt::format("line {}: '{}' is not a number", number, words[row.size()]));
      }
      continue;
    }
    if (row.size() < 2) { bad(name, fmt::format("line {}: a node without values", number)); }
    if (!rows.empty() && row.size() != rows[0].size()) {
      bad(name, fmt::format("line {}: {} columns where those before have {}", number, row.size(),
                            rows[0].size()));
    }
    if (!(row[0] >= 0) || row[0] != std::floor(row[0])) {
      bad(name, fmt::format("line {}: '{}' is not the number of a node", number, words[0]));
    }
    file.numbers.push_back(static_cast<std::int64_t>(row[0]));
    rows.push_back(std::move(row));
  }
  if (rows.empty()) bad(name, "has no line of a node's number and values");
  const std::size_t columns = rows[0].size() - 1;
  // "node,U1,U2" or "Node Label  U1  U2": the last words are the columns'.
  std::vector<std::string> titles;
  for (const std::vector<std::string>& words : headers) {
    const bool label = words.size() > 2 && words[0] == "Node" && words[1] == "Label";
    if (words.size() != columns + (label ? 2 : 1)) continue;
    titles.assign(words.end() - static_cast<std::ptrdiff_t>(columns), words.end());
  }
  for (std::size_t c = 0; c < columns; ++c) {
    MatrixXd values(1, static_cast<Index>(rows.size()));
    for (std::size_t i = 0; i < rows.size(); ++i) values(0, static_cast<Index>(i)) = rows[i][c + 1];
    file.fields.push_back({titles.empty() ? std::to_string(c + 1) : titles[c], std::move(values)});
  }
  return file;
}

namespace {

NodalFile read_hdf5(const std::filesystem::path& path, const std::string& dataset) {
  const std::string name = fmt::format("{}:{}", path.string(), dataset);
  const hdf5::Quiet quiet;
  try {
    const hdf5::Handle h5(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose,
                          "not an HDF5 file");
    const hdf5::Table<double> table = hdf5::read_table<double>(h5, dataset.c_str());
    NodalFile file;
    file.fields.push_back({"", as_columns(table.data, static_cast<Index>(table.columns))});
    return file;
  } catch (const hdf5::Trouble& trouble) { bad(name, trouble.what); }
}

}  // namespace

NodalFile read_nodal_file(const std::filesystem::path& path) {
  const std::string text = path.string();
  const std::size_t colon = text.rfind(':');
  if (colon != std::string::npos && colon > 0) {
    const std::filesystem::path file = text.substr(0, colon);
    if (!std::filesystem::exists(file)) bad(file.string(), "no such file");
    return read_hdf5(file, text.substr(colon + 1));
  }
  std::error_code code;
  if (!std::filesystem::is_regular_file(path, code)) bad(text, "no such file");
  const std::string ending = path.extension().string();
  if (ending == ".h5" || ending == ".hdf5") {
    bad(text, "name the dataset behind a colon: runs.h5:/u/level_3");
  }
  static const std::map<std::string, NodalFile (*)(const std::string&, const std::string&)> readers{
      {".vtu", parse_vtu},   {".vtk", parse_vtk},   {".frd", parse_frd},  {".npy", parse_npy},
      {".csv", parse_table}, {".rpt", parse_table}, {".txt", parse_table}};
  const auto reader = readers.find(ending);
  if (reader == readers.end()) {
    bad(text, fmt::format("'{}' is not known: .vtu, .vtk, .frd, .npy, .h5, .csv, .rpt and .txt are",
                          ending));
  }
  try {
    return reader->second(hdf5::all_bytes(path), text);
  } catch (const hdf5::Trouble& trouble) { bad(text, trouble.what); }
}

}  // namespace palpable

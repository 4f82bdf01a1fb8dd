#include "palpable/bake/mesh/field_files.h"
#include "palpable/bake/mesh/field_text.h"
#include "palpable/common/base/bounded_text.h"
#include "palpable/common/base/plain_text.h"
#include "palpable/common/base/text_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
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
using namespace field_text;

constexpr std::size_t kBestPacking = 1100;  // upper bound of zlib's compression ratio, 1032

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
    std::string kept;
    std::string_view xml = bytes;
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
      xml = kept = bytes.substr(0, open + 1) + bytes.substr(close);
    }
    if (const std::string why = why_no_text(xml, TextPart::kAll); !why.empty()) bad(name, why);
    if (const auto unparsable = why_not_parsed(xml, Notation::kXml)) {
      bad(name, fmt::format("line {}: {}", unparsable->line, unparsable->what));
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
    const std::string order = root.attribute("byte_order").as_string("LittleEndian");
    if (order != "LittleEndian" && order != "BigEndian") {
      bad(name, fmt::format("its byte_order is '{}', neither LittleEndian nor BigEndian", order));
    }
    swap_ = order == "BigEndian";
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
        const std::optional<double> value = to_any_number(word);
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

  // The unpacked bytes of an array, which may be in place or appended.
  std::string payload(const pugi::xml_node& node, std::string_view format,
                      const std::string& title) {
    std::string text;
    if (format == "binary") {
      for (const char c : std::string_view(node.child_value())) {
        if (std::strchr(" \t\r\n", c) == nullptr) text += c;
      }
      return unpacked({text, true, title});
    }
    const auto offset = node.attribute("offset").as_ullong();
    if (offset > appended_.size()) bad(name_, fmt::format("'{}' lies behind the end", title));
    return unpacked({appended_.substr(offset), appended_is_base64_, title});
  }

  // The text that an array's bytes are read from: base64 letters, or raw bytes.
  struct Source {
    std::string_view letters;
    bool encoded;
    const std::string& title;
  };

  // The bytes from letter `begin` on, and the index of the letter behind them. In packed data the
  // header and the data are encoded separately.
  std::pair<std::string, std::size_t> decode(const Source& source, std::size_t begin,
                                             std::size_t bytes) const {
    const std::size_t letters = source.encoded ? (bytes + 2) / 3 * 4 : bytes;
    if (begin > source.letters.size() || letters > source.letters.size() - begin) {
      bad(name_, fmt::format("'{}' is cut short", source.title));
    }
    const std::string_view mine = source.letters.substr(begin, letters);
    std::string part = source.encoded ? base64(mine, name_) : std::string(mine);
    if (part.size() < bytes) bad(name_, fmt::format("'{}' is cut short", source.title));
    part.resize(bytes);
    return {std::move(part), begin + letters};
  }

  // The first numbers of a header, and the index of the letter behind them.
  std::pair<std::vector<double>, std::size_t> header(const Source& source,
                                                     std::size_t numbers) const {
    auto [bytes, end] = decode(source, 0, numbers * header_.size);
    return {header_.convert(bytes, swap_), end};
  }

  std::size_t checked(double size, const Source& source) const {
    if (!(size >= 0) || size > 8.0 * static_cast<double>(kMostNumbers)) {
      bad(name_, fmt::format("'{}' claims {} bytes", source.title, size));
    }
    return static_cast<std::size_t>(size);
  }

  std::string unpacked(const Source& source) const {
    if (compressed_) return inflated(source);
    const auto [first, end] = header(source, 1);
    const std::size_t size = checked(first[0], source);
    // In base64, header and data are mostly one text; where the header was encoded apart, it ends
    // with the sign that fills up its last letters.
    const bool apart = source.encoded && size > 0 && source.letters[end - 1] == '=';
    if (apart) return decode(source, end, size).first;
    return decode(source, 0, header_.size + size).first.substr(header_.size);
  }

  // Header: number of blocks, size of each, size of a last one that is smaller, packed sizes.
  std::string inflated(const Source& source) const {
    const std::vector<double> first = header(source, 3).first;
    const std::size_t blocks = checked(first[0], source);
    if (blocks == 0) return {};
    const auto [sizes, data] = header(source, 3 + blocks);
    std::size_t total = 0;
    for (std::size_t b = 0; b < blocks; ++b) total += checked(sizes[3 + b], source);
    const std::string packed = decode(source, data, total).first;
    std::string whole;
    std::size_t at = 0;
    for (std::size_t b = 0; b < blocks; ++b) {
      const std::size_t size =
          checked(b + 1 == blocks && first[2] > 0 ? first[2] : first[1], source);
      const auto length = static_cast<std::size_t>(sizes[3 + b]);
      // A header may announce more than zlib can have packed: memory is taken only for the rest.
      if (size > kBestPacking * (length + 1)) {
        bad(name_, fmt::format("'{}' is damaged: a block of {} bytes announces {}", source.title,
                               length, size));
      }
      std::string block(size, '\0');
      uLongf made = size;
      if (::uncompress(reinterpret_cast<Bytef*>(block.data()), &made,
                       reinterpret_cast<const Bytef*>(packed.data() + at), length) != Z_OK ||
          made != size) {
        bad(name_, fmt::format("'{}' is damaged: zlib refuses it", source.title));
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

}  // namespace

NodalFile parse_vtu(const std::string& bytes, const std::string& name) {
  return VtuReader(bytes, name).read();
}

}  // namespace palpable

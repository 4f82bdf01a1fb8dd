#include "palpable/bake/mesh/field_files.h"
#include "palpable/bake/mesh/field_text.h"
#include "palpable/common/base/plain_text.h"
#include "palpable/common/base/text_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

namespace palpable {
namespace {

using Eigen::Index;
using namespace field_text;

// The legacy format, ASCII or binary.
class VtkReader {
 public:
  VtkReader(const std::string& bytes, const std::string& name)
      : bytes_(bytes), name_(name), at_(bytes.size() - without_mark(bytes).size()) {}

  NodalFile read() {
    if (!line().starts_with("# vtk DataFile")) bad(name_, "not a legacy file of VTK");
    (void)line();  // a title
    const std::string kind = word();
    if (kind != "ASCII" && kind != "BINARY") complain("neither ASCII nor BINARY");
    binary_ = kind == "BINARY";
    if (!binary_) {
      if (const std::string why = why_no_text(bytes_, TextPart::kAll); !why.empty()) {
        bad(name_, why);
      }
    }
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
      cells_ = peek() == "OFFSETS" ? cells_by_offsets(count, size) : numbers(size, "int");
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
      (void)line();  // the rest of this line
      while (!line().empty()) {}
    } else {
      read_attribute(key);
    }
  }

  // Cells of version 5.1, where each one begins in a list of all nodes, as those of the versions
  // before: the number of a cell's nodes, then these.
  std::vector<double> cells_by_offsets(std::int64_t offsets, std::int64_t nodes) {
    (void)word();
    const std::vector<double> begin = numbers(offsets, word());
    if (word() != "CONNECTIVITY") complain("OFFSETS without CONNECTIVITY");
    const std::vector<double> all = numbers(nodes, word());
    std::vector<double> cells;
    for (std::size_t c = 0; c + 1 < begin.size(); ++c) {
      const double first = begin[c], last = begin[c + 1];
      if (!(first >= 0 && last >= first && last <= static_cast<double>(all.size()))) {
        complain(fmt::format("the OFFSETS of cell {} are not within the CONNECTIVITY", c));
      }
      cells.push_back(
          static_cast<double>(static_cast<std::size_t>(last) - static_cast<std::size_t>(first)));
      for (auto k = static_cast<std::size_t>(first); k < static_cast<std::size_t>(last); ++k) {
        cells.push_back(all[k]);
      }
    }
    return cells;
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

  // A line ends with "\n", "\r\n" or a lone "\r".
  std::string line() {
    const std::size_t end = std::min(bytes_.find_first_of("\r\n", at_), bytes_.size());
    std::string text = bytes_.substr(at_, end - at_);
    at_ = std::min(end + (bytes_.compare(end, 2, "\r\n") == 0 ? 2 : 1), bytes_.size());
    return text;
  }
  std::string word() {
    // A text may end with a zero byte.
    const std::string_view between(" \t\r\n\0", binary_ ? 4 : 5);
    at_ = std::min(bytes_.find_first_not_of(between, at_), bytes_.size());
    const std::size_t end = std::min(bytes_.find_first_of(between, at_), bytes_.size());
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
    const std::optional<double> value = to_any_number(text);
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
        const std::optional<double> value = to_any_number(text);
        if (!value) complain(fmt::format("'{}' where a number is needed", text));
        values.push_back(*value);
      }
      return values;
    }
    static const std::map<std::string, std::string> names{
        {"double", "Float64"},      {"float", "Float32"},       {"int", "Int32"},
        {"long", "Int64"},          {"vtktypeint64", "Int64"},  {"vtktypeint32", "Int32"},
        {"vtkIdType", "Int64"},     {"unsigned_char", "UInt8"}, {"char", "Int8"},
        {"unsigned_int", "UInt32"}, {"short", "Int16"},         {"unsigned_short", "UInt16"},
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
  std::size_t at_;
  bool binary_ = false, at_points_ = false;
  std::int64_t count_ = 0;
  std::vector<double> cells_;
  NodalFile file_;
};

}  // namespace

NodalFile parse_vtk(const std::string& bytes, const std::string& name) {
  return VtkReader(bytes, name).read();
}

}  // namespace palpable

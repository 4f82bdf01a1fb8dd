#include "palpable/bake/mesh/field_files.h"

#include "palpable/bake/mesh/field_text.h"
#include "palpable/common/base/npy_file.h"
#include "palpable/common/base/plain_text.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/base/whole_file.h"
#include "palpable/common/body_file/foreign_hdf5.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <new>
#include <optional>
#include <string_view>
#include <utility>

namespace palpable {

using Eigen::Index;
using Eigen::MatrixXd;
using namespace field_text;

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
    if (has_decimal_commas(text)) bad(name, fmt::format("line {}: {}", number, kDecimalCommas));
    std::vector<double> row;
    for (const std::string_view word : words) {
      const std::optional<double> value = to_any_number(word);
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
  try {
    const hdf5::ForeignNumbers table = hdf5::read_foreign(path, dataset);
    const std::size_t dimensions = table.size.size();
    if (dimensions == 0 || dimensions > 2 || table.values.empty()) {
      bad(name, "must be a table of nodes x components");
    }
    const Index components = dimensions == 2 ? static_cast<Index>(table.size[1]) : 1;
    NodalFile file;
    file.fields.push_back({"", as_columns(table.values, components)});
    return file;
  } catch (const hdf5::Trouble& trouble) { bad(name, trouble.what); }
}

// Largest file of fields that is read, bytes: a mesh of ten million nodes as text.
constexpr std::uintmax_t kLargestFields = 2'000'000'000;

// A format: its reader, what reads its bytes and what judges the first of them (FileBound).
struct FieldKind {
  NodalFile (*parse)(const std::string&, const std::string&);
  Result<std::string> (*read)(const std::filesystem::path&, const FileBound&);
  std::string (*why_not)(std::string_view first, std::uintmax_t size) = nullptr;
};

std::string why_no_vtu(std::string_view first, std::uintmax_t /*size*/) {
  if (is_utf16(first)) return why_no_text(first, TextPart::kFirst);
  const std::string_view text = without_mark(first);
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin != std::string_view::npos && text[begin] == '<') return {};
  return "not XML, which a .vtu file is";
}

std::string why_no_vtk(std::string_view first, std::uintmax_t /*size*/) {
  if (is_utf16(first)) return why_no_text(first, TextPart::kFirst);
  return without_mark(first).starts_with("# vtk DataFile") ? "" : "not a legacy file of VTK";
}

NodalFile read_field_file(const std::filesystem::path& path, const FieldKind& kind) {
  FileBound bound{.most = kLargestFields};
  if (kind.why_not != nullptr) bound.why_not = kind.why_not;
  const Result<std::string> bytes = kind.read(path, bound);
  if (!bytes) bad(path.string(), bytes.problem().message);
  return kind.parse(bytes.value(), path.string());
}

}  // namespace

NodalFile read_nodal_file(const std::filesystem::path& path) {
  const std::string text = path.string();
  const std::size_t colon = text.rfind(':');
  if (colon != std::string::npos && colon > 0) {
    const std::filesystem::path file = text.substr(0, colon);
    if (const std::string why = why_no_file(file); !why.empty()) bad(file.string(), why);
    return read_hdf5(file, text.substr(colon + 1));
  }
  if (const std::string why = why_no_file(path); !why.empty()) bad(text, why);
  const std::string ending = path.extension().string();
  if (ending == ".h5" || ending == ".hdf5") {
    bad(text, "name the dataset behind a colon: runs.h5:/u/level_3");
  }
  // .vtu and .vtk may hold bytes that are no text.
  static const std::map<std::string, FieldKind> readers{
      {".vtu", {parse_vtu, read_whole_file, why_no_vtu}},
      {".vtk", {parse_vtk, read_whole_file, why_no_vtk}},
      {".npy", {parse_npy, read_whole_file, why_no_npy}},
      {".frd", {parse_frd, read_text_file}},
      {".csv", {parse_table, read_text_file}},
      {".rpt", {parse_table, read_text_file}},
      {".txt", {parse_table, read_text_file}}};
  const auto reader = readers.find(ending);
  if (reader == readers.end()) {
    bad(text, fmt::format("'{}' is not known: .vtu, .vtk, .frd, .npy, .h5, .csv, .rpt and .txt are",
                          ending));
  }
  try {
    return read_field_file(path, reader->second);
  } catch (const std::bad_alloc&) { bad(text, "needs more memory than there is"); }
}

}  // namespace palpable

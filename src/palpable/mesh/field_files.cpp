#include "palpable/mesh/field_files.h"

#include "palpable/mesh/field_text.h"
#include "palpable/reduced/hdf5_tools.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

namespace palpable {

using Eigen::Index;
using Eigen::MatrixXd;
using namespace field_text;

NodalFile parse_npy(const std::string& bytes, const std::string& name) {
  if (bytes.size() < 12 || bytes.compare(0, 6, "\x93NUMPY") != 0) bad(name, "not a .npy file");
  const bool long_header = bytes[6] != 1;
  const std::size_t begin = long_header ? 12 : 10;
  std::size_t length = 0;
  for (std::size_t k = 0; k < (long_header ? 4u : 2u); ++k) {
    length |= static_cast<std::size_t>(static_cast<unsigned char>(bytes[8 + k])) << (8 * k);
  }
  if (length > bytes.size() - begin) bad(name, "is cut short");
  const std::string header = bytes.substr(begin, length);
  const auto value_of = [&](const std::string& key) {
    const std::size_t at = header.find("'" + key + "'");
    const std::size_t colon = at == std::string::npos ? at : header.find(':', at);
    if (colon == std::string::npos) bad(name, fmt::format("its header has no '{}'", key));
    return header.substr(colon + 1);
  };
  const std::string type = value_of("descr");
  const std::size_t quote = type.find('\'');
  const std::string kind = quote == std::string::npos ? "" : type.substr(quote + 1, 3);
  if (kind != "<f8" && kind != "<f4") {
    bad(name, fmt::format("holds numbers of type '{}': save it as float64 or float32", kind));
  }
  if (value_of("fortran_order").find("False") > 2) {
    bad(name, "is stored column by column: save numpy.ascontiguousarray() of it");
  }
  const std::string shape = value_of("shape");
  const std::size_t open = shape.find('('), close = shape.find(')');
  if (open == std::string::npos || close == std::string::npos) bad(name, "its header has no shape");
  std::vector<std::int64_t> size;
  for (const std::string_view word :
       words_of(std::string_view(shape).substr(open + 1, close - open - 1), " ,")) {
    size.push_back(static_cast<std::int64_t>(number_of(word).value_or(-1)));
  }
  if (size.empty() || size.size() > 2 || size[0] < 1 || size.back() < 1 || size[0] > kMostNumbers ||
      size.back() > kMostNumbers / size[0]) {
    bad(name, "must be an array of nodes x components");
  }
  const std::int64_t components = size.size() == 2 ? size[1] : 1;
  const std::string_view data = std::string_view(bytes).substr(begin + length);
  const NumberType number = *number_type(kind == "<f8" ? "Float64" : "Float32");
  if (data.size() != static_cast<std::size_t>(size[0] * components) * number.size) {
    bad(name, fmt::format("has {} bytes of numbers where its shape needs {}", data.size(),
                          static_cast<std::size_t>(size[0] * components) * number.size));
  }
  NodalFile file;
  file.fields.push_back({"", as_columns(number.convert(data, false), components)});
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

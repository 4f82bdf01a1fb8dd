/// @file
/// Nodal fields in the files of other programs: VTK (.vtu, .vtk), CalculiX (.frd), NumPy (.npy),
/// HDF5 and tables of node and values (.csv, .rpt, .txt).
///
///   n  rows: nodes in the file's own order
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace palpable {

/// The nodal data of a file.
struct NodalFile {
  struct Field {
    std::string name;        ///< empty where the format has none (.npy, HDF5)
    Eigen::MatrixXd values;  ///< (components x n)
  };
  std::vector<Field> fields;
  std::vector<std::int64_t> numbers;  ///< (n) of the nodes; empty: the format has none
  Eigen::Matrix3Xd points;            ///< (3 x n); no columns: the format has none
  /// Of .vtu and .vtk: nodes (from 0) of each tetrahedron, 4 or 10; empty where there are none.
  std::vector<std::vector<std::int64_t>> tets;
};

/// Reads a file, whose format follows from the ending of its name. After a colon comes the path of
/// a dataset within an HDF5 file: "runs.h5:/u/level_3".
///
/// .vtu: ASCII, binary or appended, plain or with zlib. .vtk: legacy, up to version 5.1, ASCII or
/// binary. .frd: ASCII, the results of the last step under their names (DISP, STRESS). Tables:
/// columns separated by blanks or commas, the first with the node's number; each further column is
/// a field, named by the header if one has as many words, else "1", "2" ... .npy and HDF5: n x c or
/// n values, single or double precision.
/// @throws Error that names the file, the line in texts, and what is wrong
[[nodiscard]] NodalFile read_nodal_file(const std::filesystem::path& path);

// Readers of the single formats, from memory. @param name  for messages
[[nodiscard]] NodalFile parse_vtu(const std::string& bytes, const std::string& name);
[[nodiscard]] NodalFile parse_vtk(const std::string& bytes, const std::string& name);
[[nodiscard]] NodalFile parse_frd(const std::string& bytes, const std::string& name);
[[nodiscard]] NodalFile parse_npy(const std::string& bytes, const std::string& name);
[[nodiscard]] NodalFile parse_table(const std::string& bytes, const std::string& name);

}  // namespace palpable

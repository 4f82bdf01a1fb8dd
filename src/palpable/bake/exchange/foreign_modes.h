/// @file
/// Separated representations from other programs, and bodies made of them.
///
///   V  vertices   m  modes   p  parameters   n_j  samples of parameter j
#pragma once

#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/reduced/reduced_body.h"

#include <Eigen/Core>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

/// Content of another program's file. Parameters may have any order and any names.
struct ForeignModes {
  SurfaceMesh surface;                        ///< m
  SeparatedField displacement;                ///< (3V) m
  std::optional<SeparatedField> stress = {};  ///< (6V) Pa: xx yy zz xy yz zx
  /// Vertices of the S sites and their loads at the last level, (3 x S) N; empty where the file
  /// does not say them.
  std::vector<int> site_vertices = {};
  Eigen::Matrix3Xd site_loads = {};
};

/// How foreign modes become a body.
struct ImportSettings {
  std::string name = "imported";
  std::string site = "site";    ///< name of the parameter that is the position of the touch
  std::string level = "level";  ///< name of the one that is the load, from 0 or more upwards
  std::string source = {};      ///< file or folder of the modes: how messages begin
  Provenance provenance = {};
};

/// Whether numbers can be modes, which are stored in single precision: finite, up to 1e30.
[[nodiscard]] bool is_single_precision(const Eigen::MatrixXd& modes);

/// Numbers of a file as numbers of vertices. @throws Error beginning with `name` where one is none
[[nodiscard]] std::vector<int> vertex_numbers(const std::vector<double>& values,
                                              const std::string& name);

/// A body made of foreign modes. What the file does not say is derived from the field:
///
/// * Without a parameter of the site's name there is one site.
/// * Unless the file has both vertices and loads of the sites, a site's vertex is the one with the
///   largest displacement at the last level, and its load is 1 N along that displacement. Patches
///   have graph distance 2 and are weighted by nodal areas.
/// * The level's samples are scaled to end at 1. If the first is above 0, a level at rest is put
///   before it.
/// * Vertices that no mode moves are held.
/// * Without stress modes the stress is zero.
///
/// @throws Error if the surface is not watertight, there is no such level, a site's patch does not
///         move farther with every level, or the sizes do not fit
[[nodiscard]] ReducedBody body_of_modes(const ForeignModes& modes, const ImportSettings& settings);

/// The modes of a body, for another program.
[[nodiscard]] ForeignModes modes_of_body(const ReducedBody& body);

// Files of separated representations that other programs write and read: a folder of NumPy arrays,
// and PXDMF, a format of the PGD community (XDMF with one grid per space). docs/exchange.md
// describes both.

/// @param folder  created if it does not exist
/// @throws Error if something cannot be written
void write_numpy_modes(const std::filesystem::path& folder, const ForeignModes& modes);

/// @throws Error that names the array that is missing or does not fit
[[nodiscard]] ForeignModes read_numpy_modes(const std::filesystem::path& folder);

/// Writes `path` (.pxdmf), and its numbers to a file beside it with .h5 added to the name.
/// @throws Error if one of them cannot be written
void write_pxdmf(const std::filesystem::path& path, const ForeignModes& modes);

/// Reads numbers from HDF5 or from the XML itself. The grid of triangles is the space. Every other
/// grid is one parameter; it is a choice if its points are unconnected (Polyvertex).
/// @throws Error that names what is missing or cannot be read
[[nodiscard]] ForeignModes read_pxdmf(const std::filesystem::path& path);

}  // namespace palpable

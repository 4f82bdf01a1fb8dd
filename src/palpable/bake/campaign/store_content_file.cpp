#include "palpable/bake/campaign/store_content_file.h"

#include "palpable/common/base/error.h"
#include "palpable/common/body_file/body_file_groups.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <span>
#include <system_error>
#include <vector>

namespace palpable {

using Eigen::Index;
using Eigen::VectorXd;
using hdf5::Handle;

namespace {

template <class T>
void write_column(hid_t file, const char* name, const std::vector<T>& values) {
  hdf5::write_table(file, name, values.data(), values.size(), 1);
}

void write_mesh(hid_t file, const TetMesh& mesh, const std::vector<std::uint8_t>& fixed) {
  const Handle g = hdf5::make_group(file, "mesh");
  hdf5::write_table(g, "nodes", mesh.nodes.data(), static_cast<hsize_t>(mesh.nodes.cols()), 3);
  hdf5::write_table(g, "tets", mesh.tets.data(), static_cast<hsize_t>(mesh.tets.cols()), 4);
  if (mesh.is_quadratic()) {
    hdf5::write_table(g, "edge_nodes", mesh.edge_nodes.data(),
                      static_cast<hsize_t>(mesh.edge_nodes.cols()), 6);
    // The ten nodes of a tetrahedron in the order of VTK and XDMF.
    Eigen::MatrixXi both(10, mesh.tets.cols());
    both << mesh.tets, mesh.edge_nodes;
    hdf5::write_table(g, "cells", both.data(), static_cast<hsize_t>(both.cols()), 10);
  }
  write_column(g, "fixed", fixed);
}

// The laws and their constants as numbers, so that another solver can pose the same problem.
void write_materials(hid_t file, const StoreContent& content) {
  if (content.materials.empty()) return;
  const Handle g = hdf5::make_group(file, "materials");
  hdf5::write_number(g, "count", static_cast<double>(content.materials.size()));
  for (std::size_t k = 0; k < content.materials.size(); ++k) {
    const std::string law = law_name(content.materials[k]);
    std::string names;
    for (const LawConstant& constant : law_constants(law)) {
      if (!names.empty()) names += ' ';
      names += constant.name;
    }
    hdf5::write_text(g, fmt::format("{}_law", k).c_str(), law);
    hdf5::write_text(g, fmt::format("{}_names", k).c_str(), names);
    write_column(g, fmt::format("{}_constants", k).c_str(), constants_of(content.materials[k]));
  }
  write_column(g, "of_element", content.material_of_element);
}

void write_sites(hid_t file, const std::vector<Site>& sites) {
  const Handle g = hdf5::make_group(file, "sites");
  std::vector<int> vertex, begin{0}, patch;
  std::vector<float> weights;
  std::vector<double> direction;
  for (const Site& site : sites) {
    vertex.push_back(site.vertex);
    patch.insert(patch.end(), site.patch.begin(), site.patch.end());
    weights.insert(weights.end(), site.weights.begin(), site.weights.end());
    begin.push_back(static_cast<int>(patch.size()));
    direction.insert(direction.end(), site.direction.begin(), site.direction.end());
  }
  write_column(g, "vertex", vertex);
  hdf5::write_table(g, "direction", direction.data(), sites.size(), 3);
  write_column(g, "patch_begin", begin);
  write_column(g, "patch", patch);
  write_column(g, "patch_weights", weights);
}

template <class Matrix, class T>
Matrix as_matrix(const hdf5::Table<T>& table) {  // dataset rows become columns
  return Eigen::Map<const Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>>(
      table.data.data(), static_cast<Index>(table.columns), static_cast<Index>(table.rows));
}

TetMesh read_mesh(hid_t file, std::vector<std::uint8_t>& fixed) {
  const Handle g = hdf5::open_group(file, "mesh");
  TetMesh mesh;
  const auto nodes = hdf5::read_table<double>(g, "nodes");
  const auto tets = hdf5::read_table<int>(g, "tets", hdf5::read_table<int>(g, "tets").rows, 4);
  hdf5::require(nodes.columns == 3, "nodes do not have three coordinates");
  mesh.nodes = as_matrix<Eigen::Matrix3Xd>(nodes);
  mesh.tets = as_matrix<Eigen::Matrix4Xi>(tets);
  if (H5Lexists(g, "edge_nodes", H5P_DEFAULT) > 0) {
    mesh.edge_nodes = as_matrix<Eigen::Matrix<int, 6, Eigen::Dynamic>>(
        hdf5::read_table<int>(g, "edge_nodes", tets.rows, 6));
  }
  const auto in_range = [&](const auto& indices) {
    return indices.size() == 0 ||
           (indices.minCoeff() >= 0 && indices.maxCoeff() < mesh.node_count());
  };
  hdf5::require(mesh.tet_count() > 0 && in_range(mesh.tets) && in_range(mesh.edge_nodes),
                "an element has a node that does not exist");
  fixed = hdf5::read_table<std::uint8_t>(g, "fixed").data;
  return mesh;
}

std::vector<Site> read_sites(hid_t file) {
  const Handle g = hdf5::open_group(file, "sites");
  const auto vertex = hdf5::read_table<int>(g, "vertex");
  const auto direction = hdf5::read_table<double>(g, "direction", vertex.rows, 3);
  const auto begin = hdf5::read_table<int>(g, "patch_begin", vertex.rows + 1, 1);
  const auto patch = hdf5::read_table<int>(g, "patch");
  const auto weights = hdf5::read_table<float>(g, "patch_weights", patch.rows, 1);
  std::vector<Site> sites;
  for (std::size_t s = 0; s < vertex.rows; ++s) {
    const int first = begin.data[s], end = begin.data[s + 1];
    hdf5::require(0 <= first && first < end && static_cast<hsize_t>(end) <= patch.rows,
                  fmt::format("site {} has no patch", s));
    sites.push_back({.vertex = vertex.data[s],
                     .patch = {patch.data.begin() + first, patch.data.begin() + end},
                     .weights = {weights.data.begin() + first, weights.data.begin() + end},
                     .direction = Eigen::Vector3d(&direction.data[3 * s])});
  }
  hdf5::require(!sites.empty(), "there is no site");
  return sites;
}

// Inverse of key_text().
std::uint64_t key_in(const std::string& text) {
  std::uint64_t key = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), key, 16);
  hdf5::require(error == std::errc() && end == text.data() + text.size(), "a key is damaged");
  return key;
}

int read_count(hid_t group) {
  const double count = hdf5::read_number(group, "count");
  hdf5::require(count >= 0 && count < 1000, "a list is damaged");
  return static_cast<int>(count);
}

Material read_material(hid_t group, int k) {
  const std::string law = hdf5::read_text(group, fmt::format("{}_law", k).c_str());
  const VectorXd values = read_column(group, fmt::format("{}_constants", k).c_str());
  try {
    hdf5::require(static_cast<std::size_t>(values.size()) == law_constants(law).size(),
                  fmt::format("law {} has another number of constants", law));
    return material_from_constants(
        law, std::span<const double>(values.data(), std::size_t(values.size())));
  } catch (const Error& error) { throw hdf5::Trouble{error.what()}; }
}

void read_materials(hid_t file, StoreContent& content) {
  const Handle g = hdf5::open_group(file, "materials");
  const int count = read_count(g);
  for (int k = 0; k < count; ++k) content.materials.push_back(read_material(g, k));
  content.material_of_element =
      hdf5::read_table<int>(g, "of_element", content.mesh.tet_count(), 1).data;
  hdf5::require(std::all_of(content.material_of_element.begin(), content.material_of_element.end(),
                            [&](int k) { return 0 <= k && k < count; }),
                "an element has a material that does not exist");
}

}  // namespace

std::string key_text(std::uint64_t key) { return fmt::format("{:016x}", key); }

Eigen::VectorXd read_column(hid_t file, const char* name) {
  const auto table = hdf5::read_table<double>(file, name);
  hdf5::require(table.columns == 1, fmt::format("'{}' is not one column", name));
  return Eigen::Map<const Eigen::VectorXd>(table.data.data(), static_cast<Index>(table.rows));
}

void write_content(hid_t file, const StoreContent& content) {
  hdf5::write_text(file, "name", content.name);
  hdf5::write_text(file, "material", content.material);
  hdf5::write_text(file, "method", std::string(method_name(content.reduction.method)));
  hdf5::write_number(file, "tolerance", content.reduction.tolerance);
  hdf5::write_number(file, "max_modes", content.reduction.max_modes);
  hdf5::write_number(file, "own_norms", content.reduction.weight_snapshots ? 1 : 0);
  write_solid(file, content);
  write_sites(file, content.sites);
  hdf5::write_table(file, "levels", content.levels.data(),
                    static_cast<hsize_t>(content.levels.size()), 1);
  std::string keys;
  for (const std::uint64_t key : content.keys) keys += key_text(key);
  hdf5::write_table(file, "keys", reinterpret_cast<const std::uint8_t*>(keys.data()),
                    content.keys.size(), 16);
  if (!content.linear.empty()) {
    const Handle g = hdf5::make_group(file, "linear");
    write_column(g, "vertex", content.linear);
    hdf5::write_text(g, "key", key_text(content.linear_key));
  }
  {
    const Handle g = hdf5::make_group(file, "parameters");
    hdf5::write_number(g, "count", static_cast<double>(content.parameters.size()));
    for (std::size_t k = 0; k < content.parameters.size(); ++k) {
      const StoredParameter& parameter = content.parameters[k];
      hdf5::write_text(g, fmt::format("{}_name", k).c_str(), parameter.name);
      hdf5::write_table(g, fmt::format("{}_values", k).c_str(), parameter.values.data(),
                        static_cast<hsize_t>(parameter.values.size()), 1);
    }
  }
  {
    const Handle g = hdf5::make_group(file, "fields");
    hdf5::write_number(g, "count", static_cast<double>(content.fields.size()));
    for (std::size_t k = 0; k < content.fields.size(); ++k) {
      hdf5::write_text(g, fmt::format("{}_name", k).c_str(), content.fields[k].name);
      hdf5::write_number(g, fmt::format("{}_components", k).c_str(), content.fields[k].components);
    }
  }
  body_file::write_provenance(file, content.provenance);
}

StoreContent read_content(hid_t file) {
  StoreContent content;
  content.name = hdf5::read_text(file, "name");
  content.material = hdf5::read_text(file, "material");
  content.reduction.tolerance = hdf5::read_number(file, "tolerance");
  content.reduction.max_modes = static_cast<int>(hdf5::read_number(file, "max_modes"));
  if (H5Aexists(file, "method") > 0) {
    const std::string name = hdf5::read_text(file, "method");
    const std::optional<ReductionMethod> method = method_named(name);
    hdf5::require(method.has_value(), fmt::format("there is no reduction '{}'", name));
    content.reduction.method = *method;
    content.reduction.weight_snapshots = hdf5::read_number(file, "own_norms") != 0;
  } else {  // an older store, from when PGD was the only method
    content.reduction.method = ReductionMethod::kPgd;
    content.reduction.weight_snapshots = false;
  }
  read_solid(file, content);
  content.sites = read_sites(file);
  content.levels = read_column(file, "levels");
  const auto keys = hdf5::read_table<std::uint8_t>(file, "keys");
  hdf5::require(keys.columns == 16 && keys.rows > 0 && keys.rows % content.sites.size() == 0,
                "there is not one key for each unit");
  for (std::size_t u = 0; u < keys.rows; ++u) {
    const std::string text(keys.data.begin() + static_cast<std::ptrdiff_t>(16 * u),
                           keys.data.begin() + static_cast<std::ptrdiff_t>(16 * u + 16));
    content.keys.push_back(key_in(text));
  }
  if (H5Lexists(file, "linear", H5P_DEFAULT) > 0) {
    const Handle g = hdf5::open_group(file, "linear");
    content.linear = hdf5::read_table<int>(g, "vertex").data;
    content.linear_key = key_in(hdf5::read_text(g, "key"));
  }
  {
    const Handle g = hdf5::open_group(file, "parameters");
    for (int k = 0; k < read_count(g); ++k) {
      content.parameters.push_back({hdf5::read_text(g, fmt::format("{}_name", k).c_str()),
                                    read_column(g, fmt::format("{}_values", k).c_str())});
    }
  }
  content.fields.clear();
  {
    const Handle g = hdf5::open_group(file, "fields");
    for (int k = 0; k < read_count(g); ++k) {
      content.fields.push_back(
          {hdf5::read_text(g, fmt::format("{}_name", k).c_str()),
           static_cast<int>(hdf5::read_number(g, fmt::format("{}_components", k).c_str()))});
    }
  }
  content.provenance = body_file::read_provenance(file);
  return content;
}

void write_solid(hid_t file, const StoreContent& content) {
  write_mesh(file, content.mesh, content.fixed);
  write_materials(file, content);
}

void read_solid(hid_t file, StoreContent& content) {
  content.mesh = read_mesh(file, content.fixed);
  if (H5Lexists(file, "materials", H5P_DEFAULT) > 0) read_materials(file, content);
}

}  // namespace palpable

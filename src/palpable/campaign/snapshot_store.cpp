#include "palpable/campaign/snapshot_store.h"

#include "palpable/base/contract.h"
#include "palpable/base/error.h"
#include "palpable/base/fnv1a.h"
#include "palpable/reduced/hdf5_tools.h"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <set>
#include <string_view>
#include <system_error>
#include <unistd.h>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using Eigen::Index;
using hdf5::Handle;
using hdf5::Trouble;

constexpr std::string_view kUnitKind = "palpable snapshots";
constexpr std::string_view kLinearKind = "palpable linear responses";
constexpr std::string_view kCampaignKind = "palpable campaign";
constexpr std::string_view kRemedy = "bake it again";
constexpr const char* kCampaignFile = "campaign.h5";
constexpr const char* kXdmfFile = "campaign.xdmf";

// Debian's HDF5 is not made for several threads.
std::mutex& hdf5_turn() {
  static std::mutex mutex;
  return mutex;
}

// Names a file in whatever goes wrong with it.
template <class Work>
auto about(const fs::path& file, Work&& work) {
  try {
    return work();
  } catch (const Trouble& trouble) {
    throw Error(fmt::format("{}: {}", file.string(), trouble.what));
  } catch (const fs::filesystem_error& error) {
    throw Error(fmt::format("{}: {}", file.string(), error.code().message()));
  }
}

// Several processes, on several machines, may write the same file.
std::string own_suffix() {
  char host[256] = {};
  ::gethostname(host, sizeof host - 1);
  return fmt::format(".part-{}-{}", host, ::getpid());
}

// Another process may just be writing its first file there, under its own name.
void refuse_foreign(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().filename().string().find(".part-") != std::string::npos) continue;
    if (entry.path().filename() == kCampaignFile) continue;
    throw Trouble{
        "the folder holds something else than snapshots; empty it or choose another name"};
  }
}

std::string hex(std::uint64_t key) { return fmt::format("{:016x}", key); }

// ---- campaign.h5 -----------------------------------------------------------------------------

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
    // As VTK and XDMF number the ten nodes of a tetrahedron.
    Eigen::MatrixXi both(10, mesh.tets.cols());
    both << mesh.tets, mesh.edge_nodes;
    hdf5::write_table(g, "cells", both.data(), static_cast<hsize_t>(both.cols()), 10);
  }
  write_column(g, "fixed", fixed);
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

void write_content(hid_t file, const StoreContent& content) {
  hdf5::write_text(file, "name", content.name);
  hdf5::write_text(file, "material", content.material);
  hdf5::write_text(file, "method", std::string(method_name(content.reduction.method)));
  hdf5::write_number(file, "tolerance", content.reduction.tolerance);
  hdf5::write_number(file, "max_modes", content.reduction.max_modes);
  hdf5::write_number(file, "own_norms", content.reduction.weight_snapshots ? 1 : 0);
  write_mesh(file, content.mesh, content.fixed);
  write_sites(file, content.sites);
  hdf5::write_table(file, "levels", content.levels.data(),
                    static_cast<hsize_t>(content.levels.size()), 1);
  std::string keys;
  for (const std::uint64_t key : content.keys) keys += hex(key);
  hdf5::write_table(file, "keys", reinterpret_cast<const std::uint8_t*>(keys.data()),
                    content.keys.size(), 16);
  if (!content.linear.empty()) {
    const Handle g = hdf5::make_group(file, "linear");
    write_column(g, "vertex", content.linear);
    hdf5::write_text(g, "key", hex(content.linear_key));
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
  const Handle g = hdf5::make_group(file, "provenance");
  hdf5::write_number(g, "count", static_cast<double>(content.provenance.size()));
  for (std::size_t k = 0; k < content.provenance.size(); ++k) {
    hdf5::write_text(g, fmt::format("{:03}_key", k).c_str(), content.provenance[k].first);
    hdf5::write_text(g, fmt::format("{:03}_value", k).c_str(), content.provenance[k].second);
  }
}

template <class Matrix, class T>
Matrix as_matrix(const hdf5::Table<T>& table) {  // dataset rows become columns
  return Eigen::Map<const Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>>(
      table.data.data(), static_cast<Index>(table.columns), static_cast<Index>(table.rows));
}

Eigen::VectorXd read_column(hid_t file, const char* name) {
  const auto table = hdf5::read_table<double>(file, name);
  hdf5::require(table.columns == 1, fmt::format("'{}' is not one column", name));
  return Eigen::Map<const Eigen::VectorXd>(table.data.data(), static_cast<Index>(table.rows));
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

int read_count(hid_t group) {
  const double count = hdf5::read_number(group, "count");
  hdf5::require(count >= 0 && count < 1000, "a list is damaged");
  return static_cast<int>(count);
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
  } else {  // of before there were others
    content.reduction.method = ReductionMethod::kPgd;
    content.reduction.weight_snapshots = false;
  }
  content.mesh = read_mesh(file, content.fixed);
  content.sites = read_sites(file);
  content.levels = read_column(file, "levels");
  const auto keys = hdf5::read_table<std::uint8_t>(file, "keys");
  hdf5::require(keys.columns == 16 && keys.rows > 0 && keys.rows % content.sites.size() == 0,
                "there is not one key for each unit");
  for (std::size_t u = 0; u < keys.rows; ++u) {
    const std::string text(keys.data.begin() + static_cast<std::ptrdiff_t>(16 * u),
                           keys.data.begin() + static_cast<std::ptrdiff_t>(16 * u + 16));
    content.keys.push_back(std::stoull(text, nullptr, 16));
  }
  if (H5Lexists(file, "linear", H5P_DEFAULT) > 0) {
    const Handle g = hdf5::open_group(file, "linear");
    content.linear = hdf5::read_table<int>(g, "vertex").data;
    content.linear_key = std::stoull(hdf5::read_text(g, "key"), nullptr, 16);
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
  const Handle g = hdf5::open_group(file, "provenance");
  for (int k = 0; k < read_count(g); ++k) {
    content.provenance.emplace_back(hdf5::read_text(g, fmt::format("{:03}_key", k).c_str()),
                                    hdf5::read_text(g, fmt::format("{:03}_value", k).c_str()));
  }
  return content;
}

// ---- a unit ----------------------------------------------------------------------------------

void write_outcome(hid_t file, const SiteSnapshots& site) {
  const SiteOutcome& outcome = site.outcome;
  hdf5::write_number(file, "full_load", site.full_load);
  hdf5::write_number(file, "largest_von_mises", site.largest_von_mises);
  hdf5::write_number(file, "reached_press", outcome.reached_press ? 1 : 0);
  hdf5::write_number(file, "press", outcome.press);
  hdf5::write_text(file, "shortfall", outcome.shortfall);
  hdf5::write_number(file, "newton_steps", outcome.newton_steps);
  hdf5::write_number(file, "cg_iterations", outcome.cg_iterations);
  hdf5::write_number(file, "smallest_volume_ratio", outcome.smallest_volume_ratio);
}

StoredUnit read_unit(hid_t file) {
  StoredUnit unit;
  unit.full_load = hdf5::read_number(file, "full_load");
  unit.largest_von_mises = hdf5::read_number(file, "largest_von_mises");
  SiteOutcome& outcome = unit.outcome;
  outcome.reached_press = hdf5::read_number(file, "reached_press") != 0;
  outcome.press = hdf5::read_number(file, "press");
  outcome.shortfall = hdf5::read_text(file, "shortfall");
  outcome.newton_steps = static_cast<int>(hdf5::read_number(file, "newton_steps"));
  outcome.cg_iterations = static_cast<int>(hdf5::read_number(file, "cg_iterations"));
  outcome.smallest_volume_ratio = hdf5::read_number(file, "smallest_volume_ratio");
  unit.press_depth = read_column(file, "press_depth");
  if (H5Lexists(file, "rest", H5P_DEFAULT) > 0) {
    unit.rest = as_matrix<Eigen::Matrix3Xd>(hdf5::read_table<double>(file, "rest"));
  }
  return unit;
}

// Opens a file on disk that has been checked before.
Handle open_checked(const fs::path& file) {
  return Handle(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "cannot be read");
}

}  // namespace

std::vector<double> StoreContent::values_at(int point) const {
  std::vector<double> values(parameters.size());
  for (std::size_t k = parameters.size(); k-- > 0;) {
    const auto n = static_cast<int>(parameters[k].values.size());
    values[k] = parameters[k].values[point % n];
    point /= n;
  }
  return values;
}

void Digest::add(const void* bytes, std::size_t count) {
  value_ = fnv1a(std::string_view(static_cast<const char*>(bytes), count), value_);
}

void Digest::add(const std::string& text) {
  add(static_cast<int>(text.size()));
  add(text.data(), text.size());
}

SnapshotStore::SnapshotStore(fs::path folder, StoreContent content)
    : folder_(std::move(folder)), content_(std::move(content)) {}

SnapshotStore SnapshotStore::attach(fs::path folder, StoreContent content) {
  return {std::move(folder), std::move(content)};
}

SnapshotStore SnapshotStore::create(fs::path folder, StoreContent content) {
  PALPABLE_EXPECT(content.unit_count() > 0 && content.unit_count() % content.site_count() == 0,
                  "a key for each site at each point");
  const fs::path file = folder / kCampaignFile;
  about(file, [&] {
    if (!fs::create_directory(folder) && !fs::exists(file)) refuse_foreign(folder);
    const std::lock_guard turn(hdf5_turn());
    const hdf5::Quiet quiet;
    const std::string bytes =
        hdf5::image_of(kCampaignKind, kSnapshotLayout, [&](hid_t h) { write_content(h, content); });
    if (!fs::exists(file) || hdf5::all_bytes(file) != bytes) {
      hdf5::write_durably(file, bytes, own_suffix());
    }
  });
  return {std::move(folder), std::move(content)};
}

SnapshotStore SnapshotStore::open(fs::path folder) {
  const fs::path file = folder / kCampaignFile;
  if (!fs::is_directory(folder)) {
    throw Error(
        fmt::format("{}: no such folder of snapshots; 'palpable bake' keeps one beside the "
                    "body file, NAME.snapshots",
                    folder.string()));
  }
  if (!fs::exists(file)) {
    throw Error(
        fmt::format("{}: not a folder of snapshots: it has no {}", folder.string(), kCampaignFile));
  }
  StoreContent content = about(file, [&] {
    const std::lock_guard turn(hdf5_turn());
    const hdf5::Quiet quiet;
    const hdf5::Image image(hdf5::all_bytes(file), kCampaignKind, kSnapshotLayout,
                            "a campaign of Palpable", kRemedy);
    return read_content(image.file());
  });
  return {std::move(folder), std::move(content)};
}

fs::path SnapshotStore::unit_file(int unit) const {
  const int site = unit % content_.site_count(), point = unit / content_.site_count();
  return folder_ / (content_.parameters.empty()
                        ? fmt::format("site_{:04}.h5", site)
                        : fmt::format("point_{:03}_site_{:04}.h5", point, site));
}

std::string SnapshotStore::why_not(int unit) const {
  const fs::path file = unit_file(unit);
  std::error_code code;
  if (!fs::is_regular_file(file, code)) return "missing";
  try {
    const std::string bytes = hdf5::all_bytes(file);
    const std::lock_guard turn(hdf5_turn());
    const hdf5::Quiet quiet;
    const hdf5::Image image(bytes, kUnitKind, kSnapshotLayout, "a snapshot file of Palpable",
                            kRemedy);
    const std::string key = hdf5::read_text(image.file(), "key");
    if (key != hex(content_.keys[static_cast<std::size_t>(unit)])) {
      return "of another campaign (mesh, material, loads or levels differ)";
    }
    return {};
  } catch (const Trouble& trouble) { return trouble.what; }
}

bool SnapshotStore::has(int unit) const { return why_not(unit).empty(); }

void SnapshotStore::write(int unit, const SiteSnapshots& snapshots, const Eigen::Matrix3Xd& rest,
                          const std::vector<Eigen::MatrixXf>& others) const {
  const fs::path file = unit_file(unit);
  about(file, [&] {
    std::string bytes;
    {
      const std::lock_guard turn(hdf5_turn());
      const hdf5::Quiet quiet;
      bytes = hdf5::image_of(kUnitKind, kSnapshotLayout, [&](hid_t h) {
        hdf5::write_text(h, "key", hex(content_.keys[static_cast<std::size_t>(unit)]));
        write_outcome(h, snapshots);
        hdf5::write_table(h, "press_depth", snapshots.press_depth.data(),
                          static_cast<hsize_t>(snapshots.press_depth.size()), 1);
        if (!rest.isZero(0.0)) {
          hdf5::write_table(h, "rest", rest.data(), static_cast<hsize_t>(rest.cols()), 3);
        }
        auto other = others.begin();
        for (const StoredField& field : content_.fields) {
          const bool own = field.name == "displacement" || field.name == "stress";
          PALPABLE_EXPECT(own || other != others.end(), "a table for each field");
          const Eigen::MatrixXf& values = field.name == "displacement" ? snapshots.displacement
                                          : own                        ? snapshots.stress
                                                                       : *other++;
          const auto c = static_cast<hsize_t>(field.components);
          PALPABLE_EXPECT(values.rows() == content_.mesh.node_count() * field.components &&
                              values.cols() == content_.level_count(),
                          "a column for each level, values for each node");
          hdf5::write_block(
              h, field.name.c_str(), values.data(),
              {static_cast<hsize_t>(values.cols()), static_cast<hsize_t>(values.rows()) / c, c});
        }
      });
    }
    hdf5::write_durably(file, bytes, own_suffix());
  });
}

void SnapshotStore::copy_from(const SnapshotStore& other, int unit) const {
  about(unit_file(unit), [&] {
    hdf5::write_durably(unit_file(unit), hdf5::all_bytes(other.unit_file(unit)), own_suffix());
  });
}

StoredUnit SnapshotStore::unit(int unit) const {
  return about(unit_file(unit), [&] {
    const std::lock_guard turn(hdf5_turn());
    const hdf5::Quiet quiet;
    const Handle file = open_checked(unit_file(unit));
    return read_unit(file);
  });
}

Eigen::MatrixXf SnapshotStore::rows(int unit, const StoredField& field, Index first,
                                    Index count) const {
  return about(unit_file(unit), [&] {
    const std::lock_guard turn(hdf5_turn());
    const hdf5::Quiet quiet;
    const Handle file = open_checked(unit_file(unit));
    const Handle set(H5Dopen2(file, field.name.c_str(), H5P_DEFAULT), H5Dclose,
                     fmt::format("dataset '{}' is missing", field.name));
    const auto c = static_cast<hsize_t>(field.components);
    const auto L = static_cast<hsize_t>(content_.level_count());
    const auto N = static_cast<hsize_t>(content_.mesh.node_count());
    const Handle space(H5Dget_space(set), H5Sclose, "dataset without size");
    hsize_t size[3] = {};
    hdf5::require(H5Sget_simple_extent_ndims(space) == 3 &&
                      H5Sget_simple_extent_dims(space, size, nullptr) == 3 && size[0] == L &&
                      size[1] == N && size[2] == c,
                  fmt::format("dataset '{}' has another size than the campaign", field.name));
    // Whole nodes around the rows that are asked for.
    const hsize_t begin = static_cast<hsize_t>(first) / c;
    const hsize_t end = (static_cast<hsize_t>(first + count) + c - 1) / c;
    const hsize_t start[3] = {0, begin, 0}, extent[3] = {L, end - begin, c};
    hdf5::check(H5Sselect_hyperslab(space, H5S_SELECT_SET, start, nullptr, extent, nullptr),
                field.name);
    const Handle memory(H5Screate_simple(3, extent, nullptr), H5Sclose, "no memory");
    Eigen::MatrixXf values(static_cast<Index>((end - begin) * c), static_cast<Index>(L));
    hdf5::check(H5Dread(set, H5T_NATIVE_FLOAT, memory, space, H5P_DEFAULT, values.data()),
                fmt::format("dataset '{}' cannot be read", field.name));
    if (values.rows() == count) return values;
    return Eigen::MatrixXf(values.middleRows(first - static_cast<Index>(begin * c), count));
  });
}

fs::path SnapshotStore::linear_file(int k) const {
  return folder_ / fmt::format("linear_{:04}.h5", k);
}

bool SnapshotStore::has_linear(int k) const {
  std::error_code code;
  if (!fs::is_regular_file(linear_file(k), code)) return false;
  try {
    const std::string bytes = hdf5::all_bytes(linear_file(k));
    const std::lock_guard turn(hdf5_turn());
    const hdf5::Quiet quiet;
    const hdf5::Image image(bytes, kLinearKind, kSnapshotLayout, "linear responses", kRemedy);
    return hdf5::read_text(image.file(), "key") == hex(content_.linear_key);
  } catch (const Trouble&) { return false; }
}

void SnapshotStore::write_linear(int k, const Eigen::MatrixXf& responses) const {
  about(linear_file(k), [&] {
    std::string bytes;
    {
      const std::lock_guard turn(hdf5_turn());
      const hdf5::Quiet quiet;
      bytes = hdf5::image_of(kLinearKind, kSnapshotLayout, [&](hid_t h) {
        hdf5::write_text(h, "key", hex(content_.linear_key));
        const auto first = content_.linear.begin() + std::ptrdiff_t{k} * kLinearRow;
        write_column(h, "vertex", std::vector<int>(first, first + responses.cols()));
        hdf5::write_block(h, "displacement", responses.data(),
                          {static_cast<hsize_t>(responses.cols()),
                           static_cast<hsize_t>(responses.rows()) / 3, 3});
      });
    }
    hdf5::write_durably(linear_file(k), bytes, own_suffix());
  });
}

Eigen::MatrixXf SnapshotStore::linear(int k) const {
  return about(linear_file(k), [&] {
    const std::lock_guard turn(hdf5_turn());
    const hdf5::Quiet quiet;
    const Handle file = open_checked(linear_file(k));
    const Handle set(H5Dopen2(file, "displacement", H5P_DEFAULT), H5Dclose,
                     "dataset 'displacement' is missing");
    const Handle space(H5Dget_space(set), H5Sclose, "dataset without size");
    hsize_t size[3] = {};
    hdf5::require(H5Sget_simple_extent_ndims(space) == 3 &&
                      H5Sget_simple_extent_dims(space, size, nullptr) == 3 &&
                      size[0] <= kLinearRow && size[1] == content_.fixed.size() && size[2] == 3,
                  "dataset 'displacement' has another size than the skin");
    Eigen::MatrixXf values(static_cast<Index>(3 * size[1]), static_cast<Index>(size[0]));
    hdf5::check(H5Dread(set, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
                "dataset 'displacement' cannot be read");
    return values;
  });
}

void SnapshotStore::copy_linear_from(const SnapshotStore& other, int k) const {
  about(linear_file(k), [&] {
    hdf5::write_durably(linear_file(k), hdf5::all_bytes(other.linear_file(k)), own_suffix());
  });
}

void SnapshotStore::finish() const {
  const fs::path file = folder_ / kXdmfFile;
  about(file, [&] {
    const std::string text = xdmf();
    if (!fs::exists(file) || hdf5::all_bytes(file) != text) {
      hdf5::write_durably(file, text, own_suffix());
    }
    std::set<fs::path> ours{kCampaignFile, kXdmfFile};
    for (int k = 0; k < content_.linear_file_count(); ++k) {
      ours.insert(linear_file(k).filename());
    }
    for (int u = 0; u < content_.unit_count(); ++u) ours.insert(unit_file(u).filename());
    for (const auto& entry : fs::directory_iterator(folder_)) {
      const std::string name = entry.path().filename().string();
      const bool made_here = name.starts_with("site_") || name.starts_with("point_") ||
                             name.starts_with("linear_") ||
                             name.find(".part-") != std::string::npos;
      if (made_here && !ours.contains(name)) fs::remove(entry.path());
    }
  });
}

// One grid per snapshot, in one series: ParaView's time is the number of the snapshot, and a
// grid's name says site and level.
std::string SnapshotStore::xdmf() const {
  const TetMesh& mesh = content_.mesh;
  const int N = mesh.node_count(), E = mesh.tet_count(), L = content_.level_count();
  const bool quadratic = mesh.is_quadratic();
  std::string text =
      "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n<Domain>\n"
      "<Grid Name=\"campaign\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
  const std::string geometry = fmt::format(
      "<Topology TopologyType=\"{0}\" NumberOfElements=\"{1}\"><DataItem Dimensions=\"{1} {2}\" "
      "NumberType=\"Int\" Format=\"HDF\">{3}:/mesh/{4}</DataItem></Topology>\n"
      "<Geometry GeometryType=\"XYZ\"><DataItem Dimensions=\"{5} 3\" NumberType=\"Float\" "
      "Precision=\"8\" Format=\"HDF\">{3}:/mesh/nodes</DataItem></Geometry>\n",
      quadratic ? "Tetrahedron_10" : "Tetrahedron", E, quadratic ? 10 : 4, kCampaignFile,
      quadratic ? "cells" : "tets", N);
  int time = 0;
  for (int u = 0; u < content_.unit_count(); ++u) {
    std::string where = fmt::format("site {}", u % content_.site_count());
    const std::vector<double> values = content_.values_at(u / content_.site_count());
    for (std::size_t k = 0; k < values.size(); ++k) {
      where += fmt::format(", {} {:.6g}", content_.parameters[k].name, values[k]);
    }
    for (int l = 0; l < L; ++l) {
      text += fmt::format("<Grid Name=\"{}, level {:.6g}\">\n<Time Value=\"{}\"/>\n{}", where,
                          content_.levels[l + 1], time++, geometry);
      for (const StoredField& field : content_.fields) {
        const int c = field.components;
        text += fmt::format(
            "<Attribute Name=\"{0}\" AttributeType=\"{1}\" Center=\"Node\">"
            "<DataItem ItemType=\"HyperSlab\" Dimensions=\"{2} {3}\">"
            "<DataItem Dimensions=\"3 3\" Format=\"XML\">{4} 0 0 1 1 1 1 {2} {3}</DataItem>"
            "<DataItem Dimensions=\"{5} {2} {3}\" NumberType=\"Float\" Precision=\"4\" "
            "Format=\"HDF\">{6}:/{0}</DataItem></DataItem></Attribute>\n",
            field.name,
            c == 1   ? "Scalar"
            : c == 3 ? "Vector"
                     : "Matrix",
            N, c, l, L, unit_file(u).filename().string());
      }
      text += "</Grid>\n";
    }
  }
  return text + "</Grid>\n</Domain>\n</Xdmf>\n";
}

}  // namespace palpable

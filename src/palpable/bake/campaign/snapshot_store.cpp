#include "palpable/bake/campaign/snapshot_store.h"

#include "palpable/bake/campaign/store_content_file.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/markup_text.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/body_file/hdf5_tools.h"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <new>
#include <string_view>
#include <system_error>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using Eigen::Index;
using hdf5::Handle;
using hdf5::Trouble;

constexpr std::string_view kRemedy = "bake it again";
constexpr hdf5::ImageKind kUnitKind{"palpable snapshots", kSnapshotLayout,
                                    "a snapshot file of Palpable", kRemedy};
constexpr hdf5::ImageKind kLinearKind{"palpable linear responses", kSnapshotLayout,
                                      "linear responses", kRemedy};
constexpr hdf5::ImageKind kCampaignKind{"palpable campaign", kSnapshotLayout,
                                        "a campaign of Palpable", kRemedy};
constexpr const char* kCampaignFile = "campaign.h5";
constexpr const char* kXdmfFile = "campaign.xdmf";

// Runs `work` and turns its exceptions into Errors that name the file.
template <class Work>
auto about(const fs::path& file, Work&& work) {
  try {
    return work();
  } catch (const Trouble& trouble) {
    throw Error(fmt::format("{}: {}", file.string(), trouble.what));
  } catch (const fs::filesystem_error& error) {
    throw Error(fmt::format("{}: {}", file.string(), error.code().message()));
  } catch (const std::bad_alloc&) {
    throw Error(fmt::format("{}: needs more memory than there is", file.string()));
  }
}

// Whether a file is an unfinished one of this campaign or an earlier one. Other files are the
// user's.
bool is_unfinished(std::string_view name) {
  const std::size_t part = name.find(".part-");
  if (part == std::string_view::npos) return false;
  const std::string_view whole = name.substr(0, part);
  if (whole == kCampaignFile || whole == kXdmfFile) return true;
  return whole.ends_with(".h5") && (whole.starts_with("site_") || whole.starts_with("point_") ||
                                    whole.starts_with("linear_"));
}

// Throws where the folder holds files that are not a store's. Temporary files are allowed: another
// process may be writing its first one.
void refuse_foreign(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().filename().string().find(".part-") != std::string::npos) continue;
    if (entry.path().filename() == kCampaignFile) continue;
    throw Trouble{
        "the folder holds something else than snapshots; empty it or choose another name"};
  }
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
    const auto rest = hdf5::read_table<double>(file, "rest");
    hdf5::require(rest.columns == 3, "'rest' does not have three components");
    unit.rest =
        Eigen::Map<const Eigen::Matrix3Xd>(rest.data.data(), 3, static_cast<Index>(rest.rows));
  }
  return unit;
}

// Whether a file is there with these bytes. One of another size is not read.
bool has_bytes(const fs::path& file, std::string_view bytes) {
  std::error_code error;
  return fs::is_regular_file(file, error) && fs::file_size(file, error) == bytes.size() &&
         hdf5::all_bytes(file) == bytes;
}

// Opens a file whose checksum has been verified before.
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

std::uint64_t campaign_key(const StoreContent& content) {
  Digest digest;
  for (const std::uint64_t key : content.keys) digest.add(key);
  digest.add(content.linear_key);
  return digest.value();
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
    const std::lock_guard turn(hdf5::turn());
    const hdf5::Quiet quiet;
    const std::string bytes = hdf5::image_of(kCampaignKind.kind, kSnapshotLayout,
                                             [&](hid_t h) { write_content(h, content); });
    if (!has_bytes(file, bytes)) { hdf5::write_durably(file, bytes, own_part_suffix()); }
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
    const std::lock_guard turn(hdf5::turn());
    const hdf5::Quiet quiet;
    const hdf5::Image image(hdf5::image_bytes(file, kCampaignKind), kCampaignKind);
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
    const std::string bytes = hdf5::image_bytes(file, kUnitKind);
    const std::lock_guard turn(hdf5::turn());
    const hdf5::Quiet quiet;
    const hdf5::Image image(bytes, kUnitKind);
    const std::string key = hdf5::read_text(image.file(), "key");
    if (key != key_text(content_.keys[unit])) {
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
      const std::lock_guard turn(hdf5::turn());
      const hdf5::Quiet quiet;
      bytes = hdf5::image_of(kUnitKind.kind, kSnapshotLayout, [&](hid_t h) {
        hdf5::write_text(h, "key", key_text(content_.keys[unit]));
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
    hdf5::write_durably(file, bytes, own_part_suffix());
  });
}

void SnapshotStore::copy_from(const SnapshotStore& other, int unit) const {
  about(unit_file(unit), [&] {
    hdf5::write_durably(unit_file(unit), hdf5::all_bytes(other.unit_file(unit)), own_part_suffix());
  });
}

StoredUnit SnapshotStore::unit(int unit) const {
  return about(unit_file(unit), [&] {
    const std::lock_guard turn(hdf5::turn());
    const hdf5::Quiet quiet;
    const Handle file = open_checked(unit_file(unit));
    return read_unit(file);
  });
}

Eigen::MatrixXf SnapshotStore::rows(int unit, const StoredField& field, Index first,
                                    Index count) const {
  return about(unit_file(unit), [&] {
    const std::lock_guard turn(hdf5::turn());
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
    // Reads the whole nodes that contain the requested rows.
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
    const std::string bytes = hdf5::image_bytes(linear_file(k), kLinearKind);
    const std::lock_guard turn(hdf5::turn());
    const hdf5::Quiet quiet;
    const hdf5::Image image(bytes, kLinearKind);
    return hdf5::read_text(image.file(), "key") == key_text(content_.linear_key);
  } catch (const Trouble&) { return false; }
}

void SnapshotStore::write_linear(int k, const Eigen::MatrixXf& responses) const {
  about(linear_file(k), [&] {
    std::string bytes;
    {
      const std::lock_guard turn(hdf5::turn());
      const hdf5::Quiet quiet;
      bytes = hdf5::image_of(kLinearKind.kind, kSnapshotLayout, [&](hid_t h) {
        hdf5::write_text(h, "key", key_text(content_.linear_key));
        const int* first = content_.linear.data() + std::ptrdiff_t{k} * kLinearRow;
        hdf5::write_table(h, "vertex", first, static_cast<hsize_t>(responses.cols()), 1);
        hdf5::write_block(h, "displacement", responses.data(),
                          {static_cast<hsize_t>(responses.cols()),
                           static_cast<hsize_t>(responses.rows()) / 3, 3});
      });
    }
    hdf5::write_durably(linear_file(k), bytes, own_part_suffix());
  });
}

Eigen::MatrixXf SnapshotStore::linear(int k) const {
  return about(linear_file(k), [&] {
    const std::lock_guard turn(hdf5::turn());
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
    hdf5::write_durably(linear_file(k), hdf5::all_bytes(other.linear_file(k)), own_part_suffix());
  });
}

void SnapshotStore::finish() const {
  const fs::path file = folder_ / kXdmfFile;
  about(file, [&] {
    const std::string text = xdmf();
    if (!has_bytes(file, text)) { hdf5::write_durably(file, text, own_part_suffix()); }
    for (const auto& entry : fs::directory_iterator(folder_)) {
      const std::string name = entry.path().filename().string();
      if (!is_unfinished(name)) continue;
      if (!is_part_of_running_process(name)) fs::remove(entry.path());
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
      where +=
          fmt::format(", {} {}", markup_text(content_.parameters[k].name), number_text(values[k]));
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
            markup_text(field.name),
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

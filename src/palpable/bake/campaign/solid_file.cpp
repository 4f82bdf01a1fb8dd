#include "palpable/bake/campaign/solid_file.h"

#include "palpable/bake/campaign/store_content_file.h"
#include "palpable/common/base/error.h"
#include "palpable/common/body_file/hdf5_tools.h"

#include <fmt/format.h>

#include <system_error>

namespace palpable {

namespace fs = std::filesystem;

namespace {

constexpr hdf5::ImageKind kSolidKind{"palpable solid", 0, "a solid of Palpable",
                                     "bake the body again"};

bool same_material(const Material& a, const Material& b) {
  return law_name(a) == law_name(b) && constants_of(a) == constants_of(b);
}

template <class A, class B>
bool same_numbers(const A& a, const B& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() && (a.array() == b.array()).all();
}

}  // namespace

fs::path solid_file_of(const fs::path& body_file) {
  return fs::path(body_file).replace_extension(".solid.h5");
}

void write_solid_file(const fs::path& file, const StoreContent& content) {
  try {
    const hdf5::Quiet quiet;
    hdf5::write_durably(file, hdf5::image_of(kSolidKind.kind, kSolidKind.layout,
                                             [&](hid_t h) { write_solid(h, content); }));
  } catch (const hdf5::Trouble& trouble) {
    throw Error(fmt::format("{}: {}", file.string(), trouble.what));
  }
}

std::optional<StoreContent> solid_beside(const fs::path& body_file, std::string_view method) {
  std::error_code error;
  if (method != kWithoutCampaign) {
    const fs::path snapshots = fs::path(body_file).replace_extension(".snapshots");
    if (!fs::is_directory(snapshots, error)) return std::nullopt;
    return SnapshotStore::open(snapshots).content();
  }
  const fs::path file = solid_file_of(body_file);
  if (!fs::exists(file, error)) return std::nullopt;
  try {
    const hdf5::Quiet quiet;
    const hdf5::Image image(hdf5::image_bytes(file, kSolidKind), kSolidKind);
    StoreContent content;
    read_solid(image.file(), content);
    return content;
  } catch (const hdf5::Trouble& trouble) {
    throw Error(fmt::format("{}: {}", file.string(), trouble.what));
  }
}

std::string solids_differ(const StoreContent& a, const StoreContent& b) {
  if (a.mesh.node_count() != b.mesh.node_count() || a.mesh.tet_count() != b.mesh.tet_count()) {
    return fmt::format("another mesh: {} nodes and {} tetrahedra instead of {} and {}",
                       a.mesh.node_count(), a.mesh.tet_count(), b.mesh.node_count(),
                       b.mesh.tet_count());
  }
  if (!same_numbers(a.mesh.nodes, b.mesh.nodes) || !same_numbers(a.mesh.tets, b.mesh.tets) ||
      !same_numbers(a.mesh.edge_nodes, b.mesh.edge_nodes)) {
    return "another mesh: as many nodes and tetrahedra, but not at the same places";
  }
  if (a.fixed != b.fixed) return "another support: other nodes of the skin are held";
  if (a.materials.empty() || b.materials.empty()) return {};
  if (a.materials.size() != b.materials.size() || a.material_of_element != b.material_of_element) {
    return "another material: other groups of elements";
  }
  for (std::size_t k = 0; k < a.materials.size(); ++k) {
    if (same_material(a.materials[k], b.materials[k])) continue;
    return fmt::format("another material: {} with the constants {} instead of {} with {}",
                       law_name(a.materials[k]), fmt::join(constants_of(a.materials[k]), ", "),
                       law_name(b.materials[k]), fmt::join(constants_of(b.materials[k]), ", "));
  }
  return {};
}

}  // namespace palpable

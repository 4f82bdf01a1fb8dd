#include "palpable/bake/campaign/import_snapshots.h"

#include "palpable/bake/campaign/fill_store.h"
#include "palpable/bake/describe/body_problem.h"
#include "palpable/bake/mesh/field_files.h"
#include "palpable/bake/mesh/volume_mesh.h"
#include "palpable/bake/solid/stress.h"
#include "palpable/common/base/bounded_text.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/nearest_word.h"
#include "palpable/common/base/quantity.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/base/whole_file.h"
#include "palpable/common/geometry/size_text.h"
#include "palpable/common/toml/toml_section.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <unordered_map>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;

double unit_of(TomlSection& section, const std::string& name) {
  static const std::map<std::string, double> pressures{
      {"Pa", 1}, {"kPa", 1e3}, {"MPa", 1e6}, {"GPa", 1e9}};
  if (name == "displacement") {
    return length_unit(section.choice("unit", length_unit_names(), "m")).value();
  }
  if (name == "stress") {
    return pressures.at(section.choice("unit", {"Pa", "kPa", "MPa", "GPa"}, "Pa"));
  }
  if (section.has("unit")) {
    section.bad("unit", "is known for displacement and stress; other fields are taken as they are");
  }
  return 1;
}

ImportManifest::Field read_field(TomlSection& section) {
  ImportManifest::Field field;
  field.place = section.place();
  field.name = section.text("name");
  if (field.name.find('/') != std::string::npos || field.name == "rest" ||
      field.name == "press_depth") {
    section.bad("name",
                fmt::format("is '{}', which means something else in the store", field.name));
  }
  field.from = section.has("from") ? section.texts("from") : std::vector{field.name};
  field.unit = unit_of(section, field.name);
  section.refuse_unknown();
  return field;
}

std::map<std::string, double> read_at(TomlSection section, const BodyDescription& body) {
  std::map<std::string, double> at;
  for (const BodyDescription::Parameter& parameter : body.parameters) {
    at[parameter.name] = section.number(parameter.name.c_str(), {-1e300, 1e300});
  }
  section.refuse_unknown();
  return at;
}

ImportManifest::Snapshot read_snapshot(TomlSection& section, const BodyDescription& body,
                                       const std::vector<ImportManifest::Field>& fields) {
  ImportManifest::Snapshot snapshot;
  snapshot.place = section.place();
  snapshot.site = section.integer("site", 0, 1'000'000);
  snapshot.level = section.number("level", {0.0, 1.0, true}, 1.0);
  if (section.has("force")) {
    snapshot.force = section.quantity("force", Quantity::kForce, {0.0, 1e9, true});
  }
  if (section.has("at") || !body.parameters.empty()) {
    snapshot.at = read_at(section.section("at"), body);
  }
  if (section.has("file") == section.has("files")) {
    throw Error(
        fmt::format("{} needs either 'file' (with all fields) or 'files' (one for each "
                    "field)",
                    section.place()));
  }
  if (section.has("file")) {
    snapshot.file = section.text("file");
  } else {
    TomlSection files = section.section("files");
    for (const ImportManifest::Field& field : fields) {
      snapshot.files[field.name] = files.text(field.name.c_str());
    }
    files.refuse_unknown();
  }
  section.refuse_unknown();
  return snapshot;
}

// Finds the row of a file for each node of the body.
class NodeMatch {
 public:
  NodeMatch(const VolumeMesh& volume) : volume_(volume) {
    for (std::size_t i = 0; i < volume.numbers.size(); ++i) {
      node_of_[volume.numbers[i]] = static_cast<int>(i);
      sorted_.push_back(volume.numbers[i]);
    }
    std::sort(sorted_.begin(), sorted_.end());
  }

  // (N) for each node of the mesh, its row in the file.
  [[nodiscard]] std::vector<Index> rows(const NodalFile& file, Index count,
                                        const std::string& name) const {
    const int N = volume_.mesh.node_count();
    std::vector<Index> row(N, -1);
    for (Index i = 0; i < count; ++i) {
      std::int64_t number = 0;
      if (!file.numbers.empty()) {
        number = file.numbers[i];
      } else if (count == N) {
        number = sorted_[i];
      } else {
        number = i + (sorted_.front() > 0 ? 1 : 0);  // a row for every node, also unused ones
      }
      const auto at = node_of_.find(number);
      if (at != node_of_.end()) row[at->second] = i;
    }
    if (file.points.cols() > 0 && !fits(file, row)) row = by_position(file, name);
    const auto lost = std::find(row.begin(), row.end(), -1);
    if (lost != row.end()) {
      throw Error(
          fmt::format("{}: has nothing for node {} of the mesh; it has {} rows, the mesh {} "
                      "nodes",
                      name, volume_.numbers[lost - row.begin()], count, N));
    }
    return row;
  }

 private:
  [[nodiscard]] double near() const {
    const Matrix3Xd& X = volume_.mesh.nodes;
    return 1e-5 * extent_of(X).norm();
  }
  [[nodiscard]] bool fits(const NodalFile& file, const std::vector<Index>& row) const {
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (row[i] < 0) return false;
      const auto node = static_cast<Index>(i);
      if (!((file.points.col(row[i]) - volume_.mesh.nodes.col(node)).norm() <= near()))
        return false;
    }
    return true;
  }
  [[nodiscard]] std::vector<Index> by_position(const NodalFile& file,
                                               const std::string& name) const {
    using Cell = std::array<std::int64_t, 3>;
    const double size = 4.0 * near();
    const auto cell_of = [&](const Eigen::Vector3d& x) {
      return Cell{std::llround(x[0] / size), std::llround(x[1] / size), std::llround(x[2] / size)};
    };
    std::map<Cell, std::vector<Index>> cells;
    for (Index i = 0; i < file.points.cols(); ++i) {
      cells[cell_of(file.points.col(i))].push_back(i);
    }
    std::vector<Index> row;
    for (Index n = 0; n < volume_.mesh.nodes.cols(); ++n) {
      const Eigen::Vector3d X = volume_.mesh.nodes.col(n);
      const Cell middle = cell_of(X);
      Index best = -1;
      double distance = near();
      for (int k = 0; k < 27; ++k) {
        const auto cell =
            cells.find({middle[0] + k % 3 - 1, middle[1] + k / 3 % 3 - 1, middle[2] + k / 9 - 1});
        if (cell == cells.end()) continue;
        for (const Index i : cell->second) {
          const double d = (file.points.col(i) - X).norm();
          if (d <= distance) {
            best = i;
            distance = d;
          }
        }
      }
      if (best < 0) {
        throw Error(
            fmt::format("{}: has no point at ({:.6g}, {:.6g}, {:.6g}), where the mesh has a "
                        "node: results on another mesh, or in another unit?",
                        name, X[0], X[1], X[2]));
      }
      row.push_back(best);
    }
    return row;
  }

  const VolumeMesh& volume_;
  std::unordered_map<std::int64_t, int> node_of_;
  std::vector<std::int64_t> sorted_;
};

// (c x n) the values of a manifest's field.
MatrixXd values_of(const NodalFile& file, const ImportManifest::Field& field,
                   const std::string& name) {
  std::vector<const MatrixXd*> parts;
  Index rows = 0;
  for (const std::string& from : field.from) {
    const MatrixXd* found = nullptr;
    for (const NodalFile::Field& f : file.fields) {
      if (f.name == from || (f.name.empty() && file.fields.size() == 1)) found = &f.values;
    }
    if (found == nullptr) {
      std::vector<std::string> names;
      for (const NodalFile::Field& f : file.fields) names.push_back(f.name);
      const std::string guess = nearest_word(from, names);
      throw Error(fmt::format("{}: has no field '{}' for {}; it has '{}'{}", name, from,
                              field.place, fmt::join(names, "', '"),
                              guess.empty() ? "" : fmt::format("; did you mean '{}'?", guess)));
    }
    parts.push_back(found);
    rows += found->rows();
  }
  MatrixXd values(rows, parts[0]->cols());
  Index at = 0;
  for (const MatrixXd* part : parts) {
    values.middleRows(at, part->rows()) = *part;
    at += part->rows();
  }
  // A full 3 x 3 tensor, row by row, as in VTK's files.
  if (field.name == "stress" && rows == 9) {
    values = MatrixXd(values(std::vector<int>{0, 4, 8, 1, 5, 2}, Eigen::all));
  }
  const Index needed = field.name == "displacement" ? 3 : field.name == "stress" ? 6 : 0;
  if (needed > 0 && values.rows() != needed) {
    throw Error(fmt::format("{}: '{}' has {} components, {} needs {}", name,
                            fmt::join(field.from, "', '"), values.rows(), field.name, needed));
  }
  if (!values.allFinite()) {
    throw Error(fmt::format("{}: '{}' holds values that are not numbers", name,
                            fmt::join(field.from, "', '")));
  }
  return field.unit * values;
}

// Rotates values into the body frame: `up` becomes Z by a cyclic permutation of the axes, as in
// place_in_body_frame().
void turn_up(MatrixXd& values, const std::string& field, UpAxis up) {
  const int first = up == UpAxis::kX ? 1 : up == UpAxis::kY ? 2 : 0;
  const MatrixXd given = values;
  if (field == "displacement") {
    for (int k = 0; k < 3; ++k) values.row(k) = given.row((first + k) % 3);
  } else if (field == "stress") {
    for (int k = 0; k < 3; ++k) {
      values.row(k) = given.row((first + k) % 3);
      values.row(3 + k) = given.row(3 + (first + k) % 3);  // xy yz zx permute as x y z do
    }
  }
}

struct Reader {
  const fs::path& folder;
  const ImportManifest& manifest;
  const NodeMatch& match;
  UpAxis up;

  // One (c x N) table for each field of the manifest.
  [[nodiscard]] std::vector<MatrixXd> read(const ImportManifest::Snapshot& snapshot) const {
    std::vector<MatrixXd> all;
    NodalFile file;
    if (!snapshot.file.empty()) file = open(snapshot, snapshot.file);
    for (const ImportManifest::Field& field : manifest.fields) {
      const fs::path path =
          snapshot.file.empty() ? fs::path(snapshot.files.at(field.name)) : snapshot.file;
      if (snapshot.file.empty()) file = open(snapshot, path);
      const MatrixXd values = values_of(file, field, (folder / path).string());
      const std::vector<Index> rows = match.rows(file, values.cols(), (folder / path).string());
      MatrixXd mine = values(Eigen::all, rows);
      turn_up(mine, field.name, up);
      all.push_back(std::move(mine));
    }
    return all;
  }

 private:
  [[nodiscard]] NodalFile open(const ImportManifest::Snapshot& snapshot,
                               const fs::path& path) const {
    try {
      return read_nodal_file(folder / path);
    } catch (const Error& error) {
      throw Error(fmt::format("{}: {}", snapshot.place, error.what()));
    }
  }
};

// The index of each snapshot in the manifest: [unit][level].
std::vector<std::vector<int>> arrange(const ImportManifest& manifest, const StoreContent& content) {
  const int S = content.site_count(), L = content.level_count();
  std::size_t P = 1;
  for (const StoredParameter& p : content.parameters)
    P *= static_cast<std::size_t>(p.values.size());
  std::vector<std::vector<int>> at(P * static_cast<std::size_t>(S),
                                   std::vector<int>(static_cast<std::size_t>(L), -1));
  for (std::size_t k = 0; k < manifest.snapshots.size(); ++k) {
    const ImportManifest::Snapshot& snapshot = manifest.snapshots[k];
    if (snapshot.site >= S) {
      throw Error(fmt::format("{}: site {} where {} has sites 0 to {}", snapshot.place,
                              snapshot.site, manifest.body.filename().string(), S - 1));
    }
    Index point = 0;
    for (const StoredParameter& p : content.parameters) {
      Index j = 0;
      const double value = snapshot.at.at(p.name);
      if (!((p.values.array() - value).abs().minCoeff(&j) <= 1e-9 * std::abs(value))) {
        throw Error(fmt::format("{}: '{}' has no value {} in {}", snapshot.place, p.name,
                                number_text(value), manifest.body.filename().string()));
      }
      point = point * p.values.size() + j;
    }
    Index l = 0;
    (content.levels.array() - snapshot.level).abs().minCoeff(&l);
    int& slot = at[point * S + snapshot.site][l - 1];
    if (slot >= 0) {
      throw Error(fmt::format("{}: the same site and level as {}", snapshot.place,
                              manifest.snapshots[slot].place));
    }
    slot = static_cast<int>(k);
  }
  for (std::size_t u = 0; u < at.size(); ++u) {
    for (std::size_t l = 0; l < at[u].size(); ++l) {
      if (at[u][l] >= 0) continue;
      throw Error(
          fmt::format("{}: no snapshot of site {} at level {:.6g}{}; a campaign has all "
                      "sites at all levels",
                      manifest.source.string(), u % static_cast<std::size_t>(S),
                      content.levels[static_cast<Index>(l) + 1],
                      P > 1 ? fmt::format(", point {}", u / static_cast<std::size_t>(S)) : ""));
    }
  }
  return at;
}

// All levels, increasing, with 0 (rest) and 1 (full load).
Eigen::VectorXd levels_of(const ImportManifest& manifest) {
  std::set<double> levels{0.0, 1.0};
  for (const ImportManifest::Snapshot& s : manifest.snapshots) levels.insert(s.level);
  Eigen::VectorXd sorted(static_cast<Index>(levels.size()));
  std::copy(levels.begin(), levels.end(), sorted.begin());
  return sorted;
}

// Indices of the manifest's fields in the order of a store: displacement, stress, others.
std::vector<std::size_t> fields_in_store_order(const ImportManifest& manifest) {
  const auto rank = [&](std::size_t k) {
    const std::string& name = manifest.fields[k].name;
    return name == "displacement" ? 0 : name == "stress" ? 1 : 2;
  };
  std::vector<std::size_t> sorted(manifest.fields.size());
  for (std::size_t k = 0; k < sorted.size(); ++k) sorted[k] = k;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
  return sorted;
}

struct ImportedUnit {
  SiteSnapshots site;
  std::vector<Eigen::MatrixXf> others;  // fields that are neither displacement nor stress
};

// Reads the snapshots of one site at one point.
struct UnitReader {
  const StoreContent& content;
  const ImportManifest& manifest;
  const Reader& reader;
  const std::vector<std::vector<int>>& order;
  const std::vector<std::size_t>& sorted;  // content.fields[j] is manifest.fields[sorted[j]]
  const BodyProblem& problem;
  const std::vector<HeldComponent>& held;
  const std::vector<std::int64_t>& numbers;  // of the nodes in the mesh's file

  [[nodiscard]] ImportedUnit read(std::size_t u) const {
    const Index L = content.level_count();
    const Matrix3Xd unit = unit_load(content.sites[u % content.sites.size()], problem.mesh.boundary,
                                     content.mesh.node_count());
    ImportedUnit result = empty_unit();
    for (Index l = 0; l < L; ++l) {
      const ImportManifest::Snapshot& snapshot = manifest.snapshots[order[u][l]];
      add_level(snapshot, l, unit, result);
      require_deeper(snapshot, l, result.site.press_depth);
      if (l + 1 < L) continue;
      if (!(snapshot.force > 0.0)) {
        throw Error(
            fmt::format("{}: needs 'force', the load on the patch at level 1", snapshot.place));
      }
      result.site.full_load = snapshot.force;
    }
    result.site.outcome.press = result.site.press_depth[L];
    return result;
  }

 private:
  [[nodiscard]] ImportedUnit empty_unit() const {
    const Index N = content.mesh.node_count(), L = content.level_count();
    ImportedUnit unit;
    unit.site.press_depth = Eigen::VectorXd::Zero(L + 1);
    unit.site.displacement.resize(3 * N, L);
    for (const StoredField& field : content.fields) {
      if (field.name == "stress") {
        unit.site.stress.resize(6 * N, L);
      } else if (field.name != "displacement") {
        unit.others.emplace_back(field.components * N, L);
      }
    }
    return unit;
  }

  // @param unit  (3 x N) the site's load of 1 N
  void add_level(const ImportManifest::Snapshot& snapshot, Index l, const Matrix3Xd& unit,
                 ImportedUnit& result) const {
    SiteSnapshots& site = result.site;
    const std::vector<MatrixXd> values = reader.read(snapshot);
    std::size_t other = 0;
    for (std::size_t j = 0; j < sorted.size(); ++j) {
      const MatrixXd& v = values[sorted[j]];
      const StoredField& field = content.fields[j];
      if (v.rows() != field.components) {
        throw Error(fmt::format("{}: '{}' has {} components, in the first snapshot {}",
                                snapshot.place, field.name, v.rows(), field.components));
      }
      if (field.name == "displacement") {
        refuse_moved_support(held, v, numbers, snapshot.place);
        refuse_far_displacement(held, v, problem.press_range, snapshot.place);
        site.displacement.col(l) = v.reshaped().cast<float>();
        site.press_depth[l + 1] = unit.cwiseProduct(v).sum();
      } else if (field.name == "stress") {
        site.stress.col(l) = v.reshaped().cast<float>();
        const StressField skin = v(Eigen::all, problem.mesh.boundary.node_of_vertex);
        site.largest_von_mises = std::max(site.largest_von_mises, von_mises(skin).maxCoeff());
      } else {
        result.others[other++].col(l) = v.reshaped().cast<float>();
      }
    }
  }

  static void require_deeper(const ImportManifest::Snapshot& snapshot, Index l,
                             const Eigen::VectorXd& depth) {
    if (depth[l + 1] > depth[l]) return;
    throw Error(fmt::format(
        "{}: at level {:.6g} the patch of site {} has moved {:.4g} m along its load, not more "
        "than the {:.4g} m of the level before: are site, direction, unit and 'up' right?",
        snapshot.place, snapshot.level, snapshot.site, depth[l + 1], depth[l]));
  }
};

// @param values  one table for each field of the manifest
// @param full  the snapshot that is judged; it is read if there is something to judge
StressJudgement judge_fields(const SolidModel& model, const ImportManifest& manifest,
                             const StoreContent& content, const Reader& reader,
                             const ImportManifest::Snapshot& full) {
  if (!content.parameters.empty()) {
    return {"stress was not judged against the law, whose parameters vary"};
  }
  const auto field = [&](const char* name) {
    const auto found =
        std::find_if(manifest.fields.begin(), manifest.fields.end(),
                     [&](const ImportManifest::Field& one) { return one.name == name; });
    return static_cast<std::size_t>(found - manifest.fields.begin());
  };
  const std::size_t stress = field("stress");
  if (stress == manifest.fields.size()) return {"there is no stress to judge"};
  const std::vector<MatrixXd> values = reader.read(full);
  return judge_stress(model, values[field("displacement")], values[stress]);
}

// Imported snapshots have no known inputs, so their key is a hash of their values.
std::uint64_t key_of(const TetMesh& mesh, const ImportedUnit& unit, int number) {
  Digest digest;
  digest.add(std::string("imported"));
  digest.add(mesh.nodes);
  digest.add(unit.site.displacement);
  digest.add(unit.site.stress);
  for (const Eigen::MatrixXf& other : unit.others) digest.add(other);
  digest.add(unit.site.full_load);
  digest.add(number);
  return digest.value();
}

}  // namespace

ImportManifest read_import_manifest(const fs::path& path) {
  const std::string file = path.string();
  const Result<std::string> text = read_text_file(path, {.most = longest_text(Notation::kToml)});
  if (!text) throw Error(fmt::format("{}: {}", file, text.problem().message));
  const toml::table table = parse_toml(text.value(), file);
  ImportManifest manifest;
  manifest.source = path;
  TomlSection root(file, "", table);
  manifest.body = root.text("body");
  if (manifest.body.is_relative()) manifest.body = path.parent_path() / manifest.body;
  const BodyDescription body = read_body_description(manifest.body);
  for (TomlSection& section : root.sections("field")) {
    manifest.fields.push_back(read_field(section));
  }
  const auto displacement =
      std::find_if(manifest.fields.begin(), manifest.fields.end(),
                   [](const ImportManifest::Field& f) { return f.name == "displacement"; });
  if (displacement == manifest.fields.end()) {
    throw Error(fmt::format("{}: needs a [[field]] with name = \"displacement\"", file));
  }
  for (TomlSection& section : root.sections("snapshot")) {
    manifest.snapshots.push_back(read_snapshot(section, body, manifest.fields));
  }
  if (manifest.snapshots.empty()) throw Error(fmt::format("{}: needs a [[snapshot]]", file));
  root.refuse_unknown();
  return manifest;
}

ImportedStore import_snapshots(const fs::path& folder, const ImportManifest& manifest,
                               const fs::path& output, const Progress& progress) {
  const BodyDescription description = read_body_description(manifest.body);
  if (!description.shape.is_volume()) {
    throw Error(
        fmt::format("{}: snapshots belong to a mesh: its [shape] needs 'mesh', not "
                    "'surface'",
                    manifest.body.string()));
  }
  const VolumeMesh volume = value_or_throw(read_volume_file(description.shape.file));
  const BodyProblem problem = pose_body(description);
  if (problem.mesh.mesh.node_count() != volume.mesh.node_count()) {
    throw Error(fmt::format("{}: 'order' makes other nodes than the file has: leave it out",
                            manifest.body.string()));
  }
  StoreContent content = content_of(description, problem);
  content.levels = levels_of(manifest);
  if (content.level_count() < 1)
    throw Error(fmt::format("{}: there are no levels", manifest.source.string()));
  const std::vector<std::vector<int>> order = arrange(manifest, content);

  const NodeMatch match(volume);
  const Reader reader{folder, manifest, match, description.shape.up};
  const std::vector<std::size_t> sorted = fields_in_store_order(manifest);
  const std::vector<MatrixXd> first = reader.read(manifest.snapshots[0]);
  content.fields.clear();
  for (const std::size_t k : sorted) {
    content.fields.push_back({manifest.fields[k].name, static_cast<int>(first[k].rows())});
  }
  content.provenance.snapshots = fmt::format(
      "imported by {}, {} files", manifest.source.filename().string(), manifest.snapshots.size());

  const std::vector<HeldComponent> held = held_components(problem.model);
  const UnitReader units{content, manifest, reader, order, sorted, problem, held, volume.numbers};
  const auto show = [&](std::size_t read) {  // each unit is read twice
    report(progress, {"reading snapshots", static_cast<double>(read),
                      2.0 * static_cast<double>(order.size()), ""});
  };
  StoreContent keyed = content;
  for (std::size_t u = 0; u < order.size(); ++u) {
    show(u);
    keyed.keys.push_back(key_of(content.mesh, units.read(u), static_cast<int>(u)));
  }
  std::optional<SetAside> set_aside = set_aside_other_campaign(output, keyed);
  SnapshotStore store = SnapshotStore::create(output, std::move(keyed));
  for (std::size_t u = 0; u < order.size(); ++u) {
    show(order.size() + u);
    if (store.has(static_cast<int>(u))) continue;
    const ImportedUnit unit = units.read(u);
    store.write(static_cast<int>(u), unit.site, Matrix3Xd(3, 0), unit.others);
  }
  report(progress, {"reading snapshots", 1.0, 1.0, ""});
  store.finish();
  const ImportManifest::Snapshot& full = manifest.snapshots[order[0].back()];
  return {std::move(store), std::move(set_aside),
          judge_fields(problem.model, manifest, content, reader, full)};
}

}  // namespace palpable

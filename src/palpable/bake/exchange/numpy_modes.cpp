#include "palpable/bake/exchange/foreign_modes.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/npy_file.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/whole_file.h"

#include <fmt/format.h>

#include <cmath>
#include <sstream>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using Eigen::Index;

constexpr std::uintmax_t kLongestNames = 1'000'000;  // bytes of parameters.txt

// The file's values as a matrix; each of its columns is one row of the file.
template <class Matrix>
void write_matrix(const fs::path& path, const Matrix& columns, std::size_t per_entry = 1) {
  using Scalar = typename Matrix::Scalar;
  const auto rows = static_cast<std::size_t>(columns.cols());
  const auto size = static_cast<std::size_t>(columns.rows());
  const std::vector<std::size_t> shape =
      per_entry == 1 ? std::vector{rows, size} : std::vector{rows, size / per_entry, per_entry};
  write_npy(path, shape, std::span<const Scalar>(columns.data(), rows * size));
}

Eigen::MatrixXd read_columns(const fs::path& path) {
  const NpyArray array = read_npy(path);
  if (array.shape.empty() || array.values.empty()) {
    throw Error(fmt::format("{}: holds no table", path.string()));
  }
  const auto rows = static_cast<Index>(array.shape[0]);
  return Eigen::Map<const Eigen::MatrixXd>(array.values.data(),
                                           static_cast<Index>(array.values.size()) / rows, rows);
}

void write_field(const fs::path& folder, const char* name, const SeparatedField& field,
                 std::size_t components) {
  write_matrix(folder / fmt::format("{}_modes.npy", name), field.modes(), components);
  for (std::size_t j = 0; j < field.axes().size(); ++j) {
    write_matrix(folder / fmt::format("{}_functions_{}.npy", name, j), field.axes()[j].functions);
  }
}

SeparatedField read_field(const fs::path& folder, const char* name,
                          std::vector<ParameterAxis> axes) {
  const fs::path file = folder / fmt::format("{}_modes.npy", name);
  const Eigen::MatrixXd modes = read_columns(file);
  for (std::size_t j = 0; j < axes.size(); ++j) {
    const fs::path functions = folder / fmt::format("{}_functions_{}.npy", name, j);
    axes[j].functions = read_columns(functions);
    if (axes[j].functions.rows() != axes[j].samples.size() ||
        axes[j].functions.cols() != modes.cols()) {
      throw Error(fmt::format("{}: {} x {} where {} modes x {} samples are needed",
                              functions.string(), axes[j].functions.cols(),
                              axes[j].functions.rows(), modes.cols(), axes[j].samples.size()));
    }
    if (!axes[j].functions.allFinite()) {
      throw Error(fmt::format("{}: is not a number somewhere", functions.string()));
    }
  }
  if (!is_single_precision(modes)) {
    throw Error(fmt::format("{}: is not a number somewhere, or above 1e30", file.string()));
  }
  return {modes.cast<float>(), std::move(axes)};
}

// The vertices or the triangles, or the loads of the sites.
Eigen::MatrixXd read_triples(const fs::path& path) {
  Eigen::MatrixXd columns = read_columns(path);
  if (columns.rows() != 3 || !columns.allFinite()) {
    throw Error(fmt::format("{}: must hold three numbers for each entry", path.string()));
  }
  return columns;
}

SurfaceMesh read_surface(const fs::path& folder) {
  const Eigen::MatrixXd vertices = read_triples(folder / "vertices.npy");
  const Eigen::MatrixXd triangles = read_triples(folder / "triangles.npy");
  if (!(triangles.minCoeff() >= 0) || !(triangles.maxCoeff() < double(vertices.cols()))) {
    throw Error(
        fmt::format("{}: names a vertex that is not there", (folder / "triangles.npy").string()));
  }
  return {vertices, triangles.cast<int>()};
}

// Increasing samples of a parameter.
Eigen::VectorXd read_samples(const fs::path& file) {
  const NpyArray array = read_npy(file);
  const Eigen::VectorXd samples = Eigen::Map<const Eigen::VectorXd>(
      array.values.data(), static_cast<Index>(array.values.size()));
  for (Index k = 0; k < samples.size(); ++k) {
    if (std::isfinite(samples[k]) && (k == 0 || samples[k - 1] < samples[k])) continue;
    throw Error(fmt::format("{}: samples must increase", file.string()));
  }
  if (samples.size() == 0) throw Error(fmt::format("{}: has no samples", file.string()));
  return samples;
}

// The parameters with their samples, without functions.
std::vector<ParameterAxis> read_parameters(const fs::path& folder) {
  const std::string file = (folder / "parameters.txt").string();
  const Result<std::string> text = read_text_file(file, {.most = kLongestNames});
  if (!text) throw Error(fmt::format("{}: {}", file, text.problem().message));
  std::istringstream names(text.value());
  std::vector<ParameterAxis> axes;
  for (std::string line; std::getline(names, line);) {
    std::istringstream words(line);
    ParameterAxis axis;
    std::string kind;
    if (!(words >> axis.name >> kind)) continue;
    if (kind != "choice" && kind != "quantity") {
      throw Error(fmt::format("{}: '{}' is neither 'choice' nor 'quantity'", file, kind));
    }
    axis.between = kind == "choice" ? Between::kNothing : Between::kSmooth;
    axis.samples = read_samples(folder / fmt::format("samples_{}.npy", axes.size()));
    axes.push_back(std::move(axis));
  }
  if (axes.empty() || axes.size() > SeparatedField::kMostAxes) {
    throw Error(fmt::format("{}: must name 1 to {} parameters, each with 'choice' or 'quantity'",
                            file, SeparatedField::kMostAxes));
  }
  return axes;
}

}  // namespace

void write_numpy_modes(const fs::path& folder, const ForeignModes& modes) {
  make_folder(folder);
  write_matrix(folder / "vertices.npy", modes.surface.vertices);
  write_matrix(folder / "triangles.npy", modes.surface.triangles);
  std::string names;
  const std::vector<ParameterAxis>& axes = modes.displacement.axes();
  for (std::size_t j = 0; j < axes.size(); ++j) {
    names += axes[j].name;
    names += axes[j].between == Between::kNothing ? " choice\n" : " quantity\n";
    write_npy(folder / fmt::format("samples_{}.npy", j),
              {static_cast<std::size_t>(axes[j].samples.size())},
              std::span<const double>(axes[j].samples.data(),
                                      static_cast<std::size_t>(axes[j].samples.size())));
  }
  write_whole_file(folder / "parameters.txt", names);
  write_field(folder, "displacement", modes.displacement, 3);
  if (modes.stress) write_field(folder, "stress", *modes.stress, 6);
  if (modes.site_vertices.empty()) return;
  write_npy(folder / "site_vertices.npy", {modes.site_vertices.size()},
            std::span<const int>(modes.site_vertices));
  write_matrix(folder / "site_loads.npy", modes.site_loads);
}

ForeignModes read_numpy_modes(const fs::path& folder) {
  SurfaceMesh surface = read_surface(folder);
  const std::vector<ParameterAxis> axes = read_parameters(folder);
  ForeignModes modes{std::move(surface), read_field(folder, "displacement", axes)};
  if (fs::exists(folder / "stress_modes.npy")) modes.stress = read_field(folder, "stress", axes);
  if (fs::exists(folder / "site_vertices.npy") && fs::exists(folder / "site_loads.npy")) {
    modes.site_vertices = vertex_numbers(read_npy(folder / "site_vertices.npy").values,
                                         (folder / "site_vertices.npy").string());
    const Eigen::MatrixXd loads = read_triples(folder / "site_loads.npy");
    if (loads.cols() != std::ssize(modes.site_vertices)) {
      throw Error(fmt::format("{}: {} loads, where site_vertices.npy has {}",
                              (folder / "site_loads.npy").string(), loads.cols(),
                              modes.site_vertices.size()));
    }
    modes.site_loads = loads;
  }
  return modes;
}

}  // namespace palpable

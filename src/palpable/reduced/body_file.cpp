#include "palpable/reduced/body_file.h"

#include "palpable/base/contract.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <fcntl.h>
#include <fstream>
#include <hdf5.h>
#include <memory>
#include <system_error>
#include <unistd.h>

namespace palpable {
namespace {

// Largest count of anything that a body file may hold: a guard against absurd sizes in a damaged
// file, far above any real body.
constexpr hsize_t kLargestCount = 200'000'000;

// A body file is an HDF5 file behind a user block, a feature of HDF5 that its tools skip. Ours is a
// short text with the size and a checksum of the whole rest. It is compared before HDF5 sees a
// byte, because HDF5 1.10 does not survive every damaged file (the fuzz test found reads of freed
// memory), and a body file must never crash its reader.
constexpr std::size_t kUserBlock = 512;
constexpr std::string_view kMagic = "palpable body file, layout ";

// What the low-level functions below throw; it never leaves this file.
struct Trouble {
  std::string what;
};

// An HDF5 identifier that closes itself.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t), const std::string& what) : id_(id), close_(close) {
    if (id < 0) throw Trouble{what};
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() { close_(id_); }
  operator hid_t() const { return id_; }  // NOLINT: stands for the identifier

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

// HDF5 prints its own error stack to stderr unless told not to; a library never prints.
class QuietHdf5 {
 public:
  QuietHdf5() {
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  QuietHdf5(const QuietHdf5&) = delete;
  QuietHdf5& operator=(const QuietHdf5&) = delete;
  ~QuietHdf5() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

template <class T>
hid_t native_type();
template <>
hid_t native_type<float>() {
  return H5T_NATIVE_FLOAT;
}
template <>
hid_t native_type<double>() {
  return H5T_NATIVE_DOUBLE;
}
template <>
hid_t native_type<int>() {
  return H5T_NATIVE_INT;
}
template <>
hid_t native_type<std::uint8_t>() {
  return H5T_NATIVE_UINT8;
}

// FNV-1a: each byte enters by an exclusive or and a multiplication, so that any one changed byte
// changes the result.
std::uint64_t checksum(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char byte : bytes) {
    hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3u;
  }
  return hash;
}

// What the user block must hold in front of `content`.
std::string user_block(std::string_view content) {
  std::string block = fmt::format("{}{}\nbytes {}\nfnv1a {:016x}\n", kMagic, kBodyFileVersion,
                                  content.size(), checksum(content));
  block.resize(kUserBlock, '\0');
  return block;
}

std::string all_bytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (!file) throw Trouble{"cannot be read"};
  return bytes;
}

void check_user_block(const std::string& bytes) {
  if (bytes.substr(0, kMagic.size()) != kMagic) throw Trouble{"not a body file of Palpable"};
  const std::string version =
      bytes.substr(kMagic.size(), bytes.find('\n', kMagic.size()) - kMagic.size());
  if (version != std::to_string(kBodyFileVersion)) {
    throw Trouble{
        fmt::format("layout version '{}' where this program reads {}; bake the body again",
                    version.substr(0, 20), kBodyFileVersion)};
  }
  if (bytes.size() <= kUserBlock || std::string_view(bytes).substr(0, kUserBlock) !=
                                        user_block(std::string_view(bytes).substr(kUserBlock))) {
    throw Trouble{"truncated or damaged (its checksum differs); copy it again or bake it again"};
  }
}

// ---- writing ---------------------------------------------------------------------------------

void check(herr_t status, const std::string& what) {
  if (status < 0) throw Trouble{what};
}

// Eigen stores columns, HDF5 rows: a (r x c) matrix is written as a dataset of c rows and r
// columns, so that each dataset row is one vertex, triangle or mode.
template <class T>
void write_table(hid_t file, const char* name, const T* data, hsize_t rows, hsize_t columns) {
  const hsize_t size[2] = {rows, columns};
  const Handle space(H5Screate_simple(2, size, nullptr), H5Sclose, "no memory");
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "no memory");
  check(H5Pset_obj_track_times(creation, false), name);  // same content, same bytes
  if (rows * columns > 0) {
    check(H5Pset_chunk(creation, 2, size), name);
    check(H5Pset_fletcher32(creation), name);  // a flipped bit is found on reading
  }
  const Handle set(
      H5Dcreate2(file, name, native_type<T>(), space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose,
      fmt::format("dataset '{}' cannot be made", name));
  if (rows * columns > 0) {
    check(H5Dwrite(set, native_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, data),
          fmt::format("dataset '{}' cannot be written", name));
  }
}

void write_text(hid_t object, const char* name, const std::string& text) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, "no memory");
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "no memory");
  check(H5Tset_size(type, std::max<std::size_t>(text.size(), 1)), name);
  check(H5Tset_strpad(type, H5T_STR_NULLPAD), name);
  check(H5Tset_cset(type, H5T_CSET_UTF8), name);
  const Handle attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                         fmt::format("attribute '{}' cannot be made", name));
  const std::string padded = text.empty() ? std::string(1, '\0') : text;
  check(H5Awrite(attribute, type, padded.data()), name);
}

void write_number(hid_t object, const char* name, double value) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, "no memory");
  const Handle attribute(
      H5Acreate2(object, name, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
      fmt::format("attribute '{}' cannot be made", name));
  check(H5Awrite(attribute, H5T_NATIVE_DOUBLE, &value), name);
}

Handle make_group(hid_t file, const char* name) {
  const Handle creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, "no memory");
  check(H5Pset_obj_track_times(creation, false), name);
  return Handle(H5Gcreate2(file, name, H5P_DEFAULT, creation, H5P_DEFAULT), H5Gclose,
                fmt::format("group '{}' cannot be made", name));
}

void write_field(hid_t file, const char* name, const SeparatedField& field) {
  const Handle group = make_group(file, name);
  const auto m = static_cast<hsize_t>(field.mode_count());
  write_table(group, "modes", field.modes().data(), m, static_cast<hsize_t>(field.value_count()));
  int number = 0;
  for (const ParameterAxis& axis : field.axes()) {
    const Handle g = make_group(group, fmt::format("axis_{}", number++).c_str());
    write_text(g, "name", axis.name);
    write_text(g, "between", axis.between == Between::kSmooth ? "smooth" : "nothing");
    const auto n = static_cast<hsize_t>(axis.samples.size());
    write_table(g, "samples", axis.samples.data(), n, 1);
    write_table(g, "functions", axis.functions.data(), m, n);
  }
}

void require(bool condition, const std::string& what) {
  if (!condition) throw Trouble{what};
}

void write_all(hid_t file, const ReducedBody& body) {
  require(body.fixed.size() == static_cast<std::size_t>(body.surface.vertex_count()),
          "'fixed' does not have one value per vertex");
  require(body.press_depth.cols() == static_cast<Eigen::Index>(body.sites.size()),
          "'press_depth' does not have one column per site");
  write_text(file, "name", body.name);
  write_text(file, "material", body.material);
  write_number(file, "largest_von_mises", body.largest_von_mises);

  {
    const Handle g = make_group(file, "surface");
    const auto V = static_cast<hsize_t>(body.surface.vertex_count());
    write_table(g, "vertices", body.surface.vertices.data(), V, 3);
    write_table(g, "triangles", body.surface.triangles.data(),
                static_cast<hsize_t>(body.surface.triangle_count()), 3);
    write_table(g, "fixed", body.fixed.data(), V, 1);
  }
  {
    const Handle g = make_group(file, "sites");
    const auto S = static_cast<hsize_t>(body.sites.size());
    std::vector<int> vertex, patch_begin{0}, patch;
    std::vector<float> weights;
    std::vector<double> direction, full_load;
    for (const Site& site : body.sites) {
      vertex.push_back(site.vertex);
      require(site.weights.size() == site.patch.size(), "a patch needs one weight per vertex");
      patch.insert(patch.end(), site.patch.begin(), site.patch.end());
      weights.insert(weights.end(), site.weights.begin(), site.weights.end());
      patch_begin.push_back(static_cast<int>(patch.size()));
      for (int k = 0; k < 3; ++k) direction.push_back(site.direction[k]);
      full_load.push_back(site.full_load);
    }
    write_table(g, "vertex", vertex.data(), S, 1);
    write_table(g, "direction", direction.data(), S, 3);
    write_table(g, "full_load", full_load.data(), S, 1);
    write_table(g, "patch_begin", patch_begin.data(), S + 1, 1);
    write_table(g, "patch", patch.data(), patch.size(), 1);
    write_table(g, "patch_weights", weights.data(), weights.size(), 1);
    write_table(g, "press_depth", body.press_depth.data(), S,
                static_cast<hsize_t>(body.press_depth.rows()));
  }
  write_field(file, "displacement", body.displacement);
  write_field(file, "stress", body.stress);
  {
    const Handle g = make_group(file, "error");
    write_number(g, "displacement_pooled", body.error.displacement_pooled);
    write_number(g, "displacement_worst", body.error.displacement_worst);
    write_number(g, "stress_pooled", body.error.stress_pooled);
    write_number(g, "stress_worst", body.error.stress_worst);
  }
  {
    const Handle g = make_group(file, "provenance");
    write_number(g, "count", static_cast<double>(body.provenance.size()));
    int number = 0;
    for (const auto& [key, value] : body.provenance) {
      write_text(g, fmt::format("{:03}_key", number).c_str(), key);
      write_text(g, fmt::format("{:03}_value", number).c_str(), value);
      ++number;
    }
  }
}

// ---- reading ---------------------------------------------------------------------------------

template <class T>
struct Table {
  std::vector<T> data;  // rows * columns, row by row
  hsize_t rows = 0;
  hsize_t columns = 0;
};

template <class T>
Table<T> read_table(hid_t file, const char* name) {
  const Handle set(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose,
                   fmt::format("dataset '{}' is missing", name));
  const Handle type(H5Dget_type(set), H5Tclose, fmt::format("dataset '{}' has no type", name));
  constexpr bool is_integer = std::is_integral_v<T>;
  if (H5Tget_class(type) != (is_integer ? H5T_INTEGER : H5T_FLOAT)) {
    throw Trouble{fmt::format("dataset '{}' does not hold {}", name,
                              is_integer ? "integers" : "floating-point numbers")};
  }
  const Handle space(H5Dget_space(set), H5Sclose, fmt::format("dataset '{}' has no size", name));
  if (H5Sget_simple_extent_ndims(space) != 2) {
    throw Trouble{fmt::format("dataset '{}' is not a table", name)};
  }
  hsize_t size[2];
  H5Sget_simple_extent_dims(space, size, nullptr);
  if (size[0] > kLargestCount || size[1] > kLargestCount ||
      (size[1] > 0 && size[0] > kLargestCount / size[1])) {
    throw Trouble{fmt::format("dataset '{}' claims {} x {} values", name, size[0], size[1])};
  }
  // A damaged header may claim more than the file holds: allocate only what is stored.
  if (H5Dget_storage_size(set) < size[0] * size[1] * H5Tget_size(type)) {
    throw Trouble{fmt::format("dataset '{}' is cut short", name)};
  }
  Table<T> table{std::vector<T>(size[0] * size[1]), size[0], size[1]};
  if (!table.data.empty() &&
      H5Dread(set, native_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, table.data.data()) < 0) {
    throw Trouble{fmt::format("dataset '{}' is damaged", name)};
  }
  return table;
}

template <class T>
Table<T> read_table(hid_t file, const char* name, hsize_t rows, hsize_t columns) {
  Table<T> table = read_table<T>(file, name);
  if (table.rows != rows || table.columns != columns) {
    throw Trouble{fmt::format("dataset '{}' is {} x {} where {} x {} is needed", name, table.rows,
                              table.columns, rows, columns)};
  }
  return table;
}

std::string read_text(hid_t object, const char* name) {
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose,
                         fmt::format("attribute '{}' is missing", name));
  const Handle type(H5Aget_type(attribute), H5Tclose,
                    fmt::format("attribute '{}' is damaged", name));
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0) {
    throw Trouble{fmt::format("attribute '{}' is not a text", name)};
  }
  const Handle space(H5Aget_space(attribute), H5Sclose, name);
  if (H5Sget_simple_extent_npoints(space) != 1) {
    throw Trouble{fmt::format("attribute '{}' is not one text", name)};
  }
  std::string text(H5Tget_size(type), '\0');
  if (H5Aread(attribute, type, text.data()) < 0) {
    throw Trouble{fmt::format("attribute '{}' is damaged", name)};
  }
  text.resize(std::min(text.find('\0'), text.size()));
  return text;
}

double read_number(hid_t object, const char* name) {
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose,
                         fmt::format("attribute '{}' is missing", name));
  const Handle type(H5Aget_type(attribute), H5Tclose, name);
  const Handle space(H5Aget_space(attribute), H5Sclose, name);
  double value = 0;
  if (H5Tget_class(type) != H5T_FLOAT || H5Sget_simple_extent_npoints(space) != 1 ||
      H5Aread(attribute, H5T_NATIVE_DOUBLE, &value) < 0) {
    throw Trouble{fmt::format("attribute '{}' is not a number", name)};
  }
  return value;
}

Handle open_group(hid_t file, const char* name) {
  return Handle(H5Gopen2(file, name, H5P_DEFAULT), H5Gclose,
                fmt::format("group '{}' is missing", name));
}

template <class T>
bool all_finite(const std::vector<T>& values) {
  for (const T v : values) {
    if (!std::isfinite(v)) return false;
  }
  return true;
}

template <class Matrix, class T>
Matrix as_matrix(const Table<T>& table) {  // dataset rows become columns
  return Eigen::Map<const Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>>(
      table.data.data(), static_cast<Eigen::Index>(table.columns),
      static_cast<Eigen::Index>(table.rows));
}

bool increases_strictly(const auto& values) {
  for (Eigen::Index i = 1; i < values.size(); ++i) {
    if (!(values[i - 1] < values[i])) return false;
  }
  return true;
}

ParameterAxis read_axis(hid_t field, int number, hsize_t m, const char* expected_name,
                        Between between) {
  const Handle g = open_group(field, fmt::format("axis_{}", number).c_str());
  ParameterAxis axis;
  axis.name = read_text(g, "name");
  require(axis.name == expected_name,
          fmt::format("axis {} is '{}' where '{}' is needed", number, axis.name, expected_name));
  const std::string text = read_text(g, "between");
  require(text == (between == Between::kSmooth ? "smooth" : "nothing"),
          fmt::format("axis '{}' is interpolated by '{}', which this program does not know",
                      axis.name, text));
  axis.between = between;
  const Table<double> samples = read_table<double>(g, "samples");
  require(samples.columns == 1 && samples.rows >= 1, "an axis has no samples");
  require(all_finite(samples.data), "an axis has samples that are not numbers");
  axis.samples = Eigen::Map<const Eigen::VectorXd>(samples.data.data(),
                                                   static_cast<Eigen::Index>(samples.rows));
  require(increases_strictly(axis.samples),
          fmt::format("the samples of axis '{}' do not increase", axis.name));
  const Table<double> functions = read_table<double>(g, "functions", m, samples.rows);
  require(all_finite(functions.data), "a parameter function is not a number somewhere");
  axis.functions = as_matrix<Eigen::MatrixXd>(functions);
  return axis;
}

SeparatedField read_field(hid_t file, const char* name, hsize_t value_count) {
  const Handle group = open_group(file, name);
  const Table<float> modes = read_table<float>(group, "modes");
  require(modes.rows >= 1, fmt::format("'{}' has no modes", name));
  require(modes.columns == value_count,
          fmt::format("the modes of '{}' have {} values where the surface needs {}", name,
                      modes.columns, value_count));
  require(all_finite(modes.data), fmt::format("a mode of '{}' is not a number somewhere", name));
  std::vector<ParameterAxis> axes;
  axes.push_back(read_axis(group, 0, modes.rows, "site", Between::kNothing));
  axes.push_back(read_axis(group, 1, modes.rows, "level", Between::kSmooth));
  return {as_matrix<Eigen::MatrixXf>(modes), std::move(axes)};
}

void read_surface(hid_t file, ReducedBody& body) {
  const Handle g = open_group(file, "surface");
  const Table<double> vertices = read_table<double>(g, "vertices");
  const Table<int> triangles = read_table<int>(g, "triangles");
  require(vertices.columns == 3 && vertices.rows >= 4, "the surface has too few vertices");
  require(triangles.columns == 3, "the surface's triangles do not have three corners");
  require(all_finite(vertices.data), "a vertex is not a number");
  body.surface.vertices = as_matrix<Eigen::Matrix3Xd>(vertices);
  body.surface.triangles = as_matrix<Eigen::Matrix3Xi>(triangles);
  const WatertightReport report = check_watertight(body.surface);
  require(report.watertight(), "the surface is " + report.describe());
  body.fixed = read_table<std::uint8_t>(g, "fixed", vertices.rows, 1).data;
}

void read_sites(hid_t file, ReducedBody& body) {
  const Handle g = open_group(file, "sites");
  const Table<int> vertex = read_table<int>(g, "vertex");
  const hsize_t S = vertex.rows;
  require(S >= 1 && vertex.columns == 1, "the body has no site");
  const Table<double> direction = read_table<double>(g, "direction", S, 3);
  const Table<double> full_load = read_table<double>(g, "full_load", S, 1);
  const Table<int> begin = read_table<int>(g, "patch_begin", S + 1, 1);
  const Table<int> patch = read_table<int>(g, "patch");
  const Table<float> weights = read_table<float>(g, "patch_weights", patch.rows, 1);
  const Table<double> depth = read_table<double>(g, "press_depth");
  require(depth.rows == S, "press_depth does not have one row per site");
  require(all_finite(direction.data) && all_finite(full_load.data) && all_finite(weights.data) &&
              all_finite(depth.data),
          "a number of the sites is not finite");
  const int V = body.surface.vertex_count();
  const auto is_vertex = [V](int v) { return v >= 0 && v < V; };
  require(begin.data.front() == 0 && static_cast<hsize_t>(begin.data.back()) == patch.rows,
          "the patches do not cover their table");
  for (std::size_t s = 0; s < S; ++s) {
    Site site;
    site.vertex = vertex.data[s];
    site.direction = Eigen::Map<const Eigen::Vector3d>(direction.data.data() + 3 * s);
    site.full_load = full_load.data[s];
    const int first = begin.data[s], end = begin.data[s + 1];
    require(0 <= first && first < end && static_cast<hsize_t>(end) <= patch.rows,
            fmt::format("site {} has no patch", s));
    site.patch.assign(patch.data.begin() + first, patch.data.begin() + end);
    site.weights.assign(weights.data.begin() + first, weights.data.begin() + end);
    double sum = 0;
    for (std::size_t k = 0; k < site.patch.size(); ++k) {
      require(is_vertex(site.patch[k]), fmt::format("site {} has a patch off the surface", s));
      require(site.weights[k] >= 0.0f, fmt::format("site {} has a negative weight", s));
      sum += site.weights[k];
    }
    require(is_vertex(site.vertex) && site.patch.front() == site.vertex,
            fmt::format("site {} does not lie in its own patch", s));
    require(std::abs(sum - 1.0) < 1e-3, fmt::format("the weights of site {} do not sum to 1", s));
    require(std::abs(site.direction.norm() - 1.0) < 1e-6,
            fmt::format("the load direction of site {} is not a unit vector", s));
    require(site.full_load > 0.0, fmt::format("site {} has no load", s));
    body.sites.push_back(std::move(site));
  }
  body.press_depth = as_matrix<Eigen::MatrixXd>(depth);
  for (std::size_t s = 0; s < S; ++s) {
    const auto column = body.press_depth.col(static_cast<Eigen::Index>(s));
    require(column.size() >= 2 && column[0] == 0.0 && increases_strictly(column),
            fmt::format("the press depth of site {} does not grow with the load", s));
  }
}

void check_axes(const ReducedBody& body) {
  const auto S = static_cast<Eigen::Index>(body.sites.size());
  for (const SeparatedField* field : {&body.displacement, &body.stress}) {
    const ParameterAxis& site = field->axes()[0];
    const ParameterAxis& level = field->axes()[1];
    require(site.samples.size() == S &&
                site.samples == Eigen::VectorXd::LinSpaced(S, 0.0, static_cast<double>(S - 1)),
            "the site axis does not number the sites");
    require(level.samples.size() == body.press_depth.rows() && level.samples.size() >= 2 &&
                level.samples[0] == 0.0 && level.samples[level.samples.size() - 1] == 1.0,
            "the level axis does not run from 0 to 1 in the steps of press_depth");
  }
}

ReducedBody read_all(hid_t file) {
  // A body cannot exist without its fields, so they start as one zero mode and are replaced below.
  const auto nothing = [](Eigen::Index rows) {
    ParameterAxis axis{"", Eigen::VectorXd::Zero(1), Eigen::MatrixXd::Zero(1, 1),
                       Between::kNothing};
    return SeparatedField(Eigen::MatrixXf::Zero(rows, 1), {axis});
  };
  ReducedBody body{.name = read_text(file, "name"),
                   .surface = {},
                   .fixed = {},
                   .sites = {},
                   .displacement = nothing(3),
                   .stress = nothing(6),
                   .press_depth = {},
                   .largest_von_mises = read_number(file, "largest_von_mises"),
                   .error = {},
                   .material = read_text(file, "material"),
                   .provenance = {}};
  require(std::isfinite(body.largest_von_mises) && body.largest_von_mises >= 0.0,
          "largest_von_mises is not a stress");
  read_surface(file, body);
  read_sites(file, body);
  const auto V = static_cast<hsize_t>(body.surface.vertex_count());
  body.displacement = read_field(file, "displacement", 3 * V);
  body.stress = read_field(file, "stress", 6 * V);
  check_axes(body);
  {
    const Handle g = open_group(file, "error");
    body.error.displacement_pooled = read_number(g, "displacement_pooled");
    body.error.displacement_worst = read_number(g, "displacement_worst");
    body.error.stress_pooled = read_number(g, "stress_pooled");
    body.error.stress_worst = read_number(g, "stress_worst");
  }
  const Handle g = open_group(file, "provenance");
  const double count = read_number(g, "count");
  require(count >= 0 && count < 1000, "the provenance is damaged");
  for (int i = 0; i < static_cast<int>(count); ++i) {
    body.provenance.emplace_back(read_text(g, fmt::format("{:03}_key", i).c_str()),
                                 read_text(g, fmt::format("{:03}_value", i).c_str()));
  }
  return body;
}

// HDF5 works in memory only: a full disk while it writes would leave it unable to close the file.
Handle in_memory() { return Handle(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "no memory"); }

std::string to_bytes(const ReducedBody& body) {
  const Handle access = in_memory();
  check(H5Pset_fapl_core(access, std::size_t{1} << 20, false), "no memory");
  const Handle file(H5Fcreate("body", H5F_ACC_TRUNC, H5P_DEFAULT, access), H5Fclose, "no memory");
  write_all(file, body);
  check(H5Fflush(file, H5F_SCOPE_GLOBAL), "no memory");
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  if (size <= 0) throw Trouble{"no memory"};
  std::string content(static_cast<std::size_t>(size), '\0');
  if (H5Fget_file_image(file, content.data(), content.size()) != size) throw Trouble{"no memory"};
  return user_block(content) + content;
}

ReducedBody from_bytes(std::string bytes) {
  check_user_block(bytes);
  const Handle access = in_memory();
  check(H5Pset_fapl_core(access, std::size_t{1} << 20, false), "no memory");
  check(H5Pset_file_image(access, bytes.data() + kUserBlock, bytes.size() - kUserBlock),
        "no memory");
  const Handle file(H5Fopen("body", H5F_ACC_RDONLY, access), H5Fclose, "HDF5 cannot open it");
  return read_all(file);
}

// Flushes a file, or the folder that names it, to the disk.
void sync_to_disk(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return;  // a file system without it: nothing more can be done
  ::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace

Result<ReducedBody> read_body_file(const std::filesystem::path& path) {
  std::error_code code;
  if (!std::filesystem::exists(path, code)) {
    return Problem{
        fmt::format("{}: no such body file; make one with 'palpable bake'", path.string())};
  }
  if (!std::filesystem::is_regular_file(path, code)) {
    return Problem{fmt::format("{}: not a file", path.string())};
  }
  const QuietHdf5 quiet;
  try {
    return from_bytes(all_bytes(path));
  } catch (const Trouble& trouble) {
    return Problem{fmt::format("{}: {}", path.string(), trouble.what)};
  } catch (const std::bad_alloc&) {
    return Problem{fmt::format("{}: needs more memory than there is", path.string())};
  }
}

void write_body_file(const std::filesystem::path& path, const ReducedBody& body) {
  std::filesystem::path aside = path;
  aside += ".part";
  const QuietHdf5 quiet;
  std::error_code code;
  try {
    const std::string bytes = to_bytes(body);
    (void)from_bytes(bytes);  // a body that breaks a promise of reduced_body.h is not written
    std::ofstream file(aside, std::ios::binary);
    if (!file) throw Trouble{"cannot be created; does the folder exist and may you write there?"};
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (!file) throw Trouble{"cannot be written; is the disk full?"};
    sync_to_disk(aside);
    std::filesystem::rename(aside, path);
    sync_to_disk(path.parent_path().empty() ? "." : path.parent_path());
  } catch (const Trouble& trouble) {
    std::filesystem::remove(aside, code);
    throw Error(fmt::format("{}: {}", path.string(), trouble.what));
  } catch (const std::filesystem::filesystem_error& error) {
    std::filesystem::remove(aside, code);
    throw Error(fmt::format("{}: {}", path.string(), error.code().message()));
  }
}

}  // namespace palpable

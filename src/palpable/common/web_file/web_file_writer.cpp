#include "palpable/common/base/checksum.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/file_format.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/whole_file.h"
#include "palpable/common/reduced/body_check.h"
#include "palpable/common/web_file/web_fields.h"
#include "palpable/common/web_file/web_file.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

namespace palpable {
namespace web {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie");

// A page fetches it whole into memory.
constexpr std::uintmax_t kLargestWebFile = 2'000'000'000;

std::string padded_to_alignment(std::string bytes, char with) {
  bytes.resize((bytes.size() + kAlignment - 1) / kAlignment * kAlignment, with);
  return bytes;
}

void put_number(std::string& bytes, std::size_t at, std::uint64_t number) {
  std::memcpy(bytes.data() + at, &number, sizeof number);
}

// The archive of web_fields.h that writes.
class Writer {
 public:
  void number(std::string_view name, double value) {
    if (!std::isfinite(value)) {
      throw Error(fmt::format("the value '{}{}' is not a number", prefix_, name));
    }
    put(name, value);
  }
  void number(std::string_view name, int value) { put(name, value); }
  void text(std::string_view name, const std::string& value) { put(name, value); }

  template <class T>
  void column(std::string_view name, const std::vector<T>& values) {
    array(name, type_name(T{}), values.data(), sizeof(T), {values.size()});
  }
  template <class T>
  void column(std::string_view name, const Eigen::Matrix<T, Eigen::Dynamic, 1>& values) {
    array(name, type_name(T{}), values.data(), sizeof(T),
          {static_cast<std::size_t>(values.size())});
  }
  template <class T, int kRows>
  void matrix(std::string_view name, const Eigen::Matrix<T, kRows, Eigen::Dynamic>& values) {
    array(name, type_name(T{}), values.data(), sizeof(T),
          {static_cast<std::size_t>(values.cols()), static_cast<std::size_t>(values.rows())});
  }

  template <class Value, class Visit>
  void optional(std::string_view name, const std::optional<Value>& value, const Visit& visit) {
    if (!value) return;
    put(name, true);
    group(name, [&] { visit(*value); });
  }
  template <class Visit>
  void group(std::string_view name, const Visit& visit) {
    const std::size_t before = prefix_.size();
    prefix_.append(name).append("/");
    visit();
    prefix_.resize(before);
  }
  template <class Visit>
  void regions(const std::vector<RegionTable>& regions, const Visit& visit) {
    number("regions", static_cast<int>(regions.size()));
    for (std::size_t k = 0; k < regions.size(); ++k) {
      group(region_name(k), [&] { visit(regions[k]); });
    }
  }

  void field(std::string_view name, const SeparatedField& field);
  void rows(std::string_view name, const RoundedRows& rows);
  void form(std::string_view name, const SymmetricForm& form, int variables, int degree);
  void places(const std::vector<Site>& sites);
  void energy(const QuarticEnergy& energy, Eigen::Index modes);
  void materials(const std::vector<Material>& materials);
  void touches(const std::vector<HeldOutTouch>& touches);

  [[nodiscard]] std::string file(const ReducedBody& body) &&;

 private:
  void put(std::string_view name, Json value) {
    values_.emplace_back(prefix_ + std::string(name), std::move(value));
  }
  void array(std::string_view name, std::string_view type, const void* data, std::size_t size,
             const std::vector<std::size_t>& shape);

  std::string prefix_;
  std::vector<std::pair<std::string, Json>> values_;
  Json arrays_ = Json::array();
  std::string data_;
};

void Writer::array(std::string_view name, std::string_view type, const void* data, std::size_t size,
                   const std::vector<std::size_t>& shape) {
  data_ = padded_to_alignment(std::move(data_), '\0');
  Json entry = Json::object();
  entry["name"] = prefix_ + std::string(name);
  entry["type"] = type;
  entry["shape"] = shape;
  entry["offset"] = data_.size();
  arrays_.push_back(std::move(entry));
  for (const std::size_t extent : shape) size *= extent;
  if (size > 0) data_.append(static_cast<const char*>(data), size);
}

void Writer::field(std::string_view name, const SeparatedField& field) {
  group(name, [&] {
    matrix("modes", field.modes());
    for (const ParameterAxis& axis : field.axes()) {
      group(axis.name, [&] {
        column("samples", axis.samples);
        matrix("functions", axis.functions);
      });
    }
  });
}

void Writer::rows(std::string_view name, const RoundedRows& rows) {
  array(name, "int16", rows.values.data(), sizeof(std::int16_t), {rows.count(), rows.width});
  column(std::string(name) + "_scale", rows.scale);
}

void Writer::form(std::string_view name, const SymmetricForm& form, int /*variables*/,
                  int /*degree*/) {
  column(name, form.values);
  column(std::string(name) + "_scale", form.scale);
}

void Writer::places(const std::vector<Site>& sites) {
  std::vector<int> vertex, begin{0}, patch;
  std::vector<float> weights;
  std::vector<double> full_load;
  Eigen::Matrix3Xd direction(3, static_cast<Eigen::Index>(sites.size()));
  for (const Site& site : sites) {
    direction.col(static_cast<Eigen::Index>(vertex.size())) = site.direction;
    vertex.push_back(site.vertex);
    full_load.push_back(site.full_load);
    patch.insert(patch.end(), site.patch.begin(), site.patch.end());
    weights.insert(weights.end(), site.weights.begin(), site.weights.end());
    begin.push_back(static_cast<int>(patch.size()));
  }
  column("vertex", vertex);
  matrix("direction", direction);
  column("full_load", full_load);
  column("patch_begin", begin);
  column("patch", patch);
  column("patch_weights", weights);
}

void Writer::energy(const QuarticEnergy& energy, Eigen::Index /*modes*/) {
  const DistinctCoefficients distinct = distinct_coefficients(energy);
  column("quadratic", distinct.quadratic);
  column("cubic", distinct.cubic);
  column("quartic", distinct.quartic);
}

void Writer::materials(const std::vector<Material>& materials) {
  number("materials", static_cast<int>(materials.size()));
  int k = 0;
  for (const Material& material : materials) {
    text(fmt::format("law_{}", k), law_name(material));
    column(fmt::format("constants_{}", k++), constants_of(material));
  }
}

// A touch without error indicators, of an older body file, has NaN in their place.
void Writer::touches(const std::vector<HeldOutTouch>& touches) {
  std::vector<int> things;
  std::vector<double> unscaled;
  Eigen::MatrixXd values(static_cast<Eigen::Index>(kHeldOutValues.size()),
                         static_cast<Eigen::Index>(touches.size()));
  for (const HeldOutTouch& touch : touches) {
    Eigen::Index row = 0;
    for (const double HeldOutTouch::*value : kHeldOutValues) {
      values(row++, static_cast<Eigen::Index>(things.size())) = touch.*value;
    }
    things.push_back(static_cast<int>(touch.thing));
    unscaled.push_back(touch.unscaled_error.value_or(std::numeric_limits<double>::quiet_NaN()));
  }
  column("things", things);
  matrix("values", values);
  column("unscaled_error", unscaled);
}

std::string Writer::file(const ReducedBody& body) && {
  Json values = Json::object();
  for (auto& [name, value] : values_) values[name] = std::move(value);
  Json header = Json::object();
  header["format"] = kFormat;
  header["version"] = kWebFileVersion;
  header["byte_order"] = "little";
  header["name"] = body.name;
  header["values"] = std::move(values);
  header["provenance"] = json_of(body.provenance);
  header["arrays"] = std::move(arrays_);
  const std::string text = padded_to_alignment(header.dump(), ' ');
  std::string bytes(kWebFileMark);
  bytes.resize(kPrefix, '\0');
  put_number(bytes, kHashedFrom, text.size());
  bytes += text;
  bytes += data_;
  return with_web_checksum(std::move(bytes));
}

}  // namespace
}  // namespace web

namespace {

void expect_valid(const TouchableBody& body) {
  const auto expect = [](const std::string& trouble) {
    if (!trouble.empty()) throw Error(trouble);
  };
  const ReducedBody& reduced = body.body;
  if (!reduced.is_settled()) {
    throw Error("a body with further parameters is delivered at one value of each: settle it");
  }
  for (const auto& [name, field] :
       {std::pair{"displacement", &reduced.displacement}, std::pair{"stress", &reduced.stress}}) {
    expect(trouble_of_field(field->modes(), field->axes(), field->value_count(), name));
  }
  expect(trouble_of(reduced));
  if (body.touch) expect(trouble_of(*body.touch, reduced.surface));
  if (body.modal) expect(trouble_of(*body.modal, reduced));
}

}  // namespace

std::string web_file_bytes(const TouchableBody& body) {
  expect_valid(body);
  web::Writer writer;
  writer.field("displacement", body.body.displacement);
  writer.field("stress", body.body.stress);
  web::visit_body(writer, body.body);
  writer.optional("touch", body.touch, [&](auto& tables) { web::visit_touch(writer, tables); });
  writer.optional("touch_modes", body.modal,
                  [&](auto& tables) { web::visit_modal(writer, tables); });
  return std::move(writer).file(body.body);
}

void write_web_file(const std::filesystem::path& path, const TouchableBody& body) {
  std::string bytes;
  try {
    bytes = web_file_bytes(body);
  } catch (const Error& error) { throw Error(fmt::format("{}: {}", path.string(), error.what())); }
  write_whole_file(path, bytes);
}

std::string with_web_checksum(std::string bytes) {
  if (bytes.size() < web::kPrefix) return bytes;
  web::put_number(bytes, 8, bytes.size());
  WordHash hash;
  hash.add(bytes.data() + web::kHashedFrom, bytes.size() - web::kHashedFrom);
  web::put_number(bytes, 16, hash.value());
  return bytes;
}

Result<TouchableBody> load_web_file(const std::filesystem::path& path) {
  const auto named = [&](const Problem& problem) {
    return Problem{fmt::format("{}: {}", path.string(), problem.message)};
  };
  const auto foreign = [](std::string_view first, std::uintmax_t /*size*/) {
    const bool ours = first.starts_with(kWebFileMark) || kWebFileMark.starts_with(first);
    return ours ? std::string() : std::string("is no delivery file of Palpable");
  };
  const Result<std::string> bytes =
      read_whole_file(path, {.most = web::kLargestWebFile, .why_not = foreign});
  if (!bytes.ok()) return named(bytes.problem());
  Result<TouchableBody> read = read_web_file(std::as_bytes(std::span(bytes.value())));
  if (!read.ok()) return named(read.problem());
  return read;
}

}  // namespace palpable

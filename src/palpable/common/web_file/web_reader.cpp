#include "palpable/common/web_file/web_reader.h"

#include "palpable/common/base/checksum.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/file_format.h"
#include "palpable/common/reduced/body_check.h"
#include "palpable/common/web_file/web_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace palpable::web {
namespace {

// Largest number of rows or columns: far above anything real, and an int everywhere.
constexpr std::int64_t kLargestExtent = 200'000'000;

std::uint64_t number_at(std::span<const std::byte> file, std::size_t at) {
  std::uint64_t number = 0;
  std::memcpy(&number, file.data() + at, sizeof number);
  return number;
}

std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// Bytes of a number of this type; 0: not known.
std::size_t size_of_type(std::string_view type) {
  constexpr std::array<std::pair<std::string_view, std::size_t>, 5> kSizes{
      {{"int16", 2}, {"int32", 4}, {"uint8", 1}, {"float32", 4}, {"float64", 8}}};
  for (const auto& [name, size] : kSizes) {
    if (name == type) return size;
  }
  return 0;
}

// What is wrong with the bytes before the header; empty: nothing.
std::string trouble_of_prefix(std::span<const std::byte> file) {
  const std::string_view begin = as_text(file.first(std::min(file.size(), kWebFileMark.size())));
  if (begin.empty() || !kWebFileMark.starts_with(begin)) {
    return "is no delivery file of Palpable, which palpable export BODY --to web writes";
  }
  if (file.size() < kPrefix) return fmt::format("is cut short: it has {} bytes", file.size());
  const std::uint64_t size = number_at(file, 8);
  if (size != file.size()) {
    return fmt::format("is {}: it has {} bytes where it states {}",
                       size > file.size() ? "cut short" : "damaged", file.size(), size);
  }
  WordHash hash;
  hash.add(file.data() + kHashedFrom, file.size() - kHashedFrom);
  if (hash.value() != number_at(file, 16)) return "is damaged: its checksum is another one";
  const std::uint64_t header = number_at(file, kHashedFrom);
  if (header % kAlignment != 0 || header > file.size() - kPrefix) {
    return "is damaged: its header does not end in it";
  }
  return {};
}

}  // namespace

std::string region_name(std::size_t k) { return fmt::format("region_{:04}", k); }

Reader::Reader(std::span<const std::byte> file) { open(file); }

void Reader::open(std::span<const std::byte> file) {
  fail(trouble_of_prefix(file));
  if (!ok()) return;
  const auto size = static_cast<std::size_t>(number_at(file, kHashedFrom));
  Result<Json> header = Json::parse(as_text(file.subspan(kPrefix, size)));
  if (!header.ok()) return fail("is damaged: its header: " + header.problem().message);
  header_ = std::move(header).value();
  const auto states = [&](std::string_view key, std::string_view needed) {
    const Json* value = header_.find(key);
    const std::string* text = value != nullptr ? value->if_text() : nullptr;
    return text != nullptr && *text == needed;
  };
  if (!states("format", kFormat)) return fail("is no delivery file of Palpable");
  const Json* version = header_.find("version");
  const std::int64_t number = version != nullptr ? version->if_whole().value_or(-1) : -1;
  if (number != kWebFileVersion) {
    return fail(fmt::format(
        "is of version {} of the format where this program reads {}; export the body again", number,
        kWebFileVersion));
  }
  if (!states("byte_order", "little")) return fail("is not little-endian");
  list_values();
  list_arrays(file.subspan(kPrefix + size));
}

void Reader::list_values() {
  const Json* values = header_.find("values");
  if (values == nullptr || !values->is_object()) return fail("is damaged: it has no values");
  for (const auto& [name, value] : values->items()) values_.emplace(name, &value);
}

void Reader::list_arrays(std::span<const std::byte> data) {
  const Json* arrays = header_.find("arrays");
  if (arrays == nullptr || !arrays->is_array()) return fail("is damaged: it has no arrays");
  std::size_t end = 0;  // of the array before
  for (const Json& entry : *arrays) {
    const Json* name = entry.find("name");
    const std::string* text = name != nullptr ? name->if_text() : nullptr;
    if (text == nullptr) return fail("is damaged: an array has no name");
    std::optional<Array> array = listed(entry, data, end);
    if (!array) {
      return fail(fmt::format("is damaged: the array '{}' does not lie in the file", *text));
    }
    if (!arrays_.emplace(*text, std::move(*array)).second) {
      return fail(fmt::format("is damaged: it holds the array '{}' twice", *text));
    }
  }
}

// An entry of the list of arrays, if its numbers lie behind those of the entry before and within
// the file.
std::optional<Reader::Array> Reader::listed(const Json& entry, std::span<const std::byte> data,
                                            std::size_t& end) const {
  const Json *type = entry.find("type"), *shape = entry.find("shape"),
             *offset = entry.find("offset");
  if (type == nullptr || shape == nullptr || offset == nullptr) return std::nullopt;
  const std::string* name = type->if_text();
  const std::size_t bytes_each = name != nullptr ? size_of_type(*name) : 0;
  const std::optional<std::int64_t> begin = offset->if_whole();
  if (bytes_each == 0 || !begin || *begin < 0 || shape->size() < 1 || shape->size() > 2) {
    return std::nullopt;
  }
  const auto first = static_cast<std::uint64_t>(*begin);
  if (first % kAlignment != 0 || first < end || first > data.size()) return std::nullopt;
  std::uint64_t count = 1;  // at most kLargestExtent squared
  Array array{*name, {}, {}};
  for (const Json& extent : *shape) {
    const std::int64_t number = extent.if_whole().value_or(-1);
    if (number < 0 || number > kLargestExtent) return std::nullopt;
    array.shape.push_back(static_cast<std::size_t>(number));
    count *= static_cast<std::uint64_t>(number);
  }
  if (count > (data.size() - first) / bytes_each) return std::nullopt;
  array.bytes =
      data.subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(count) * bytes_each);
  end = static_cast<std::size_t>(first) + array.bytes.size();
  return array;
}

void Reader::fail(std::string what) {
  if (!ok()) return;
  trouble_ = std::move(what);
  // Names from a damaged header may hold anything.
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < ' '; };
  std::replace_if(trouble_.begin(), trouble_.end(), is_control, '?');
}

void Reader::fail_shape(std::string_view name) {
  fail(fmt::format("the array '{}{}' has a size that does not fit the others", prefix_, name));
}

void Reader::fail_value(std::string_view name) {
  fail(fmt::format("the value '{}{}' is missing or out of range", prefix_, name));
}

bool Reader::has(std::string_view name) const {
  return ok() && values_.contains(prefix_ + std::string(name));
}

const Json* Reader::value_of(std::string_view name) {
  if (!ok()) return nullptr;
  const auto found = values_.find(prefix_ + std::string(name));
  if (found != values_.end()) return found->second;
  fail_value(name);
  return nullptr;
}

const Reader::Array* Reader::find(std::string_view name, std::string_view type,
                                  std::size_t dimensions) {
  if (!ok()) return nullptr;
  const auto found = arrays_.find(prefix_ + std::string(name));
  if (found == arrays_.end()) {
    fail(fmt::format("the array '{}{}' is missing", prefix_, name));
    return nullptr;
  }
  const Array& array = found->second;
  if (array.type != type || array.shape.size() != dimensions) {
    fail(fmt::format("the array '{}{}' is of {} in {} dimensions where {} in {} is needed", prefix_,
                     name, array.type, array.shape.size(), type, dimensions));
    return nullptr;
  }
  return &array;
}

void Reader::number(std::string_view name, double& value) {
  const Json* found = value_of(name);
  if (found == nullptr) return;
  const std::optional<double> number = found->if_number();
  if (!number) return fail_value(name);
  value = *number;
}

void Reader::number(std::string_view name, int& value) {
  const Json* found = value_of(name);
  if (found == nullptr) return;
  const std::optional<std::int64_t> whole = found->if_whole();
  if (!whole || *whole < std::numeric_limits<int>::min() ||
      *whole > std::numeric_limits<int>::max()) {
    return fail_value(name);
  }
  value = static_cast<int>(*whole);
}

void Reader::text(std::string_view name, std::string& value) {
  const Json* found = value_of(name);
  if (found == nullptr) return;
  const std::string* text = found->if_text();
  if (text == nullptr) return fail_value(name);
  value = *text;
}

void Reader::origin(std::string& name, Provenance& provenance) {
  if (!ok()) return;
  const Json* stated = header_.find("name");
  const std::string* text = stated != nullptr ? stated->if_text() : nullptr;
  const Json* from = header_.find("provenance");
  if (text == nullptr || from == nullptr) return fail("is damaged: it has no name or provenance");
  name = *text;
  Result<Provenance> read = provenance_of_json(from->dump());
  if (!read.ok()) return fail(read.problem().message);
  provenance = std::move(read).value();
}

std::optional<SeparatedField> Reader::field(std::string_view name) {
  Eigen::MatrixXf modes;
  std::vector<ParameterAxis> axes(2);
  axes[0] = {"site", {}, {}, Between::kNothing};
  axes[1] = {"level", {}, {}, Between::kSmooth};
  group(name, [&] {
    matrix("modes", modes);
    for (ParameterAxis& axis : axes) {
      group(axis.name, [&] {
        column("samples", axis.samples);
        matrix("functions", axis.functions);
      });
    }
  });
  if (ok()) fail(trouble_of_field(modes, axes, modes.rows(), name));
  if (!ok()) return std::nullopt;
  return SeparatedField(std::move(modes), std::move(axes));
}

void Reader::rows(std::string_view name, RoundedRows& rows) {
  const Array* array = find(name, "int16", 2);
  if (array == nullptr) return;
  rows.width = array->shape[1];
  rows.values.resize(array->shape[0] * array->shape[1]);
  copy(*array, rows.values.data());
  column(std::string(name) + "_scale", rows.scale);
  if (ok() && rows.scale.size() != array->shape[0]) fail_shape(std::string(name) + "_scale");
}

void Reader::form(std::string_view name, SymmetricForm& form, int variables, int degree) {
  if (!ok()) return;
  if (variables < 0 || variables > kMostTouchModes) return fail_shape(name);
  form.variables = variables;
  form.degree = degree;
  column(name, form.values);
  column(std::string(name) + "_scale", form.scale);
  if (ok() && (form.values.size() != distinct_coefficients(variables, degree) ||
               form.scale.size() != runs_of(variables, degree))) {
    fail_shape(name);
  }
}

void Reader::places(std::vector<Site>& sites) {
  std::vector<int> vertex, begin, patch;
  std::vector<float> weights;
  std::vector<double> full_load;
  Eigen::Matrix3Xd direction;
  column("vertex", vertex);
  matrix("direction", direction);
  column("full_load", full_load);
  column("patch_begin", begin);
  column("patch", patch);
  column("patch_weights", weights);
  if (!ok()) return;
  const std::size_t n = vertex.size();
  if (static_cast<std::size_t>(direction.cols()) != n || full_load.size() != n) {
    return fail_shape("direction");
  }
  if (begin.size() != n + 1 || begin.front() != 0 || !std::is_sorted(begin.begin(), begin.end()) ||
      static_cast<std::size_t>(begin.back()) != patch.size() || weights.size() != patch.size()) {
    return fail_shape("patch_begin");
  }
  sites.resize(n);
  for (std::size_t s = 0; s < n; ++s) {
    const int first = begin[s], end = begin[s + 1];
    sites[s] = {.vertex = vertex[s],
                .patch = {patch.begin() + first, patch.begin() + end},
                .weights = {weights.begin() + first, weights.begin() + end},
                .direction = direction.col(static_cast<Eigen::Index>(s)),
                .full_load = full_load[s]};
  }
}

void Reader::energy(QuarticEnergy& energy, Eigen::Index modes) {
  DistinctCoefficients distinct;
  column("quadratic", distinct.quadratic);
  column("cubic", distinct.cubic);
  column("quartic", distinct.quartic);
  if (!ok()) return;
  if (modes < 1 || modes > kMostSeveralModes ||
      distinct.quadratic.size() != distinct_count(modes, 2) ||
      distinct.cubic.size() != distinct_count(modes, 3) ||
      distinct.quartic.size() != distinct_count(modes, 4)) {
    return fail_shape("quadratic");
  }
  energy = energy_of(static_cast<int>(modes), distinct);
}

void Reader::materials(std::vector<Material>& materials) {
  int count = 0;
  number("materials", count);
  if (count < 0 || count > kMostMaterials) return fail_value("materials");
  for (int k = 0; k < count && ok(); ++k) {
    const std::string name = fmt::format("constants_{}", k);
    std::string law;
    std::vector<double> constants;
    text(fmt::format("law_{}", k), law);
    column(name, constants);
    if (!ok()) return;
    try {
      if (constants.size() != law_constants(law).size()) return fail_shape(name);
      materials.push_back(material_from_constants(law, constants));
    } catch (const Error& error) { fail(error.what()); }
  }
}

void Reader::touches(std::vector<HeldOutTouch>& touches) {
  std::vector<int> things;
  Eigen::MatrixXd values;
  std::vector<double> unscaled;
  column("things", things);
  matrix("values", values);
  column("unscaled_error", unscaled);
  if (!ok()) return;
  const std::size_t n = things.size();
  if (static_cast<std::size_t>(values.cols()) != n || unscaled.size() != n ||
      static_cast<std::size_t>(values.rows()) != kHeldOutValues.size()) {
    return fail_shape("values");
  }
  touches.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    touches[k].thing = static_cast<PressingThing>(things[k]);
    Eigen::Index row = 0;
    for (double HeldOutTouch::*value : kHeldOutValues) {
      touches[k].*value = values(row++, static_cast<Eigen::Index>(k));
    }
    if (!std::isnan(unscaled[k])) touches[k].unscaled_error = unscaled[k];
  }
}

}  // namespace palpable::web

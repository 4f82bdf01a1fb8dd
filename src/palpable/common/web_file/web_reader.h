/// @file
/// The archive of web_fields.h that reads a delivery file in memory.
///
/// The first thing that is wrong is kept, and nothing is read from then on: members that were not
/// reached keep their values. So a damaged file ends in one line, without an exception.
#pragma once

#include "palpable/common/base/json.h"
#include "palpable/common/web_file/web_fields.h"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpable::web {

class Reader {
 public:
  /// @param file  outlives this
  explicit Reader(std::span<const std::byte> file);
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  [[nodiscard]] bool ok() const { return trouble_.empty(); }
  /// The first thing that is wrong, in one line; empty: nothing.
  [[nodiscard]] const std::string& trouble() const { return trouble_; }

  /// The body's name and its provenance.
  void origin(std::string& name, Provenance& provenance);
  /// A field over site and level; nothing after a trouble.
  [[nodiscard]] std::optional<SeparatedField> field(std::string_view name);

  void number(std::string_view name, double& value);
  void number(std::string_view name, int& value);
  void text(std::string_view name, std::string& value);

  template <class T>
  void column(std::string_view name, std::vector<T>& values) {
    const Array* array = find(name, type_name(T{}), 1);
    if (array == nullptr) return;
    values.resize(array->shape[0]);
    copy(*array, values.data());
  }
  template <class T>
  void column(std::string_view name, Eigen::Matrix<T, Eigen::Dynamic, 1>& values) {
    const Array* array = find(name, type_name(T{}), 1);
    if (array == nullptr) return;
    values.resize(static_cast<Eigen::Index>(array->shape[0]));
    copy(*array, values.data());
  }
  template <class T, int kRows>
  void matrix(std::string_view name, Eigen::Matrix<T, kRows, Eigen::Dynamic>& values) {
    const Array* array = find(name, type_name(T{}), 2);
    if (array == nullptr) return;
    const auto rows = static_cast<Eigen::Index>(array->shape[1]);
    if (kRows != Eigen::Dynamic && rows != kRows) return fail_shape(name);
    values.resize(rows, static_cast<Eigen::Index>(array->shape[0]));
    copy(*array, values.data());
  }

  template <class Value, class Visit>
  void optional(std::string_view name, std::optional<Value>& value, const Visit& visit) {
    if (!has(name)) return;
    value.emplace();
    group(name, [&] { visit(*value); });
  }
  template <class Visit>
  void group(std::string_view name, const Visit& visit) {
    const std::size_t before = prefix_.size();
    prefix_.append(name).append("/");
    if (ok()) visit();
    prefix_.resize(before);
  }
  template <class Visit>
  void regions(std::vector<RegionTable>& regions, const Visit& visit) {
    int count = 0;
    number("regions", count);
    // Each has arrays: more of them than arrays are not stored, and must not be allocated.
    if (count < 0 || static_cast<std::size_t>(count) > arrays_.size()) return fail_value("regions");
    regions.resize(static_cast<std::size_t>(count));
    for (std::size_t k = 0; k < regions.size() && ok(); ++k) {
      group(region_name(k), [&] { visit(regions[k]); });
    }
  }

  void rows(std::string_view name, RoundedRows& rows);
  void form(std::string_view name, SymmetricForm& form, int variables, int degree);
  void places(std::vector<Site>& sites);
  void energy(QuarticEnergy& energy, Eigen::Index modes);
  void materials(std::vector<Material>& materials);
  void touches(std::vector<HeldOutTouch>& touches);

 private:
  struct Array {
    std::string_view type;
    std::vector<std::size_t> shape;    // one number or two
    std::span<const std::byte> bytes;  // within the file
  };

  void open(std::span<const std::byte> file);
  void list_values();
  void list_arrays(std::span<const std::byte> data);
  [[nodiscard]] std::optional<Array> listed(const Json& entry, std::span<const std::byte> data,
                                            std::size_t& end) const;

  void fail(std::string what);
  void fail_shape(std::string_view name);
  void fail_value(std::string_view name);
  [[nodiscard]] bool has(std::string_view name) const;
  [[nodiscard]] const Json* value_of(std::string_view name);
  // Nothing after a trouble, also if the array is missing or of another kind.
  [[nodiscard]] const Array* find(std::string_view name, std::string_view type,
                                  std::size_t dimensions);
  static void copy(const Array& array, void* to) {
    if (!array.bytes.empty()) std::memcpy(to, array.bytes.data(), array.bytes.size());
  }

  std::string trouble_;
  std::string prefix_;  // of names in the present group
  Json header_;
  std::map<std::string_view, const Json*> values_;
  std::map<std::string_view, Array> arrays_;
};

}  // namespace palpable::web

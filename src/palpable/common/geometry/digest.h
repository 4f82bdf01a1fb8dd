/// @file
/// A digest of everything that a result is computed from. Stored results carry it, and are used
/// again only if it is the same.
#pragma once

#include "palpable/common/base/checksum.h"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// FNV-1a, 64 bits, over the bytes of all numbers that are added; the sizes of texts and tables are
/// included.
class Digest {
 public:
  explicit Digest(std::uint64_t start = kFnvStart) : value_(start) {}
  void add(const void* bytes, std::size_t count) {
    value_ = fnv1a(std::string_view(static_cast<const char*>(bytes), count), value_);
  }
  void add(double x) { add(&x, sizeof x); }
  void add(int x) { add(&x, sizeof x); }
  void add(std::uint64_t x) { add(&x, sizeof x); }
  void add(const std::string& text) {
    add(static_cast<int>(text.size()));
    add(text.data(), text.size());
  }
  void add(const std::vector<int>& list) {
    add(static_cast<int>(list.size()));
    add(list.data(), list.size() * sizeof(int));
  }
  template <class Matrix>
  void add(const Eigen::PlainObjectBase<Matrix>& matrix) {
    add(static_cast<int>(matrix.rows()));
    add(static_cast<int>(matrix.cols()));
    add(matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(*matrix.data()));
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_;
};

}  // namespace palpable

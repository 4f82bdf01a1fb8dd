#include "palpable/bake/solid/triangular_panels.h"

#include "palpable/common/material/tensor.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace palpable {
namespace {

constexpr int kPanelWidth = 16;
constexpr int kGroup = 4;  // columns that share one pass over the rows

using PanelFloats = float __attribute__((vector_size(kPanelWidth * sizeof(float))));
using Words = std::uint32_t __attribute__((vector_size(kPanelWidth * sizeof(std::uint32_t))));
using HalfWords = BFloat16 __attribute__((vector_size(kPanelWidth * sizeof(BFloat16))));

void round_to(float x, float& stored) { stored = x; }
void round_to(float x, BFloat16& stored) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  stored = static_cast<BFloat16>((bits + 0x7fffU + ((bits >> 16U) & 1U)) >> 16U);
}

PALPABLE_ALWAYS_INLINE float widened(float x) { return x; }
PALPABLE_ALWAYS_INLINE float widened(BFloat16 x) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(x) << 16U);
}

PALPABLE_ALWAYS_INLINE void load(const float* from, PanelFloats& to) {
  std::memcpy(&to, from, sizeof to);
}
PALPABLE_ALWAYS_INLINE void load(const BFloat16* from, PanelFloats& to) {
  HalfWords half;
  std::memcpy(&half, from, sizeof half);
  to = (PanelFloats)(__builtin_convertvector(half, Words) << 16U);
}

}  // namespace

// Forward and backward substitution with one panel, kGroup columns at a time. `z` holds the entries
// of the vector at the panel's rows, and zeros up to the panel's padded length.
template <class Stored>
struct TriangularPanels<Stored>::Solve {
  template <int kColumns>
  PALPABLE_ALWAYS_INLINE static void forward(const Stored* panel, int stride, int j,
                                             const float* inverse, float* z) {
    float solved[kColumns];
    for (int c = 0; c < kColumns; ++c) {
      float value = z[j + c];
      for (int b = 0; b < c; ++b) value -= widened(panel[b * stride + j + c]) * solved[b];
      solved[c] = value * inverse[c];
    }
    for (int i = j / kPanelWidth * kPanelWidth; i < stride; i += kPanelWidth) {
      PanelFloats sum;
      std::memcpy(&sum, z + i, sizeof sum);
      for (int c = 0; c < kColumns; ++c) {
        PanelFloats column;
        load(panel + c * stride + i, column);
        sum -= column * solved[c];
      }
      std::memcpy(z + i, &sum, sizeof sum);
    }
    // The pass has changed these entries as well; set them again.
    for (int c = 0; c < kColumns; ++c) z[j + c] = solved[c];
  }

  template <int kColumns>
  PALPABLE_ALWAYS_INLINE static void backward(const Stored* panel, int stride, int j,
                                              const float* inverse, float* z) {
    float own[kColumns];
    for (int c = 0; c < kColumns; ++c) {
      own[c] = z[j + c];
      z[j + c] = 0.0F;  // the pass is about the rows below the group
    }
    PanelFloats sums[kColumns] = {};
    for (int i = j / kPanelWidth * kPanelWidth; i < stride; i += kPanelWidth) {
      PanelFloats below;
      std::memcpy(&below, z + i, sizeof below);
      for (int c = 0; c < kColumns; ++c) {
        PanelFloats column;
        load(panel + c * stride + i, column);
        sums[c] += column * below;
      }
    }
    for (int c = kColumns; c-- > 0;) {
      float value = own[c];
      for (int lane = 0; lane < kPanelWidth; ++lane) value -= sums[c][lane];
      for (int b = c + 1; b < kColumns; ++b) value -= widened(panel[c * stride + j + b]) * z[j + b];
      z[j + c] = value * inverse[c];
    }
  }

  PALPABLE_ALWAYS_INLINE static int run(const TriangularPanels& L, float* y, float* z) {
    const Supernodes& s = L.supernodes_;
    const int count = static_cast<int>(s.first_column.size()) - 1;
    const auto at = [](const auto& list, int k) { return list[k]; };
    for (int k = 0; k < count; ++k) {
      const int first = at(s.first_column, k), columns = at(s.first_column, k + 1) - first;
      const int rows = at(s.first_row, k + 1) - at(s.first_row, k), stride = padded(rows);
      const int* const row = s.rows.data() + at(s.first_row, k);
      const Stored* const panel = L.panel(k);
      const float* const inverse = L.inverse_diagonal_.data() + first;
      for (int i = 0; i < columns; ++i) z[i] = y[first + i];
      for (int i = columns; i < stride; ++i) z[i] = 0.0F;
      int j = 0;
      for (; j + kGroup <= columns; j += kGroup) {
        forward<kGroup>(panel + j * std::ptrdiff_t{stride}, stride, j, inverse + j, z);
      }
      for (; j < columns; ++j) {
        forward<1>(panel + j * std::ptrdiff_t{stride}, stride, j, inverse + j, z);
      }
      for (int i = 0; i < columns; ++i) y[first + i] = z[i];
      for (int i = columns; i < rows; ++i) y[row[i]] += z[i];
    }
    for (int k = count; k-- > 0;) {
      const int first = at(s.first_column, k), columns = at(s.first_column, k + 1) - first;
      const int rows = at(s.first_row, k + 1) - at(s.first_row, k), stride = padded(rows);
      const int* const row = s.rows.data() + at(s.first_row, k);
      const Stored* const panel = L.panel(k);
      const float* const inverse = L.inverse_diagonal_.data() + first;
      for (int i = 0; i < rows; ++i) z[i] = y[row[i]];
      for (int i = rows; i < stride; ++i) z[i] = 0.0F;
      // From the last column to the first, in the same groups as forward.
      int j = columns;
      for (; j % kGroup != 0; --j) {
        backward<1>(panel + (j - 1) * std::ptrdiff_t{stride}, stride, j - 1, inverse + j - 1, z);
      }
      for (; j > 0; j -= kGroup) {
        backward<kGroup>(panel + (j - kGroup) * std::ptrdiff_t{stride}, stride, j - kGroup,
                         inverse + j - kGroup, z);
      }
      for (int i = 0; i < columns; ++i) y[first + i] = z[i];
    }
    return 0;
  }
};

// The same for several vectors: `z` holds kSystems numbers for each entry. The panel's numbers are
// converted to floats in tiles of kPanelWidth rows; each is then broadcast to all lanes.
template <class Stored>
struct TriangularPanels<Stored>::SolveTogether {
  using Row = float __attribute__((vector_size(kSystems * sizeof(float)), may_alias));
  template <int kColumns>
  struct alignas(kPanelWidth * sizeof(float)) Tile {
    float of[kColumns][kPanelWidth];
  };

  // Returned by reference: the plain ABI has no registers that could hold so wide a vector.
  PALPABLE_ALWAYS_INLINE static Row& row(float* z, std::ptrdiff_t i) {
    return *reinterpret_cast<Row*>(z + i * kSystems);
  }

  template <int kColumns>
  PALPABLE_ALWAYS_INLINE static void widen(const Stored* panel, std::ptrdiff_t stride, int i,
                                           Tile<kColumns>& tile) {
    for (int c = 0; c < kColumns; ++c) {
      PanelFloats column;
      load(panel + c * stride + i, column);
      std::memcpy(tile.of[c], &column, sizeof column);
    }
  }

  template <int kColumns>
  PALPABLE_ALWAYS_INLINE static void forward(const Stored* panel, int stride, int rows, int j,
                                             const float* inverse, float* z) {
    Row solved[kColumns];
    for (int c = 0; c < kColumns; ++c) {
      Row value = row(z, j + c);
      for (int b = 0; b < c; ++b) value -= widened(panel[b * stride + j + c]) * solved[b];
      solved[c] = value * inverse[c];
      row(z, j + c) = solved[c];
    }
    Tile<kColumns> tile;
    for (int i = j / kPanelWidth * kPanelWidth; i < rows; i += kPanelWidth) {
      widen<kColumns>(panel, stride, i, tile);
      const int begin = std::max(j + kColumns - i, 0), end = std::min(rows - i, kPanelWidth);
      for (int k = begin; k < end; ++k) {
        Row sum = row(z, i + k);
        for (int c = 0; c < kColumns; ++c) sum -= tile.of[c][k] * solved[c];
        row(z, i + k) = sum;
      }
    }
  }

  template <int kColumns>
  PALPABLE_ALWAYS_INLINE static void backward(const Stored* panel, int stride, int rows, int j,
                                              const float* inverse, float* z) {
    Row sums[kColumns] = {};
    Tile<kColumns> tile;
    for (int i = j / kPanelWidth * kPanelWidth; i < rows; i += kPanelWidth) {
      widen<kColumns>(panel, stride, i, tile);
      const int begin = std::max(j + kColumns - i, 0), end = std::min(rows - i, kPanelWidth);
      for (int k = begin; k < end; ++k) {
        const Row below = row(z, i + k);
        for (int c = 0; c < kColumns; ++c) sums[c] += tile.of[c][k] * below;
      }
    }
    for (int c = kColumns; c-- > 0;) {
      Row value = row(z, j + c) - sums[c];
      for (int b = c + 1; b < kColumns; ++b) {
        value -= widened(panel[c * stride + j + b]) * row(z, j + b);
      }
      row(z, j + c) = value * inverse[c];
    }
  }

  PALPABLE_ALWAYS_INLINE static int run(const TriangularPanels& L, float* y, float* z) {
    constexpr int kMost = 8, kSome = 4;  // columns that share one pass over the rows
    const Supernodes& s = L.supernodes_;
    const int count = static_cast<int>(s.first_column.size()) - 1;
    const auto at = [](const auto& list, int k) { return list[k]; };
    for (int k = 0; k < count; ++k) {
      const int first = at(s.first_column, k), columns = at(s.first_column, k + 1) - first;
      const int rows = at(s.first_row, k + 1) - at(s.first_row, k), stride = padded(rows);
      const int* const places = s.rows.data() + at(s.first_row, k);
      const Stored* const panel = L.panel(k);
      const float* const inverse = L.inverse_diagonal_.data() + first;
      for (int i = 0; i < columns; ++i) row(z, i) = row(y, first + i);
      for (int i = columns; i < rows; ++i) row(z, i) = Row{};
      int j = 0;
      for (; j + kMost <= columns; j += kMost) {
        forward<kMost>(panel + j * std::ptrdiff_t{stride}, stride, rows, j, inverse + j, z);
      }
      if (j + kSome <= columns) {
        forward<kSome>(panel + j * std::ptrdiff_t{stride}, stride, rows, j, inverse + j, z);
        j += kSome;
      }
      for (; j < columns; ++j) {
        forward<1>(panel + j * std::ptrdiff_t{stride}, stride, rows, j, inverse + j, z);
      }
      for (int i = 0; i < columns; ++i) row(y, first + i) = row(z, i);
      for (int i = columns; i < rows; ++i) row(y, places[i]) += row(z, i);
    }
    for (int k = count; k-- > 0;) {
      const int first = at(s.first_column, k), columns = at(s.first_column, k + 1) - first;
      const int rows = at(s.first_row, k + 1) - at(s.first_row, k), stride = padded(rows);
      const int* const places = s.rows.data() + at(s.first_row, k);
      const Stored* const panel = L.panel(k);
      const float* const inverse = L.inverse_diagonal_.data() + first;
      for (int i = 0; i < rows; ++i) row(z, i) = row(y, places[i]);
      int j = columns;
      for (; j % kSome != 0; --j) {
        backward<1>(panel + (j - 1) * std::ptrdiff_t{stride}, stride, rows, j - 1, inverse + j - 1,
                    z);
      }
      if (j % kMost != 0) {
        j -= kSome;
        backward<kSome>(panel + j * std::ptrdiff_t{stride}, stride, rows, j, inverse + j, z);
      }
      for (; j > 0; j -= kMost) {
        backward<kMost>(panel + (j - kMost) * std::ptrdiff_t{stride}, stride, rows, j - kMost,
                        inverse + j - kMost, z);
      }
      for (int i = 0; i < columns; ++i) row(y, first + i) = row(z, i);
    }
    return 0;
  }
};

template <class Stored>
TriangularPanels<Stored>::TriangularPanels(const Supernodes& supernodes) : supernodes_(supernodes) {
  std::size_t size = 0;
  for (std::size_t k = 0; k + 1 < supernodes.first_column.size(); ++k) {
    const int columns = supernodes.first_column[k + 1] - supernodes.first_column[k];
    const int stride = padded(supernodes.first_row[k + 1] - supernodes.first_row[k]);
    start_.push_back(size);
    size += static_cast<std::size_t>(columns) * static_cast<std::size_t>(stride / kPanelWidth);
    scratch_size_ = std::max(scratch_size_, static_cast<std::size_t>(stride));
  }
  values_.assign(size, Sixteen{});
  inverse_diagonal_.assign(supernodes.first_column.back(), 0.0F);
}

template <class Stored>
template <class Number>
void TriangularPanels<Stored>::set(int k, const Number* values) {
  const auto at = static_cast<std::size_t>(k);
  const int first = supernodes_.first_column[at];
  const int columns = supernodes_.first_column[at + 1] - first;
  const int rows = supernodes_.first_row[at + 1] - supernodes_.first_row[at];
  const int stride = padded(rows);
  for (int j = 0; j < columns; ++j) {
    const Number* const from = values + static_cast<std::ptrdiff_t>(j) * rows;
    Stored* const to = panel(k) + static_cast<std::ptrdiff_t>(j) * stride;
    for (int i = j + 1; i < rows; ++i) round_to(static_cast<float>(from[i]), to[i]);
    inverse_diagonal_[first + j] = static_cast<float>(1.0 / from[j]);
  }
}

template <class Stored>
void TriangularPanels<Stored>::solve(SimdLevel simd, std::span<float> y,
                                     std::span<float> scratch) const {
  float* const values = y.data();
  float* const z = scratch.data();
  run_at<Solve>(simd, *this, values, z);
}

template <class Stored>
void TriangularPanels<Stored>::solve_together(SimdLevel simd, std::span<float> y,
                                              std::span<float> scratch) const {
  float* const values = y.data();
  float* const z = scratch.data();
  run_at<SolveTogether>(simd, *this, values, z);
}

template class TriangularPanels<BFloat16>;
template class TriangularPanels<float>;
template void TriangularPanels<BFloat16>::set(int, const float*);
template void TriangularPanels<BFloat16>::set(int, const double*);
template void TriangularPanels<float>::set(int, const float*);
template void TriangularPanels<float>::set(int, const double*);

}  // namespace palpable

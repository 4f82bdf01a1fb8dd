#include "palpable/bake/solid/sparse_cholesky.h"

#include "palpable/bake/solid/triangular_panels.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cblas.h>
#include <cholmod.h>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

// Declared here because <omp.h> belongs to the compiler, and one that builds without OpenMP may not
// have it.
extern "C" {
void omp_set_max_active_levels(int levels);
int omp_get_max_active_levels(void);
// LAPACK: A = L L^T of the lower triangle; info > 0 where A is not positive definite.
void spotrf_(const char* triangle, const int* n, float* A, const int* stride, int* info);
}

namespace palpable {

namespace {
struct alignas(64) SixteenFloats {
  float of[CholeskyFactor::kMostTogether];
};
}  // namespace

struct FactorWorkspace::Content {
  cholmod_common common{};
  // For solve_roughly(): the solution in the order of elimination, and the entries of one panel's
  // rows, gathered.
  std::vector<float> permuted, gathered;
  // The same for solve_together().
  std::vector<SixteenFloats> many_permuted, many_gathered;

  Content() {
    cholmod_start(&common);
    common.print = 0;  // no messages; `status` has the errors
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.final_ll = 1;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_GIVEN;
    common.postorder = 1;
  }
  Content(const Content&) = delete;
  Content& operator=(const Content&) = delete;
  ~Content() { cholmod_finish(&common); }
};

FactorWorkspace::FactorWorkspace() : content_(std::make_unique<Content>()) {}
FactorWorkspace::~FactorWorkspace() = default;

namespace {

// OpenBLAS's own threads: sites run side by side already.
[[maybe_unused]] const bool kOneBlasThread = (openblas_set_num_threads(1), true);

// While this object lives, OpenMP runs parallel regions of the calling thread on one thread.
// Debian's CHOLMOD otherwise asks for four, whatever OMP_NUM_THREADS says; since sites run side by
// side on all cores, those threads would mostly wait for each other.
class OneThread {
 public:
  OneThread() : before_(omp_get_max_active_levels()) { omp_set_max_active_levels(0); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;
  ~OneThread() { omp_set_max_active_levels(before_); }

 private:
  int before_;
};

// Frees with a `common` of its own, because the thread whose `common` allocated the memory may have
// ended. CHOLMOD permits that: a `common` only counts the bytes.
void free_factor(cholmod_factor* factor) {
  cholmod_common common;
  cholmod_start(&common);
  cholmod_free_factor(&factor, &common);
  cholmod_finish(&common);
}

void refuse_if_out_of_memory(const cholmod_common& common) {
  if (common.status == CHOLMOD_OUT_OF_MEMORY || common.status == CHOLMOD_TOO_LARGE) {
    throw Error(fmt::format(
        "the sparse factor does not fit into memory ({:.1f} million nonzeros); use a coarser mesh",
        common.lnz / 1e6));
  }
}

// The lower triangle of a symmetric block matrix, column by column, as CHOLMOD reads it. This
// object owns the arrays.
struct LowerColumns {
  std::vector<int> start, row;
  std::vector<double> value;

  explicit LowerColumns(const BlockPattern& pattern) {
    const int M = pattern.rows();
    start.reserve(static_cast<std::size_t>(3 * M) + 1);
    start.push_back(0);
    for (int c = 0; c < M; ++c) {
      for (int j = 0; j < 3; ++j) {
        for_column(pattern, c, [&](int r, int) {
          for (int i = (r == c ? j : 0); i < 3; ++i) row.push_back(3 * r + i);
        });
        start.push_back(static_cast<int>(row.size()));
      }
    }
  }

  void fill(const BlockMatrix& K) {
    value.clear();
    value.reserve(row.size());
    const int M = K.pattern().rows();
    for (int c = 0; c < M; ++c) {
      for (int j = 0; j < 3; ++j) {
        for_column(K.pattern(), c, [&](int r, int place) {
          // K is symmetric: the block (c, r), which row c stores, is the transpose of (r, c).
          const auto B = K.block(place);
          for (int i = (r == c ? j : 0); i < 3; ++i) value.push_back(B(j, i));
        });
      }
    }
  }

  cholmod_sparse view() {
    cholmod_sparse A{};
    A.nrow = A.ncol = start.size() - 1;
    A.nzmax = row.size();
    A.p = start.data();
    A.i = row.data();
    A.x = value.empty() ? nullptr : value.data();
    A.stype = -1;
    A.itype = CHOLMOD_INT;
    A.xtype = value.empty() ? CHOLMOD_PATTERN : CHOLMOD_REAL;
    A.dtype = CHOLMOD_DOUBLE;
    A.sorted = 1;
    A.packed = 1;
    return A;
  }

 private:
  template <class Visit>
  static void for_column(const BlockPattern& pattern, int c, const Visit& visit) {
    const auto begin = pattern.row_start[c];
    const auto end = pattern.row_start[c + 1];
    for (int p = begin; p < end; ++p) {
      const int r = pattern.column[p];
      if (r >= c) visit(r, p);
    }
  }
};

}  // namespace

struct CholeskyAnalysis::Content {
  BlockPattern pattern;
  LowerColumns columns;
  cholmod_factor* symbolic = nullptr;
  std::vector<int> place_of_unknown;     // unknown -> its place in the order of elimination
  std::vector<int> supernode_of_column;  // in that order
  double flops = 0;

  explicit Content(const BlockPattern& the_pattern) : pattern(the_pattern), columns(the_pattern) {}
  Content(const Content&) = delete;
  Content& operator=(const Content&) = delete;
  ~Content() { free_factor(symbolic); }

  [[nodiscard]] int size() const { return static_cast<int>(symbolic->n); }
  [[nodiscard]] std::span<const int> order() const {
    return {static_cast<const int*>(symbolic->Perm), symbolic->n};
  }
  [[nodiscard]] Supernodes supernodes() const {
    const auto* const first_row = static_cast<const int*>(symbolic->pi);
    return {{static_cast<const int*>(symbolic->super), symbolic->nsuper + 1},
            {first_row, symbolic->nsuper + 1},
            {static_cast<const int*>(symbolic->s),
             static_cast<std::size_t>(first_row[symbolic->nsuper])}};
  }
  // Where each panel begins in an array of all panels, as CHOLMOD lays them out.
  [[nodiscard]] const int* first_value() const { return static_cast<const int*>(symbolic->px); }
};

CholeskyAnalysis::CholeskyAnalysis(const BlockPattern& pattern, FactorWorkspace& workspace) {
  const OneThread one_thread;
  cholmod_common& common = workspace.content().common;
  auto content = std::make_shared<Content>(pattern);
  const auto M = static_cast<std::size_t>(pattern.rows());

  // Order the nodes, not the unknowns: a graph of a ninth of the size, and the three unknowns of a
  // node stay together, which makes larger supernodes.
  std::vector<int> node_start{0}, node_row;
  for (int c = 0; c < pattern.rows(); ++c) {
    for (int p = pattern.row_start[c]; p < pattern.row_start[c + 1]; ++p) {
      const int r = pattern.column[p];
      if (r >= c) node_row.push_back(r);
    }
    node_start.push_back(static_cast<int>(node_row.size()));
  }
  cholmod_sparse graph{};
  graph.nrow = graph.ncol = M;
  graph.nzmax = node_row.size();
  graph.p = node_start.data();
  graph.i = node_row.data();
  graph.stype = -1;
  graph.itype = CHOLMOD_INT;
  graph.xtype = CHOLMOD_PATTERN;
  graph.dtype = CHOLMOD_DOUBLE;
  graph.sorted = graph.packed = 1;
  std::vector<int> node_order(M);
  if (cholmod_metis(&graph, nullptr, 0, 1, node_order.data(), &common) == 0) {
    refuse_if_out_of_memory(common);
    throw Error("the nodes of the mesh could not be ordered for the sparse factor");
  }
  std::vector<int> order;
  order.reserve(3 * M);
  for (const int n : node_order) {
    for (int i = 0; i < 3; ++i) order.push_back(3 * n + i);
  }
  cholmod_sparse A = content->columns.view();
  content->symbolic = cholmod_analyze_p(&A, order.data(), nullptr, 0, &common);
  if (content->symbolic == nullptr) {
    refuse_if_out_of_memory(common);
    throw Error("the structure of the sparse factor could not be determined");
  }
  PALPABLE_EXPECT(content->symbolic->is_super && content->symbolic->itype == CHOLMOD_INT,
                  "the factor is supernodal, with int indices, as asked for");
  content->flops = common.fl;
  content->place_of_unknown.resize(3 * M);
  for (int place = 0; place < content->size(); ++place) {
    content->place_of_unknown[content->order()[place]] = place;
  }
  const std::span<const int> first_column = content->supernodes().first_column;
  for (std::size_t k = 0; k + 1 < first_column.size(); ++k) {
    content->supernode_of_column.resize(first_column[k + 1], static_cast<int>(k));
  }
  content_ = std::move(content);
}

double CholeskyAnalysis::nonzeros() const { return static_cast<double>(content_->symbolic->xsize); }
double CholeskyAnalysis::factor_flops() const { return content_->flops; }

// The factor of K / scale, whose numbers are of order one whatever the unit of stiffness.
struct CholeskyFactor::Content {
  std::shared_ptr<const CholeskyAnalysis::Content> analysis;
  std::variant<TriangularPanels<BFloat16>, TriangularPanels<float>> panels;
  double scale = 1.0;
};

namespace {

// The largest entry of the diagonal.
double scale_of(const BlockMatrix& K) {
  double largest = 0.0;
  for (int row = 0; row < K.pattern().rows(); ++row) {
    largest = std::max(largest, K.block(K.pattern().find(row, row)).diagonal().maxCoeff());
  }
  return largest;
}

// Smallest pivot that elimination may leave, ratio to the diagonal entry before it. A smaller pivot
// is rounding, and the matrix is singular to this precision. The bound lies between what rounding
// leaves (5.5 epsilon in the last pivots of a free chain, as the tests build it) and the pivots of
// real bodies (none of the shipped ones is below 1e-3, which is 8,000 epsilon in single precision).
template <class Number>
constexpr double kSmallestPivot = 100.0 * std::numeric_limits<Number>::epsilon();

// The smallest pivot of a factorised panel of K / scale, relative to its diagonal entry before the
// elimination; at most 1.
template <class Number>
double smallest_pivot(const CholeskyAnalysis::Content& analysis, const BlockMatrix& K, double scale,
                      int k, const Number* panel) {
  const Supernodes s = analysis.supernodes();
  const auto at = static_cast<std::size_t>(k);
  const int first = s.first_column[at], columns = s.first_column[at + 1] - first;
  const std::ptrdiff_t stride = s.first_row[at + 1] - s.first_row[at];
  double smallest = 1.0;
  for (int j = 0; j < columns; ++j) {
    const int unknown = analysis.order()[first + j];
    const int node = unknown / 3, axis = unknown % 3;
    const double before = K.block(K.pattern().find(node, node))(axis, axis) / scale;
    const double pivot = static_cast<double>(panel[j + j * stride]);
    smallest = std::min(smallest, pivot * pivot / before);
  }
  return smallest;
}

// The supernodal factor in single precision, left-looking: each panel takes the products of the
// panels to its left that reach into its columns, then is factorised itself (as CHOLMOD does it in
// double precision; Chen, Davis, Hager, Rajamanickam 2008, sec. 3.2).
class SingleFactor {
 public:
  SingleFactor(const CholeskyAnalysis::Content& analysis, double scale)
      : analysis_(analysis),
        scale_(scale),
        s_(analysis.supernodes()),
        values_(static_cast<std::size_t>(analysis.symbolic->xsize)),
        row_in_panel_(static_cast<std::size_t>(analysis.size())),
        waiting_(s_.first_column.size() - 1, -1),
        next_waiting_(waiting_.size(), -1),
        used_rows_(waiting_.size(), 0) {}

  // False: the matrix is not positive definite to single precision.
  bool factorise(const BlockMatrix& K) {
    for (int k = 0; k < count(); ++k) {
      for (int i = 0; i < rows(k); ++i) row_in_panel_[at(row_list(k)[i])] = i;
      fill(k, K);
      for (int left = waiting_[at(k)]; left >= 0;) {
        const int next = next_waiting_[at(left)];
        subtract(left, k);
        left = next;
      }
      if (!eliminate(k, K)) return false;
    }
    return true;
  }

  template <class Panels>
  void copy_to(Panels& panels) {
    for (int k = 0; k < count(); ++k) panels.set(k, panel(k));
  }

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  [[nodiscard]] int count() const { return static_cast<int>(s_.first_column.size()) - 1; }
  [[nodiscard]] int columns(int k) const {
    return s_.first_column[at(k + 1)] - s_.first_column[at(k)];
  }
  [[nodiscard]] int rows(int k) const { return s_.first_row[at(k + 1)] - s_.first_row[at(k)]; }
  [[nodiscard]] const int* row_list(int k) const { return s_.rows.data() + s_.first_row[at(k)]; }
  [[nodiscard]] float* panel(int k) { return values_.data() + analysis_.first_value()[k]; }

  // The entries of K in the columns of panel k.
  void fill(int k, const BlockMatrix& K) {
    const BlockPattern& pattern = K.pattern();
    const int first = s_.first_column[at(k)], stride = rows(k);
    float* const X = panel(k);
    for (int j = 0; j < columns(k); ++j) {
      const int unknown = analysis_.order()[at(first + j)];
      const int node = unknown / 3, axis = unknown % 3;
      for (int p = pattern.row_start[at(node)]; p < pattern.row_start[at(node + 1)]; ++p) {
        const auto B = K.block(p);
        for (int i = 0; i < 3; ++i) {
          const int row = analysis_.place_of_unknown[at(3 * pattern.column[at(p)] + i)];
          if (row < first + j) continue;
          X[static_cast<std::ptrdiff_t>(j) * stride + row_in_panel_[at(row)]] =
              static_cast<float>(B(axis, i) / scale_);
        }
      }
    }
  }

  // Subtracts from panel k the contribution of panel `left`.
  void subtract(int left, int k) {
    const int begin = used_rows_[at(left)], all = rows(left), depth = columns(left);
    const int* const row = row_list(left);
    const int end_column = s_.first_column[at(k + 1)];
    const int end = static_cast<int>(std::lower_bound(row + begin, row + all, end_column) - row);
    const int width = end - begin, height = all - begin;
    product_.resize(at(width) * at(height));
    const float* const L = panel(left);
    cblas_ssyrk(CblasColMajor, CblasLower, CblasNoTrans, width, depth, 1.0F, L + begin, all, 0.0F,
                product_.data(), height);
    if (height > width) {
      cblas_sgemm(CblasColMajor, CblasNoTrans, CblasTrans, height - width, width, depth, 1.0F,
                  L + end, all, L + begin, all, 0.0F, product_.data() + width, height);
    }
    target_.resize(at(height));
    for (int i = 0; i < height; ++i) target_[at(i)] = row_in_panel_[at(row[begin + i])];
    for (int j = 0; j < width; ++j) {
      float* const column = panel(k) + static_cast<std::ptrdiff_t>(target_[at(j)]) * rows(k);
      const float* const from = product_.data() + static_cast<std::ptrdiff_t>(j) * height;
      for (int i = j; i < height; ++i) column[target_[at(i)]] -= from[i];
    }
    used_rows_[at(left)] = end;
    wait(left);
  }

  bool eliminate(int k, const BlockMatrix& K) {
    const int n = columns(k), stride = rows(k);
    float* const X = panel(k);
    int info = 0;
    spotrf_("L", &n, X, &stride, &info);
    if (info != 0) return false;
    if (smallest_pivot(analysis_, K, scale_, k, X) < kSmallestPivot<float>) return false;
    if (stride > n) {
      cblas_strsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, stride - n, n,
                  1.0F, X, stride, X + n, stride);
    }
    used_rows_[at(k)] = n;
    wait(k);
    return true;
  }

  // Panel `left` is next needed by the supernode of its first row that was not used yet.
  void wait(int left) {
    if (used_rows_[at(left)] == rows(left)) return;
    const int where = analysis_.supernode_of_column[at(row_list(left)[used_rows_[at(left)]])];
    next_waiting_[at(left)] = waiting_[at(where)];
    waiting_[at(where)] = left;
  }

  const CholeskyAnalysis::Content& analysis_;
  double scale_;
  Supernodes s_;
  std::vector<float> values_, product_;
  std::vector<int> row_in_panel_, target_;
  // For each supernode, a linked list of the panels to its left that it has to subtract next.
  std::vector<int> waiting_, next_waiting_;
  std::vector<int> used_rows_;
};

}  // namespace

namespace {

// CHOLMOD's factor of K / scale into the panels; false if K is not positive definite.
template <class Panels>
bool factorise_in_double(const CholeskyAnalysis::Content& analysis, const BlockMatrix& K,
                         double scale, cholmod_common& common, Panels& panels) {
  const OneThread one_thread;
  LowerColumns columns = analysis.columns;
  columns.fill(K);
  for (double& value : columns.value) value /= scale;
  cholmod_sparse A = columns.view();
  const std::unique_ptr<cholmod_factor, void (*)(cholmod_factor*)> L(
      cholmod_copy_factor(analysis.symbolic, &common), free_factor);
  if (L) cholmod_factorize(&A, L.get(), &common);
  refuse_if_out_of_memory(common);
  if (!L || common.status != CHOLMOD_OK || L->minor < L->n) return false;
  for (int k = 0; k < static_cast<int>(L->nsuper); ++k) {
    const double* const panel =
        static_cast<const double*>(L->x) + static_cast<const int*>(L->px)[k];
    if (smallest_pivot(analysis, K, scale, k, panel) < kSmallestPivot<double>) return false;
    panels.set(k, panel);
  }
  return true;
}

}  // namespace

ExactFactor::ExactFactor(const CholeskyAnalysis& analysis, const BlockMatrix& K,
                         FactorWorkspace& workspace) {
  const OneThread one_thread;
  cholmod_common& common = workspace.content().common;
  LowerColumns columns = analysis.content().columns;
  columns.fill(K);
  cholmod_sparse A = columns.view();
  const std::shared_ptr<cholmod_factor> L(cholmod_copy_factor(analysis.content().symbolic, &common),
                                          free_factor);
  if (L) cholmod_factorize(&A, L.get(), &common);
  refuse_if_out_of_memory(common);
  if (!L || common.status != CHOLMOD_OK || L->minor < L->n) {
    throw Error("the stiffness is not positive definite: the body can move without resistance");
  }
  factor_ = L;
}

void ExactFactor::solve(Eigen::MatrixXd& B, FactorWorkspace& workspace) const {
  const OneThread one_thread;
  cholmod_common& common = workspace.content().common;
  // CHOLMOD only reads the factor, but its argument is not const.
  auto* const L = static_cast<cholmod_factor*>(const_cast<void*>(factor_.get()));
  PALPABLE_EXPECT(static_cast<std::size_t>(B.rows()) == L->n, "B has the rows of the matrix");
  cholmod_dense b{};
  b.nrow = b.d = static_cast<std::size_t>(B.rows());
  b.ncol = static_cast<std::size_t>(B.cols());
  b.nzmax = b.nrow * b.ncol;
  b.x = B.data();
  b.xtype = CHOLMOD_REAL;
  b.dtype = CHOLMOD_DOUBLE;
  cholmod_dense* x = cholmod_solve(CHOLMOD_A, L, &b, &common);
  refuse_if_out_of_memory(common);
  PALPABLE_EXPECT(x != nullptr, "a factor solves");
  B = Eigen::Map<const Eigen::MatrixXd>(static_cast<const double*>(x->x), B.rows(), B.cols());
  cholmod_free_dense(&x, &common);
}

std::optional<CholeskyFactor> CholeskyFactor::make(const CholeskyAnalysis& analysis,
                                                   const BlockMatrix& K, FactorPrecision precision,
                                                   FactorWorkspace& workspace) try {
  auto content = std::make_shared<Content>();
  content->analysis = analysis.content_;
  content->scale = scale_of(K);
  if (!(content->scale > 0.0) || !std::isfinite(content->scale)) return std::nullopt;
  const Supernodes supernodes = analysis.content().supernodes();
  if (precision == FactorPrecision::k16Bits) {
    content->panels.emplace<TriangularPanels<BFloat16>>(supernodes);
  } else {
    content->panels.emplace<TriangularPanels<float>>(supernodes);
  }
  const bool definite = std::visit(
      [&](auto& panels) {
        {
          SingleFactor single(analysis.content(), content->scale);
          if (single.factorise(K)) {
            single.copy_to(panels);
            return true;
          }
        }
        return factorise_in_double(analysis.content(), K, content->scale,
                                   workspace.content().common, panels);
      },
      content->panels);
  if (!definite) return std::nullopt;
  return CholeskyFactor(std::move(content));
} catch (const std::bad_alloc&) {
  throw Error(fmt::format(
      "the sparse factor does not fit into memory ({:.1f} million nonzeros); use a coarser mesh",
      analysis.nonzeros() / 1e6));
}

void CholeskyFactor::solve_roughly(const Eigen::VectorXd& b, Eigen::VectorXd& x,
                                   FactorWorkspace& workspace) const {
  const CholeskyAnalysis::Content& analysis = *content_->analysis;
  const Eigen::Index n = analysis.size();
  PALPABLE_EXPECT(b.size() == n, "the right-hand side has the size of the matrix");
  x.resize(n);
  // Single precision has a small range: work with numbers of order one.
  const double scale = b.cwiseAbs().maxCoeff();
  if (scale == 0.0) {
    x.setZero();
    return;
  }
  std::vector<float>& y = workspace.content().permuted;
  std::vector<float>& z = workspace.content().gathered;
  y.resize(n);
  const int* const order = analysis.order().data();
  for (Eigen::Index i = 0; i < n; ++i) { y[i] = static_cast<float>(b[order[i]] / scale); }
  std::visit(
      [&](const auto& panels) {
        z.resize(panels.scratch_size());
        panels.solve(best_simd_level(), y, z);
      },
      content_->panels);
  for (Eigen::Index i = 0; i < n; ++i) {
    x[order[i]] = scale / content_->scale * static_cast<double>(y[i]);
  }
}

void CholeskyFactor::solve_together(std::span<const Eigen::VectorXd* const> b,
                                    std::span<Eigen::VectorXd* const> x,
                                    FactorWorkspace& workspace) const {
  const std::size_t count = b.size();
  PALPABLE_EXPECT(count == x.size() && count <= kMostTogether, "as many solutions as systems, 16");
  const CholeskyAnalysis::Content& analysis = *content_->analysis;
  const Eigen::Index n = analysis.size();
  const int* const order = analysis.order().data();
  const auto rows = static_cast<std::size_t>(n);
  std::vector<SixteenFloats>& y = workspace.content().many_permuted;
  std::vector<SixteenFloats>& z = workspace.content().many_gathered;
  y.resize(rows);
  // Single precision has a small range: work with numbers of order one.
  std::array<double, kMostTogether> scale{}, inverse{};
  for (std::size_t s = 0; s < count; ++s) {
    PALPABLE_EXPECT(b[s]->size() == n, "the right-hand side has the size of the matrix");
    scale[s] = b[s]->cwiseAbs().maxCoeff();
    inverse[s] = scale[s] > 0.0 ? 1.0 / scale[s] : 0.0;
  }
  for (std::size_t i = 0; i < rows; ++i) {
    y[i] = {};
    for (std::size_t s = 0; s < count; ++s) {
      y[i].of[s] = static_cast<float>((*b[s])[order[i]] * inverse[s]);
    }
  }
  std::visit(
      [&](const auto& panels) {
        z.resize(panels.scratch_size());
        panels.solve_together(best_simd_level(), {y.data()->of, kMostTogether * y.size()},
                              {z.data()->of, kMostTogether * z.size()});
      },
      content_->panels);
  for (std::size_t s = 0; s < count; ++s) {
    x[s]->resize(n);
    const double back = scale[s] / content_->scale;
    for (std::size_t i = 0; i < rows; ++i) {
      (*x[s])[order[i]] = back * static_cast<double>(y[i].of[s]);
    }
  }
}

Eigen::Index CholeskyFactor::size() const { return content_->analysis->size(); }

std::size_t CholeskyFactor::bytes() const {
  return std::visit([](const auto& panels) { return panels.bytes(); }, content_->panels);
}

}  // namespace palpable

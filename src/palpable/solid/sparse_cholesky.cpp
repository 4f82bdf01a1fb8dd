#include "palpable/solid/sparse_cholesky.h"

#include "palpable/base/contract.h"
#include "palpable/base/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <cholmod.h>
#include <utility>
#include <vector>

// From the OpenMP interface, of which this is all we need: <omp.h> is the compiler's own and need
// not be there for a compiler that builds without OpenMP.
extern "C" {
void omp_set_max_active_levels(int levels);
int omp_get_max_active_levels(void);
}

namespace palpable {

struct FactorWorkspace::Content {
  cholmod_common common{};
  // Reused by cholmod_solve2 from one solve to the next.
  cholmod_dense* X = nullptr;
  cholmod_dense* Y = nullptr;
  cholmod_dense* E = nullptr;
  // Of solve_roughly(): the solution in the order of elimination, and rows of it side by side.
  Eigen::VectorXf permuted, gathered;

  Content() {
    cholmod_start(&common);
    common.print = 0;  // the library is silent; the status tells
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.final_ll = 1;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_GIVEN;
    common.postorder = 1;
  }
  Content(const Content&) = delete;
  Content& operator=(const Content&) = delete;
  ~Content() {
    cholmod_free_dense(&X, &common);
    cholmod_free_dense(&Y, &common);
    cholmod_free_dense(&E, &common);
    cholmod_finish(&common);
  }
};

FactorWorkspace::FactorWorkspace() : content_(std::make_unique<Content>()) {}
FactorWorkspace::~FactorWorkspace() = default;

namespace {

// Debian's CHOLMOD asks OpenMP for four threads whatever OMP_NUM_THREADS says. A solve is to use
// one: sites run side by side, and four threads on two busy cores mostly wait for each other. No
// parallel region may become active while this object lives; the setting is the calling thread's
// own.
class OneThread {
 public:
  OneThread() : before_(omp_get_max_active_levels()) { omp_set_max_active_levels(0); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;
  ~OneThread() { omp_set_max_active_levels(before_); }

 private:
  int before_;
};

// Frees with a common of its own: the one that allocated may belong to a thread that is gone. A
// common only counts the bytes.
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

// The lower triangle of a symmetric block matrix, column by column, in arrays of ours that CHOLMOD
// only reads.
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
    const auto begin = pattern.row_start[static_cast<std::size_t>(c)];
    const auto end = pattern.row_start[static_cast<std::size_t>(c) + 1];
    for (int p = begin; p < end; ++p) {
      const int r = pattern.column[static_cast<std::size_t>(p)];
      if (r >= c) visit(r, p);
    }
  }
};

}  // namespace

struct CholeskyAnalysis::Content {
  LowerColumns columns;
  cholmod_factor* symbolic = nullptr;

  explicit Content(const BlockPattern& pattern) : columns(pattern) {}
  Content(const Content&) = delete;
  Content& operator=(const Content&) = delete;
  ~Content() { free_factor(symbolic); }
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
    for (int p = pattern.row_start[static_cast<std::size_t>(c)];
         p < pattern.row_start[static_cast<std::size_t>(c) + 1]; ++p) {
      const int r = pattern.column[static_cast<std::size_t>(p)];
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
  content_ = std::move(content);
}

double CholeskyAnalysis::nonzeros() const { return static_cast<double>(content_->symbolic->xsize); }

struct CholeskyFactor::Content {
  cholmod_factor* factor = nullptr;
  Eigen::VectorXf rounded;  // factor->x

  Content() = default;
  Content(const Content&) = delete;
  Content& operator=(const Content&) = delete;
  ~Content() { free_factor(factor); }
};

std::optional<CholeskyFactor> CholeskyFactor::make(const CholeskyAnalysis& analysis,
                                                   const BlockMatrix& K,
                                                   FactorWorkspace& workspace) {
  const OneThread one_thread;
  cholmod_common& common = workspace.content().common;
  auto content = std::make_shared<Content>();
  content->factor =
      cholmod_copy_factor(const_cast<cholmod_factor*>(analysis.content().symbolic), &common);
  LowerColumns columns = analysis.content().columns;
  columns.fill(K);
  cholmod_sparse A = columns.view();
  if (content->factor != nullptr) cholmod_factorize(&A, content->factor, &common);
  refuse_if_out_of_memory(common);
  if (content->factor == nullptr || common.status == CHOLMOD_NOT_POSDEF ||
      content->factor->minor < content->factor->n) {
    return std::nullopt;
  }
  PALPABLE_EXPECT(content->factor->is_super && content->factor->itype == CHOLMOD_INT,
                  "the factor is supernodal, with int indices, as asked for");
  content->rounded =
      Eigen::Map<const Eigen::VectorXd>(static_cast<const double*>(content->factor->x),
                                        static_cast<Eigen::Index>(content->factor->xsize))
          .cast<float>();
  return CholeskyFactor(std::move(content));
}

void CholeskyFactor::solve(const Eigen::VectorXd& b, Eigen::VectorXd& x,
                           FactorWorkspace& workspace) const {
  const OneThread one_thread;
  FactorWorkspace::Content& scratch = workspace.content();
  PALPABLE_EXPECT(b.size() == static_cast<Eigen::Index>(content_->factor->n),
                  "the right-hand side has the size of the matrix");
  cholmod_dense B{};
  B.nrow = B.nzmax = B.d = static_cast<std::size_t>(b.size());
  B.ncol = 1;
  B.x = const_cast<double*>(b.data());  // only read
  B.xtype = CHOLMOD_REAL;
  B.dtype = CHOLMOD_DOUBLE;
  if (cholmod_solve2(CHOLMOD_A, content_->factor, &B, nullptr, &scratch.X, nullptr, &scratch.Y,
                     &scratch.E, &scratch.common) == 0) {
    refuse_if_out_of_memory(scratch.common);
    throw Error("the sparse factor could not be applied");
  }
  x = Eigen::Map<const Eigen::VectorXd>(static_cast<const double*>(scratch.X->x), b.size());
}

void CholeskyFactor::solve_roughly(const Eigen::VectorXd& b, Eigen::VectorXd& x,
                                   FactorWorkspace& workspace) const {
  const cholmod_factor& L = *content_->factor;
  const auto n = static_cast<Eigen::Index>(L.n);
  PALPABLE_EXPECT(b.size() == n, "the right-hand side has the size of the matrix");
  // Supernode k: columns super[k] .. super[k + 1] of L, stored as one dense panel whose rows are
  // numbered by s[pi[k]] .. s[pi[k + 1]]; the first of those rows are its own columns.
  const int* const order = static_cast<const int*>(L.Perm);
  const int* const super = static_cast<const int*>(L.super);
  const int* const row_begin = static_cast<const int*>(L.pi);
  const int* const value_begin = static_cast<const int*>(L.px);
  const int* const rows = static_cast<const int*>(L.s);
  const auto supernodes = static_cast<Eigen::Index>(L.nsuper);

  Eigen::VectorXf& y = workspace.content().permuted;
  Eigen::VectorXf& g = workspace.content().gathered;
  y.resize(n);
  g.resize(n);
  x.resize(n);
  // Single precision has a small range: work with numbers of order one.
  const double scale = b.cwiseAbs().maxCoeff();
  if (scale == 0.0) {
    x.setZero();
    return;
  }
  for (Eigen::Index i = 0; i < n; ++i) y[i] = static_cast<float>(b[order[i]] / scale);

  using Panel = Eigen::Map<const Eigen::MatrixXf, 0, Eigen::OuterStride<>>;
  const auto visit = [&](Eigen::Index k, auto&& work) {
    const int columns = super[k + 1] - super[k];
    const int panel_rows = row_begin[k + 1] - row_begin[k];
    const float* const values = content_->rounded.data() + value_begin[k];
    const Panel own(values, columns, columns, Eigen::OuterStride<>(panel_rows));
    const Panel below(values + columns, panel_rows - columns, columns,
                      Eigen::OuterStride<>(panel_rows));
    work(y.segment(super[k], columns), own, below, rows + row_begin[k] + columns);
  };
  for (Eigen::Index k = 0; k < supernodes; ++k) {  // L z = b
    visit(k, [&](auto z, const Panel& own, const Panel& below, const int* below_rows) {
      own.template triangularView<Eigen::Lower>().solveInPlace(z);
      auto down = g.head(below.rows());
      down.noalias() = below * z;
      for (Eigen::Index i = 0; i < below.rows(); ++i) y[below_rows[i]] -= down[i];
    });
  }
  for (Eigen::Index k = supernodes; k-- > 0;) {  // L^T x = z
    visit(k, [&](auto z, const Panel& own, const Panel& below, const int* below_rows) {
      auto up = g.head(below.rows());
      for (Eigen::Index i = 0; i < below.rows(); ++i) up[i] = y[below_rows[i]];
      z.noalias() -= below.transpose() * up;
      own.template triangularView<Eigen::Lower>().transpose().solveInPlace(z);
    });
  }
  for (Eigen::Index i = 0; i < n; ++i) x[order[i]] = scale * static_cast<double>(y[i]);
}

}  // namespace palpable

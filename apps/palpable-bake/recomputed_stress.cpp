#include "apps/palpable-bake/recomputed_stress.h"

#include "palpable/campaign/held_out.h"
#include "palpable/campaign/store_rows.h"
#include "palpable/describe/body_problem.h"
#include "palpable/solid/stress.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <vector>

namespace palpable::app {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
constexpr int kSiteStep = 4, kLevelStep = 5;
constexpr int kFewest = 4, kMost = 6;  // modes of displacement a site

struct Account {
  std::vector<double> errors;

  [[nodiscard]] double worst() const { return *std::max_element(errors.begin(), errors.end()); }
  [[nodiscard]] double median() const {
    std::vector<double> sorted = errors;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
  }
};

template <class Work>
double microseconds_of(int times, const Work& work) {
  const auto begin = std::chrono::steady_clock::now();
  for (int k = 0; k < times; ++k) work();
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin)
             .count() /
         times;
}

// The elements from which stress on the skin follows: a node there takes what patches of inner
// nodes beside it say (stress_recovery.h), so two layers of elements.
TetMesh outer_layers(const TetMesh& mesh, const Boundary& boundary) {
  std::vector<char> node(static_cast<std::size_t>(mesh.node_count()), 0);
  for (const int n : boundary.node_of_vertex) node[static_cast<std::size_t>(n)] = 1;
  std::vector<int> elements;
  for (int layer = 0; layer < 2; ++layer) {
    elements.clear();
    for (int e = 0; e < mesh.tet_count(); ++e) {
      const auto touches = [&](int n) { return node[static_cast<std::size_t>(n)] != 0; };
      const auto corners = mesh.tets.col(e);
      if (std::any_of(corners.begin(), corners.end(), touches)) elements.push_back(e);
    }
    for (const int e : elements) {
      for (const int n : mesh.tets.col(e)) node[static_cast<std::size_t>(n)] = 1;
    }
  }
  std::vector<int> number(node.size(), -1), kept;
  for (std::size_t n = 0; n < node.size(); ++n) {
    if (node[n] == 0) continue;
    number[n] = static_cast<int>(kept.size());
    kept.push_back(static_cast<int>(n));
  }
  TetMesh part{mesh.nodes(Eigen::all, kept), mesh.tets(Eigen::all, elements)};
  for (int& n : part.tets.reshaped()) n = number[static_cast<std::size_t>(n)];
  return part;
}

}  // namespace

Json recomputed_stress(const BodyDescription& description, const SnapshotStore& store,
                       const SnapshotStore& held_out, const ReducedBody& body) {
  const BodyProblem problem = pose_body(description);
  const TetMesh& mesh = problem.model.mesh;
  const Boundary& boundary = problem.mesh.boundary;
  const StressRecovery recovery(mesh);
  const StoreContent& content = store.content();
  const StoredField u_field = *find_field(content, "displacement");
  const StoredField s_field = *find_field(content, "stress");
  const SnapshotRows rows = snapshot_rows(store, 0, u_field);
  const VectorXd weights = value_weights(mesh, u_field);
  const VectorXd& levels = held_out.content().levels;
  const auto on_skin = [&](const StressField& all) {
    return von_mises(StressField(all(Eigen::all, boundary.node_of_vertex)));
  };

  std::vector<Account> recomputed(kMost + 1);
  Account own;
  const HeldOutErrors of_body = held_out_errors(body, held_out);
  for (int s = 0; s < content.site_count(); s += kSiteStep) {
    const SnapshotRows site{rows.values,
                            {1, content.level_count()},
                            [&](Index first, Index count) -> MatrixXd {
                              return rows.read_first(s).middleRows(first, count);
                            },
                            [&](int) { return rows.read_first(s); }};
    const Reduction modes =
        reduce(site, weights, {.tolerance = 1e-6, .max_modes = kMost, .weight_snapshots = true});
    const SeparatedTensor& block = modes.blocks[0];
    MatrixXd G = MatrixXd::Zero(content.levels.size(), block.F.cols());
    G.bottomRows(content.level_count()) = block.G[0];
    const SeparatedField field(block.F.cast<float>(),
                               {{"level", content.levels, G, Between::kSmooth}});
    const Eigen::MatrixXf truths = held_out.rows(s, s_field, 0, Index{6} * mesh.node_count());
    for (Index l = 0; l < levels.size() - 1; l += kLevelStep) {
      own.errors.push_back(of_body.von_mises(l, s));
      const VectorXd truth =
          on_skin(StressField(truths.col(l).cast<double>().reshaped(6, mesh.node_count())));
      for (int m = kFewest; m <= kMost; ++m) {
        const SeparatedField cut = field.truncated(std::min(m, field.mode_count()));
        Eigen::VectorXf u(cut.value_count());
        const double mu[1] = {levels[l + 1]};
        cut.evaluate(mu, {u.data(), static_cast<std::size_t>(u.size())});
        const VectorXd found = on_skin(nodal_cauchy_stress(
            problem.model, u.cast<double>().reshaped(3, mesh.node_count()), recovery));
        recomputed[static_cast<std::size_t>(m)].errors.push_back(
            (found - truth).cwiseAbs().maxCoeff() / truth.maxCoeff());
      }
    }
  }

  const TetMesh outer = outer_layers(mesh, boundary);
  SolidModel part;
  part.mesh = outer;
  part.material = problem.model.material;
  const StressRecovery part_recovery(outer);
  const Eigen::Matrix3Xd rest = Eigen::Matrix3Xd::Zero(3, outer.node_count());
  const double us_stress =
      microseconds_of(5, [&] { (void)nodal_cauchy_stress(part, rest, part_recovery); });
  const double V = body.surface.vertex_count(), S = content.site_count();
  Json result;
  result["sites"] = (content.site_count() + kSiteStep - 1) / kSiteStep;
  result["levels"] = (levels.size() - 2) / kLevelStep + 1;
  result["outer_nodes"] = outer.node_count();
  result["outer_tets"] = outer.tet_count();
  const auto row = [&](const std::string& name, const Account& account, double bytes, double us) {
    result["rows"].push_back({{"stress", name},
                              {"vm_median", account.median()},
                              {"vm_worst", account.worst()},
                              {"bytes", static_cast<long long>(bytes)},
                              {"us", us}});
  };
  std::vector<float> u(static_cast<std::size_t>(body.displacement.value_count()));
  std::vector<float> sigma(static_cast<std::size_t>(body.stress.value_count()));
  std::vector<float> vm(u.size() / 3);
  const double mu[2] = {0.0, 0.5};
  row("a field of its own", own,
      4.0 * V * (3.0 * body.displacement.mode_count() + 6.0 * body.stress.mode_count()),
      microseconds_of(200, [&] {
        body.displacement.evaluate(mu, u);
        body.stress.evaluate(mu, sigma);
        von_mises(sigma, vm);
      }));
  for (int m = kFewest; m <= kMost; ++m) {
    const SeparatedField few(
        Eigen::MatrixXf::Ones(Index{3} * outer.node_count(), m),
        {{"level", content.levels, MatrixXd::Ones(content.levels.size(), m), Between::kSmooth}});
    Eigen::VectorXf moved(few.value_count());
    const double us_u = microseconds_of(200, [&] {
      few.evaluate({mu + 1, 1}, {moved.data(), static_cast<std::size_t>(moved.size())});
    });
    row(fmt::format("from {} modes of displacement", m), recomputed[static_cast<std::size_t>(m)],
        4.0 * 3.0 * outer.node_count() * m * S, us_u + us_stress);
  }
  return result;
}

}  // namespace palpable::app

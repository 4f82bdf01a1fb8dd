#include "bench/bake/recomputed_stress.h"

#include "palpable/bake/campaign/held_out.h"
#include "palpable/bake/campaign/store_rows.h"
#include "palpable/bake/describe/body_problem.h"
#include "palpable/bake/solid/stress.h"
#include "palpable/common/base/order_statistics.h"

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
constexpr int kFewest = 4, kMost = 6;  // modes of displacement per site

struct Account {
  std::vector<double> errors;

  [[nodiscard]] double worst() const { return *std::max_element(errors.begin(), errors.end()); }
  [[nodiscard]] double median() const {
    std::vector<double> copy = errors;
    return upper_median(copy);
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

// The elements on which stress on the skin depends: two layers, because stress at a node of the
// skin is recovered from patches of the inner nodes beside it (stress_recovery.h).
TetMesh outer_layers(const TetMesh& mesh, const Boundary& boundary) {
  std::vector<char> node(mesh.node_count(), 0);
  for (const int n : boundary.node_of_vertex) node[n] = 1;
  std::vector<int> elements;
  for (int layer = 0; layer < 2; ++layer) {
    elements.clear();
    for (int e = 0; e < mesh.tet_count(); ++e) {
      const auto touches = [&](int n) { return node[n] != 0; };
      const auto corners = mesh.tets.col(e);
      if (std::any_of(corners.begin(), corners.end(), touches)) elements.push_back(e);
    }
    for (const int e : elements) {
      for (const int n : mesh.tets.col(e)) node[n] = 1;
    }
  }
  std::vector<int> number(node.size(), -1), kept;
  for (std::size_t n = 0; n < node.size(); ++n) {
    if (node[n] == 0) continue;
    number[n] = static_cast<int>(kept.size());
    kept.push_back(static_cast<int>(n));
  }
  TetMesh part{mesh.nodes(Eigen::all, kept), mesh.tets(Eigen::all, elements)};
  for (int& n : part.tets.reshaped()) n = number[n];
  return part;
}

// The compared snapshots, and the data that all states share.
struct Campaign {
  const SnapshotStore& store;
  const SnapshotStore& held_out;
  const BodyProblem& problem;
  StressRecovery recovery{problem.model.mesh};

  [[nodiscard]] VectorXd von_mises_on_skin(const StressField& stress) const {
    return von_mises(StressField(stress(Eigen::all, problem.mesh.boundary.node_of_vertex)));
  }
};

// Displacement of one site at all nodes as a function of the level, in up to kMost modes.
SeparatedField few_modes(const Campaign& campaign, int site) {
  const StoreContent& content = campaign.store.content();
  const StoredField field = *find_field(content, "displacement");
  const SnapshotRows rows = snapshot_rows(campaign.store, 0, field);
  const SnapshotRows of_site{rows.values,
                             {1, content.level_count()},
                             [&](Index first, Index count) -> MatrixXd {
                               return rows.read_first(site).middleRows(first, count);
                             },
                             [&](int) { return rows.read_first(site); }};
  const Reduction modes = reduce(of_site, value_weights(campaign.problem.model.mesh, field),
                                 {.tolerance = 1e-6, .max_modes = kMost, .weight_snapshots = true});
  const SeparatedTensor& block = modes.blocks[0];
  MatrixXd G = MatrixXd::Zero(content.levels.size(), block.F.cols());
  G.bottomRows(content.level_count()) = block.G[0];
  return {block.F.cast<float>(), {{"level", content.levels, G, Between::kSmooth}}};
}

// Adds the errors of one site at some intermediate levels; recomputed[m] is for m modes.
void add_site(const Campaign& campaign, int site, std::vector<Account>& recomputed) {
  const SolidModel& model = campaign.problem.model;
  const int N = model.mesh.node_count();
  const SeparatedField field = few_modes(campaign, site);
  const StoreContent& between = campaign.held_out.content();
  const StoredField stress = *find_field(between, "stress");
  const Eigen::MatrixXf truths = campaign.held_out.rows(site, stress, 0, Index{6} * N);
  for (Index l = 0; l < between.level_count(); l += kLevelStep) {
    const VectorXd truth =
        campaign.von_mises_on_skin(StressField(truths.col(l).cast<double>().reshaped(6, N)));
    for (int m = kFewest; m <= kMost; ++m) {
      const SeparatedField cut = field.truncated(std::min(m, field.mode_count()));
      Eigen::VectorXf u(cut.value_count());
      const double mu[1] = {between.levels[l + 1]};
      cut.evaluate(mu, {u.data(), static_cast<std::size_t>(u.size())});
      const VectorXd found = campaign.von_mises_on_skin(
          nodal_cauchy_stress(model, u.cast<double>().reshaped(3, N), campaign.recovery));
      recomputed[m].errors.push_back((found - truth).cwiseAbs().maxCoeff() / truth.maxCoeff());
    }
  }
}

Json row_of(const std::string& name, const Account& account, double bytes, double us) {
  return {{"stress", name},
          {"vm_median", account.median()},
          {"vm_worst", account.worst()},
          {"bytes", static_cast<long long>(bytes)},
          {"us", us}};
}

// Time of evaluating both fields, as the live half does, us.
double own_field_us(const ReducedBody& body) {
  std::vector<float> u(body.displacement.value_count());
  std::vector<float> sigma(body.stress.value_count());
  std::vector<float> vm(u.size() / 3);
  const double mu[2] = {0.0, 0.5};
  return microseconds_of(200, [&] {
    body.displacement.evaluate(mu, u);
    body.stress.evaluate(mu, sigma);
    von_mises(sigma, vm);
  });
}

// Time of evaluating the displacement of n nodes from m modes, us.
double displacement_us(const VectorXd& levels, int n, int m) {
  const SeparatedField few(Eigen::MatrixXf::Ones(Index{3} * n, m),
                           {{"level", levels, MatrixXd::Ones(levels.size(), m), Between::kSmooth}});
  Eigen::VectorXf moved(few.value_count());
  const double level[1] = {0.5};
  return microseconds_of(200, [&] {
    few.evaluate(level, {moved.data(), static_cast<std::size_t>(moved.size())});
  });
}

}  // namespace

Json recomputed_stress(const BodyDescription& description, const SnapshotStore& store,
                       const SnapshotStore& held_out, const ReducedBody& body) {
  const BodyProblem problem = pose_body(description);
  const Campaign campaign{store, held_out, problem};
  const StoreContent& content = store.content();
  const Index between = held_out.content().level_count();
  std::vector<Account> recomputed(kMost + 1);
  Account own;
  const HeldOutErrors of_body = held_out_errors(body, held_out);
  for (int s = 0; s < content.site_count(); s += kSiteStep) {
    for (Index l = 0; l < between; l += kLevelStep) own.errors.push_back(of_body.von_mises(l, s));
    add_site(campaign, s, recomputed);
  }

  SolidModel outer;
  outer.mesh = outer_layers(problem.model.mesh, problem.mesh.boundary);
  outer.material = problem.model.material;
  const int outer_nodes = outer.mesh.node_count();
  const StressRecovery outer_recovery(outer.mesh);
  const Eigen::Matrix3Xd rest = Eigen::Matrix3Xd::Zero(3, outer_nodes);
  const double us_stress =
      microseconds_of(5, [&] { (void)nodal_cauchy_stress(outer, rest, outer_recovery); });
  const double V = body.surface.vertex_count(), S = content.site_count();
  Json result;
  result["sites"] = (content.site_count() + kSiteStep - 1) / kSiteStep;
  result["levels"] = (between - 1) / kLevelStep + 1;
  result["outer_nodes"] = outer_nodes;
  result["outer_tets"] = outer.mesh.tet_count();
  result["rows"].push_back(
      row_of("a field of its own", own,
             4.0 * V * (3.0 * body.displacement.mode_count() + 6.0 * body.stress.mode_count()),
             own_field_us(body)));
  for (int m = kFewest; m <= kMost; ++m) {
    result["rows"].push_back(row_of(fmt::format("from {} modes of displacement", m), recomputed[m],
                                    4.0 * 3.0 * outer_nodes * m * S,
                                    displacement_us(content.levels, outer_nodes, m) + us_stress));
  }
  return result;
}

}  // namespace palpable::app

// palpable bench evaluate: cost of evaluating one body.

#include "apps/common/command_line.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/common/base/stage_clock.h"
#include "palpable/common/body_file/body_file.h"
#include "palpable/common/reduced/mode_kernels.h"
#include "palpable/common/reduced/pressed_surface.h"

#include <fmt/core.h>

#include "bench/live/bench.h"
#include <array>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

using Series = std::vector<std::pair<std::string, std::vector<double>>>;

void add_to(Series& series, std::string_view name, double ms) {
  for (auto& [stage, values] : series) {
    if (stage == name) {
      values.push_back(ms);
      return;
    }
  }
  series.emplace_back(std::string(name), std::vector<double>{ms});
}

double median_of(const Series& series, std::string_view name) {
  for (const auto& [stage, values] : series) {
    if (stage == name) return percentile(values, 0.5);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

void print(Json result, const Series& series, bool json) {
  result["cores"] = std::thread::hardware_concurrency();
  for (const auto& [stage, values] : series) {
    result["stages"][stage] = {{"p50_ms", percentile(values, 0.5)},
                               {"p99_ms", percentile(values, 0.99)},
                               {"count", values.size()}};
  }
  if (json) {
    fmt::print("{}\n", result.dump(2));
    return;
  }
  fmt::print("{:<16}{:>12}{:>12}{:>10}\n", "stage", "median ms", "p99 ms", "count");
  for (const auto& [stage, values] : series) {
    fmt::print("{:<16}{:>12.4f}{:>12.4f}{:>10}\n", stage, percentile(values, 0.5),
               percentile(values, 0.99), values.size());
  }
}

struct BodyOptions {
  std::filesystem::path body;
  int repeats = 500;
  bool json = false;
};

Json about(const char* bench, const ReducedBody& body) {
  Json result;
  result["bench"] = bench;
  result["body"] = body.name;
  result["vertices"] = body.surface.vertex_count();
  result["sites"] = body.sites.size();
  result["displacement_modes"] = body.displacement.mode_count();
  result["stress_modes"] = body.stress.mode_count();
  return result;
}

// The size of the paper's bunny with the paper's reduction: one set of modes for all sites.
constexpr int kGlobalVertices = 3731;
constexpr int kGlobalModes = 60;

// A field of that size with arbitrary values.
SeparatedField global_field() {
  Eigen::MatrixXf F(3 * kGlobalVertices, kGlobalModes);
  for (Eigen::Index i = 0; i < F.size(); ++i) F(i) = static_cast<float>(i % 1000 - 500) * 1e-5f;
  const Eigen::VectorXd levels = Eigen::VectorXd::LinSpaced(27, 0, 1);
  const Eigen::VectorXd sites = Eigen::VectorXd::LinSpaced(34, 0, 33);
  return {std::move(F),
          {{"site", sites, Eigen::MatrixXd::Ones(34, kGlobalModes), Between::kNothing},
           {"level", levels, levels.replicate(1, kGlobalModes), Between::kSmooth}}};
}

void bench_evaluate(const BodyOptions& options) {
  const ReducedBody body = value_or_throw(read_pressable_body(options.body));
  const Eigen::Matrix3Xf rest = body.surface.vertices.cast<float>();
  const auto V = static_cast<std::size_t>(rest.cols());
  Eigen::Matrix3Xf vertices(3, rest.cols()), normals(3, rest.cols());
  std::vector<float> u(3 * V), mises(V), global_u(3 * kGlobalVertices);
  const SeparatedField global = global_field();
  Eigen::MatrixXf copy = global.modes();

  Series series;
  const auto timed = [&](const char* name, const auto& work) {
    StageTimes times;
    {
      const StageTimer timer(times, name);
      work();
    }
    for (const StageTime& stage : times.stages()) add_to(series, stage.name, stage.ms);
  };
  // The variants alternate, so that other load on the machine affects all of them.
  for (int i = 0; i < options.repeats; ++i) {
    const std::array mu{static_cast<double>(i % 34), 0.1 + 0.8 * (i % 97) / 97.0};
    timed("copy", [&] {
      std::memcpy(copy.data(), global.modes().data(),
                  static_cast<std::size_t>(copy.size()) * sizeof(float));
    });
    timed("global_60", [&] { global.evaluate(mu, global_u); });
  }
  for (int i = 0; i < options.repeats; ++i) {
    // Each site for several frames, as a hand stays at one.
    const std::array mu{static_cast<double>(static_cast<std::size_t>(i / 16) % body.sites.size()),
                        0.1 + 0.8 * (i % 97) / 97.0};
    timed("per_site", [&] { body.displacement.evaluate(mu, u); });
    timed("derivative", [&] { body.displacement.derivative(mu, 1, u); });
    timed("all", [&] { press_surface(body, rest, mu, vertices, normals, mises); });
  }

  Json result = about("evaluate", body);
  result["modes_per_site"] = body.displacement.largest_block();
  result["stress_modes_per_site"] = body.stress.largest_block();
  result["instructions"] = mode_kernels().front().name;
  const auto median_us = [&](const char* name) { return 1e3 * median_of(series, name); };
  const double mode_bytes = static_cast<double>(copy.size()) * sizeof(float);
  const double moved = mode_bytes + static_cast<double>(global_u.size()) * sizeof(float);
  result["us_global_60"] = median_us("global_60");
  result["us_per_site"] = median_us("per_site");
  result["us_derivative"] = median_us("derivative");
  result["us_all"] = median_us("all");
  result["copy_us"] = median_us("copy");
  // Bytes read and written per second, relative to the copy, which reads and writes each byte.
  result["bandwidth_fraction"] =
      (moved / median_us("global_60")) / (2 * mode_bytes / median_us("copy"));
  print(result, series, options.json);
}

}  // namespace

void add_bench_body(Command bench) {
  auto options = std::make_shared<BodyOptions>();
  Command command = bench.add_subcommand(
      "evaluate", "Evaluation of the reduced body, and what copying as many bytes takes");
  command.add_option("body", options->body, "Body file")
      .default_is("build/bodies/bunny.palpable, else out/demo/bunny.palpable");
  command.add_option("--repeats", options->repeats, "Frames")
      .in_range(1, 10'000'000)
      .show_default();
  command.add_json(options->json);
  command.footer("Example: palpable bench evaluate bunny.palpable");
  command.callback([options] {
    std::error_code ignored;
    for (const char* usual : {"build/bodies/bunny.palpable", "out/demo/bunny.palpable"}) {
      if (options->body.empty() && std::filesystem::exists(usual, ignored)) options->body = usual;
    }
    if (options->body.empty()) throw Error("name a body file; ./demo makes one");
    bench_evaluate(*options);
  });
}

}  // namespace palpable::app

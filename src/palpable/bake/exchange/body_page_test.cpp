#include "palpable/bake/exchange/body_page.h"

#include "tests/support/bodies.h"
#include "tests/support/test.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Eigen::Index;
using nlohmann::json;
using test::tolerance;

const BodyPageFacts kFacts{.file = "ball.palpable",
                           .file_bytes = 123456,
                           .displacement_us = 1.25,
                           .stress_us = 2.5,
                           .all_us = 4.75,
                           .repeats = 400,
                           .processor = "a processor, 2 cores",
                           .date = "2026-11-22",
                           .program = "palpable 0"};

// Six sites, four levels and, if `further`, nine combinations of further values.
ReducedBody ball(bool further) {
  ReducedBody body = test::pressed_ball(0.05, 0.01, 1);
  if (further) body = test::with_further(body);
  const Index K = 6 * 4 * (further ? 9 : 1);
  ErrorCourse course{Eigen::Vector2i(1, 4), Eigen::Vector2d(0.1, 0.002), Eigen::MatrixXf(K, 2)};
  for (Index k = 0; k < K; ++k) {
    course.snapshots(k, 0) = 0.5f;
    course.snapshots(k, 1) = 1e-3f * static_cast<float>(k + 1);
  }
  body.error = {2e-3, 4e-3, 3e-3, 5e-3};
  body.error.displacement_course = course;
  body.error.held_out = HeldOutRecord{Eigen::Vector2d(0.25, 0.75), Eigen::MatrixXf(2, 6), 1e-4,
                                      Eigen::MatrixXf::Constant(2, 6, 0.01f)};
  for (Index i = 0; i < 12; ++i) {
    body.error.held_out->displacement.data()[i] = 1e-4f * static_cast<float>(i + 1);
  }
  body.provenance = {.reduction = "per-site (a POD of each site's levels)",
                     .command_line = "palpable bake <b>ball</b>.toml",
                     .held_out = "between levels",
                     .held_out_values = {{"softness", 1.5, "between values"}}};
  body.method = "per-site";
  return body;
}

json data_of(const std::string& page) {
  const std::string begin = "id=\"data\">";
  const std::size_t from = page.find(begin) + begin.size();
  return json::parse(page.substr(from, page.find("</script>", from) - from));
}

template <class T>
std::vector<T> unpacked(const std::string& text) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t held = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    held = held << 6 | static_cast<std::uint32_t>(letters.find(c));
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += static_cast<char>(held >> bits & 255u);
  }
  std::vector<T> values(bytes.size() / sizeof(T));
  std::copy(bytes.begin(), bytes.end(), reinterpret_cast<char*>(values.data()));
  return values;
}

TEST_CASE("the page of a body says what the body says", "[exchange][pages]") {
  const ReducedBody body = ball(false);
  const std::string page = body_page(body, kFacts, "ball.csv");
  const json data = data_of(page);
  CHECK(data["fields"]["displacement"]["pooled"] == 2e-3);
  CHECK(data["fields"]["stress"]["worst"] == 5e-3);
  CHECK(data["fields"]["displacement"]["modes"] == body.displacement.mode_count());
  const json& course = data["courses"]["displacement"];
  CHECK(course["modes"] == json({1, 4}));
  CHECK(course["pooled"] == json({0.1, 0.002}));
  CHECK(course["axis"] == "modes of each site");
  CHECK(course["worst"][1].get<double>() == Approx(0.024));
  CHECK(course["median"][1].get<double>() == Approx(0.013));
  // Of 0.001, 0.002 .. 0.024: ranks 0.05 * 23 and 0.95 * 23, from 0 on.
  CHECK(course["p05"][1].get<double>() == Approx(0.00215));
  CHECK(course["p95"][1].get<double>() == Approx(0.02285));
  CHECK(data["courses"]["stress"].is_null());
  // Snapshot k is of site k / 4, level k % 4.
  CHECK(data["snapshots"]["displacement"]["values"][2][3].get<double>() == Approx(0.012));
  CHECK(data["levels"] == json({0.25, 0.5, 0.75, 1.0}));
  CHECK(data["held_out"]["displacement"][5][1].get<double>() == Approx(12e-4));
  CHECK(data["held_out"]["displacement_worst"].get<double>() == Approx(12e-4));
  CHECK(data["between_sites"].is_null());
  CHECK(data["timing"]["all_us"] == 4.75);
  CHECK(data["provenance"][1][1] == "palpable bake <b>ball</b>.toml");
  CHECK(data["provenance"][3] == json::array({"held out, softness = 1.5", "between values"}));
  CHECK(data["notes"]["held_out"] == json::array({"between levels", "between values"}));
  CHECK(data["notes"]["between_sites"] == json::array());
  CHECK_THAT(page, Contains("ball.csv") && Contains("palpable 0"));
  CHECK(data["touch"]["held_out"] == json::array());
  BodyPageFacts touched = kFacts;
  touched.touch = "anywhere";
  touched.held_out = {{PressingThing::kRim, 3.25e-3, 0.02, 0.01, 0.125}};
  const json held_out = data_of(body_page(body, touched, "x"))["touch"]["held_out"];
  CHECK((held_out.size() == 1 && held_out[0]["obstacle"] == "rim" && held_out[0]["force"] == 0.01));
  CHECK_THAT(body_table(body, touched),
             Contains("\nheld_out_touch,von_mises,,,,rim 3.25 mm,0.125,1\n"));
  CHECK_THAT(body_table(body, kFacts), !Contains("held_out_touch"));
  ReducedBody known = body;
  known.error.between_sites = 0.31;
  CHECK(data_of(body_page(known, kFacts, "x"))["between_sites"] == 0.31);
}

TEST_CASE("over further parameters a snapshot's error on the page is the worst of them",
          "[exchange][pages]") {
  const json data = data_of(body_page(ball(true), kFacts, "ball.csv"));
  // Site 2, level 3: combinations 99 .. 107 of 216.
  CHECK(data["snapshots"]["displacement"]["values"][2][3].get<double>() == Approx(0.108));
  CHECK(data["courses"]["displacement"]["count"] == 216);
  CHECK(data["functions"]["displacement"].size() >= 2);  // of the level and of further parameters
}

TEST_CASE("the modes on the page are those of the body, as large as they get",
          "[exchange][pages]") {
  const ReducedBody body = ball(false);
  const json data = data_of(body_page(body, kFacts, "ball.csv"));
  const json& modes = data["modes"]["displacement"];
  REQUIRE(modes.size() == 6);  // the first of each of six sites
  for (const json& mode : modes) {
    const int column = mode["column"];
    CHECK(body.displacement.block(0, mode["site"].get<int>()).first == column);
    double weight = 1;
    for (const ParameterAxis& axis : body.displacement.axes()) {
      weight *= axis.functions.col(column).cwiseAbs().maxCoeff();
    }
    const auto values = unpacked<std::int16_t>(mode["data"]);
    REQUIRE(static_cast<int>(values.size()) == body.displacement.value_count());
    const double scale = mode["scale"];
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double F = weight * double(body.displacement.modes()(static_cast<Index>(i), column));
      CHECK(std::abs(scale * values[i] - F) <= tolerance(0.501, "rounding to a step") * scale);
    }
  }
  const json& mesh = data["mesh"];
  const auto vertices = unpacked<std::uint16_t>(mesh["vertices"]);
  REQUIRE(static_cast<Index>(vertices.size()) == body.surface.vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const double low = mesh["low"][i % 3], size = mesh["size"][i % 3];
    CHECK(std::abs(low + size * vertices[i] / 65535 - body.surface.vertices.data()[i]) <=
          tolerance(0.501 / 65535, "rounding to a step") * size);
  }
  const auto corners = unpacked<std::uint16_t>(mesh["triangles"]);
  REQUIRE(static_cast<Index>(corners.size()) == body.surface.triangles.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    CHECK(corners[i] == body.surface.triangles.data()[i]);
  }
}

TEST_CASE("the table beside the page has the same numbers, a line each", "[exchange][pages]") {
  std::istringstream table(body_table(ball(true), kFacts));
  std::string line;
  std::getline(table, line);
  CHECK(line == "quantity,field,modes,site,level,further,value,unit");
  int snapshots = 0, held_out = 0, functions = 0;
  bool worst = false, file = false;
  while (std::getline(table, line)) {
    CHECK(std::count(line.begin(), line.end(), ',') == 7);
    snapshots += line.starts_with("error_snapshot,displacement,");
    held_out += line.starts_with("held_out,");
    functions += line.starts_with("function_of_level,displacement,");
    worst = worst || line == "error_snapshot,displacement,4,5,1,combination 8,0.216000006,1";
    file = file || line == "bytes_of_file,,,,,,123456,B";
  }
  CHECK(snapshots == 2 * 216);
  CHECK(held_out == 2 * 12);
  CHECK(functions == 5 * ball(true).displacement.mode_count());
  CHECK(worst);
  CHECK(file);
}

}  // namespace
}  // namespace palpable

#include "palpable/common/body_file/touch_file.h"

#include "palpable/common/body_file/body_file_groups.h"
#include "palpable/common/body_file/hdf5_tools.h"
#include "palpable/common/body_file/touch_text.h"
#include "tests/support/bodies.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/some_touch_tables.h"
#include "tests/support/test.h"

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using test::ScratchFolder;

ReducedBody ball() { return test::pressed_ball(0.05, 0.01, 1); }

void check_same(const RoundedRows& a, const RoundedRows& b) {
  CHECK(a.width == b.width);
  CHECK(a.values == b.values);
  CHECK(a.scale == b.scale);
}

void check_same(const SymmetricForm& a, const SymmetricForm& b) {
  CHECK(a.variables == b.variables);
  CHECK(a.degree == b.degree);
  CHECK(a.values == b.values);
  CHECK(a.scale == b.scale);
}

void check_same(const ComplianceTable& a, const ComplianceTable& b) {
  CHECK(a.vertices == b.vertices);
  CHECK(a.clusters == b.clusters);
  CHECK(a.cluster_of == b.cluster_of);
  check_same(a.basis, b.basis);
  check_same(a.beyond, b.beyond);
  CHECK(a.far_first == b.far_first);
  CHECK(a.far_second == b.far_second);
  check_same(a.couplings, b.couplings);
  CHECK(a.first == b.first);
  CHECK(a.neighbours == b.neighbours);
  CHECK(a.near == b.near);
  CHECK(a.near_scale == b.near_scale);
}

void check_same(const TouchTables& a, const TouchTables& b) {
  CHECK(a.point_spacing == b.point_spacing);
  CHECK(a.region_reach == b.region_reach);
  CHECK(a.friction == b.friction);
  check_same(a.compliance, b.compliance);
  REQUIRE(a.regions.size() == b.regions.size());
  for (std::size_t k = 0; k < a.regions.size(); ++k) {
    INFO("region " << k);
    CHECK(a.regions[k].vertex == b.regions[k].vertex);
    CHECK(a.regions[k].vertices == b.regions[k].vertices);
    check_same(a.regions[k].modes, b.regions[k].modes);
    check_same(a.regions[k].far_shapes, b.regions[k].far_shapes);
    check_same(a.regions[k].far_shares, b.regions[k].far_shares);
    check_same(a.regions[k].cubic, b.regions[k].cubic);
    check_same(a.regions[k].quartic, b.regions[k].quartic);
  }
  check_same(a.cross.modes, b.cross.modes);
  check_same(a.cross.cubic, b.cross.cubic);
  CHECK(a.shell.stress_free == b.shell.stress_free);
  CHECK(a.shell.preload == b.shell.preload);
  CHECK(a.shell.element_nodes == b.shell.element_nodes);
  CHECK(a.shell.elements == b.shell.elements);
  REQUIRE(a.shell.materials.size() == b.shell.materials.size());
  for (std::size_t k = 0; k < a.shell.materials.size(); ++k) {
    CHECK(law_name(a.shell.materials[k]) == law_name(b.shell.materials[k]));
    CHECK(constants_of(a.shell.materials[k]) == constants_of(b.shell.materials[k]));
  }
  CHECK(a.shell.material_of == b.shell.material_of);
  CHECK(a.shell.first == b.shell.first);
  CHECK(a.shell.points == b.shell.points);
  CHECK(a.shell.weights == b.shell.weights);
  REQUIRE(a.vibration.has_value() == b.vibration.has_value());
  if (a.vibration) {
    CHECK(a.vibration->omega == b.vibration->omega);
    CHECK(a.vibration->shapes == b.vibration->shapes);
    CHECK(a.vibration->loss_factor == b.vibration->loss_factor);
    CHECK(a.vibration->density == b.vibration->density);
    CHECK(a.vibration->mass == b.vibration->mass);
  }
  REQUIRE(a.held_out.size() == b.held_out.size());
  for (std::size_t k = 0; k < a.held_out.size(); ++k) {
    CHECK(a.held_out[k].thing == b.held_out[k].thing);
    for (const double HeldOutTouch::*value : kHeldOutValues) {
      CHECK(a.held_out[k].*value == b.held_out[k].*value);
    }
    CHECK(a.held_out[k].unscaled_error == b.held_out[k].unscaled_error);
  }
}

// Writes a body file whose group /touch is that of `tables`, changed by `spoil`, with a valid
// checksum.
void write_spoilt(const fs::path& path, const TouchTables& tables,
                  const std::function<void(hid_t touch)>& spoil) {
  write_touchable_body(path, ball(), tables);
  const hdf5::Image image(hdf5::all_bytes(path), {"palpable body file", kBodyFileVersion, "", ""});
  write_body_file(path, ball(), ModeStorage::kFloat32, [&](hid_t file) {
    const hdf5::Handle none(H5Pcreate(H5P_OBJECT_COPY), H5Pclose, "no memory");
    REQUIRE(H5Ocopy(image.file(), "touch", file, "touch", none, H5P_DEFAULT) >= 0);
    spoil(hdf5::open_group(file, "touch"));
  });
}

TEST_CASE("tables of touch come back from a body file to the last bit", "[body_file][files]") {
  const ScratchFolder folder("touch_file");
  const ReducedBody body = ball();
  for (const int regions : {0, 3}) {
    INFO(regions << " regions");
    TouchTables tables = test::some_touch_tables(body.surface, regions);
    if (regions > 0) tables.friction = 0.61;
    if (regions > 0) tables.vibration = test::some_vibration(tables.shell.nodes());
    write_touchable_body(folder / "ball.palpable", body, tables);
    const TouchableBody again = value_or_throw(read_touchable_body(folder / "ball.palpable"));
    CHECK(again.body.surface.vertices == body.surface.vertices);
    CHECK(again.body.displacement.modes() == body.displacement.modes());
    REQUIRE(again.touch);
    check_same(*again.touch, tables);
  }
}

// Touch tables with a coarser skin that is slightly smaller than the ball.
TouchTables carrying_tables() {
  TouchTables tables = test::some_touch_tables(ball().surface, 1);
  CoarseSkin& coarse = tables.coarse.emplace();
  coarse.surface = ball().surface;
  coarse.surface.vertices *= 0.99;
  coarse.fixed.assign(static_cast<std::size_t>(coarse.surface.vertex_count()), 0);
  coarse.fixed[3] = 1;
  return tables;
}

TEST_CASE("a coarser skin comes back from a body file with its tables",
          "[body_file][files][carried]") {
  const ScratchFolder folder("touch_file");
  const TouchTables tables = carrying_tables();
  write_touchable_body(folder / "ball.palpable", ball(), tables);
  const TouchableBody again = value_or_throw(read_touchable_body(folder / "ball.palpable"));
  REQUIRE((again.touch && again.touch->coarse));
  check_same(*again.touch, tables);
  CHECK(again.touch->coarse->surface.vertices == tables.coarse->surface.vertices);
  CHECK(again.touch->coarse->surface.triangles == tables.coarse->surface.triangles);
  CHECK(again.touch->coarse->fixed == tables.coarse->fixed);
  CHECK_THAT(touch_text(again.touch), Catch::Contains("carried by a coarser skin of"));
  const TouchableBody large = scaled(again, 3);
  CHECK(large.touch->coarse->surface.vertices.isApprox(3 * tables.coarse->surface.vertices));
}

TEST_CASE("damaged tables are a problem of their own, and no reason to refuse the body",
          "[body_file][files]") {
  const ScratchFolder folder("touch_file");
  const fs::path path = folder / "ball.palpable";
  const TouchTables tables = test::some_touch_tables(ball().surface);
  write_touchable_body(path, ball(), tables);
  const BodyAndTouch whole = value_or_throw(read_body_and_touch(path));
  CHECK(whole.touch.value()->held_out.size() == 2);
  write_spoilt(path, tables,
               [](hid_t touch) { REQUIRE(H5Ldelete(touch, "shell", H5P_DEFAULT) >= 0); });
  const BodyAndTouch spoilt = value_or_throw(read_body_and_touch(path));
  CHECK(spoilt.body.surface.vertices == ball().surface.vertices);
  REQUIRE_FALSE(spoilt.touch.ok());
  CHECK_THAT(touch_text(spoilt.touch),
             Catch::Contains("not as baked: ") && Catch::Contains("group 'shell' is missing"));
  CHECK_FALSE(read_body_and_touch(folder / "none.palpable").ok());
}

TEST_CASE("the same tables give the same bytes", "[body_file][files]") {
  const ScratchFolder folder("touch_file");
  const ReducedBody body = ball();
  for (const char* name : {"a.palpable", "b.palpable"}) {
    write_touchable_body(folder / name, body, test::some_touch_tables(body.surface));
  }
  CHECK(hdf5::all_bytes(folder / "a.palpable") == hdf5::all_bytes(folder / "b.palpable"));
}

TEST_CASE("readers without touch tables read the body, and older files have no tables",
          "[body_file][files]") {
  const ScratchFolder folder("touch_file");
  const ReducedBody body = ball();
  write_touchable_body(folder / "ball.palpable", body, test::some_touch_tables(body.surface),
                       ModeStorage::kFloat16);
  CHECK(value_or_throw(read_body_file(folder / "ball.palpable")).name == body.name);
  for (const char* old : {"tests/data/ball_v1.palpable", "tests/data/ball_v1_full.palpable"}) {
    const TouchableBody read = value_or_throw(read_touchable_body(old));
    CHECK_FALSE(read.body.name.empty());
    CHECK_FALSE(read.touch);
  }
  CHECK_THAT(read_touchable_body(folder / "none.palpable").problem().message,
             Catch::Contains("none.palpable: no such body file"));
}

using Faults = std::vector<std::pair<std::string, std::function<void(TouchTables&)>>>;

// Checks that writing refuses each fault with its name and keeps the good file.
void check_refused(const TouchTables& good, const Faults& faults) {
  const ScratchFolder folder("touch_file");
  const fs::path path = folder / "ball.palpable";
  const ReducedBody body = ball();
  CHECK(trouble_of(good, body.surface).empty());
  write_touchable_body(path, body, good);
  const std::string bytes = hdf5::all_bytes(path);
  for (const auto& [expected, spoil] : faults) {
    TouchTables tables = good;
    spoil(tables);
    std::string message = "(written)";
    try {
      write_touchable_body(path, body, tables);
    } catch (const Error& error) { message = error.what(); }
    INFO(expected << " <- " << message);
    CHECK(message.find(path.string() + ": touch: " + expected) == 0);
    CHECK(hdf5::all_bytes(path) == bytes);
  }
}

TEST_CASE("a coarser skin that breaks a rule is named", "[body_file][errors][carried]") {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  check_refused(carrying_tables(),
                {{"the coarser skin has positions that are not finite",
                  [](auto& t) { t.coarse->surface.vertices(1, 2) = kNan; }},
                 {"the coarser skin has triangles of vertices that are not there",
                  [](auto& t) { t.coarse->surface.triangles(0, 1) = 5000; }},
                 {"the coarser skin has triangles of vertices that are not there",
                  [](auto& t) { t.coarse->surface.triangles(2, 0) = -1; }},
                 {"the coarser skin does not say which vertices are held",
                  [](auto& t) { t.coarse->fixed.pop_back(); }},
                 {"the coarser skin is not where the body's is",
                  [](auto& t) { t.coarse->surface.vertices *= 2; }},
                 {"the coarser skin has no vertices",
                  [](auto& t) { t.coarse->surface.vertices.resize(3, 0); }},
                 {"the compliance is of", [](auto& t) {
                    t.coarse->surface.vertices.conservativeResizeLike(
                        Eigen::Matrix3Xd::Zero(3, t.coarse->surface.vertex_count() + 1));
                    t.coarse->fixed.push_back(0);
                  }}});
}

TEST_CASE("tables that break a rule are named, and not written over a good file",
          "[body_file][errors]") {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const TouchTables good = test::some_touch_tables(ball().surface);
  const Faults faults{
      {"the compliance is wrong in its size", [](auto& t) { t.compliance.clusters = 5000; }},
      {"the compliance is wrong in its clusters", [](auto& t) { t.compliance.clusters = 2; }},
      {"the compliance is wrong in the size of its far field",
       [](auto& t) { t.compliance.couplings.values.pop_back(); }},
      {"the compliance is wrong in its lists", [](auto& t) { t.compliance.first[1] = 4000; }},
      {"the compliance is wrong in a factor", [](auto& t) { t.compliance.basis.scale[3] = kNan; }},
      {"the compliance is wrong in a factor",
       [](auto& t) { t.compliance.couplings.scale[0] = -1; }},
      {"the compliance is wrong in a factor", [](auto& t) { t.compliance.beyond.scale[3] = kNan; }},
      {"the compliance is wrong in the size of its far field",
       [](auto& t) { t.compliance.beyond.scale.pop_back(); }},
      {"the compliance is wrong in a factor",
       [](auto& t) { t.compliance.near_scale[4] = std::numeric_limits<float>::infinity(); }},
      {"the compliance is of 12 vertices where the skin has 42",
       [](auto& t) {
         t.compliance = test::some_touch_tables(sphere_surface({0, 0, 0}, 0.1, 0)).compliance;
       }},
      {"region 1 is wrong in its middle", [](auto& t) { t.regions[1].vertex = 42; }},
      {"region 1 is wrong in its middle", [](auto& t) { t.regions[1].vertex = -1; }},
      {"region 2 is wrong in its list of vertices",
       [](auto& t) { std::swap(t.regions[2].vertices[0], t.regions[2].vertices[1]); }},
      {"region 2 is wrong in its list of vertices",
       [](auto& t) { t.regions[2].vertices[1] = t.regions[2].vertices[0]; }},
      {"region 2 is wrong in its list of vertices",
       [](auto& t) { t.regions[2].vertices.back() = 43; }},
      {"region 0 is wrong in the size of its modes",
       [](auto& t) { t.regions[0].modes.scale.pop_back(); }},
      {"region 0 is wrong in a factor of its modes",
       [](auto& t) { t.regions[0].modes.scale[2] = kNan; }},
      {"region 2 is wrong in the size of its far shapes",
       [](auto& t) { t.regions[2].far_shapes.width = 16; }},
      {"region 2 is wrong in the size of its far shapes",
       [](auto& t) { t.regions[2].far_shapes.scale.pop_back(); }},
      {"region 2 is wrong in a factor of its far shapes",
       [](auto& t) { t.regions[2].far_shapes.scale[5] = kNan; }},
      {"region 0 is wrong in the size of its far shares",
       [](auto& t) { t.regions[0].far_shares.values.pop_back(); }},
      {"region 0 is wrong in its number of far shapes",
       [](auto& t) { t.regions[0].far_shares.scale.pop_back(); }},
      // A region must own whole clusters: in a cluster that it owns in part, both its modes and its
      // far shapes would contribute.
      {"region 0 is wrong in its list of vertices",
       [](auto& t) {
         t.regions[0].vertices.resize(1);
         t.regions[0].modes.values.resize(3 * 16);
         t.regions[0].modes.scale.resize(3);
       }},
      {"region 0 is wrong in its number of modes",
       [](auto& t) { t.regions[0].cubic.variables = 15; }},
      {"region 0 is wrong in its number of modes",
       [](auto& t) { t.regions[0].cubic.variables = kMostTouchModes + 16; }},
      {"region 0 is wrong in the size of its second order",
       [](auto& t) { t.regions[0].cubic.scale.pop_back(); }},
      {"region 0 is wrong in a factor of its second order",
       [](auto& t) { t.regions[0].cubic.scale.back() = -kNan; }},
      {"region 0 is wrong in the size of its third order",
       [](auto& t) { t.regions[0].quartic.variables = 17; }},
      {"region 0 is wrong in the size of its third order",
       [](auto& t) { t.regions[0].quartic.values.pop_back(); }},
      {"the cross terms are wrong in the size of its modes",
       [](auto& t) { t.cross.modes.values.pop_back(); }},
      {"the cross terms are wrong in the size of its second order",
       [](auto& t) { t.cross.cubic.variables = 47; }},
      {"the cross terms are wrong in its number of modes",
       [](auto& t) {
         t.cross.cubic = {17, 3, std::vector<std::int16_t>(969), std::vector<float>(153)};
       }},
      {"the reach of regions is no length", [](auto& t) { t.region_reach = -0.01; }},
      {"the spacing of contact points is no length", [](auto& t) { t.point_spacing = NAN; }},
      {"the coefficient of friction", [](auto& t) { t.friction = -0.1; }},
      {"the coefficient of friction", [](auto& t) { t.friction = NAN; }},
      {"contact points 1e-06 m apart would be", [](auto& t) { t.point_spacing = 1e-6; }},
  };
  check_refused(good, faults);
}

TEST_CASE("vibration modes that break a rule are named, and not written over a good file",
          "[body_file][errors]") {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  TouchTables good = test::some_touch_tables(ball().surface);
  good.vibration = test::some_vibration(good.shell.nodes());
  check_refused(
      good,
      {{"the vibration modes are wrong in their number",
        [](auto& t) {
          t.vibration->omega.clear();
          t.vibration->shapes.resize(0, t.vibration->shapes.cols());
        }},
       {"the vibration modes are wrong in their number",
        [](auto& t) { t.vibration = test::some_vibration(43, kMostVibrationModes + 1); }},
       {"the vibration modes are wrong in their frequencies",
        [](auto& t) { t.vibration->omega[2] = NAN; }},
       {"the vibration modes are wrong in their frequencies",
        [](auto& t) { t.vibration->omega[0] = 0; }},
       {"the vibration modes are wrong in their frequencies",
        [](auto& t) { t.vibration->omega[1] = t.vibration->omega[0] - 1; }},
       {"the vibration modes are wrong in their frequencies",
        [](auto& t) { t.vibration->omega[4] = std::numeric_limits<double>::infinity(); }},
       {"the vibration modes are wrong in the size of their shapes",
        [](auto& t) { t.vibration->shapes.conservativeResize(5, 3 * 42); }},
       {"the vibration modes are wrong in the size of their shapes",
        [](auto& t) { t.vibration->shapes.conservativeResize(4, 3 * 43); }},
       {"the vibration modes are wrong in a shape",
        [](auto& t) { t.vibration->shapes(3, 17) = kNan; }},
       {"the vibration modes are wrong in the loss factor",
        [](auto& t) { t.vibration->loss_factor = 1; }},
       {"the vibration modes are wrong in the loss factor",
        [](auto& t) { t.vibration->loss_factor = -0.1; }},
       {"the vibration modes are wrong in the loss factor",
        [](auto& t) { t.vibration->loss_factor = NAN; }},
       {"the vibration modes are wrong in the density", [](auto& t) { t.vibration->density = 0; }},
       {"the vibration modes are wrong in the mass", [](auto& t) { t.vibration->mass = -1; }}});
}

TEST_CASE("a shell that breaks a rule is named, and not written over a good file",
          "[body_file][errors]") {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const TouchTables good = test::some_touch_tables(ball().surface);
  const Faults faults{
      {"the shell is wrong in its size",
       [](auto& t) { t.shell.preload.conservativeResize(3, 42); }},
      {"the shell is wrong in its size", [](auto& t) { t.shell.element_nodes = 5; }},
      {"the shell is wrong in its size",
       [](auto& t) {
         t.shell.stress_free.conservativeResize(3, 41);
         t.shell.preload.conservativeResize(3, 41);
       }},
      {"the shell is wrong in its places",
       [](auto& t) { t.shell.stress_free(1, 3) = std::numeric_limits<double>::quiet_NaN(); }},
      {"the shell is wrong in its places", [](auto& t) { t.shell.preload(1, 3) = 1e5; }},
      {"the shell is wrong in its elements", [](auto& t) { t.shell.elements[2] = 43; }},
      {"the shell is wrong in its elements", [](auto& t) { t.shell.elements.pop_back(); }},
      {"the shell is wrong in its materials", [](auto& t) { t.shell.material_of[5] = 2; }},
      {"the shell is wrong in its materials",
       [](auto& t) {
         t.shell.materials[1] = NeoHookean{-1, 2};
       }},
      {"the shell is wrong in the weights of its recovery", [](auto& t) { t.shell.first[4] = -1; }},
      {"the shell is wrong in the weights of its recovery",
       [](auto& t) { t.shell.first.pop_back(); }},
      {"the shell is wrong in the weights of its recovery",
       [](auto& t) { t.shell.points[7] = 80; }},
      {"the shell is wrong in the weights of its recovery",
       [](auto& t) { t.shell.weights[7] = kNan; }},
      {"the shell is wrong in the shape of an element",
       [](auto& t) { std::swap(t.shell.elements[1], t.shell.elements[2]); }},
      {"the shell is wrong in the shape of an element",
       [](auto& t) { t.shell.elements[1] = t.shell.elements[2]; }},
      {"the shell is of 44 nodes where the compliance has 43",
       [](auto& t) {
         t.shell.stress_free.conservativeResize(3, 44);
         t.shell.stress_free.col(43).setZero();
         t.shell.preload.setZero(3, 44);
       }},
  };
  check_refused(good, faults);
}

using FileFaults = std::vector<std::pair<std::string, std::function<void(hid_t touch)>>>;

// Faults of a file: a number, a dataset or a table is replaced or removed.
std::function<void(hid_t)> number(const char* group, const char* name, double value) {
  return [=](hid_t touch) {
    const hdf5::Handle g = hdf5::open_group(touch, group);
    REQUIRE(H5Adelete(g, name) >= 0);
    hdf5::write_number(g, name, value);
  };
}

std::function<void(hid_t)> without(const char* name) {
  return [=](hid_t touch) { REQUIRE(H5Ldelete(touch, name, H5P_DEFAULT) >= 0); };
}

template <class Value>
std::function<void(hid_t)> table(const char* name, Value value, hsize_t rows, hsize_t columns) {
  return [=](hid_t touch) {
    without(name)(touch);
    const std::vector<Value> data(rows * columns, value);
    hdf5::write_table(touch, name, data.data(), rows, columns);
  };
}

// Checks that reading refuses each fault with its name, and that the body is read without the
// tables.
void check_refused(const FileFaults& faults) {
  const ScratchFolder folder("touch_file");
  const fs::path path = folder / "ball.palpable";
  TouchTables good = test::some_touch_tables(ball().surface);
  good.vibration = test::some_vibration(good.shell.nodes());
  for (const auto& [expected, spoil] : faults) {
    write_spoilt(path, good, spoil);
    const Result<TouchableBody> read = read_touchable_body(path);
    INFO(expected << " <- " << (read.ok() ? "(read)" : read.problem().message));
    REQUIRE_FALSE(read.ok());
    CHECK(read.problem().message.find(path.string() + ": ") == 0);
    CHECK(read.problem().message.find(expected) != std::string::npos);
    CHECK(read_body_file(path).ok());
  }
}

TEST_CASE("older held-out touches without error indicators are read, and calibrate nothing",
          "[body_file]") {
  const ScratchFolder folder("touch_file");
  const fs::path path = folder / "ball.palpable";
  const TouchTables good = test::some_touch_tables(ball().surface);
  REQUIRE(good.held_out.front().unscaled_error.has_value());
  write_spoilt(path, good, [](hid_t touch) {
    REQUIRE(H5Ldelete(touch, "held_out/unscaled_error", H5P_DEFAULT) >= 0);
  });
  const TouchableBody read = read_touchable_body(path).value();
  REQUIRE(read.touch->held_out.size() == 2);
  for (const HeldOutTouch& touch : read.touch->held_out) {
    CHECK_FALSE(touch.unscaled_error.has_value());
  }
}

TEST_CASE("tables that break a rule within a file are refused by name when it is read",
          "[body_file][errors]") {
  const FileFaults faults{
      {"tables of touch have layout 0 where this program reads 2; bake the body again",
       number(".", "layout", 0)},
      {"touch: the number of regions is not valid", number(".", "regions", -1)},
      {"touch: the number of regions is not valid", number(".", "regions", NAN)},
      {"touch/region_0003: group 'region_0003' is missing", number(".", "regions", 4)},
      {"touch/compliance: group 'compliance' is missing", without("compliance")},
      {"touch/compliance: dataset 'near' is missing", without("compliance/near")},
      {"touch/compliance: attribute 'clusters' is not a count",
       number("compliance", "clusters", 2.5)},
      {"touch/compliance: dataset 'far_second' is 2 x 1 where 1 x 1 is needed",
       table("compliance/far_second", 2, 2, 1)},
      {"touch/compliance: dataset 'near_scale' is 42 x 1 where 41 x 1 is needed",
       table("compliance/first", 0, 42, 1)},
      {"touch/compliance: dataset 'first' is empty", table("compliance/first", 0, 0, 1)},
      {"touch/compliance: the near field is not in rows of sixteen",
       table("compliance/near", std::int16_t{0}, 10, 15)},
      {"touch/compliance: dataset 'neighbours' does not hold integers",
       table("compliance/neighbours", 1.0f, 10, 1)},
      {"touch: the compliance is wrong in its lists of neighbours",
       table("compliance/neighbours", 99, 10, 1)},
      {"touch/region_0001: attribute 'vertex' is not a count", number("region_0001", "vertex", .5)},
      {"touch/region_0001: attribute 'vertex' is not a count", number("region_0001", "vertex", -1)},
      {"touch: region 1 is wrong in its middle", number("region_0001", "vertex", 42)},
      {"touch/region_0002: a region has too many leading modes",
       number("region_0002", "leading", 17)},
      {"touch/region_0002: dataset 'quartic' is 70 x 1 where 126 x 1 is needed",
       number("region_0002", "leading", 6)},
      {"touch/region_0000: 'cubic' is of 528 modes, more than 512",
       [](hid_t touch) {
         table("region_0000/modes", std::int16_t{1}, 3, 528)(touch);
         table("region_0000/modes_scale", 1.0f, 3, 1)(touch);
       }},
      {"touch/cross: dataset 'cubic' is 19599 x 1 where 19600 x 1 is needed",
       table("cross/cubic", std::int16_t{1}, 19599, 1)},
      {"touch: the cross terms are wrong in the size of its modes",
       [](hid_t touch) {
         table("cross/modes", std::int16_t{1}, 3, 48)(touch);
         table("cross/modes_scale", 1.0f, 3, 1)(touch);
       }},
      {"touch: the spacing of contact points is no length", number(".", "point_spacing", 0)},
  };
  check_refused(faults);
}

TEST_CASE("a shell that breaks a rule within a file is refused by name when it is read",
          "[body_file][errors]") {
  const FileFaults faults{
      {"touch/shell: group 'shell' is missing", without("shell")},
      {"touch/shell: dataset 'preload' is missing", without("shell/preload")},
      {"touch/shell: dataset 'stress_free' does not have three columns",
       table("shell/stress_free", 0.0, 43, 2)},
      {"touch: the shell is wrong in its size", table("shell/preload", 0.0, 42, 3)},
      {"touch/shell: elements do not have 4 or 10 nodes", table("shell/elements", 0, 80, 5)},
      {"touch/shell: dataset 'material_of' is 80 x 1 where 79 x 1 is needed",
       table("shell/elements", 0, 79, 4)},
      {"touch/shell: there are too many materials", number("shell", "materials", 1e6)},
      {"touch/shell: attribute 'law_2' is missing", number("shell", "materials", 3)},
      {"touch: the shell is wrong in its materials", number("shell", "materials", 1)},
      {"touch/shell: unknown material law \"rubber\"",
       [](hid_t touch) {
         const hdf5::Handle g = hdf5::open_group(touch, "shell");
         REQUIRE(H5Adelete(g, "law_0") >= 0);
         hdf5::write_text(g, "law_0", "rubber");
       }},
      {"touch/shell: law 'neo-hookean' does not have 3 constants",
       table("shell/constants_0", 1.0, 3, 1)},
      {"touch/shell: material neo-hookean has C1 = -1 Pa", table("shell/constants_0", -1.0, 2, 1)},
      {"touch/shell: dataset 'first' is empty", table("shell/first", 0, 0, 1)},
      {"touch: the shell is wrong in the weights", table("shell/first", 0, 43, 1)},
      {"touch/held_out: dataset 'values' is 1 x 4 where 2 x 4",
       table("held_out/values", 0.01, 1, 4)},
      {"touch: the held-out touches are wrong in an obstacle", table("held_out/things", 6, 2, 1)},
      {"touch: the held-out touches are wrong in a depth", table("held_out/values", 0.0, 2, 4)},
      {"touch: the held-out touches are wrong in a depth", table("held_out/values", NAN, 2, 4)},
      {"touch/held_out: dataset 'unscaled_error' is 1 x 1 where 2 x 1",
       table("held_out/unscaled_error", 0.01, 1, 1)},
      {"touch: the held-out touches are wrong in the error indicators of a touch",
       table("held_out/unscaled_error", NAN, 2, 1)},
  };
  check_refused(faults);
}

TEST_CASE("vibration modes that break a rule within a file are refused by name when it is read",
          "[body_file][errors]") {
  check_refused({
      {"touch/vibration: dataset 'omega' is missing", without("vibration/omega")},
      {"touch/vibration: dataset 'shapes' is missing", without("vibration/shapes")},
      {"touch/vibration: attribute 'mass' is missing",
       [](hid_t touch) { REQUIRE(H5Adelete(hdf5::open_group(touch, "vibration"), "mass") >= 0); }},
      {"touch/vibration: dataset 'omega' is not one column", table("vibration/omega", 40.0, 1, 5)},
      {"touch/vibration: dataset 'omega' does not hold floating-point numbers",
       table("vibration/omega", 40, 5, 1)},
      {"touch/vibration: shapes are not of as many modes as 'omega'",
       table("vibration/omega", 40.0, 4, 1)},
      {"touch/vibration: shapes are not of as many modes as 'omega'",
       table("vibration/shapes", 1.0f, 5, 3 * 43)},
      {"touch: the vibration modes are wrong in the size of their shapes",
       table("vibration/shapes", 1.0f, 3 * 42, 5)},
      {"touch: the vibration modes are wrong in a shape",
       table("vibration/shapes", std::numeric_limits<float>::infinity(), 3 * 43, 5)},
      {"touch: the vibration modes are wrong in their frequencies",
       table("vibration/omega", -1.0, 5, 1)},
      {"touch: the vibration modes are wrong in their number",
       [](hid_t touch) {
         table("vibration/omega", 1.0, 0, 1)(touch);
         table("vibration/shapes", 1.0f, 3 * 43, 0)(touch);
       }},
      {"touch: the vibration modes are wrong in the loss factor",
       number("vibration", "loss_factor", 2)},
      {"touch: the vibration modes are wrong in the density", number("vibration", "density", -3)},
      {"touch: the vibration modes are wrong in the mass", number("vibration", "mass", NAN)},
  });
}

}  // namespace
}  // namespace palpable

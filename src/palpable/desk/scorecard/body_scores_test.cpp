// An artificial press whose truth is known in closed form. The true response has perfect scores,
// and each score is bad for the kind of wrong response that it is meant to show.

#include "palpable/common/base/error.h"
#include "palpable/common/body_file/body_file.h"
#include "palpable/desk/clip_files/camera_paths.h"
#include "palpable/desk/clip_files/frame_records.h"
#include "palpable/desk/clip_files/image_files.h"
#include "palpable/desk/scorecard/scorecard.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using Eigen::Vector3d;
using test::tolerance;

constexpr double kRadius = 0.015;  // m, of the pressing ball
const Vector3d kForcePerMetre(50, 0, -500);

// The position of the ball in a frame. The body is 100 mm high, so a ball deeper than 10 mm counts
// as passing through.
struct Moment {
  double depth;  // m, below the top; negative above it
  double seen_share;
  bool has_full_solution;
};
constexpr std::array<Moment, 8> kMoments{{{-0.050, 1, false},
                                          {-0.007, 1, false},
                                          {0.002, 1, true},  // shallow
                                          {0.006, 1, true},
                                          {0.008, 1, true},
                                          {0.012, 1, false},   // passes through
                                          {0.006, 0.2, true},  // not seen by a camera
                                          {-0.050, 1, false}}};

// A block 100 mm high whose top, at Z = 0, has vertices 2.5 mm apart.
SurfaceMesh block() {
  constexpr int kParts = 40;
  SurfaceMesh surface;
  surface.vertices.resize(3, (kParts + 1) * (kParts + 1) + 1);
  surface.triangles.resize(3, 2 * kParts * kParts + 4 * kParts);
  const auto at = [](int i, int j) { return j * (kParts + 1) + i; };
  for (int j = 0; j <= kParts; ++j) {
    for (int i = 0; i <= kParts; ++i) {
      surface.vertices.col(at(i, j)) << 0.0025 * i - 0.05, 0.0025 * j - 0.05, 0;
    }
  }
  const int bottom = static_cast<int>(surface.vertices.cols()) - 1;
  surface.vertices.col(bottom) << 0, 0, -0.1;
  int t = 0;
  for (int j = 0; j < kParts; ++j) {
    for (int i = 0; i < kParts; ++i) {
      surface.triangles.col(t++) << at(i, j), at(i + 1, j), at(i + 1, j + 1);
      surface.triangles.col(t++) << at(i, j), at(i + 1, j + 1), at(i, j + 1);
    }
  }
  for (int i = 0; i < kParts; ++i) {  // an inverted pyramid closes the mesh
    surface.triangles.col(t++) << at(i + 1, 0), at(i, 0), bottom;
    surface.triangles.col(t++) << at(i, kParts), at(i + 1, kParts), bottom;
    surface.triangles.col(t++) << at(0, i), at(0, i + 1), bottom;
    surface.triangles.col(t++) << at(kParts, i + 1), at(kParts, i), bottom;
  }
  return surface;
}

// Deforms the top to the shape of a ball above `at`, scaled by `times`, and leaves the rest
// unchanged. The stress is proportional to the displacement of a vertex.
void press(ValuedSurface& skin, const Vector2d& at, double depth, double times) {
  for (int v = 0; v + 1 < skin.surface.vertex_count(); ++v) {
    const double r = (skin.surface.vertices.col(v).head<2>() - at).norm();
    if (r >= kRadius || depth <= 0) continue;
    const double down = depth - kRadius + std::sqrt(kRadius * kRadius - r * r);
    if (down <= 0) continue;
    skin.surface.vertices(2, v) = -times * down;
    skin.values[v] = times * 1e6 * down;
  }
}

ValuedSurface at_rest() {
  ValuedSurface skin{block(), {}};
  skin.values = Eigen::VectorXd::Zero(skin.surface.vertex_count());
  return skin;
}

ValuedSurface pressed(double depth, double times = 1) {
  ValuedSurface skin = at_rest();
  press(skin, Vector2d::Zero(), depth, times);
  return skin;
}

void write_text(const fs::path& path, const std::string& text) { test::write_bytes(path, text); }

// The body's position in the camera frame, m; it is not rotated.
const Vector3d kPlace(0.01, -0.02, 0.4);
constexpr const char* kPoseText = "[1,0,0,0.01, 0,1,0,-0.02, 0,0,1,0.4, 0,0,0,1]";

void write_truth(const fs::path& folder) {
  std::string contacts, hands, path, deformed;
  fs::create_directories(folder / "deformed");
  write_valued_ply(folder / "deformed" / "rest.ply", pressed(0), kVonMisesProperty);
  for (int n = 0; n < std::ssize(kMoments); ++n) {
    const Moment& now = kMoments[n];
    const Vector3d middle(0, 0, kRadius - now.depth);
    hands += hand_line({n, {{kPlace + middle, kPlace + middle, kRadius, kRadius}}});
    path += trajectory_line({n / 30.0, Rigid3::Identity()});
    ContactLine contact{.frame = n, .touching = now.depth > 0, .site = -1};
    if (contact.touching) {
      contact.depth = now.depth;
      contact.point = Vector3d::Zero();
      contact.seen_share = now.seen_share;
    } else {
      contact.gap = -now.depth;
    }
    contacts += contact_line(contact);
    if (!now.has_full_solution) continue;
    write_valued_ply(deformed_skin_file(folder / "deformed", n), pressed(now.depth),
                     kVonMisesProperty);
    deformed +=
        deformed_line({.frame = n, .depth = now.depth, .force = now.depth * kForcePerMetre});
  }
  write_text(folder / "camera.toml", "fps = 30\ndepth_unit_m = 0.00025\n");
  write_text(folder / "scene.toml", fmt::format("camera_from_body = {}\n", kPoseText));
  write_text(folder / "contact.jsonl", contacts);
  write_text(folder / "hand.jsonl", hands);
  write_text(folder / "trajectory.txt", path);
  write_text(folder / "deformed" / "deformed.jsonl", deformed);
}

// The response of a system in a frame.
struct Response {
  ValuedSurface skin;
  bool felt = false;
  Vector3d force = Vector3d::Zero();
};
using Responses = std::function<Response(const Moment&)>;

Response perfect(const Moment& now) {
  return {pressed(now.depth), now.depth > 0, now.depth * kForcePerMetre};
}

void write_result(const fs::path& folder, const Responses& responses) {
  fs::create_directories(folder / "meshes");
  write_valued_ply(folder / "meshes" / "rest.ply", pressed(0), kVonMisesProperty);
  std::string touches;
  for (int n = 0; n < std::ssize(kMoments); ++n) {
    const Response response = responses(kMoments[n]);
    write_valued_ply(folder / "meshes" / frame_name(n, ".ply"), response.skin, kVonMisesProperty);
    if (response.felt) touches += touches_line({n, {{.force = response.force}}});
  }
  write_text(folder / "touches.jsonl", touches);
  write_text(folder / "live.json", fmt::format("{{\"camera_from_body\":{}}}", kPoseText));
}

Scorecard scores_of(const Responses& responses) {
  const test::ScratchFolder scratch("contact_scores");
  write_truth(scratch / "truth");
  write_result(scratch / "result", responses);
  return score_folders(scratch / "truth", scratch / "result", nullptr, {});
}

TEST_CASE("the truth itself as result has perfect scores", "[scorecard]") {
  const Scorecard scores = scores_of(perfect);
  const BodyScores& body = scores.body;
  CHECK(body.touch_precision == 1.0);
  CHECK(body.touch_recall == 1.0);
  CHECK(body.touch_recall_3mm == 1.0);
  CHECK(body.touch_false_discovery_5mm == 0.0);
  CHECK(body.frames_too_deep == 1);
  const double chord =
      tolerance(0.25, "mm; a chord of 5 mm (the dent is steep) in a ball of 15 mm");
  CHECK(*body.penetration_p99_mm <= chord);
  CHECK(*body.largest_jump_mm <= tolerance(1e-9, "rounding"));
  CHECK(body.jumps_above_4mm == 0);
  CHECK(body.reference_frames == 2);
  CHECK(body.reference_frames_shallow == 1);
  const double rounding = tolerance(1e-9, "weights of a corner");
  for (const auto& error : {body.displacement_error, body.max_vertex_error_mm,
                            body.max_vertex_error_mm_shallow, body.von_mises_error}) {
    REQUIRE(error.has_value());
    CHECK(error->p90 <= rounding);
  }
  CHECK(body.force_error->p90 <= tolerance(1e-5, "forces have six decimals"));
  CHECK(body.excess_indentation_mm->p99 <= rounding);
  CHECK(body.reference_frames_unseen == 1);
  CHECK(body.max_vertex_error_mm_unseen->p90 <= rounding);
  REQUIRE(body.unseen);
  CHECK(body.unseen->frames == 1);
  CHECK(body.unseen->displacement_error->p90 <= rounding);
  CHECK(body.unseen->max_vertex_error_mm->p90 <= rounding);
  CHECK(body.unseen->von_mises_error->p90 <= rounding);
  CHECK(body.unseen->force_error->p90 <= tolerance(1e-5, "forces have six decimals"));
  CHECK(body.frames_touch_unseen == 1);
  CHECK(*body.penetration_median_mm_unseen <= chord);
  CHECK(body.placement_error_mm->p90 == 0);
  CHECK(scores.frames_processed == 8);
}

TEST_CASE("a body that stays at rest misses the touch and is penetrated", "[scorecard]") {
  const Scorecard scores = scores_of([](const Moment&) { return Response{pressed(0)}; });
  CHECK(scores.body.touch_recall_3mm == 0.0);
  CHECK_FALSE(scores.body.touch_false_discovery_5mm.has_value());
  CHECK(scores.body.displacement_error->median == Approx(1));
  CHECK(scores.body.max_vertex_error_mm->median == Approx(7));  // median of 6 and 8 mm
  CHECK(scores.body.max_vertex_error_mm_shallow->median == Approx(2));
  CHECK(scores.body.von_mises_error->median == Approx(1));
  CHECK(scores.body.force_error->median == Approx(1));
  REQUIRE(scores.body.by_frame.size() == 2);
  for (const ReferenceFrame& frame : scores.body.by_frame) {
    CHECK(*frame.displacement_error == Approx(1));
    CHECK(*frame.von_mises_error == Approx(1));
    CHECK(*frame.force_error == Approx(1));
  }
  CHECK(scores.body.by_frame[0].frame < scores.body.by_frame[1].frame);
  CHECK(*scores.body.by_frame[0].max_vertex_error_mm +
            *scores.body.by_frame[1].max_vertex_error_mm ==
        Approx(14));  // 6 and 8 mm
  CHECK(scores.body.excess_indentation_mm->p99 == 0);
  // 2, 6 and 8 mm count; the 12 mm of a ball that passes through and the 6 mm that no camera sees
  // do not.
  CHECK(*scores.body.penetration_median_mm == Approx(6));
  CHECK(*scores.body.penetration_p99_mm == Approx(8 - 0.02 * 2));
  CHECK(*scores.body.penetration_median_mm_unseen == Approx(6));
}

TEST_CASE("a body that deforms twice as much as it should is overpressed, though not penetrated",
          "[scorecard]") {
  const Scorecard scores = scores_of([](const Moment& now) {
    return Response{pressed(now.depth, 2), now.depth > 0, 2 * now.depth * kForcePerMetre};
  });
  CHECK(*scores.body.penetration_p99_mm <=
        tolerance(0.25, "mm; a chord of 5 mm (the dent is steep) in a ball of 15 mm"));
  CHECK(scores.body.touch_recall_3mm == 1.0);
  CHECK(scores.body.displacement_error->median == Approx(1));
  CHECK(scores.body.von_mises_error->median == Approx(1));
  CHECK(scores.body.force_error->median == Approx(1));
  CHECK(scores.body.excess_indentation_mm->p50 == Approx(6));  // median of 2, 6 and 8 mm
  CHECK(scores.body.excess_indentation_mm->p99 == Approx(8 - 0.02 * 2));
}

TEST_CASE("a touch felt with nothing near is false, one that no camera sees is not missed",
          "[scorecard]") {
  const Scorecard early = scores_of([](const Moment& now) {
    return Response{pressed(0), now.depth > -0.04, {0, 0, -1}};  // also at 7 mm distance
  });
  CHECK(*early.body.touch_false_discovery_5mm == Approx(1.0 / 6));
  const Scorecard blind = scores_of([](const Moment& now) {
    Response response = perfect(now);
    if (now.seen_share < 0.5) response.felt = false;
    return response;
  });
  CHECK(blind.body.touch_recall_3mm == 1.0);
  CHECK(*blind.body.touch_recall == Approx(4.0 / 5));
  // Pressed far from the true place: the force may be right, the skin is not.
  const Scorecard beside = scores_of([](const Moment& now) {
    Response response = perfect(now);
    response.skin.surface.vertices = block().vertices;
    if (now.depth > 0) response.skin.surface.vertices(2, 0) = -now.depth;
    return response;
  });
  CHECK(beside.body.force_error->p90 <= tolerance(1e-5, "forces have six decimals"));
  CHECK(beside.body.displacement_error->median > 1);
  CHECK(*beside.body.penetration_median_mm == Approx(6));
}

TEST_CASE("a touch that no camera sees is scored apart from the others", "[scorecard]") {
  const Scorecard scores = scores_of([](const Moment& now) {
    return now.seen_share < 0.5 ? Response{at_rest()} : perfect(now);  // and without a felt touch
  });
  const BodyScores& deformed = scores.body;
  const double rounding = tolerance(1e-9, "weights of a corner");
  CHECK(deformed.displacement_error->p90 <= rounding);
  CHECK(deformed.max_vertex_error_mm->p90 <= rounding);
  CHECK(deformed.von_mises_error->p90 <= rounding);
  CHECK(deformed.force_error->p90 <= tolerance(1e-5, "forces have six decimals"));
  CHECK(deformed.excess_indentation_mm->p99 <= rounding);
  CHECK(deformed.reference_frames == 2);
  CHECK(deformed.reference_frames_shallow == 1);
  CHECK(deformed.reference_frames_unseen == 1);
  CHECK(deformed.max_vertex_error_mm_unseen->median == Approx(6));
  REQUIRE(deformed.unseen);
  CHECK(deformed.unseen->frames == 1);
  CHECK(deformed.unseen->displacement_error->median == Approx(1));  // at rest
  CHECK(deformed.unseen->max_vertex_error_mm->median == Approx(6));
  CHECK(deformed.unseen->von_mises_error->median == Approx(1));
  CHECK(deformed.unseen->force_error->median == Approx(1));  // not felt
  REQUIRE(deformed.unseen->by_frame.size() == 1);
  CHECK(deformed.unseen->by_frame[0].frame == 6);
  CHECK(*deformed.unseen->by_frame[0].displacement_error == Approx(1));
  CHECK(*deformed.unseen->by_frame[0].force_error == Approx(1));
}

TEST_CASE("shallow touches that no camera sees are counted, not among the deep ones",
          "[scorecard]") {
  const test::ScratchFolder scratch("contact_scores_shallow_unseen");
  const fs::path truth = scratch / "truth";
  write_truth(truth);
  write_result(scratch / "result", perfect);
  // No touch is seen. Of the frames with full solutions, that of 2 mm is shallow.
  std::string contacts;
  for (int n = 0; n < std::ssize(kMoments); ++n) {
    const double depth = kMoments[static_cast<std::size_t>(n)].depth;
    ContactLine contact{.frame = n, .touching = depth > 0, .site = -1};
    if (contact.touching) {
      contact.depth = depth;
      contact.point = Vector3d::Zero();
      contact.seen_share = 0.4;
    } else {
      contact.gap = -depth;
    }
    contacts += contact_line(contact);
  }
  write_text(truth / "contact.jsonl", contacts);
  const BodyScores scores = score_folders(truth, scratch / "result", nullptr, {}).body;
  CHECK(scores.reference_frames == 0);
  CHECK(scores.reference_frames_shallow == 0);
  CHECK(scores.reference_frames_unseen == 4);
  REQUIRE(scores.unseen);
  CHECK(scores.unseen->frames == 3);
  CHECK(scores.unseen->by_frame.size() == 3);
  CHECK_FALSE(scores.displacement_error.has_value());
  CHECK(scores.unseen->displacement_error->p90 <= tolerance(1e-9, "weights of a corner"));
}

TEST_CASE("overpress is also measured at the second of two touches", "[scorecard]") {
  const test::ScratchFolder scratch("contact_scores_two");
  const fs::path truth = scratch / "truth";
  write_truth(truth);
  // In frame 3 a second ball presses 4 mm deep, 50 mm from the first.
  const Vector2d left(-0.025, 0), right(0.025, 0);
  const auto both = [&](double times_right) {
    ValuedSurface skin = at_rest();
    press(skin, left, 0.006, 1);
    press(skin, right, 0.004, times_right);
    return skin;
  };
  std::string hands;
  for (int n = 0; n < std::ssize(kMoments); ++n) {
    HandLine line{n, {}};
    for (const auto& [at, depth] : {std::pair(left, 0.006), std::pair(right, 0.004)}) {
      const Vector3d middle = kPlace + Vector3d(at.x(), at.y(), kRadius - depth);
      line.capsules.push_back({middle, middle, kRadius, kRadius});
    }
    hands += hand_line(line);
  }
  write_text(truth / "hand.jsonl", hands);
  write_valued_ply(deformed_skin_file(truth / "deformed", 3), both(1), kVonMisesProperty);
  write_text(truth / "deformed/deformed.jsonl",
             deformed_line({.frame = 3, .depth = 0.006, .force = {0, 0, -1}}));
  const auto overpress_of = [&](double times_right) {
    write_result(scratch / "result", [&](const Moment&) { return Response{both(times_right)}; });
    return score_folders(truth, scratch / "result", nullptr, {}).body.excess_indentation_mm->p99;
  };
  CHECK(overpress_of(1) <= tolerance(1e-9, "weights of a corner"));
  CHECK(overpress_of(2) == Approx(4));
  // Without the pose of the body, only the point in contact.jsonl is a touched place.
  fs::remove(truth / "scene.toml");
  CHECK(overpress_of(2) <= tolerance(1e-9, "weights of a corner"));
}

TEST_CASE("frames left out by a result count as the body at rest", "[scorecard]") {
  const test::ScratchFolder scratch("contact_scores_left_out");
  const fs::path result = scratch / "result";
  write_truth(scratch / "truth");
  const auto scores = [&] { return score_folders(scratch / "truth", result, nullptr, {}); };
  const auto hard = [](const Moment& now) { return now.depth == 0.008; };
  write_result(result,
               [&](const Moment& now) { return hard(now) ? Response{pressed(0)} : perfect(now); });
  const Scorecard resting = scores();
  write_result(result, perfect);
  write_text(result / "live.json", fmt::format("{{\"camera_from_body\":{},\"processed\":"
                                               "[0,1,2,3,5,6,7]}}",
                                               kPoseText));
  const Scorecard left_out = scores();
  CHECK(left_out.frames_processed == 7);
  CHECK(left_out.body.reference_frames == 2);
  CHECK(left_out.body.displacement_error->median == Approx(0.5));  // median of 0 and 1
  CHECK(left_out.body.max_vertex_error_mm->median == Approx(4));
  CHECK(left_out.body.von_mises_error->median == Approx(0.5));
  CHECK(left_out.body.force_error->median == Approx(0.5));
  CHECK(*left_out.body.touch_recall_3mm == Approx(2.0 / 3));  // the touches of 6, 8 and 12 mm
  CHECK(*left_out.body.penetration_p99_mm == Approx(8).margin(0.2));
  const double rounding = tolerance(1e-12, "the same sums");
  const auto same = [&](double a, double b) { return std::abs(a - b) <= rounding; };
  CHECK(same(left_out.body.displacement_error->p90, resting.body.displacement_error->p90));
  CHECK(same(left_out.body.von_mises_error->p90, resting.body.von_mises_error->p90));
  CHECK(same(left_out.body.force_error->p90, resting.body.force_error->p90));
  CHECK(same(left_out.body.excess_indentation_mm->p99, resting.body.excess_indentation_mm->p99));
  CHECK(same(*left_out.body.penetration_p99_mm, *resting.body.penetration_p99_mm));
  CHECK(left_out.body.touch_recall_3mm == resting.body.touch_recall_3mm);
  // Without a drawn pose for the frame that was left out, the true pose is used.
  std::string poses;
  for (const int n : {0, 1, 2, 3, 5, 6, 7}) {
    poses += fmt::format("{{\"frame\":{},\"camera_from_body\":{}}}\n", n, kPoseText);
  }
  write_text(result / "pose.jsonl", poses);
  CHECK(same(*scores().body.penetration_p99_mm, *left_out.body.penetration_p99_mm));
  fs::remove(scratch / "truth/scene.toml");
  CHECK_FALSE(scores().body.penetration_p99_mm.has_value());
  // Pops need only the other frames.
  CHECK(scores().body.largest_jump_mm == left_out.body.largest_jump_mm);
}

TEST_CASE("a body with the right shape in a wrong pose has the error of that pose", "[scorecard]") {
  const test::ScratchFolder scratch("contact_scores_place");
  const fs::path truth = scratch / "clip" / "truth";
  const fs::path result = scratch / "result";
  write_truth(truth);
  write_result(result, perfect);
  write_text(result / "live.json",
             "{\"camera_from_body\":[1,0,0,0.013, 0,1,0,-0.024, 0,0,1,0.4, 0,0,0,1]}");
  const auto scores = [&] { return score_folders(truth, result, nullptr, {}); };
  CHECK(scores().body.placement_error_mm->median == Approx(5));  // shifted by 3 and 4 mm
  CHECK(scores().body.displacement_error->p90 <= tolerance(1e-9, "weights of a corner"));
  // With an unknown pose in some frame there is no score: it might be the worst frame.
  write_text(result / "pose.jsonl",
             fmt::format("{{\"frame\":0,\"camera_from_body\":{}}}\n", kPoseText));
  CHECK_FALSE(scores().body.placement_error_mm.has_value());
  fs::remove(result / "pose.jsonl");
  // Older films have scene.toml only beside the pictures.
  fs::create_directories(scratch / "clip/frames");
  fs::rename(truth / "scene.toml", scratch / "clip/frames/scene.toml");
  CHECK(scores().body.placement_error_mm->p90 == Approx(5));
  fs::remove(scratch / "clip/frames/scene.toml");
  CHECK_FALSE(scores().body.placement_error_mm.has_value());
}

TEST_CASE("a drawn skin that does not lie on the true one is refused", "[scorecard][errors]") {
  const test::ScratchFolder scratch("contact_scores_other");
  const fs::path result = scratch / "result";
  write_truth(scratch / "truth");
  write_result(result, perfect);
  const auto scores = [&] { return score_folders(scratch / "truth", result, nullptr, {}); };
  const auto draw_at_rest = [&](double scale, double lifted) {
    ValuedSurface rest = at_rest();
    rest.surface.vertices *= scale;
    rest.surface.vertices.row(2).array() += lifted;
    write_valued_ply(result / "meshes/rest.ply", rest, kVonMisesProperty);
  };
  draw_at_rest(1, 0.0009);  // 1 mm, 1 % of the height, is allowed
  CHECK(scores().body.displacement_error.has_value());
  for (const auto& [scale, lifted] : {std::pair(1.0, 0.0013), std::pair(1000.0, 0.0)}) {
    draw_at_rest(scale, lifted);
    CHECK_THROWS_WITH(scores(), Catch::Contains("meshes/rest.ply: at rest it lies ") &&
                                    Catch::Contains("deformed/rest.ply on average") &&
                                    Catch::Contains("another body, scale or frame") &&
                                    !Catch::Contains("\n"));
  }
  // Without full-order solutions the skin is compared with that of the filmed body.
  draw_at_rest(1, 0.0013);
  fs::rename(scratch / "truth/deformed/rest.ply", scratch / "truth/body.ply");
  fs::remove_all(scratch / "truth/deformed");
  CHECK_THROWS_WITH(scores(), Catch::Contains("truth/body.ply on average"));
  // Without rest.ply, the mesh of the first frame is compared.
  fs::rename(result / "meshes/rest.ply", result / "meshes/000000.ply");
  CHECK_THROWS_WITH(scores(), Catch::Contains("000000.ply: at rest it lies"));
  write_ply(result / "meshes/000000.ply", {block().vertices, Eigen::Matrix3Xi(3, 0)});
  CHECK_THROWS_WITH(scores(), Catch::Contains("000000.ply"));
}

TEST_CASE("a true skin that is not the one at rest is refused", "[scorecard][errors]") {
  const test::ScratchFolder scratch("contact_scores_triangles");
  write_truth(scratch / "truth");
  write_result(scratch / "result", perfect);
  const auto refused = [&](const ValuedSurface& skin, const char* says) {
    write_valued_ply(scratch / "truth/deformed/000003.ply", skin, kVonMisesProperty);
    CHECK_THROWS_WITH(score_folders(scratch / "truth", scratch / "result", nullptr, {}),
                      Catch::Contains("000003.ply") && Catch::Contains(says));
  };
  ValuedSurface other = pressed(0.006);
  other.surface.triangles.conservativeResize(3, other.surface.triangles.cols() - 1);
  refused(other, "other triangles than rest.ply");
  other = pressed(0.006);
  std::swap(other.surface.triangles(0, 0), other.surface.triangles(1, 0));
  refused(other, "other triangles than rest.ply");
  refused({box_surface({0, 0, 0}, {1, 1, 1}), Eigen::VectorXd::Zero(8)},
          "8 vertices, but rest.ply");
}

TEST_CASE("a skin with other triangles is compared by projection", "[scorecard]") {
  // The block with six triangles. Its top does not move, so each score is that of a body at rest.
  SurfaceMesh coarse;
  coarse.vertices.resize(3, 5);
  coarse.vertices << -0.05, 0.05, 0.05, -0.05, 0, -0.05, -0.05, 0.05, 0.05, 0, 0, 0, 0, 0, -0.1;
  coarse.triangles.resize(3, 6);
  coarse.triangles << 0, 0, 1, 2, 3, 0, 1, 2, 0, 1, 2, 3, 2, 3, 4, 4, 4, 4;
  const Scorecard scores = [&] {
    const test::ScratchFolder scratch("contact_scores_coarse");
    write_truth(scratch / "truth");
    write_result(scratch / "result", [&](const Moment&) {
      return Response{{coarse, Eigen::VectorXd::Zero(5)}};
    });
    write_ply(scratch / "result/meshes/rest.ply", coarse);
    return score_folders(scratch / "truth", scratch / "result", nullptr, {});
  }();
  CHECK(scores.body.displacement_error->p90 == Approx(1));
  CHECK(scores.body.placement_error_mm->p90 == 0);
}

TEST_CASE("a skin that jumps by more than 4 mm without a hand is a pop", "[scorecard]") {
  int frame = 0;
  const Scorecard scores = scores_of([&](const Moment& now) {
    ++frame;
    Response response = perfect(now);
    if (frame == 8)
      response.skin = pressed(0.006);  // the hand has moved away by 44 mm in one frame
    return response;
  });
  CHECK(scores.body.jumps_above_4mm == 0);  // the hand's motion explains any jump of the skin
  const Scorecard twitching = scores_of([&](const Moment& now) {
    Response response = perfect(now);
    if (now.depth == 0.008) response.skin = pressed(0.001);
    return response;
  });
  CHECK(twitching.body.jumps_above_4mm == 1);
}

TEST_CASE("a value that is unknown in one frame has no score", "[scorecard]") {
  const test::ScratchFolder scratch("contact_scores_unknown");
  const fs::path result = scratch / "result";
  write_truth(scratch / "truth");
  const auto deformed = [&] { return score_folders(scratch / "truth", result, nullptr, {}).body; };
  write_result(result, perfect);
  write_ply(result / "meshes/000003.ply", pressed(0.006).surface);  // without its stress
  CHECK_FALSE(deformed().von_mises_error.has_value());
  CHECK(deformed().displacement_error.has_value());
  write_text(result / "touches.jsonl", "{\"frame\":3}\n");  // without its force
  CHECK_FALSE(deformed().force_error.has_value());
  CHECK(deformed().displacement_error.has_value());
  write_text(result / "touches.jsonl", "{\"frame\":5}\n");  // a frame without a full-order solution
  CHECK(deformed().force_error->median == Approx(1));
  // Without rest.ply, the first mesh without a touch is the skin at rest.
  fs::remove(result / "meshes/rest.ply");
  CHECK(deformed().displacement_error->p90 <= tolerance(1e-9, "weights of a corner"));
  fs::remove(result / "meshes/000003.ply");
  CHECK_FALSE(deformed().displacement_error.has_value());
  CHECK_FALSE(deformed().excess_indentation_mm.has_value());
  CHECK(deformed().reference_frames == 2);
  // A frame that was not processed counts as the body at rest without a touch.
  write_text(result / "live.json", "{\"processed\":[0,1,2,4,5,6,7]}");
  write_text(result / "touches.jsonl",
             touches_line({3, {{.force = Vector3d(0.006 * kForcePerMetre)}}}) +
                 touches_line({4, {{.force = Vector3d(0.008 * kForcePerMetre)}}}));
  CHECK(deformed().displacement_error->median == Approx(0.5));
  CHECK(deformed().force_error->median == Approx(0.5));
}

TEST_CASE("frames marked as not scored are skipped", "[scorecard]") {
  const test::ScratchFolder scratch("contact_scores_way");
  write_truth(scratch / "truth");
  write_result(scratch / "result", perfect);
  write_text(scratch / "truth/deformed/deformed.jsonl",
             deformed_line({.frame = 3, .depth = 0.006, .force = {0, 0, -1}, .scored = false}) +
                 deformed_line({.frame = 4, .depth = 0.008, .force = {0, 0, -1}}));
  const Scorecard scores = score_folders(scratch / "truth", scratch / "result", nullptr, {});
  CHECK(scores.body.reference_frames == 1);
  write_text(scratch / "truth/deformed/deformed.jsonl",
             deformed_line({.frame = 99, .depth = 0.006, .force = {0, 0, -1}}));
  CHECK_THROWS_WITH(score_folders(scratch / "truth", scratch / "result", nullptr, {}),
                    Catch::Contains("deformed.jsonl: frame 99"));
}

TEST_CASE("with a reduced body, skin, stress and force follow from the touches", "[scorecard]") {
  const ReducedBody body = value_or_throw(read_pressable_body("tests/data/ball_v1.palpable"));
  const test::ScratchFolder scratch("contact_scores_body");
  const fs::path truth = scratch / "truth";
  const fs::path deformed_folder = truth / "deformed";
  fs::create_directories(deformed_folder);
  // The truth is the body itself, pressed at a site.
  const auto skin = [&](int site, double level) {
    const auto V = static_cast<std::size_t>(body.surface.vertex_count());
    std::vector<float> u(3 * V), stress(6 * V), mises(V);
    const std::array mu{static_cast<double>(site), level};
    body.displacement.evaluate(mu, u);
    body.stress.evaluate(mu, stress);
    von_mises(stress, mises);
    ValuedSurface pressed{
        body.surface, Eigen::Map<Eigen::VectorXf>(mises.data(), std::ssize(mises)).cast<double>()};
    pressed.surface.vertices +=
        Eigen::Map<Eigen::Matrix3Xf>(u.data(), 3, std::ssize(mises)).cast<double>();
    return pressed;
  };
  ValuedSurface rest{body.surface, Eigen::VectorXd::Zero(body.surface.vertex_count())};
  write_valued_ply(deformed_folder / "rest.ply", rest, kVonMisesProperty);
  write_valued_ply(deformed_skin_file(deformed_folder, 1), skin(1, 0.5), kVonMisesProperty);
  write_text(deformed_folder / "deformed.jsonl",
             deformed_line({.frame = 1,
                            .depth = 0.005,
                            .force = 0.5 * body.sites[1].full_load * body.sites[1].direction}));
  write_text(truth / "camera.toml", "fps = 30\ndepth_unit_m = 0.00025\n");
  write_text(
      truth / "contact.jsonl",
      "{\"frame\":0,\"touching\":false}\n{\"frame\":1,\"touching\":true,\"depth_m\":0.005}\n");
  const auto scores = [&](const std::string& touches) {
    write_text(scratch / "result/touches.jsonl", touches);
    return score_folders(truth, scratch / "result", &body, {}).body;
  };
  // A line in the format before lists: force and stress follow from site and level.
  const BodyScores right = scores("{\"frame\":1,\"site\":1,\"level\":0.5}\n");
  CHECK(right.displacement_error->median <= tolerance(1e-5, "weights of a corner, in floats"));
  CHECK(right.von_mises_error->median <= tolerance(1e-5, "weights of a corner, in floats"));
  CHECK(right.force_error->median <= tolerance(1e-6, "nine decimals"));
  const BodyScores other = scores("{\"frame\":1,\"touches\":[{\"site\":0,\"level\":0.5}]}\n");
  CHECK(other.displacement_error->median > 0.5);
  CHECK(other.von_mises_error->median > 0.2);
  CHECK(other.force_error->median > 0.2);
  const BodyScores none = scores("");
  CHECK(none.displacement_error->median == Approx(1));
  CHECK(none.von_mises_error->median == Approx(1));
  CHECK(none.force_error->median == Approx(1));
  CHECK_FALSE(scores("{\"frame\":1,\"site\":1}\n").displacement_error.has_value());
  rest.surface.vertices *= 1.1;
  write_valued_ply(deformed_folder / "rest.ply", rest, kVonMisesProperty);
  CHECK_THROWS_WITH(scores(""), Catch::StartsWith(body.name + ": at rest it lies") &&
                                    Catch::Contains("another body, scale or frame"));
}

}  // namespace
}  // namespace palpable

#include "palpable/desk/scorecard/drawn_skins.h"

#include "palpable/common/base/error.h"
#include "palpable/desk/clip_files/image_files.h"
#include "palpable/desk/score/skin_scores.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <limits>
#include <span>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr double kPassesThrough = 0.1;  // largest scored depth, ratio to the body's height

double height_of(const SurfaceMesh& skin) {
  return skin.vertices.row(2).maxCoeff() - skin.vertices.row(2).minCoeff();
}

template <class Matrix>
std::span<float> numbers_of(Matrix& matrix) {
  return {matrix.data(), static_cast<std::size_t>(matrix.size())};
}

}  // namespace

DrawnSkins::DrawnSkins(const TruthFolder& truth, const ResultFolder& result,
                       const ReducedBody* body)
    : truth_(truth), result_(result), body_(body), meshes_(fs::is_directory(result.meshes)) {
  if (meshes_) {
    find_rest_among_meshes();
    return;
  }
  if (body == nullptr) return;
  rest_ = body->surface;
  height_ = height_of(*rest_);
  expect_true_body(*rest_, body->name);
  const auto known = [](const auto& touches) {
    const FoundTouch& first = touches.second.front();
    return first.site >= 0 && first.level.has_value();
  };
  touches_give_skins_ =
      result.touches && std::all_of(result.touches->begin(), result.touches->end(), known);
}

std::optional<ValuedSurface> DrawnSkins::at(int frame, Stress stress) {
  if (meshes_) return from_file(mesh_file(frame));
  if (!touches_give_skins_) return std::nullopt;
  return from_touch(frame, stress);
}

std::optional<double> DrawnSkins::deepest_scored() const {
  // A body in a scene of several may be a beam, which can bend by more than its height. Frames in
  // which a hand passes through it are marked as not scored in its truth.
  if (truth_.part != truth_.folder) return std::numeric_limits<double>::infinity();
  if (truth_.body) return kPassesThrough * height_of(truth_.body->rest);
  if (height_) return kPassesThrough * *height_;
  return std::nullopt;
}

fs::path DrawnSkins::mesh_file(int frame) const {
  return result_.meshes / frame_name(frame, ".ply");
}

std::optional<ValuedSurface> DrawnSkins::from_file(const fs::path& path) {
  if (!fs::exists(path)) return std::nullopt;
  ValuedSurface skin = value_or_throw(read_valued_ply(path, kVonMisesProperty));
  const int count = skin.surface.vertex_count();
  if (vertices_ != 0 && count != vertices_) {
    throw Error(fmt::format("{}: {} vertices, but frames before it {}; every frame shows one body",
                            path.string(), count, vertices_));
  }
  vertices_ = count;
  return skin;
}

ValuedSurface DrawnSkins::from_touch(int frame, Stress stress) const {
  ValuedSurface skin{body_->surface, {}};
  const Eigen::Index V = skin.surface.vertices.cols();
  const auto touches = result_.touches->find(frame);
  if (touches == result_.touches->end()) {
    if (stress == Stress::kWanted) skin.values = Eigen::VectorXd::Zero(V);
    return skin;
  }
  const FoundTouch& touch = touches->second.front();
  if (touch.site >= std::ssize(body_->sites)) {
    throw Error(fmt::format("{}: frame {} presses site {}, but {} has {} sites",
                            (result_.folder / "touches.jsonl").string(), frame, touch.site,
                            body_->name, body_->sites.size()));
  }
  const std::array mu{static_cast<double>(touch.site), *touch.level};
  Eigen::Matrix3Xf u = Eigen::Matrix3Xf::Zero(3, V);
  body_->displacement.evaluate(mu, numbers_of(u));
  skin.surface.vertices += u.cast<double>();
  if (stress == Stress::kNotWanted) return skin;
  Eigen::VectorXf cauchy(6 * V);
  Eigen::VectorXf mises(V);
  body_->stress.evaluate(mu, numbers_of(cauchy));
  von_mises(numbers_of(cauchy), numbers_of(mises));
  skin.values = mises.cast<double>();
  return skin;
}

void DrawnSkins::find_rest_among_meshes() {
  const fs::path rest_file = result_.meshes / "rest.ply";
  if (const auto rest = from_file(rest_file)) {
    rest_ = rest->surface;
    height_ = height_of(*rest_);
    expect_true_body(*rest_, rest_file.string());
    return;
  }
  const auto first = std::find(result_.processed.begin(), result_.processed.end(), 1);
  const auto frame = static_cast<int>(first - result_.processed.begin());
  const auto skin = from_file(mesh_file(frame));
  if (!skin) return;
  height_ = height_of(skin->surface);
  if (truth_.contacts.empty() || truth_.contacts[frame].touching) return;
  rest_ = skin->surface;
  expect_true_body(*rest_, mesh_file(frame).string());
}

void DrawnSkins::expect_true_body(const SurfaceMesh& rest, const std::string& what) const {
  if (rest.triangle_count() == 0) {
    throw Error(fmt::format("{}: has no triangles, so it is no skin", what));
  }
  if (!truth_.body) return;
  const double offset = skin_offset(truth_.body->rest, rest);
  const double height = height_of(truth_.body->rest);
  if (offset <= kSameBody * height) return;
  throw Error(fmt::format(
      "{}: at rest it lies {:.3g} mm off {} on average (allowed: {:.3g} mm, {:g} % of "
      "the height): another body, scale or frame than the one that was filmed",
      what, 1e3 * offset, truth_.body->file.string(), 1e3 * kSameBody * height, 100 * kSameBody));
}

}  // namespace palpable

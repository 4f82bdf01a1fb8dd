#include "palpable/live/view/scene_light.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>

namespace palpable {
namespace {

constexpr int kStep = 4;           // px of the depth between two samples
constexpr int kReach = 5;          // px from a sample to the points that span its normal
constexpr double kFarthest = 1.5;  // m; farther away normals are noise
constexpr float kDarkest = 0.01f;  // linear luminance below which a pixel's hue is noise
constexpr std::uint8_t kBrightest = 247;
constexpr int kHueSteps = 16;  // across each of the two directions of the hue
constexpr int kCellsX = 8;     // of the picture, in which one hue has one albedo
constexpr int kCellsY = 5;
constexpr int kColorCells = kHueSteps * kHueSteps * kCellsX * kCellsY;
constexpr int kFewest = 12;            // samples that a paint must have
constexpr float kLeastTurn = 0.02f;    // least 1 - |mean normal| of a paint: 0.2 rad about the mean
constexpr int kFirstRounds = 40;       // of the first fit
constexpr int kRounds = 8;             // of a fit that begins with the last estimate
constexpr double kUsualWeight = 5e-4;  // of the usual light, as a ratio to that of all samples
constexpr double kUsualDirected = 1.5;     // |b| of the usual light
constexpr double kDirectedByWindow = 0.8;  // |b| estimated beside a window; the true one is 2.2
constexpr double kMostDirected = 4;    // |b|: the sun in a room is 5 times as bright as its shadows
constexpr double kFollow = 0.2;        // weight of a new estimate in light()
constexpr double kCauchy = 1.5;        // Cauchy scale, as a ratio to the spread of residuals
constexpr double kLeastSpread = 0.05;  // of residuals; or one smooth wall would outweigh the rest
constexpr double kHueShare = 0.25;     // share of the picture's mean hue in the light's colour

const std::array<float, 256>& linear_of_byte() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> t{};
    for (std::size_t i = 0; i < t.size(); ++i) {
      t[i] = std::pow(static_cast<float>(i) / 255.0f, 2.2f);
    }
    return t;
  }();
  return table;
}

Eigen::Vector3f linear_of(Rgb c) {
  const std::array<float, 256>& t = linear_of_byte();
  return {t[c.r], t[c.g], t[c.b]};
}

// The index of a colour's hue, which does not depend on its brightness.
int hue_of(const Eigen::Vector3f& c) {
  const Eigen::Vector3f share = c / c.sum();
  const auto step = [](float value) {
    return std::clamp(static_cast<int>((value + 0.5f) * kHueSteps), 0, kHueSteps - 1);
  };
  return step(1.5f * (share.x() - share.y())) * kHueSteps +
         step(share.z() - 0.5f * (share.x() + share.y()));
}

float median_of(std::span<float> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

SceneLight light_in_camera(const RoomLight& light, const Rigid3& camera_from_body) {
  SceneLight in_camera;
  in_camera.to_lamp = (camera_from_body.linear() * light.to_light).cast<float>();
  in_camera.lamp = static_cast<float>(std::clamp(light.directed / kDirectedByWindow, 0.5, 1.3));
  in_camera.color = (light.brightness * light.tint).cast<float>();
  return in_camera;
}

void LightEstimator::see(const SeenFrame& seen, const Rigid3& camera_from_body) {
  if (until_next_ > 0) {
    --until_next_;
    return;
  }
  if (seen.color.empty() || seen.depth.empty()) return;
  until_next_ = kEvery - 1;

  // Brightness and hue of the whole picture.
  double log_sum = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  long count = 0;
  for (int y = 0; y < seen.color.height(); y += 2 * kStep) {
    for (int x = 0; x < seen.color.width(); x += 2 * kStep) {
      const Eigen::Vector3f c = linear_of(seen.color(x, y));
      log_sum += std::log(c.mean() + 1e-3f);
      sum += c.cast<double>();
      ++count;
    }
  }
  const double brightness =
      std::clamp(std::exp(log_sum / static_cast<double>(count)) / kUsualMean, 0.1, 1.6);
  Eigen::Vector3d tint = Eigen::Vector3d::Ones();
  if (sum.minCoeff() > 0) {
    tint = (1 - kHueShare) * tint + kHueShare * sum / sum.mean();
    tint /= tint.mean();
  }

  sample_surfaces(seen);
  const Eigen::Matrix3d turn = camera_from_body.linear();
  const Eigen::Vector3d usual = kUsualDirected * usual_lamp(turn.col(2));
  // Rounds add up from one fit to the next.
  if (!began_) fitted_ = turn.transpose() * usual;
  fitted_ = turn.transpose() * fit(turn * fitted_, usual);

  const double follow = began_ ? kFollow : 1.0;
  began_ = true;
  const Eigen::Vector3d b = (1 - follow) * light_.directed * light_.to_light + follow * fitted_;
  light_.directed = b.norm();
  if (light_.directed > 1e-6) light_.to_light = b / light_.directed;
  light_.brightness += follow * (brightness - light_.brightness);
  light_.tint += follow * (tint - light_.tint);
}

void LightEstimator::sample_surfaces(const SeenFrame& seen) {
  const DepthImage& depth = seen.depth;
  const int factor = std::max(seen.color.width() / depth.width(), 1);
  samples_.clear();
  samples_.reserve(static_cast<std::size_t>((depth.width() / kStep + 1)) *
                   static_cast<std::size_t>(depth.height() / kStep + 1));
  by_paint_.reserve(samples_.capacity());
  const PinholeCamera& camera = seen.depth_camera;
  for (int y = kReach; y < depth.height() - kReach; y += kStep) {
    for (int x = kReach; x < depth.width() - kReach; x += kStep) {
      const float z = depth(x, y);
      const float left = depth(x - kReach, y), right = depth(x + kReach, y);
      const float above = depth(x, y - kReach), below = depth(x, y + kReach);
      // One surface and not an edge between two: both ends lie on a line with the middle. NaN
      // fails.
      if (!(z < kFarthest && std::abs(left + right - 2 * z) < 0.01f * z &&
            std::abs(above + below - 2 * z) < 0.01f * z && std::abs(right - left) < 0.06f * z &&
            std::abs(below - above) < 0.15f * z)) {
        continue;
      }
      const Rgb pixel = seen.color(factor * x, factor * y);
      if (std::max({pixel.r, pixel.g, pixel.b}) > kBrightest) continue;
      const Eigen::Vector3f color = linear_of(pixel);
      const float luminance = color.mean();
      if (luminance < kDarkest) continue;
      const Eigen::Vector3d across =
          camera.unproject(x + kReach, y, right) - camera.unproject(x - kReach, y, left);
      const Eigen::Vector3d down =
          camera.unproject(x, y + kReach, below) - camera.unproject(x, y - kReach, above);
      // X right and Y down: this product points to the camera.
      const Eigen::Vector3f normal = down.cross(across).normalized().cast<float>();
      const int cell = y * kCellsY / depth.height() * kCellsX + x * kCellsX / depth.width();
      samples_.push_back({normal, luminance, hue_of(color) * (kCellsX * kCellsY) + cell});
    }
  }
  // Sorts the samples by paint.
  first_of_paint_.assign(kColorCells + 1, 0);
  for (const Sample& s : samples_) ++first_of_paint_[static_cast<std::size_t>(s.paint) + 1];
  for (std::size_t k = 1; k < first_of_paint_.size(); ++k)
    first_of_paint_[k] += first_of_paint_[k - 1];
  std::sort(samples_.begin(), samples_.end(),
            [](const Sample& a, const Sample& b) { return a.paint < b.paint; });
  // A flat paint does not determine the light; the noise of its normals would lower |b|.
  flat_.resize(kColorCells);
  for (std::size_t k = 0; k < flat_.size(); ++k) {
    Eigen::Vector3f mean = Eigen::Vector3f::Zero();
    const auto first = static_cast<std::size_t>(first_of_paint_[k]);
    const auto last = static_cast<std::size_t>(first_of_paint_[k + 1]);
    for (std::size_t i = first; i < last; ++i) mean += samples_[i].normal;
    flat_[k] = last - first < kFewest ||
               1.0f - mean.norm() / static_cast<float>(last - first) < kLeastTurn;
  }
  by_paint_.resize(samples_.size());
  albedo_.resize(kColorCells);
}

void LightEstimator::fit_albedos(const Eigen::Vector3d& b) {
  const Eigen::Vector3f toward = b.cast<float>();
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    by_paint_[i] = samples_[i].luminance / (1.0f + std::max(toward.dot(samples_[i].normal), 0.0f));
  }
  for (std::size_t k = 0; k < albedo_.size(); ++k) {
    const auto first = static_cast<std::size_t>(first_of_paint_[k]);
    const auto count = static_cast<std::size_t>(first_of_paint_[k + 1]) - first;
    albedo_[k] = flat_[k] != 0
                     ? 0.0
                     : static_cast<double>(median_of(std::span(by_paint_).subspan(first, count)));
  }
}

Eigen::Vector3d LightEstimator::fit(Eigen::Vector3d b, const Eigen::Vector3d& usual) {
  std::vector<float>& spread = by_paint_;  // free once the albedos are known
  const int rounds = began_ ? kRounds : kFirstRounds;
  for (int round = 0; round < rounds; ++round) {
    fit_albedos(b);
    // Residuals of luminance, relative to the model's.
    const auto light_on = [&](const Sample& s) {
      return 1.0 + std::max(b.dot(s.normal.cast<double>()), 0.0);
    };
    const auto residual = [&](const Sample& s) {
      return s.luminance / (albedo_[static_cast<std::size_t>(s.paint)] * light_on(s)) - 1.0;
    };
    std::size_t used = 0;
    for (const Sample& s : samples_) {
      if (albedo_[static_cast<std::size_t>(s.paint)] == 0) continue;
      spread[used++] = static_cast<float>(std::abs(residual(s)));
    }
    if (used < kFewest) return usual;
    const double typical =
        kCauchy * std::max(1.48 * static_cast<double>(median_of(std::span(spread).first(used))),
                           kLeastSpread);
    // Unknowns: the factor of the room's light, and b.
    Eigen::Matrix4d normal_matrix = kUsualWeight * Eigen::Matrix4d::Identity();
    Eigen::Vector4d right_side = kUsualWeight * (Eigen::Vector4d() << 1, usual).finished();
    for (const Sample& s : samples_) {
      if (albedo_[static_cast<std::size_t>(s.paint)] == 0) continue;
      const double r = residual(s) / typical;
      const double weight = 1.0 / ((1.0 + r * r) * static_cast<double>(used));
      const double light = light_on(s);
      // A surface that faces away from the last b is taken to face away from the new one.
      Eigen::Vector4d row(1, 0, 0, 0);
      if (light > 1.0) row.tail<3>() = s.normal.cast<double>();
      row /= light;
      normal_matrix.noalias() += weight * row * row.transpose();
      right_side += weight * (residual(s) + 1.0) * row;
    }
    const Eigen::Vector4d x = normal_matrix.ldlt().solve(right_side);
    if (!(x[0] > 0.05) || !x.allFinite()) return usual;
    b = x.tail<3>() / x[0];
    if (b.norm() > kMostDirected) b *= kMostDirected / b.norm();
  }
  return b;
}

}  // namespace palpable

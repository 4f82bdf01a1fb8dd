#include "palpable/contact/rest_filter.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpable {
namespace {

constexpr float kPresent = 0.5f;

// px: whoever looks for an outline looks so far beyond the box at most.
constexpr int kBeside = 16;

// Parts beyond are specks: they are passed on as they are.
constexpr int kMostParts = 64;

}  // namespace

PixelBox united(const PixelBox& a, const PixelBox& b) {
  if (a.width == 0 || a.height == 0) return b;
  if (b.width == 0 || b.height == 0) return a;
  const int x = std::min(a.x, b.x), y = std::min(a.y, b.y);
  return {x, y, std::max(a.x + a.width, b.x + b.width) - x,
          std::max(a.y + a.height, b.y + b.height) - y};
}

void RestFilter::start(const DepthImage& depth, const MaskImage& shows, const PartLabels& parts,
                       const Rigid3& camera_from_body) {
  const bool stands = camera_from_body.matrix() == camera_from_body_.matrix() &&
                      presence_.width() == depth.width() && presence_.height() == depth.height();
  if (!stands) {
    average_.resize(depth.width(), depth.height());
    presence_.resize(depth.width(), depth.height());
    part_.resize(depth.width(), depth.height());
    std::fill(presence_.begin(), presence_.end(), 0.0f);
    box_ = {};
    parts_.clear();
    camera_from_body_ = camera_from_body;
  }
  depth_.resize(depth.width(), depth.height());
  shows_.resize(depth.width(), depth.height());
  before_.clear();
  for (const Part& part : parts_) before_.push_back({.frames = part.frames});
  parts_.assign(static_cast<std::size_t>(std::min(parts.count(), kMostParts)), {});
  overlaps_.assign(parts_.size() * before_.size(), 0);
  box_ = united(box_, parts.box());
  const int first = std::max(box_.y - kBeside, 0);
  const int last = std::min(box_.y + box_.height + kBeside, depth.height());
  for (int y = first; y < last; ++y) {
    std::copy_n(depth.row(y), depth.width(), depth_.row(y));
    std::copy_n(shows.row(y), shows.width(), shows_.row(y));
  }
}

void RestFilter::sum_up(const DepthImage& depth, const PartLabels& parts) {
  for (int y = box_.y; y < box_.y + box_.height; ++y) {
    for (int x = box_.x; x < box_.x + box_.width; ++x) {
      const bool was = presence_(x, y) > kPresent;
      const int before = was ? part_(x, y) : PartLabels::kNone;
      if (before >= 0) {
        FormerPart& part = before_[static_cast<std::size_t>(before)];
        part.pixels += 1, part.x += x, part.y += y;
      }
      const int label = parts.box().contains(x, y) ? parts.at(x, y) : PartLabels::kNone;
      if (label < 0 || label >= std::ssize(parts_)) continue;
      Part& part = parts_[static_cast<std::size_t>(label)];
      const auto z = static_cast<double>(depth(x, y));
      part.pixels += 1, part.x += x, part.y += y, part.z += z;
      if (before < 0) continue;
      part.both += 1;
      part.apart += z - static_cast<double>(average_(x, y));
      ++overlaps_[static_cast<std::size_t>(label) * before_.size() +
                  static_cast<std::size_t>(before)];
    }
  }
}

void RestFilter::find_shares(const PinholeCamera& camera) {
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    Part& part = parts_[i];
    const auto first = overlaps_.begin() + static_cast<std::ptrdiff_t>(i * before_.size());
    const auto most = std::max_element(first, first + std::ssize(before_));
    if (before_.empty() || *most == 0 || part.both < 0.5 * part.pixels) continue;
    part.was = static_cast<int>(most - first);
    FormerPart& was = before_[static_cast<std::size_t>(part.was)];
    const double m_per_px = part.z / part.pixels / camera.fx_px;
    const double dx = m_per_px * (part.x / part.pixels - was.x / was.pixels);
    const double dy = m_per_px * (part.y / part.pixels - was.y / was.pixels);
    const double dz = part.apart / part.both;
    const double shift = std::sqrt(dx * dx + dy * dy + dz * dz);
    const double moved =
        std::clamp((shift - settings_.rests) / (settings_.moves - settings_.rests), 0.0, 1.0);
    const float frames =
        std::min(was.frames + 1, static_cast<float>(std::max(settings_.most_frames, 1)));
    part.share = std::max(1 / frames, static_cast<float>(moved));
    part.frames = 1 / part.share;
    was.share = std::min(was.share, part.share);
  }
}

void RestFilter::average(const DepthImage& depth, const MaskImage& shows, const PartLabels& parts,
                         float gate_at_1m) {
  for (int y = box_.y; y < box_.y + box_.height; ++y) {
    for (int x = box_.x; x < box_.x + box_.width; ++x) {
      const int label = parts.box().contains(x, y) ? parts.at(x, y) : PartLabels::kNone;
      float& presence = presence_(x, y);
      float& mean = average_(x, y);
      if (label >= 0 && label < std::ssize(parts_)) {
        const float share = parts_[static_cast<std::size_t>(label)].share;
        const float z = depth(x, y);
        const bool same = presence > 0 && std::abs(z - mean) < gate_at_1m * z * z;
        mean = same ? mean + share * (z - mean) : z;
        presence += share * (1 - presence);
        part_(x, y) = static_cast<std::int16_t>(label);
      } else if (presence > 0) {
        const float share = before_[static_cast<std::size_t>(part_(x, y))].share;
        // A hole in a thing that rests is no sign that it has gone.
        if (share >= 1 || shows(x, y) != kShowsUnknown) presence -= share * presence;
        if (presence < 1e-3f) presence = 0;
      } else {
        continue;
      }
      if (presence > kPresent) {
        depth_(x, y) = mean;
        shows_(x, y) = kShowsPresser;
      } else if (shows_(x, y) == kShowsPresser) {
        shows_(x, y) = kShowsRoom;
      }
    }
  }
  // The parts' numbers of this frame, also where a part flickers just now.
  for (int y = box_.y; y < box_.y + box_.height; ++y) {
    for (int x = box_.x; x < box_.x + box_.width; ++x) {
      const int label = parts.box().contains(x, y) ? parts.at(x, y) : PartLabels::kNone;
      if (label >= 0 || presence_(x, y) == 0) continue;
      int now = PartLabels::kNone;
      for (std::size_t i = 0; i < parts_.size(); ++i) {
        if (parts_[i].was == part_(x, y)) now = static_cast<int>(i);
      }
      if (now >= 0) {
        part_(x, y) = static_cast<std::int16_t>(now);
      } else {
        presence_(x, y) = 0;
      }
    }
  }
}

void RestFilter::add(const DepthImage& depth, const MaskImage& shows, const PartLabels& parts,
                     const PinholeCamera& camera, const Rigid3& camera_from_body, double noise) {
  start(depth, shows, parts, camera_from_body);
  sum_up(depth, parts);
  find_shares(camera);
  average(depth, shows, parts, static_cast<float>(settings_.sigmas * noise));
}

}  // namespace palpable

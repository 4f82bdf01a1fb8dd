#include "palpable/bake/truth/episodes.h"

#include <algorithm>
#include <cmath>

namespace palpable {

std::vector<Episode> episodes_of(const std::vector<ContactLine>& contacts, int count,
                                 double deepest, int apart) {
  std::vector<int> touching;
  for (const ContactLine& contact : contacts) {
    if (contact.touching && contact.depth <= deepest) touching.push_back(contact.frame);
  }
  const int there = static_cast<int>(touching.size());
  const int chosen = std::min(count, there);
  const auto begin_of = [&](int frame) {
    int first = frame;
    for (int back = 1; first >= back && back <= apart; ++back) {
      if (!contacts[static_cast<std::size_t>(first - back)].touching) continue;
      first -= back;
      back = 0;
    }
    return first;
  };
  std::vector<Episode> episodes;
  for (int i = 0; i < chosen; ++i) {
    const int frame = touching[static_cast<std::size_t>((i + 0.5) * there / chosen)];
    const int first = begin_of(frame);
    if (episodes.empty() || episodes.back().first != first) episodes.push_back({first, {}});
    episodes.back().wanted.push_back(frame);
  }
  return episodes;
}

std::vector<Capsule> capsules_at(const ClipHands& hands, double t) {
  const double last = hands.frame_count() - 1.0;
  const double within = std::clamp(t, 0.0, last);
  const auto before = static_cast<std::size_t>(within);
  const double share = within - static_cast<double>(before);
  if (share == 0.0) return hands.capsules[before];
  const std::vector<Capsule>& from = hands.capsules[before];
  const std::vector<Capsule>& to = hands.capsules[before + 1];
  if (from.size() != to.size()) return share < 0.5 ? from : to;
  std::vector<Capsule> between;
  for (std::size_t k = 0; k < from.size(); ++k) {
    const auto mix = [&](const auto& a, const auto& b) { return (1.0 - share) * a + share * b; };
    between.push_back({mix(from[k].a, to[k].a), mix(from[k].b, to[k].b), mix(from[k].ra, to[k].ra),
                       mix(from[k].rb, to[k].rb)});
  }
  return between;
}

}  // namespace palpable

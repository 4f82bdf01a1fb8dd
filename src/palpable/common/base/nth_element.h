/// @file
/// std::nth_element with the same order of elements wherever the core is compiled.
#pragma once

#include <algorithm>
#include <iterator>
#include <utility>

namespace palpable {

#ifndef __GLIBCXX__
namespace detail {

// Moves the elements that stand before the pivot, the median of three, to the front, and returns
// where the others begin.
template <class Iterator, class Before>
Iterator parted(Iterator first, Iterator last, const Before& before) {
  const Iterator a = first + 1, b = first + (last - first) / 2, c = last - 1;
  Iterator median = a;
  if (before(*a, *b)) {
    median = before(*b, *c) ? b : before(*a, *c) ? c : a;
  } else if (!before(*a, *c)) {
    median = before(*b, *c) ? c : b;
  }
  std::iter_swap(first, median);
  for (Iterator low = a, high = last;; ++low) {
    while (before(*low, *first)) ++low;
    do { --high; } while (before(*first, *high));
    if (!(low < high)) return low;
    std::iter_swap(low, high);
  }
}

template <class Iterator, class Before>
void sort_few(Iterator first, Iterator last, const Before& before) {
  for (Iterator next = first; next != last; ++next) {
    auto value = std::move(*next);
    Iterator to = next;
    for (; to != first && before(value, *(to - 1)); --to) *to = std::move(*(to - 1));
    *to = std::move(value);
  }
}

}  // namespace detail
#endif

/// std::nth_element. The standard does not say in which order it leaves the elements on each side,
/// and contact's sums over them depend on it. GCC's library, which the programs use, decides;
/// elsewhere its algorithm is repeated, all but the guard against sequences made to be slow.
template <class Iterator, class Before>
void select_nth(Iterator first, Iterator nth, Iterator last, const Before& before) {
#ifdef __GLIBCXX__
  std::nth_element(first, nth, last, before);
#else
  if (nth == last) return;
  while (last - first > 3) {
    const Iterator cut = detail::parted(first, last, before);
    (cut <= nth ? first : last) = cut;
  }
  detail::sort_few(first, last, before);
#endif
}

}  // namespace palpable

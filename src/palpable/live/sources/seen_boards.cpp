#include "palpable/live/sources/seen_boards.h"

#include "palpable/live/sources/source_guard.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace palpable {
namespace {

constexpr double kNewShare = 0.02;  // required motion of a board, ratio to the picture's width

void add(BoardView board, double new_px, SeenBoards& seen) {
  const bool alike = std::any_of(seen.views.begin(), seen.views.end(), [&](const BoardView& other) {
    return difference_px(board, other) < new_px;
  });
  if (alike) {
    ++seen.alike;
  } else {
    seen.views.push_back(std::move(board));
  }
}

}  // namespace

SeenBoards find_boards(FrameSource& source, const BoardPattern& pattern, int wanted,
                       const std::function<void(const BoardSearchStep&)>& on_step) {
  const double new_px = kNewShare * source.format().width;
  SeenBoards seen;
  SourceGuard guard(source);
  Frame frame;
  for (FrameStatus status = guard.next(frame); status != FrameStatus::kEnd;
       status = guard.next(frame)) {
    const bool searched = status == FrameStatus::kFrame;
    if (searched) {
      ++seen.pairs;
      if (std::optional<BoardView> board = find_board(frame.left, frame.right, pattern)) {
        board->number = frame.number;
        add(std::move(*board), new_px, seen);
      }
    }
    const bool is_live = source.is_live();
    const int done = is_live ? static_cast<int>(seen.views.size()) : seen.pairs;
    on_step({.seen = seen,
             .searched = searched,
             .is_live = is_live,
             .done = done,
             .total = is_live ? wanted : std::max(source.frame_count(), seen.pairs),
             .reports = guard.take_reports()});
    if (searched && source.is_live() && std::ssize(seen.views) == wanted) break;
  }
  return seen;
}

}  // namespace palpable

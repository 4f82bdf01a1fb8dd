// Lets what a clip shows press a body: prints in how many of its frames the body is touched. Where
// the body stands is in the scene.toml beside the images.
//
//     run_session out/demo/bunny.palpable out/demo/clip/frames

#include "palpable/common/base/error.h"
#include "palpable/common/body_file/body_file.h"
#include "palpable/live/player/live_loop.h"
#include "palpable/live/player/live_run.h"

#include <cstdio>
#include <exception>
#include <utility>

int main(int argc, char** argv) try {
  using namespace palpable;
  if (argc != 3) throw Error("usage: run_session BODY FOLDER");
  ReducedBody body = value_or_throw(read_pressable_body(argv[1]));
  LiveSettings wanted;
  wanted.images.device = argv[2];
  LiveRun run = open_live(std::move(body), wanted);

  LiveLoop loop(run);
  int touching = 0;
  while (const Scene* scene = loop.next()) touching += scene->touches.empty() ? 0 : 1;
  std::printf("%d\n", touching);

  // The loop has counted, too; and a clip in which nothing touches shows little.
  return touching == loop.counts().touching && touching > 0 ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "run_session: %s\n", error.what());
  return 1;
}

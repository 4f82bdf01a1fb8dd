#include "palpable/bake/mesh/tetgen_process.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/whole_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <new>
#include <span>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#define TETLIBRARY  // tetgen.h then throws an int where the program would exit
#include <tetgen.h>

namespace palpable {
namespace {

// Exit code of the child: 0, or this plus TetGen's error number (terminatetetgen in tetgen.h).
constexpr int kGaveUp = 64;
constexpr int kOutOfMemory = 1, kRefused = 20;

std::string complaint(int code) {
  switch (code) {
    case kOutOfMemory:
      return "out of memory";
    case 3:
      return "the surface passes through itself";
    case 4:
      return "the surface has features too small to resolve; remesh it with another edge";
    case 5:
      return "two facets are nearly coplanar; remesh the surface with another edge";
    case kRefused:
      return "it refuses its switches";
    default:
      return fmt::format("it gave up (its code {}); remesh the surface with another edge", code);
  }
}

// Copies the surface into TetGen's input, which TetGen frees with delete[].
void fill(tetgenio& in, const TetgenRequest& request) {
  const SurfaceMesh& surface = request.surface;
  in.numberofpoints = surface.vertex_count();
  in.pointlist = new REAL[surface.vertices.size()];
  std::copy_n(surface.vertices.data(), surface.vertices.size(), in.pointlist);
  in.numberoffacets = surface.triangle_count();
  in.facetlist = new tetgenio::facet[surface.triangle_count()];
  for (int t = 0; t < surface.triangle_count(); ++t) {
    tetgenio::facet& facet = in.facetlist[t];
    tetgenio::init(&facet);
    facet.numberofpolygons = 1;
    facet.polygonlist = new tetgenio::polygon[1];
    tetgenio::init(&facet.polygonlist[0]);
    facet.polygonlist[0].numberofvertices = 3;
    facet.polygonlist[0].vertexlist = new int[3];
    std::copy_n(surface.triangles.col(t).data(), 3, facet.polygonlist[0].vertexlist);
  }
  in.numberofholes = static_cast<int>(request.holes.size());
  in.holelist = new REAL[3 * request.holes.size() + 1];
  for (std::size_t h = 0; h < request.holes.size(); ++h) {
    std::copy_n(request.holes[h].data(), 3, in.holelist + 3 * h);
  }
}

// The child's work: writes counts, nodes and tetrahedra into the pipe. @returns the exit code
int fill_and_send(const TetgenRequest& request, int pipe) {
  // Leaked on purpose: their destructors are what crashes.
  auto& in = *new tetgenio;
  auto& out = *new tetgenio;
  fill(in, request);
  char switches[] = "pYQq1.3/12a1";
  tetgenbehavior behavior;
  if (!behavior.parse_commandline(switches)) return kGaveUp + kRefused;
  behavior.maxvolume = request.largest_volume;  // exact; a switch would round it
  try {
    tetrahedralize(&behavior, &in, &out);
  } catch (const int code) { return kGaveUp + code; } catch (const std::bad_alloc&) {
    return kGaveUp + kOutOfMemory;
  }
  const int counts[] = {out.numberofpoints, out.numberoftetrahedra};
  const auto nodes = 3 * static_cast<std::size_t>(counts[0]);
  const auto tets = 4 * static_cast<std::size_t>(counts[1]);
  const bool sent = write_all(pipe, std::as_bytes(std::span(counts))) &&
                    write_all(pipe, std::as_bytes(std::span(out.pointlist, nodes))) &&
                    write_all(pipe, std::as_bytes(std::span(out.tetrahedronlist, tets)));
  return sent ? 0 : kGaveUp;
}

[[noreturn]] void be_the_child(const TetgenRequest& request, int pipe) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // ends when the parent is killed
  // A crash here is expected: no handler of the parent's, no core file, no report of a sanitizer.
  for (const int fault : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE}) ::signal(fault, SIG_DFL);
  ::prctl(PR_SET_DUMPABLE, 0);
  const int nowhere = ::open("/dev/null", O_WRONLY);  // TetGen prints when it gives up
  for (const int output : {STDOUT_FILENO, STDERR_FILENO}) ::dup2(nowhere, output);
  ::_exit(fill_and_send(request, pipe));
}

}  // namespace

std::variant<TetMesh, std::string> run_tetgen(const TetgenRequest& request) {
  PALPABLE_EXPECT(request.largest_volume > 0.0, "a volume is positive");
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) {
    throw Error(fmt::format("TetGen cannot be started: {}", std::strerror(errno)));
  }
  const pid_t child = ::fork();
  if (child < 0) {
    const int problem = errno;
    for (const int end : ends) ::close(end);
    throw Error(fmt::format("TetGen cannot be started: {}", std::strerror(problem)));
  }
  if (child == 0) be_the_child(request, ends[1]);
  ::close(ends[1]);
  TetMesh mesh;
  int counts[2] = {0, 0};
  bool whole = read_all(ends[0], std::as_writable_bytes(std::span(counts)));
  if (whole) {
    mesh.nodes.resize(3, counts[0]);
    mesh.tets.resize(4, counts[1]);
    whole =
        read_all(ends[0], std::as_writable_bytes(std::span(
                              mesh.nodes.data(), static_cast<std::size_t>(mesh.nodes.size())))) &&
        read_all(ends[0], std::as_writable_bytes(std::span(
                              mesh.tets.data(), static_cast<std::size_t>(mesh.tets.size()))));
  }
  ::close(ends[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {}
  if (WIFSIGNALED(status)) { return fmt::format("it crashed ({})", ::strsignal(WTERMSIG(status))); }
  if (WEXITSTATUS(status) != 0) return complaint(WEXITSTATUS(status) - kGaveUp);
  if (!whole || mesh.tet_count() == 0) return std::string("it made no tetrahedra");
  return mesh;
}

}  // namespace palpable

// This file is compiled without contraction of a * b + c (CMakeLists.txt), so that all processors
// give the same bytes.

#include "palpable/common/response/skin_normals.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/response/float_lanes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

namespace palpable {
namespace {

// Eight triangles.
struct Corners {
  int of[3][kPackSize];
};

struct Faces {
  const Corners* corners;
  int packs;
  const FourRow* places;  // (V)
  FourRow* faces;         // of all triangles: normal times twice the area
};
struct FaceNormals {
  PALPABLE_ALWAYS_INLINE static int run(const Faces& all) {
    for (int p = 0; p < all.packs; ++p) {
      FloatPack a[3], b[3], c[3];
      gather(all.places, all.corners[p].of[0], a);
      gather(all.places, all.corners[p].of[1], b);
      gather(all.places, all.corners[p].of[2], c);
      for (int i = 0; i < 3; ++i) {
        b[i] -= a[i];
        c[i] -= a[i];
      }
      const FloatPack n[3] = {b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2],
                              b[0] * c[1] - b[1] * c[0]};
      store_rows(n, all.faces + p * kPackSize);
    }
    return 0;
  }
};

struct Around {
  const int* vertex;  // (V) ordered by how many faces they have
  const int* first;   // (V + 1) in that order
  const int* faces;
  const FourRow* normals;  // of faces
  FourRow* sums;           // (V, padded to a multiple of 8)
  int vertices;
};
struct VertexNormals {
  PALPABLE_ALWAYS_INLINE static int run(const Around& around, float*& to) {
    for (int n = 0; n < around.vertices; ++n) {
      Four sum{};
      for (int k = around.first[n]; k < around.first[n + 1]; ++k) {
        sum += around.normals[around.faces[k]].v;
      }
      around.sums[around.vertex[n]].v = sum;
    }
    constexpr int kEight[kPackSize] = {0, 1, 2, 3, 4, 5, 6, 7};
    for (int first = 0; first < around.vertices; first += kPackSize) {
      FloatPack n[3];
      gather(around.sums + first, kEight, n);
      const FloatPack length = square_root(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
      const FloatPack divisor = length > 0.0f ? length : FloatPack{} + 1.0f;
      for (FloatPack& component : n) component /= divisor;
      store_rows(n, around.sums + first);
    }
    for (int v = 0; v < around.vertices; ++v) {
      __builtin_memcpy(to + 3 * v, &around.sums[v].v, 3 * sizeof(float));
    }
    return 0;
  }
};

}  // namespace

struct SkinNormals::Work {
  SimdLevel level;
  int vertices;
  std::vector<Corners> corners;
  // The triangles of vertex[n], rising: faces[first[n]] .. [first[n + 1] - 1]. Vertices with the
  // same number of faces stand together: a loop of the same length as the one before is predicted
  // well.
  std::vector<int> vertex, first, faces;
  std::vector<FourRow> places, normals;
};

SkinNormals::SkinNormals(const Eigen::Matrix3Xi& triangles, int vertices, SimdLevel level)
    : work_(std::make_unique<Work>()) {
  Work& w = *work_;
  const auto T = static_cast<std::size_t>(triangles.cols());
  w.level = level;
  w.vertices = vertices;
  w.corners.assign((T + kPackSize - 1) / kPackSize, Corners{});
  w.normals.assign(w.corners.size() * kPackSize, FourRow{});
  const auto V = static_cast<std::size_t>(vertices);
  w.places.assign((V + kPackSize - 1) / kPackSize * kPackSize, FourRow{});
  std::vector<std::vector<int>> around(V);
  for (std::size_t t = 0; t < T; ++t) {
    for (int c = 0; c < 3; ++c) {
      const int v = triangles(c, static_cast<Eigen::Index>(t));
      PALPABLE_EXPECT(v >= 0 && v < vertices, "triangles of these vertices");
      w.corners[t / kPackSize].of[c][t % kPackSize] = v;
      around[static_cast<std::size_t>(v)].push_back(static_cast<int>(t));
    }
  }
  w.vertex.resize(V);
  std::iota(w.vertex.begin(), w.vertex.end(), 0);
  const auto faces_of = [&](int v) -> const std::vector<int>& {
    return around[static_cast<std::size_t>(v)];
  };
  std::stable_sort(w.vertex.begin(), w.vertex.end(),
                   [&](int a, int b) { return faces_of(a).size() < faces_of(b).size(); });
  w.first.push_back(0);
  for (const int v : w.vertex) {
    w.faces.insert(w.faces.end(), faces_of(v).begin(), faces_of(v).end());
    w.first.push_back(static_cast<int>(w.faces.size()));
  }
}
SkinNormals::~SkinNormals() = default;
SkinNormals::SkinNormals(SkinNormals&&) noexcept = default;

void SkinNormals::find(const Eigen::Matrix3Xf& x, Eigen::Matrix3Xf& normals) {
  Work& w = *work_;
  PALPABLE_EXPECT(x.cols() == w.vertices && normals.cols() == w.vertices,
                  "a place and a normal of each vertex");
  for (Eigen::Index v = 0; v < x.cols(); ++v) {
    w.places[static_cast<std::size_t>(v)].v = Four{x(0, v), x(1, v), x(2, v), 0.0f};
  }
  const Faces faces{w.corners.data(), static_cast<int>(w.corners.size()), w.places.data(),
                    w.normals.data()};
  run_at<FaceNormals>(w.level, faces);
  const Around around{w.vertex.data(),  w.first.data(),  w.faces.data(),
                      w.normals.data(), w.places.data(), w.vertices};
  float* to = normals.data();
  run_at<VertexNormals>(w.level, around, to);
}

}  // namespace palpable

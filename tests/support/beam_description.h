/// @file
/// The small beam as a file and its description, for intrusive bakes.
#pragma once

#include "palpable/bake/describe/body_description.h"
#include "tests/support/small_beam.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace palpable::test {

/// A CalculiX deck with the sets CLAMP, TOP and UNDER (lower face near the free end).
inline void write_beam_deck(const std::filesystem::path& path, const SolidModel& model) {
  std::ofstream file(path);
  file << "*NODE\n";
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    const auto X = model.mesh.nodes.col(n);
    file << fmt::format("{}, {:.9g}, {:.9g}, {:.9g}\n", n + 1, X[0], X[1], X[2]);
  }
  file << "*ELEMENT, TYPE=C3D4, ELSET=ALL\n";
  for (int e = 0; e < model.mesh.tet_count(); ++e) {
    const Eigen::Vector4i t = model.mesh.tets.col(e).array() + 1;
    file << fmt::format("{}, {}, {}, {}, {}\n", e + 1, t[0], t[1], t[2], t[3]);
  }
  const auto set = [&](const char* name, const std::vector<int>& nodes) {
    file << "*NSET, NSET=" << name << "\n";
    for (const int n : nodes) file << n + 1 << "\n";
  };
  set("CLAMP", model.fixed_nodes);
  set("TOP", face_nodes(model, 0.05, 0.01));
  set("UNDER", face_nodes(model, 0.0, 0.30));
}

/// @param intrusive  the section [intrusive] and any further text of the description
inline BodyDescription describe_small_beam(const std::filesystem::path& folder,
                                           const std::string& intrusive) {
  write_beam_deck(folder / "beam.inp", small_beam(16, 6, 2));
  return parse_body_description(R"(name = "beam"
[shape]
mesh = "beam.inp"
[material]
law = "saint-venant-kirchhoff"
young = "0.5 MPa"
poisson = 0.3
[support]
set = "CLAMP"
[sites]
sets = ["TOP"]
patch = 1
direction = [0, 0, -1]
)" + intrusive,
                                folder / "beam.toml");
}

}  // namespace palpable::test

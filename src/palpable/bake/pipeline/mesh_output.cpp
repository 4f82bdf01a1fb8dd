#include "palpable/bake/pipeline/mesh_output.h"

#include "palpable/bake/exchange/vtu_file.h"
#include "palpable/bake/mesh/inp_file.h"
#include "palpable/bake/mesh/msh_file.h"
#include "palpable/common/base/contract.h"

#include <algorithm>
#include <string>

namespace palpable {

void write_volume_file(const std::filesystem::path& path, const TetMesh& mesh) {
  const std::string ending = path.extension().string();
  PALPABLE_EXPECT(std::find(kMeshEndings.begin(), kMeshEndings.end(), ending) != kMeshEndings.end(),
                  "the ending decides the format");
  if (ending == ".msh") write_msh_file(path, mesh);
  if (ending == ".vtu") write_vtu_file(path, mesh, {});
  if (ending == ".inp") write_inp_file(path, mesh);
}

}  // namespace palpable

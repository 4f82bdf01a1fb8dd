#include "palpable/desk/clip_writer/desk_film.h"

#include "palpable/common/base/error.h"

namespace palpable {

DeskBody desk_body(const ReducedBody& body) {
  DeskBody desk;
  desk.surface = body.surface;
  desk.directions.resize(3, static_cast<Eigen::Index>(body.sites.size()));
  for (std::size_t s = 0; s < body.sites.size(); ++s) {
    desk.site_vertices.push_back(body.sites[s].vertex);
    desk.directions.col(static_cast<Eigen::Index>(s)) = body.sites[s].direction;
  }
  return desk;
}

Film film_of(const Sequence& sequence) {
  const StereoRig rig = zed_mini_rig();
  const RectifiedGeometry geometry = rectified_geometry(rig);
  return {rig, geometry,
          value_or_throw(DeskRenderer::make({rig, sequence.faults, geometry.rectified_from_left},
                                            desk_scene(sequence.look), sequence.look))};
}

}  // namespace palpable

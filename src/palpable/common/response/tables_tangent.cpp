#include "palpable/common/response/tables_tangent.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/row_kernels.h"

#include <algorithm>

namespace palpable {

using Eigen::Vector3f;

Eigen::Vector3f position_of(const Place& place, const Eigen::Matrix3Xf& u) {
  Eigen::Vector3f x = place.at_rest;
  for (std::size_t k = 0; k < place.shares.count; ++k) {
    x += place.shares.of[k].weight * u.col(place.local[k]);
  }
  return x;
}

void StepPlaces::make_room(std::size_t most_places, std::size_t most_vertices,
                           std::size_t most_own) {
  most_places_ = most_places;
  most_vertices_ = most_vertices;
  most_own_ = most_own;
  places_.reserve(most_places);
  vertices_.reserve(most_vertices);
}

void StepPlaces::clear() {
  for (const int v : vertices_) local_of_vertex_[static_cast<std::size_t>(v)] = -1;
  vertices_.clear();
  places_.clear();
  own_ = 0;
}

bool StepPlaces::add(Place place) {
  const std::span shares(place.shares.of.data(), place.shares.count);
  const auto missing = std::count_if(shares.begin(), shares.end(), [&](const ForceShare& share) {
    return local_of_vertex_[static_cast<std::size_t>(share.vertex)] < 0;
  });
  const auto more = static_cast<std::size_t>(missing);
  if (places_.size() == most_places_ || vertices_.size() + more > most_vertices_ ||
      (!place.is_foot && own_ + more > most_own_)) {
    return false;
  }
  if (!place.is_foot) own_ += more;
  for (std::size_t k = 0; k < shares.size(); ++k) {
    int& local = local_of_vertex_[static_cast<std::size_t>(shares[k].vertex)];
    if (local < 0) {
      local = static_cast<int>(vertices_.size());
      vertices_.push_back(shares[k].vertex);
    }
    place.local[k] = local;
  }
  places_.push_back(place);
  return true;
}

namespace {

// direction . field at a force's place. @param field  three values per slot
float along(const TablesAt& at, const UnitForce& force, std::span<const float> field) {
  const Place& place = at.places[force.place];
  const Vector3f& d = force.direction;
  float sum = 0;
  for (std::size_t k = 0; k < place.shares.count; ++k) {
    const float* u = field.data() + 3 * place.slots[k];
    sum += place.shares.of[k].weight * (d[0] * u[0] + d[1] * u[1] + d[2] * u[2]);
  }
  return sum;
}

// The displacement of a place. @param field  three values per slot
Vector3f displacement_of_place(const TablesAt& at, std::size_t place,
                               std::span<const float> field) {
  const Place& there = at.places[place];
  Vector3f x = Vector3f::Zero();
  for (std::size_t k = 0; k < there.shares.count; ++k) {
    x += there.shares.of[k].weight * Eigen::Map<const Vector3f>(field.data() + 3 * there.slots[k]);
  }
  return x;
}

// The patch of load that a force belongs to; -1: none.
int patch_of_unit(const TablesAt& at, const UnitForce& force) {
  const ForceShares& shares = at.places[force.place].shares;
  const auto* heaviest = std::max_element(
      shares.of.begin(), shares.of.begin() + shares.count,
      [](const ForceShare& a, const ForceShare& b) { return a.weight < b.weight; });
  return at.regions->patch_of(heaviest->vertex);
}

// Fills a row for each unit force: Phi^T times it.
void fill_inertia_rows(const TablesAt& at, std::span<const UnitForce> forces,
                       std::span<float> rows) {
  const std::size_t r = at.inertia->row_width();
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const std::span<float> row = rows.subspan(i * r, r);
    std::fill(row.begin(), row.end(), 0.0f);
    const ForceShares& shares = at.places[forces[i].place].shares;
    for (std::size_t k = 0; k < shares.count; ++k) {
      const auto [vertex, weight] = shares.of[k];
      if (weight != 0) at.inertia->add_row(vertex, weight * forces[i].direction, row);
    }
  }
}

}  // namespace

TablesTangent::TablesTangent(std::size_t most_modes, std::size_t inertia)
    : modes_wide_(most_modes),
      inertia_wide_(inertia),
      turned_coordinates_(most_modes),
      turned_inertia_(inertia) {
  patches_.reserve(NonlinearResponse::kMostPatches);
}

void TablesTangent::make_room(std::size_t most_places, std::size_t width) {
  PALPABLE_EXPECT(width == padded(width), "a compliance has whole rows' steps");
  width_ = width;
  tangent_row_.resize(width);
  rows_.resize(most_places * width);
  mode_rows_.resize(most_places * modes_wide_);
  turned_.resize(most_places * modes_wide_);
  order_.resize(most_places);
  patch_of_.resize(most_places);
  sums_.resize(most_places);
  normals_.reserve(most_places);
  const std::size_t tangents = 2 * most_places;
  tangent_modes_.resize(tangents * modes_wide_);
  tangent_order_.resize(tangents);
  tangent_patch_.resize(tangents);
  tangent_sums_.resize(tangents);
  inertia_rows_.resize(most_places * inertia_wide_);
  tangent_inertia_rows_.resize(tangents * inertia_wide_);
}

// row = G times a unit force.
void TablesTangent::fill_row(const TablesAt& at, const UnitForce& unit,
                             std::span<float> row) const {
  const Place& place = at.places[unit.place];
  std::fill(row.begin(), row.end(), 0.0f);
  for (std::size_t k = 0; k < place.shares.count; ++k) {
    const float weight = place.shares.of[k].weight;
    if (weight == 0) continue;
    const Vector3f force = weight * unit.direction;
    const float* blocks = at.compliance.blocks().data();
    best_row_kernels().add_float_rows(
        blocks + static_cast<std::size_t>(3 * place.slots[k]) * width_, width_, {force.data(), 3},
        row);
  }
}

// Fills mode_rows_ and turned_ for the unit forces, patch by patch.
void TablesTangent::find_mode_rows(const TablesAt& at, std::span<const UnitForce> forces) {
  for (std::size_t i = 0; i < forces.size(); ++i) patch_of_[i] = patch_of_unit(at, forces[i]);
  patches_.clear();
  std::size_t next_row = 0;
  for (int patch = 0; patch < at.regions->patch_count(); ++patch) {
    const auto r = static_cast<std::size_t>(at.regions->region_of(patch).mode_count());
    PatchRows of_patch{next_row, next_row, next_row * modes_wide_};
    for (std::size_t i = 0; i < forces.size(); ++i) {
      if (patch_of_[i] != patch) continue;
      const Place& place = at.places[forces[i].place];
      const std::size_t start = of_patch.at + (next_row - of_patch.first) * r;
      const std::span<float> row(mode_rows_.data() + start, r);
      std::fill(row.begin(), row.end(), 0.0f);
      for (std::size_t k = 0; k < place.shares.count; ++k) {
        const auto [vertex, weight] = place.shares.of[k];
        if (weight != 0) at.regions->add_mode_row(patch, vertex, weight * forces[i].direction, row);
      }
      at.regions->times(patch, row, {turned_.data() + start, r});
      order_[next_row++] = i;
    }
    of_patch.last = next_row;
    patches_.push_back(of_patch);
  }
}

// Adds the regions' part of W and q.
void TablesTangent::add_modes(const TablesAt& at, std::span<const UnitForce> forces,
                              std::span<double> W, std::size_t m, std::span<double> q) {
  find_mode_rows(at, forces);
  for (int patch = 0; patch < at.regions->patch_count(); ++patch) {
    const PatchRows& of_patch = patches_[static_cast<std::size_t>(patch)];
    const std::span<const float> coordinates = at.regions->coordinates(patch);
    const std::span<float> turned_now(turned_coordinates_.data(), coordinates.size());
    at.regions->times(patch, coordinates, turned_now);
    best_row_kernels().dots_floats(mode_rows_.data() + of_patch.at, of_patch.last - of_patch.first,
                                   turned_now, sums_.data());
    for (std::size_t i = of_patch.first; i < of_patch.last; ++i) {
      q[forces[order_[i]].row] -= static_cast<double>(sums_[i - of_patch.first]);
    }
    const std::size_t r = coordinates.size();
    for (std::size_t i = 0; i < of_patch.last - of_patch.first; ++i) {
      best_row_kernels().dots_floats(mode_rows_.data() + of_patch.at, i + 1,
                                     {turned_.data() + of_patch.at + i * r, r}, sums_.data());
      double* row = W.data() + forces[order_[of_patch.first + i]].row * m;
      for (std::size_t j = 0; j <= i; ++j) {
        row[forces[order_[of_patch.first + j]].row] += static_cast<double>(sums_[j]);
      }
    }
  }
}

void TablesTangent::add_compliance(const TablesAt& at, std::span<const UnitForce> forces,
                                   std::span<double> W, std::size_t m, std::span<double> q) {
  normals_.assign(forces.begin(), forces.end());
  has_mode_rows_ = at.regions != nullptr;
  // Other bodies may have added to W before, which must not count in the mean.
  mean_ = 0;
  const auto count = static_cast<double>(forces.size());
  for (const UnitForce& f : forces) mean_ -= W[f.row * m + f.row] / count;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const UnitForce& f = forces[i];
    const std::span<float> row(rows_.data() + i * width_, width_);
    fill_row(at, f, row);
    q[f.row] -= static_cast<double>(along(at, f, at.field));
    for (std::size_t j = 0; j <= i; ++j) {
      W[f.row * m + forces[j].row] += static_cast<double>(along(at, forces[j], row));
    }
  }
  if (at.regions != nullptr) add_modes(at, forces, W, m, q);
  for (const UnitForce& f : forces) mean_ += W[f.row * m + f.row] / count;
  if (at.inertia != nullptr) {
    add_inertia(at, forces, W, m, q);
    mean_ = std::max(mean_, 0.0);  // the tables are rounded
  }
}

void TablesTangent::add_tangential(const TablesAt& at, std::span<const UnitForce> forces,
                                   std::span<float> W_nt, std::size_t wide, std::span<double> W_tt,
                                   std::span<double> q_t) {
  const std::size_t t = q_t.size();
  for (std::size_t p = 0; p < normals_.size(); ++p) {
    float* to = W_nt.data() + normals_[p].row * wide;
    const std::span<const float> row(rows_.data() + p * width_, width_);
    for (const UnitForce& f : forces) to[f.row] += along(at, f, row);
  }
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const UnitForce& f = forces[i];
    fill_row(at, f, tangent_row_);
    for (std::size_t j = 0; j <= i; ++j) {
      const UnitForce& other = forces[j];
      const auto value = static_cast<double>(along(at, other, tangent_row_));
      W_tt[f.row * t + other.row] += value;
      if (i != j) W_tt[other.row * t + f.row] += value;
    }
    q_t[f.row] -= static_cast<double>(along(at, f, at.field));
  }
  if (at.inertia != nullptr) add_tangential_inertia(at, forces, W_nt, wide, W_tt, q_t);
}

void TablesTangent::add_all_tangential(const TablesAt& at, std::span<const UnitForce> forces,
                                       std::span<float> W_nt, std::size_t wide,
                                       std::span<double> W_tt, std::span<double> q_t) {
  const std::size_t t = q_t.size();
  // Calls use(i, x) with the displacement x, m/N, that a row has at the place of each force. Those
  // of one place follow each other, so that it is summed once for both.
  const auto for_each = [&](std::span<const float> row, std::size_t count, const auto& use) {
    Vector3f x = Vector3f::Zero();
    for (std::size_t i = 0; i < count; ++i) {
      if (i == 0 || forces[i].place != forces[i - 1].place) {
        x = displacement_of_place(at, forces[i].place, row);
      }
      use(i, x);
    }
  };
  for (std::size_t p = 0; p < normals_.size(); ++p) {
    float* to = W_nt.data() + normals_[p].row * wide;
    for_each(
        {rows_.data() + p * width_, width_}, forces.size(),
        [&](std::size_t i, const Vector3f& x) { to[forces[i].row] += forces[i].direction.dot(x); });
  }
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const std::size_t to = forces[i].row;
    fill_row(at, forces[i], tangent_row_);
    for_each(tangent_row_, i + 1, [&](std::size_t j, const Vector3f& x) {
      const auto value = static_cast<double>(forces[j].direction.dot(x));
      W_tt[to * t + forces[j].row] += value;
      if (i != j) W_tt[forces[j].row * t + to] += value;
    });
    q_t[to] -= static_cast<double>(along(at, forces[i], at.field));
  }
  if (at.regions != nullptr && has_mode_rows_) {
    add_tangential_modes(at, forces, W_nt, wide, W_tt, q_t);
  }
  if (at.inertia != nullptr) add_tangential_inertia(at, forces, W_nt, wide, W_tt, q_t);
}

// Adds the regions' part, as add_modes() does among normal forces.
void TablesTangent::add_tangential_modes(const TablesAt& at, std::span<const UnitForce> forces,
                                         std::span<float> W_nt, std::size_t wide,
                                         std::span<double> W_tt, std::span<double> q_t) {
  const std::size_t t = q_t.size();
  for (std::size_t i = 0; i < forces.size(); ++i) tangent_patch_[i] = patch_of_unit(at, forces[i]);
  for (int patch = 0; patch < at.regions->patch_count(); ++patch) {
    const PatchRows& of_patch = patches_[static_cast<std::size_t>(patch)];
    const std::span<const float> coordinates = at.regions->coordinates(patch);
    const std::size_t r = coordinates.size();
    const std::span<float> turned(turned_coordinates_.data(), r);
    std::size_t count = 0;
    for (std::size_t i = 0; i < forces.size(); ++i) {
      if (tangent_patch_[i] != patch) continue;
      const Place& place = at.places[forces[i].place];
      const std::span<float> row(tangent_modes_.data() + count * r, r);
      std::fill(row.begin(), row.end(), 0.0f);
      for (std::size_t k = 0; k < place.shares.count; ++k) {
        const auto [vertex, weight] = place.shares.of[k];
        if (weight != 0) at.regions->add_mode_row(patch, vertex, weight * forces[i].direction, row);
      }
      at.regions->times(patch, row, turned);
      tangent_order_[count] = i;
      const std::size_t to = forces[i].row;
      best_row_kernels().dots_floats(mode_rows_.data() + of_patch.at,
                                     of_patch.last - of_patch.first, turned, tangent_sums_.data());
      for (std::size_t k = of_patch.first; k < of_patch.last; ++k) {
        W_nt[normals_[order_[k]].row * wide + to] += tangent_sums_[k - of_patch.first];
      }
      best_row_kernels().dots_floats(tangent_modes_.data(), count + 1, turned,
                                     tangent_sums_.data());
      for (std::size_t k = 0; k <= count; ++k) {
        const std::size_t other = forces[tangent_order_[k]].row;
        W_tt[to * t + other] += static_cast<double>(tangent_sums_[k]);
        if (other != to) W_tt[other * t + to] += static_cast<double>(tangent_sums_[k]);
      }
      ++count;
    }
    at.regions->times(patch, coordinates, turned);
    best_row_kernels().dots_floats(tangent_modes_.data(), count, turned, tangent_sums_.data());
    for (std::size_t k = 0; k < count; ++k) {
      q_t[forces[tangent_order_[k]].row] -= static_cast<double>(tangent_sums_[k]);
    }
  }
}

// Adds the part of inertia, as add_modes() adds that of a region.
void TablesTangent::add_inertia(const TablesAt& at, std::span<const UnitForce> forces,
                                std::span<double> W, std::size_t m, std::span<double> q) {
  const std::size_t r = at.inertia->row_width();
  const std::span<float> turned(turned_inertia_.data(), r);
  fill_inertia_rows(at, forces, inertia_rows_);
  at.inertia->times(at.inertia->modal_forces(), turned);
  best_row_kernels().dots_floats(inertia_rows_.data(), forces.size(), turned, sums_.data());
  for (std::size_t i = 0; i < forces.size(); ++i) {
    q[forces[i].row] -= static_cast<double>(sums_[i]);
  }
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const std::span<const float> row_of_modes(inertia_rows_.data() + i * r, r);
    mean_ -= at.inertia->static_compliance(row_of_modes) / static_cast<double>(forces.size());
    at.inertia->times(row_of_modes, turned);
    best_row_kernels().dots_floats(inertia_rows_.data(), i + 1, turned, sums_.data());
    double* row = W.data() + forces[i].row * m;
    for (std::size_t j = 0; j <= i; ++j) row[forces[j].row] += static_cast<double>(sums_[j]);
  }
}

void TablesTangent::add_tangential_inertia(const TablesAt& at, std::span<const UnitForce> forces,
                                           std::span<float> W_nt, std::size_t wide,
                                           std::span<double> W_tt, std::span<double> q_t) {
  const std::size_t r = at.inertia->row_width(), t = q_t.size();
  const std::span<float> turned(turned_inertia_.data(), r);
  fill_inertia_rows(at, forces, tangent_inertia_rows_);
  at.inertia->times(at.inertia->modal_forces(), turned);
  best_row_kernels().dots_floats(tangent_inertia_rows_.data(), forces.size(), turned,
                                 tangent_sums_.data());
  for (std::size_t i = 0; i < forces.size(); ++i) {
    q_t[forces[i].row] -= static_cast<double>(tangent_sums_[i]);
  }
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const std::size_t to = forces[i].row;
    at.inertia->times({tangent_inertia_rows_.data() + i * r, r}, turned);
    best_row_kernels().dots_floats(inertia_rows_.data(), normals_.size(), turned,
                                   tangent_sums_.data());
    for (std::size_t p = 0; p < normals_.size(); ++p) {
      W_nt[normals_[p].row * wide + to] += tangent_sums_[p];
    }
    best_row_kernels().dots_floats(tangent_inertia_rows_.data(), i + 1, turned,
                                   tangent_sums_.data());
    for (std::size_t j = 0; j <= i; ++j) {
      const auto value = static_cast<double>(tangent_sums_[j]);
      W_tt[to * t + forces[j].row] += value;
      if (i != j) W_tt[forces[j].row * t + to] += value;
    }
  }
}

}  // namespace palpable

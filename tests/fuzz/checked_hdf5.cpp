#include "tests/fuzz/checked_hdf5.h"

#include "palpable/common/base/checksum.h"
#include "palpable/common/body_file/hdf5_tools.h"

#include <fmt/format.h>

#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace palpable::fuzz {
namespace {

constexpr std::size_t kUserBlock = 512;

// A dataset, or an attribute of an object.
struct Place {
  std::string object, attribute;
};

herr_t add_attribute(hid_t object, const char* name, const H5A_info_t* /*info*/, void* to) {
  char path[1000] = {};
  H5Iget_name(object, path, sizeof path);
  static_cast<std::vector<Place>*>(to)->push_back({path, name});
  return 0;
}

herr_t add_object(hid_t root, const char* name, const H5O_info_t* info, void* to) {
  if (info->type == H5O_TYPE_DATASET) static_cast<std::vector<Place>*>(to)->push_back({name, ""});
  const hdf5::Handle object(H5Oopen(root, name, H5P_DEFAULT), H5Oclose, "object");
  return H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, nullptr, add_attribute, to);
}

void spoil_dataset(hid_t file, const Place& place, Random& random) {
  const hdf5::Handle set(H5Dopen2(file, place.object.c_str(), H5P_DEFAULT), H5Dclose, "set");
  const hdf5::Handle type(H5Dget_type(set), H5Tclose, "type");
  const hdf5::Handle space(H5Dget_space(set), H5Sclose, "space");
  const auto count = static_cast<std::size_t>(H5Sget_simple_extent_npoints(space));
  std::vector<char> data(count * H5Tget_size(type));
  if (data.empty()) return;
  H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data.data());
  spoil_number(data, H5Tget_size(type), H5Tget_class(type) == H5T_FLOAT, random);
  H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data.data());
}

void spoil_attribute(hid_t file, const Place& place, Random& random) {
  const hdf5::Handle object(H5Oopen(file, place.object.c_str(), H5P_DEFAULT), H5Oclose, "object");
  std::optional<hdf5::Handle> old(
      std::in_place, H5Aopen(object, place.attribute.c_str(), H5P_DEFAULT), H5Aclose, "attribute");
  const hdf5::Handle type(H5Aget_type(*old), H5Tclose, "type");
  const hdf5::Handle space(H5Aget_space(*old), H5Sclose, "space");
  std::vector<char> data(H5Tget_size(type));
  H5Aread(*old, type, data.data());
  old.reset();
  if (H5Tget_class(type) == H5T_FLOAT) {
    spoil_number(data, data.size(), true, random);
  } else {
    spoil_number(data, 1, false, random);
  }
  // Deleted and created again: AddressSanitizer finds that HDF5 1.10 writes out of bounds when an
  // attribute that was read is changed.
  H5Adelete(object, place.attribute.c_str());
  const hdf5::Handle made(
      H5Acreate2(object, place.attribute.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
      "attribute");
  H5Awrite(made, type, data.data());
}

}  // namespace

std::string with_spoilt_values(const std::string& bytes, Random& random) {
  const hdf5::Quiet quiet;
  const hdf5::Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "access");
  H5Pset_fapl_core(access, std::size_t{1} << 20, false);
  std::string content = bytes.substr(kUserBlock);
  H5Pset_file_image(access, content.data(), content.size());
  {
    const hdf5::Handle file(H5Fopen("image", H5F_ACC_RDWR, access), H5Fclose, "image");
    std::vector<Place> places;
    H5Ovisit(file, H5_INDEX_NAME, H5_ITER_INC, add_object, &places);
    for (std::size_t k = 1 + random() % 8; k > 0; --k) {
      const Place& place = places[random() % places.size()];
      place.attribute.empty() ? spoil_dataset(file, place, random)
                              : spoil_attribute(file, place, random);
    }
    H5Fflush(file, H5F_SCOPE_GLOBAL);
    content.resize(static_cast<std::size_t>(H5Fget_file_image(file, nullptr, 0)));
    H5Fget_file_image(file, content.data(), content.size());
  }
  std::string block =
      fmt::format("{}\nbytes {}\nfnv1a {:016x}\n", bytes.substr(0, bytes.find('\n')),
                  content.size(), fnv1a(content));
  block.resize(kUserBlock, '\0');
  return block + content;
}

}  // namespace palpable::fuzz

#include "palpable/common/body_file/foreign_hdf5.h"

#include "palpable/common/base/output_file.h"
#include "tests/support/full_disk.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <string>

namespace palpable {
namespace {

namespace fs = std::filesystem;

// Writes an HDF5 file with a table of integers, a compressed dataset of three dimensions, a single
// number and a text.
void write_theirs(const fs::path& path) {
  const hdf5::Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT),
                          H5Fclose, "file");
  const std::vector<int> integers{1, 2, 3, 4, 5, 6};
  hdf5::write_table(file, "table", integers.data(), 2, 3);
  const hdf5::Handle group = hdf5::make_group(file, "deep");
  std::vector<float> values(1000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = 0.5F * static_cast<float>(i);
  const hsize_t size[3] = {10, 20, 5}, chunk[3] = {5, 20, 5};
  const hdf5::Handle space(H5Screate_simple(3, size, nullptr), H5Sclose, "space");
  const hdf5::Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "creation");
  H5Pset_chunk(creation, 3, chunk);
  H5Pset_deflate(creation, 9);
  const hdf5::Handle set(
      H5Dcreate2(group, "packed", H5T_NATIVE_FLOAT, space, H5P_DEFAULT, creation, H5P_DEFAULT),
      H5Dclose, "set");
  H5Dwrite(set, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  const hdf5::Handle scalar(H5Screate(H5S_SCALAR), H5Sclose, "scalar");
  const double one = 7.25;
  const hdf5::Handle number(
      H5Dcreate2(file, "number", H5T_NATIVE_DOUBLE, scalar, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Dclose, "number");
  H5Dwrite(number, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, &one);
  const hdf5::Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "type");
  const hdf5::Handle text(
      H5Dcreate2(file, "text", type, scalar, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose,
      "text");
}

std::string trouble_of(const fs::path& path, const std::string& dataset) {
  try {
    (void)hdf5::read_foreign(path, dataset);
  } catch (const hdf5::Trouble& trouble) { return trouble.what; }
  return "(read)";
}

TEST_CASE("numbers of another program's HDF5 file are read, packed or not",
          "[body_file][foreign]") {
  const test::ScratchFolder folder("foreign_hdf5");
  write_theirs(folder / "theirs.h5");
  const hdf5::ForeignNumbers table = hdf5::read_foreign(folder / "theirs.h5", "table");
  CHECK(table.size == std::vector<std::size_t>{2, 3});
  CHECK(table.values == std::vector<double>{1, 2, 3, 4, 5, 6});
  const hdf5::ForeignNumbers packed = hdf5::read_foreign(folder / "theirs.h5", "/deep/packed");
  CHECK(packed.size == std::vector<std::size_t>{10, 20, 5});
  CHECK(packed.values.back() == 499.5);
  CHECK(hdf5::read_foreign(folder / "theirs.h5", "number").values == std::vector<double>{7.25});
}

TEST_CASE("missing datasets, texts and files that are not HDF5 are refused with the reason",
          "[body_file][foreign]") {
  const test::ScratchFolder folder("foreign_hdf5");
  write_theirs(folder / "theirs.h5");
  CHECK(trouble_of(folder / "theirs.h5", "other") == "dataset 'other' is missing");
  CHECK(trouble_of(folder / "theirs.h5", "text") == "dataset 'text' does not hold numbers");
  CHECK(trouble_of(folder / "theirs.h5", "deep") == "dataset 'deep' is missing");
  CHECK(trouble_of(folder / "none.h5", "table") == "no such file");
  test::write_bytes(folder / "text.h5", "hello");
  CHECK(trouble_of(folder / "text.h5", "table") == "not an HDF5 file");
}

TEST_CASE("an HDF5 file that is cut short is called so, with its bytes", "[body_file][foreign]") {
  const test::ScratchFolder folder("foreign_hdf5");
  write_theirs(folder / "theirs.h5");
  const std::string good = test::file_bytes(folder / "theirs.h5");
  const std::string all = std::to_string(good.size());
  for (const std::size_t size : {good.size() - 1, good.size() / 2, std::size_t{200}}) {
    test::write_bytes(folder / "cut.h5", good.substr(0, size));
    CHECK(trouble_of(folder / "cut.h5", "table") ==
          "is cut short: it has " + std::to_string(size) + " of " + all + " bytes; copy it again");
  }
  for (const std::size_t size : {std::size_t{20}, std::size_t{8}}) {
    test::write_bytes(folder / "cut.h5", good.substr(0, size));
    CHECK(trouble_of(folder / "cut.h5", "table") == "is cut short within its header");
  }
  test::write_bytes(folder / "cut.h5", good.substr(0, 5));
  CHECK(trouble_of(folder / "cut.h5", "table") == "not an HDF5 file");
  // Behind a user block, and of the newer superblock that h5py writes with libver='latest'.
  test::write_bytes(folder / "cut.h5", std::string(512, ' ') + good.substr(0, 300));
  CHECK_THAT(trouble_of(folder / "cut.h5", "table"),
             Catch::Contains("it has 812 of " + std::to_string(512 + good.size())));
  std::string newer = good.substr(0, 8) + std::string("\2\x08\x08\0", 4) + std::string(16, '\0');
  newer += good.substr(40, 8) + std::string(100, '\0');
  test::write_bytes(folder / "cut.h5", newer);
  CHECK_THAT(trouble_of(folder / "cut.h5", "table"), Catch::Contains("of " + all + " bytes"));
}

// Some of these damages end HDF5 1.10 by a signal; which ones is not known.
TEST_CASE("no damage to another program's HDF5 file ends this program", "[body_file][foreign]") {
  const test::ScratchFolder folder("foreign_hdf5");
  write_theirs(folder / "theirs.h5");
  const std::string good = test::file_bytes(folder / "theirs.h5");
  int refused = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    INFO("seed " << seed);
    auto random = test::random_case(seed);
    std::string bytes = good;
    for (unsigned k = 0; k <= seed % 16; ++k) {
      bytes[random() % bytes.size()] = static_cast<char>(random() % 256);
    }
    test::write_bytes(folder / "bad.h5", bytes);
    const std::string trouble = trouble_of(folder / "bad.h5", seed % 2 ? "table" : "deep/packed");
    CHECK_FALSE(trouble.empty());
    if (trouble != "(read)") ++refused;
  }
  CHECK(refused > 50);
  CHECK(hdf5::read_foreign(folder / "theirs.h5", "table").values[5] == 6);
}

TEST_CASE("a full disk leaves the old HDF5 file, and lets the program end", "[body_file][files]") {
  const test::ScratchFolder folder("full_disk");
  const fs::path path = folder / "a.h5";
  test::write_bytes(path, "old");
  const std::vector<double> numbers(100'000, 1.5);
  const auto fill = [&](hid_t file) {
    for (const char* name : {"a", "b", "c"}) {
      hdf5::write_table(file, name, numbers.data(), numbers.size(), 1);
    }
  };
  for (const rlim_t bytes : {0, 100, 3'000, 500'000, 1'000'000, 2'400'000, 2'401'000}) {
    INFO("room for " << bytes << " bytes");
    CHECK(test::run_with_full_disk(bytes, [&] {
            const hdf5::Quiet quiet;
            try {
              hdf5::write_file(path, fill, [] {});
            } catch (const hdf5::Trouble& trouble) {
              return trouble.what.find("cannot be written") != std::string::npos ? 42 : 43;
            }
            return 0;
          }) == 42);
    CHECK(test::file_bytes(path) == "old");
    CHECK_FALSE(fs::exists(part_of(folder / "a.h5")));
  }
  {
    const hdf5::Quiet quiet;
    hdf5::write_file(path, fill, [] {});
  }
  CHECK(hdf5::read_foreign(path, "c").values == numbers);
  CHECK_FALSE(fs::exists(part_of(folder / "a.h5")));
}

TEST_CASE("an HDF5 file is not in place when what belongs to it fails", "[body_file][files]") {
  const test::ScratchFolder folder("not_in_place");
  const hdf5::Quiet quiet;
  const auto fill = [](hid_t file) { hdf5::write_number(file, "n", 1); };
  const auto fails = [] { throw hdf5::Trouble{"the other one"}; };
  CHECK_THROWS_AS(hdf5::write_file(folder / "a.h5", fill, fails), hdf5::Trouble);
  CHECK_THROWS_AS(hdf5::write_file(
                      folder / "b.h5", [&](hid_t) { fails(); }, [] {}),
                  hdf5::Trouble);
  CHECK_THROWS_AS(hdf5::write_file(folder / "none" / "a.h5", fill, [] {}), hdf5::Trouble);
  CHECK(fs::is_empty(folder.path()));
}

}  // namespace
}  // namespace palpable

#include "hdf5_file.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <iterator>
#include <limits>
#include <memory>
#include <new>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

#include "atomic_file.h"
#include "io/deferred/hdf5_functions.h"

namespace tetropolis {

namespace {

/// What the driver is given with the list of access properties.
struct DriverInfo {
  int* error;
};

/// HDF5 knows the beginning only.
struct OpenFile {
  H5FD_t known;
  int descriptor;
  haddr_t end_of_addresses;
  haddr_t end_of_file;
  int* error;
};

OpenFile& of(H5FD_t* file) { return *reinterpret_cast<OpenFile*>(file); }
const OpenFile& of(const H5FD_t* file) { return *reinterpret_cast<const OpenFile*>(file); }

void keep_first(int& error) {
  if (error == 0) error = errno == 0 ? EIO : errno;
}

constexpr haddr_t kMostBytes = std::numeric_limits<off_t>::max();

H5FD_t* open_file(const char* name, unsigned /*flags*/, hid_t access, haddr_t /*most*/) {
  const auto* info = static_cast<const DriverInfo*>(H5Pget_driver_info(access));
  if (info == nullptr) return nullptr;
  const int descriptor = ::open(name, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    keep_first(*info->error);
    return nullptr;
  }
  // An exception must not go through the library, which is C.
  auto* open = new (std::nothrow) OpenFile{{}, descriptor, 0, 0, info->error};
  if (open == nullptr) {
    ::close(descriptor);
    if (*info->error == 0) *info->error = ENOMEM;
    return nullptr;
  }
  return &open->known;
}

herr_t close_file(H5FD_t* file) {
  const std::unique_ptr<OpenFile> open(&of(file));
  if (::close(open->descriptor) != 0) keep_first(*open->error);
  return 0;
}

/// As HDF5's own drivers for files, so that files are laid out as by these.
herr_t query(const H5FD_t* /*file*/, unsigned long* flags) {
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
           H5FD_FEAT_AGGREGATE_SMALLDATA;
  return 0;
}

haddr_t end_of_addresses(const H5FD_t* file, H5FD_mem_t /*type*/) {
  return of(file).end_of_addresses;
}

herr_t set_end_of_addresses(H5FD_t* file, H5FD_mem_t /*type*/, haddr_t address) {
  of(file).end_of_addresses = address;
  return 0;
}

haddr_t end_of_file(const H5FD_t* file, H5FD_mem_t /*type*/) { return of(file).end_of_file; }

/// What cannot be read is zeros.
herr_t read_file(H5FD_t* file, H5FD_mem_t /*type*/, hid_t /*transfer*/, haddr_t address,
                 std::size_t size, void* buffer) {
  auto* to = static_cast<char*>(buffer);
  while (size > 0) {
    const ssize_t got = ::pread(of(file).descriptor, to, size, static_cast<off_t>(address));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) keep_first(*of(file).error);
    if (got <= 0) break;
    to += got;
    address += static_cast<haddr_t>(got);
    size -= static_cast<std::size_t>(got);
  }
  std::fill_n(to, size, '\0');
  return 0;
}

herr_t write_file(H5FD_t* file, H5FD_mem_t /*type*/, hid_t /*transfer*/, haddr_t address,
                  std::size_t size, const void* buffer) {
  OpenFile& open = of(file);
  const auto* from = static_cast<const char*>(buffer);
  open.end_of_file = std::max<haddr_t>(open.end_of_file, address + size);
  while (size > 0 && *open.error == 0) {
    errno = 0;
    const ssize_t put = ::pwrite(open.descriptor, from, size, static_cast<off_t>(address));
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) {
      keep_first(*open.error);
      break;
    }
    from += put;
    address += static_cast<haddr_t>(put);
    size -= static_cast<std::size_t>(put);
  }
  return 0;
}

/// The file has all addresses that were given away.
herr_t truncate_file(H5FD_t* file, hid_t /*transfer*/, hbool_t /*closing*/) {
  OpenFile& open = of(file);
  if (open.end_of_file == open.end_of_addresses) return 0;
  if (::ftruncate(open.descriptor, static_cast<off_t>(open.end_of_addresses)) != 0)
    keep_first(*open.error);
  open.end_of_file = open.end_of_addresses;
  return 0;
}

H5FD_class_t make_driver_class() {
  H5FD_class_t driver{};
#if H5_VERSION_GE(1, 13, 0)
  driver.version = H5FD_CLASS_VERSION;
  driver.value = static_cast<H5FD_class_value_t>(256);  // of those for unregistered drivers
#endif
  driver.name = "tetropolis";
  driver.maxaddr = kMostBytes;
  driver.fc_degree = H5F_CLOSE_WEAK;
  driver.fapl_size = sizeof(DriverInfo);
  driver.open = open_file;
  driver.close = close_file;
  driver.query = query;
  driver.get_eoa = end_of_addresses;
  driver.set_eoa = set_end_of_addresses;
  driver.get_eof = end_of_file;
  driver.read = read_file;
  driver.write = write_file;
  driver.truncate = truncate_file;
  constexpr std::array<H5FD_mem_t, H5FD_MEM_NTYPES> kFreeLists = H5FD_FLMAP_DICHOTOMY;
  std::copy(kFreeLists.begin(), kFreeLists.end(), std::begin(driver.fl_map));
  return driver;
}

hid_t register_driver() {
  static const H5FD_class_t driver = make_driver_class();  // HDF5 keeps a copy
  return H5FDregister(&driver);
}

hid_t create_file(const std::filesystem::path& path, hid_t driver, int* error) {
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  const DriverInfo info{error};
  if (H5Pset_driver(access.id(), driver, &info) < 0) return -1;
  // Else small datasets share a block and lie before larger ones made earlier.
  H5Pset_small_data_block_size(access.id(), 0);
  return H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id());
}

}  // namespace

Hdf5File::Hdf5File(const std::filesystem::path& path, const std::filesystem::path& target)
    : target_(target),
      driver_(register_driver(), H5FDunregister),
      file_(create_file(path, driver_.id(), &error_), H5Fclose) {
  require(file_.good());
}

void Hdf5File::require(bool good) const {
  if (good && error_ == 0) return;
  throw_cannot_write(target_,
                     error_ == 0 ? "HDF5 gave no reason" : std::generic_category().message(error_));
}

}  // namespace tetropolis

#include "viz_export/hdf5/hdf5_driver.h"

#include <fcntl.h>
#include <hdf5.h>
#include <sys/stat.h>
#include <unistd.h>

#include <memory>

namespace epafi {

namespace {

struct OpenFile : H5FD_t {
  int descriptor = -1;
  haddr_t end_of_address = 0, end_of_file = 0;
};

OpenFile& of(H5FD_t* file) { return *static_cast<OpenFile*>(file); }
const OpenFile& of(const H5FD_t* file) { return *static_cast<const OpenFile*>(file); }

H5FD_t* open_file(const char* name, unsigned flags, hid_t, haddr_t) {
  if ((flags & (H5F_ACC_RDWR | H5F_ACC_TRUNC | H5F_ACC_CREAT)) != 0) return nullptr;
  const int descriptor = open(name, O_RDONLY | O_CLOEXEC);
  struct stat about {};
  if (descriptor < 0 || fstat(descriptor, &about) != 0) {
    if (descriptor >= 0) close(descriptor);
    return nullptr;
  }
  auto file = std::make_unique<OpenFile>();
  file->descriptor = descriptor;
  file->end_of_file = static_cast<haddr_t>(about.st_size);
  return file.release();
}

herr_t close_file(H5FD_t* file) {
  const std::unique_ptr<OpenFile> closed(&of(file));
  return close(closed->descriptor);
}

/// No features: nothing is cached between reads. Data sieving pays only where rows are read one by one.
herr_t no_features(const H5FD_t*, unsigned long* flags) {
  *flags = 0;
  return 0;
}

haddr_t get_eoa(const H5FD_t* file, H5FD_mem_t) { return of(file).end_of_address; }
herr_t set_eoa(H5FD_t* file, H5FD_mem_t, haddr_t address) {
  of(file).end_of_address = address;
  return 0;
}
haddr_t get_eof(const H5FD_t* file, H5FD_mem_t) { return of(file).end_of_file; }

herr_t read_bytes(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t address, size_t size, void* buffer) {
  const OpenFile& f = of(file);
  if (address > f.end_of_file || size > f.end_of_file - address) return -1;
  auto* to = static_cast<char*>(buffer);
  while (size > 0) {
    const ssize_t got = pread(f.descriptor, to, size, static_cast<off_t>(address));
    if (got <= 0) return -1;
    to += got;
    address += static_cast<haddr_t>(got);
    size -= static_cast<size_t>(got);
  }
  return 0;
}

herr_t write_bytes(H5FD_t*, H5FD_mem_t, hid_t, haddr_t, size_t, const void*) { return -1; }

hid_t driver() {
  static const H5FD_class_t description = [] {
    H5FD_class_t d{};
    d.name = "checked_reading";
    d.maxaddr = HADDR_MAX;
    d.fc_degree = H5F_CLOSE_WEAK;
    d.open = open_file;
    d.close = close_file;
    d.query = no_features;
    d.get_eoa = get_eoa;
    d.set_eoa = set_eoa;
    d.get_eof = get_eof;
    d.read = read_bytes;
    d.write = write_bytes;
    return d;
  }();
  static const hid_t id = H5FDregister(&description);
  return id;
}

}  // namespace

bool set_checked_reading(std::int64_t access) {
  const hid_t id = driver();
  return id >= 0 && H5Pset_driver(access, id, nullptr) >= 0;
}

}  // namespace epafi

#include "viz_export/hdf5/hdf5_file.h"

#include <hdf5.h>

#include <algorithm>
#include <new>
#include <system_error>
#include <utility>

#include "viz_export/hdf5/damaged_run.h"
#include "viz_export/hdf5/hdf5_driver.h"
#include "viz_export/hdf5/hdf5_heaps.h"

namespace epafi {

namespace {

/// Owns one HDF5 identifier.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle(hid_t id, Close close) : id_(id), close_(close) {}
  Handle(Handle&& o) noexcept : id_(std::exchange(o.id_, -1)), close_(o.close_) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  Handle& operator=(Handle&&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  Close close_;
};

/// Creation properties without time stamps, so that the same run writes the same bytes.
Handle timeless(hid_t kind) {
  Handle list(H5Pcreate(kind), H5Pclose);
  H5Pset_obj_track_times(list, false);
  return list;
}

/// HDF5's description of the last error, from the innermost frame of its error stack.
std::string last_cause() {
  std::string cause;
  const auto keep = [](unsigned, const H5E_error2_t* error, void* out) -> herr_t {
    auto& text = *static_cast<std::string*>(out);
    if (text.empty() && error->desc != nullptr) text = error->desc;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep, &cause);
  H5Eclear2(H5E_DEFAULT);
  return cause.empty() ? "no cause given by HDF5" : cause;
}

hid_t memory_type(Hdf5Type type) {
  switch (type) {
    case Hdf5Type::float32:
      return H5T_NATIVE_FLOAT;
    case Hdf5Type::float64:
      return H5T_NATIVE_DOUBLE;
    case Hdf5Type::int8:
      return H5T_NATIVE_INT8;
    case Hdf5Type::int16:
      return H5T_NATIVE_INT16;
    case Hdf5Type::int32:
      return H5T_NATIVE_INT32;
    case Hdf5Type::int64:
      return H5T_NATIVE_INT64;
    case Hdf5Type::uint8:
      return H5T_NATIVE_UINT8;
    case Hdf5Type::uint16:
      return H5T_NATIVE_UINT16;
    case Hdf5Type::uint32:
      return H5T_NATIVE_UINT32;
    case Hdf5Type::uint64:
      return H5T_NATIVE_UINT64;
  }
  return -1;
}

Handle text_type(std::size_t size) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, std::max<std::size_t>(size, 1));
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

constexpr std::size_t deflate_ratio = 1032;          // the most that deflate can expand (zlib technical details)
constexpr std::size_t spare = std::size_t{8} << 20;  // what HDF5 takes to open a file, with room
constexpr std::size_t most_metadata = std::size_t{1} << 18;  // of names and places of datasets; in memory 30 times it
constexpr std::size_t piece_rows = 16384;                    // of three doubles 400 kB
constexpr std::size_t most_text = std::size_t{1} << 28;      // 256 MiB: no scene text is longer

}  // namespace

struct Hdf5File::Impl {
  std::filesystem::path path;
  hid_t id = -1;

  /// Size of the file, an upper bound for all that it holds.
  std::size_t file_bytes() const {
    hsize_t size = 0;
    check(H5Fget_filesize(id, &size), "read the size of the file");
    return size;
  }
  [[noreturn]] void fail(const std::string& operation) const {
    throw FileError(path.string() + ": cannot " + operation + ": " + last_cause());
  }
  Handle checked(hid_t id_or_error, Handle::Close close, const std::string& operation) const {
    if (id_or_error < 0) fail(operation);
    return {id_or_error, close};
  }
  void check(herr_t status, const std::string& operation) const {
    if (status < 0) fail(operation);
  }
  Handle dataset(const std::string& name) const {
    return checked(H5Dopen2(id, name.c_str(), H5P_DEFAULT), H5Dclose, "open dataset '" + name + "'");
  }
  Handle object(const std::string& name) const {
    return checked(H5Oopen(id, name.c_str(), H5P_DEFAULT), H5Oclose, "open '" + name + "'");
  }
  std::vector<hsize_t> extents(hid_t dataset_id, const std::string& name) const {
    const Handle space = checked(H5Dget_space(dataset_id), H5Sclose, "read the shape of '" + name + "'");
    const int rank = H5Sget_simple_extent_ndims(space);
    if (rank < 0) fail("read the shape of '" + name + "'");
    std::vector<hsize_t> dims(static_cast<std::size_t>(rank));
    if (rank > 0) H5Sget_simple_extent_dims(space, dims.data(), nullptr);
    return dims;
  }
  bool has(const std::string& name) const;
  void make_group(const std::string& name) const;
  /// All groups that lead to `name`.
  void make_parents(const std::string& name) const {
    const std::size_t last = name.find_last_not_of('/', name.rfind('/'));  // before one or several in a row
    if (name.find('/') != std::string::npos && last != std::string::npos) make_group(name.substr(0, last + 1));
  }
  /// rows: initial number of an extendable dataset.
  Handle make_dataset(const std::string& name, Hdf5Type type, hsize_t rows, const Hdf5Layout& layout) const;
  /// extents: of the rows to write from `first` on.
  void write_rows(hid_t dataset_id, Hdf5Type type, hsize_t first, std::vector<hsize_t> extents, const void* values,
                  const std::string& what) const;
  Handle attribute(const std::string& object_name, const std::string& key) const {
    return checked(H5Aopen_by_name(id, object_name.c_str(), key.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                   "read attribute '" + key + "' of '" + object_name + "'");
  }
  void set(const std::string& object_name, const std::string& key, hid_t type, const void* value) const {
    const std::string what = "write attribute '" + key + "' of '" + object_name + "'";
    const Handle owner = object(object_name);
    if (H5Aexists(owner, key.c_str()) > 0) check(H5Adelete(owner, key.c_str()), what);
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
    const Handle a = checked(H5Acreate2(owner, key.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, what);
    check(H5Awrite(a, type, value), what);
  }
  void get(const std::string& object_name, const std::string& key, H5T_class_t kind, hid_t type, void* value) const {
    const Handle a = attribute(object_name, key);
    const Handle stored(H5Aget_type(a), H5Tclose);
    const Handle space(H5Aget_space(a), H5Sclose);
    if (H5Tget_class(stored) != kind || H5Sget_simple_extent_npoints(space) != 1)
      throw FileError(path.string() + ": attribute '" + key + "' of '" + object_name + "' is not a single " +
                      (kind == H5T_INTEGER ? "whole number" : "number"));
    check(H5Aread(a, type, value), "read attribute '" + key + "' of '" + object_name + "'");
  }
  /// Reads a string of fixed or variable length through `read(type, buffer)`.
  template <class Read>
  std::string text(hid_t type, const std::string& what, const Read& read) const {
    if (H5Tget_class(type) != H5T_STRING) throw FileError(path.string() + ": " + what + " is not text");
    if (H5Tis_variable_str(type) > 0) {
      char* value = nullptr;
      check(read(type, &value), "read " + what);
      std::string copy = value == nullptr ? "" : value;
      H5free_memory(value);
      return copy;
    }
    const std::size_t size = H5Tget_size(type);
    if (size > most_text || size > file_bytes())
      throw FileError(path.string() + ": " + what + " claims " + std::to_string(size) + " bytes");
    std::string value(size, '\0');
    check(read(type, value.data()), "read " + what);
    return value.substr(0, value.find('\0'));
  }
};

namespace {
/// Limits HDF5's metadata cache. Its default of 32 MB counts bytes in the file; in memory it needs 30 times as much: 24
/// kB per shape of run.h5.
void limit_metadata(hid_t access) {
  H5AC_cache_config_t config{};
  config.version = H5AC__CURR_CACHE_CONFIG_VERSION;
  if (H5Pget_mdc_config(access, &config) < 0) return;
  config.set_initial_size = true;
  config.initial_size = most_metadata / 2;
  config.min_size = most_metadata / 4;
  config.max_size = most_metadata;
  H5Pset_mdc_config(access, &config);
}
}  // namespace

Hdf5File::Hdf5File(const std::filesystem::path& path, Mode mode) : impl_(std::make_unique<Impl>()) {
  // All files are closed by this program. The library would crash at exit on one that could not be closed (full disk).
  static const bool leaves_exit_alone = H5dont_atexit() >= 0;
  static_cast<void>(leaves_exit_alone);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are reported once, by us
  impl_->path = path;
  // HDF5 1.10 crashes (H5AC_create) where memory runs out while it opens a file: allocate it first, to fail with an
  // exception
  ::operator delete(::operator new(spare));
  std::error_code none;
  if (mode != Mode::create && !std::filesystem::is_regular_file(path, none))
    throw FileError(path.string() + ": cannot open: there is no such file");
  if (mode != Mode::create) refuse_broken_heaps(path);
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V18);
  limit_metadata(access);
  if (mode == Mode::read && !set_checked_reading(access)) impl_->fail("open");
  if (mode == Mode::create) {
    impl_->id = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, timeless(H5P_FILE_CREATE), access);
  } else {
    impl_->id = H5Fopen(path.c_str(), mode == Mode::read ? H5F_ACC_RDONLY : H5F_ACC_RDWR, access);
  }
  if (impl_->id < 0 && mode == Mode::create) impl_->fail("create");
  if (impl_->id < 0) throw FileError(damage_text(path, path.string() + ": cannot open: " + last_cause()));
}

Hdf5File::~Hdf5File() {
  if (impl_ && impl_->id >= 0) H5Fclose(impl_->id);
}
Hdf5File::Hdf5File(Hdf5File&&) noexcept = default;
Hdf5File& Hdf5File::operator=(Hdf5File&& other) noexcept {
  std::swap(impl_, other.impl_);
  return *this;
}

const std::filesystem::path& Hdf5File::path() const { return impl_->path; }

void Hdf5File::close() {
  if (impl_->id < 0) return;
  const hid_t id = std::exchange(impl_->id, -1);
  const bool flushed = H5Fflush(id, H5F_SCOPE_GLOBAL) >= 0;
  const std::string cause = flushed ? "" : last_cause();
  const bool closed = H5Fclose(id) >= 0;
  if (!flushed || !closed)
    throw FileError(impl_->path.string() + ": cannot write: " + (flushed ? last_cause() : cause));
  H5garbage_collect();  // it keeps 2 MB for the next file: 5 bytes of each of 400 000 spheres
}

bool Hdf5File::has(const std::string& name) const { return impl_->has(name); }

bool Hdf5File::Impl::has(const std::string& name) const {
  // check every group of the path: H5Lexists fails where one is missing
  for (std::size_t end = name.find('/', 1);; end = name.find('/', end + 1)) {
    const std::string part = name.substr(0, end);
    if (part != "/" && H5Lexists(id, part.c_str(), H5P_DEFAULT) <= 0) {
      H5Eclear2(H5E_DEFAULT);
      return false;
    }
    if (end == std::string::npos) return true;
  }
}

std::vector<std::string> Hdf5File::children(const std::string& group) const {
  const hid_t opened = H5Gopen2(impl_->id, group.c_str(), H5P_DEFAULT);
  const Handle g = impl_->checked(opened, H5Gclose, "open group '" + group + "'");
  std::vector<std::string> names;
  const auto keep = [](hid_t, const char* name, const H5L_info_t*, void* out) -> herr_t {
    static_cast<std::vector<std::string>*>(out)->emplace_back(name);
    return 0;
  };
  impl_->check(H5Literate(g, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, keep, &names), "list group '" + group + "'");
  std::sort(names.begin(), names.end());
  return names;
}

void Hdf5File::make_group(const std::string& name) { impl_->make_group(name); }

void Hdf5File::Impl::make_group(const std::string& name) const {
  if (has(name)) return;
  make_parents(name);
  const hid_t made = H5Gcreate2(id, name.c_str(), H5P_DEFAULT, timeless(H5P_GROUP_CREATE), H5P_DEFAULT);
  checked(made, H5Gclose, "create group '" + name + "'");
}

void Hdf5File::remove(const std::string& name) {
  impl_->check(H5Ldelete(impl_->id, name.c_str(), H5P_DEFAULT), "remove '" + name + "'");
}

Handle Hdf5File::Impl::make_dataset(const std::string& name, Hdf5Type type, hsize_t rows,
                                    const Hdf5Layout& layout) const {
  const std::string what = "write dataset '" + name + "'";
  const hsize_t dims[2] = {rows, layout.columns}, most[2] = {layout.extendable ? H5S_UNLIMITED : rows, layout.columns};
  const int rank = layout.columns > 1 ? 2 : 1;
  const Handle space = checked(H5Screate_simple(rank, dims, most), H5Sclose, what);
  make_parents(name);
  const Handle create = timeless(H5P_DATASET_CREATE);
  H5Pset_fill_time(create, H5D_FILL_TIME_NEVER);
  if (layout.extendable || (layout.compressed && rows > 0)) {
    const hsize_t chunk_rows = layout.extendable ? layout.chunk_rows : std::min<hsize_t>(rows, layout.chunk_rows);
    const hsize_t chunk[2] = {chunk_rows, layout.columns};
    check(H5Pset_chunk(create, rank, chunk), what);
    if (layout.compressed) {
      H5Pset_shuffle(create);
      check(H5Pset_deflate(create, 1), what);
    }
  }
  const hid_t made = H5Dcreate2(id, name.c_str(), memory_type(type), space, H5P_DEFAULT, create, H5P_DEFAULT);
  return checked(made, H5Dclose, what);
}

void Hdf5File::Impl::write_rows(hid_t dataset_id, Hdf5Type type, hsize_t first, std::vector<hsize_t> extents,
                                const void* values, const std::string& what) const {
  std::vector<hsize_t> start(extents.size(), 0);
  start[0] = first;
  const Handle target = checked(H5Dget_space(dataset_id), H5Sclose, what);
  check(H5Sselect_hyperslab(target, H5S_SELECT_SET, start.data(), nullptr, extents.data(), nullptr), what);
  const Handle source(H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr), H5Sclose);
  check(H5Dwrite(dataset_id, memory_type(type), source, target, H5P_DEFAULT, values), what);
}

void Hdf5File::write_raw(const std::string& name, Hdf5Type type, const void* values, std::size_t elements,
                         const Hdf5Layout& layout) {
  EPAFI_REQUIRE(layout.columns > 0 && elements % layout.columns == 0, "rows are complete");
  const Handle d = impl_->make_dataset(name, type, elements / layout.columns, layout);
  if (elements == 0) return;
  impl_->check(H5Dwrite(d, memory_type(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, values), "write dataset '" + name + "'");
}

void Hdf5File::write_pieces_raw(const std::string& name, Hdf5Type type, std::size_t rows, std::size_t columns,
                                const Piece& piece) {
  const Handle d = impl_->make_dataset(name, type, rows, {.columns = columns});
  for (std::size_t first = 0; first < rows; first += piece_rows) {
    const std::size_t count = std::min(rows - first, piece_rows);
    std::vector<hsize_t> extents{count};
    if (columns > 1) extents.push_back(columns);
    impl_->write_rows(d, type, first, extents, piece(first, count), "write dataset '" + name + "'");
  }
}

void Hdf5File::append_raw(const std::string& name, Hdf5Type type, const void* values, std::size_t elements) {
  const std::string what = "append to dataset '" + name + "'";
  const Handle d = impl_->dataset(name);
  std::vector<hsize_t> dims = impl_->extents(d, name);
  const std::size_t columns = dims.size() > 1 ? dims[1] : 1;
  EPAFI_REQUIRE(elements % columns == 0, "rows are complete");
  std::vector<hsize_t> count = dims;
  count[0] = elements / columns;
  if (count[0] == 0) return;
  dims[0] += count[0];
  impl_->check(H5Dset_extent(d, dims.data()), what);
  impl_->write_rows(d, type, dims[0] - count[0], count, values, what);
}

void Hdf5File::overwrite_raw(const std::string& name, Hdf5Type type, std::size_t first, const void* values,
                             std::size_t elements) {
  const Handle d = impl_->dataset(name);
  std::vector<hsize_t> count = impl_->extents(d, name);
  const std::size_t columns = count.size() > 1 ? count[1] : 1, rows = elements / columns;
  EPAFI_REQUIRE(!count.empty() && elements % columns == 0 && first + rows <= count[0], "the rows are there");
  if (rows == 0) return;
  count[0] = rows;
  impl_->write_rows(d, type, first, count, values, "overwrite rows of dataset '" + name + "'");
}

void Hdf5File::truncate(const std::string& name, std::size_t rows) {
  const Handle d = impl_->dataset(name);
  std::vector<hsize_t> dims = impl_->extents(d, name);
  if (dims.empty() || dims[0] <= rows) return;
  dims[0] = rows;
  impl_->check(H5Dset_extent(d, dims.data()), "truncate dataset '" + name + "'");
}

std::vector<std::size_t> Hdf5File::shape(const std::string& name) const {
  const auto dims = impl_->extents(impl_->dataset(name), name);
  return {dims.begin(), dims.end()};
}

std::size_t Hdf5File::elements_checked(const std::string& name, Hdf5Type wanted) const {
  const Handle d = impl_->dataset(name);
  const Handle stored(H5Dget_type(d), H5Tclose);
  const hid_t target = memory_type(wanted);
  if (H5Tget_class(stored) != H5Tget_class(target) || H5Tget_size(stored) > H5Tget_size(target))
    throw FileError(impl_->path.string() + ": dataset '" + name + "' has elements of another type than expected");
  std::size_t count = 1, bytes = 0;
  bool fits = true;
  for (hsize_t extent : impl_->extents(d, name)) fits = fits && !__builtin_mul_overflow(count, extent, &count);
  fits = fits && !__builtin_mul_overflow(count, H5Tget_size(stored), &bytes);
  const Handle creation(H5Dget_create_plist(d), H5Pclose);
  const std::size_t ratio = H5Pget_nfilters(creation) > 0 ? deflate_ratio : 1;
  const std::size_t held = std::min<std::size_t>(H5Dget_storage_size(d), impl_->file_bytes());
  if (!fits || bytes / ratio > held)
    throw FileError(impl_->path.string() + ": dataset '" + name + "' claims " +
                    (fits ? std::to_string(bytes) : "more than 2^64") + " bytes but the file holds " +
                    std::to_string(held) + " of it");
  return count;
}

void Hdf5File::refuse_size(const std::string& name, std::size_t wanted) const {
  throw FileError(impl_->path.string() + ": dataset '" + name + "' does not have the expected " +
                  std::to_string(wanted) + " elements");
}

void Hdf5File::read_raw(const std::string& name, Hdf5Type type, void* values) const {
  const Handle d = impl_->dataset(name);
  if (H5Dget_storage_size(d) == 0) return;
  const herr_t status = H5Dread(d, memory_type(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
  impl_->check(status, "read dataset '" + name + "'");
}

void Hdf5File::write_text(const std::string& name, const std::string& text) {
  const std::string what = "write text '" + name + "'";
  const Handle type = text_type(text.size());
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  impl_->make_parents(name);
  const hid_t made =
      H5Dcreate2(impl_->id, name.c_str(), type, space, H5P_DEFAULT, timeless(H5P_DATASET_CREATE), H5P_DEFAULT);
  const Handle d = impl_->checked(made, H5Dclose, what);
  impl_->check(H5Dwrite(d, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()), what);
}

std::string Hdf5File::read_text(const std::string& name) const {
  const Handle d = impl_->dataset(name);
  const Handle type(H5Dget_type(d), H5Tclose);
  if (!impl_->extents(d, name).empty()) throw FileError(impl_->path.string() + ": '" + name + "' is not a single text");
  const auto read = [&](hid_t t, void* to) { return H5Dread(d, t, H5S_ALL, H5S_ALL, H5P_DEFAULT, to); };
  return impl_->text(type, "'" + name + "'", read);
}

void Hdf5File::set_attribute(const std::string& object, const std::string& key, const std::string& value) {
  impl_->set(object, key, text_type(value.size()), value.c_str());
}
void Hdf5File::set_attribute(const std::string& object, const std::string& key, double value) {
  impl_->set(object, key, H5T_NATIVE_DOUBLE, &value);
}
void Hdf5File::set_attribute(const std::string& object, const std::string& key, std::uint64_t value) {
  impl_->set(object, key, H5T_NATIVE_UINT64, &value);
}

bool Hdf5File::has_attribute(const std::string& object, const std::string& key) const {
  return H5Aexists_by_name(impl_->id, object.c_str(), key.c_str(), H5P_DEFAULT) > 0;
}

std::string Hdf5File::text_attribute(const std::string& object, const std::string& key) const {
  const Handle a = impl_->attribute(object, key);
  const Handle type(H5Aget_type(a), H5Tclose);
  const Handle space(H5Aget_space(a), H5Sclose);
  if (H5Sget_simple_extent_npoints(space) != 1)
    throw FileError(impl_->path.string() + ": attribute '" + key + "' is not a single text");
  return impl_->text(type, "attribute '" + key + "'", [&](hid_t t, void* to) { return H5Aread(a, t, to); });
}

double Hdf5File::number_attribute(const std::string& object, const std::string& key) const {
  double value = 0.0;
  impl_->get(object, key, H5T_FLOAT, H5T_NATIVE_DOUBLE, &value);
  return value;
}

std::uint64_t Hdf5File::count_attribute(const std::string& object, const std::string& key) const {
  std::uint64_t value = 0;
  impl_->get(object, key, H5T_INTEGER, H5T_NATIVE_UINT64, &value);
  return value;
}

}  // namespace epafi

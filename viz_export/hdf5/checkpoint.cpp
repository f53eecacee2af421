#include "viz_export/hdf5/checkpoint.h"

#include <set>

#include "engine/state/hash.h"
#include "viz_export/files/side_file.h"
#include "viz_export/hdf5/hdf5_file.h"

namespace epafi {

namespace {

constexpr std::uint64_t format_number = 5;  // grows when old files can no longer be read
constexpr const char* kind = "epafi checkpoint";
const std::string columns_group = "/state/";

/// Hash of name, element size and bytes, so that a renamed or truncated column is detected.
std::uint64_t column_hash(std::string_view name, std::size_t element, const std::byte* data, std::size_t bytes) {
  Hash hash;
  hash.add(name);
  hash.add(element);
  hash.add(bytes);
  std::size_t i = 0;
  for (; i + 8 <= bytes; i += 8) {
    std::uint64_t word;
    std::memcpy(&word, data + i, 8);
    hash.add(word);
  }
  for (; i < bytes; ++i) hash.add(static_cast<std::uint64_t>(data[i]));
  return hash.value();
}

std::uint64_t header_hash(const CheckpointHeader& h, std::uint64_t columns) {
  Hash hash;
  hash.add(h.version);
  hash.add(h.scene_hash);
  hash.add(h.scene_path);
  hash.add(h.scene_text);
  for (const std::string& line : h.overrides) hash.add(line);
  hash.add(h.step);
  hash.add(&h.time, 1);
  hash.add(columns);
  if (!h.record.empty()) hash.add(h.record);
  return hash.value();
}

class SavingVisitor : public StateVisitor {
 public:
  explicit SavingVisitor(Hdf5File& file) : file_(file) {}
  std::uint64_t columns = 0;

 protected:
  std::size_t bytes_of(std::string_view, std::size_t, std::size_t current) override { return current; }
  void exchange(std::string_view name, std::size_t element, std::byte* data, std::size_t bytes) override {
    const std::string dataset = columns_group + std::string(name);
    file_.write<std::uint8_t>(dataset, {reinterpret_cast<const std::uint8_t*>(data), bytes});
    file_.set_attribute(dataset, "element", static_cast<std::uint64_t>(element));
    file_.set_attribute(dataset, "hash", column_hash(name, element, data, bytes));
    ++columns;
  }

 private:
  Hdf5File& file_;
};

class LoadingVisitor : public StateVisitor {
 public:
  explicit LoadingVisitor(const Hdf5File& file) : file_(file) {}
  bool has_loaded(const std::string& name) const { return loaded_.count(name) != 0; }
  bool has(std::string_view name) const override { return file_.has(columns_group + std::string(name)); }

 protected:
  std::size_t bytes_of(std::string_view name, std::size_t element, std::size_t) override {
    const std::string column(name), dataset = columns_group + column;
    if (!file_.has(dataset)) refuse(column, "is missing");
    const auto shape = file_.shape(dataset);
    if (file_.count_attribute(dataset, "element") != element || shape.size() != 1 || shape[0] % element != 0)
      refuse(column, "has elements of another size than this program's");
    return shape[0];
  }
  void exchange(std::string_view name, std::size_t element, std::byte* data, std::size_t bytes) override {
    const std::string column(name), dataset = columns_group + column;
    if (!loaded_.insert(column).second) refuse(column, "is asked for twice");
    file_.read_into(dataset, reinterpret_cast<std::uint8_t*>(data), bytes);
    if (file_.count_attribute(dataset, "hash") != column_hash(name, element, data, bytes))
      refuse(column, "is damaged: its hash does not fit its bytes");
  }

 private:
  [[noreturn]] void refuse(const std::string& column, const std::string& what) const {
    throw FileError(file_.path().string() + ": cannot load the checkpoint: column '" + column + "' " + what);
  }
  const Hdf5File& file_;
  std::set<std::string> loaded_;
};

/// Names of all datasets below a group, without the group's own path.
void collect_columns(const Hdf5File& file, const std::string& prefix, std::vector<std::string>& names) {
  for (const std::string& child : file.children(columns_group + prefix)) {
    const std::string name = prefix + child;
    if (file.has_attribute(columns_group + name, "hash")) {
      names.push_back(name);
    } else {
      collect_columns(file, name + "/", names);
    }
  }
}

/// Checks all columns before the state is changed: HDF5 does not detect changed bytes in plain datasets.
void verify_columns(const Hdf5File& file, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const std::string dataset = columns_group + name;
    const auto bytes = file.read<std::uint8_t>(dataset);
    const auto element = static_cast<std::size_t>(file.count_attribute(dataset, "element"));
    const auto* data = reinterpret_cast<const std::byte*>(bytes.data());
    if (file.count_attribute(dataset, "hash") != column_hash(name, element, data, bytes.size()))
      throw FileError(file.path().string() + ": cannot load the checkpoint: column '" + name +
                      "' is damaged: its hash does not fit its bytes");
  }
}

CheckpointHeader read_header(const Hdf5File& file) {
  const std::string path = file.path().string();
  if (!file.has_attribute("/", "kind") || file.text_attribute("/", "kind") != kind)
    throw FileError(path + ": is not a checkpoint of Epafi");
  const std::uint64_t format = file.count_attribute("/", "format");
  if (format != format_number)
    throw FileError(path + ": has checkpoint format " + std::to_string(format) + ", this program reads format " +
                    std::to_string(format_number) + "; resume with the version that wrote it");
  CheckpointHeader h;
  h.version = file.text_attribute("/", "version");
  h.scene_hash = file.text_attribute("/", "scene_hash");
  h.scene_path = file.text_attribute("/", "scene_path");
  h.scene_text = file.read_text("/scene");
  for (const std::string& key : file.children("/overrides")) h.overrides.push_back(file.read_text("/overrides/" + key));
  h.step = file.count_attribute("/", "step");
  h.time = file.number_attribute("/", "time");
  if (file.has("/record")) h.record = file.read_text("/record");
  if (file.count_attribute("/", "header_hash") != header_hash(h, file.count_attribute("/", "columns")))
    throw FileError(path + ": the checkpoint's header is damaged: its hash does not fit");
  return h;
}

std::string override_name(std::size_t k) {
  const std::string digits = std::to_string(k);
  return "/overrides/" + std::string(6 - std::min<std::size_t>(6, digits.size()), '0') + digits;
}

}  // namespace

void save_checkpoint(const std::filesystem::path& path, const CheckpointHeader& header, const StateWalk& walk) {
  SideFile side(path);
  Hdf5File file(side.path(), Hdf5File::Mode::create);
  SavingVisitor visitor(file);
  file.make_group("/state");
  walk(visitor);
  file.set_attribute("/", "kind", std::string(kind));
  file.set_attribute("/", "format", format_number);
  file.set_attribute("/", "version", header.version);
  file.set_attribute("/", "scene_hash", header.scene_hash);
  file.set_attribute("/", "scene_path", header.scene_path);
  file.write_text("/scene", header.scene_text);
  if (!header.record.empty()) file.write_text("/record", header.record);
  file.make_group("/overrides");
  for (std::size_t k = 0; k < header.overrides.size(); ++k) file.write_text(override_name(k), header.overrides[k]);
  file.set_attribute("/", "step", header.step);
  file.set_attribute("/", "time", header.time);
  file.set_attribute("/", "columns", visitor.columns);
  file.set_attribute("/", "header_hash", header_hash(header, visitor.columns));
  file.close();
  side.commit(true);
}

CheckpointHeader read_checkpoint_header(const std::filesystem::path& path) {
  return read_header(Hdf5File(path, Hdf5File::Mode::read));
}

void load_state(const std::filesystem::path& path, const StateWalk& walk) {
  const Hdf5File file(path, Hdf5File::Mode::read);
  (void)read_header(file);
  LoadingVisitor visitor(file);
  walk(visitor);
}

CheckpointHeader load_checkpoint(const std::filesystem::path& path, const std::string& scene_hash,
                                 const StateWalk& walk) {
  const Hdf5File file(path, Hdf5File::Mode::read);
  CheckpointHeader header = read_header(file);
  if (header.scene_hash != scene_hash)
    throw FileError(path.string() + ": belongs to another scene (hash " + header.scene_hash + ", this scene has " +
                    scene_hash + ")");
  std::vector<std::string> names;
  collect_columns(file, "", names);
  if (names.size() != file.count_attribute("/", "columns"))
    throw FileError(path.string() + ": is damaged: it holds " + std::to_string(names.size()) + " columns of " +
                    std::to_string(file.count_attribute("/", "columns")));
  verify_columns(file, names);
  LoadingVisitor visitor(file);
  walk(visitor);
  for (const std::string& name : names)
    if (!visitor.has_loaded(name))
      throw FileError(path.string() + ": cannot load the checkpoint: column '" + name +
                      "' is not a part of this simulation");
  return header;
}

}  // namespace epafi

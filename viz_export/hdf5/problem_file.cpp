#include "viz_export/hdf5/problem_file.h"

#include <algorithm>
#include <fstream>

#include "viz_export/hdf5/hdf5_file.h"

namespace epafi {

namespace {

using Index = Eigen::Index;
using Sparse = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& why) {
  throw FileError(path.string() + ": " + why);
}

Sparse to_matrix(Index rows, Index columns, const Triplets& entries) {
  Sparse m(rows, columns);
  m.setFromTriplets(entries.begin(), entries.end());
  return m;
}

std::int64_t number(const Hdf5File& file, const std::string& name) {
  std::int64_t value = 0;
  file.read_into(name, &value, 1);
  return value;
}

/// rows, columns: required by the vectors of the problem; a matrix that states others is refused before memory is
/// allocated.
Sparse read_matrix(const Hdf5File& file, const std::string& name, Index rows, Index columns) {
  const std::int64_t m = number(file, name + "/m"), n = number(file, name + "/n"), nz = number(file, name + "/nz");
  if (m != rows || n != columns)
    refuse(file.path(), "matrix '" + name + "' has " + std::to_string(m) + " x " + std::to_string(n) +
                            " entries, the vectors ask for " + std::to_string(rows) + " x " + std::to_string(columns));
  const auto i = file.read<std::int64_t>(name + "/i"), p = file.read<std::int64_t>(name + "/p");
  const auto x = file.read<double>(name + "/x");
  const auto broken = [&](const std::string& why) { refuse(file.path(), "matrix '" + name + "' " + why); };
  if (nz < -2) broken("has nz = " + std::to_string(nz) + "; allowed are -1 (columns), -2 (rows), >= 0 (triplets)");
  Triplets entries;
  const auto add = [&](std::int64_t row, std::int64_t col, std::size_t k) {
    if (row < 0 || row >= m || col < 0 || col >= n) broken("has an entry outside its extent");
    entries.emplace_back(static_cast<int>(row), static_cast<int>(col), x[k]);
  };
  if (nz >= 0) {
    const auto count = static_cast<std::size_t>(nz);
    if (i.size() < count || p.size() < count || x.size() < count) broken("has fewer entries than nz");
    for (std::size_t k = 0; k < count; ++k) add(i[k], p[k], k);
    return to_matrix(m, n, entries);
  }
  const std::int64_t outer = nz == -1 ? n : m;
  if (p.size() < static_cast<std::size_t>(outer) + 1) broken("has too few starts of columns");
  for (std::int64_t c = 0; c < outer; ++c) {
    const std::int64_t from = p[static_cast<std::size_t>(c)], to = p[static_cast<std::size_t>(c) + 1];
    if (from < 0 || to < from || static_cast<std::size_t>(to) > std::min(i.size(), x.size()))
      broken("has wrong starts");
    for (auto k = static_cast<std::size_t>(from); k < static_cast<std::size_t>(to); ++k)
      nz == -1 ? add(i[k], c, k) : add(c, i[k], k);
  }
  return to_matrix(m, n, entries);
}

Eigen::VectorXd read_vector(const Hdf5File& file, const std::string& name) {
  const auto values = file.read<double>(name);
  if (values.size() > std::size_t{1} << 27) refuse(file.path(), "'" + name + "' is too long");  // indices are 32 bits
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Index>(values.size()));
}

void check_friction(const std::filesystem::path& path, const Eigen::VectorXd& mu) {
  for (const double x : mu)
    if (!(x >= 0.0)) refuse(path, "a friction coefficient is " + std::to_string(x) + "; allowed are values >= 0");
}

Eigen::VectorXd read_friction(const Hdf5File& file, const std::string& name, Index rows) {
  const auto mu = file.read<double>(name);
  if (3 * static_cast<Index>(mu.size()) != rows)
    refuse(file.path(), "has " + std::to_string(mu.size()) + " friction coefficients for " + std::to_string(rows) +
                            " rows; only three rows per contact are read");
  Eigen::VectorXd v = Eigen::Map<const Eigen::VectorXd>(mu.data(), static_cast<Index>(mu.size()));
  check_friction(file.path(), v);
  return v;
}

std::variant<GlobalForm, LocalForm> read_hdf5(const std::filesystem::path& path) {
  const Hdf5File file(path, Hdf5File::Mode::read);
  if (file.has("fclib_local")) {
    LocalForm form;
    form.q = read_vector(file, "fclib_local/vectors/q");
    const Index rows = form.q.size();
    form.mu = read_friction(file, "fclib_local/vectors/mu", rows);
    form.W = read_matrix(file, "fclib_local/W", rows, rows);
    return form;
  }
  if (!file.has("fclib_global")) refuse(path, "holds neither 'fclib_local' nor 'fclib_global'");
  GlobalForm form;
  form.f = read_vector(file, "fclib_global/vectors/f");
  form.w = read_vector(file, "fclib_global/vectors/w");
  form.mu = read_friction(file, "fclib_global/vectors/mu", form.w.size());
  form.M = read_matrix(file, "fclib_global/M", form.f.size(), form.f.size());
  form.H = read_matrix(file, "fclib_global/H", form.f.size(), form.w.size());
  return form;
}

/// Numbers of a text file, one after the other.
class Numbers {
 public:
  explicit Numbers(const std::filesystem::path& path) : path_(path) {
    if (std::filesystem::is_regular_file(path)) in_.open(path);  // a pipe would be waited for
    if (!in_.is_open()) refuse(path, "cannot be opened");
  }
  double next(const char* what) {
    double x = 0;
    if (!(in_ >> x)) refuse(path_, std::string("ends or is no number where the ") + what + " should stand");
    return x;
  }
  Index count(const char* what) {
    const double x = next(what);
    if (!(x >= 0.0 && x <= 1e8) || x != std::floor(x)) refuse(path_, std::string(what) + " is no count");
    return static_cast<Index>(x);
  }

 private:
  std::filesystem::path path_;
  std::ifstream in_;
};

Sparse read_blocks(Numbers& in, Index rows, const std::filesystem::path& path) {
  const Index blocks = in.count("number of blocks"), n0 = in.count("block rows"), n1 = in.count("block columns");
  if (n0 * 3 != rows || n1 * 3 != rows) refuse(path, "blocks are not 3 x 3");
  for (Index k = 0; k < n0 + n1; ++k) in.count("block size");
  const Index starts = in.count("number of row starts"), columns = in.count("number of columns");
  std::vector<Index> start, column;
  for (Index k = 0; k < starts; ++k) start.push_back(in.count("row start"));
  for (Index k = 0; k < columns; ++k) column.push_back(in.count("block column"));
  if (starts < 1 || start.back() > blocks || columns < blocks || !std::is_sorted(start.begin(), start.end()))
    refuse(path, "block pattern is inconsistent");
  Triplets entries;
  for (Index row = 0; row + 1 < starts; ++row)
    for (Index k = start[static_cast<std::size_t>(row)]; k < start[static_cast<std::size_t>(row) + 1]; ++k) {
      in.count("number of a block");
      for (int j = 0; j < 3; ++j)  // a block is stored by columns
        for (int i = 0; i < 3; ++i) {
          const Index c = 3 * column[static_cast<std::size_t>(k)] + j, r = 3 * row + i;
          if (c >= rows || r >= rows) refuse(path, "a block lies outside W");
          entries.emplace_back(static_cast<int>(r), static_cast<int>(c), in.next("block"));
        }
    }
  return to_matrix(rows, rows, entries);
}

LocalForm read_text(const std::filesystem::path& path) {
  Numbers in(path);
  if (in.count("dimension") != 3) refuse(path, "is not in three dimensions");
  const Index contacts = in.count("number of contacts"), storage = in.count("storage of W");
  const Index rows = in.count("rows of W"), columns = in.count("columns of W");
  if (rows != 3 * contacts || columns != rows) refuse(path, "W does not have three rows per contact");
  LocalForm form;
  if (storage == 1) {
    form.W = read_blocks(in, rows, path);
  } else if (storage == 0) {
    Triplets entries;
    for (int j = 0; j < columns; ++j)
      for (int i = 0; i < rows; ++i) entries.emplace_back(i, j, in.next("W"));
    form.W = to_matrix(rows, rows, entries);
  } else {
    refuse(path, "storage " + std::to_string(storage) + " of W; read are 0 (dense) and 1 (blocks)");
  }
  form.q.resize(rows);
  form.mu.resize(contacts);
  for (double& x : form.q) x = in.next("free velocity");
  for (double& x : form.mu) x = in.next("friction coefficient");
  check_friction(path, form.mu);
  return form;
}

void write_matrix(Hdf5File& file, const std::string& name, Sparse m) {
  m.makeCompressed();
  const auto one = [&](const char* key, std::int32_t value) {
    file.write<std::int32_t>(name + key, std::span<const std::int32_t>(&value, 1));
  };
  one("/m", static_cast<std::int32_t>(m.rows()));
  one("/n", static_cast<std::int32_t>(m.cols()));
  one("/nz", -1);
  one("/nzmax", static_cast<std::int32_t>(m.nonZeros()));
  const auto count = static_cast<std::size_t>(m.nonZeros());
  file.write<std::int32_t>(name + "/p", std::span(m.outerIndexPtr(), static_cast<std::size_t>(m.cols()) + 1));
  file.write<std::int32_t>(name + "/i", std::span(m.innerIndexPtr(), count));
  file.write<double>(name + "/x", std::span<const double>(m.valuePtr(), count));
}

}  // namespace

ProblemFile read_problem(const std::filesystem::path& path) {
  std::string name = path.filename().string();
  const bool text = path.extension() == ".dat";
  for (const char* ending : {".dat", ".hdf5", ".h5"})
    if (name.size() > std::string(ending).size() && name.ends_with(ending)) name.resize(name.rfind('.'));
  if (text) return {name, read_text(path)};
  return {name, read_hdf5(path)};
}

void write_problem(const std::filesystem::path& path, const GlobalForm& form, const std::string& title) {
  Hdf5File file(path, Hdf5File::Mode::create);
  const std::int32_t dimension = 3;
  file.write<std::int32_t>("fclib_global/spacedim", std::span(&dimension, 1));
  write_matrix(file, "fclib_global/M", form.M);
  write_matrix(file, "fclib_global/H", form.H);
  const auto vector = [&](const char* key, const Eigen::VectorXd& v) {
    file.write<double>(std::string("fclib_global/vectors/") + key,
                       std::span<const double>(v.data(), static_cast<std::size_t>(v.size())));
  };
  vector("f", form.f);
  vector("w", form.w);
  vector("mu", form.mu);
  file.write_text("fclib_global/info/title", title);
  file.close();
}

}  // namespace epafi

#include "ranks/state_image.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <stdexcept>

#include "engine/units/error.h"
#include "ranks/communicator.h"
#include "ranks/plan.h"

namespace epafi {

namespace {

const std::string states_name = "world/states";

class ImageSaver final : public StateVisitor {
 public:
  explicit ImageSaver(bool with_states) : with_states_(with_states) {}
  StateImage image;

 protected:
  bool only_counts() const override { return with_states_; }  // of columns in records, which are in the states
  std::size_t bytes_of(std::string_view, std::size_t, std::size_t current) override { return current; }
  void exchange(std::string_view name, std::size_t element, std::byte* data, std::size_t bytes) override {
    if (data == nullptr && bytes > 0) return;
    image.push_back({std::string(name), whose(), element, RowBytes(bytes)});
    if (bytes > 0) std::memcpy(image.back().data.data(), data, bytes);
  }

 private:
  bool with_states_;
};

class ImageLoader final : public StateVisitor {
 public:
  ImageLoader(StateImage& image, bool with_states) : image_(image), with_states_(with_states) {}
  bool has(std::string_view name) const override { return find(name) != nullptr; }

 protected:
  bool only_counts() const override { return with_states_; }
  std::size_t bytes_of(std::string_view name, std::size_t, std::size_t) override {
    EPAFI_REQUIRE(has(name), "both states have the same columns");
    return find(name)->data.size();
  }
  void exchange(std::string_view name, std::size_t, std::byte* data, std::size_t bytes) override {
    if (data != nullptr && bytes > 0) std::memcpy(data, find(name)->data.data(), bytes);
  }

 private:
  ImageColumn* find(std::string_view name) const {
    const auto at = std::ranges::find(image_, name, &ImageColumn::name);
    return at == image_.end() ? nullptr : &*at;
  }
  StateImage& image_;
  bool with_states_;
};

/// Columns whose rows are sent together.
struct RowGroup {
  std::vector<ImageColumn*> columns;
  bool slots_inside = false;  ///< in the first bytes of a row of the first column; else they are columns of their own
  std::size_t row() const {
    std::size_t bytes = 0;
    for (const ImageColumn* c : columns) bytes += c->row;
    return bytes;
  }
  std::size_t rows() const { return columns.front()->rows(); }
  void write(std::size_t k, std::byte* to) const {
    for (const ImageColumn* c : columns) {
      std::memcpy(to, c->data.data() + k * c->row, c->row);
      to += c->row;
    }
  }
  Slot* slot(std::size_t k, std::size_t which) const {
    std::byte* const at = slots_inside ? columns[0]->data.data() + k * columns[0]->row + which * sizeof(Slot)
                                       : columns[which]->data.data() + k * sizeof(Slot);
    return reinterpret_cast<Slot*>(at);
  }
};

RowGroup body_group(StateImage& image) {
  RowGroup group;
  for (ImageColumn& c : image)
    if (c.whose == RowsOf::bodies) group.columns.push_back(&c);
  return group;
}

std::vector<RowGroup> contact_groups(StateImage& image) {
  std::vector<RowGroup> groups;
  for (ImageColumn& c : image) {
    const bool begins = c.whose == RowsOf::first_slots || c.whose == RowsOf::pairs;
    if (begins) groups.push_back({{&c}, c.whose == RowsOf::pairs});
    if (c.whose == RowsOf::second_slots || c.whose == RowsOf::contacts) groups.back().columns.push_back(&c);
  }
  return groups;
}

struct BodyHead {
  std::uint32_t place;
  std::int32_t owner;
};
struct ContactHead {
  std::uint32_t a, b;  ///< places
};

/// Rows of a group with heads on their way. Those that stay with this rank are not touched until all are put in order.
template <class Head>
class Parcel {
 public:
  explicit Parcel(const RowGroup& group) : group_(group), apart_(sizeof(Head) + group.row()) {}
  void add(int rank, const Head& head, std::size_t k) {
    if (rank != own_) return sent_.push_back({rank, head, k});
    staying_.push_back(k);
    heads_.push_back(head);
  }
  /// Heads of the rows that stay, then of those that have come.
  const std::vector<Head>& send(double& bytes) {
    std::vector<std::size_t> next(static_cast<std::size_t>(rank_count()) + 1, 0);  // row of each rank
    for (const Item& item : sent_) ++next[static_cast<std::size_t>(item.rank) + 1];
    std::partial_sum(next.begin(), next.end(), next.begin());
    RowBytes rows(sent_.size() * apart_);
    std::vector<int> to(sent_.size());
    for (const Item& item : sent_) {
      const std::size_t k = next[static_cast<std::size_t>(item.rank)]++;
      std::byte* const at = rows.data() + k * apart_;
      to[k] = item.rank;
      std::memcpy(at, &item.head, sizeof(Head));
      group_.write(item.k, at + sizeof(Head));
    }
    bytes += static_cast<double>(rows.size());
    Plan plan(to);
    plan.run(rows, apart_, arrived_);
    for (std::size_t k = 0; k < plan.received(); ++k)
      std::memcpy(&heads_.emplace_back(), arrived_.data() + k * apart_, sizeof(Head));
    return heads_;
  }
  /// The row of head order[k] becomes row k.
  void unpack(const std::vector<std::uint32_t>& order) const {
    const std::vector<std::size_t> begin = runs_of(order);
    std::size_t offset = sizeof(Head);
    for (ImageColumn* c : group_.columns) {
      RowBytes all(order.size() * c->row);
      for (std::size_t run = 0; run + 1 < begin.size(); ++run) {
        const std::size_t k = order[begin[run]];
        const std::byte* const from = k < staying_.size() ? c->data.data() + staying_[k] * c->row
                                                          : arrived_.data() + (k - staying_.size()) * apart_ + offset;
        std::memcpy(all.data() + begin[run] * c->row, from, (begin[run + 1] - begin[run]) * c->row);
      }
      c->data.swap(all);
      offset += c->row;
    }
  }

 private:
  struct Item {
    int rank;
    Head head;
    std::size_t k;
  };
  /// Where rows begin that lie side by side in their columns, and the end.
  std::vector<std::size_t> runs_of(const std::vector<std::uint32_t>& order) const {
    const auto stays = [&](std::size_t k) { return order[k] < staying_.size(); };
    std::vector<std::size_t> begin;
    for (std::size_t k = 0; k < order.size(); ++k)
      if (k == 0 || !stays(k) || !stays(k - 1) || staying_[order[k]] != staying_[order[k - 1]] + 1) begin.push_back(k);
    begin.push_back(order.size());
    return begin;
  }

  const RowGroup& group_;
  std::size_t apart_;  ///< bytes from one sent row to the next
  int own_ = rank_number();
  std::vector<Item> sent_;
  std::vector<std::size_t> staying_;
  std::vector<Head> heads_;
  RowBytes arrived_;
};

/// Merges sorted runs, one per rank, into a sorted whole.
template <class Less>
void merge_runs(std::vector<std::uint32_t>& order, const Less& less) {
  std::vector<std::size_t> begin{0};
  for (std::size_t k = 1; k < order.size(); ++k)
    if (less(order[k], order[k - 1])) begin.push_back(k);
  begin.push_back(order.size());
  const auto at = [&](std::size_t run) { return order.begin() + static_cast<std::ptrdiff_t>(begin[run]); };
  while (begin.size() > 2) {
    std::vector<std::size_t> merged{0};
    for (std::size_t run = 0; run + 1 < begin.size(); run += 2) {
      const std::size_t last = std::min(run + 2, begin.size() - 1);
      std::inplace_merge(at(run), at(run + 1), at(last), less);
      merged.push_back(begin[last]);
    }
    begin.swap(merged);
  }
}

/// Received bodies are sorted by their place among all bodies.
void exchange_bodies(const RowGroup& group, const Routes& routes, Arrival& arrival) {
  Parcel<BodyHead> parcel(group);
  for (std::size_t s = 0; s < routes.place.size(); ++s)
    for (std::uint32_t k = routes.begin[s]; routes.mine[s] != 0 && k < routes.begin[s + 1]; ++k)
      parcel.add(routes.to[k], {routes.place[s], routes.owner[s]}, s);
  const std::vector<BodyHead>& heads = parcel.send(arrival.bytes);
  std::vector<std::uint32_t> order(heads.size());
  std::iota(order.begin(), order.end(), 0u);
  merge_runs(order, [&](std::uint32_t i, std::uint32_t k) { return heads[i].place < heads[k].place; });
  arrival.place.reserve(order.size());
  arrival.owner.reserve(order.size());
  for (const std::uint32_t k : order) {
    arrival.place.push_back(heads[k].place);
    arrival.owner.push_back(heads[k].owner);
  }
  EPAFI_REQUIRE(std::ranges::adjacent_find(arrival.place) == arrival.place.end(), "a body comes once");
  parcel.unpack(order);
}

bool goes_to(const Routes& routes, Slot body, int rank) {
  const auto begin = routes.to.begin() + routes.begin[body], end = routes.to.begin() + routes.begin[body + 1];
  return std::find(begin, end, rank) != end;
}

/// A contact goes to the owners of its bodies, sent by that of the first free one.
void exchange_contacts(const RowGroup& group, const Routes& routes, Arrival& arrival) {
  Parcel<ContactHead> parcel(group);
  for (std::size_t k = 0; k < group.rows(); ++k) {
    const Slot a = *group.slot(k, 0), b = *group.slot(k, 1);
    const int first = routes.owner[a], second = routes.owner[b];
    const bool held_a = first == Routes::all_ranks, held_b = second == Routes::all_ranks;
    const ContactHead head{routes.place[a], routes.place[b]};
    if (held_a && held_b)
      for (const int rank : routes.to_all) parcel.add(rank, head, k);
    if ((held_a && held_b) || routes.mine[held_a ? b : a] == 0) continue;
    if (routes.gathers) {
      parcel.add(0, head, k);
      continue;
    }
    if (routes.to_one) {  // bodies that have parted have nothing to remember
      const int rank = held_a ? second : first;
      if (goes_to(routes, held_a ? a : b, rank)) parcel.add(rank, head, k);
      continue;
    }
    if (!held_a) parcel.add(first, head, k);
    if (!held_b && (held_a || first != second)) parcel.add(second, head, k);
  }
  const std::vector<ContactHead>& heads = parcel.send(arrival.bytes);
  const auto slot_of = [&](std::uint32_t place) {
    const auto at = std::ranges::lower_bound(arrival.place, place);
    if (at == arrival.place.end() || *at != place) throw std::logic_error("a contact came to a rank without its body");
    return static_cast<Slot>(at - arrival.place.begin());
  };
  std::vector<std::uint32_t> order(heads.size());
  std::iota(order.begin(), order.end(), 0u);
  // contacts of one pair come from one rank, in the order of their features
  std::ranges::stable_sort(order, {}, [&](std::uint32_t k) { return std::pair(heads[k].a, heads[k].b); });
  parcel.unpack(order);
  for (std::size_t k = 0; k < order.size(); ++k) {
    *group.slot(k, 0) = slot_of(heads[order[k]].a);
    *group.slot(k, 1) = slot_of(heads[order[k]].b);
  }
}

/// Fills the slot of each id from the id of each slot.
void find_slots(StateImage& image) {
  const auto ids = std::ranges::find(image, std::string("world/id"), &ImageColumn::name);
  for (ImageColumn& c : image) {
    if (c.whose != RowsOf::ids) continue;
    EPAFI_REQUIRE(ids != image.end() && c.row == sizeof(Slot), "a world has ids and slots");
    auto* const slots = reinterpret_cast<Slot*>(c.data.data());
    std::fill_n(slots, c.rows(), no_slot);
    for (std::uint32_t s = 0; s < ids->rows(); ++s) {
      std::uint32_t id = 0;
      std::memcpy(&id, ids->data.data() + s * sizeof id, sizeof id);
      slots[id] = s;
    }
  }
}

}  // namespace

StateImage image_of(const StateWalk& walk, const World* world) {
  const bool with_states = world && world->columns().states;
  ImageSaver saver(with_states);
  walk(saver);
  if (with_states) {
    const auto states = std::as_bytes(world->states());
    saver.image.push_back({states_name, RowsOf::bodies, sizeof(BodyState), RowBytes(states.begin(), states.end())});
  }
  return std::move(saver.image);
}

void restore(StateImage& image, const StateWalk& walk, World* world) {
  const bool with_states = world && world->columns().states;
  ImageLoader loader(image, with_states);
  walk(loader);
  if (!with_states) return;
  const RowBytes& from = std::ranges::find(image, states_name, &ImageColumn::name)->data;
  const auto to = std::as_writable_bytes(world->states());
  EPAFI_REQUIRE(to.size() == from.size(), "a state for each body");
  if (!to.empty()) std::memcpy(to.data(), from.data(), to.size());
}

Arrival exchange_rows(StateImage& image, const Routes& routes) {
  Arrival arrival;
  exchange_bodies(body_group(image), routes, arrival);
  const std::vector<RowGroup> groups = contact_groups(image);
  std::vector<double> rows;
  for (const RowGroup& group : groups) rows.push_back(static_cast<double>(group.rows()));
  sum_over_ranks(rows);
  for (std::size_t k = 0; k < groups.size(); ++k)
    if (rows[k] > 0.0) exchange_contacts(groups[k], routes, arrival);  // a plan costs messages, even for no rows
  find_slots(image);
  return arrival;
}

}  // namespace epafi

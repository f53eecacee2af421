/// @file orders.h  Orders of rank 0 for the next common task of all ranks.
#pragma once
#include <cstdint>
#include <exception>
#include <optional>
#include <type_traits>

#include "engine/step/domain.h"
#include "engine/step/observer.h"
#include "ranks/communicator.h"

namespace epafi {

enum class Task : std::int32_t {
  receive,
  give,
  give_seen,  ///< contacts as `contacts` wants them
  totals,
  stiffness,
  step,
  receive_to_find,
  find,
  give_found,
  help,
  figures,
  announce,  ///< the text follows, of `size` bytes
  end
};

/// An order as sent to all ranks.
struct Order {
  Task task = Task::end;
  std::int32_t code = 0;  ///< to end with; totals: overlaps are asked for too
  ContactView contacts = ContactView::none;
  double dt = 0.0;  ///< [s]
  double low[3] = {}, high[3] = {};
  std::int32_t has_domain = 0, outside = 0;
  bool run_on = false;
  std::uint64_t size = 0;  ///< of what is announced

  void set_domain(const std::optional<Domain>& domain) {
    has_domain = domain.has_value();
    if (!domain) return;
    for (int k = 0; k < 3; ++k) {
      low[k] = domain->min[k];
      high[k] = domain->max[k];
    }
    outside = static_cast<std::int32_t>(domain->outside);
  }
  std::optional<Domain> domain() const {
    if (has_domain == 0) return std::nullopt;
    return Domain{Vec3(low[0], low[1], low[2]), Vec3(high[0], high[1], high[2]), static_cast<Domain::Outside>(outside)};
  }
};
static_assert(std::is_trivially_copyable_v<Order>);

/// By rank 0; the others take it by the same broadcast.
inline void tell(Order order) { broadcast(&order, sizeof order); }

/// True during its lifetime, and for ever after an exception.
class Busy {
 public:
  explicit Busy(bool& busy) : busy_(busy), exceptions_(std::uncaught_exceptions()) { busy_ = true; }
  ~Busy() { busy_ = std::uncaught_exceptions() > exceptions_; }
  Busy(const Busy&) = delete;
  Busy& operator=(const Busy&) = delete;

 private:
  bool& busy_;
  int exceptions_;
};

}  // namespace epafi

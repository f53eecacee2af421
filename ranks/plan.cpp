#include "ranks/plan.h"

#include <mpi.h>
#include <zoltan_comm.h>
#include <zoltan_types.h>

#include "engine/units/error.h"

namespace epafi {

namespace {
constexpr int tag_of_plan = 11, tag_of_rows = 12;

ZOLTAN_COMM_OBJ* zoltan(void* plan) { return static_cast<ZOLTAN_COMM_OBJ*>(plan); }

void check(int code, const char* what) {
  if (code != ZOLTAN_OK && code != ZOLTAN_WARN)
    throw FileError(std::string("ranks: ") + what + " failed, Zoltan's code " + std::to_string(code));
}
}  // namespace

Plan::Plan(std::vector<int> to) : sent_(to.size()) {
  ZOLTAN_COMM_OBJ* made = nullptr;
  int count = 0;
  to.reserve(1);  // no null pointer
  check(Zoltan_Comm_Create(&made, static_cast<int>(to.size()), to.data(), MPI_COMM_WORLD, tag_of_plan, &count),
        "a communication plan");
  plan_ = made;
  received_ = static_cast<std::size_t>(count);
}

Plan::~Plan() {
  ZOLTAN_COMM_OBJ* made = zoltan(plan_);
  if (made != nullptr) Zoltan_Comm_Destroy(&made);
}

namespace {
/// No null pointers.
char* bytes_of(const std::vector<std::byte>& rows) {
  static std::byte none{};
  return reinterpret_cast<char*>(const_cast<std::byte*>(rows.empty() ? &none : rows.data()));
}
}  // namespace

void Plan::begin(const std::vector<std::byte>& rows, std::size_t row, std::vector<std::byte>& arrived) const {
  EPAFI_REQUIRE(rows.size() == sent_ * row, "a row for each place of the plan");
  arrived.resize(received_ * row);
  check(Zoltan_Comm_Do_Post(zoltan(plan_), tag_of_rows, bytes_of(rows), static_cast<int>(row), bytes_of(arrived)),
        "an exchange");
}

void Plan::finish(const std::vector<std::byte>& rows, std::size_t row, std::vector<std::byte>& arrived) const {
  check(Zoltan_Comm_Do_Wait(zoltan(plan_), tag_of_rows, bytes_of(rows), static_cast<int>(row), bytes_of(arrived)),
        "an exchange");
}

}  // namespace epafi

/// @file contact_list.h  Contacts as frames show them: those that touch or carry force.
#pragma once
#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/step/contact_pieces.h"

namespace epafi {

/// Some contacts, rows [first, first + size) of a frame; row is counted from the frame's first one. Each value is
/// fetched on access: written out they take 104 bytes a contact, and half the time of a frame.
class ContactRows {
 public:
  ContactRows() = default;
  /// `acting`: places among the contacts.
  /// residual: of each contact of the set, or empty.
  ContactRows(const World& world, const ContactSet& contacts, std::size_t first, std::vector<std::uint32_t> acting,
              std::span<const float> residual = {})
      : world_(&world), contacts_(&contacts), first_(first), acting_(std::move(acting)), residual_(residual) {}
  std::size_t begin() const { return first_; }
  std::size_t end() const { return first_ + acting_.size(); }

  std::uint32_t id_a(std::size_t row) const { return static_cast<std::uint32_t>(world_->id[contacts_->a[at(row)]]); }
  std::uint32_t id_b(std::size_t row) const { return static_cast<std::uint32_t>(world_->id[contacts_->b[at(row)]]); }
  /// Centre of A [m]; the contact point in place of a wall's centre.
  Vec3 from(std::size_t row) const;
  Vec3 to(std::size_t row) const;  ///< the same of B, of the image that is touched
  const Vec3& force(std::size_t row) const { return contacts_->force[at(row)]; }  ///< on A [N]
  /// > 0 pushes the bodies apart [N].
  double normal_force(std::size_t row) const { return -force(row).dot(contacts_->normal[at(row)]); }
  double overlap(std::size_t row) const { return std::max(0.0, -contacts_->gap[at(row)]); }  ///< [m], >= 0
  bool has_residual() const { return !residual_.empty(); }
  /// Residual of this contact: its square is the contribution to the square of the solver's residual.
  float residual(std::size_t row) const { return residual_[at(row)]; }

  /// To the same rows of `contacts`, and of `residual` where there is one.
  void copy(ContactSet& contacts, std::vector<float>& residual) const;

 private:
  std::size_t at(std::size_t row) const { return acting_[row - first_]; }
  const World* world_ = nullptr;
  const ContactSet* contacts_ = nullptr;
  std::size_t first_ = 0;
  std::vector<std::uint32_t> acting_;
  std::span<const float> residual_;
};

/// All of them, a piece at a time: whole columns of what a contact model finds itself took 350 bytes a sphere of a bed.
/// Empty before forces have been evaluated. Rows are in the order of the pieces.
class ContactList {
 public:
  ContactList() = default;
  /// residual: of each contact that the model has not found itself, of which there are then none; or empty.
  ContactList(const World& world, const ContactPieces& contacts, std::span<const float> residual = {});
  /// All of `contacts`, which the caller keeps alive, as copy() has filled them.
  ContactList(const World& world, const ContactSet& contacts, std::span<const float> residual);
  /// Copies the list, independent of later steps of the model. residual: by contact.
  void copy(ContactSet& contacts, std::vector<float>& residual) const;
  std::size_t size() const { return begins_.back(); }
  /// The row at which each piece begins, and one behind the last: a piece at least, which may be empty.
  const std::vector<std::size_t>& begins() const { return begins_; }
  /// f(rows) of a piece; several threads may read.
  template <class F>
  void read(std::size_t piece, const F& f) const {
    if (size() == 0) return f(ContactRows{});
    contacts_->read(pieces_[piece], [&](const ContactSet& c, std::size_t begin, std::size_t end) {
      const bool all = all_act_ || contacts_->all_touching(pieces_[piece]);
      f(ContactRows(*world_, c, begins_[piece], acting(c, begin, end, all),
                    residual_.size() == c.size() ? residual_ : std::span<const float>{}));
    });
  }

 private:
  /// Places among `contacts` of those that touch or carry force, or of all.
  static std::vector<std::uint32_t> acting(const ContactSet& contacts, std::size_t begin, std::size_t end, bool all);
  const World* world_ = nullptr;
  std::optional<ContactPieces> contacts_;
  std::span<const float> residual_;
  bool all_act_ = false;
  std::vector<std::size_t> pieces_;  ///< that have rows
  std::vector<std::size_t> begins_{0, 0};
};

}  // namespace epafi

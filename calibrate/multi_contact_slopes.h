// Forces of a multi-contact law on many measured states at once, and how they change with the numbers of the law: what
// fits ask for again and again while geometry stays. Held to multi_contact_forces() and to central differences of it by
// the tests.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "common/contact/multi_contact_prediction.h"
#include "common/data/multi_contact_measurements.h"

namespace softgrain {

/// One state: neighbours and their overlaps [Rs]. Both must outlive what is made of it.
struct OverlapState {
  const std::vector<MultiContactPartner>* partners = nullptr;
  const std::vector<double>* overlap = nullptr;
};

/// Lenses, directions and who touches whom are worked out once; the numbers of the law are ln a, b, delta, m0, m1, m2,
/// then ln w and m of every kind and size of neighbour that occurs.
class MultiContactSlopes {
 public:
  MultiContactSlopes(LawForm form, const std::vector<OverlapState>& states);

  [[nodiscard]] std::size_t forces() const { return forces_.size(); }
  [[nodiscard]] std::size_t numbers() const { return kLaw + 2 * kinds_.size(); }

  /// The numbers of a law of this form.
  [[nodiscard]] std::vector<double> numbers_of(const MultiContactModel& model) const;

  /// Forces over E Rs^2 as multi_contact_forces() has them, state after state, touching neighbour after touching
  /// neighbour.
  void evaluate(std::span<const double> numbers, std::span<double> force) const;

  /// Depth that counts, over Rs, less the threshold, of every soft particle of every state: where it changes its sign,
  /// forces have a kink. -1 of one without overlap.
  [[nodiscard]] std::vector<double> above_threshold(std::span<const double> numbers) const;

  /// d force/d number, row-major (forces x numbers). At the threshold of a body, where forces have a kink, the side
  /// without force.
  void slopes(std::span<const double> numbers, std::span<double> slope) const;

 private:
  static constexpr std::size_t kLaw = 6;

  struct Contact {
    Lens<double> lens;
    Vec3 direction;
    std::size_t kind = 0;  ///< index of its constants, in kinds_
  };
  /// A soft particle: its contacts are in contacts_, one after the other.
  struct Body {
    std::size_t first = 0;
    std::size_t count = 0;
  };
  /// A force on a neighbour: what the centre adds, and of soft neighbours what they add themselves.
  struct Side {
    std::size_t body = 0;
    std::size_t contact = 0;  ///< index in contacts_
    double area = 1.0;        ///< radius of the body squared, over Rs^2
  };
  struct Force {
    Side centre;
    Side other;
    bool has_other = false;
  };
  struct BodyState;
  struct Evaluation;

  std::size_t kind_of(const MultiContactPartner& partner);
  Contact contact_of(const MultiContactPartner& partner, double overlap);
  std::size_t add_body(const std::vector<Contact>& contacts);
  void add_state(const OverlapState& state);
  [[nodiscard]] Side other_side(const OverlapState& state, std::size_t k);
  [[nodiscard]] Evaluation evaluation(std::span<const double> numbers) const;
  [[nodiscard]] double force_of(const Evaluation& at, const Side& side) const;
  void add_slopes(const Evaluation& at, const Side& side, std::span<double> row) const;

  LawForm form_;
  std::vector<MultiContactPartner> kinds_;  ///< one neighbour of each kind and size
  std::vector<Contact> contacts_;
  std::vector<Body> bodies_;
  std::vector<Force> forces_;
};

}  // namespace softgrain

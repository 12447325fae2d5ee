// Three laws at a material point, in principal stresses: NorSand, SANISAND (2004) and the cell law with shear memory.
// Stresses over E, compression positive, logarithmic strains. compare.py compiles this file and calls run().
//
// NorSand and SANISAND: elasticity B = n p (1 - x)/(x e), x = (p/K)^(1/n), which is the slope of the isotropic curve
// p = K x^n of the cell law at any density, and G = r B. Critical state: e_c = e_G - l p^xi, psi = e - e_c.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>
#include <vector>

namespace {

using Vec = std::array<double, 3>;
constexpr double kLeastPressure = 1e-8;

double sum(const Vec& a) { return a[0] + a[1] + a[2]; }
double dot(const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
double norm(const Vec& a) { return std::sqrt(dot(a, a)); }
Vec scaled(const Vec& a, double f) { return {a[0] * f, a[1] * f, a[2] * f}; }
Vec added(const Vec& a, const Vec& b, double f = 1.0) { return {a[0] + f * b[0], a[1] + f * b[1], a[2] + f * b[2]}; }
Vec raised(const Vec& a, double b) { return {a[0] + b, a[1] + b, a[2] + b}; }
double mean(const Vec& a) { return sum(a) / 3.0; }
Vec deviator(const Vec& a) { return raised(a, -mean(a)); }

/// A plastic law in rates: with the flow R and the loading direction n, d lambda = n:E:d eps/(n:E:R + Kp).
class Plastic {
 public:
  /// par: K n r e_G l xi
  Plastic(const double* par, double p, double e, const double* grading)
      : shift_(grading[0]), factor_(grading[1]), stress_{p, p, p}, e_(e) {
    std::tie(K_, n_, shear_, e_G_, l_, xi_) = std::tuple(par[0], par[1], par[2], par[3], par[4], par[5]);
  }
  virtual ~Plastic() = default;

  /// Strains the point by `step`; with `lateral` above 0 the sides take the strain that brings them to it.
  void strain(const Vec& step, double lateral) {
    const double largest = std::max({std::abs(step[0]), std::abs(step[1]), std::abs(step[2])});
    for (double left = 1.0; left > 1e-12;) {
      moduli();
      const double size = std::min(5e-5, 1e-3 * mean(stress_) / std::max(B_, G_));
      const double share = std::min(left, size / std::max(largest, 1e-12));
      Vec part = scaled(step, share);
      const double rise = lateral > 0.0 ? (lateral - 0.5 * (stress_[0] + stress_[1])) * share / left : 0.0;
      advance(part, lateral > 0.0, rise);
      e_ = (1.0 + e_) * std::exp(-sum(part)) - 1.0;
      left -= share;
      if (++steps_ > 20000) return;
    }
  }

  Vec stress() const { return stress_; }
  double void_ratio() const { return e_; }

 protected:
  struct Flow {
    Vec direction;  ///< R
    Vec loading;    ///< n
    double hardening = 0.0;
  };
  virtual bool yields(const Vec& trial) const = 0;
  virtual Flow flow(const Vec& trial) = 0;
  virtual void harden(double multiplier) = 0;
  virtual void correct() = 0;

  double state_parameter(double p) const { return relative_void_ratio() - e_G_ + l_ * std::pow(p, xi_); }
  double relative_void_ratio() const { return (e_ - shift_) / factor_; }
  Vec elastic(const Vec& strain) const { return raised(scaled(deviator(strain), 2.0 * G_), B_ * sum(strain)); }

  double shift_, factor_, K_ = 0.0, n_ = 0.0, shear_ = 0.0, e_G_ = 0.0, l_ = 0.0, xi_ = 0.0;
  double B_ = 0.0, G_ = 0.0;
  Vec stress_;
  double e_;
  int steps_ = 0;

 private:
  void moduli() {
    const double p = std::max(mean(stress_), kLeastPressure);
    const double x = std::min(std::pow(p / K_, 1.0 / n_), 0.9);
    B_ = n_ * p * (1.0 - x) / (x * std::max(e_, 0.02));
    G_ = shear_ * B_;
  }

  void advance(Vec& part, bool by_stress, double rise) {
    const double a = B_ + 4.0 / 3.0 * G_, b = B_ - 2.0 / 3.0 * G_;
    if (by_stress) part[0] = part[1] = (rise - b * part[2]) / (a + b);
    const Vec trial = added(stress_, elastic(part));
    if (yields(trial)) {
      const Flow f = flow(trial);
      const Vec ER = elastic(f.direction), En = elastic(f.loading);
      const double below = std::max(dot(f.loading, ER) + f.hardening, 1e-3 * G_);
      Vec whole = part;
      if (by_stress) {
        const double along = a + b - ER[0] * (En[0] + En[1]) / below;
        const double across = b - ER[0] * En[2] / below;
        if (along > 1e-3 * (a + b)) whole[0] = whole[1] = (rise - across * part[2]) / along;
      }
      const double multiplier = dot(En, whole) / below;
      if (multiplier > 0.0) {
        part = whole;
        stress_ = added(added(stress_, elastic(part)), ER, -multiplier);
        hold();
        harden(multiplier);
        correct();
        hold();
        return;
      }
    }
    stress_ = trial;
    hold();
  }

  void hold() {
    if (!(mean(stress_) > kLeastPressure)) stress_ = {kLeastPressure, kLeastPressure, kLeastPressure};
  }
};

/// Jefferies (1993), Geotechnique 43, 91; the form of Jefferies and Shuttle (2011), as remembered:
///   q = M_i p (1 - ln(p/p_i)), associated, so D = d eps_v/d eps_q = M_i - q/p;
///   M_i = M(theta) (1 - N chi_i |psi_i|/M), psi_i = e - e_c(p_i), chi_i = chi/(1 - chi l_e/M), l_e = -d e_c/d ln p_i;
///   M(theta) = M - M^2/(3 + M) cos(3 theta/2 + pi/4), theta = pi/6 in triaxial compression;
///   d p_i/p_i = H (M_i/M) (p/p_i)^2 [exp(-chi_i psi_i/M) - p_i/p] d eps_q, H = H_0 - H_psi psi_i.
/// exp(...) is the densest image pressure, which D_min = chi psi gives. Elastic below the surface; no inner cap.
class NorSand : public Plastic {
 public:
  /// par: K n r e_G l xi | M N chi H_0 H_psi R; p_i = R p/e at the start (R = 1: on the surface).
  NorSand(const double* par, double p, double e, const double* grading)
      : Plastic(par, p, e, grading), image_(par[11] * p / std::numbers::e) {
    std::tie(M_, N_, chi_, H0_, Hpsi_) = std::tuple(par[6], par[7], par[8], par[9], par[10]);
  }

 private:
  struct State {
    double M_i, densest, hardening;
  };
  State state(const Vec& s) const {
    const double l_e = l_ * xi_ * std::pow(image_, xi_);
    const double chi = chi_ / std::max(1.0 - chi_ * l_e / M_, 0.2);
    const double psi = state_parameter(image_);
    const Vec d = deviator(s);
    const double q = std::sqrt(1.5) * norm(d);
    const double lode = q > 1e-12 ? std::asin(std::clamp(13.5 * d[0] * d[1] * d[2] / (q * q * q), -1.0, 1.0)) / 3.0
                                  : std::numbers::pi / 6.0;
    const double M = M_ - M_ * M_ / (3.0 + M_) * std::cos(1.5 * lode + 0.25 * std::numbers::pi);
    const double lower = std::max(1.0 - N_ * chi * std::abs(psi) / M_, 0.1);
    const double densest = std::exp(std::clamp(-chi * psi / (M_ * lower), -3.0, 3.0));
    return {M * lower, densest, std::max(H0_ - Hpsi_ * psi, 1.0) * M / M_ * lower};
  }
  /// d ln p_i/d eps_q.
  double rate(const Vec& s) const {
    const State now = state(s);
    const double ratio = std::max(mean(s), kLeastPressure) / image_;
    return now.hardening * ratio * ratio * (now.densest - 1.0 / ratio);
  }
  double excess(const Vec& s) const {
    const double p = std::max(mean(s), kLeastPressure);
    return std::sqrt(1.5) * norm(deviator(s)) - state(s).M_i * p * (1.0 + std::log(image_ / p));
  }
  bool yields(const Vec& trial) const override { return excess(trial) > 0.0; }
  Flow flow(const Vec& /*trial*/) override { return at(stress_); }
  Flow at(const Vec& s) const {
    const double p = std::max(mean(s), kLeastPressure);
    const Vec d = deviator(s);
    const double q = std::sqrt(1.5) * norm(d);
    const double M_i = state(s).M_i;
    const Vec n = raised(q > 1e-9 * p ? scaled(d, 1.5 / q) : Vec{}, (M_i - q / p) / 3.0);
    return {n, n, M_i * p * rate(s)};
  }
  void harden(double multiplier) override {
    image_ = std::max(image_ * (1.0 + std::clamp(rate(stress_) * multiplier, -0.5, 0.5)), kLeastPressure);
  }
  /// Back to the yield surface along the flow (Potts and Gens 1985): M_i changes with psi_i and theta.
  void correct() override {
    for (int k = 0; k < 2; ++k) {
      const Flow f = at(stress_);
      const Vec ER = elastic(f.direction);
      const double below = std::max(dot(f.loading, ER) + f.hardening, 1e-3 * G_);
      stress_ = added(stress_, ER, -excess(stress_) / below);
    }
  }

  double M_, N_, chi_, H0_, Hpsi_, image_;
};

/// Dafalias and Manzari (2004), J. Eng. Mech. 130, 622, without fabric:
///   |r - alpha| = sqrt(2/3) m, r = s/p, n its normal; d alpha = lambda (2/3) h (alpha_b - alpha),
///   h = b_0/((alpha - alpha_in):n), b_0 = h_0 (1 - c_h e) G/p, K_p = (2/3) p h (alpha_b - alpha):n;
///   alpha_b, alpha_d = sqrt(2/3) [g M exp(-n_b psi) - m, g M exp(n_d psi) - m] n, g = 2c/(1 + c - (1 - c) cos 3theta);
///   D = A_0 (alpha_d - alpha):n, R = B n - C (n^2 - I/3) + D I/3, B = 1 + 1.5 (1 - c)/c g cos 3theta,
///   C = 3 sqrt(1.5) (1 - c)/c g. G/p stands for the paper's G_0 (p/p_at)^(-1/2), without its density function.
class Sanisand : public Plastic {
 public:
  /// par: K n r e_G l xi | M c h_0 c_h n_b A_0 n_d
  Sanisand(const double* par, double p, double e, const double* grading) : Plastic(par, p, e, grading) {
    std::tie(M_, c_, h0_, ch_, nb_, A0_, nd_) = std::tuple(par[6], par[7], par[8], par[9], par[10], par[11], par[12]);
  }

 private:
  static constexpr double kRadius = 0.01 * 0.816496580927726;  ///< sqrt(2/3) m, m = 0.01
  static Vec ratio(const Vec& s) { return scaled(deviator(s), 1.0 / std::max(mean(s), kLeastPressure)); }
  bool yields(const Vec& trial) const override { return norm(added(ratio(trial), alpha_, -1.0)) > kRadius; }

  Flow flow(const Vec& trial) override {
    const double p = std::max(mean(stress_), kLeastPressure);
    const Vec off = added(ratio(trial), alpha_, -1.0);
    const Vec n = scaled(off, 1.0 / std::max(norm(off), 1e-12));
    if (dot(added(alpha_, start_, -1.0), n) < 0.0) start_ = alpha_;
    const double cos3 =
        std::clamp(std::sqrt(6.0) * (n[0] * n[0] * n[0] + n[1] * n[1] * n[1] + n[2] * n[2] * n[2]), -1.0, 1.0);
    const double g = 2.0 * c_ / (1.0 + c_ - (1.0 - c_) * cos3);
    const double psi = std::clamp(state_parameter(p), -1.0, 1.0);
    const double to_bound = std::sqrt(2.0 / 3.0) * (g * M_ * std::exp(std::clamp(-nb_ * psi, -3.0, 3.0)) - 0.01);
    const double to_dilate = std::sqrt(2.0 / 3.0) * (g * M_ * std::exp(std::clamp(nd_ * psi, -3.0, 3.0)) - 0.01);
    towards_ = added(scaled(n, to_bound), alpha_, -1.0);
    const double D = A0_ * (to_dilate - dot(alpha_, n));
    const double b0 = h0_ * std::max(1.0 - ch_ * relative_void_ratio(), 0.01) * G_ / p;
    h_ = b0 / std::max(dot(added(alpha_, start_, -1.0), n), 1e-5);
    const double B = 1.0 + 1.5 * (1.0 - c_) / c_ * g * cos3;
    const double C = 3.0 * std::sqrt(1.5) * (1.0 - c_) / c_ * g;
    const Vec square{n[0] * n[0], n[1] * n[1], n[2] * n[2]};
    const Vec R = raised(added(scaled(n, B), raised(square, -1.0 / 3.0), -C), D / 3.0);
    return {R, raised(n, -dot(n, ratio(stress_)) / 3.0), 2.0 / 3.0 * p * h_ * dot(towards_, n)};
  }
  void harden(double multiplier) override { alpha_ = added(alpha_, towards_, multiplier * 2.0 / 3.0 * h_); }
  /// The surface is brought to the stress.
  void correct() override {
    const Vec off = added(ratio(stress_), alpha_, -1.0);
    if (const double size = norm(off); size > 1e-12) alpha_ = added(ratio(stress_), off, -kRadius / size);
  }

  double M_, c_, h0_, ch_, nb_, A0_, nd_;
  Vec alpha_{}, start_{}, towards_{};
  double h_ = 0.0;
};

/// The cell law with shear memory, mean field: macrosim/cell_matter/material_point.cpp in short.
class CellPoint {
 public:
  /// par: x_r K n | mu_f chi A r_c m c [k or lambda]. rule 0: the cell law; 1: strength mu_f exp(-m psi), as M_b of
  /// SANISAND; 2: stiffness of faces chi exp(-k psi), softer when loose, as its h; 3: lambda, by which phi_c goes with
  /// the pressure, as e_c. e_J: void ratio at which the grading jams as the card's preparation.
  CellPoint(const double* par, double p, double e, double e_J, int rule)
      : rule_(rule), x_r_(par[0]), K_(par[1]), n_(par[2]), mu_(par[3]), chi_(par[4]), A_(par[5]), m_(par[7]) {
    c_ = rule == 1 ? 1.0 : par[8];
    k_ = rule == 2 ? par[9] : 0.0;
    slope_ = rule == 3 ? par[9] : 0.0;
    const double x = std::pow(p / K_, 1.0 / n_);
    phi_ = 1.0 / (1.0 + e);
    onset_ = next_ = (phi_ - x) / (1.0 - x);
    critical_ = 1.0 / (1.0 + par[6] * e_J);
    constexpr std::array<double, 5> cosine{0.04691007703066800, 0.2307653449471585, 0.5, 0.7692346550528415,
                                           0.9530899229693320};
    constexpr std::array<double, 5> share{0.1184634425280945, 0.2393143352496832, 0.2844444444444444,
                                          0.2393143352496832, 0.1184634425280945};
    for (int i = 0; i < 5; ++i)
      for (int j = 0; j < 4; ++j) {
        const double sine = std::sqrt(1.0 - cosine[i] * cosine[i]), angle = (j + 0.5) / 8.0 * std::numbers::pi;
        faces_.push_back({{sine * std::cos(angle), sine * std::sin(angle), cosine[i]}, share[i] / 4.0, {}, {}});
      }
    respond();
    stiffness_ = chi_ * B_ * std::exp(-k_ * psi());
    strength_ = strength();
  }

  void strain(const Vec& step, double lateral) {
    const double largest = std::max({std::abs(step[0]), std::abs(step[1]), std::abs(step[2])});
    const int parts = std::max(1, static_cast<int>(std::ceil(largest / 2.5e-3 * (1.0 - 1e-9))));
    for (int k = 0; k < parts; ++k) {
      Vec one = scaled(step, 1.0 / parts);
      if (!(lateral > 0.0)) {
        part(one);
        continue;
      }
      const CellPoint before = *this;
      double low = -2.0 * std::abs(one[2]), high = -low;
      for (int n = 0; n < 40; ++n) {
        one[0] = one[1] = 0.5 * (low + high);
        *this = before;
        part(one);
        const Vec s = stress();
        (0.5 * (s[0] + s[1]) > lateral ? high : low) = one[0];
      }
    }
  }
  Vec stress() const {
    Vec out{p_ + spring_, p_ + spring_, p_ + spring_};
    for (const Face& f : faces_)
      for (int k = 0; k < 3; ++k) out[k] += 3.0 * f.weight * f.sum[k] * f.normal[k];
    return out;
  }
  double void_ratio() const { return 1.0 / phi_ - 1.0; }

 private:
  struct Face {
    Vec normal;
    double weight;
    std::array<Vec, 6> force;
    Vec sum;
  };
  static constexpr std::array<double, 6> kShare{0.0608, 0.2239, 0.3921, 0.2585, 0.0589, 0.0058};
  static constexpr std::array<double, 6> kYield{0.1006, 0.3017, 0.704, 1.5085, 3.5198, 9.0509};

  void respond() {  // of a volume of 1, with the tail below x_r
    const double end = onset_ + x_r_ * (1.0 - onset_);
    const auto at = [&](double phi) {
      const double t = phi - onset_;
      const double p = K_ * std::pow(t / (1.0 - onset_), n_);
      return std::array<double, 2>{p, n_ * p / t * phi};
    };
    if (phi_ > end) {
      const auto [p, B] = at(phi_);
      p_ = p;
      B_ = B;
      push_ = (n_ - 1.0) * phi_ / (phi_ - onset_) + 1.0;
      return;
    }
    const auto [p, B] = at(end);
    const double rate = B * end / phi_ / p, u = 1.0 / (1.0 + 0.5 * (1.0 - phi_ / end) * rate);
    p_ = p * u * u;
    B_ = p * rate * u * u * u;
    push_ = 1.5 * u * rate - 1.0;
  }
  double psi() const { return (critical_ + slope_ * std::max(phi_ - next_, 0.0) - next_) / (1.0 - critical_); }
  double strength() const {
    const double mu = rule_ == 1 ? mu_ * std::exp(std::clamp(-m_ * psi(), -2.0, 2.0))
                                 : mu_ * (1.0 + c_ * std::tanh(-m_ * psi() / c_));
    if (mu >= mu_) return mu;
    return mu_ + (mu - mu_) * std::clamp(0.5 * ((phi_ - next_) / (1.0 - next_) / x_r_ - 1.0), 0.0, 1.0);
  }
  void part(const Vec& step) {
    phi_ = std::min(phi_ * std::exp(sum(step)), 0.999);
    onset_ = next_;
    const double k0 = stiffness_;
    respond();
    const double k = stiffness_ = chi_ * B_ * std::exp(-k_ * psi());
    double slip = 0.0, used = 0.0, energy = 0.0;
    for (Face& f : faces_) {
      const Vec motion{step[0] * f.normal[0], step[1] * f.normal[1], step[2] * f.normal[2]};
      const Vec in_plane = added(motion, f.normal, -dot(motion, f.normal));
      const Vec held = scaled(f.sum, k / k0);
      f.sum = {};
      for (int s = 0; s < 6; ++s) {
        Vec& T = f.force[s];
        T = added(scaled(T, k / k0), in_plane, k * kShare[s]);
        const double most = kShare[s] * kYield[s] * strength_ * p_, size = norm(T);
        if (size > most) T = scaled(T, most / size);
        f.sum = added(f.sum, T);
        energy += 3.0 * f.weight * dot(T, T) / (2.0 * kShare[s] * k);
      }
      const Vec moved = added(in_plane, added(f.sum, held, -1.0), -1.0 / k);
      slip += 2.0 * f.weight * norm(moved);
      used += 3.0 * f.weight * std::max(0.0, 0.5 * dot(added(f.sum, held), moved)) / p_;
    }
    spring_ = energy * push_;
    const double moved = onset_ * (1.0 + A_ * (1.5 * mu_ * slip - used));
    next_ = moved > onset_ ? std::min(moved, std::max(onset_, (phi_ - x_r_) / (1.0 - x_r_))) : moved;
    strength_ = strength();
  }

  int rule_;
  double x_r_, K_, n_, mu_, chi_, A_, m_, c_ = 1.0, k_ = 0.0, slope_ = 0.0, stiffness_ = 0.0;
  double phi_ = 0.0, onset_ = 0.0, next_ = 0.0, critical_ = 0.0;
  double p_ = 0.0, B_ = 0.0, push_ = 0.0, spring_ = 0.0, strength_ = 0.0;
  std::vector<Face> faces_;
};

template <class Point>
void follow(Point point, int points, const double* strain, const double* lateral, double* out) {
  for (int k = 1; k < points; ++k) {
    const double* a = strain + 3 * (k - 1);
    point.strain({a[3] - a[0], a[4] - a[1], a[5] - a[2]}, lateral[k]);
    const Vec s = point.stress();
    for (int j = 0; j < 3; ++j) out[4 * k + j] = s[j];
    out[4 * k + 3] = point.void_ratio();
  }
}

}  // namespace

/// Follows a path from the isotropic pressure p and the void ratio e. `lateral`: stress that the sides keep at each
/// point, 0 where their strain is given. `grading`, plastic laws: shift and factor of void ratios against those of the
/// fit, in psi and c_h; cell law: e_J. out: three stresses and the void ratio of each point.
extern "C" void run(int model, const double* par, double p, double e, const double* grading, int points,
                    const double* strain, const double* lateral, double* out) {
  out[0] = out[1] = out[2] = p;
  out[3] = e;
  if (model == 0) {
    follow(NorSand(par, p, e, grading), points, strain, lateral, out);
  } else if (model == 1) {
    follow(Sanisand(par, p, e, grading), points, strain, lateral, out);
  } else {
    follow(CellPoint(par, p, e, grading[0], model - 2), points, strain, lateral, out);
  }
}

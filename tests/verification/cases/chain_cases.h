// Chains of beads: momentum passed on by single impacts, the solitary wave of Hertz contacts, sound under compression.
#pragma once

#include <string>
#include <vector>

namespace softgrain::verification {

/// Newton's cradle of equal elastic beads with gaps between them: the first `strikers` come with 1 m/s. Final speeds
/// [m/s]; closed form: as many at the other end leave with 1 m/s, all others rest.
inline constexpr std::size_t kCradleBeads = 5;
std::vector<double> run_cradle(std::size_t strikers);
std::string cradle_scene(std::size_t strikers);

/// Beads with gaps, each `ratio` times as large in radius as the one before (below 1), hit one after the other. Closed
/// form: v_(i+1) = (1 + e) m_i/(m_i + m_(i+1)) v_i, and bead i keeps (m_i - e m_(i+1))/(m_i + m_(i+1)) of v_i.
struct TaperedChain {
  double ratio = 0.8;
  double restitution = 0.9;
  std::size_t beads = 6;
};
std::vector<double> run_tapered(const TaperedChain& chain);
std::vector<double> tapered_closed_form(const TaperedChain& chain);

/// Speed of the leading pulse in an uncompressed chain that a bead of the same kind hits.
struct SolitaryWave {
  double striker = 0.0;    ///< speed of the hit [m/s]
  double amplitude = 0.0;  ///< largest speed of a bead as the pulse passes [m/s]
  double speed = 0.0;      ///< of the pulse [m/s]
};
SolitaryWave run_solitary(double striker_speed);

/// Nesterenko's long-wave theory: V = (16/25)^(1/5) c0^(4/5) v_m^(1/5), c0^2 = K (2R)^(5/2)/m = 2E/(pi rho (1-nu^2)).
double long_wave_speed(double amplitude);
/// The discrete chain: V^5 = (g^3/J) c0^4 v_m with numbers of its travelling wave, see discrete_wave().
double discrete_wave_speed(double amplitude);

/// The travelling wave of the chain itself, r(n - ct) for the overlap of neighbours: m c^2 r = K (tent * r^(3/2)), tent
/// = max(1 - |x|, 0) [English and Pego 2005], solved by iteration on a grid. Scaled to max r = 1: g = tent * r^(3/2) at
/// the top, J = integral of r^(3/2) over one bead around it. Of long waves g^3/J would be 16/25.
struct DiscreteWave {
  double g = 0.0;
  double j = 0.0;
  std::vector<double> x;  ///< [beads]
  std::vector<double> r;
};
const DiscreteWave& discrete_wave();

/// Speed of a bead over time as the pulse of run_solitary(1 m/s) passes, x = (t - t_peak) V/2R in beads, over v_m; and
/// the same of the travelling wave.
struct PulseShape {
  std::vector<double> x;
  std::vector<double> here;
  std::vector<double> discrete;
};
PulseShape pulse_shape();

/// Angular frequency of a small standing wave of `mode` periods over the ring of kRingBeads precompressed beads.
inline constexpr int kRingBeads = 40;
struct SoundMode {
  int mode = 0;
  double frequency = 0.0;    ///< [rad/s]
  double closed_form = 0.0;  ///< 2 sqrt(k/m) sin(pi mode/beads), k = (3/2) K sqrt(h)
  double wave_speed = 0.0;   ///< frequency over wave number [m/s]
  double long_wave = 0.0;    ///< spacing sqrt(k/m) [m/s]
};
SoundMode run_sound(int mode);

}  // namespace softgrain::verification

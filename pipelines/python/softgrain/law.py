"""Laws of soft particles: cards (law.toml) and tables (law_table.toml), evaluated by the compiled laws of the simulation.

Delta = h/R is the overlap over the radius of the soft particle (of two the smaller). Forces are in newtons for a soft particle of
`radius` [m] whose grains have Young's modulus `modulus` [Pa]; both are those that were measured unless said otherwise. With
radius=1, modulus=1 numbers are dimensionless: F/(E R^2), stiffness/(E R).
"""
import os
import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from softgrain import installation
from softgrain.errors import InputError
from softgrain.figures import Drawn, new_figure


@dataclass(frozen=True)
class ThresholdPowerLaw:
    """The numbers of F(Delta) = 0 below delta, a (Delta^b - delta^b) from there on; c = -a delta^b."""

    a: float
    b: float
    c: float
    delta: float
    intervals: dict  # parameter: (low, high) at 95 %, of those that the card states

    def __repr__(self):
        return f"<F = {self.a:.4g} Delta^{self.b:.4g} {self.c:+.3g} from Delta = {self.delta:.4g} on>"


@dataclass(frozen=True)
class PairLaw:
    """One kind of contact. normal: Fn/(E Rs^2); tangential_initial and tangential_secant: kt/(E Rs), None when not fitted."""

    kind: str
    status: str
    normal: ThresholdPowerLaw
    tangential_initial: ThresholdPowerLaw | None
    tangential_secant: ThresholdPowerLaw | None
    delta_min: float
    delta_max: float

    def __repr__(self):
        return f"<{self.kind} law ({self.status}): {self.normal!r}, measured for {self.delta_min:.3g} to {self.delta_max:.3g}>"


def _scalar_or_array(values, shape):
    return float(values) if shape == () else values.reshape(shape)


def _overlaps(values, name="delta"):
    """Overlaps as floats, and the mask of what is masked (None: nothing is). InputError for what is no number, and for flags, which
    would count as 0 and 1."""
    masked = np.ma.isMaskedArray(values)
    hint = ""
    try:
        array = values if masked else np.asarray(values)
        if array.dtype.kind in "iufO" or array.size == 0:
            return np.asarray(array.filled(0) if masked else array, dtype=float), np.ma.getmaskarray(array) if masked else None
        hint = f"; flags choose elements: {name}[flags]" if array.dtype.kind == "b" else ""
    except (TypeError, ValueError):
        pass
    raise InputError([f"{name} = {values!r:.60}: must be a number or an array of numbers{hint}"])


def _masked(values, mask):
    """The answer with the mask of the question."""
    return values if mask is None else np.ma.masked_array(values, mask=mask)


class Law(Drawn):
    """A law that was fitted. Law.load() gives a CardLaw or a TableLaw."""

    path: Path
    shell_radius: float  # Rs of what was measured [m]
    youngs_modulus: float  # E [Pa]
    card: dict  # all that the file says

    @staticmethod
    def load(path):
        """A card (law.toml) or a table (law_table.toml), or that of a run directory. InputError with file and line for wrong content,
        and for a card of the cell law, which has no forces at contacts; IoError for files."""
        laws = installation.laws()
        file, law = laws.load(os.fspath(path))
        return CardLaw(file, law) if isinstance(law, laws.Card) else TableLaw(file, law)

    def __fspath__(self):  # wherever a law file is asked for
        return str(self.path)

    @staticmethod
    def from_library(out, *, mu=None, exponent=None, ratio=None, solid_fraction=None, nu=None, press_test=None, library=None,
                     own=None):
        """The law table of a material that was not measured, concluded from measured ones, written to `out` (.toml) and loaded.

        mu: friction of the grains; exponent, ratio: b and rmax/rmin of their sizes, P(r) ~ r^-b; solid_fraction: of the grains in
        their shell; nu: Poisson's ratio, 0.3 unless given. press_test: instead of exponent, ratio, solid_fraction and nu, the table (or
        law card) of a press test of one soft particle on a plane; mu where it does not say it. library: another than that of the
        program; own: a law table of own packings that corrects it. InputError, with the measured ranges, for a material outside
        them; IoError for files."""
        from softgrain.running import execute, raise_for
        options = {"--mu": mu, "--exponent": exponent, "--ratio": ratio, "--solid-fraction": solid_fraction, "--nu": nu,
                   "--press-test": press_test, "--library": library, "--own": own, "--out": os.fspath(out)}
        ended = execute(["law", "get", *(str(x) for name, value in options.items() if value is not None for x in (name, value))])
        if ended.status != 0:
            raise_for(ended)
        return Law.load(out)

    def __reduce__(self):  # in another process the file is read again
        return Law.load, (str(self.path.resolve()),)

    def _units(self, radius, modulus):
        radius = self.shell_radius if radius is None else float(radius)
        modulus = self.youngs_modulus if modulus is None else float(modulus)
        for name, value in (("radius", radius), ("modulus", modulus)):
            if not (np.isfinite(value) and value > 0.0):
                raise InputError([f"{name} = {value}: must be above 0"])
        return {"force": modulus * radius**2, "stiffness": modulus * radius, "tangential": modulus * radius, "volume": 1.0}


class CardLaw(Law):
    """The law of single contacts: F = E R^2 a (Delta^b - delta^b) above the threshold delta [law card]."""

    def __init__(self, path, law=None):
        self.path = Path(path)
        self._laws = law or installation.laws().Card(str(path))
        self.card = tomllib.loads(self.path.read_text(encoding="utf-8-sig"))
        self.pairs = _pairs(self.card)
        self.shell_radius = float(self.card["measurement"]["shell_radius"])
        self.youngs_modulus = float(self.card["measurement"]["youngs_modulus"])

    def pair(self, kind):
        """The numbers of a kind, "soft-solid" or "soft-soft". KeyError when the card has none."""
        for pair in self.pairs:
            if pair.kind == kind:
                return pair
        raise KeyError(f"the card has no law of kind {kind!r}; it has {[p.kind for p in self.pairs]}")

    def force(self, delta, kind="soft-solid", *, radius=None, modulus=None, beyond=None):
        """Normal force [N] at Delta, a number or an array of any shape; 0 below the threshold.

        beyond: above the largest Delta that was measured "clamp" it, "extrapolate" or refuse ("error": InputError); as the card says
        unless given. InputError too when the card has no usable law of this kind."""
        return self._values(kind, "force", delta, radius, modulus, False, beyond)

    def stiffness(self, delta, kind="soft-solid", *, radius=None, modulus=None, beyond=None):
        """dF/dh [N/m], the derivative of force() by the overlap h = Delta R. By Delta itself: times R."""
        return self._values(kind, "stiffness", delta, radius, modulus, False, beyond)

    def tangential_stiffness(self, delta, kind="soft-solid", *, slope="initial", radius=None, modulus=None, beyond=None):
        """kt [N/m]: slope at no rotation ("initial") or the secant ("secant"), at 1 degree on a plane and 0.5 degree between soft
        particles unless the law was measured otherwise."""
        return self._values(kind, "tangential", delta, radius, modulus, _is_secant(slope), beyond)

    def force_interval(self, delta, kind="soft-solid", *, radius=None, modulus=None, beyond=None):
        """95 % interval of force(): (low, high), from the bootstrap beside the card, else linearised from its covariance; None when
        the card keeps neither; NaN beyond what was measured."""
        return self._interval(kind, "force", delta, radius, modulus, False, beyond)

    def stiffness_interval(self, delta, kind="soft-solid", *, radius=None, modulus=None, beyond=None):
        """95 % interval of stiffness(): (low, high), linearised from the covariance; None without one, NaN beyond what was
        measured."""
        return self._interval(kind, "stiffness", delta, radius, modulus, False, beyond)

    def tangential_interval(self, delta, kind="soft-solid", *, slope="initial", radius=None, modulus=None, beyond=None):
        """95 % interval of tangential_stiffness(): (low, high), or None; NaN beyond what was measured."""
        return self._interval(kind, "tangential", delta, radius, modulus, _is_secant(slope), beyond)

    def inside(self, delta, kind="soft-solid"):
        """Whether Delta lies in what was measured (an array of flags)."""
        pair = self.pair(kind)
        delta, mask = _overlaps(delta)
        return _masked((delta >= pair.delta_min * (1 - 1e-12)) & (delta <= pair.delta_max * (1 + 1e-12)), mask)

    def _values(self, kind, what, delta, radius, modulus, secant, beyond):
        delta, mask = _overlaps(delta)
        out = self._laws.values(kind, what, delta, self._units(radius, modulus)[what], secant, beyond)
        return _masked(_scalar_or_array(out, delta.shape), mask)

    def _interval(self, kind, what, delta, radius, modulus, secant, beyond):
        delta, mask = _overlaps(delta)
        found = self._laws.interval(kind, what, delta, self._units(radius, modulus)[what], secant, beyond)
        return None if found is None else tuple(_masked(_scalar_or_array(side, delta.shape), mask) for side in found)

    def figure(self, kind="soft-solid"):
        """Force over Delta with its 95 % band, as a matplotlib figure."""
        pair = self.pair(kind)
        delta = np.linspace(0.0, pair.delta_max, 200)
        figure, axes = new_figure()
        band = self.force_interval(delta, kind)
        if band is not None:
            axes.fill_between(delta, *band, alpha=0.25, linewidth=0, label="95 %")
        axes.plot(delta, self.force(delta, kind), label=f"{kind} law ({pair.status})")
        axes.axvline(pair.delta_min, color="0.6", linewidth=0.8, linestyle=":", label="measured from here")
        axes.set_xlabel("overlap h/R")
        axes.set_ylabel(f"normal force [N], R = {1e3 * self.shell_radius:.4g} mm")
        axes.legend(frameon=False)
        return figure

    def __repr__(self):
        return f"<law card {self.path}: {', '.join(f'{p.kind} ({p.status})' for p in self.pairs)}>"


class TableLaw(Law):
    """Laws of soft particles that know about all their contacts [law table].

    form: "pair", "isotropic" or "directional"; the best of the table unless given. solid_fraction: that of the contents; of the main packing
    unless given. range: outside the measured solid fractions "reject" or "clamp". partner: "plane", "solid" or "soft" neighbours of
    `ratio` times the radius. arrangement: how neighbours of one kind stand around the particle, all pressed in by Delta: "one",
    "opposite", "cube"... (softgrain law eval --help lists them).
    """

    def __init__(self, path, law=None):
        self.path = Path(path)
        self._laws = law or installation.laws().Table(str(path))
        self.card = tomllib.loads(self.path.read_text(encoding="utf-8-sig"))
        main = self.about()
        self.shell_radius = main["shell_radius"]
        self.youngs_modulus = main["youngs_modulus"]

    def about(self, form=None, solid_fraction=None, range="reject"):  # pylint: disable=redefined-builtin
        """What a choice comes to: form, status, solid_fraction, where it was measured (volume_max, overlap_max), remark."""
        return self._laws.about(_choice(form, solid_fraction, range, None))

    def force(self, delta, partner="plane", *, ratio=1.0, arrangement="one", radius=None, modulus=None, **choice):
        """Normal force [N] on the first of the neighbours, all pressed in by Delta = h/R: a number or an array of any shape.

        choice: form, solid_fraction, range, beyond. InputError for a solid fraction that was not measured, or no such law."""
        return self._even("force", delta, partner, ratio, arrangement, radius, modulus, choice)

    def stiffness(self, delta, partner="plane", *, ratio=1.0, arrangement="one", radius=None, modulus=None, **choice):
        """dF/dh [N/m] of the first neighbour when it alone moves. With arrangement "one": the derivative of force()."""
        return self._even("stiffness", delta, partner, ratio, arrangement, radius, modulus, choice)

    def tangential_stiffness(self, delta, partner="plane", *, ratio=1.0, arrangement="one", radius=None, modulus=None, **choice):
        """kt [N/m] of the first neighbour."""
        return self._even("tangential", delta, partner, ratio, arrangement, radius, modulus, choice)

    def volume(self, delta, partner="plane", *, ratio=1.0, arrangement="one", **choice):
        """Equivalent volume S of the particle, over its own; about()["volume_max"] is the end of what was measured."""
        return self._even("volume", delta, partner, ratio, arrangement, None, None, choice)

    def force_interval(self, delta, partner="plane", *, ratio=1.0, arrangement="one", radius=None, modulus=None, **choice):
        """95 % interval of force(): (low, high), from the refits beside the table; None when it keeps none; NaN beyond what was
        measured."""
        return self._even_interval("force", delta, partner, ratio, arrangement, radius, modulus, choice)

    def stiffness_interval(self, delta, partner="plane", *, ratio=1.0, arrangement="one", radius=None, modulus=None, **choice):
        """95 % interval of stiffness(): (low, high), or None; NaN beyond what was measured."""
        return self._even_interval("stiffness", delta, partner, ratio, arrangement, radius, modulus, choice)

    def forces(self, overlap, direction, partner="plane", ratio=1.0, *, radius=None, modulus=None, **choice):
        """Normal forces [N] on K neighbours that stand anywhere and are pressed in by different overlaps.

        overlap: (..., K), h/R of each, not above 0 where it does not touch; direction: (K, 3), from the centre to the neighbours (need
        not be of length 1); partner and ratio: one for all or one for each. Gives (..., K)."""
        overlap, mask = _overlaps(overlap, "overlap")
        direction = np.atleast_2d(_overlaps(direction, "direction")[0])
        count = len(direction)
        if (overlap.shape[-1] if overlap.ndim else 1) != count:
            raise InputError([f"overlap: shape {overlap.shape}: must have one column per neighbour, {count}"])
        kinds = [partner] * count if isinstance(partner, str) else list(partner)
        ratios = np.broadcast_to(np.asarray(ratio, dtype=float), count).tolist()
        around = installation.laws().Neighbours(kinds, ratios, direction.tolist())
        states = overlap.reshape(-1, overlap.shape[-1] if overlap.ndim else 1)
        scale = self._units(radius, modulus)["force"]
        out = self._laws.values(_choice(**choice), around, "force", -1, states, scale).reshape(overlap.shape)
        return _masked(out, mask)

    def _question(self, delta, partner, ratio, arrangement):
        directions, shares = installation.laws().arrangement(arrangement, 0.5)
        around = installation.laws().Neighbours([partner] * len(shares), [float(ratio)] * len(shares), directions)
        return around, delta.reshape(-1, 1) * np.asarray(shares)

    def _even(self, what, delta, partner, ratio, arrangement, radius, modulus, choice):
        delta, mask = _overlaps(delta)
        around, overlap = self._question(delta, partner, ratio, arrangement)
        out = self._laws.values(_choice(**choice), around, what, 0, overlap, self._units(radius, modulus)[what])
        return _masked(_scalar_or_array(out if delta.ndim else out[0], delta.shape), mask)

    def _even_interval(self, what, delta, partner, ratio, arrangement, radius, modulus, choice):
        delta, mask = _overlaps(delta)
        around, overlap = self._question(delta, partner, ratio, arrangement)
        found = self._laws.interval(_choice(**choice), around, what, 0, overlap, self._units(radius, modulus)[what])
        return None if found is None else tuple(_masked(_scalar_or_array(s if delta.ndim else s[0], delta.shape), mask)
                                                for s in found)

    def figure(self, partner="plane", arrangements=("one", "opposite", "cube"), **choice):
        """Force on the first neighbour over Delta for several arrangements, with 95 % bands, as a matplotlib figure."""
        about = self.about(**{k: v for k, v in choice.items() if k != "beyond"})
        delta = np.linspace(0.0, about["overlap_max"], 120)
        figure, axes = new_figure()
        for arrangement in arrangements:
            force = self.force(delta, partner, arrangement=arrangement, **choice)
            line, = axes.plot(delta, force, label=f"{arrangement}")
            band = self.force_interval(delta, partner, arrangement=arrangement, **choice)
            if band is not None:
                axes.fill_between(delta, *band, alpha=0.2, linewidth=0, color=line.get_color())
        axes.set_xlabel("overlap h/R")
        axes.set_ylabel(f"force on one neighbour [N], R = {1e3 * self.shell_radius:.4g} mm")
        axes.set_title(f"{about['form']} law, solid fraction {about['solid_fraction']:.3f}", fontsize=10)
        axes.legend(frameon=False, title=f"neighbours: {partner}")
        return figure

    def __repr__(self):
        about = self.about()
        fractions = ", ".join(f"{entry['solid_fraction']:.3f}" for entry in self.card["entry"])
        return f"<law table {self.path}: solid fraction {fractions}, best form {about['form']} ({about['status']})>"


def _choice(form=None, solid_fraction=None, range="reject", beyond=None):  # pylint: disable=redefined-builtin
    return installation.laws().TableChoice(form, solid_fraction, range, beyond)


def _is_secant(slope):
    if slope not in ("initial", "secant"):
        raise InputError([f'slope = "{slope}": must be "initial" or "secant"'])
    return slope == "secant"


def _estimates(table):
    names = ("a", "b", "c", "delta")
    intervals = {n: (table[n]["interval_95"]["low"], table[n]["interval_95"]["high"])
                 for n in names if "interval_95" in table[n]}
    return ThresholdPowerLaw(*(float(table[n]["value"]) for n in names), intervals)


def _tangential(pair, name):
    table = pair.get(name)
    return _estimates(table) if table is not None and table.get("fitted", False) else None


def _pairs(card):
    return tuple(PairLaw(p["kind"], p["status"], _estimates(p["normal"]), _tangential(p, "tangential_initial"),
                         _tangential(p, "tangential_secant"), p["validity"]["delta_min"], p["validity"]["delta_max"])
                 for p in card["pair"])

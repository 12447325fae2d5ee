"""Law cards (law.toml): fitted threshold power laws of soft contacts. Everything dimensionless, as in the card."""
import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np


@dataclass(frozen=True)
class ThresholdPowerLaw:
    """F(Delta) = 0 below delta, a Delta^b + c from there on."""

    a: float
    b: float
    c: float
    delta: float
    intervals: dict  # parameter: (low, high) at 95 %, of those that the card states

    def __call__(self, overlap):
        """F at one overlap Delta = hn/Rs or an array of them."""
        overlap = np.asarray(overlap, dtype=float)
        above = overlap >= self.delta
        value = np.where(above, self.a * np.power(np.where(above, overlap, 1.0), self.b) + self.c, 0.0)
        return float(value) if value.ndim == 0 else value


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


@dataclass(frozen=True)
class Law:
    shell_radius: float  # Rs of what was measured [m]
    youngs_modulus: float  # E [Pa]
    pairs: tuple
    card: dict  # all that the file says

    def pair(self, kind):
        """The law of a kind, "soft-solid" or "soft-soft". KeyError when the card has none."""
        for pair in self.pairs:
            if pair.kind == kind:
                return pair
        raise KeyError(f"the card has no law of kind {kind!r}; it has {[p.kind for p in self.pairs]}")

    def force(self, kind, overlap, radius=None, modulus=None):
        """Normal force [N] at an overlap Delta, of soft particles as measured unless radius [m] and modulus [Pa] say else."""
        radius = self.shell_radius if radius is None else radius
        modulus = self.youngs_modulus if modulus is None else modulus
        return modulus * radius**2 * self.pair(kind).normal(overlap)


def _estimates(table):
    names = ("a", "b", "c", "delta")
    intervals = {n: (table[n]["interval_95"]["low"], table[n]["interval_95"]["high"])
                 for n in names if "interval_95" in table[n]}
    return ThresholdPowerLaw(*(float(table[n]["value"]) for n in names), intervals)


def _tangential(pair, name):
    table = pair.get(name)
    return _estimates(table) if table is not None and table.get("fitted", False) else None


def read_law(path):
    """A law card. ValueError when the file is none."""
    with open(Path(path), "rb") as file:
        card = tomllib.load(file)
    if "pair" not in card or "measurement" not in card:
        raise ValueError(f"{path}: is no law card (it has no [measurement] or no [[pair]])")
    pairs = tuple(PairLaw(p["kind"], p["status"], _estimates(p["normal"]), _tangential(p, "tangential_initial"),
                          _tangential(p, "tangential_secant"), p["validity"]["delta_min"], p["validity"]["delta_max"])
                  for p in card["pair"])
    measured = card["measurement"]
    return Law(float(measured["shell_radius"]), float(measured["youngs_modulus"]), pairs, card)

#!/usr/bin/env python3
"""Whether two runs of a scene hold the same bits, wherever a change of the code should have moved arithmetic only.

  same_bits.py RUN RUN    compares every number of every HDF5 file of two run directories; status 1 when one differs

Provenance, times and the seals that cover them (table_id, belongs_to) are left out. Needs h5py (Debian: python3-h5py).
"""
import sys
from pathlib import Path

import h5py
import numpy as np

LEFT_OUT = ("provenance", "seconds", "table_id", "belongs_to")


def same(u, v):
    u, v = np.asarray(u), np.asarray(v)
    return np.array_equal(u, v, equal_nan=u.dtype.kind == "f" and v.dtype.kind == "f")


def objects(file):
    names = {"/"}
    file.visit(names.add)
    return {n for n in names if not any(word in n for word in LEFT_OUT)}


def differences(first, second):
    """What differs, and how many numbers and texts were compared."""
    found, compared = [], 0
    with h5py.File(first) as a, h5py.File(second) as b:
        names = objects(a) & objects(b)
        found += [f"{n}: in one of them only" for n in sorted(objects(a) ^ objects(b))]
        for n in sorted(names):
            attributes = {k for k in (set(a[n].attrs) | set(b[n].attrs)) if not any(word in k for word in LEFT_OUT)}
            for k in sorted(attributes):
                compared += 1
                if k not in a[n].attrs or k not in b[n].attrs or not same(a[n].attrs[k], b[n].attrs[k]):
                    found.append(f"{n} {k}")
            if isinstance(a[n], h5py.Dataset) and isinstance(b[n], h5py.Dataset):
                compared += a[n].size
                if not same(a[n][()], b[n][()]):
                    found.append(n)
    return found, compared


def main():
    first, second = Path(sys.argv[1]), Path(sys.argv[2])
    names = sorted(p.name for p in first.glob("*.h5"))
    if not names:
        sys.exit(f"{first}: no HDF5 file")
    total, bad = 0, 0
    for name in names:
        if not (second / name).exists():
            print(f"{name}: not in {second}")
            bad += 1
            continue
        found, compared = differences(first / name, second / name)
        print(f"{name}: {compared} compared, {len(found)} differ{': ' + ', '.join(found[:5]) if found else ''}")
        total, bad = total + compared, bad + len(found)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())

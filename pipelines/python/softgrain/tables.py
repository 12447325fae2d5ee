"""Tables: columns of equal length with their units, as numpy arrays, and as pandas DataFrames where pandas is installed."""
import csv
import html
import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np


def counted(count, one, many=""):
    """A number and what it counts: "1 point", "3 points"."""
    return f"{count} {one if count == 1 else many or one + 's'}"


class Tabular:
    """Mixin of what has a table()."""

    def dataframe(self):
        """table() as a pandas DataFrame; its attrs["units"] has the units. ImportError where pandas is not installed."""
        return self.table().dataframe()


class Table(Mapping, Tabular):
    """Columns by name: table["stress_axial"] is a numpy array. units: of the columns, "1" without dimension and "" where none is
    known or the column holds words. len(table) is the number of columns, table.rows that of rows."""

    def __init__(self, name, columns, units=None):
        self.name = name
        self.columns = {k: np.asarray(v) for k, v in columns.items()}
        lengths = {len(v) for v in self.columns.values()}
        if len(lengths) > 1:
            raise ValueError(f"{name}: columns of different lengths: {sorted(lengths)}")
        self.rows = lengths.pop() if lengths else 0
        self.units = {k: (units or {}).get(k, "") for k in self.columns}

    def table(self):
        """Itself, as everything that has a table."""
        return self

    def dataframe(self):
        """The table as a pandas DataFrame; its attrs["units"] has the units. ImportError where pandas is not installed."""
        try:
            import pandas
        except ImportError as e:
            raise ImportError("a DataFrame needs pandas (Debian: python3-pandas; else pip install pandas); without it "
                              "table() gives numpy arrays") from e
        frame = pandas.DataFrame(dict(self.columns))
        frame.attrs["units"] = dict(self.units)
        return frame

    def __getitem__(self, name):
        return self.columns[name]

    def __iter__(self):
        return iter(self.columns)

    def __len__(self):
        return len(self.columns)

    def heading(self, name):
        """The name of a column with its unit: "stress_axial [Pa]"."""
        unit = self.units[name]
        return f"{name} [{unit}]" if unit not in ("", "1") else name

    def __repr__(self):
        names = [self.heading(name) for name in self.columns]
        more = f", and {len(names) - 6} more" if len(names) > 7 else ""
        return f"<table {self.name}: {self.rows} rows of {', '.join(names[:6] if more else names)}{more}>"

    def _repr_html_(self):
        shown = min(self.rows, 20)
        head = "".join(f"<th>{html.escape(self.heading(name))}</th>" for name in self.columns)
        body = "".join("<tr>" + "".join(f"<td>{html.escape(_cell(column[k]))}</td>" for column in self.columns.values()) + "</tr>"
                       for k in range(shown))
        more = f"<p>{self.rows - shown} rows more</p>" if shown < self.rows else ""
        return f"<table><tr>{head}</tr>{body}</table>{more}"


def _cell(value):
    return f"{value:.6g}" if isinstance(value, (float, np.floating)) else str(value)


def records(name, rows, units=None, columns=()):
    """A table of dicts, one a row. What a row does not have, or has as None, is NaN in a column of numbers and "" in one of words.
    columns: those that are there without rows too."""
    keys = list(dict.fromkeys([*columns, *(key for row in rows for key in row)]))
    filled = {}
    for key in keys:
        values = [row.get(key) for row in rows]
        words = any(isinstance(v, str) for v in values)
        whole = all(isinstance(v, (int, np.integer)) for v in values)
        filled[key] = values if whole else [("" if words else np.nan) if v is None else (str(v) if words else v) for v in values]
    return Table(name, filled, units)


def joined(name, tables, labels):
    """Tables one below the other. labels: a dict for each table, of the columns that say which one a row comes from. A column that
    only some of them have is NaN in the rows of the others."""
    names = list(dict.fromkeys(key for one in tables for key in one))
    columns = {key: np.concatenate([np.repeat(label[key], one.rows) for one, label in zip(tables, labels)])
               for key in (labels[0] if labels else ())}
    columns.update({key: np.concatenate([one[key] if key in one else np.full(one.rows, np.nan) for one in tables]) for key in names})
    units = {key: unit for one in tables for key, unit in one.units.items()}
    return Table(name, columns, units)


_HEADING = re.compile(r"^(?P<name>.*?) \[(?P<unit>[^\[\]]+)\]$")


def read_csv(path):
    """A CSV file of a report (curves/*.csv) or a sweep (table.csv) as a Table: headings "normal force Fn [N]" give name and unit, empty
    cells are NaN among numbers."""
    path = Path(path)
    with open(path, newline="", encoding="utf-8-sig") as file:
        head, *rows = [row for row in csv.reader(file) if row]
    columns, units = {}, {}
    for k, heading in enumerate(head):
        found = _HEADING.match(heading)
        name = found["name"] if found else heading
        if name in columns:
            name = heading if heading not in columns else f"{heading} ({k + 1})"
        columns[name] = _column([row[k] if k < len(row) else "" for row in rows])
        units[name] = found["unit"] if found else ""
    return Table(path.stem, columns, units)


def _column(texts):
    try:
        return np.array([float(t) if t else np.nan for t in texts])
    except ValueError:
        return np.array(texts, dtype=str)

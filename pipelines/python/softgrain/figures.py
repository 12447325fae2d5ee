"""What notebooks show of our objects. matplotlib is loaded when a figure is asked for."""
import base64
import io
from pathlib import Path


def new_figure(columns=1, width=5.5, height=4.0):
    """A figure and its axes, outside pyplot: a notebook shows it once and nothing keeps it."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    figure = Figure(figsize=(width * columns, height), layout="tight")
    FigureCanvasAgg(figure)
    axes = figure.subplots(1, columns, squeeze=False)[0]
    for one in axes:
        one.spines[["top", "right"]].set_visible(False)
        one.grid(alpha=0.25, linewidth=0.6)
    return figure, (axes[0] if columns == 1 else axes)


def png(figure):
    """The figure as the bytes of a PNG."""
    out = io.BytesIO()
    figure.savefig(out, format="png", dpi=110)
    return out.getvalue()


class Picture:
    """A figure of a report, an SVG file. Notebooks show it; path says where it is."""

    def __init__(self, path):
        self.path = Path(path)

    def _repr_svg_(self):
        return self.path.read_text(encoding="utf-8")

    def save(self, path):
        """Copies the file."""
        Path(path).write_bytes(self.path.read_bytes())

    def __repr__(self):
        return f"<picture {self.path}>"


class Drawn:
    """Mixin of what has a figure(): a notebook shows it, where matplotlib is installed."""

    def _repr_png_(self):
        try:
            figure = self.figure()
        except ImportError:
            return None
        return None if figure is None else png(figure)

    def _image(self):
        """The same as an HTML image, for notebooks that show a text beside it; empty where there is none."""
        data = self._repr_png_()
        return "" if data is None else f'<img src="data:image/png;base64,{base64.b64encode(data).decode()}">'

"""h5py, when a file is read: laws and runs need none."""


def open_file(path):
    """The file, to be read. ImportError that says what is missing."""
    try:
        import h5py
    except ImportError as e:
        raise ImportError("reading .h5 files needs h5py (Debian: python3-h5py; else pip install h5py)") from e
    return h5py.File(path, "r")


def is_group(item):
    """A group, not a data set."""
    return hasattr(item, "keys")


def text_attribute(item, name):
    """A text attribute as str."""
    value = item.attrs[name]
    return value.decode() if isinstance(value, bytes) else str(value)

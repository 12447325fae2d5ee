"""Reads files with ParaView's own readers and prints what they hold as JSON, one entry per file and time.

    pvpython read_with_paraview.py FILE...

Of every time: points, cells, and of every array its number of values, sum, smallest and largest.
"""
import json
import sys

from paraview.simple import Delete, OpenDataFile, XDMFReader
from paraview import servermanager
from vtkmodules.numpy_interface import dataset_adapter


def leaves(data):
    """The data sets of a multi-block collection, or the one that is there."""
    if data is None:
        return []
    if data.IsA("vtkCompositeDataSet"):
        found = []
        iterator = data.NewIterator()
        iterator.InitTraversal()
        while not iterator.IsDoneWithTraversal():
            found.append(iterator.GetCurrentDataObject())
            iterator.GoToNextItem()
        return found
    return [data]


def arrays(attributes):
    out = {}
    for name in attributes.keys():
        values = attributes[name]
        if values is None or not hasattr(values, "size") or values.size == 0:
            continue
        out[name] = {"values": int(values.size), "sum": float(values.sum()), "low": float(values.min()),
                     "high": float(values.max())}
    return out


def moments(reader):
    times = getattr(reader, "TimestepValues", None)
    if times is None:
        return [0.0]
    times = list(times) if hasattr(times, "__len__") else [times]
    return times or [0.0]


def content(path):
    # Of the three XDMF readers the plain one knows parts of data sets (hyperslabs).
    reader = XDMFReader(FileNames=[path]) if path.endswith(".xdmf") else OpenDataFile(path)
    if reader is None:
        return {"error": "no reader"}
    out = []
    for time in moments(reader):
        reader.UpdatePipeline(time)
        try:
            fetched = servermanager.Fetch(reader)
        except AttributeError as error:
            out.append({"time": float(time), "error": str(error)})
            continue
        for leaf in leaves(fetched):
            wrapped = dataset_adapter.WrapDataObject(leaf)
            points = wrapped.Points
            extent = [0.0, 0.0]
            longest = 0.0
            if points is not None and len(points):
                extent = [float(points.min()), float(points.max())]
            for k in range(leaf.GetNumberOfCells()):
                cell = leaf.GetCell(k)
                if cell.GetNumberOfPoints() == 2:
                    longest = max(longest, cell.GetLength2() ** 0.5)
            out.append({"time": float(time), "points": leaf.GetNumberOfPoints(), "cells": leaf.GetNumberOfCells(),
                        "extent": extent, "longest_line": longest, "point_data": arrays(wrapped.PointData),
                        "cell_data": arrays(wrapped.CellData)})
    Delete(reader)
    return out


if __name__ == "__main__":
    print("RESULT " + json.dumps({path: content(path) for path in sys.argv[1:]}))

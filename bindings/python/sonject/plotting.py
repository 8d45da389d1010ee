"""Pictures by matplotlib, which is imported for the first of them."""

from __future__ import annotations

import importlib
from typing import Any, Mapping, Optional

import numpy

from ._picture import decibels as levels_of
from ._picture import grey_ends
from ._values import real_number
from .keys import Quantity
from .result import Result


def _pyplot() -> Any:
    return importlib.import_module("matplotlib.pyplot")


def _extent(shape: tuple[int, int], geometry: Mapping[str, Any]) -> tuple[float, float, float, float]:
    """Returns outer edges of the pixels, m: first and last slant range, last and first track place."""
    rows, columns = shape
    given = {"first_along_track": 0.0, **geometry}
    wide, high, left, top = (
        real_number(f"{name}_m", given[name])
        for name in ("column_spacing", "row_spacing", "first_slant_range", "first_along_track")
    )
    left, top = left - 0.5 * wide, top - 0.5 * high
    return left, left + columns * wide, top + rows * high, top


def draw(
    image: Any,
    *,
    geometry: Optional[Mapping[str, Any]] = None,
    decibels: Optional[tuple[Quantity, Quantity]] = None,
    axes: Any = None,
) -> Any:
    """Draws an image's magnitudes in dB; returns matplotlib's AxesImage.

    image: rows (track positions) x columns (slant ranges), amplitudes or complex pixels. geometry:
    labels the axes, as input.geometry of scenes; None: pixels. decibels: ends of the grey scale;
    None: percentiles 3 and 99.8, as sonject quicklook. axes: matplotlib's; None: the current ones.
    """
    axes = _pyplot().gca() if axes is None else axes
    levels = levels_of(image)
    ends = grey_ends(levels) if decibels is None else decibels
    low, high = (real_number("decibels", end) for end in ends)
    extent = None if geometry is None else _extent(levels.shape, geometry)
    axes.set_xlabel("slant range in columns" if geometry is None else "slant range in m")
    axes.set_ylabel("track in rows" if geometry is None else "track in m")
    return axes.imshow(
        numpy.maximum(levels, low),
        cmap="gray",
        vmin=low,
        vmax=high,
        extent=extent,
        interpolation="nearest",
    )


def draw_result(
    patch: Any,
    result: Result,
    *,
    geometry: Optional[Mapping[str, Any]] = None,
    decibels: Optional[tuple[Quantity, Quantity]] = None,
    figure: Any = None,
) -> Any:
    """Draws the patch before, with the objects, and with their labels; returns the figure.

    patch: the argument of inject. geometry, decibels: as in draw, the same for all three. figure:
    matplotlib's; None: a new one.
    """
    figure = _pyplot().figure(figsize=(12, 4), layout="constrained") if figure is None else figure
    panels = figure.subplots(1, 3, sharex=True, sharey=True)
    before = draw(result._linear(patch), geometry=geometry, decibels=decibels, axes=panels[0])
    scale = before.get_clim()
    for panel in panels[1:]:
        draw(result._linear(result.image), geometry=geometry, decibels=scale, axes=panel)
    labels = numpy.ma.masked_equal(result.labels, 0)
    panels[2].imshow(
        labels, cmap="tab10", vmin=0, vmax=9, alpha=0.6, extent=before.get_extent(),
        interpolation="nearest",
    )
    for panel, title in zip(panels, ("before", "after", "labels")):
        panel.set_title(title)
    return figure

"""The calls of the package: injection into arrays, and whole runs on files."""

from __future__ import annotations

import ctypes
import itertools
import json
from typing import Any, Iterable, Mapping, Optional, Tuple, Union

import numpy

from . import _interface as s
from ._classes import ElementLayout
from ._library import load
from ._values import (
    Overrides,
    PathLike,
    choice,
    file_name,
    filled,
    given,
    initialised,
    keys_text,
    library_pixels,
    optional_file_name,
    override_texts,
    real_number,
    shard_values,
    whole_number,
)
from .context import Context, Progress, ProgressBridge, default_context
from .enumerations import ConvertAxis, LabelFormat, RangeAxis, SeriesForm
from .keys import Quantity
from .result import Array, Box, ContactMeasures, Measurement, Result
from .scene import Scene
from .transfer import Transfer

AnyTransfer = Union[str, Mapping[str, Any]]


def inject(
    patch: Any,
    scene: Scene,
    progress: Optional[Progress] = None,
    *,
    transfer: Optional[AnyTransfer] = None,
) -> Result:
    """Puts the scene's objects into a patch, which is never changed.

    patch: array of rows (track positions) x columns (slant ranges), linear amplitudes or complex
    pixels. Its pixel (0, 0) lies where the scene's geometry begins; the scene's own patch is not
    used. float32 and complex64 arrays with contiguous columns are read in place. Other floating
    point arrays are converted to these; anything else is refused. None if the scene's input makes
    the patch, uniform or synthetic.

    transfer: for a patch of grey levels (uint8, uint16, float32) instead of amplitudes, as
    input.transfer of scenes: "{kind: decibel, parameter: 0.378}", or a dictionary. The image then
    has the patch's type, and untouched pixels keep their grey levels. Each bit is that of a run on
    a file of these pixels. A row of zeros alone is one where nothing was heard, and stays empty.

    progress: called with the finished fraction and the stage's name. A true answer cancels; an
    exception ends the call and is raised here. True shows a bar by tqdm if that is installed.

    Raises SonjectError, Cancelled, and TypeError or ValueError for arrays that are no patch.
    """
    curve = _curve(transfer)
    pixels, array = _optional_pixels(patch, curve)
    context = scene.context
    count = scene.object_count
    bridge = ProgressBridge(progress)
    pointer = context.make(
        s.sonject_result,
        "sonject_inject",
        context,
        scene,
        pixels,
        bridge.callback,
        None,
        bridge=bridge,
    )
    del array
    return Result(context, pointer, count, curve)


def _curve(transfer: Optional[AnyTransfer]) -> Optional[Transfer]:
    return None if transfer is None else Transfer(transfer)


def _optional_pixels(patch: Any, transfer: Optional[Transfer]) -> tuple[Any, Any]:
    """Returns the argument for a patch or None, and the array that it points into and needs."""
    if patch is None:
        return None, None
    pixels, array = library_pixels(patch, transfer)
    return ctypes.byref(pixels), array


def _context_of(scene: Optional[Scene], context: Optional[Context]) -> Context:
    if scene is not None:
        return scene.context
    return default_context() if context is None else context


def _label_sum(labels: Iterable[Union[str, LabelFormat]]) -> int:
    if isinstance(labels, str):
        raise TypeError("labels must be a sequence of formats, such as ['yolo', 'voc']")
    return sum({choice("labels", LabelFormat, label) for label in labels})


def run(
    scene: Scene,
    folder: PathLike,
    progress: Optional[Progress] = None,
    labels: Iterable[Union[str, LabelFormat]] = (),
    shard: Optional[Tuple[int, int]] = None,
    exit_after_s: Quantity = 0.0,
    checkpoint_s: Quantity = 0.0,
    overwrites: bool = False,
) -> bool:
    """Reads the scene's input, injects, and writes the result files into folder.

    labels: formats ("yolo", "voc") of label files beside coco.json. shard: (i, K), i from 1, traces
    one of K parts of all rays into folder/work and leaves no result; merge makes the result of all
    K. exit_after_s: time after which the call stops by itself, as if cancelled; the same call then
    continues. checkpoint_s: longest time between checkpoints, 60 s by default.

    Returns False, with nothing done, if folder already held the finished result of the same inputs,
    every file as it was written. A result of other inputs is refused unless overwrites is true.
    """
    context = scene.context
    params = filled(
        s.sonject_run_params,
        folder=file_name("folder", folder),
        labels=_label_sum(labels),
        exit_after_s=exit_after_s,
        checkpoint_s=checkpoint_s,
        overwrites=bool(overwrites),
        **({} if shard is None else shard_values(shard)),
    )
    return context.complete(
        "sonject_run", context, scene, ctypes.byref(params), progress=progress
    )


def merge(
    folder: PathLike,
    scene: Optional[Scene] = None,
    progress: Optional[Progress] = None,
    context: Optional[Context] = None,
    labels: Iterable[Union[str, LabelFormat]] = (),
) -> bool:
    """Makes the result of all shards in folder, as run would have without shards.

    scene: needed if the traced scene came from no scene file; else the shards know it. labels: as
    in run. Returns False, with nothing done, if folder already held the finished result.
    """
    context = _context_of(scene, context)
    params = filled(
        s.sonject_merge_params,
        folder=file_name("folder", folder),
        labels=_label_sum(labels),
    )
    return context.complete(
        "sonject_merge", context, scene, ctypes.byref(params), progress=progress
    )


def trace(scene: Scene, file: PathLike, progress: Optional[Progress] = None) -> None:
    """Traces the scene and writes its sums to a file, from which form makes images."""
    context = scene.context
    context.work("sonject_trace", context, scene, file_name("file", file), progress=progress)


def form(
    file: PathLike,
    folder: PathLike,
    overrides: Overrides = (),
    scene: Optional[Scene] = None,
    progress: Optional[Progress] = None,
    context: Optional[Context] = None,
    *,
    labels: Iterable[Union[str, LabelFormat]] = (),
    overwrites: bool = False,
) -> bool:
    """Forms the image of a file that trace wrote, and writes into folder what run would.

    overrides: as in Scene.read, of bandwidth, pulse, resolution, response, measured_response and
    motion of the sonar, and of input.path. scene: instead of overrides, and needed if the traced
    scene came from no scene file. labels, overwrites: as in run. Returns False, with nothing done,
    if folder already held the finished result of the same inputs.
    """
    context = _context_of(scene, context)
    texts = override_texts(overrides)
    params = filled(
        s.sonject_form_params,
        file=file_name("file", file),
        folder=file_name("folder", folder),
        overrides=ctypes.cast(texts, ctypes.POINTER(ctypes.c_char_p)),
        override_count=len(texts),
        labels=_label_sum(labels),
        overwrites=bool(overwrites),
    )
    return context.complete(
        "sonject_form", context, scene, ctypes.byref(params), progress=progress
    )


def check(scene: Scene) -> str:
    """Checks the scene against its input image; describes the geometry as a text with a drawing."""
    return scene.context.text("sonject_check", scene.context, scene)


def quicklook(
    image: PathLike,
    picture: PathLike,
    *,
    decibels: Optional[tuple[Quantity, Quantity]] = None,
    range_axis: RangeAxis = RangeAxis.SLANT,
    altitude_m: Optional[Quantity] = None,
    geometry: Optional[Mapping[str, Any]] = None,
    transfer: Optional[AnyTransfer] = None,
    channel: Union[str, int, None] = None,
    array: Optional[str] = None,
    context: Optional[Context] = None,
) -> None:
    """Draws an image file as a PNG.

    channel: "port", "starboard" or its number in an XTF or JSF file, None for the only one. array:
    its name in an HDF5 or MATLAB file. decibels: ends of the grey scale; None: chosen from the
    image. altitude_m, geometry: None for the image's metadata. transfer: None for plain amplitudes.
    geometry and transfer have the keys of input.geometry and input.transfer of scenes.
    """
    context = default_context() if context is None else context
    minimum = maximum = None
    if decibels is not None:
        minimum, maximum = (real_number("decibels", end) for end in decibels)
        if not minimum < maximum:
            raise ValueError(f"decibels must be (minimum, maximum), not {decibels!r}")
    params = filled(
        s.sonject_quicklook_params,
        image=file_name("image", image),
        picture=file_name("picture", picture),
        range_axis=choice("range_axis", RangeAxis, range_axis),
        **_image_keys(channel=channel, array=array, geometry=geometry, transfer=transfer),
        **given(minimum_db=minimum, maximum_db=maximum, altitude_m=altitude_m),
    )
    context.call("sonject_quicklook", context, ctypes.byref(params))


def convert(
    source: PathLike,
    output: PathLike,
    *,
    into: Optional[PathLike] = None,
    channel: Union[str, int, None] = None,
    array: Optional[str] = None,
    range_axis: ConvertAxis = ConvertAxis.KEPT,
    geometry: Optional[Mapping[str, Any]] = None,
    altitude_m: Optional[Quantity] = None,
    grey: Optional[Tuple[Quantity, Quantity]] = None,
    context: Optional[Context] = None,
) -> None:
    """Converts a file of one format to another (.tif, .png, .npy, .h5).

    into: a file, of which the output becomes a copy with the source's samples. geometry,
    altitude_m: None for the source's metadata. grey: black and white of 8 bit grey levels, dB over
    full scale; None: the numbers stay as they are.
    """
    context = default_context() if context is None else context
    black, white = (None, None) if grey is None else grey
    params = filled(
        s.sonject_convert_params,
        input=file_name("source", source),
        output=file_name("output", output),
        into=optional_file_name("into", into),
        **_image_keys(channel=channel, array=array, geometry=geometry),
        range_axis=choice("range_axis", ConvertAxis, range_axis),
        **given(altitude_m=altitude_m, black_db=black, white_db=white),
    )
    context.call("sonject_convert", context, ctypes.byref(params))


def _image_keys(**values: Any) -> dict[str, Optional[bytes]]:
    """Returns the keys for an image file as texts."""
    return {name: keys_text(name, value) for name, value in values.items()}


def measure(
    image: Any,
    labels: Optional[Any] = None,
    context: Optional[Context] = None,
    *,
    transfer: Optional[AnyTransfer] = None,
) -> Measurement:
    """Measures the seabed of an image; image and transfer are as in inject.

    labels: array of the image's shape, not 0 where there is no seabed, such as Result.labels.
    """
    context = default_context() if context is None else context
    pixels, array = library_pixels(image, _curve(transfer))
    mask = None
    if labels is not None:
        mask = numpy.ascontiguousarray(numpy.asarray(labels) != 0, dtype=numpy.uint8)
        if mask.shape != array.shape:
            raise ValueError(f"labels must have the image's shape {array.shape}, not {mask.shape}")
    params = filled(
        s.sonject_measure_params,
        pixels=ctypes.pointer(pixels),
        labels_mask=None if mask is None else mask.ctypes.data_as(ctypes.POINTER(ctypes.c_uint8)),
    )
    measurement = initialised(s.sonject_measurement)
    context.call("sonject_measure", context, ctypes.byref(params), ctypes.byref(measurement))
    del array, mask
    return Measurement.from_structure(measurement)


def calibrate(
    swath: Any,
    *,
    channel: Union[str, int, None] = None,
    array: Optional[str] = None,
    geometry: Optional[Mapping[str, Any]] = None,
    output: Optional[PathLike] = None,
    picture: Optional[PathLike] = None,
    context: Optional[Context] = None,
) -> dict[str, Any]:
    """Estimates a swath's transfer function, ceiling, looks, response, noise floor, water column.

    Returns them as keys of scenes. Under "measured" each has its standard error, or "not_seen" with
    the reason.

    swath: an image file, or an array of stored numbers with any transfer function. geometry: keys
    of input.geometry of scenes; None for the file's metadata. output: a file for the answer as
    JSON, for input.calibration of scenes. picture: a PNG that shows the evidence.
    """
    context = default_context() if context is None else context
    is_file = isinstance(swath, (str, bytes)) or hasattr(swath, "__fspath__")
    if not is_file:
        swath = numpy.asarray(swath)
        if swath.dtype.kind in "iu":
            swath = swath.astype(numpy.float32)
    pixels, kept = (None, None) if is_file else library_pixels(swath)
    params = filled(
        s.sonject_calibrate_params,
        image=file_name("swath", swath) if is_file else None,
        pixels=None if pixels is None else ctypes.pointer(pixels),
        as_json=True,
        output=optional_file_name("output", output),
        picture=optional_file_name("picture", picture),
        **_image_keys(channel=channel, array=array, geometry=geometry),
    )
    text = context.text("sonject_calibrate", context, ctypes.byref(params))
    del kept
    found: dict[str, Any] = json.loads(text)
    return found


def measure_contact(
    image: Any,
    box: Optional[Box] = None,
    *,
    row_spacing_m: Quantity = 0.0,
    column_spacing_m: Quantity = 0.0,
    transfer: Optional[AnyTransfer] = None,
    context: Optional[Context] = None,
) -> ContactMeasures:
    """Measures extent and brightness of a contact's highlight and shadow.

    image, transfer: as in inject. box: around both, with some seabed; None: the brightest highlight
    of the image. Spacings: 0 if unknown; lengths are then known in pixels alone.
    """
    context = default_context() if context is None else context
    pixels, array = library_pixels(image, _curve(transfer))
    place = None if box is None else s.sonject_box(*(
        whole_number(name, getattr(box, name), 2**31)
        for name in ("first_row", "first_column", "rows", "columns")))
    measures = initialised(s.sonject_contact_measures)
    context.call(
        "sonject_measure_contact",
        context,
        ctypes.byref(pixels),
        None if place is None else ctypes.byref(place),
        real_number("row_spacing_m", row_spacing_m),
        real_number("column_spacing_m", column_spacing_m),
        ctypes.byref(measures),
    )
    del array
    return ContactMeasures.from_structure(measures)


def _find_layout(scene: Scene, rows: int, columns: int) -> ElementLayout:
    layout = initialised(s.sonject_element_layout)
    scene.context.call(
        "sonject_elements_describe", scene.context, scene, rows, columns, ctypes.byref(layout)
    )
    return ElementLayout.from_structure(layout)


def element_layout(scene: Scene, shape: tuple[int, int] = (0, 0)) -> ElementLayout:
    """Describes the series that element_series gives for a patch of this shape, rows x columns.

    (0, 0): for the patch that the scene's input makes, uniform or synthetic.
    """
    largest = 2**31
    rows, columns = (whole_number("shape", size, largest) for size in shape)
    return _find_layout(scene, rows, columns)


def element_series(
    patch: Any,
    scene: Scene,
    progress: Optional[Progress] = None,
    *,
    transfer: Optional[AnyTransfer] = None,
) -> Array:
    """Computes each hydrophone's time series: pings x hydrophones x samples.

    Series are complex64, or float32 in pass band; relative to the source's pressure at 1 m, or in
    Pa if the array has a source_level_db. They contain what inject draws: targets and, in
    resynthesise mode, the seabed. In composite mode the seabed is the measured patch, which has no
    element data. patch, progress, transfer, and exceptions: as in inject.
    """
    pixels, array = _optional_pixels(patch, _curve(transfer))
    layout = _find_layout(scene, *((0, 0) if array is None else array.shape))
    is_complex = layout.elements.form == SeriesForm.BASEBAND
    series = numpy.empty(layout.shape, numpy.complex64 if is_complex else numpy.float32)
    scene.context.work(
        "sonject_element_series",
        scene.context,
        scene,
        pixels,
        progress=progress,
        outputs=[series.ctypes.data_as(ctypes.POINTER(ctypes.c_float)), series.nbytes],
    )
    return series


def run_elements(
    scene: Scene,
    folder: PathLike,
    progress: Optional[Progress] = None,
    *,
    overwrites: bool = False,
) -> None:
    """Writes the series of the scene's input into folder: series.npy and elements.json.

    Series of other inputs in folder are refused unless overwrites is true.
    """
    params = filled(
        s.sonject_run_params, folder=file_name("folder", folder), overwrites=bool(overwrites)
    )
    scene.context.work(
        "sonject_elements_run", scene.context, scene, ctypes.byref(params), progress=progress
    )


def absorption(
    frequency_hz: Quantity,
    temperature_celsius: Quantity,
    salinity_permille: float = 35.0,
    depth_m: Quantity = 0.0,
    ph: float = 8.0,
) -> float:
    """Returns the absorption of sea water in dB/m after Francois and Garrison (1982).

    200 Hz...1 MHz, -2...30 degrees Celsius, 0...40 per mille, 0...5000 m below the sea surface, pH
    7...9; NaN outside these ranges.
    """
    given_in_order = {
        "frequency_hz": frequency_hz, "temperature_celsius": temperature_celsius,
        "salinity_permille": salinity_permille, "depth_m": depth_m, "ph": ph,
    }
    return float(load().sonject_absorption(*itertools.starmap(real_number, given_in_order.items())))

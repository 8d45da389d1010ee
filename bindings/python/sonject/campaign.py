"""Campaigns: many injections drawn from distributions, as a data set or one by one in memory."""

from __future__ import annotations

import ctypes
import operator
import os
from typing import Any, Iterator, Optional, Sequence, Tuple, Union

from . import _interface as s
from ._classes import CampaignImage as CampaignImage
from ._values import (
    Overrides, PathLike, absolute_file_name, choice, file_name, filled, given, initialised,
    override_texts, shard_values,
)
from .context import Context, Handle, Progress, ProgressBridge, counted, default_context
from .enumerations import LabelPart
from .keys import Quantity
from .result import Result
from .scene import Scene


class Campaign(Handle):
    """A campaign file, read and checked; len() is the number of its images.

    As a sequence it makes images in memory, without files. campaign[17] is the Result of image 17,
    the same however often and in whatever order it is asked for. ``for result in campaign``, or a
    loader with workers of its own, can train on it. Workers are threads or processes. Spawned
    processes get the campaign pickled and read the file again. Forked ones inject on the device
    native alone.

    The image of a result is linear, whatever its swath's type: float32 amplitudes, or complex64 for
    a complex swath. Amplitudes are rounded and limited like the numbers that run() writes; the
    swath's Transfer converts between both. Full scale is 1, or the value that a curve of kind
    decibel sets. A JPEG loses more.

    calibration: auto is for run(), which keeps the file in its folder; name that file for images in
    memory.

    overrides: as in Scene.read, but of the campaign's keys: ``{"images": 100}``.
    """

    _noun = "campaign"

    def __init__(
        self,
        path: PathLike,
        overrides: Overrides = (),
        context: Optional[Context] = None,
    ) -> None:
        context = default_context() if context is None else context
        texts = override_texts(overrides)
        params = filled(s.sonject_scene_read_params, override_count=len(texts),
                        overrides=ctypes.cast(texts, ctypes.POINTER(ctypes.c_char_p)))
        pointer = context.make(
            s.sonject_campaign,
            "sonject_campaign_read",
            context,
            absolute_file_name("path", path),
            ctypes.byref(params),
        )
        super().__init__(context, pointer)
        self._source = (
            os.path.abspath(os.fsdecode(path)),
            [os.fsdecode(text) for text in texts],
        )

    def __reduce__(self) -> Any:
        return Campaign, self._source

    def _summary(self) -> str:
        return f"of {counted(len(self), 'image')}"

    def __len__(self) -> int:
        count = ctypes.c_uint64()
        self._context.call("sonject_campaign_image_count", self, ctypes.byref(count))
        return count.value

    def _id(self, number: int) -> int:
        count = len(self)
        index = operator.index(number)
        if not -count <= index < count:
            raise IndexError(f"there is no image {index}: the campaign has {count}")
        return index % count

    def describe(self, number: int) -> CampaignImage:
        """Returns the values drawn for an image."""
        told = initialised(s.sonject_campaign_image)
        self._context.call(
            "sonject_campaign_describe", self, self._id(number), ctypes.byref(told)
        )
        return CampaignImage.from_structure(told)

    def scene(self, number: int) -> Scene:
        """Returns the scene of an image: its input is the swath's file, its patch the image."""
        pointer = self._context.make(
            s.sonject_scene, "sonject_campaign_scene", self._context, self, self._id(number)
        )
        return Scene._adopt(self._context, pointer)

    def inject(self, number: int, progress: Optional[Progress] = None) -> Result:
        """Makes an image in memory; its truth counts the image's own pixels."""
        bridge = ProgressBridge(progress)
        image = self.describe(number)
        pointer = self._context.make(
            s.sonject_result,
            "sonject_campaign_inject",
            self._context,
            self,
            image.id,
            bridge.callback,
            None,
            bridge=bridge,
        )
        return Result(self._context, pointer, image.object_count)

    def __getitem__(self, number: int) -> Result:
        return self.inject(number)

    def __iter__(self) -> Iterator[Result]:
        return (self.inject(number) for number in range(len(self)))

    def run(
        self,
        folder: PathLike,
        progress: Optional[Progress] = None,
        *,
        shard: Tuple[int, int] = (1, 1),
        only: Optional[int] = None,
        exit_after_s: Quantity = 0.0,
        overwrites: bool = False,
    ) -> bool:
        """Makes the images that the folder lacks, and the data set's documents once all are there.

        shard: (i, k) makes ids with id % k == i - 1, for merge. only: makes this image alone, again
        if it exists. exit_after_s: time after which the call stops by itself, as if cancelled; the
        same call then continues. overwrites: removes another campaign's images in folder; else they
        are refused. Returns False if nothing was left to do.
        """
        params = filled(
            s.sonject_campaign_run_params,
            folder=file_name("folder", folder),
            only_one=only is not None,
            exit_after_s=exit_after_s,
            overwrites=bool(overwrites),
            **shard_values(shard),
            **given(only=None if only is None else self._id(only)),
        )
        return self._context.complete(
            "sonject_campaign_run", self._context, self, ctypes.byref(params), progress=progress
        )


def merge_campaign(
    folder: PathLike, progress: Optional[Progress] = None, context: Optional[Context] = None
) -> None:
    """Checks that all images of a folder's campaign are there and writes the data set's documents.

    Raises SonjectError, which names what is missing.
    """
    context = default_context() if context is None else context
    context.work("sonject_campaign_merge", context, file_name("folder", folder), progress=progress)


def fit_campaign(
    path: PathLike,
    contacts: PathLike,
    fitted: PathLike,
    overrides: Overrides = (),
    *,
    boxes: Union[str, LabelPart] = "both",
    classes: Union[str, Sequence[str]] = (),
    progress: Optional[Progress] = None,
    context: Optional[Context] = None,
) -> None:
    """Writes a campaign file like the one at path whose targets measure as real contacts do.

    contacts: as for sonject fit: a COCO file, a .csv file, a folder of YOLO's or VOC's labels, or a
    .yaml file of quantiles. fitted: the file to write, in path's folder; a page comes beside it.
    boxes: the part of contacts that boxes enclose, unless their class tells it: both, highlight or
    shadow. classes: names of the classes to use; none: all.
    """
    context = default_context() if context is None else context
    texts = override_texts(overrides)
    params = filled(s.sonject_scene_read_params, override_count=len(texts),
                    overrides=ctypes.cast(texts, ctypes.POINTER(ctypes.c_char_p)))
    wanted = [file_name("class", each) for each in ([classes] if isinstance(classes, str) else classes)]
    names = (ctypes.c_char_p * len(wanted))(*wanted)
    fit_params = filled(s.sonject_campaign_fit_params, part=choice("boxes", LabelPart, boxes),
                        contacts=file_name("contacts", contacts),
                        classes=ctypes.cast(names, ctypes.POINTER(ctypes.c_char_p)),
                        class_count=len(names),
                        fitted=file_name("fitted", fitted))
    context.work("sonject_campaign_fit", context, file_name("path", path), ctypes.byref(params),
                 ctypes.byref(fit_params), progress=progress)

"""Scenes: sonar, water, seabed and objects."""

from __future__ import annotations

import ctypes
from typing import Any, Iterable, Mapping, Optional, Sequence, Type, Union

import numpy

from . import _interface as s
from ._values import (
    Overrides,
    PathLike,
    file_name,
    filled,
    initialised,
    override_texts,
    plain_text,
    real_numbers,
    whole_number,
)
from .context import Context, Handle, default_context
from .enumerations import PulseAxis
from .objects import Object, Parts, Target
from .parameters import (
    Elements,
    Geometry,
    Injection,
    Medium,
    Motion,
    Patch,
    Pulse,
    Recording,
    Seabed,
    Surface,
    Sonar,
    Synthetic,
    Transfer,
    Uniform,
)

Input = Union[PathLike, Recording, Uniform, Synthetic]


class Scene(Handle):
    """What the sonar sees. Each setting is checked, and copied, when it is made.

    sonar, pulse, motion, medium, seabed, surface, geometry, injection: None for the defaults (but
    geometry needs at least the first slant range before anything can be injected); objects: up to
    250; input: an image file, Uniform or Synthetic, None where inject is given an array; transfer,
    patch: of an image file; context: None for the thread's own one.
    """

    _noun = "scene"

    def __init__(
        self,
        *,
        sonar: Optional[Sonar] = None,
        pulse: Optional[Pulse] = None,
        motion: Optional[Motion] = None,
        medium: Optional[Medium] = None,
        seabed: Optional[Seabed] = None,
        surface: Optional[Surface] = None,
        geometry: Optional[Geometry] = None,
        injection: Optional[Injection] = None,
        objects: Iterable[Object] = (),
        input: Optional[Input] = None,
        transfer: Optional[Transfer] = None,
        patch: Optional[Patch] = None,
        context: Optional[Context] = None,
    ) -> None:
        context = default_context() if context is None else context
        super().__init__(context, context.make(s.sonject_scene, "sonject_scene_create", context))
        settings: list[tuple[str, Any, Type[Any]]] = [
            ("sonar", sonar, Sonar),
            ("pulse", pulse, Pulse),
            ("motion", motion, Motion),
            ("medium", medium, Medium),
            ("seabed", seabed, Seabed),
            ("surface", surface, Surface),
            ("geometry", geometry, Geometry),
            ("injection", injection, Injection),
            ("transfer", transfer, Transfer),
            ("patch", patch, Patch),
        ]
        for name, setting, kind in settings:
            if setting is not None:
                self._set(name, setting, kind)
        if input is not None:
            self.set_input(input)
        for each in objects:
            self.add(each)

    @classmethod
    def read(
        cls,
        path: PathLike,
        overrides: Overrides = (),
        context: Optional[Context] = None,
        *,
        allows_user_shapes: bool = False,
    ) -> "Scene":
        """Reads a scene file; of one with bands the override "band" chooses one of ``Scene.bands``.

        overrides: "key.path=value" texts, or a mapping of key paths to values, which replace or
        add keys: ``{"input.path": "swath.tif", "objects[0].heading": "30 deg"}``;
        allows_user_shapes: shapes may be code in the file or beside it, which then can do what the
        process can: only for files that you trust.
        """
        texts = override_texts(overrides)
        context = default_context() if context is None else context
        params = filled(s.sonject_scene_read_params, allows_user_shapes=bool(allows_user_shapes))
        pointer = context.make(
            s.sonject_scene,
            "sonject_scene_read_with",
            context,
            file_name("path", path),
            texts,
            len(texts),
            ctypes.byref(params),
        )
        return cls._adopt(context, pointer)

    @classmethod
    def _adopt(cls, context: Context, pointer: Any) -> "Scene":
        """The scene behind a handle that the library made."""
        scene = cls.__new__(cls)
        Handle.__init__(scene, context, pointer)
        return scene

    @staticmethod
    def bands(
        path: PathLike, overrides: Overrides = (), context: Optional[Context] = None
    ) -> list[str]:
        """Names of the bands that a scene file, with overrides as for ``read``, leaves to be chosen."""
        texts = override_texts(overrides)
        context = default_context() if context is None else context
        return context.text(
            "sonject_scene_bands", context, file_name("path", path), texts, len(texts)
        ).split()

    def _set(self, name: str, setting: Any, kind: Type[Any]) -> None:
        if not isinstance(setting, kind):
            raise TypeError(f"{name} must be a {kind.__name__}, not {setting!r}")
        structure = setting.to_structure()
        self._context.call("sonject_scene_set_" + name, self, ctypes.byref(structure))

    def set_sonar(self, sonar: Sonar) -> None:
        self._set("sonar", sonar, Sonar)

    def set_pulse(self, pulse: Pulse) -> None:
        self._set("pulse", pulse, Pulse)

    @staticmethod
    def _parts_of(samples: Any) -> dict[str, Any]:
        """Real and imaginary part of samples, the latter None where they are real."""
        given = numpy.asarray(samples)
        if given.dtype.kind != "c":
            return {"real part of samples": given, "imaginary part of samples": None}
        return {"real part of samples": given.real, "imaginary part of samples": given.imag}

    def set_pulse_table(
        self, samples: Any, *, ranges_m: Any = None, times_s: Any = None
    ) -> None:
        """Measured pulse: real or complex baseband samples of the compressed envelope.

        ranges_m: slant range beyond the target, or times_s: after its echo; at least four, rising
        through 0. The largest sample becomes 1; samples in between are cubic.
        """
        if (ranges_m is None) == (times_s is None):
            raise ValueError("give either ranges_m or times_s")
        axis = PulseAxis.RANGE if times_s is None else PulseAxis.TIME
        name, positions = ("ranges_m", ranges_m) if times_s is None else ("times_s", times_s)
        self._set_samples(
            "pulse_table", {name: positions, **self._parts_of(samples)}, int(axis)
        )

    def set_cross_range_table(self, distances_m: Any, samples: Any) -> None:
        """Measured cross-range response of a synthetic aperture, in place of the sonar's window.

        samples: real or complex, at distances_m of the pixel beyond the target, along the track;
        without any the window counts again.
        """
        self._set_samples(
            "cross_range_table", {"distances_m": distances_m, **self._parts_of(samples)}
        )

    def set_motion(self, motion: Motion) -> None:
        self._set("motion", motion, Motion)

    def set_motion_table(self, along_track_m: Any, sway_m: Any) -> None:
        """Measured residual sway along the track, positive towards the imaged side.

        Linear in between, constant beyond; added to that of set_motion; without any it is taken
        away.
        """
        self._set_samples("motion_table", {"along_track_m": along_track_m, "sway_m": sway_m})

    def set_yaw_table(self, along_track_m: Any, yaw_rad: Any) -> None:
        """Measured residual yaw in the same way, the bow towards the imaged side positive.

        It counts together with the yaw_advance_m of set_motion.
        """
        self._set_samples("yaw_table", {"along_track_m": along_track_m, "yaw_rad": yaw_rad})

    def set_medium(self, medium: Medium) -> None:
        self._set("medium", medium, Medium)

    def _set_samples(self, name: str, columns: Mapping[str, Any], *before: Any) -> None:
        """Calls a function of columns of doubles, None for NULL, and their common length.

        before: its arguments that come first.
        """
        arrays: dict[str, Any] = {
            key: None if values is None else real_numbers(key, values)
            for key, values in columns.items()
        }
        (first, leading), *others = arrays.items()
        for key, array in others:
            if array is not None and array.size != leading.size:
                raise ValueError(f"{key} has {array.size} values, {first} has {leading.size}")
        double = ctypes.POINTER(ctypes.c_double)
        pointers = [
            None if array is None else array.ctypes.data_as(double) for array in arrays.values()
        ]
        self._context.call("sonject_scene_set_" + name, self, *before, *pointers, leading.size)

    def set_water_layers(
        self, bottoms_m: Any, sound_speeds_mps: Any, densities: Any = None
    ) -> None:
        """Level layers of water, each of one sound speed, from the seabed upwards.

        bottoms_m: height of each layer's lower edge over the mean seabed, the first 0, rising;
        densities: in any one unit, None where they are equal. Lists or arrays; without any layer the
        water has the medium's sound speed again.
        """
        self._set_samples(
            "water_layers",
            {
                "bottoms_m": bottoms_m,
                "sound_speeds_mps": sound_speeds_mps,
                "densities": densities,
            },
        )

    def set_sound_speed_profile(self, heights_m: Any, sound_speeds_mps: Any) -> None:
        """Measured sound speeds at heights over the mean seabed, rising, which become layers.

        Linear in between, constant beyond. Lists or arrays of at least two values.
        """
        self._set_samples(
            "sound_speed_profile",
            {"heights_m": heights_m, "sound_speeds_mps": sound_speeds_mps},
        )

    def set_seabed(self, seabed: Seabed) -> None:
        self._set("seabed", seabed, Seabed)

    def set_relief(
        self,
        heights_m: Any,
        *,
        first_along_track_m: float = 0.0,
        first_ground_range_m: float = 0.0,
        row_spacing_m: float = 0.025,
        column_spacing_m: float = 0.025,
    ) -> None:
        """Heights of the seabed over its mean plane: rows along-track, columns in ground range.

        first_...: where row and column 0 lie; ground range is horizontal from the track. Bilinear
        in between, 0 outside; at the patch's edges relief falls to 0 over 1 m, or an eighth of the
        patch's side where that is less. Adds to the features of a scene file and takes the place of
        its heights; None takes heights away.
        """
        if heights_m is None:
            params = initialised(s.sonject_relief_params)
            self._context.call("sonject_scene_set_relief", self, ctypes.byref(params), None)
            return
        given = numpy.asarray(heights_m)
        if given.ndim != 2 or given.dtype.kind not in "fiu":
            raise ValueError(
                f"heights_m must have rows and columns of real numbers, not the shape "
                f"{given.shape} of {given.dtype}"
            )
        heights = numpy.ascontiguousarray(given, dtype=numpy.float32)
        if max(heights.shape) > 0xFFFFFFFF:
            raise ValueError(f"heights_m of the shape {heights.shape} is too large")
        if 0 in heights.shape:
            raise ValueError("heights_m is empty; None takes the relief away")
        params = filled(
            s.sonject_relief_params,
            rows=heights.shape[0],
            columns=heights.shape[1],
            first_along_track_m=first_along_track_m,
            first_ground_range_m=first_ground_range_m,
            row_spacing_m=row_spacing_m,
            column_spacing_m=column_spacing_m,
        )
        self._context.call(
            "sonject_scene_set_relief",
            self,
            ctypes.byref(params),
            heights.ctypes.data_as(ctypes.POINTER(ctypes.c_float)),
        )

    def set_surface(self, surface: Surface) -> None:
        self._set("surface", surface, Surface)

    def set_geometry(self, geometry: Geometry) -> None:
        self._set("geometry", geometry, Geometry)

    def set_injection(self, injection: Injection) -> None:
        self._set("injection", injection, Injection)

    def set_transfer(self, transfer: Transfer) -> None:
        self._set("transfer", transfer, Transfer)

    def set_elements(self, elements: Elements) -> None:
        """The array that element_series listens with."""
        self._set("elements", elements, Elements)

    def set_patch(self, patch: Patch) -> None:
        self._set("patch", patch, Patch)

    def set_input(self, source: Input) -> None:
        """Where the swath comes from: an image file, a Recording, Uniform or Synthetic."""
        if isinstance(source, Synthetic):
            self._set("input_synthetic", source, Synthetic)
        elif isinstance(source, Uniform):
            largest = 2**32 - 1
            rows = whole_number("rows", source.rows, largest)
            columns = whole_number("columns", source.columns, largest)
            self._context.call("sonject_scene_set_input_uniform", self, rows, columns)
        elif isinstance(source, Recording):
            number = source.number()
            path = file_name("input", source.path)
            self._context.call("sonject_scene_set_input_file", self, path)
            self._context.call("sonject_scene_set_input_channel", self, number)
            array = None if source.array is None else plain_text("array", source.array)
            self._context.call("sonject_scene_set_input_array", self, array)
        else:
            path = file_name("input", source)
            self._context.call("sonject_scene_set_input_file", self, path)

    def take_geometry(self) -> None:
        """Sets geometry and altitude from the input, a Recording, over the rows of the patch."""
        self._context.call("sonject_scene_take_geometry", self)

    def add_mesh(
        self,
        path: PathLike,
        *,
        unit_m: float = 1.0,
        axes: Sequence[int] = (1, 2, 3),
        allows_open: bool = False,
        smooth_angle_rad: float = 0.0,
    ) -> int:
        """Reads a mesh file (STL, OBJ, PLY) for ``Mesh`` objects; gives its number.

        unit_m: metres a unit of the file; axes: which axis of the file the object's nose, y and z
        axis is, 1, 2, 3, negative for the reverse of it; allows_open: a mesh that is not closed is
        taken as thin sheets; smooth_angle_rad: facets that meet at less stand for one smooth
        surface to what scatters on them.
        """
        params = filled(
            s.sonject_mesh_params,
            allows_open=int(allows_open),
            unit_m=unit_m,
            smooth_angle_rad=smooth_angle_rad,
        )
        params.axes[:] = [int(axis) for axis in axes]
        return self._number("add_mesh", file_name("mesh", path), ctypes.byref(params))

    def add_user_shape(
        self,
        code: str,
        *,
        bounding_radius_m: float,
        name: str = "code",
        half_length_m: float = 0.0,
        half_width_m: float = 0.0,
        half_height_m: float = 0.0,
        parameters: Sequence[float] = (),
        is_open: bool = False,
        first_line: int = 1,
    ) -> int:
        """Takes a shape in OpenCL C for ``UserShape`` objects; gives its number.

        code: functions shape_distance and shape_normal, see include/sonject/user_shape.h; it can do
        what the process can, and what does not end cannot be stopped. name, first_line: how messages
        name its lines; bounding_radius_m: of a sphere about the origin that holds the shape, as do
        the half sizes of a box (0: the radius), by which it rests on the seabed; parameters: up to
        16 numbers for the functions; is_open: a surface without inside, which reflects on both sides.
        """
        count = len(parameters)
        if count > s.USER_PARAMETERS_CAPACITY:
            raise ValueError(f"parameters must be at most {s.USER_PARAMETERS_CAPACITY}, not {count}")
        params = filled(
            s.sonject_user_shape_params,
            name=plain_text("name", name),
            code=plain_text("code", code),
            is_open=bool(is_open),
            bounding_radius_m=bounding_radius_m,
            half_length_m=half_length_m,
            half_width_m=half_width_m,
            half_height_m=half_height_m,
            first_line=first_line,
            parameter_count=count,
        )
        params.parameters[:count] = [float(value) for value in parameters]
        return self._number("add_user_shape", ctypes.byref(params))

    def add(self, thing: Object) -> int:
        """Adds an object; gives its number, counted from 0.

        Where the library refuses one of an object's parts, the object stays with those before it.
        """
        if not isinstance(thing, Object):
            raise TypeError(f"an Object is wanted, not {thing!r}")
        structure = ctypes.byref(thing.to_structure())
        if isinstance(thing, Target):
            consent = bool(thing.allows_user_shapes)
            params = filled(s.sonject_scene_read_params, allows_user_shapes=consent)
            path = file_name("path", thing.path)
            return self._number("add_target", path, ctypes.byref(params), structure)
        parts = [part.to_structures() for part in thing.parts] if isinstance(thing, Parts) else []
        index = self._number("add_object", structure)
        for part in parts:
            self._context.call("sonject_scene_add_part", self, index, *map(ctypes.byref, part))
        return index

    def _number(self, name: str, *arguments: Any) -> int:
        """What the library function, told a scene and these, writes behind its last argument."""
        number = ctypes.c_uint32()
        self._context.call("sonject_scene_" + name, self, *arguments, ctypes.byref(number))
        return number.value

    @property
    def object_count(self) -> int:
        return self._number("object_count")

"""The ctypes declarations against the headers and against the C compiler."""

import ctypes
import os
import re
import shlex
import subprocess

import headers
import pytest

from sonject import _library, _structures, enumerations
from sonject._functions import FUNCTIONS

ENUMERATIONS = {
    "sonject_status": (enumerations.Status, "SONJECT_"),
    "sonject_side": (enumerations.Side, "SONJECT_SIDE_"),
    "sonject_match": (enumerations.Match, "SONJECT_MATCH_"),
    "sonject_level_kind": (enumerations.LevelKind, "SONJECT_LEVEL_"),
    "sonject_labels": (enumerations.LabelFormat, "SONJECT_LABELS_"),
    "sonject_transfer": (enumerations.TransferKind, "SONJECT_TRANSFER_"),
    "sonject_injection_mode": (enumerations.Mode, "SONJECT_MODE_"),
    "sonject_column_rule": (enumerations.ColumnRule, "SONJECT_COLUMNS_"),
    "sonject_estimator": (enumerations.Estimator, "SONJECT_ESTIMATOR_"),
    "sonject_forward_rule": (enumerations.ForwardRule, "SONJECT_FORWARD_"),
    "sonject_reflection_kind": (enumerations.ReflectionKind, "SONJECT_REFLECTION_"),
    "sonject_shape": (enumerations.Shape, "SONJECT_SHAPE_"),
    "sonject_end": (enumerations.End, "SONJECT_END_"),
    "sonject_burial_kind": (enumerations.BurialKind, "SONJECT_BURIAL_"),
    "sonject_position_kind": (enumerations.PositionKind, "SONJECT_POSITION_"),
    "sonject_pixel_kind": (enumerations.PixelKind, "SONJECT_PIXELS_"),
    "sonject_layer": (enumerations.Layer, "SONJECT_LAYER_"),
    "sonject_samples": (enumerations.Samples, "SONJECT_SAMPLES_"),
    "sonject_convert_axis": (enumerations.ConvertAxis, "SONJECT_CONVERT_AXIS_"),
    "sonject_range_axis": (enumerations.RangeAxis, "SONJECT_AXIS_"),
    "sonject_input_kind": (enumerations.InputKind, "SONJECT_INPUT_"),
    "sonject_seabed_map": (enumerations.SeabedMap, "SONJECT_MAP_"),
    "sonject_response_window": (enumerations.ResponseWindow, "SONJECT_WINDOW_"),
    "sonject_series_form": (enumerations.SeriesForm, "SONJECT_SERIES_"),
    "sonject_series_pulse": (enumerations.SeriesPulse, "SONJECT_SERIES_"),
    "sonject_pulse_kind": (enumerations.PulseKind, "SONJECT_PULSE_"),
    "sonject_pulse_window": (enumerations.PulseWindow, "SONJECT_PULSE_"),
    "sonject_pulse_axis": (enumerations.PulseAxis, "SONJECT_PULSE_AXIS_"),
    "sonject_sonar_kind": (enumerations.SonarKind, "SONJECT_SONAR_"),
}


def mirrored():
    """The structures of the package that have fields."""
    return {
        name: kind
        for name, kind in vars(_structures).items()
        if name.startswith("sonject_")
        and isinstance(kind, type)
        and issubclass(kind, ctypes.Structure)
        and hasattr(kind, "_fields_")
    }


def test_every_structure_has_the_headers_fields():
    declared = headers.structures()
    assert declared
    assert {name: list(kind._fields_) for name, kind in mirrored().items()} == declared


def test_every_function_has_the_headers_parameters():
    declared = headers.functions()
    assert len(declared) == headers.declaration_count() > 0
    assert FUNCTIONS == declared


def test_callbacks_are_the_headers():
    declared = headers.callbacks()
    assert set(declared) == {"sonject_log_function", "sonject_progress_function"}
    for name, (result, parameters) in declared.items():
        kind = getattr(_structures, name)
        assert kind._restype_ is result
        assert list(kind._argtypes_) == parameters


def test_every_enumeration_has_the_headers_values():
    declared = headers.enumerations()
    assert set(declared) == set(ENUMERATIONS)
    for name, (kind, prefix) in ENUMERATIONS.items():
        assert {prefix + member.name: member.value for member in kind} == declared[name]


def test_name_capacity_and_version_are_the_headers():
    text = headers.source()
    numbers = dict(re.findall(r"#define SONJECT_(VERSION_\w+|\w+_CAPACITY) (\d+)", text))
    assert int(numbers["NAME_CAPACITY"]) == _structures.NAME_CAPACITY
    assert int(numbers["CUTS_CAPACITY"]) == _structures.CUTS_CAPACITY
    assert int(numbers["SWAYS_CAPACITY"]) == _structures.SWAYS_CAPACITY
    assert int(numbers["YAWS_CAPACITY"]) == _structures.YAWS_CAPACITY
    version = tuple(int(numbers["VERSION_" + part]) for part in ("MAJOR", "MINOR", "PATCH"))
    assert version == _library.VERSION


def layout_program():
    """A C program that prints the size of each structure and the place of each field."""
    lines = ["#include <stddef.h>", "#include <stdio.h>", "#include <sonject/sonject.h>"]
    lines.append("int main(void) {")
    for name, kind in mirrored().items():
        lines.append(f'printf("{name} %zu\\n", sizeof({name}));')
        for field, _ in kind._fields_:
            lines.append(
                f'printf("{name}.{field} %zu %zu\\n", offsetof({name}, {field}), '
                f"sizeof((({name} *)0)->{field}));"
            )
    lines.append("return 0; }")
    return "\n".join(lines)


@pytest.fixture(scope="module")
def compiled_layout(tmp_path_factory):
    folder = tmp_path_factory.mktemp("layout")
    (folder / "layout.c").write_text(layout_program())
    compiler = shlex.split(os.environ.get("CC", "cc"))
    subprocess.run(
        [*compiler, "-std=c99", f"-I{headers.FOLDER.parent}", "-o", folder / "layout"]
        + [folder / "layout.c"],
        check=True,
    )
    printed = subprocess.run([folder / "layout"], check=True, capture_output=True, text=True)
    rows = (line.split() for line in printed.stdout.splitlines())
    return {row[0]: [int(number) for number in row[1:]] for row in rows}


def test_layout_is_the_compilers(compiled_layout):
    ours = {}
    for name, kind in mirrored().items():
        ours[name] = [ctypes.sizeof(kind)]
        for field, _ in kind._fields_:
            place = getattr(kind, field)
            ours[f"{name}.{field}"] = [place.offset, place.size]
    assert ours == compiled_layout


def test_init_functions_write_the_size_of_ours():
    library = _library.load()
    for name, kind in mirrored().items():
        if name + "_init" in FUNCTIONS:
            structure = kind()
            getattr(library, name + "_init")(ctypes.byref(structure))
            assert structure.struct_size == ctypes.sizeof(kind), name

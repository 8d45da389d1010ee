"""Writes the modules of the Python package that say what the C headers say: generate.py FOLDER HEADER...

FOLDER gets _interface.py, the declarations for ctypes; enumerations.py; and _classes.py, the
dataclasses of structures, with the headers' comments as their documentation. Whatever in a header is
not understood ends it with an error.
"""

import pathlib
import re
import sys
import textwrap

SCALARS = {"char": "c_char", "double": "c_double", "float": "c_float", "int": "c_int",
           "size_t": "c_size_t", "int32_t": "c_int32", "uint8_t": "c_uint8",
           "uint32_t": "c_uint32", "uint64_t": "c_uint64"}
# Enumerations whose name in Python is not that in C.
ENUMERATION_NAMES = {"sonject_injection_mode": "Mode", "sonject_labels": "LabelFormat",
                     "sonject_transfer": "TransferKind"}
# Structures that are classes in Python: name and base, of _parameters.py.
CLASSES = {
    "sonject_box": ("Box", "BoxBase"),
    "sonject_material_params": ("Material", "MaterialBase"),
    "sonject_sonar_params": ("Sonar", "Parameters"),
    "sonject_pulse_params": ("Pulse", "Parameters"),
    "sonject_motion_params": ("Motion", "MotionBase"),
    "sonject_medium_params": ("Medium", "Parameters"),
    "sonject_seabed_params": ("Seabed", "Parameters"),
    "sonject_surface_params": ("Surface", "Parameters"),
    "sonject_geometry_params": ("Geometry", "Parameters"),
    "sonject_transfer_params": ("Transfer", "Parameters"),
    "sonject_injection_params": ("Injection", "InjectionBase"),
    "sonject_synthetic_params": ("Synthetic", "Parameters"),
    "sonject_patch_params": ("Patch", "Parameters"),
    "sonject_elements_params": ("Elements", "Parameters"),
    "sonject_element_layout": ("ElementLayout", "ElementLayoutBase"),
    "sonject_device_info": ("Device", "Answer"),
    "sonject_object_truth": ("ObjectTruth", "Answer"),
    "sonject_statistics": ("Statistics", "Answer"),
    "sonject_measurement": ("Measurement", "Answer"),
    "sonject_contact_measures": ("ContactMeasures", "Answer"),
    "sonject_campaign_image": ("CampaignImage", "Answer"),
}
# Members that are no fields: their bases have them in another form, or a call without files leaves
# them unset.
NO_FIELDS = {"struct_size", "reserved", "estimate_noise", "noise_floor_db of Injection", "sway_count",
             "sways", "yaw_count", "yaws", "seam_before"}
# What those bases have instead.
OF_BASES = {
    "Motion": [("sways, yaws", "up to 8 sines each, added together: amplitude (m or rad), wavelength_m "
                "along-track, phase_rad")],
    "Injection": [("noise_floor_db", "noise energy over the local mean seabed energy, below 0; None: "
                   "estimated from the patch")],
}
REQUIRED = {"first_slant_range_m of Geometry"}  # beside those of structures without defaults
COMMENT = r"/\*(?:(?!\*/).)*\*/"


class Header:
    """The declarations of the headers, in the order in which they come."""

    def __init__(self, sources):
        text = "\n".join(sources)
        self.capacities = dict(re.findall(r"#define SONJECT_(\w+_CAPACITY)\s+(\d+)", text))
        self.version = re.findall(r"#define SONJECT_VERSION_[A-Z]+\s+(\d+)", text)
        bare = re.sub(COMMENT, " ", text, flags=re.S)
        self.enumerations, self.structures, self.titles = {}, {}, {}
        for source in sources:
            title = words(re.match(COMMENT, source, flags=re.S)[0])
            for comment, kind, name, body in re.findall(
                rf"(?:({COMMENT})\n)?typedef (enum|struct) (\w+) \{{\n(.*?)\n\}} \3;",
                re.sub(rf"^{COMMENT}", "", source, flags=re.S), flags=re.S):
                found = self.enumerations if kind == "enum" else self.structures
                found[name] = list(members(body))
                self.titles[name] = lines(comment) if comment else [title]
        self.constants = re.findall(r"SONJECT_(\w+) = (-\d+)", bare)
        self.opaque = re.findall(r"typedef struct (\w+) \1;", bare)
        self.callbacks = re.findall(r"typedef (\w+) \(\*(\w+)\)\(([^)]*)\);", bare)
        self.functions = [(result, name, parameters) for result, name, parameters in re.findall(
            r"SONJECT_API\s+((?:const )?\w+\s\*?)(\w+)\(([^)]*)\);", bare)]
        understood = [self.enumerations, self.structures, self.opaque, self.callbacks]
        assert bare.count("typedef ") == sum(map(len, understood)), "a typedef is not understood"
        declared = re.findall(r"SONJECT_API (?!__)[\w *\s]+\(", bare)
        assert len(self.functions) == len(declared) > 0, "a function is not understood"
        assert len(self.version) == 3, "the version is not understood"


def lines(comment):
    """The lines of a C comment, those of a drawing as they are."""
    return [re.sub(r"^ ?\* ?", "", line).rstrip() for line in comment[2:-2].strip().split("\n")]


def words(comment):
    return " ".join(" ".join(lines(re.sub(r"\n\s+\*?", "\n", comment))).split())


def members(body):
    """(declaration, comment) of each member; a comment of its own line is of the next one."""
    end = ";" if ";" in re.sub(COMMENT, "", body, flags=re.S) else ","
    before, place = "", 0
    for found in re.finditer(rf"\s*({COMMENT})|\s*([^/{end}]+?)(?:{end}|(?=\s*/\*)|$)"
                             rf"(?:[ ]*({COMMENT}))?", body, flags=re.S):
        assert found.start() == place, f"not understood: {body[place:found.start()]!r}"
        place = found.end()
        alone, declaration, behind = found.groups()
        if alone:
            before = words(alone) + " "
        elif declaration:
            yield " ".join(declaration.split()), (before if behind or before else "") + (
                words(behind) if behind else "")
            before = ""
    assert body[place:].strip() == "", f"not understood: {body[place:]!r}"


def split(declaration):
    """Type, name and array length of "const char *name", "char name[64]", ..."""
    found = re.fullmatch(r"(.*?)(\w+)(?:\[(\w+)\])?", declaration.strip(), flags=re.S)
    return " ".join(found[1].split()), found[2], found[3]


def ctypes_name(header, text):
    """The ctypes type that a C type's spelling stands for."""
    found = re.fullmatch(r"(?:const )?(\w+) ?((?:\*| |const)*)", text.strip())
    assert found, f"not understood: {text}"
    base, stars = found.groups()
    depth = stars.count("*")
    if base in ("char", "void") and depth:
        kind, depth = ("c_char_p" if base == "char" else "c_void_p"), depth - 1
    elif base == "void":
        return "None"
    elif base in header.enumerations:
        kind = "c_int"
    else:
        kind = SCALARS.get(base, base)
    return "POINTER(" * depth + kind + ")" * depth


def parameters(header, text):
    text = " ".join(text.split())
    return [] if text == "void" else [ctypes_name(header, split(each)[0]) for each in text.split(",")]


def interface(header):
    """_interface.py"""
    yield '"""The public structures and functions of include/sonject under their C names."""\n'
    yield "import ctypes\nfrom ctypes import CFUNCTYPE, POINTER"
    yield "from ctypes import " + ", ".join([*SCALARS.values(), "c_char_p", "c_void_p"])
    yield "from typing import Any\n"
    yield f"VERSION = ({', '.join(header.version)})"
    for name, value in [*header.capacities.items(), *header.constants]:
        yield f"{name} = {value}"
    for result, name, text in header.callbacks:
        kinds = ", ".join([ctypes_name(header, result), *parameters(header, text)])
        yield f"{name} = CFUNCTYPE({kinds})"
    for name in header.opaque:
        yield f'\n\nclass {name}(ctypes.Structure):\n    """Opaque."""'
    written = set(header.opaque)

    def write(name):
        if name in written:
            return
        written.add(name)
        fields = []
        for declaration, _ in header.structures[name]:
            kind, field, length = split(declaration)
            for word in re.findall(r"sonject_\w+", kind):
                if word in header.structures:
                    yield from write(word)
            kind = ctypes_name(header, kind)
            if length:
                kind += " * " + length.removeprefix("SONJECT_")
            fields.append(f'        ("{field}", {kind}),')
        yield f"\n\nclass {name}(ctypes.Structure):\n    _fields_ = ["
        yield "\n".join(fields) + "\n    ]"

    for name in header.structures:
        yield from write(name)
    yield "\n\n# name: (what it returns, its parameters in order)"
    yield "FUNCTIONS: dict[str, tuple[Any, list[Any]]] = {"
    for result, name, text in header.functions:
        kinds = ", ".join(parameters(header, text))
        yield f'    "{name}": ({ctypes_name(header, result)}, [{kinds}]),'
    yield "}"


def enumeration_name(name):
    words_of = name.removeprefix("sonject_").split("_")
    return ENUMERATION_NAMES.get(name, "".join(word.capitalize() for word in words_of))


def values(header, name):
    """(member's name in Python, value, comment) of an enumeration."""
    found = [(*re.fullmatch(r"(SONJECT_\w+) = (\d+)", text).groups(), comment)
             for text, comment in header.enumerations[name]]
    stem = found[0][0]
    while not all(member.startswith(stem + "_") for member, _, _ in found):
        stem = stem.rpartition("_")[0]
    return [(member.removeprefix(stem + "_"), value, comment) for member, value, comment in found]


def enumerations(header):
    """enumerations.py"""
    yield '"""Named choices; the values are those of the C enumerations."""\n\nimport enum'
    for name in header.enumerations:
        found = values(header, name)
        yield f"\n\nclass {enumeration_name(name)}(enum.IntEnum):"
        yield from documentation(header, header.titles[name],
                                 [(member, comment) for member, _, comment in found])
        yield from (f"    {member} = {value}" for member, value, _ in found)


def documentation(header, title, described):
    """A docstring, in the words of Python."""
    told = textwrap.wrap(title[0], 94) if len(title) == 1 else [*title]
    described = [(name, comment) for name, comment in described
                 if comment and comment not in header.enumerations]
    told += [""] * bool(described)
    for name, comment in described:
        told += textwrap.wrap(f"{name}: {comment}", 94, subsequent_indent="    ")
    told += [""] * (len(told) > 1)
    text = "\n".join(told)
    for name in header.enumerations:
        for declaration, (member, _, _) in zip(header.enumerations[name], values(header, name)):
            text = re.sub(rf"\b{declaration[0].split()[0]}\b", f"{enumeration_name(name)}.{member}",
                          text)
        text = re.sub(rf"\b{name}\b", enumeration_name(name), text)
    for name, (kind, _) in CLASSES.items():
        text = re.sub(rf"\b{name}\b", kind, text)
    text = re.sub(r"\bsonject_scene_(?=\w)", "Scene.", text)
    text = re.sub(r"\bNULL\b", "None", re.sub(r"\bsonject_(?=[a-z])", "", text))
    text = ('r"""' if "\\" in text else '"""') + text + '"""'
    yield textwrap.indent(text, "    ", lambda line: line.strip()) + "\n"


def fields_of(header, structure):
    """(name, type in Python, comment) of the fields of a structure's class."""
    kind, base = CLASSES[structure]
    for declaration, comment in header.structures[structure]:
        written, name, length = split(declaration)
        if NO_FIELDS & {name, f"{name} of {kind}"}:
            continue
        choice = re.match(r"sonject_\w+", comment)
        assert not length or written == "char", f"no field for {declaration}"
        if written in CLASSES:
            found = CLASSES[written][0]
        elif written == "char" and length:
            found = "str"
        elif written == "double":
            found = "float"
        elif re.search(r"(^|_)(is|has)_", name) or comment.startswith("1: "):
            found = "bool"
        elif choice and choice[0] in header.enumerations and base not in ("Answer", "BoxBase"):
            found = enumeration_name(choice[0])
        else:
            assert written in ("uint32_t", "uint64_t"), f"no field for {declaration}"
            found = "int"
        yield name, found, comment


def classes(header):
    """_classes.py"""
    chosen = sorted(enumeration_name(name) for name in header.enumerations)
    bases = sorted({base for _, base in CLASSES.values()})
    functions = {name for _, name, _ in header.functions}
    yield '"""The classes of structures, their fields as include/sonject declares them."""\n'
    yield "from dataclasses import dataclass\n"
    yield "from . import _interface as s"
    yield f"from ._parameters import {', '.join(bases)}, library_default"
    yield f"from .enumerations import ({', '.join(chosen)})"
    for structure, (kind, base) in CLASSES.items():
        found = list(fields_of(header, structure))
        is_answer = base in ("Answer", "BoxBase", "ElementLayoutBase")
        yield f"\n\n@dataclass({'frozen' if is_answer else 'kw_only'}=True)"
        yield f"class {kind}({base}):"
        yield from documentation(header, header.titles[structure],
                                 OF_BASES.get(kind, []) + [(name, comment)
                                                           for name, _, comment in found])
        yield f"    _structure = s.{structure}\n"
        has_defaults = structure + "_init" in functions
        for name, kind_of, _ in found:
            is_given = not has_defaults or f"{name} of {kind}" in REQUIRED
            yield f"    {name}: {kind_of}" + ("" if is_given else " = library_default()")


def main():
    folder = pathlib.Path(sys.argv[1])
    header = Header([pathlib.Path(name).read_text(encoding="utf-8") for name in sys.argv[2:]])
    for name, write in {"_interface": interface, "enumerations": enumerations,
                        "_classes": classes}.items():
        text = "\n".join(write(header)) + "\n"
        (folder / f"{name}.py").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()

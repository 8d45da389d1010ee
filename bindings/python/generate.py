"""Generates modules of the Python package: generate.py FOLDER KEYS HEADER...

FOLDER gets _interface.py, the declarations of the C headers for ctypes; enumerations.py;
_classes.py, the dataclasses of structures, documented by the headers' comments; and keys.py, the
keys of scenes, from tools/scenes/KEYS.md. Anything that the parser does not understand ends it with
an error.
"""

import keyword
import pathlib
import re
import sys
import textwrap

SCALARS = {"char": "c_char", "double": "c_double", "float": "c_float", "int": "c_int",
           "size_t": "c_size_t", "int32_t": "c_int32", "uint8_t": "c_uint8",
           "uint32_t": "c_uint32", "uint64_t": "c_uint64"}
# Enumerations with another name in Python than in C.
ENUMERATION_NAMES = {"sonject_labels": "LabelFormat"}
# Structures that are classes in Python: name and base, of _parameters.py.
CLASSES = {
    "sonject_box": ("Box", "BoxBase"),
    "sonject_elements_params": ("ElementArray", "Answer"),
    "sonject_element_layout": ("ElementLayout", "ElementLayoutBase"),
    "sonject_device_info": ("Device", "Answer"),
    "sonject_object_truth": ("ObjectTruth", "Answer"),
    "sonject_statistics": ("Statistics", "Answer"),
    "sonject_measurement": ("Measurement", "Answer"),
    "sonject_contact_measures": ("ContactMeasures", "Answer"),
    "sonject_campaign_image": ("CampaignImage", "Answer"),
}
NO_FIELDS = {"struct_size", "reserved"}
COMMENT = r"/\*(?:(?!\*/).)*\*/"


class Header:
    """The declarations of the headers, in their order."""

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
    """Returns the lines of a C comment, those of a drawing as they are."""
    return [re.sub(r"^ ?\* ?", "", line).rstrip() for line in comment[2:-2].strip().split("\n")]


def words(comment):
    return " ".join(" ".join(lines(re.sub(r"\n\s+\*?", "\n", comment))).split())


def members(body):
    """Yields (declaration, comment) of members; a comment on its own line belongs to the next one."""
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
    """Splits "const char *name", "char name[64]", ... into type, name and array length."""
    found = re.fullmatch(r"(.*?)(\w+)(?:\[(\w+)\])?", declaration.strip(), flags=re.S)
    return " ".join(found[1].split()), found[2], found[3]


def ctypes_name(header, text):
    """Returns the ctypes type for the spelling of a C type."""
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
    """Yields _interface.py."""
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
    """Yields (member's name in Python, value, comment) of an enumeration."""
    found = [(*re.fullmatch(r"(SONJECT_\w+) = (\d+)", text).groups(), comment)
             for text, comment in header.enumerations[name]]
    stem = found[0][0]
    while not all(member.startswith(stem + "_") for member, _, _ in found):
        stem = stem.rpartition("_")[0]
    return [(member.removeprefix(stem + "_"), value, comment) for member, value, comment in found]


def enumerations(header):
    """Yields enumerations.py."""
    yield '"""Named choices; the values are those of the C enumerations."""\n\nimport enum'
    for name in header.enumerations:
        found = values(header, name)
        yield f"\n\nclass {enumeration_name(name)}(enum.IntEnum):"
        yield from documentation(header, header.titles[name],
                                 [(member, comment) for member, _, comment in found])
        yield from (f"    {member} = {value}" for member, value, _ in found)


def documentation(header, title, described):
    """Yields a docstring, with C's names replaced by Python's."""
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
    """Yields (name, type in Python, comment) of the fields of a structure's class."""
    for declaration, comment in header.structures[structure]:
        written, name, length = split(declaration)
        if name in NO_FIELDS:
            continue
        assert not length or written == "char", f"no field for {declaration}"
        if written in CLASSES:
            found = CLASSES[written][0]
        elif written == "char" and length:
            found = "str"
        elif written == "double":
            found = "float"
        elif re.search(r"(^|_)(is|has)_", name) or comment.startswith("1: "):
            found = "bool"
        else:
            assert written in ("uint32_t", "uint64_t"), f"no field for {declaration}"
            found = "int"
        yield name, found, comment


def classes(header):
    """Yields _classes.py."""
    bases = sorted({base for _, base in CLASSES.values()})
    yield '"""The classes of structures, their fields as include/sonject declares them."""\n'
    yield "from dataclasses import dataclass\n"
    yield f"from ._parameters import {', '.join(bases)}"
    for structure, (kind, base) in CLASSES.items():
        found = list(fields_of(header, structure))
        yield "\n\n@dataclass(frozen=True)"
        yield f"class {kind}({base}):"
        yield from documentation(header, header.titles[structure],
                                 [(name, comment) for name, _, comment in found])
        yield from (f"    {name}: {kind_of}" for name, kind_of, _ in found)


class Key:
    """A key of scene files, or a section of keys, as in tools/scenes/KEYS.md."""

    def __init__(self):
        self.unit, self.told, self.words = "", "", ""
        self.inner, self.is_list = {}, False

    def at(self, path):
        """Returns the key at a path below this one; makes it if it is new."""
        key = self
        for part in path.split("."):
            key = key.inner.setdefault(part.removesuffix("[]"), Key())
            key.is_list = key.is_list or part.endswith("[]")
        return key


def read_keys(text):
    scene = Key()
    for path, mark, meaning, unit, default, limits in re.findall(
            r"^\| `([^`]+)`( \*)? \| (.*?) \| (.*?) \| (.*?) \| (.*?) \|$", text, flags=re.M):
        key = scene.at(path)
        key.unit, key.words = unit, limits
        notes = [unit, limits, "required" if mark else default != "–" and f"default {default}"]
        key.told = f"{meaning} ({'; '.join(filter(None, notes))})".replace("\\|", "|")
    (shared,) = re.findall(r"^Parts, .*meaning: (.*)$", text, flags=re.M)
    body, part = scene.at("objects"), scene.at("objects.parts")
    for name in re.findall(r"`(\w+)", shared):
        if not part.at(name).inner and name != "parts":
            part.inner[name] = body.inner[name]
    return scene


def key_types(scene):
    """Yields keys.py: scenes as dictionaries whose keys type checkers know."""
    yield '"""The keys of scenes, as in scene files: each section is a dictionary.\n'
    yield "Quantities are numbers in the first unit that is listed, or texts with a unit: 0.3 or \"30 cm\"."
    yield '"""\n\nfrom __future__ import annotations\n'
    yield "import os\nfrom typing import Any, Literal, Sequence, TypedDict, Union\n"
    yield "Quantity = Union[float, str]\nFile = Union[str, os.PathLike[str]]"
    written = set()

    def class_name(path):
        names = "".join(part.capitalize() for part in re.findall(r"[a-z]+", path))
        return re.sub("^Objects", "Object", names).replace("Parts", "Part") or "Scene"

    def kind_of(path, key):
        kinds = []
        if key.unit == "word":
            kinds.append("Literal[" + ", ".join(f'"{word}"' for word in key.words.split(", ")) + "]")
        elif key.unit == "whole number":
            kinds.append("int")
        elif key.unit == "true or false":
            kinds.append("bool")
        elif key.unit == "file name":
            kinds.append("File")
        elif key.unit in ("text", "name"):
            kinds.append("str")
        elif key.unit == "list":
            return f"Sequence[{class_name(path.rpartition('.')[0])}]"
        elif key.unit and "a list" in key.words:
            return "Sequence[Quantity]"
        elif key.unit:
            kinds.append("Any" if "section" in key.unit or "list" in key.unit else "Quantity")
        if key.inner:
            section = class_name(path)
            kinds.append(f"Sequence[{section}]" if key.is_list else section)
        return kinds[0] if len(kinds) == 1 else f"Union[{', '.join(kinds)}]"

    def write(path, key):
        name = class_name(path)
        if name in written:
            return
        written.add(name)
        fields = {}
        for part, inner in key.inner.items():
            inside = f"{path}.{part}".lstrip(".")
            if id(inner) in places:
                inside = places[id(inner)]
            places[id(inner)] = inside
            if inner.inner:
                yield from write(inside, inner)
            fields[part] = (kind_of(inside, inner), inner.told)
        base = "TypedDict"
        reserved = {part: kind for part, (kind, _) in fields.items() if keyword.iskeyword(part)}
        if reserved:
            base = f"_{name}"
            listed = ", ".join(f'"{part}": {kind}' for part, kind in reserved.items())
            yield f'\n\n{base} = TypedDict("{base}", {{{listed}}}, total=False)'
        yield f"\n\nclass {name}Keys({base}, total=False):" if name == "Scene" else (
            f"\n\nclass {name}({base}, total=False):")
        told = [f"`{path}`." if path else "All sections of a scene."]
        for part, (_, meaning) in fields.items():
            if meaning:
                told += textwrap.wrap(f"{part}: {meaning}", 94, subsequent_indent="    ")
        text = "\n".join(told + [""] * (len(told) > 1))
        yield textwrap.indent(f'"""{text}"""', "    ", lambda line: line.strip()) + "\n"
        yield from (f"    {part}: {kind}" for part, (kind, _) in fields.items()
                    if part not in reserved)

    places = {}
    yield from write("", scene)


def main():
    folder = pathlib.Path(sys.argv[1])
    texts = [pathlib.Path(name).read_text(encoding="utf-8") for name in sys.argv[2:]]
    header = Header(texts[1:])
    for name, lines_of in {"_interface": interface(header), "enumerations": enumerations(header),
                           "_classes": classes(header), "keys": key_types(read_keys(texts[0]))}.items():
        text = "\n".join(lines_of) + "\n"
        (folder / f"{name}.py").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
